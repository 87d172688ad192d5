// The pattern of the sun's light that waves mirror onto a body: caustics (plugin/light/caustics.h) on level planes above the water.
#pragma once

#include <atomic>
#include <cstddef>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <vector>

#include "core/waves/frame.h"
#include "plugin/light/caustics.h"

namespace pelagic {

// Of which sun, over which box: its middle, relative to the sea's origin, and halves of its edges [m]. Heights count from the water at it, level_m
// over the sea at rest.
struct MirroredSunWanted {
    SunThroughWaves sun;
    glm::dvec3 middle_m{0.0};
    glm::dmat3 half_edges_m{0.0};
    double level_m = 0.0;
    double finest_m = 0.0, finest_cell_m = 0.0;  // footprints below which nothing is looked for
    bool operator==(const MirroredSunWanted&) const = default;
};

class MirroredSun {
  public:
    // Of a frame that is set; of its query 0. All threads of the calling arena. Throws BuildCancelled.
    template <class T>
    void find(const Frame<T>& frame, MirroredSunWanted wanted, const std::atomic<bool>* cancel);
    // None, which is even.
    void clear();
    // The light on an upright wall over its mean, at a place [m] as the box's middle is.
    float at(const glm::dvec3& place_m) const;
    // At most, and of what finding one holds meanwhile [bytes].
    static std::size_t bytes();
    static std::size_t finding_bytes();

  private:
    // Where the light of a level sea falls, relative to a plane: a place on others follows that light's way.
    struct Plane {
        double height_m = 0.0;
        glm::dvec2 from_m{0.0};  // along and left of the sun's way
        double texel_m = 1.0;
        int side = 0;
        std::vector<float> texels{};
        float at(const glm::dvec2& place_m) const;
    };

    std::vector<Plane> planes_;  // by rising height
    glm::dvec2 way_{0.0}, along_{1.0, 0.0};
    float share_ = 0.0f;  // of the pattern that shows
    std::optional<MirroredSunWanted> found_;
    const void* frame_ = nullptr;
    long times_set_ = 0;
};

}  // namespace pelagic
