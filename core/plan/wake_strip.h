// The turbulent wake of a vessel: a strip behind its stern where foam lies and short waves are damped, and the foam of its bow. All of it
// by eye but for its form: as wide as (1 + x/x₀)^(1/5) at the way x from the stern (what is recalled of Milgram and others 1993;
// self-propelled bodies are said to have that and 1/4), foam that fades with its age, in a few seconds where it breaks and in a minute and a half what
// the propeller beat in. A function of the path and the time alone. Only the nearest piece of the path counts: where a vessel crosses its
// own wake, the older one ends at the line between the two.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/vec2.hpp>
#include <limits>
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
    WakeWater<double> at(glm::dvec2 place_m, double footprint_m) const {
        return at(place_m, footprint_m, near(place_m, place_m), Wanted::Foam);
    }
    // Calls use(i, water) for some of the `count` places place_of(i), among them all where there is some of what is wanted. Neighbours
    // share the search for what is near; places that lie far apart have none. What a place gets depends on no other.
    enum class Wanted { Foam, Calm };
    template <class PlaceOf, class FootprintOf, class Use>
    void for_each(Wanted wanted, std::size_t count, const PlaceOf& place_of, const FootprintOf& footprint_of,
                  const Use& use) const {
        constexpr std::size_t kNeighbours = 16;
        for (std::size_t first = 0, end = 0; first < count; first = end) {
            end = std::min(first + kNeighbours, count);
            glm::dvec2 low_m(std::numeric_limits<double>::infinity()), high_m = -low_m;
            std::array<glm::dvec2, kNeighbours> places_m;
            std::array<std::size_t, kNeighbours> of;
            std::size_t within = 0;
            for (std::size_t i = first; i < end; ++i) {
                const glm::dvec2 place_m = place_of(i);
                if (!whole_.meets(place_m, place_m)) continue;  // nor does what is no number
                low_m = glm::min(low_m, place_m);
                high_m = glm::max(high_m, place_m);
                places_m[within] = place_m;
                of[within++] = i;
            }
            if (within == 0) continue;
            const glm::dvec2 size_m = high_m - low_m;
            const bool is_shared = std::max(size_m.x, size_m.y) <= kSharedReaches * reach_m_;
            Pieces pieces;
            if (is_shared) pieces = near(low_m, high_m);
            for (std::size_t p = 0; p < within; ++p) {
                if (!is_shared) pieces = near(places_m[p], places_m[p]);
                if (pieces.count > 0) use(of[p], at(places_m[p], footprint_of(of[p]), pieces, wanted));
            }
        }
    }

    // From the bow: where, how far along the path, how long ago the vessel's middle was there, how fast it was, of a speed that
    // makes foam, and half the strip's width.
    struct Point {
        glm::dvec2 place_m{0.0};
        double way_m = 0.0, age_s = 0.0, strength = 0.0, half_m = 0.0;
    };
    // Round some and all that they reach.
    struct Box {
        glm::dvec2 low_m{0.0}, high_m{0.0};
        bool meets(glm::dvec2 from_m, glm::dvec2 to_m) const {
            return from_m.x <= high_m.x && from_m.y <= high_m.y && to_m.x >= low_m.x && to_m.y >= low_m.y;
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
    // Of a larger rectangle, in reaches, so many pieces are near that each place's own search is cheaper, as measured.
    static constexpr double kSharedReaches = 6.0;
    // Of the path, by their first points.
    struct Pieces {
        std::array<std::uint8_t, kMostPoints> of;
        std::size_t count = 0;
    };
    // How far a place is off a piece, squared, and where along the piece it is nearest.
    struct Off {
        double square_m2, share;
    };
    Off off(std::size_t piece, glm::dvec2 place_m) const;
    // Of a rectangle: among them is the nearest one of any place in it that the wake reaches.
    Pieces near(glm::dvec2 low_m, glm::dvec2 high_m) const;
    WakeWater<double> at(glm::dvec2 place_m, double footprint_m, const Pieces& pieces, Wanted wanted) const;

    WakeHull<double> hull_;
    double reach_m_ = 0.0;
    std::vector<Point> points_;
    std::vector<Box> boxes_;
    Box whole_;
};

}  // namespace pelagic
