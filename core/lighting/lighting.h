// The light that the sea sends to the eye: Bruneton, Neyret, Holzschuch 2010 with the whitecaps of Dupuy and
// Bruneton 2012. The formulas are in this folder's *.glsl files. C++ includes them, and the preview passes
// the same text to OpenGL. This header is the batch interface for C++.
#pragma once

#include <cstddef>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>

#include "core/lighting/floor.h"
#include "core/lighting/foam_structure.h"
#include "core/lighting/sky.h"
#include "core/lighting/water.h"

namespace pelagic {

// How the sky's reflection is computed. Accuracy and time: `pelagic accuracy --rows sky`.
enum class SkyQuality {
    One,       // one lookup, filtered over an ellipse (Eq. 22, 27)
    Nine,      // nine lookups, at the nodes of a quadrature over the visible slopes
    Integral,  // the integral of Eq. 20 over the slopes, with visibility: the reference
};
enum class FresnelFit {
    Paper,  // Eq. 26, the mean of Schlick's approximation
    Exact,  // our fit of the mean of the exact unpolarised term
};

// A variant: which terms are on, and how they are computed. A term that is off costs no more than asking whether it is on;
// in GLSL, which is compiled for each variant with constants, not even that.
struct LightingChoice {
    bool sun = true, sky = true, water = true, whitecaps = true;
    bool air = true;  // between eye and sea (air.h): shade_sea() itself knows no distance, see_through() does
    bool spray = false;  // likewise (spray.h), where the scene has it
    SkyQuality sky_quality = SkyQuality::Nine;
    FresnelFit fresnel = FresnelFit::Exact;
    bool second_reflection = true;  // of what facets mirror onto the sea; without it that light is lost
    bool mesh_masking =
        true;  // normals lean to the eye as those of resolved waves do (SeaPoint::mesh_variance)
    bool operator==(const LightingChoice&) const = default;
};

// Radiance towards the eye by source: reflected sun, reflected sky, light from the water, foam, and what the air before
// them adds (air.h), and the spray (spray.h). Each is weighted by its share of the pixel already; their sum is the radiance.
struct SeaRadiance {
    glm::vec3 sun{0.0f}, sky{0.0f}, sea{0.0f}, foam{0.0f}, air{0.0f};
};

// A pixel of sea.
struct SeaPoint {
    glm::vec3 to_eye{0.0f, 0.0f, 1.0f};  // unit
    glm::vec3 normal{0.0f, 0.0f, 1.0f};  // unit, of the resolved waves; may face away from the eye
    // (σxx, σyy, σxy) of the unresolved waves [-], world axes: as the resolved waves carry them, and at rest.
    glm::vec3 slope_variance{0.0f}, slope_variance_at_rest{0.0f};
    float coverage = 0.0f;  // of whitecaps, 0 … 1
    // Unit: the vertical at the point, in the axes of to_eye and of the sky. Normal and slope variance are relative to it.
    glm::vec3 up{0.0f, 0.0f, 1.0f};
    // Variance of the slopes that the mesh leaves unresolved, at rest, along the view's horizontal direction;
    // slope_variance_at_rest is what the normal, which is finer than the mesh, leaves unresolved of these
    // (visible_normal() in slopes.glsl). 0: the mesh is as fine.
    float mesh_variance = 0.0f;
    // For the pattern of foam: the place at rest [m], relative to the pattern's origin, and the pixel there, its
    // width and long axis [m]; the part of the
    // coverage where waves break now (no more than all of it counts), and since when the rest is there.
    glm::vec2 rest_m{0.0f};
    glm::vec3 pixel_m{0.0f};
    float active = 1.0f;
    float age_s = 0.0f;
    glm::vec3 from_eye_m{0.0f};  // in the eye's axes, for the floor below
    // Of the waves longer than kCrestFootprint_m's, for light through crests: slopes and height above the sea at rest [m].
    glm::vec3 crest{0.0f};
    // What earlier breaking has left of the bubbles, of 1 where all breaks; negative where nobody knows: then by what is left of the foam and its age.
    float bubbles = -1.0f;
};
// The footprint at which SeaPoint::crest is asked for [m]: ripples don't bend the light's way through a crest.
inline constexpr double kCrestFootprint_m = 1.0;

// The sea as a diffuse surface, linear Rec. 709, for hosts that bring their own optics: the share of the
// irradiance of a diffuse sky that leaves again, ideally diffuse.
struct SeaAlbedo {
    // Through the surface, into the water and up to the surface again (water.glsl). The factor (1 − F) of the
    // way out, which depends on the eye, is the host's, and so is what the surface itself reflects.
    glm::vec3 water{0.0f};
    glm::vec3 foam{0.0f};      // of covered area, of all ages (foam.glsl)
    float water_index = 1.0f;  // of refraction, for that surface
};
SeaAlbedo sea_albedo(const WaterBody& water);

// What a body sends back of the light of a uniform sky, with its floor, just below the surface and seen from above, as a diffuse
// reflectance: what hosts with one colour of water take for it. 0 … 1, linear Rec. 709.
glm::vec3 body_reflectance(const WaterBody& water);

// The part of light from a direction (unit; below the horizon as at it) that the surface lets into the water, 0 … 1: a rough one of a body, a
// level one otherwise.
float water_entering(const WaterBody& water, glm::vec3 from);

// A colour's values at the wavelengths of water, 0 … 1 (water.glsl).
WaterBands bands_of(const glm::vec3& colour);

// The light from the water at points as that of a diffuse surface, for hosts that light the sea themselves: of the irradiance of sun and sky
// on a level plane the share that leaves again, before the factor (1 − F) of the way out; 0 … 1, 0 in the dark. It counts to_eye,
// normal and crest, and coverage, active and age_s for the bubbles under foam; on level water, without the foam itself. Throws as
// shade_sea() for spans of different lengths.
void water_albedo(const Sky& sky, const WaterBody& water, std::span<const SeaPoint> points,
                  std::span<glm::vec3> albedo);

struct Air;

// Writes radiance[i] for points[i], on the calling thread. air: before the eye below which `sky` is; points whose sun is
// another one have their own light (place.glsl). Without it all have that of `sky`. foam: the pattern that their rest_m are
// relative to; without it foam is smooth. floor: as the eye sees it; without it, it is level and evenly lit. Each depends on its point and the arguments alone,
// and is finite for finite points. Throws std::invalid_argument if the spans differ in length, or if
// choice.sky is on and the sky has no map.
void shade_sea(const LightingChoice& choice, const Sky& sky, const WaterBody& water,
               std::span<const SeaPoint> points, std::span<SeaRadiance> radiance, const Air* air = nullptr,
               const FoamPattern& foam = {}, const FloorSeen& floor = {});

// A facet of the sea at a point: where the light comes from that it mirrors to the eye (unit, in the axes of to_eye), and which part of it
// the eye sees. Of facets that mirror downwards, 0.
struct MirroredLight {
    glm::vec3 from{0.0f, 0.0f, 1.0f};
    float weight = 0.0f;
};
// The facets that shade_sea() integrates the sky over at a point (the integral of SkyQuality::Integral), for light that no map of the sky
// has. Foam hides its share.
class SeaFacets {
  public:
    SeaFacets(const LightingChoice& choice, const Sky& sky, const SeaPoint& point,
              const FoamPattern& foam = {});

