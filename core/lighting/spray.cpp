#include "core/lighting/spray.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/glm.hpp>
#include <stdexcept>

#include "core/base/constants.h"
#include "core/lighting/air.h"
#include "core/lighting/background.h"

namespace pelagic {
namespace {

namespace spray_shading {
using namespace glm;

struct Shading {
    static constexpr int kAirColumns = Air::kColumns, kAirRows = Air::kRows, kAirSkyRows = Air::kSkyRows,
                         kAirHorizonRow = Air::kHorizonRow;
    const Spray& map;

    vec4 air_texel(int, int) const { return vec4(0.0f); }  // the air has been counted
    vec4 spray_texel(int column, int row) const {
        return map.texels[static_cast<std::size_t>(row) * map.columns + static_cast<std::size_t>(column)];
    }
    float spray_lift(int column, int row) const {
        const std::size_t at =
            static_cast<std::size_t>(map.rows + row) * map.columns + static_cast<std::size_t>(column);
        return at < map.texels.size() ? map.texels[at].x : 0.0f;
    }

// clang-format off
#include "core/lighting/air.glsl"
#include "core/lighting/spray.glsl"
    // clang-format on
};

}  // namespace spray_shading

spray_shading::Shading::SprayThreads threads_of(const SprayThreads& threads) {
    return {threads.cell, threads.wind, threads.born, threads.names, threads.per_m, threads.pixel_rad};
}

spray_shading::Shading::SprayView view_of(const Spray& spray) {
    return {spray.columns,         spray.rows,       spray.azimuth,
            spray.columns_per_rad, spray.first_m,    spray.row_step,
            spray.is_torn,         spray.scale_m,    spray.step_m,
            spray.haze_per_m,      spray.forward,    spray.eye_m,
            spray.top_m,           spray.to_sun,     spray.sun,
            spray.above,           spray.below,      spray.low_ahead,
            spray.low_beside,      spray.low_behind, threads_of(spray.threads)};
}

void take(SeaRadiance& radiance, const spray_shading::Shading::SprayPath& path) {
    for (glm::vec3* layer : {&radiance.sun, &radiance.sky, &radiance.sea, &radiance.foam, &radiance.air})
        *layer *= path.transmittance;
    radiance.air += path.scattered;
}

spray_shading::Shading::SprayPath path_of(const Spray& spray, glm::vec3 direction,
                                          std::optional<float> distance_m, bool on_sea) {
    spray_shading::Shading shading{spray};
    return shading.spray_path(-direction, distance_m.value_or(shading.kSprayEndless_m), on_sea,
                              view_of(spray));
}

}  // namespace

void light_spray(Spray& spray, const LightingChoice& choice, const Sky& sky, const WaterBody& water,
                 double foam) {
    constexpr auto kPi_f = static_cast<float>(kPi);
    const float sun = choice.sun ? 1.0f : 0.0f, rest = choice.sky ? 1.0f : 0.0f;
    spray.to_sun = sky.sun_direction;
    spray.sun = sky.sun_radiance * (sun * kPi_f * sky.sun_angular_radius * sky.sun_angular_radius);
    spray.above = sky.sky_irradiance * (rest / kPi_f);
    constexpr float kLow = 0.2f;  // of a unit vector's height
    const float flat = std::hypot(sky.sun_direction.x, sky.sun_direction.y);
    const glm::vec2 sunwards =
        flat > 1e-6f ? glm::vec2(sky.sun_direction.x, sky.sun_direction.y) / flat : glm::vec2(1.0f, 0.0f);
    const auto low = [&](glm::vec2 towards) {
        return rest * background(sky, glm::vec3(towards * std::sqrt(1.0f - kLow * kLow), kLow), kLow).sky;
    };
    spray.low_ahead = low(sunwards);
    spray.low_beside = 0.5f * (low({-sunwards.y, sunwards.x}) + low({sunwards.y, -sunwards.x}));
    spray.low_behind = low(-sunwards);
    constexpr float kSurface = 0.06751f;  // of a diffuse sky's light, as kDiffuseFresnel in fresnel.glsl
    const SeaAlbedo albedo = sea_albedo(water);
    const auto covered = choice.whitecaps ? static_cast<float>(foam) : 0.0f;
    const glm::vec3 clear = kSurface + (choice.water ? albedo.water : glm::vec3(0.0f));
    spray.below = (sun * sky.sun_irradiance + rest * sky.sky_irradiance) / kPi_f *
                  ((1.0f - covered) * clear + covered * albedo.foam);
}

SpraySeen spray_before(const Spray& spray, glm::vec3 direction, std::optional<float> distance_m,
                       bool on_sea) {
    if (spray.empty()) return {};
    const auto path = path_of(spray, direction, distance_m, on_sea);
    return {path.transmittance, path.scattered};
}

float spray_thread(const Spray& spray, glm::vec2 place_m, float height_m, float extinction_per_m,
                   float pixel_m) {
    spray_shading::Shading shading{spray};
    return shading.spray_thread(place_m, height_m, extinction_per_m, pixel_m, threads_of(spray.threads));
}

glm::vec3 spray_light(const Spray& spray, glm::vec3 direction, float height_m) {
    spray_shading::Shading shading{spray};
    const float column =
        spray.haze_per_m * spray.scale_m * std::exp(-std::max(height_m, 0.0f) / spray.scale_m);
    return shading.spray_source(shading.spray_light_along(direction, view_of(spray)), column);
}

void see_through_spray(const Spray& spray, std::span<const glm::vec3> to_eye,
                       std::span<const float> distance_m, std::span<SeaRadiance> radiance) {
    if (to_eye.size() != radiance.size() || distance_m.size() != radiance.size())
        throw std::invalid_argument(
            "see_through_spray: give one direction and one distance for each SeaRadiance");
    if (spray.empty()) return;
    spray_shading::Shading shading{spray};
    const spray_shading::Shading::SprayView view = view_of(spray);
    for (std::size_t i = 0; i < radiance.size(); ++i)
        take(radiance[i], shading.spray_path(to_eye[i], distance_m[i], true, view));
}

float see_through_spray(const Spray& spray, glm::vec3 direction, std::optional<float> distance_m,
                        SeaRadiance& radiance) {
    if (spray.empty()) return 1.0f;
    const auto path = path_of(spray, direction, distance_m, false);
    take(radiance, path);
    return path.transmittance;
}

}  // namespace pelagic
