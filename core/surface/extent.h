// How far the sea's surface moves from rest, in expectation [m]: a view must look so far beyond its border.
#pragma once

#include "core/surface/unresolved_height.h"

namespace pelagic {

// All 0 for a calm. Of a spectrum: expected_extent() (plan/extent.h).
struct Extent {
    double height_m = 0.0;              // |z|
    double reach_m = 0.0;               // of the horizontal displacement, choppiness included
    double significant_height_m = 0.0;  // Hs = 4 √m0
    UnresolvedHeight unresolved{};      // by the length of a mesh's cells

    bool operator==(const Extent&) const = default;
};

}  // namespace pelagic
