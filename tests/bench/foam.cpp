// Foam's pattern and brightness. A patch of sea from 5 m to 20 km: its mean radiance with the pattern against that of smooth
// coverage. Dense foam in the sun against the sky over the horizon.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <memory>
#include <vector>

#include "core/evaluate/evaluate.h"
#include "core/lighting/background.h"
#include "core/lighting/colour.h"
#include "core/lighting/lighting.h"
#include "core/lighting/sky.h"
#include "core/lighting/water.h"
#include "core/surface/patch.h"
#include "tests/bench/timing.h"

namespace pelagic::bench {
namespace {

constexpr double kPixelTangent = 7.3e-4;  // a picture 1280 pixels wide through a 50° lens

double luminance_of(const glm::vec3& colour) {
    return luminance(glm::dvec3(colour));
}

// The means of all light and of the foam's over the points, per area of the picture.
struct Means {
    double all = 0.0, foam = 0.0;
};

class Patch {
  public:
    Patch(const Scene& scene, double elevation_deg)
        : to_eye_(std::cos(glm::radians(elevation_deg)), 0.0, std::sin(glm::radians(elevation_deg))),
          sky_(daylight_sky({.sun_elevation_deg = 40.0, .sun_azimuth_deg = 0.0})),
          water_(water_body({})),
          frame_(std::make_shared<const Sea<float>>(
              make_plan(scene, {view_query(*prepare(scene), {.products = kProducts})}))),
          rest_(rest_points<float>(
              {.per_side = kPoints, .spacing_m = kPatch_m / kPoints, .first_m = -0.5 * kPatch_m})),
          points_(rest_.size()),
          radiance_(rest_.size()),
          moments_(rest_.size()) {
        frame_.set(3.0);
    }

    void see_from(double height_m) {
        const double sine = static_cast<double>(to_eye_.z);
        const double width_m = kPixelTangent * height_m / sine;
        const glm::vec3 pixel_m(width_m, width_m / sine, 0.0);
        const std::vector<float> widths(rest_.size(), pixel_m.x);
        const std::vector<glm::vec2> axes(rest_.size(), glm::vec2(pixel_m.y, 0.0f));
        Results<float> results;
        results.set(Product::Normal, {&points_[0].normal, sizeof(SeaPoint)});
        results.set(Product::SlopeVariance, {&points_[0].slope_variance, sizeof(SeaPoint)});
        results.set(Product::Breaking, {&points_[0].coverage, sizeof(SeaPoint)});
        results.set(Product::JacobianMoments, {moments_.data()});
        evaluate(frame_, 0,
                 Points<float>{.count = rest_.size(),
                               .rest_m = {rest_.data()},
                               .pixel_m = {widths.data()},
                               .pixel_axis_m = {axes.data()}},
                 results);
        for (std::size_t i = 0; i < points_.size(); ++i) {
            points_[i].to_eye = to_eye_;
            points_[i].rest_m = rest_[i];
            points_[i].pixel_m = pixel_m;
        }
    }

    Means mean(const FoamPattern& foam) {
        shade_sea({.sky_quality = SkyQuality::One}, sky_, water_, points_, radiance_, nullptr, foam);
        Means sum;
        double all_area = 0.0;
        for (std::size_t i = 0; i < points_.size(); ++i) {
            const glm::vec3 normal = points_[i].normal;
            if (std::abs(normal.z) < 1e-6f) continue;
            const double area =
                static_cast<double>(std::max(glm::dot(normal, to_eye_) * moments_[i].x / normal.z, 0.0f));
            const SeaRadiance& r = radiance_[i];
            sum.all += area * luminance_of(r.sun + r.sky + r.sea + r.foam);
            sum.foam += area * luminance_of(r.foam);
            all_area += area;
        }
        return {sum.all / all_area, sum.foam / all_area};
    }

  private:
    static constexpr int kPoints = 400;  // a side
    static constexpr double kPatch_m = 600.0;
    inline static const ProductSet kProducts =
        products(Product::Normal, Product::SlopeVariance, Product::Breaking, Product::JacobianMoments);

