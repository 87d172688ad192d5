// What the hulls of a shot's objects ask of the sea: where its water is that meets them, and how fast.
#pragma once

#include <optional>
#include <set>
#include <string>

#include "core/plan/outputs.h"
#include "core/plan/query.h"
#include "pelagic/scene.h"

namespace pelagic {

struct Plan;

// Positions and velocities, with the footprints that hulls have of them, as a picture's levels are: round the floating_cell_m() of what floats,
// and contact_level_m() where somebody asks who has no places or velocities of its own. None where nobody asks.
std::optional<Query> hulls_query(const Scene& scene, bool has_places);
// Of pictures: where hulls have foam, and of all that floats, so that it is where it is whatever else a picture shows.
std::optional<Query> hulls_query_of_picture(const Scene& scene);
// Of these footprints [m]; none without any.
std::optional<Query> hulls_query(const std::set<double>& footprints_m);
// Its number in a plan that has it.
std::optional<int> hulls_query(const Plan& plan);
// Whether the plan's scene has hulls, and a frame of the plan knows where all of them are.
bool knows_hulls(const Plan& plan);

// The footprint of the water along a hull whose foam is so wide [m].
double contact_level_m(double foam_m);

// Of the knobs, what a query's answers about hulls have: which levels there are changes none of them.
std::string hulls_text(const Plan& plan);

// Whether what it holds is of the surface itself: meshes, whitecaps, volumes, drops.
bool may_meet_hulls(const PlannedOutput& output);

}  // namespace pelagic
