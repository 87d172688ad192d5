#include "plugin/light/exposure.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>

#include "core/lighting/background.h"
#include "core/lighting/colour.h"
#include "core/lighting/lighting.h"
#include "core/lighting/tone.h"
#include "core/spectrum/cox_munk.h"
#include "plugin/light/light.h"

namespace pelagic {
namespace {

constexpr std::size_t kMostViews = 16;
constexpr int kColumns = 24;  // of places in a view; rows as many as make them square
// A picture that shows nothing but black, such as one at night, is exposed as if it were this bright.
constexpr double kDarkest = 1e-5;  // [kcd/m²]

class Meter {
  public:
    Meter(const Scene& scene, const Sky& sky) : sky_(sky), water_(make_water(scene)) {
        variance_ = static_cast<float>(0.5 * CoxMunk::at_wind(scene.sea.wind_speed_mps).total);
    }

    void add(const View& view) {
        const double step = static_cast<double>(view.resolution.x) / kColumns;
        const int rows = std::max(1, static_cast<int>(std::lround(view.resolution.y / step)));
        const double row_step = static_cast<double>(view.resolution.y) / rows;
        for (int row = 0; row < rows; ++row)
            for (int column = 0; column < kColumns; ++column)
                add(glm::vec3(view.direction({(column + 0.5) * step, (row + 0.5) * row_step})));
    }

    double log_mean() const { return std::exp(sum_ / static_cast<double>(count_)); }

  private:
    void add(glm::vec3 direction) {
        const glm::vec3 seen =
            direction.z < 0.0f ? of_sea(-direction) : background(sky_, direction, 1.0f).sky;
        sum_ += std::log(std::max(luminance(glm::dvec3(seen)), kDarkest));
        ++count_;
    }

    glm::vec3 of_sea(glm::vec3 to_eye) const {
        const SeaPoint point{.to_eye = to_eye, .slope_variance = {variance_, variance_, 0.0f}};
        SeaRadiance lit;
        shade_sea({.whitecaps = false}, sky_, water_, {&point, 1}, {&lit, 1});
        return lit.sun + lit.sky + lit.sea;
    }

    const Sky& sky_;
    WaterBody water_;
    float variance_;
    double sum_ = 0.0;
    std::size_t count_ = 0;
};

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

float shot_exposure(const Scene& scene, const Sky& sky, double stops) {
    Meter meter(scene, sky);
    for (const View& view : metered_views(scene)) meter.add(view);
    return static_cast<float>(exposure_for(meter.log_mean()) * std::exp2(stops));
}

}  // namespace pelagic
