// How many blocks of voxels a volume will hold, in expectation: known from the plan, before there is a sea.
#pragma once

#include "core/plan/plan.h"

namespace pelagic {

struct ExpectedSpray {
    double blocks = 0.0;  // of vdb::kBlock voxels a side
    double voxels = 0.0;  // in them that hold spray
};

// Of one frame's spray. A block's column has some where the Jacobian of the waves that break falls low enough at one of its
// voxels: the excursions of a Gaussian field into a square (Adler and Taylor 2007, the expected Euler characteristic), taken as
// independent of each other. Within 0.7 … 1.5 of what a frame has (test_volumes).
ExpectedSpray expected_spray(const Plan& plan);

// Of one frame's level set, in blocks: along the surface, which stands over a block as steeply as its slopes do on average, along the
// floor, and along the sides. Within 0.9 … 1.1 of what a frame has (test_volumes).
double expected_level_set_blocks(const Plan& plan);

}  // namespace pelagic
