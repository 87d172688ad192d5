#include "plugin/light/exposure.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>

#include "core/base/constants.h"
#include "core/lighting/air.h"
#include "core/lighting/background.h"
#include "core/lighting/colour.h"
#include "core/lighting/floor.h"
#include "core/lighting/lighting.h"
#include "core/lighting/meniscus.h"
#include "core/lighting/tone.h"
#include "core/plan/effects.h"
#include "core/scene/number_keys.h"
#include "core/spectrum/cox_munk.h"
#include "core/spectrum/directional_spectrum.h"
#include "core/surface/earth.h"
#include "core/waves/whitecaps.h"
#include "plugin/light/light.h"

namespace pelagic {
namespace {

constexpr std::size_t kMostViews = 16;
constexpr int kColumns = 24;  // of places in a view; rows as many as make them square
// A picture that shows nothing but black, such as one at night, is exposed as if it were this bright.
constexpr double kDarkest = 1e-5;  // [kcd/m²]

// Parts of a view that are this many times darker than its brightest part without the sun aren't metered, such as
// space beside the earth: pictures show them black whatever their exposure.
constexpr double kRange = 1024.0;
// Light times exposure of dense foam, which the exposure approaches from below: the film curve's 0.83, so that foam in the sun
// keeps its shades. Over a dark sea seen from above the mean alone would burn it out.
constexpr double kBrightestFoam = 1.25;
// Heights that differ by less than this, as a logarithm, share one table of air, which takes tens of milliseconds.
constexpr double kSameHeight = 0.1;

constexpr double kLeastHeight_m = 0.1;

// Eyes below this z are metered as in the water.
double under_from_m(const Scene& scene, const WaterBody& water) {
    const bool is_open =
        scene.surface.kind != SurfaceKind::Cage &&
        (scene.surface.kind != SurfaceKind::Patch || scene.surface.beyond != Beyond::Nothing);
    if (!is_open || !water.has_body) return -std::numeric_limits<double>::infinity();
    // Hardly a wave is as deep as two deviations of their height.
    return -std::max(2.0 * std::sqrt(DirectionalSpectrum(scene.sea, scene.waves.band_gains).m0()),
                     kLeastHeight_m);
}

class Meter {
  public:
    Meter(const Scene& scene, const Sky& sky, const Floor* floor)
        : sky_(sky),
          water_(make_water(scene)),
          curvature_per_m_(scene.surface.earth_curvature ? kEarthCurvature_per_m : 0.0) {
        under_m_ = under_from_m(scene, water_);
        variance_ = static_cast<float>(0.5 * CoxMunk::at_wind(scene.sea.wind_speed_mps).total);
        if (!water_.has_body || scene.sea.depth_file == SeaState{}.depth_file) return;
        if (!floor) made_ = make_floor(scene);
        floor_ = floor ? floor : &*made_;
    }

    void add(const View& view) {
        is_under_ = view.position_m.z < under_m_;
        eye_m_ = static_cast<float>(view.position_m.z);
        position_m_ = glm::dvec2(view.position_m);
        if (floor_ && is_under_) water_.floor_m = static_cast<float>(floor_->depth_m(position_m_));
        is_foam_seen_ = is_foam_seen_ || !is_under_;
        height_m_ = std::max(view.position_m.z, kLeastHeight_m);
        if (sky_.air && !(std::abs(std::log(height_m_ / air_height_m_)) < kSameHeight)) {
            air_ = sky_.air->seen_from(height_m_);
            air_height_m_ = height_m_;
        }
        const double step = static_cast<double>(view.resolution.x) / kColumns;
        const int rows = std::max(1, static_cast<int>(std::lround(view.resolution.y / step)));
        const double row_step = static_cast<double>(view.resolution.y) / rows;
        std::vector<Seen> all;
        double brightest = 0.0;
        for (int row = 0; row < rows; ++row)
            for (int column = 0; column < kColumns; ++column) {
                all.push_back(along(view.direction({(column + 0.5) * step, (row + 0.5) * row_step})));
                brightest = std::max(brightest, all.back().calm);
            }
        for (const Seen& seen : all) {
            if (seen.whole < brightest / kRange) continue;
            sum_ += std::log(std::max(seen.whole, kDarkest));
            ++count_;
        }
    }

    double log_mean() const { return std::exp(sum_ / static_cast<double>(count_)); }
    // From above, where it is bright.
    bool is_foam_seen() const { return is_foam_seen_; }

  private:
    // Luminance with and without the sun's reflection.
    struct Seen {
        double whole, calm;
    };

    // Distance to the sea at rest [m]; infinite in the sky.
    double distance_m(glm::dvec3 direction) const {
        const double up = (1.0 + height_m_ * curvature_per_m_) * direction.z;
        const double inside = up * up - height_m_ * curvature_per_m_ * (2.0 + height_m_ * curvature_per_m_);
        if (!(direction.z < 0.0 && inside >= 0.0)) return std::numeric_limits<double>::infinity();
        return height_m_ * (2.0 + height_m_ * curvature_per_m_) / (std::sqrt(inside) - up);
    }

