// What a frame of a shot costs by its plan: what `pelagic explain --json` says, and `pelagic farm` cuts tasks by.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>

#include "core/plan/memory.h"
#include "core/plan/plan.h"
#include "plugin/budget/cost.h"
#include "plugin/render/render.h"

namespace pelagic::cli {

struct FrameAccount {
    double seconds = 0.0;          // of computing it in a run; encoding and writing come on top
    std::size_t bytes = 0;         // of its files' values, before they are compressed
    std::size_t memory_bytes = 0;  // of the run, on so many threads
};

// The recorded rates, which are of two cores, on so many: as if each did its share.
Rates rates_on(int threads);

// Of a plan of a bake (plan_bake) of so many frames.
FrameAccount bake_account(const Plan& plan, int frames, int threads, const Rates& rates);
FrameAccount picture_account(const Scene& scene, const RenderOptions& options, int threads,
                             const Rates& rates);

nlohmann::ordered_json json_of(const FrameAccount& account);
// "takes about 0.12 s of computing and 3.4 MiB in its files, before they are packed".
std::string text_of(const FrameAccount& account);

}  // namespace pelagic::cli
