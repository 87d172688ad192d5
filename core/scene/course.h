// The paths of waves.vessels, as text and in the sea's time.
#pragma once

#include <cstddef>
#include <glm/vec2.hpp>
#include <optional>
#include <string_view>
#include <vector>

#include "pelagic/scene.h"

namespace pelagic {

// A place of a vessel's middle, as waves.vessels[].path says it.
struct CourseKey {
    double frame = 0.0, east_m = 0.0, north_m = 0.0;
};
// "1 0 0, 48 20 5": a frame and a place each. None for a text that isn't one: `wrong` is then the first key that isn't, from 0.
std::optional<std::vector<CourseKey>> course_of(std::string_view path, std::size_t* wrong = nullptr);

// Where a vessel is. Before its first key it comes along its first course at its first speed, after the last it goes on along the last.
struct VesselPath {
    struct Key {
        double time_s = 0.0;
        glm::dvec2 place_m{0.0}, velocity_mps{0.0};
    };
    std::vector<Key> keys;  // at least two, by rising time
    bool is_smooth = false;

    glm::dvec2 at(double time_s) const;
    glm::dvec2 velocity_mps(double time_s) const;
    double fastest_mps() const;  // between its keys, nearly
    double slowest_mps() const;

  private:
    std::vector<double> speeds_mps() const;  // between its keys
    template <class Linear, class Cubic>
    glm::dvec2 on(double time_s, Linear linear, Cubic cubic) const;
};
// In the time of a shot's sea; no keys where the text is no path.
VesselPath path_of(const Shot& shot, const Vessel& vessel);

}  // namespace pelagic
