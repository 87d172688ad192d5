// What ellipses leave unresolved beyond round footprints of their width: the moments of the waves that their taps let
// through in part (core/plan/taps.h), as a table over widths, lengths and directions.
//
// An integral over the spectrum. What a round footprint of weight w resolves is ∬ Ψ m w² over the cascades' bands. An
// ellipse of response wR leaves ∬ Ψ m w² (1 − R²) of that unresolved. m is kp kq for slopes and (choppiness · coth
// kd)² kp kq kr ks/k² for the Jacobian's moments, of the waves that break, through no footprint finer than theirs.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/plan/taps.h"
#include "core/waves/trains.h"

namespace pelagic {

class EllipseMoments {
  public:
    EllipseMoments() = default;  // nothing is unresolved
    EllipseMoments(const Plan& plan, const Query& query);
    // Between two of one plan and query; displacement gradients' times `gradients`.
    EllipseMoments(const EllipseMoments& first, const EllipseMoments& second, double share, double gradients);

    bool empty() const { return values_.empty(); }
    // Linear between the table's nodes (EllipseTable). level: the lower level's number plus the share of the next.
    // ratio: 1 … kLongestEllipse. direction [rad].
    UnresolvedMoments<double> unresolved(double level, double ratio, double direction) const;

    // Ordered by width, ratio and direction, which varies fastest.
    const std::vector<UnresolvedMoments<float>>& values() const { return values_; }
    int widths() const { return widths_; }

  private:
    int widths_ = 0;
    std::vector<UnresolvedMoments<float>> values_;
};

}  // namespace pelagic