    glm::vec3 to_eye_;
    Sky sky_;
    WaterBody water_;
    Frame<float> frame_;
    std::vector<glm::vec2> rest_;
    std::vector<SeaPoint> points_;
    std::vector<SeaRadiance> radiance_;
    std::vector<glm::vec3> moments_;
};

void back_off(double wind_mps, double elevation_deg) {
    Scene scene;
    scene.sea.wind_speed_mps = wind_mps;
    Patch patch(scene, elevation_deg);
    const FoamPattern smooth = foam_pattern({}, {}),
                      lace = foam_pattern({.structure = 1.0, .streaks = 0.5}, {});
    double least = 1e300, most = 0.0, least_foam = 1e300, most_foam = 0.0;
    for (double height_m = 5.0; height_m < 20.1e3; height_m *= 2.0) {
        patch.see_from(height_m);
        const Means without = patch.mean(smooth), with = patch.mean(lace);
        least = std::min(least, with.all / without.all);
        most = std::max(most, with.all / without.all);
        least_foam = std::min(least_foam, with.foam / without.foam);
        most_foam = std::max(most_foam, with.foam / without.foam);
    }
    std::printf("  %5g m/s %4g deg   all light %6.4f .. %6.4f   foam's %6.4f .. %6.4f   %s\n", wind_mps,
                elevation_deg, least, most, least_foam, most_foam,
                least >= 0.98 && most <= 1.02 ? "+- 2 % met" : "+- 2 % missed");
}

// Level dense foam of a fresh sea, 3° below the horizon, against the sky half a degree over it, in the same direction.
void against_the_sky(double sun_elevation_deg, double from_sun_deg) {
    const Sky sky =
        daylight_sky({.sun_elevation_deg = sun_elevation_deg, .sun_azimuth_deg = 0.0, .turbidity = 2.0});
    const auto towards = [&](double elevation_deg) {
        const double up = glm::radians(elevation_deg), around = glm::radians(from_sun_deg);
        return glm::vec3(
            glm::dvec3(std::cos(up) * std::cos(around), std::cos(up) * std::sin(around), std::sin(up)));
    };
    // Where a pattern shows nothing but dense foam: of a pattern that is all dense.
    FoamPattern dense = foam_pattern({.dense_active = 1.0f, .dense_left = 1.0f}, {});
    const SeaPoint point{
        .to_eye = -towards(-3.0), .slope_variance = glm::vec3(0.02f, 0.015f, 0.0f), .coverage = 1.0f};
    SeaRadiance white, grey;
    const WaterBody water = water_body({});
    shade_sea({}, sky, water, {&point, 1}, {&white, 1}, nullptr, dense);
    shade_sea({}, sky, water, {&point, 1}, {&grey, 1});
    const double over = luminance_of(background(sky, towards(0.5), 1.0f).sky);
    const double ratio = luminance_of(white.foam) / over;
    std::printf("  sun %2g deg, %3g deg from it: dense %5.2f, all of the foam %5.2f of the sky's   %s\n",
                sun_elevation_deg, from_sun_deg, ratio, luminance_of(grey.foam) / over,
                ratio >= 1.3 ? ">= 1.3 met" : ">= 1.3 missed");
}

}  // namespace
}  // namespace pelagic::bench

int main() {
    using namespace pelagic::bench;
    std::printf(
        "Mean radiance of 600 m of sea from 5 m to 20 km up, with foam's pattern over that without:\n");
    for (const double wind_mps : {10.0, 14.0, 20.0})
        for (const double elevation_deg : {15.0, 40.0}) back_off(wind_mps, elevation_deg);
    std::printf("Foam in the sun against the sky over the horizon, turbidity 2:\n");
    for (const double elevation_deg : {30.0, 45.0, 60.0})
        for (const double from_sun_deg : {95.0, 135.0, 180.0}) against_the_sky(elevation_deg, from_sun_deg);
}