    // Of an eye in the water.
    Seen below(const glm::vec3& to) const {
        SeaRadiance lit;
        if (to.z > 0.0f) {
            const SeaPoint point{.to_eye = -to, .slope_variance = {variance_, variance_, 0.0f}};
            const float metres = -eye_m_ / to.z;
            shade_sea_from_below({.whitecaps = false}, sky_, water_, eye_m_, {&point, 1}, {&metres, 1},
                                 {&lit, 1});
        } else {
            shade_water({}, sky_, water_, eye_m_, {&to, 1}, {&lit, 1});
        }
        const double calm = kBehindGlass * luminance(glm::dvec3(lit.sky + lit.sea));
        return {calm + kBehindGlass * luminance(glm::dvec3(lit.sun)), calm};
    }

    Seen along(glm::dvec3 direction) const {
        const glm::vec3 to(direction);
        if (is_under_) return below(to);
        const double distance = distance_m(direction);
        if (std::isinf(distance)) {
            const double sky =
                luminance(glm::dvec3(air_.has_sky ? sky_through(air_, to) : background(sky_, to, 1.0f).sky));
            return {sky, sky};
        }
        const glm::dvec3 at = curvature_per_m_ * (glm::dvec3(0.0, 0.0, height_m_) + distance * direction) +
                              glm::dvec3(0.0, 0.0, 1.0);
        const SeaPoint point{.to_eye = -to,
                             .slope_variance = {variance_, variance_, 0.0f},
                             .up = glm::vec3(glm::normalize(at))};
        SeaRadiance lit;
        WaterBody water = water_;
        if (floor_)
            water.floor_m =
                static_cast<float>(floor_->depth_m(position_m_ + distance * glm::dvec2(direction)));
        shade_sea({.whitecaps = false}, sky_, water, {&point, 1}, {&lit, 1}, &air_);
        const auto metres = static_cast<float>(distance);
        see_through(air_, {&point.to_eye, 1}, {&metres, 1}, {&lit, 1});
        const double calm = luminance(glm::dvec3(lit.sky + lit.sea + lit.air));
        return {calm + luminance(glm::dvec3(lit.sun)), calm};
    }

    const Sky& sky_;
    WaterBody water_;
    std::optional<Floor> made_;
    const Floor* floor_ = nullptr;  // where a map says how deep it is
    glm::dvec2 position_m_{0.0};
    double curvature_per_m_;
    float variance_;
    double under_m_;  // eyes below it are under water
    bool is_under_ = false, is_foam_seen_ = false;
    float eye_m_ = 0.0f;
    double height_m_ = 0.0, air_height_m_ = 0.0;
    Air air_;
    double sum_ = 0.0;
    std::size_t count_ = 0;
};

// Of dense white foam that lies level [kcd/m²]; 0 where there is none to be seen.
double foam_luminance(const Scene& scene, const Sky& sky) {
    constexpr double kReflectance = 0.55;  // foam.glsl
    constexpr double kSeen = 0.005;        // the coverage from which on it counts whole
    if (!is_on(Effect::Whitecaps, scene)) return 0.0;
    const double seen = std::min(1.0, law_coverage(scene) / kSeen);
    return seen * kReflectance / kPi * luminance(glm::dvec3(sky.sun_irradiance + sky.sky_irradiance));
}

}  // namespace

std::vector<View> metered_views(const Scene& scene) {
    const std::vector<CameraKey>& keys = scene.camera.keys;
    if (keys.empty()) return {view_at(scene.camera, scene.shot.first_frame)};
    const std::size_t count = std::min(keys.size(), kMostViews);
    std::vector<View> views;
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t key = count > 1 ? i * (keys.size() - 1) / (count - 1) : 0;
        views.push_back(view_at(scene.camera, keys[key].frame));
    }
    return views;
}

bool is_metered_in_water(const Scene& scene) {
    return metered_views(scene).front().position_m.z < under_from_m(scene, make_water(scene));
}

float shot_exposure(const Scene& scene, const Sky& sky, double stops, const Floor* floor) {
    refuse_keys(scene);
    stops += scene.camera.exposure_ev;
    if (scene.camera.ev100) return static_cast<float>(exposure_of_ev100(*scene.camera.ev100 - stops));
    Meter meter(scene, sky, floor);
    for (const View& view : metered_views(scene)) meter.add(view);
    const double metered = exposure_for(meter.log_mean()),
                 most = kBrightestFoam /
                        std::max(meter.is_foam_seen() ? foam_luminance(scene, sky) : 0.0, 1e-30);
    const double share = metered / most;
    return static_cast<float>(metered / std::sqrt(std::sqrt(1.0 + (share * share) * (share * share))) *
                              std::exp2(stops));
}

}  // namespace pelagic
