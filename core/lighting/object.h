// The light of a body's surface (object.glsl), for C++.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "core/lighting/lighting.h"
#include "core/lighting/sky.h"
#include "core/lighting/water.h"

namespace pelagic {

// object.glsl says what the members are.
struct ObjectLook {
    glm::vec3 colour{0.8f};
    float roughness = 0.5f;
    glm::vec3 glow{0.0f};  // [kcd/m²]
};
struct ObjectSurroundings {
    glm::vec3 flat_part{0.0f}, x{0.0f}, y{0.0f}, z{0.0f}, xy{0.0f}, yz{0.0f}, zz{0.0f}, xz{0.0f}, xx_yy{0.0f};
    glm::vec3 water{0.0f};
};

// What surrounds bodies on a sea: the sky above and, below, its image and the sun's in waves of the water's slopes, with the light
// from the water, of which so much is covered with foam (0 … 1). Terms that are off are black.
ObjectSurroundings object_surroundings(const LightingChoice& choice, const Sky& sky, const WaterBody& water,
                                       double foam);
// On a surface of that unit normal.
glm::vec3 object_irradiance(const ObjectSurroundings& light, glm::vec3 normal);
// Radiance to the eye (unit) of the sun of a sky, where nothing hides it.
glm::vec3 object_of_sun(const ObjectLook& look, const Sky& sky, glm::vec3 to_eye, glm::vec3 normal);
// Radiance to the eye of light from all round: the irradiance, and the mean radiance in the varnish's lobe.
glm::vec3 object_of_surroundings(const ObjectLook& look, float cosine, glm::vec3 irradiance,
                                 glm::vec3 mirrored);

// Radiance of a place in the water to an eye there, by the direction (unit) to the sun as the water shows it, what enters of the sun's
// irradiance on the level sea and what falls on it of the sky's, each times what water leaves of it down to there.
glm::vec3 object_in_water(const ObjectLook& look, glm::vec3 normal, glm::vec3 to_sun, glm::vec3 sun,
                          glm::vec3 sky);

// A facet of rough varnish, by the distribution of those that an eye sees (Heitz 2018): unit, as to_eye in axes whose z is the normal.
// disc: even in the unit disc.
glm::vec3 mirrored_facet(glm::vec3 to_eye, float roughness, glm::vec2 disc);
// Which part of the light that it mirrors comes to the eye, by the cosines of the eye to the facet and of the light to the normal. Its
// mean over such facets is object_reflectance().
float mirrored_by_facet(float facing_facet, float leaving, float roughness);
// The same by where light comes from (unit, in those axes): what of its radiance and solid angle comes to the eye, and how densely facets by
// an even disc mirror there [1/sr].
struct VarnishPart {
    float weight = 0.0f, density = 0.0f;
};
VarnishPart mirrored_by_varnish(glm::vec3 to_eye, glm::vec3 to_light, float roughness);
// What the varnish reflects of uniform light. cosine: of the view to the normal.
float object_reflectance(float cosine, float roughness);
// What level water mirrors, and where it refracts a ray that falls on it (unit) from the side of the normal.
float mirrored_by_level_water(float cosine);
glm::vec3 refracted_by_water(glm::vec3 ray, glm::vec3 normal);

}  // namespace pelagic
