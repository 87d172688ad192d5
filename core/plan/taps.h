// The taps of ellipses (taps.inl), and what they let through.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/base/number.h"
#include "core/plan/plan.h"

namespace pelagic {

#include "core/plan/taps.inl"

// A longer ellipse than Knobs::longest_ellipse counts as one that is as long and wider: so many widths. Costs are in
// proportion. What ellipses leave unresolved is known up to here.
inline constexpr double kLongestEllipse = 8.0;

// What ellipses leave unresolved beyond round footprints (core/waves/ellipse_moments.h) is a table: so many nodes
// from a level of footprints to the next and for an octave of length over width, and so many directions over half a
// turn.
struct EllipseTable {
    static constexpr int kNodesALevel = 2, kNodesAnOctave = 3, kRatios = 3 * kNodesAnOctave + 1,
                         kDirections = 24;

    static std::size_t nodes(std::size_t levels) {
        return (kNodesALevel * (levels - 1) + 1) * kRatios * kDirections;
    }
    static constexpr std::size_t kBytesANode = 8 * sizeof(float);
};

// Whether points of a query may have ellipses, and ask what those leave unresolved.
inline bool has_ellipse_table(const Plan& plan, const Query& query) {
    return (query.products & unresolved_products()).any() && query.pixel_m.size() > 1 && !query.lattice &&
           !plan.cascades.empty();
}

// The last of the taps: they are −last … last.
inline int last_tap(double reach) {
    return static_cast<int>(std::ceil(reach - 0.5));
}

// R: what a wave of this wave number along the axis [rad/m] counts with, in all taps together.
inline double tap_response(const Taps<double>& taps, double k_along) {
    const int last = last_tap(taps.reach);
    double sum = tap_weight(taps.reach, 0.0);
    for (int j = 1; j <= last; ++j)
        sum += 2.0 * tap_weight(taps.reach, 1.0 * j) * std::cos(k_along * taps.spacing_m * j);
    return sum;
}

// The largest round footprint that lets all waves of a cascade pass whole [m].
inline double whole_footprint_m(const CascadePlan& cascade, const FootprintFilter& filter) {
    const double last = std::min(cascade.k_upper, kPi * cascade.resolution / cascade.size_m);
    return kTwoPi / last / filter.n_max;
}

}  // namespace pelagic
