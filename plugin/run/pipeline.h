// Items that pass three stages, different items side by side, in a fixed number of places.
//
//   compute   on the calling thread, one item after another, rising; parallel inside
//   encode    on the threads of the calling TBB arena, several items side by side
//   write     on a thread of its own, one item after another, rising: it waits for a disk, and holds none of
//             TBB's threads meanwhile
//
// Knows nothing of what the items are.
#pragma once

#include <functional>

namespace pelagic {

// Each is called once an item, with the item's number from 0 and its place. What one throws ends the
// pipeline.
struct PipelineStages {
    std::function<void(int item, int place)> compute, encode, write;
    std::function<void(int item)> written{};  // told on the calling thread, rising; may be empty
};

// Measured from the call to the end [s]. A stage is busy while it works on one item or more; stages that
// share the cores slow one another.
struct PipelineTimes {
    double wall_s = 0.0;
    double compute_busy_s = 0.0, encode_busy_s = 0.0, write_busy_s = 0.0;
    double waiting_for_write_s = 0.0;   // nothing could be computed or encoded before a place was written
    double waiting_for_encode_s = 0.0;  // nothing was there to be written
};

// Item i is in place i mod `places` from its computing until it is written: no more items than places are
// under way, and a place's memory is its item's alone. places ≥ 1; with one, nothing overlaps but an item's
// own work. While a place is awaited the calling thread encodes that place's item, too, and then sleeps.
//
// When a stage throws, the items before are still written, none after, and the exception passes through when
// all threads have ended: always the one of the lowest item. What `written` throws passes through as well,
// and nothing more is begun.
PipelineTimes run_pipeline(int items, int places, const PipelineStages& stages);

}  // namespace pelagic
