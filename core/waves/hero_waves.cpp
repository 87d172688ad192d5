#include "core/waves/hero_waves.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "core/base/constants.h"
#include "core/plan/choppiness.h"
#include "core/plan/masks.h"
#include "core/spectrum/energy_shares.h"
#include "core/waves/loop.h"
#include "core/waves/trains.h"

namespace pelagic {
namespace {

constexpr int kDemands = 6;  // of a hero: η, its gradient and rate, D
// A demand of which the others leave less than this share free, as variance, isn't made.
constexpr double kLeastFree = 1e-2;

std::vector<HeroMode> hero_modes(const PreparedScene& prepared) {
    const DirectionalSpectrum& spectrum = prepared.spectrum;
    const EnergyShares energy(spectrum, 0.0, std::numeric_limits<double>::infinity());
    std::vector<HeroMode> modes;
    if (!(energy.energy() > 0.0)) return modes;
    const Choppiness choppiness = Choppiness::asked(prepared.scene).built();
    const double loop_s = prepared.scene.shot.sea_loop_s();
    constexpr double kGolden = 0.6180339887498949;  // (√5 − 1)/2: neighbours in wavelength go all ways
    const int count = kHeroTrains * static_cast<int>(prepared.scene.waves.heroes.size());
    for (int i = 0; i < count; ++i) {
        const double k = energy.wavenumber(kHeroEnergy * (i + 0.5) / count), turn = (i + 0.5) * kGolden;
        const double theta = direction_of_share(spectrum, k, turn - std::floor(turn));
        const Dispersion& dispersion = spectrum.dispersion();
        modes.push_back({.wavelength_m = kTwoPi / k,
                         .direction = {std::cos(theta), std::sin(theta)},
                         .cycles_per_s = looped_cycles_per_s(dispersion.omega(k), loop_s),
                         .horizontal_ratio = choppiness.at(k) * dispersion.horizontal_ratio(k)});
    }
    return modes;
}

// What a mode's cos θ and its sin θ have at a phase, by demand: θ = ωt − k·x falls with x.
struct Row {
    std::array<double, kDemands> of_cosine, of_sine;
};
Row row_of(const HeroMode& mode, double cycles) {
    const double cosine = std::cos(kTwoPi * cycles), sine = std::sin(kTwoPi * cycles);
    const glm::dvec2 k = kTwoPi * mode.cycles_per_m(), across = mode.horizontal_ratio * mode.direction;
    const double omega = kTwoPi * mode.cycles_per_s;
    return {.of_cosine = {cosine, k.x * sine, k.y * sine, -omega * sine, across.x * sine, across.y * sine},
            .of_sine = {sine, -k.x * cosine, -k.y * cosine, omega * cosine, -across.x * cosine,
                        -across.y * cosine}};
}

// Solves C x = r by Cholesky's method: one hero after the other, of each the largest pivot first. C: covariances. Demands that are left
// out have 0.
std::vector<double> solved(std::vector<double> c, std::vector<double> r) {
    const std::size_t n = r.size();
    const auto at = [&](std::size_t i, std::size_t j) -> double& { return c[i * n + j]; };
    // Each demand in its own deviations.
    std::vector<double> deviation(n);
    for (std::size_t i = 0; i < n; ++i) deviation[i] = std::sqrt(std::max(at(i, i), 0.0));
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < n; ++j) {
            const double by = deviation[i] * deviation[j];
            at(i, j) = by > 0.0 ? at(i, j) / by : 0.0;
        }
        r[i] = deviation[i] > 0.0 ? r[i] / deviation[i] : 0.0;
    }
    std::vector<std::size_t> pivots;
    std::vector<char> is_done(n, 0);
    for (;;) {
        std::size_t pivot = n;
        for (std::size_t i = 0; i < n && (pivot == n || i % kDemands != 0); ++i)
            if (!is_done[i] && at(i, i) > kLeastFree && (pivot == n || at(i, i) > at(pivot, pivot)))
                pivot = i;
        if (pivot == n) break;
        is_done[pivot] = 1;
        pivots.push_back(pivot);
        for (std::size_t i = 0; i < n; ++i) {
            if (is_done[i]) continue;
            const double factor = at(i, pivot) / at(pivot, pivot);
            for (std::size_t j = 0; j < n; ++j)
                if (!is_done[j]) at(i, j) -= factor * at(pivot, j);
            r[i] -= factor * r[pivot];
        }
    }
    std::vector<double> x(n, 0.0);
    for (auto pivot = pivots.rbegin(); pivot != pivots.rend(); ++pivot) {
        double rest = r[*pivot];
        for (auto later = pivots.rbegin(); later != pivot; ++later) rest -= at(*pivot, *later) * x[*later];
        x[*pivot] = rest / at(*pivot, *pivot);
    }
    for (std::size_t i = 0; i < n; ++i) x[i] = deviation[i] > 0.0 ? x[i] / deviation[i] : 0.0;
    return x;
}

}  // namespace

