// What ellipses hide beyond round footprints of their width: the moments of the waves that their taps let through in
// part (core/plan/taps.h), as a table over widths, lengths and directions.
//
// An integral over the spectrum: what a round footprint of weight w resolves is ∬ Ψ m w² over the cascades' bands, and an
// ellipse of response wR leaves ∬ Ψ m w² (1 − R²) of that to be counted as hidden, m being kp kq for slopes and
// (choppiness · coth kd)² kp kq kr ks/k² for the Jacobian's, of the waves that break, through no footprint finer than theirs.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/plan/taps.h"
#include "core/waves/trains.h"

namespace pelagic {

class EllipseMoments {
  public:
    EllipseMoments() = default;  // nothing is hidden
    EllipseMoments(const Plan& plan, const Query& query);

    bool empty() const { return values_.empty(); }
    // Linear between the table's nodes (EllipseTable). rung: the lower one's number plus the share of the next.
    // ratio: 1 … kLongestEllipse. direction [rad].
    HiddenMoments<double> hidden(double rung, double ratio, double direction) const;

    // By width, ratio and direction, which is the fastest.
    const std::vector<HiddenMoments<float>>& values() const { return values_; }
    int widths() const { return widths_; }

  private:
    int widths_ = 0;
    std::vector<HiddenMoments<float>> values_;
};

}  // namespace pelagic
