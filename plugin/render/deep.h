// Deep pixels: what a pixel shows by its distance, so that another program can put things between.
//
// A pixel is a list of samples from the nearest on. Each has the alpha, and the light times alpha, that it would have alone: laid over each
// other they are the picture's pixel with its alpha. Of a pixel in which so much is seen of each, a sample's alpha is its share of what those
// before it leave.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

namespace pelagic {

struct DeepSample {
    glm::vec3 light{0.0f};
    float alpha = 0.0f;
    float z_m = 0.0f, z_back_m = 0.0f;  // along the view's axis; alike: a surface, otherwise an even veil
    float id = 0.0f;                    // matte_id() of what is there; 0: spray
};

// Of a whole picture, rows from the top, x fastest: how many samples each pixel has, and all of these.
struct DeepPixels {
    std::vector<std::uint32_t> counts;
    std::vector<DeepSample> samples;
};

// What one of a pixel's places shows, as parts of the pixel: a surface, and the veil before it.
struct DeepSight {
    float id = 0.0f;
    float z_m = 0.0f;    // of what ends the veil, seen or held out
    float alpha = 0.0f;  // of the surface; 0: none is seen
    glm::vec3 light{0.0f};
    float veil = 0.0f;
    glm::vec3 veil_light{0.0f};
};

// Surfaces of one kind are one sample as far as this share of their distance apart; and so many are a pixel's at most,
// or as many as it has kinds.
inline constexpr float kDeepNear = 0.01f;
inline constexpr std::size_t kMostDeepSurfaces = 8;
// The veil is cut where surfaces are, and at 2 m, 8 m, 32 m … 8192 m. A part that hides less than this joins what comes next.
inline constexpr std::size_t kVeilCuts = 7;
inline constexpr float kLeastVeil = 5e-4f;

// Adds a pixel's samples, in rising distance and none across another. hides: which part of what lies at a distance along the view's axis
// the veil hides, at the pixel's middle: it says where the veils of all places are thick, not how much they hide.
// Returns how many.
std::uint32_t add_deep_pixel(std::span<const DeepSight> sights, const std::function<float(float z_m)>& hides,
                             std::vector<DeepSample>& to);

// At most, of a pixel whose places show so many sights.
std::size_t most_deep_samples(std::size_t sights, std::size_t objects, bool has_veil);

}  // namespace pelagic
