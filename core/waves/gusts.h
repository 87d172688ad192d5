// What gusts do to the sea. Short waves follow the wind within seconds: the slope variance that a footprint leaves
// unresolved is multiplied by f = 1 + strength · level, since it is linear in the wind (Cox and Munk 1954). Whitecaps
// follow the shot's law: J is compared with a threshold at which the whole sea would have a coverage in proportion to
// f^p, p being the law's exponent at the mean wind. The mean of both over area is what it is without gusts.
//
// A front multiplies f by its own factor; what the means are refers to the sea without fronts. Where the law has no foam at the mean wind there
// is none to be multiplied, in a front as little.
//
// Resolved waves are those of the mean wind, and so are the moments of J.
#pragma once

#include <array>

#include "core/plan/gusts.h"

namespace pelagic {

struct Gusts {
    GustsPlan plan;
    // ε = Σ of_level[n] · at^n + Σ of_kept[n] · kept^n. The second sum corrects footprints that resolve only a
    // part of the pattern, `kept` of its variance, so that the mean coverage stays. f = middle + half · at: at is the level itself
    // without fronts, and with them reaches as far.
    static constexpr int kLevelTerms = 9, kKeptTerms = 8;
    std::array<double, kLevelTerms> of_level{};
    std::array<double, kKeptTerms> of_kept{};
    double middle = 1.0, half = 0.0;
    double exponent = 0.0;   // p
    double most_foam = 1.0;  // of a front, times the mean

    // Of a front's wind, times the mean, over waves and footprints that no pattern is seen in.
    double foam_of(double fronts_wind) const;
};

struct FoamBalance;

// `threshold`: without gusts. `exponent`: law_exponent().
Gusts make_gusts(const GustsPlan& plan, const FoamBalance& balance, double threshold, double exponent);

}  // namespace pelagic
