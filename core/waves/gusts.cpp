#include "core/waves/gusts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "core/base/constants.h"
#include "core/plan/filter.h"
#include "core/waves/whitecaps.h"

namespace pelagic {
namespace {

// What a round footprint resolves of each wave's amplitude.
std::array<double, GustsPlan::kWaves> resolved_amplitudes(const GustsPlan& plan, double footprint_m) {
    const FootprintFilter filter;
    std::array<double, GustsPlan::kWaves> resolved{};
    for (std::size_t i = 0; i < resolved.size(); ++i)
        resolved[i] = plan.waves[i].amplitude * filter.weight(kTwoPi / plan.waves[i].shortest_m, footprint_m);
    return resolved;
}

// Equally likely values of a sum of waves with independent phases: the means of equal parts of its distribution.
std::vector<double> likely_values(const std::array<double, GustsPlan::kWaves>& amplitudes) {
    constexpr std::size_t kSamples = 4096, kParts = 128;
    // Phases on a lattice that fills the eight dimensions evenly (Roberts 2018): powers of the root of x⁹ = x + 1.
    double root = 1.0;
    for (int i = 0; i < 60; ++i) root = std::pow(1.0 + root, 1.0 / (GustsPlan::kWaves + 1));
    std::vector<double> samples(kSamples, 0.0);
    for (std::size_t s = 0; s < kSamples; ++s) {
        double step = 1.0;
        for (const double amplitude : amplitudes) {
            step /= root;
            samples[s] += amplitude * std::cos(kTwoPi * step * static_cast<double>(s));
        }
    }
    std::sort(samples.begin(), samples.end());
    std::vector<double> values(kParts, 0.0);
    for (std::size_t s = 0; s < kSamples; ++s) values[s * kParts / kSamples] += samples[s];
    for (double& value : values) value *= static_cast<double>(kParts) / kSamples;
    return values;
}

template <class Function>
double mean_of(std::span<const double> values, const Function& function) {
    double sum = 0.0;
    for (const double value : values) sum += function(value);
    return sum / static_cast<double>(values.size());
}

double level_of(double value) {
    return value / std::sqrt(1.0 + value * value);
}

// Where a rising function reaches a value.
template <class Function>
double solve(double low, double high, double value, const Function& function) {
    for (int i = 0; i < 40; ++i) {
        const double middle = 0.5 * (low + high);
        (function(middle) < value ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

// The coefficients of the polynomial that has these values at x_i, by Newton's divided differences.
template <std::size_t N>
std::array<double, N> polynomial(const std::array<double, N>& x, std::array<double, N> y) {
    for (std::size_t order = 1; order < N; ++order)
        for (std::size_t i = N - 1; i >= order; --i) y[i] = (y[i] - y[i - 1]) / (x[i] - x[i - order]);
    std::array<double, N> terms{};
    for (std::size_t i = N; i-- > 0;) {
        for (std::size_t n = N - 1; n > 0; --n) terms[n] = terms[n - 1] - x[i] * terms[n];
        terms[0] = y[i] - x[i] * terms[0];
    }
    return terms;
}

double value_of(std::span<const double> terms, double x) {
    double sum = 0.0;
    for (std::size_t n = terms.size(); n-- > 0;) sum = sum * x + terms[n];
    return sum;
}

}  // namespace

double Gusts::foam_of(double fronts_wind) const {
    return std::min(std::pow(fronts_wind, exponent), most_foam);
}

Gusts make_gusts(const GustsPlan& plan, const FoamBalance& balance, double threshold, double exponent) {
    Gusts gusts{.plan = plan, .half = plan.strength, .exponent = exponent};
    gusts.of_level[0] = threshold;
    const bool has_fronts = !plan.fronts.empty();
    if (has_fronts) {
        const double least = (1.0 - plan.strength) * plan.weakest,
                     largest = (1.0 + plan.strength) * plan.strongest;
        gusts.middle = 0.5 * (least + largest);
        gusts.half = 0.5 * (largest - least);
    }
    if (!std::isfinite(threshold)) return gusts;
    const double mean = balance.coverage_at(threshold);
    const auto coverage_at = [&](double at) { return balance.coverage_at(at); };
    const double highest = balance.highest_threshold(), most = std::min(kMostCoverage, coverage_at(highest));
    // Scaled so that the mean over the whole pattern is the sea's. The coverage is nowhere above `most`.
    gusts.most_foam = mean > 0.0 ? most / mean : 1.0;
    // Without fronts.
    const auto share = [&](double level) { return std::pow(1.0 + plan.strength * level, exponent); };
    const auto threshold_of = [&](double level) {
        return value_of(gusts.of_level,
                        has_fronts ? (1.0 + plan.strength * level - gusts.middle) / gusts.half : level);
    };
    const auto whole = likely_values(resolved_amplitudes(plan, 0.0));
    constexpr double kMostScale = 100.0;
    const double scale = solve(0.0, kMostScale, mean, [&](double by) {
        return mean_of(whole, [&](double value) { return std::min(by * share(level_of(value)), most); });
    });

    std::array<double, Gusts::kLevelTerms> level{}, at_level{};
    for (std::size_t i = 0; i < level.size(); ++i) {
        level[i] = std::cos(kPi * (static_cast<double>(i) + 0.5) / Gusts::kLevelTerms);  // Chebyshev's nodes
        const double foam = std::pow(gusts.middle + gusts.half * level[i], exponent);
        at_level[i] = solve(0.0, highest, std::min(scale * foam, most), coverage_at);
    }
    gusts.of_level = polynomial(level, at_level);

    std::array<double, Gusts::kKeptTerms> kept{}, at_kept{};
    for (std::size_t i = 0; i < kept.size(); ++i) {
        kept[i] = static_cast<double>(i) / (Gusts::kKeptTerms - 1);
        const double octave = solve(-40.0, 40.0, -kept[i], [&](double at) {
            double variance = 0.0;
            for (const double resolved : resolved_amplitudes(plan, std::exp2(at)))
                variance += 0.5 * resolved * resolved;
            return -variance;
        });
        const auto values = likely_values(resolved_amplitudes(plan, std::exp2(octave)));
        at_kept[i] = solve(-0.5, 0.5, mean, [&](double more) {
            return mean_of(values,
                           [&](double value) { return coverage_at(threshold_of(level_of(value)) + more); });
        });
    }
    gusts.of_kept = polynomial(kept, at_kept);
    return gusts;
}

}  // namespace pelagic