LocalWaves& LocalWaves::operator+=(const LocalWaves& other) {
    height_m += other.height_m;
    slope += other.slope;
    rate_mps += other.rate_mps;
    displacement_m += other.displacement_m;
    return *this;
}

double hero_time_s(const Scene& scene, const HeroWave& hero) {
    return time_within_loop_s(scene.shot.time_s(hero.frame), scene.shot.sea_loop_s());
}

std::vector<HeroTrain> hero_trains(const PreparedScene& prepared, std::span<const LocalWaves> around) {
    const std::vector<HeroWave>& heroes = prepared.scene.waves.heroes;
    const std::vector<HeroMode> modes = hero_modes(prepared);
    std::vector<HeroTrain> trains;
    if (heroes.empty() || modes.empty()) return trains;

    const std::size_t n = kDemands * heroes.size();
    std::vector<double> missing(n);
    for (std::size_t h = 0; h < heroes.size(); ++h) {
        const LocalWaves& there = around[h];
        const HeroMask mask = hero_mask(prepared.masks, heroes[h]);
        const double height_m = mask.raise * heroes[h].height_m;
        const glm::dvec2 slope = -height_m * mask.change_per_m - there.slope;
        const std::array<double, kDemands> lacks{
            height_m - there.height_m, slope.x, slope.y, -there.rate_mps, -there.displacement_m.x,
            -there.displacement_m.y};
        std::ranges::copy(lacks, missing.begin() + static_cast<std::ptrdiff_t>(kDemands * h));
    }
    std::vector<double> of_cosine(n * modes.size()), of_sine(n * modes.size()), covariance(n * n);
    for (std::size_t j = 0; j < modes.size(); ++j) {
        double *const cosine = &of_cosine[j * n], *const sine = &of_sine[j * n];
        for (std::size_t h = 0; h < heroes.size(); ++h) {
            const Row row = row_of(modes[j], phase_at(modes[j].cycles_per_m(), modes[j].cycles_per_s, 0.0,
                                                      {heroes[h].east_m, heroes[h].north_m},
                                                      hero_time_s(prepared.scene, heroes[h])));
            std::ranges::copy(row.of_cosine, cosine + kDemands * h);
            std::ranges::copy(row.of_sine, sine + kDemands * h);
        }
        for (std::size_t a = 0; a < n; ++a)
            for (std::size_t b = 0; b < n; ++b)
                covariance[a * n + b] += cosine[a] * cosine[b] + sine[a] * sine[b];
    }
    // All modes have the same energy, which cancels.
    const std::vector<double> weight = solved(std::move(covariance), std::move(missing));
    for (std::size_t j = 0; j < modes.size(); ++j) {
        double u = 0.0, v = 0.0;
        for (std::size_t a = 0; a < n; ++a) {
            u += of_cosine[j * n + a] * weight[a];
            v += of_sine[j * n + a] * weight[a];
        }
        // u cos θ + v sin θ = √(u² + v²) cos(θ + φ), φ = −atan2(v, u)
        const double start = -std::atan2(v, u) / kTwoPi;
        trains.push_back(
            {.mode = modes[j], .height_m = std::hypot(u, v), .start_cycles = start - std::floor(start)});
    }
    return trains;
}

HeroShape hero_shape(std::span<const HeroTrain> trains, glm::dvec2 place_m, double reduced_time_s) {
    HeroShape shape;
    double xx = 0.0, xy = 0.0, yy = 0.0;
    for (const HeroTrain& train : trains) {
        const HeroMode& mode = train.mode;
        const double height_m = train.height_m *
                                std::cos(kTwoPi * phase_at(mode.cycles_per_m(), mode.cycles_per_s,
                                                           train.start_cycles, place_m, reduced_time_s)),
                     gradient = kTwoPi / mode.wavelength_m * mode.horizontal_ratio * height_m;
        shape.height_m += height_m;
        xx += gradient * mode.direction.x * mode.direction.x;
        xy += gradient * mode.direction.x * mode.direction.y;
        yy += gradient * mode.direction.y * mode.direction.y;
    }
    shape.compression = 0.5 * (xx + yy) + std::hypot(0.5 * (xx - yy), xy);
    return shape;
}

}  // namespace pelagic
