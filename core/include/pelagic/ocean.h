// The water above a place of the world: its height, normal and velocity, for one float or a thousand.
//
//   pelagic::Scene scene;
//   pelagic::Ocean ocean(scene);
//   ocean.set(1.5);
//   const pelagic::WaterState water = ocean.water_at({3.0, -8.0});
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <span>

#include "pelagic/scene.h"
#include "pelagic/version.h"

namespace pelagic {
inline namespace PELAGIC_VERSION_NAMESPACE {

struct WaterState {
    float height_m = 0.0f;               // z; the sea at rest is at 0
    glm::vec3 normal{0.0f, 0.0f, 1.0f};  // unit; z < 0 where the highest sheet is turned over
    glm::vec3 velocity_mps{0.0f};        // of the water at that height; a second is one of the sea's time
};

class Ocean {
  public:
    // The sea of the scene, at its time 0. footprint_m: about the width of what floats; waves shorter than twice that are left
    // out. 0: the spacing of the scene's patch. Takes from a tenth of a second up. Throws std::invalid_argument for a scene or a
    // footprint that isn't accepted.
    explicit Ocean(const Scene& scene, double footprint_m = 0.0);
    ~Ocean();
    Ocean(Ocean&&) noexcept;
    Ocean& operator=(Ocean&&) noexcept;

    // The sea at any time [s]. Milliseconds. Nobody may ask meanwhile. Throws std::invalid_argument for a time that isn't
    // accepted (further than 1e12 s from 0, or none).
    void set(double t_s);

    // The water above places (x, y) of the world [m], within 1e9 m. Waves move water to the side: the point at rest that is displaced
    // to the place is found by iteration, to a millimetre but for a few places of a sea that folds much. Where the surface has folded over itself its highest sheet counts.
    // Each place's answer depends on nothing but the place and the time, and is finite. Any number of threads may ask at
    // once; many places are shared among the threads of the calling arena. Throws std::invalid_argument for what is no place, and
    // where `water` isn't as long as the places.
    WaterState water_at(glm::dvec2 place_m) const;
    void water_at(std::span<const glm::dvec2> places_m, std::span<WaterState> water) const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};
}  // namespace PELAGIC_VERSION_NAMESPACE
}  // namespace pelagic
