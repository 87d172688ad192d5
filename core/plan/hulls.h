// What the hulls of a shot's objects ask of the sea: where its water is that meets them, and how fast.
#pragma once

#include <optional>

#include "core/plan/outputs.h"
#include "core/plan/query.h"
#include "pelagic/scene.h"

namespace pelagic {

struct Plan;

// Positions and velocities, with the footprints that hulls have of them: contact_level_m(), and for what floats those round its
// floating_cell_m(), as a picture's levels are. None without a hull that keeps water out.
std::optional<Query> hulls_query(const Scene& scene);
// Its number in a plan that has it.
std::optional<int> hulls_query(const Plan& plan);

// The footprint of the water along a hull whose foam is so wide [m].
double contact_level_m(double foam_m);

// Whether what it holds is of the surface itself: meshes, whitecaps, volumes, drops.
bool may_meet_hulls(const PlannedOutput& output);

}  // namespace pelagic
