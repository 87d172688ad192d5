// Which wave trains a scene has. See trains.h.
#include "core/plan/trains.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <limits>
#include <stdexcept>

#include "core/base/constants.h"
#include "core/plan/fields.h"
#include "core/plan/filter.h"
#include "core/scene/cascade_bands.h"
#include "core/spectrum/energy_shares.h"
#include "core/spectrum/gauss.h"
#include "core/spectrum/spectral_moments.h"

namespace pelagic {
namespace {

constexpr double kPaperShortest_m = 0.02;  // Bruneton et al. 2010, §7.3
constexpr int kBelowPixel = 10;            // §3.2: fewer don't add up to a Gaussian
constexpr double kLongerShare = 1e-3;      // of m0, left beyond the longest train
constexpr double kLeastRange = 10.0;       // longest over shortest, where one of them is ours to choose

// The wavelength beyond which there is at most kLongerShare of m0: one of the spectrum's panels (12 % apart).
double longest_with_energy_m(const DirectionalSpectrum& spectrum) {
    const auto panels = spectrum.panels();
    if (panels.empty()) return kTwoPi / DirectionalSpectrum::kCalmPeakWavenumber;
    double sum = 0.0;
    std::size_t i = 0;
    for (; i + 2 < panels.size(); ++i) {
        sum += GaussLegendre<8>::rule().integrate(panels[i], panels[i + 1],
                                                  [&](double k) { return spectrum.omnidirectional(k); });
        if (sum > kLongerShare * spectrum.m0()) break;
    }
    return kTwoPi / panels[i];
}

// The shortest edge with which exactly the last `below` bins lie below nyquist_m: the edge between them and
// the others, longest (shortest/longest)^((count − below)/count), is nyquist_m itself.
double shortest_for_m(const TrainsPlan& plan, int below, double nyquist_m) {
    if (!(nyquist_m < plan.longest_m)) return plan.longest_m;
    return plan.longest_m *
           std::pow(nyquist_m / plan.longest_m, plan.count / static_cast<double>(plan.count - below));
}

// The wavelength of the bin's mean wavenumber; of a bin without energy the geometric middle.
double mean_wavelength_m(const DirectionalSpectrum& spectrum, double longer_m, double shorter_m) {
    double energy = 0.0, mean = 0.0;
    spectrum.for_panels(kTwoPi / longer_m, kTwoPi / shorter_m, [&](double from, double to) {
        const auto sum = [&](auto&& of) { return GaussLegendre<8>::rule().integrate(from, to, of); };
        energy += sum([&](double k) { return spectrum.omnidirectional(k); });
        mean += sum([&](double k) { return k * spectrum.omnidirectional(k); });
    });
    if (!(energy > 0.0) || !(mean > 0.0)) return std::sqrt(longer_m * shorter_m);
    return std::clamp(kTwoPi * energy / mean, shorter_m, longer_m);
}

}  // namespace

double TrainsPlan::edge_m(int i) const {
    if (i == count) return shortest_m;
    return longest_m * std::pow(shortest_m / longest_m, i / static_cast<double>(count));
}

std::size_t TrainsPlan::sea_bytes(bool double_precision) const {
    const std::size_t scalar = double_precision ? sizeof(double) : sizeof(float);
    // Of each: wavevector, frequency, phase, two amplitudes, wavelength; a factor a field, the wavelength
    // and the weight in breaking; its moments alone and in both running sums, and the eight that a pixel hides, alone and in
    // one sum. A sum has one entry more than there are trains.
    constexpr std::size_t kUnresolved = 8;
    const auto trains = static_cast<std::size_t>(count + hero_trains);
    return trains * (7 * sizeof(double) + (kFieldCount + 2) * scalar) +
           (3 * trains + 2) * sizeof(SpectralMoments) + (2 * trains + 1) * kUnresolved * scalar +
           coast_bytes(double_precision);
}

std::size_t TrainsPlan::coast_bytes(bool double_precision) const {
    // Of each cell a phase and a gain of each train that feels it, in whole vectors; the gain of all others, its share of breaking waves and its height.
    const std::size_t scalar = double_precision ? sizeof(double) : sizeof(float), vector = 64 / scalar;
    const std::size_t stride = (static_cast<std::size_t>(coast_trains) + vector - 1) / vector * vector;
    return static_cast<std::size_t>(coast_cells.x) * static_cast<std::size_t>(coast_cells.y) *
           (2 * stride + 3) * scalar;
}

namespace {

void plan_coast(TrainsPlan& plan, const Waves& waves) {
    constexpr double kShortest_m = 2.0;
    if (!waves.coast_depths)
        throw std::invalid_argument("the depths of sea.depth_file weren't read, and waves.coast needs them");
    plan.coast_cells = coast_cells(waves.coast_depths->size_m());
    plan.coast_trains = static_cast<int>(
        std::ranges::count_if(plan.wavelengths_m, [](double length_m) { return length_m > kShortest_m; }));
}

TrainsPlan model_trains(const PreparedScene& prepared, double finest_footprint_m) {
    const Waves& waves = prepared.scene.waves;
    const DirectionalSpectrum& spectrum = prepared.spectrum;
    const double nyquist_m = FootprintFilter{}.n_min * finest_footprint_m;
    TrainsPlan plan{.count = waves.trains};
    plan.longest_m = waves.longest_m.value_or(longest_with_energy_m(spectrum));
    if (waves.shortest_m) {
        plan.shortest_m = *waves.shortest_m;
        if (!waves.longest_m) plan.longest_m = std::max(plan.longest_m, kLeastRange * plan.shortest_m);
    } else {
        if (!waves.cascades.empty()) {
            plan.shortest_m = waves.cascades.front().size_m / kBandModes;
        } else {
            plan.shortest_m = kPaperShortest_m;
            if (nyquist_m > 0.0) {
                // No further than there are waves: beyond is nothing to keep as variance either.
                const double end_m = spectrum.empty() ? kPaperShortest_m : kTwoPi / spectrum.panels().back();
                const int below = std::min(kBelowPixel, plan.count / 2);
                plan.shortest_m =
                    std::min(plan.shortest_m, std::max(shortest_for_m(plan, below, nyquist_m), end_m));
            }
        }
        plan.shortest_m = std::min(plan.shortest_m, plan.longest_m / kLeastRange);
    }
    for (int i = 0; i < plan.count; ++i) {
        plan.wavelengths_m.push_back(mean_wavelength_m(spectrum, plan.edge_m(i), plan.edge_m(i + 1)));
        plan.below_pixel += plan.wavelengths_m.back() < nyquist_m;
    }
    if (waves.coast) plan_coast(plan, waves);
    return plan;
}

}  // namespace

std::optional<TrainsPlan> resolve_trains(const PreparedScene& prepared, double finest_footprint_m) {
    const Waves& waves = prepared.scene.waves;
    const bool has_heroes = !waves.heroes.empty() && prepared.spectrum.m0() > 0.0;
    if (waves.model != WaveModel::Trochoid && !has_heroes) return std::nullopt;
    constexpr double kInfinite = std::numeric_limits<double>::infinity();
    TrainsPlan plan = waves.model == WaveModel::Trochoid
                          ? model_trains(prepared, finest_footprint_m)
                          : TrainsPlan{.longest_m = kInfinite, .shortest_m = kInfinite};
    if (has_heroes) {
        plan.hero_trains = kHeroTrains * static_cast<int>(waves.heroes.size());
        const EnergyShares energy(prepared.spectrum, 0.0, kInfinite);
        plan.hero_ends = {energy.wavenumber(kHeroHeightEnergy), energy.wavenumber(kHeroEnergy)};
    }
    return plan;
}

}  // namespace pelagic
