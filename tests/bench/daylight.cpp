// The sky of daylight in pictures, from the table before the eye and from the map that waves mirror, against the model
// itself along each pixel's ray; and the row of the horizon while the sun rises.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <vector>

#include "core/base/constants.h"
#include "core/lighting/air.h"
#include "core/lighting/background.h"
#include "core/lighting/colour.h"
#include "core/lighting/sky.h"
#include "core/surface/view.h"
#include "plugin/light/light.h"
#include "plugin/render/render.h"

namespace pelagic::bench {
namespace {

constexpr double kDegree = kPi / 180.0;
constexpr double kEye_m = 2.0;
constexpr double kDisc = 0.00465 + 6e-4;  // [rad], with the pixel that its rim blurs

double model(const Atmosphere& air, double sun_rad, glm::dvec3 to) {
    const double dip = std::acos(kEarthRadius_m / (kEarthRadius_m + kEye_m));
    const SightLine line{.height_km = 1e-3 * kEye_m,
                         .elevation_rad = std::max(std::asin(std::clamp(to.z, -1.0, 1.0)), 1e-7 - dip)};
    const std::array azimuths{std::atan2(to.y, to.x)};
    const Atmosphere::Scattered light = air.scattered(line, azimuths)[0];
    const double cosine = to.x * std::cos(sun_rad) + to.z * std::sin(sun_rad);
    return luminance(colour_of(light.by_air) * air_phase(cosine) +
                     colour_of(light.by_haze) * haze_phase(cosine) + colour_of(light.more));
}

// The largest errors of a way to look the sky up.
struct Errors {
    double value = 0.0, gradient = 0.0;
    void add(const Errors& other) {
        value = std::max(value, other.value);
        gradient = std::max(gradient, other.gradient);
    }
};

// Pixels of a line of a picture, in order: what each of the ways says, and whether it lies beside the sun's disc.
struct Pixel {
    double model, table, map;
    bool counts;
};
using Line = std::vector<Pixel>;

Errors errors_of(const std::vector<Line>& lines, double Pixel::*way) {
    Errors worst;
    double steepest = 1e-30, change = 0.0;
    for (const Line& line : lines)
        for (std::size_t i = 0; i < line.size(); ++i) {
            const Pixel& at = line[i];
            if (!at.counts) continue;
            worst.value = std::max(worst.value, std::abs(at.*way / at.model - 1.0));
            if (i == 0 || !line[i - 1].counts) continue;
            const double expected = at.model - line[i - 1].model, found = at.*way - line[i - 1].*way;
            steepest = std::max(steepest, std::abs(expected));
            change = std::max(change, std::abs(found - expected));
        }
    worst.gradient = change / steepest;
    return worst;
}

// Every sixteenth column and row, 1280 × 720, 40°, towards this azimuth from the sun.
std::vector<Line> lines_of(const Sky& sky, const Air& air, const Atmosphere& model_air, double sun_rad,
                           double azimuth_deg, double up_deg) {
    Camera camera;
    camera.resolution = {1280, 720};
    camera.fov_deg = 40.0;
    camera.position_m = {0.0, 0.0, kEye_m};
    camera.look_at_m =
        camera.position_m + 100.0 * glm::dvec3(std::cos(azimuth_deg * kDegree) * std::cos(up_deg * kDegree),
                                               std::sin(azimuth_deg * kDegree) * std::cos(up_deg * kDegree),
                                               std::sin(up_deg * kDegree));
    const View view = view_at(camera, 1);
    constexpr int kEvery = 80;
    std::vector<Line> lines(1280 / kEvery + 720 / kEvery);
    const glm::dvec3 sun(std::cos(sun_rad), 0.0, std::sin(sun_rad));
    tbb::parallel_for(std::size_t{0}, lines.size(), [&](std::size_t i) {
        const bool column = i < 1280 / kEvery;
        const int fixed = static_cast<int>(column ? i : i - 1280 / kEvery) * kEvery + kEvery / 2;
        for (int along = 0; along < (column ? 720 : 1280); ++along) {
            const glm::dvec2 pixel = column ? glm::dvec2(fixed, along) + 0.5 : glm::dvec2(along, fixed) + 0.5;
            const glm::dvec3 to = view.direction(pixel);
            if (to.z <= 0.0) continue;
            const glm::vec3 direction(to);
            lines[i].push_back(
                {model(model_air, sun_rad, to), luminance(glm::dvec3(sky_through(air, direction))),
                 luminance(glm::dvec3(background(sky, direction, 1.0f).sky)), glm::length(to - sun) > kDisc});
        }
    });
    return lines;
}

void print_sky() {
    std::printf(
        "The sky of pictures, 40° wide, 1280 × 720, against the model itself, outside the disc: largest errors of\n"
        "the value, and of the gradient, of the largest in the picture\n"
        "  %4s %9s %24s %24s\n",
        "sun", "turbidity", "before the eye", "in the map");
    Errors worst;
    for (const double sun_deg : {0.0, 2.0, 5.0, 20.0, 60.0})
        for (const double turbidity : {2.0, 3.0, 8.0}) {
            const Sky sky =
                daylight_sky({.sun_elevation_deg = sun_deg, .sun_azimuth_deg = 0.0, .turbidity = turbidity});
            const Air air = sky.air->seen_from(kEye_m);
            const Atmosphere model_air(turbidity, sun_deg * kDegree);
            Errors table, map;
            for (const double azimuth_deg : {0.0, 90.0, 180.0})
                for (const double up_deg : {5.0, std::max(sun_deg, 35.0)}) {
                    const std::vector<Line> lines =
                        lines_of(sky, air, model_air, sun_deg * kDegree, azimuth_deg, up_deg);
                    table.add(errors_of(lines, &Pixel::table));
                    map.add(errors_of(lines, &Pixel::map));
                }
            std::printf("  %3.0f° %9.0f %12.2f %% %8.2f %% %11.2f %% %8.2f %%\n", sun_deg, turbidity,
                        100.0 * table.value, 100.0 * table.gradient, 100.0 * map.value, 100.0 * map.gradient);
            worst.add(table);
        }
    std::printf("  before the eye: value <= 1 %% %s, gradient <= 2 %% %s\n",
                worst.value <= 0.01 ? "met" : "missed", worst.gradient <= 0.02 ? "met" : "missed");
}

// The luminance of the rows about the horizon, in the picture's middle column, away from the sun.
constexpr int kSide = 32;

std::vector<double> horizon_rows(double sun_deg, double turbidity) {
    Scene scene;
    scene.quality.level = QualityLevel::Draft;
    scene.light = {.sun_elevation_deg = sun_deg, .sun_azimuth_deg = 270.0, .turbidity = turbidity};
    scene.sea.wind_speed_mps = 0.5;
    scene.camera.resolution = {kSide, kSide};
    scene.camera.fov_deg = 2.0 * std::atan(kSide / 2 * 5.7e-4) / kDegree;
    scene.camera.position_m = {0.0, 0.0, 4.0};
    const double dip = std::acos(kEarthRadius_m / (kEarthRadius_m + 4.0));
    scene.camera.look_at_m = {0.0, 1e3, 4.0 - 1e3 * std::tan(dip)};
    Renderer renderer(scene, render_options(scene), make_sky(scene), std::array{1});
    Picture picture;
    renderer.render(1, picture);
    std::vector<double> rows;
    for (std::size_t y = 0; y < kSide; ++y) {
        double sum = 0.0;
        for (std::size_t x = 0; x < kSide; ++x)
            sum += luminance(glm::dvec3(radiance_of(picture.layers[y * kSide + x])));
        rows.push_back(sum / kSide);
    }
    return rows;
}

void print_horizon() {
    double most = 0.0, least = 1e30;
    int suns = 0, within = 0;
    for (const double turbidity : {2.0, 8.0})
        for (int step = 0; step <= 40; ++step) {
            const std::vector<double> rows = horizon_rows(-1.0 + 0.1 * step, turbidity);
            bool inside = true;
            for (std::size_t i = kSide / 2 - 1; i <= kSide / 2;
                 ++i) {  // the last of the sky and the first of the sea
                const double more = rows[i] / std::max(rows[i - 1], rows[i + 1]),
                             less = rows[i] / std::min(rows[i - 1], rows[i + 1]);
                inside = inside && more <= 1.5 && less >= 1.0 / 1.5;
                most = std::max(most, more);
                least = std::min(least, less);
            }
            ++suns;
            within += inside;
        }
    std::printf(
        "\nThe horizon's row away from the sun, suns from −1 to 3° by 0.1°, turbidity 2 and 8: at most %.2f of the\n"
        "brighter of its neighbours, at least %.2f of the darker; within a factor of 1.5: %d of %d, all %s\n",
        most, least, within, suns, within == suns ? "met" : "missed");
}

void print_time() {
    std::printf("\nTo build, ms, least of five on all threads:");
    const auto least = [](const auto& work) {
        double best = 1e30;
        for (int i = 0; i < 5; ++i) {
            const auto start = std::chrono::steady_clock::now();
            work();
            best = std::min(
                best,
                std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
        }
        return best;
    };
    const Sky sky = daylight_sky({});
    const double all = least([] { daylight_sky({}); });
    const double before_eye = least([&] { sky.air->seen_from(kEye_m); });
    std::printf(" daylight_sky() %.0f, the table before an eye %.0f\n", all, before_eye);
}

}  // namespace
}  // namespace pelagic::bench

int main() {
    pelagic::bench::print_sky();
    pelagic::bench::print_horizon();
    pelagic::bench::print_time();
}
