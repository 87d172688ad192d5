// The large drops of the spray as particles (core/plan/spray_drops.h): parcels of drops, torn off crests where waves break.
//
// A cell of the sea at rest has, in each interval of absolute time, as many parcels as break there beside the sea's mean. Hashes of
// cell, interval and number say where and when each starts and what it is like; the sea at the interval's beginning says how
// many, and from where. Then it flies in closed form: drag, linear, towards a wind that is its own for its life, and weight, so that
// it falls through that at its settling speed. It ends where it is back at the height of the sea at rest, or is kLongestLife_s old. So a
// drop depends on the scene, the square's cells and the time alone: a frame alone has the bits that it has in a run, and loops close.
//
// A parcel stands for many drops: its section is what they take of the light, and comes and goes with its age. The mean of
// all sections over area is the law's thickness (SprayDropsLaw), exactly in expectation, whatever lives parcels have: each has its
// share of section times life, the more the wider it is.
#pragma once

#include <atomic>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <map>
#include <memory>
#include <vector>

#include "core/evaluate/hulls.h"
#include "core/plan/spray_drops.h"
#include "core/waves/frame.h"

namespace pelagic {

struct SprayDrop {
    glm::dvec3 position_m{0.0};    // in the world
    glm::dvec3 velocity_mps{0.0};  // its derivative
    double width_m = 0.0;          // across the parcel, > 0
    double section_m2 = 0.0;       // extinction, > 0
    std::int64_t id =
        0;  // 0 … 2^53 − 1, the same at all times; in loops longer than a life no two share one but by chance

    // Of a disc of that width that hides as much.
    double opacity() const;
};

template <class T>
class SprayDrops {
  public:
    // Of that sea's scene and plan, over squares with this side [m]. Throws BuildCancelled.
    SprayDrops(const Sea<T>& sea, double size_m, const BuildWatch& watch = {});
    ~SprayDrops();

    // None in any square: where the scene has no such drops, and where no wave breaks.
    bool empty() const { return !(per_m2_ > 0.0); }
    const SprayDropsPlan& plan() const { return plan_; }

    // What is in the air at a time over a square round this place of the world, by cell and interval. On all threads of the
    // calling arena; the same bits whatever their number. Throws BuildCancelled.
    void at(double time_s, glm::dvec2 middle_m, std::vector<SprayDrop>& drops,
            const std::atomic<bool>* cancel = nullptr);

  private:
    struct Parcel;
    struct Cells {
        std::int64_t x = 0, y = 0, columns = 0, rows = 0;
        bool operator==(const Cells&) const = default;
    };

    Cells cells_round(glm::dvec2 middle_m) const;
    std::int64_t within_loop(std::int64_t interval) const;
    std::vector<Parcel> made(std::int64_t interval, const Cells& cells, const std::atomic<bool>* cancel);
    // Those that would start in a hull.
    void leave_out_of_hulls(std::vector<Parcel>& parcels, double time_s);
    Parcel started(std::int64_t interval, glm::i64vec2 cell, int number, double weight) const;

    SprayDropsPlan plan_;
    double size_m_ = 0.0,
           per_m2_ =
               0.0;  // the latter: section times seconds of life of a square metre's parcels of a second
    double mean_breaking_ = 0.0;
    std::uint64_t seed_ = 0;
    glm::dvec2 downwind_{1.0, 0.0};
    double wind_mps_ = 0.0, friction_mps_ = 0.0;  // where drops fly
    std::vector<double> settling_mps_;            // of drops that each stand for as much
    std::unique_ptr<Frame<T>> frame_;
    std::unique_ptr<Hulls> hulls_;  // none where the plan has none
    Cells cells_;
    std::map<std::int64_t, std::vector<Parcel>> known_;  // by interval, of these cells
};

}  // namespace pelagic
