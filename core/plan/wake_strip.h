// The turbulent wake of a vessel: a strip behind its stern where foam lies and short waves are damped, and the foam of its bow. All of it
// by eye but for its form: as wide as (1 + x/x₀)^(1/5) at the way x from the stern (what is recalled of Milgram and others 1993;
// self-propelled bodies are said to have that and 1/4), foam that fades with its age, in a few seconds where it breaks and in a minute and a half what
// the propeller beat in. A function of the path and the time alone. Only the nearest piece of the path counts: where a vessel crosses its
// own wake, the older one ends at the line between the two.
#pragma once

#include <glm/vec2.hpp>
#include <vector>

#include "core/base/number.h"
#include "core/plan/filter.h"
#include "core/plan/vessels.h"

namespace pelagic {

#include "core/plan/wake_strip.inl"

class WakeStrip {
  public:
    WakeStrip(const VesselPlan& plan, double time_s);

    // Through a pixel of this footprint [m].
    WakeWater<double> at(glm::dvec2 place_m, double footprint_m) const;
    // Whether any of it reaches into a rectangle.
    bool reaches(glm::dvec2 low_m, glm::dvec2 high_m) const;

    // From the bow: where, how far along the path, how long ago the vessel's middle was there, and how fast it was, of a speed that
    // makes foam.
    struct Point {
        glm::dvec2 place_m{0.0};
        double way_m = 0.0, age_s = 0.0, strength = 0.0;
    };
    // Round some and all that they reach.
    struct Box {
        glm::dvec2 low_m{0.0}, high_m{0.0};
        bool holds(glm::dvec2 at_m) const {
            return at_m.x >= low_m.x && at_m.y >= low_m.y && at_m.x <= high_m.x && at_m.y <= high_m.y;
        }
    };
    static constexpr int kMostPoints = 160;
    static constexpr int kBoxSteps = 8;  // from point to point, in a box
    const WakeHull<double>& hull() const { return hull_; }
    const std::vector<Point>& points() const { return points_; }
    const std::vector<Box>& boxes() const { return boxes_; }
    const Box& whole() const { return whole_; }
    double reach_m() const { return reach_m_; }  // from the path: beyond it there is none

  private:
    WakeHull<double> hull_;
    double reach_m_ = 0.0;
    std::vector<Point> points_;
    std::vector<Box> boxes_;
    Box whole_;
};

}  // namespace pelagic
