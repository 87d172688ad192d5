// How a picture is computed in parts that stay near the caches, for the renderer and for what it will need.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/lighting/lighting.h"
#include "pelagic/scene.h"
#include "plugin/render/raster.h"
#include "plugin/render/ray_scene.h"
#include "plugin/render/sea_light.h"

namespace pelagic {

// Samples are pixels of a larger picture with cells as large as before.
inline Scene of_samples(const Scene& scene, int samples) {
    Scene sampled = scene;
    sampled.camera.resolution *= samples;
    sampled.surface.cell_px *= samples;
    return sampled;
}

// Samples that are computed at once: enough to keep all threads busy, little enough to stay near the caches.
inline constexpr int kBatch = 1 << 16;
inline constexpr std::size_t kShadeGrain = 256;  // samples a task shades

// Rows of samples that are computed at once: whole bands of the rasteriser that are whole rows of the picture.
inline int rows_of_batch(int sample_width, int samples) {
    const int rows_at_once = Rasteriser::kBandRows * samples;
    return std::max(1, kBatch / (rows_at_once * sample_width)) * rows_at_once;
}

// What the sea of a sample shows of bodies. By the facets that were looked at: the light that those mirror which mirror a body, the sky's
// that they would mirror without it, and the sky's of all of them. And what it shows more than that: of lamps, and through its surface more
// than without bodies.
struct BodiesInSea {
    glm::vec3 mirrored{0.0f}, hidden{0.0f}, sky{0.0f}, more{0.0f};
    BodiesInSea& operator*=(float share) {
        for (glm::vec3* of : {&mirrored, &hidden, &sky, &more}) *of *= share;
        return *this;
    }
};

// Drops before a sample, where deep pixels are asked for: the part that they leave, their light, and how far they are.
struct DropsBefore {
    float left = 1.0f, distance_m = 0.0f;
    glm::vec3 light{0.0f};
};

// What a batch of samples holds, by sample of the batch or by sample that shows the sea.
template <class T>
struct Batch {
    std::vector<std::uint32_t> triangles;  // by sample
    std::vector<PixelPlace> places;        // by sample; empty where all lie in their pixels' centres
    std::vector<SeaRadiance> radiance;     // by sample
    std::vector<float>
        veil;  // by sample: what spray and water that climbs the glass hide of the sky; empty where nobody asks
    std::vector<float> sea_m;         // by sample: how far the sea is; empty where nobody asks
    std::vector<DropsBefore> drops;   // by sample; likewise
    std::vector<std::uint8_t> under;  // by sample: it looks through water; empty where none may
    std::vector<double> glass_m;  // by sample: its height above the water at the camera's glass [m]; likewise
    std::vector<std::size_t> climbed;  // which samples look through what climbs the glass, rising
    std::vector<std::size_t> water;    // which samples show water without a surface, rising
    // Of shots with objects, otherwise empty, by sample: the body that it shows, the light from there, and what the sea shows of bodies.
    std::vector<RayHit> body;
    std::vector<glm::vec3> object;
    std::vector<BodiesInSea> in_sea;
    std::vector<std::size_t> sea;  // which samples show the sea, rising
    SeenSea<T> seen;               // from here on by entry of `sea`
    std::vector<SeaRadiance> lit;
    std::vector<glm::vec3> lamplight;     // where something glows; likewise
    std::vector<SeaRadiance> unlit;       // without the sun, where bodies hide it; likewise
    std::vector<std::uint8_t> in_shadow;  // whether they do
    std::vector<float> sun_share;         // how much of it they leave
};

}  // namespace pelagic
