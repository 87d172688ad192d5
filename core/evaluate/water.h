// The water above places of the world, for who has a frame.
#pragma once

#include <span>

#include "core/evaluate/surface_above.h"
#include "pelagic/ocean.h"

namespace pelagic {

inline constexpr ProductSet kWaterProducts =
    products(Product::Displacement, Product::Normal, Product::Velocity);

// As Ocean::water_at(), of a query that holds kWaterProducts and is prepared for them. footprint_m: that of cells and pixels
// [m]; 0: the query's first. `alone`: by the calling thread.
void water_at(const BoundsByLevel<float>& bounds, const PreparedQuery<float>& query,
              std::span<const glm::dvec2> places_m, float footprint_m, std::span<WaterState> water,
              bool alone = false);

}  // namespace pelagic
