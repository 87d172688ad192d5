// A bake: plan, sea, and then frame after frame into files.
//
//   DIR/NAME.usda, DIR/NAME.camera.usdc, DIR/NAME.sky.exr or NAME.sky.####.exr, DIR/mesh/…, DIR/maps/…, DIR/tiles/…, DIR/volumes/…, DIR/NAME.json
//
// plugin/run says which files are kept and how frames follow each other. bake_memory() says how much is held; a bake that
// needs more than there is is refused before it begins.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/plan/memory.h"
#include "core/plan/plan.h"
#include "core/scene/problem.h"
#include "pelagic/scene.h"
#include "plugin/run/run.h"

namespace pelagic {

// One being computed, one encoded, one written.
inline constexpr int kFramesInFlight = 3;

// What a bake of so many frames of the plan (plan_bake) holds at most, on so many threads.
MemoryNeed bake_memory(const Plan& plan, std::size_t frames, int threads);

// Of what the plan's files of each of these frames are made: made_of() (plugin/run/record.h).
std::vector<std::string> frames_made_of(const Plan& plan, std::span<const int> frames);

// Keys of a valid scene that pictures show and a bake refuses.
std::vector<Problem> unbaked_keys(const Scene& scene);

// Throws std::invalid_argument for a scene that bake() refuses.
void check_bake(const Scene& scene, const std::filesystem::path& out);

// Throws NotEnoughMemory before anything is written, as run(), and
// std::invalid_argument for a scene that problems_of() refuses or that asks for nothing.
RunReport bake(const Scene& scene, const RunOptions& options);

}  // namespace pelagic
