// What gusts do to the sea. Short waves follow the wind within seconds: the slope variance that a footprint leaves
// unresolved is multiplied by f = 1 + strength · level, since it is linear in the wind (Cox and Munk 1954). Whitecaps
// follow the shot's law: J is compared with a threshold at which the whole sea would have a coverage in proportion to
// f^p, p being the law's exponent at the mean wind. The mean of both over area is what it is without gusts.
//
// A front multiplies f by w, its own wind over the sea's, and has the law's coverage at w times the sea's wind, on the mean of the pattern
// within it. What the means are refers to the sea without fronts. Where the law has no foam at the mean wind, a front has none
// either: the threshold and what breaking leaves are calibrated on that wind's breaking waves.
//
// Resolved waves are those of the mean wind, and so are the moments of J.
#pragma once

#include <array>

#include "core/plan/gusts.h"

namespace pelagic {

struct Gusts {
    GustsPlan plan;
    // ε = Σ of_level[n] · level^n + Σ of_kept[n] · kept^n. The second sum corrects footprints that resolve only a
    // part of the pattern, `kept` of its variance, so that the mean coverage stays.
    static constexpr int kLevelTerms = 9, kKeptTerms = 8;
    std::array<double, kLevelTerms> of_level{};
    std::array<double, kKeptTerms> of_kept{};
    // A front adds lines from bend to bend, in w, which are 0 where w is 1: each bend adds its slopes where the wind is farther from 1 than
    // there. To ε, `even` where a footprint hides the pattern and `patchy` more where it keeps all of it; and to what foam is of the mean.
    struct Bend {
        double wind = 1.0, even = 0.0, patchy = 0.0, foam = 0.0;
    };
    static constexpr int kBends = 16;
    std::array<Bend, kBends> stronger{}, weaker{};
    double most = 0.0;  // of ε in a front

    // Of a front's wind, times the mean, over waves and footprints that no pattern is seen in.
    double foam_of(double fronts_wind) const;
};

struct FoamBalance;

// `threshold`: without gusts. The scene: whose law it is.
Gusts make_gusts(const GustsPlan& plan, const FoamBalance& balance, double threshold, const Scene& scene);

}  // namespace pelagic
