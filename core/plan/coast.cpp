#include "core/plan/coast.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <memory>
#include <stdexcept>

#include "core/plan/effects.h"
#include "core/plan/masks.h"
#include "core/spectrum/directional_spectrum.h"
#include "core/spectrum/gauss.h"
#include "core/spectrum/tma.h"

namespace pelagic {
namespace {

constexpr double kDepthStep = 0.05;  // of ln d

double depth_place(double depth_m) {
    return std::log(std::max(depth_m, kCoastShore_m) / kCoastShore_m) / kDepthStep;
}

}  // namespace

// No finer than waves that feel the floor need.
double coast_cell_m(glm::dvec2 size_m) {
    constexpr double kCellsASide = 256.0, kFinest_m = 0.25;
    return std::max(std::max(size_m.x, size_m.y) / kCellsASide, kFinest_m);
}

// As square as can be.
glm::ivec2 coast_cells(glm::dvec2 size_m) {
    return glm::max(glm::ivec2(glm::round(size_m / coast_cell_m(size_m))), 4);
}

CoastDepths coast_depths(const DepthMap& map, glm::ivec2 count) {
    CoastDepths depths{
        .count = count, .from_m = map.from_m(), .cell_m = map.size_m() / glm::dvec2(count), .depth_m = {}};
    for (int y = 0; y < count.y; ++y)
        for (int x = 0; x < count.x; ++x) {
            const glm::dvec2 from = depths.from_m + glm::dvec2(x, y) * depths.cell_m;
            depths.depth_m.push_back(map.mean_m(from, from + depths.cell_m));
        }
    return depths;
}

TilesOverDepth::TilesOverDepth(const DirectionalSpectrum& spectrum, double deepest_m)
    : height_m_(std::sqrt(8.0 * spectrum.m0())) {
    // Waves of less energy than this are too few to be weighed.
    constexpr double kLeast = 1e-5;
    struct Waves {
        double omega, speed, sea, swell;
    };
    std::vector<Waves> all;
    double sum = 0.0;
    const auto& rule = GaussLegendre<4>::rule();
    const Dispersion& from = spectrum.dispersion();
    spectrum.for_panels(0.0, std::numeric_limits<double>::infinity(), [&](double low, double high) {
        const double half = 0.5 * (high - low), middle = 0.5 * (high + low);
        for (std::size_t node = 0; node < rule.node.size(); ++node) {
            const WavePoint point = wave_point(from, middle + half * rule.node[node]);
            Waves waves{point.omega, point.domega_dk, 0.0, 0.0};
            for (const WaveSystem& system : spectrum.systems())
                (system.may_be_swell() ? waves.swell : waves.sea) +=
                    half * rule.weight[node] * system.energy(point);
            if (!(waves.sea + waves.swell > kLeast * spectrum.m0())) continue;
            sum += waves.sea + waves.swell;
            all.push_back(waves);
        }
    });
    for (Waves& waves : all) {
        waves.sea /= sum;
        waves.swell /= sum;
    }
    const double of_sea = std::sqrt(from.depth_m / kGravity);
    const auto nodes = static_cast<std::size_t>(depth_place(deepest_m)) + 2;
    for (std::size_t i = 0; i < nodes; ++i) {
        const double depth_m = kCoastShore_m * std::exp(kDepthStep * static_cast<double>(i)),
                     here = std::sqrt(depth_m / kGravity);
        const Dispersion dispersion{depth_m};
        double energy = 0.0;
        for (const Waves& waves : all) {
            if (waves.sea > 0.0)
                energy +=
                    waves.sea *
                    std::min(kitaigorodskii(waves.omega * here) / kitaigorodskii(waves.omega * of_sea), 1.0);
            if (waves.swell > 0.0)
                energy += waves.swell *
                          std::min(waves.speed / dispersion.domega_dk(dispersion.wavenumber(waves.omega)),
                                   kMostCoastEnergy);
        }
        energy_.push_back(energy);
    }
}

double TilesOverDepth::energy(double depth_m) const {
    const double place = std::min(depth_place(depth_m), static_cast<double>(energy_.size() - 1));
    const auto i = std::min(static_cast<std::size_t>(place), energy_.size() - 2);
    return energy_[i] + (place - static_cast<double>(i)) * (energy_[i + 1] - energy_[i]);
}

double TilesOverDepth::amplitude(double depth_m) const {
    if (!(depth_m > kCoastShore_m)) return 0.0;
    const double all = std::sqrt(energy(depth_m)), over = height_m_ * all / (kSurfGamma * depth_m);
    return all * std::pow(1.0 + std::pow(over, 5.0), -0.2);
}

void add_coast_mask(std::optional<MasksPlan>& masks, const Scene& scene,
                    const DirectionalSpectrum& spectrum) {
    if (!is_on(Effect::Coast, scene) || !(spectrum.m0() > 0.0)) return;
    if (!scene.waves.coast_depths)
        throw std::invalid_argument("the depths of sea.depth_file weren't read, and waves.coast needs them");
    const DepthMap& map = *scene.waves.coast_depths;
    const CoastDepths depths = coast_depths(map, coast_cells(map.size_m()));
    const TilesOverDepth tiles(spectrum, *std::ranges::max_element(depths.depth_m));
    auto surf = std::make_shared<CoastSurf<double>>();
    surf->count = depths.count;
    surf->from_m = depths.from_m;
    surf->cell_m = depths.cell_m;
    surf->peak_per_m = spectrum.peak_wavenumber();
    surf->fade_m = coast_fade_m(map.size_m());
    std::vector<double> gains;
    const double deviation_m = std::sqrt(spectrum.m0());
    for (const double depth_m : depths.depth_m) {
        gains.push_back(tiles.amplitude(depth_m));
        surf->deviation_m.push_back(deviation_m * gains.back());
        surf->broken.push_back(
            gains.back() > 0.0 ? surf_share(std::sqrt(8.0) * surf->deviation_m.back(), depth_m) : 0.0);
    }
    // Beyond the map as at its edge, and fading.
    const glm::ivec2 beyond = glm::ivec2(glm::ceil(surf->fade_m / depths.cell_m));
    auto cells = std::make_shared<MaskCells>();
    cells->count = depths.count + 2 * beyond;
    double least = 0.0;
    for (int y = 0; y < cells->count.y; ++y)
        for (int x = 0; x < cells->count.x; ++x) {
            const glm::ivec2 at = glm::ivec2(x, y) - beyond,
                             on = glm::clamp(at, glm::ivec2(0), depths.count - 1);
            const glm::dvec2 away_m = depths.from_m + (glm::dvec2(at) + 0.5) * depths.cell_m;
            const double left = at == on
                                    ? 1.0
                                    : coast_fade(glm::length(surf->beyond_m(away_m)) / surf->fade_m).left,
                         share = left * (1.0 - gains[depths.at(on.x, on.y)]);
            least = std::min(least, share);
            cells->shares.push_back(static_cast<float>(share));
            if (cells->shares.back() > cells->most) {
                cells->most = cells->shares.back();
                cells->most_at = {x, y};
            }
        }
    if (!masks) masks.emplace();
    const glm::dvec2 half = 0.5 * glm::dvec2(cells->count);
    const glm::dvec2 first_m = depths.from_m - glm::dvec2(beyond) * depths.cell_m;
    masks->masks.push_back({.middle_m = first_m + half * depths.cell_m,
                            .cells_per_m = 1.0 / depths.cell_m,
                            .reach_m = glm::length((half + 1.0) * depths.cell_m),
                            .waves = 0.0,
                            .strongest = 1.0 - static_cast<double>(cells->most),
                            .other_way = 1.0 - least,
                            .strongest_m = first_m + (glm::dvec2(cells->most_at) + 0.5) * depths.cell_m});
    masks->masks.back().cells = std::move(cells);
    masks->changes_waves = true;
    masks->surf = std::move(surf);
}

}  // namespace pelagic
