// What evaluate() can be asked for in Python: the core's products, and what only persistent foam has
// (core/effects/foam_history.h). The same names as in meshes that are read back.
#pragma once

#include <array>
#include <bitset>
#include <cstddef>

#include "core/plan/products.h"

namespace pelagic::python {

struct OutputRow {
    const char* identifier;
    std::size_t components;  // of a point's value: 3, or 1
    const char* description;
};

inline constexpr std::size_t kFoamActive = kProductCount, kFoamAge = kProductCount + 1;

// The products first, in their own order.
inline constexpr auto kOutputs = [] {
    std::array<OutputRow, kProductCount + 2> rows{};
    for (std::size_t i = 0; i < kProductCount; ++i)
        rows[i] = {kProductTable[i].identifier, kProductTable[i].components, kProductTable[i].description};
    rows[kFoamActive] = {"foam_active", 1, "what of the coverage breaks now, 0 … 1"};
    rows[kFoamAge] = {"foam_age", 1,
                      "the mean age of the foam that is there, what breaks now counting as 0 [s]"};
    return rows;
}();

using OutputSet = std::bitset<kOutputs.size()>;

// Those that are the core's.
inline ProductSet products_of(const OutputSet& outputs) {
    return ProductSet(outputs.to_ullong() & ((1ull << kProductCount) - 1));
}

}  // namespace pelagic::python
