// A budget instead of knobs: quality.max_error or quality.frame_ms, turned into ordinary keys before anything is planned.
//
// What a mesh misses is known from the spectrum (mesh_error_model.h), what reading between the nodes adds is recorded, and what a
// frame costs follows from its plan (cost_model.h): the choice is arithmetic, alike on every machine.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/plan/prepared_scene.h"
#include "core/scene/scene.h"

namespace pelagic {

bool has_budget(const Quality& quality);
Scene without_budget(Scene scene);
// The scene with the keys that its budget asks for, as prepare() has it; the scene itself without a budget. It must be valid.
// Throws std::invalid_argument, saying what comes nearest, where nothing holds the budget.
Scene settled(Scene scene);

// "quality.max_error = 0.01: the cheapest", or "…, which nothing holds: the most accurate".
std::string text_of_budget(const Quality& quality, bool holds);

// The settings that a mesh's budget asks for: quality.level, and how fine the surface is, whatever the shot says of both.
struct MeshBudget {
    Scene scene;  // with them, and without a budget
    double error =
        0.0;  // expected RMS distance from the sea over Hs; of a mesh for a camera, from what its pixels show
    double ms = 0.0;     // of a frame, by the cost model
    bool holds = true;   // false: nothing holds the budget, and these settings come nearest
    std::string text{};  // for people: what was chosen, and why
};

// Of a valid scene with a budget. max_error: the cheapest settings that err by no more; frame_ms: the most accurate ones that
// cost no more. A patch or near-far mesh gets another surface.resolution, a projected grid, planet or adaptive cage another
// surface.cell_px, other cages another surface.cage_level; a scene that bakes no mesh only another level.
MeshBudget mesh_budget(const PreparedScene& prepared);

// The surfaces that mesh_budget() chooses from, from coarse to fine; of those that aren't even grids only the ones of up to two
// million points.
std::vector<Surface> rising_fineness(const Scene& scene);

}  // namespace pelagic
