// The seas that the benchmarks compute: cascades whose frames hold whole squares of waves, nothing filtered.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "core/plan/plan.h"
#include "core/waves/frame.h"
#include "core/waves/sea.h"

namespace pelagic::bench {

inline constexpr double kSize_m = 400.0;
inline const ProductSet kEightFields = products(Product::Position, Product::Normal, Product::SlopeVariance,
                                                Product::Breaking);  // displacement, slopes, derivatives

inline constexpr double kUsualRatio = 4.23606797749979;  // the golden ratio cubed: that of "auto" cascades

struct OwnGrids {
    int n = 1024, cascades = 1;
    ProductSet products = kEightFields;
    double footprint_m = 0.0;
    double ratio = kUsualRatio;  // of a cascade's period to the next one's
};

// Each cascade (n × n, a period of 400 m, the next ones smaller by the golden ratio cubed) on its own
// lattice.
template <class T = float>
std::shared_ptr<const Sea<T>> sea_on_own_grids(const OwnGrids& wanted) {
    Scene scene;
    std::vector<Query> queries;
    double size_m = kSize_m;
    for (int c = 0; c < wanted.cascades; ++c, size_m /= wanted.ratio) {
        scene.waves.cascades.push_back({.size_m = size_m, .resolution = wanted.n});
        Query query;
        query.name = "cascade";
        query.products = wanted.products;
        query.cell_m = query.pixel_m = {wanted.footprint_m};
        query.points = static_cast<std::size_t>(wanted.n) * wanted.n;
        query.lattice = Lattice{-0.5 * size_m, size_m / wanted.n};
        query.only_cascade = c;
        queries.push_back(std::move(query));
    }
    return std::make_shared<const Sea<T>>(make_plan(scene, queries));
}

}  // namespace pelagic::bench
