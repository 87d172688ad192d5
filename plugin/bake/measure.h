// What each effect and output of a shot adds to a frame: the frame with it less the frame without it.
//
// Transforms and bytes are differences of two plans, exact and at once. Times are medians of differences: one
// frame with and one without, again and again, so that a machine that slows down slows both. Work that two
// outputs share is in neither's row, and the rows add up to the whole only where nothing is shared.
//
// Two seas are held at a time, the shot's and the one without the item at hand.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/plan/plan.h"
#include "pelagic/scene.h"

namespace pelagic {

// A plan's price, or the difference of two.
struct PlanCost {
    std::int64_t transforms = 0, lines = 0;  // a frame, beside those of its foam's history
    std::int64_t sea_bytes = 0;
    std::int64_t frame_bytes = 0;  // with its foam's history
    std::int64_t output_bytes = 0;
};
PlanCost cost_of(const Plan& plan);
PlanCost operator-(const PlanCost& a, const PlanCost& b);

// An effect or output, and the shot without it.
struct MeasureItem {
    std::string name;  // "mesh", "mesh normal", "map normal", "tiles", "whitecaps", …
    Scene without;
};
// Those of the shot, in the order of the plan's tables: the mesh with all that is on it, each of its
// attributes, each map with its tiles, the tiles, the effects.
std::vector<MeasureItem> measure_items(const Scene& scene);

// Whether both bakes compute the same numbers.
bool same_work(const Plan& a, const Plan& b);

struct Milliseconds {
    double median = 0.0, spread = 0.0;  // spread: half of what holds the middle half of the values
};

struct Measured {
    std::string name;
    PlanCost cost{};
    // As a bake does it: the sea set to the frame's time, all points, the sums of the record; and its files'
    // bytes, but for a crate, which has none but the values.
    Milliseconds compute{}, encode{};
    int pairs = 0;  // of computed frames; 0: nothing changes, and nothing was measured
};

struct MeasureProgress {
    std::string name{};  // of the item at hand
    int item = 0, items = 0;
    double seconds_left = 0.0;  // about
};

struct MeasureOptions {
    // Half for computing and half for encoding, if there are enough pairs by then; building the sea comes on
    // top.
    double seconds_an_item = 2.0;
    int least_pairs = 4, most_pairs = 24;
    std::function<void(const MeasureProgress&)> progress;  // may be empty
    std::function<void(const Measured&)> measured;         // each item as soon as it is known; may be empty
};

// The most bytes that measure() holds on so many threads, about: both seas, frames, results and encoded files.
std::size_t measure_bytes(const Scene& scene, int threads);

// The whole shot, after each of its items. The scene must be valid. Throws std::bad_alloc.
Measured measure(const Scene& scene, const MeasureOptions& options);

}  // namespace pelagic
