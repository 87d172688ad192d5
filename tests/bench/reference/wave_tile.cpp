// The plan and waves of one tile. See wave_tile.h.
#include "tests/bench/reference/wave_tile.h"

#include <cmath>
#include <vector>

#include "core/base/constants.h"
#include "core/scene/cascade_bands.h"

namespace pelagic::bench {
namespace {

constexpr double kTime_s = 100.0;  // arbitrary, but not 0, where phases are the random numbers themselves

// From a quarter of the shortest wave, which n_max lets pass fully, to the tile's size, at which n_min stops
// all waves, in steps of √½; evaluate() interpolates between them.
std::vector<double> levels(double shortest_m, double size_m) {
    std::vector<double> footprints_m;
    for (double f = 0.25 * shortest_m; f < size_m; f *= std::sqrt(2.0)) footprints_m.push_back(f);
    footprints_m.push_back(size_m);
    return footprints_m;
}

Query query(const char* name, ProductSet products, const std::vector<double>& footprints_m) {
    Query result;
    result.name = name;
    result.products = products;
    result.cell_m = result.pixel_m = footprints_m;
    result.only_cascade = 0;
    return result;
}

}  // namespace

WaveTile::WaveTile(const WaveTileOptions& options) : size_m_(options.size_m) {
    Scene scene;
    scene.shot.seed = options.seed;
    scene.sea.wind_speed_mps = options.wind_speed_mps;
    scene.sea.fetch_m = options.fetch_m;
    scene.waves.choppiness = options.choppiness;
    scene.effects.whitecaps = false;
    // A second tile that is never queried limits the first one's band to its modes: the second band begins at
    // kBandModes waves per tile.
    const double modes = 0.5 * options.resolution - 4.0;
    shortest_m_ = size_m_ / modes;
    scene.waves.cascades = {{.size_m = size_m_, .resolution = options.resolution},
                            {.size_m = kBandModes * shortest_m_, .resolution = kMinCascadeResolution}};
    const auto footprints_m = levels(shortest_m_, size_m_);
    const std::vector<Query> queries{
        query("all waves", products(Product::Position, Product::Normal, Product::SlopeVariance), {0.0}),
        query("cells", products(Product::Position), footprints_m),
        query("pixels", products(Product::Normal, Product::SlopeVariance), footprints_m)};
    frame_ = std::make_unique<Frame<float>>(std::make_shared<const Sea<float>>(make_plan(scene, queries)));
    frame_->set(kTime_s);
    unresolved_height_ = prepare(scene)->extent.unresolved;
}

SpectralMoments WaveTile::unresolved_from_all() const {
    const QueryStatistics& statistics = frame_->sea().statistics(kWhole);
    SpectralMoments resolved = statistics.resolved.front(), unresolved = statistics.whole;
    unresolved += resolved *= -1.0;
    return unresolved;
}

SurfaceBounds WaveTile::bounds() const {
    // Five standard deviations: one of 1e6 independent heights exceeds that.
    const double deviation_m = std::sqrt(whole().m0);
    return {.height_m = 5.0 * deviation_m, .reach_m = 5.0 * deviation_m};
}

}  // namespace pelagic::bench
