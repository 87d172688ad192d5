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

// What fronts of a wind, times the sea's, add.
struct FrontNode {
    double wind = 1.0, even = 0.0, patchy = 0.0, foam = 1.0;
};

FrontNode between(const FrontNode& a, const FrontNode& b, double wind) {
    const double share = (wind - a.wind) / (b.wind - a.wind);
    return {wind, a.even + share * (b.even - a.even), a.patchy + share * (b.patchy - a.patchy),
            a.foam + share * (b.foam - a.foam)};
}

// Of samples in order those ends of lines that leave the least error, the first and the last among them.
template <class Error>
std::vector<FrontNode> fewest_nodes(const std::vector<FrontNode>& samples, std::size_t most,
                                    const Error& error) {
    std::vector<std::size_t> kept{0, samples.size() - 1};
    while (kept.size() < most) {
        std::size_t worst = 0, before = 0;
        double largest = 0.0;
        for (std::size_t k = 1; k < kept.size(); ++k)
            for (std::size_t i = kept[k - 1] + 1; i < kept[k]; ++i) {
                const double found =
                    error(between(samples[kept[k - 1]], samples[kept[k]], samples[i].wind), samples[i]);
                if (found > largest) largest = found, worst = i, before = k;
            }
        if (largest == 0.0) break;
        kept.insert(kept.begin() + static_cast<std::ptrdiff_t>(before), worst);
    }
    std::vector<FrontNode> nodes;
    for (const std::size_t i : kept) nodes.push_back(samples[i]);
    return nodes;
}

// Where the wind is farther from 1 than at a node, lines go on with other slopes.
std::array<Gusts::Bend, Gusts::kBends> bends_at(const std::vector<FrontNode>& nodes) {
    std::array<Gusts::Bend, Gusts::kBends> bends{};
    Gusts::Bend sum;
    for (std::size_t i = 0; i + 1 < nodes.size(); ++i) {
        const FrontNode &from = nodes[i], &to = nodes[i + 1];
        const double per_wind = 1.0 / std::abs(to.wind - from.wind);
        const Gusts::Bend slope{from.wind, (to.even - from.even) * per_wind,
                                (to.patchy - from.patchy) * per_wind, (to.foam - from.foam) * per_wind};
        bends[i] = {from.wind, slope.even - sum.even, slope.patchy - sum.patchy, slope.foam - sum.foam};
        sum = slope;
    }
    return bends;
}

// What fronts add to a sea whose thresholds are these: `even`, where no pattern is seen, and `patchy`, equally likely, where all of
// it is. On the mean there is as much more foam as by the law.
void add_fronts(Gusts& gusts, const FoamBalance& balance, const Scene& scene, double mean, double most,
                double even, std::span<const double> patchy) {
    constexpr int kSamples = 64;
    constexpr double kLittle = 0.01;  // of the mean: errors count by what there is, and this
    if (!(mean > 0.0)) return;
    const double sea = law_coverage(scene);
    const auto law = [&](double wind) { return std::min(mean * (law_coverage(scene, wind) / sea), most); };
    const auto coverage_at = [&](double at) { return balance.coverage_at(std::min(at, gusts.most)); };
    const auto more_of = [&](std::span<const double> thresholds, double wind) {
        const auto [least, largest] = std::ranges::minmax(thresholds);
        return solve(-1.0 - largest, gusts.most - least, law(wind), [&](double more) {
            return mean_of(thresholds, [&](double at) { return coverage_at(at + more); });
        });
    };
    const std::span<const double> one(&even, 1);
    const double even_of_sea = more_of(one, 1.0), patchy_of_sea = more_of(patchy, 1.0);  // all but 0
    const auto side = [&](double end) {
        if (end == 1.0) return std::array<Gusts::Bend, Gusts::kBends>{};
        std::vector<FrontNode> samples;
        for (int i = 0; i <= kSamples; ++i) {
            const double wind = std::pow(end, static_cast<double>(i) / kSamples);
            samples.push_back(
                {.wind = wind, .even = more_of(one, wind) - even_of_sea, .foam = law(wind) / mean});
        }
        std::vector<FrontNode> nodes =
            fewest_nodes(samples, Gusts::kBends + 1, [&](const FrontNode& line, const FrontNode& at) {
                return std::max(std::abs(coverage_at(even + line.even) - coverage_at(even + at.even)) / mean,
                                std::abs(line.foam - at.foam)) /
                       (at.foam + kLittle);
            });
        for (FrontNode& node : nodes) node.patchy = more_of(patchy, node.wind) - patchy_of_sea - node.even;
        return bends_at(nodes);
    };
    gusts.stronger = side(gusts.plan.strongest);
    gusts.weaker = side(gusts.plan.weakest);
}

}  // namespace

double Gusts::foam_of(double fronts_wind) const {
    double foam = 1.0;
    for (const Bend& bend : stronger) foam += bend.foam * std::max(fronts_wind - bend.wind, 0.0);
    for (const Bend& bend : weaker) foam += bend.foam * std::max(bend.wind - fronts_wind, 0.0);
    return std::max(foam, 0.0);
}

Gusts make_gusts(const GustsPlan& plan, const FoamBalance& balance, double threshold, const Scene& scene) {
    Gusts gusts{.plan = plan};
    gusts.of_level[0] = threshold;
    if (!std::isfinite(threshold)) return gusts;
    const double mean = balance.coverage_at(threshold), exponent = law_exponent(scene);
    const auto coverage_at = [&](double at) { return balance.coverage_at(at); };
    const double highest = balance.highest_threshold(), most = std::min(kMostCoverage, coverage_at(highest));
    const bool has_fronts = !plan.fronts.empty();
    if (has_fronts) gusts.most = solve(0.0, highest, most, coverage_at);
    if (has_fronts && plan.strength == 0.0) {
        add_fronts(gusts, balance, scene, mean, most, threshold, {&threshold, 1});
        return gusts;
    }
    // Scaled so that the mean over the whole pattern is the sea's. The coverage is nowhere above `most`.
    const auto share = [&](double level) { return std::pow(1.0 + plan.strength * level, exponent); };
    const auto threshold_of = [&](double level) { return value_of(gusts.of_level, level); };
    const auto whole = likely_values(resolved_amplitudes(plan, 0.0));
    constexpr double kMostScale = 100.0;
    const double scale = solve(0.0, kMostScale, mean, [&](double by) {
        return mean_of(whole, [&](double value) { return std::min(by * share(level_of(value)), most); });
    });

    std::array<double, Gusts::kLevelTerms> level{}, at_level{};
    for (std::size_t i = 0; i < level.size(); ++i) {
        level[i] = std::cos(kPi * (static_cast<double>(i) + 0.5) / Gusts::kLevelTerms);  // Chebyshev's nodes
        at_level[i] = solve(0.0, highest, std::min(scale * share(level[i]), most), coverage_at);
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
    if (!has_fronts) return gusts;
    std::vector<double> patchy;
    constexpr std::size_t kTogether = 8;
    for (std::size_t i = 0; i < whole.size(); i += kTogether)
        patchy.push_back(value_of(gusts.of_kept, 1.0) +
                         mean_of(std::span(whole).subspan(i, kTogether),
                                 [&](double value) { return threshold_of(level_of(value)); }));
    add_fronts(gusts, balance, scene, mean, most, threshold_of(0.0) + gusts.of_kept[0], patchy);
    return gusts;
}

}  // namespace pelagic
