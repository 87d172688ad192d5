#include "core/plan/choppiness.h"

#include <limits>

#include "core/scene/cascade_bands.h"

namespace pelagic {
namespace {

constexpr double kNoEnd = std::numeric_limits<double>::infinity();

}  // namespace

Choppiness::Choppiness(double of_all) : Choppiness(std::vector<Band>{{kNoEnd, of_all}}) {}

Choppiness::Choppiness(std::vector<Band> bands) {
    // Neighbours that are alike are one band: so what is integrated is, to the bit, that of one choppiness.
    for (const Band& band : bands) {
        if (!bands_.empty() && bands_.back().choppiness == band.choppiness)
            bands_.back().k_end = band.k_end;
        else
            bands_.push_back(band);
        largest_ = std::max(largest_, band.choppiness);
    }
}

Choppiness Choppiness::asked(const Scene& scene) {
    const Waves& waves = scene.waves;
    if (waves.cascades.empty() || waves.model != WaveModel::Fft) return waves.choppiness;
    std::vector<double> sizes_m;
    for (const CascadeSize& cascade : waves.cascades) sizes_m.push_back(cascade.size_m);
    const std::vector<double> edges = lower_edges(sizes_m);
    std::vector<Band> bands;
    for (std::size_t i = 0; i < edges.size(); ++i)
        bands.push_back({i + 1 < edges.size() ? edges[i + 1] : kNoEnd,
                         waves.cascades[i].choppiness.value_or(waves.choppiness)});
    return bands;
}

Choppiness Choppiness::built() const {
    std::vector<Band> bands = bands_;
    for (Band& band : bands)
        if (band.choppiness < kLeastShown) band.choppiness = 0.0;
    return bands;
}

}  // namespace pelagic
