#include "core/lighting/object.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

namespace pelagic {
namespace object_shading {

using namespace glm;

// clang-format off
#include "core/lighting/special.glsl"
#include "core/lighting/fresnel.glsl"
#include "core/lighting/object.glsl"
// clang-format on

}  // namespace object_shading

namespace {

namespace shading = object_shading;

shading::ObjectLook glsl(const ObjectLook& look) {
    return {look.colour, look.roughness, look.glow};
}

// The sun's irradiance across its light.
glm::vec3 beam_of(const Sky& sky) {
    return shading::kPi * sky.sun_angular_radius * sky.sun_angular_radius * sky.sun_radiance;
}

// Adds light that comes from a direction (unit): its irradiance across that direction.
void add_light(ObjectSurroundings& to, glm::vec3 from, glm::vec3 light) {
    to.flat_part += light * 0.25f;
    to.x += light * (0.5f * from.x);
    to.y += light * (0.5f * from.y);
    to.z += light * (0.5f * from.z);
    // Of the second degree a diffuse surface keeps a quarter of what it does of the first constant.
    to.xy += light * (0.9375f * from.x * from.y);
    to.yz += light * (0.9375f * from.y * from.z);
    to.xz += light * (0.9375f * from.x * from.z);
    to.zz += light * (0.078125f * (3.0f * from.z * from.z - 1.0f));
    to.xx_yy += light * (0.234375f * (from.x * from.x - from.y * from.y));
}

}  // namespace

ObjectSurroundings object_surroundings(const LightingChoice& choice, const Sky& sky, const WaterBody& water,
                                       double foam) {
    ObjectSurroundings made;
    const float covered = choice.whitecaps ? static_cast<float>(foam) : 0.0f;
    const glm::vec3 sun = choice.sun ? sky.sun_irradiance : glm::vec3(0.0f),
                    above = choice.sky ? sky.sky_irradiance : glm::vec3(0.0f);
    const SeaAlbedo albedo = sea_albedo(water);
    made.water = (sun + above) / shading::kPi *
                 ((1.0f - covered) * (choice.water ? albedo.water : glm::vec3(0.0f)) + covered * albedo.foam);
    const float variance = 0.5f * (water.waves.x + water.waves.y);
    const auto reflected = [&](float cosine) {
        return (1.0f - covered) * shading::fresnel_effective_exact(cosine, std::sqrt(variance), variance);
    };
    const auto mirrored = [](glm::vec3 d) { return glm::vec3(d.x, d.y, -d.z); };
    constexpr int kSide = 64;  // of a square round the horizon's circle in the sky's map
    constexpr float kStep = 2.0f / kSide;
    for (int j = 0; j < kSide; ++j)
        for (int i = 0; i < kSide; ++i) {
            const glm::vec2 u(-1.0f + kStep * (static_cast<float>(i) + 0.5f),
                              -1.0f + kStep * (static_cast<float>(j) + 0.5f));
            if (glm::dot(u, u) > 1.0f) continue;
            const glm::vec3 d = sky_map_direction(u);
            const float solid_angle = (1.0f + d.z) * (1.0f + d.z) * kStep * kStep;
            const glm::vec3 light = choice.sky ? solid_angle * sky.map.open_radiance(u) : glm::vec3(0.0f);
            add_light(made, d, light);
            add_light(made, mirrored(d), reflected(d.z) * light + solid_angle * made.water);
        }
    if (choice.sun && sky.sun_direction.z > 0.0f)
        add_light(made, mirrored(sky.sun_direction), reflected(sky.sun_direction.z) * beam_of(sky));
    return made;
}

glm::vec3 object_irradiance(const ObjectSurroundings& light, glm::vec3 normal) {
    return shading::object_irradiance(normal, {light.flat_part, light.x, light.y, light.z, light.xy, light.yz,
                                               light.zz, light.xz, light.xx_yy, light.water});
}

glm::vec3 object_of_sun(const ObjectLook& look, const Sky& sky, glm::vec3 to_eye, glm::vec3 normal) {
    return shading::object_of_sun(to_eye, sky.sun_direction, normal, glsl(look), sky.sun_radiance,
                                  beam_of(sky));
}

glm::vec3 object_of_surroundings(const ObjectLook& look, float cosine, glm::vec3 irradiance,
                                 glm::vec3 mirrored) {
    return shading::object_of_surroundings(cosine, glsl(look), irradiance, mirrored);
}

glm::vec3 object_in_water(const ObjectLook& look, glm::vec3 normal, glm::vec3 to_sun, glm::vec3 sun,
                          glm::vec3 sky) {
    return shading::object_in_water(normal, to_sun, sun, sky, glsl(look));
}

glm::vec3 mirrored_facet(glm::vec3 to_eye, float roughness, glm::vec2 disc) {
    const float alpha = shading::varnish_alpha(roughness);
    // Where facets are stretched to a hemisphere it is seen as a disc, half of which the horizon cuts.
    const glm::vec3 eye = glm::normalize(glm::vec3(alpha * to_eye.x, alpha * to_eye.y, to_eye.z));
    const float level2 = eye.x * eye.x + eye.y * eye.y;
    const glm::vec3 side = level2 > 1e-8f ? glm::vec3(-eye.y, eye.x, 0.0f) / std::sqrt(level2)
                                          : glm::vec3(1.0f, 0.0f, 0.0f),
                    rise = glm::cross(eye, side);
    disc.y = glm::mix(std::sqrt(std::max(1.0f - disc.x * disc.x, 0.0f)), disc.y, 0.5f * (1.0f + eye.z));
    const glm::vec3 found =
        disc.x * side + disc.y * rise + std::sqrt(std::max(1.0f - glm::dot(disc, disc), 0.0f)) * eye;
    return glm::normalize(glm::vec3(alpha * found.x, alpha * found.y, std::max(found.z, 1e-4f)));
}

float mirrored_by_facet(float facing_facet, float leaving, float roughness) {
    return shading::varnish_fresnel(facing_facet) *
           shading::varnish_visible(std::max(leaving, 1e-3f), shading::varnish_alpha(roughness));
}

// The distribution of facets that an eye sees, over the solid angle of what they mirror (Heitz 2018, Eq. 17).
VarnishPart mirrored_by_varnish(glm::vec3 to_eye, glm::vec3 to_light, float roughness) {
    const glm::vec3 both = to_eye + to_light;
    if (!(to_light.z > 0.0f) || !(to_eye.z > 0.0f) || !(both.z > 0.0f)) return {};
    const float alpha2 = shading::square(shading::varnish_alpha(roughness));
    const glm::vec3 facet = glm::normalize(both);
    // α² − 1 times a square near 1 loses all that narrow lobes have: sin² is small there.
    const float spread = alpha2 * facet.z * facet.z + facet.x * facet.x + facet.y * facet.y;
    const float seen = shading::varnish_visible(to_eye.z, shading::varnish_alpha(roughness));
    VarnishPart part{.density = alpha2 / (shading::kPi * spread * spread) * seen / (4.0f * to_eye.z)};
    part.weight = part.density * mirrored_by_facet(glm::dot(to_eye, facet), to_light.z, roughness);
    return part;
}

float object_reflectance(float cosine, float roughness) {
    return shading::varnish_reflectance(cosine, roughness);
}

float mirrored_by_level_water(float cosine) {
    return shading::fresnel_exact(cosine, shading::kWaterIndex);
}

glm::vec3 refracted_by_water(glm::vec3 ray, glm::vec3 normal) {
    return glm::refract(ray, normal, 1.0f / shading::kWaterIndex);
}

}  // namespace pelagic
