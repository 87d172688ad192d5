// The worst figure of a test, which it records for the bench's tables.
#pragma once

#include <cmath>

namespace pelagic::test {

// The larger one; what is no number stays, where std::max() would lose it.
inline double worse(double a, double b) {
    return std::isnan(a) || a > b ? a : b;
}

}  // namespace pelagic::test