    // One of `count` facets: the sum of weight times radiance is an estimate of what the eye sees of it, without bias where their places are
    // spread over the unit square evenly, each in its own part of x: 1/count as wide.
    MirroredLight mirrored(glm::vec2 place, std::size_t count) const;

    // The same by where light comes from, for lights so small that few facets find them.
    struct Part {
        float weight = 0.0f;   // times radiance and solid angle it is what the eye sees [1/sr]
        float density = 0.0f;  // of mirrored()'s directions, for each facet [1/sr]
    };
    // direction: unit, in the axes of to_eye. spread: standard deviation of slopes that is added for the weight, as of a light so wide.
    Part from(const glm::vec3& direction, float spread = 0.0f) const;

  private:
    static constexpr float kFarthest = 4.0f;             // deviations
    glm::vec3 up_, x_, y_, normal_, variance_, to_eye_;  // the facets' frame, and the eye in it
    glm::vec2 along_, across_;
    float height_, along2_, area_;  // MaskedView's
    float clear_, first_, all_;
};

// As shade_sea() for an eye in a body of water, at this height above the sea at rest [m], that sees the points from below at these distances
// [m] through the water. `sea` has what the water between scatters.
void shade_sea_from_below(const LightingChoice& choice, const Sky& sky, const WaterBody& water,
                          float height_m, std::span<const SeaPoint> points, std::span<const float> distance_m,
                          std::span<SeaRadiance> radiance, const FoamPattern& foam = {},
                          const FloorSeen& floor = {});

// What such an eye sees in these directions (unit) where they don't meet the surface: the water, and its floor.
void shade_water(const LightingChoice& choice, const Sky& sky, const WaterBody& water, float height_m,
                 std::span<const glm::vec3> direction, std::span<SeaRadiance> radiance,
                 const FloorSeen& floor = {});

// The part of the light of what is this far away [m], ≥ 0, that comes to such an eye from there: 0 … 1, linear Rec. 709.
glm::vec3 water_lets_through(const WaterBody& water, float distance_m);

}  // namespace pelagic
