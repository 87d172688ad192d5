#include "core/plan/second_order.h"

#include <algorithm>

#include "core/plan/grid_layout.h"
#include "core/plan/mode_lattice.h"
#include "core/scene/cascade_bands.h"

namespace pelagic {
namespace {

// Of the waves that hold the last fifth of the energy little comes that isn't in the factors already.
constexpr int kLastBin = 13;
// Fewer hold no groups to speak of.
constexpr int kLeastBins = 6;
// Of the lattice: larger transforms would cost more than a frame of the default sea.
constexpr int kLargestRadius = 192;
// How much the pairs of waves that aren't summed may add to the factors.
constexpr double kMostAdded = 1.5;

}  // namespace

std::size_t SecondOrderPlan::bytes(bool double_precision) const {
    const std::size_t scalar = double_precision ? sizeof(double) : sizeof(float);
    const std::size_t rows = static_cast<std::size_t>(resolution), half = static_cast<std::size_t>(radius);
    return 2 * scalar *
           (rows * ((2 * half - 1) * sums() + static_cast<std::size_t>(reach) * results()) +
            results() * lattice_modes(reach));
}

SecondOrderBand::SecondOrderBand(const SecondOrder& pairs, double k_lower, double k_upper, double size_m,
                                 int largest_radius)
    : largest_radius_(largest_radius) {
    if (!(pairs.deviation_m > 0.0)) return;
    int first = 0, last = kLastBin;
    while (first < last && pairs.edges[first] < k_lower) ++first;
    const auto fits = [&](int end) {
        return pairs.edges[end] <= k_upper &&
               modes_within(size_m, pairs.edges[end]) <= std::min(largest_radius, kLargestRadius);
    };
    while (last > first && !fits(last)) --last;
    if (last - first < kLeastBins) return;
    first_ = first;
    last_ = last;
    radius_ = modes_within(size_m, pairs.edges[last]);
}

SecondOrderPlan SecondOrderBand::plan(const SecondOrder& pairs, double gain, bool moves,
                                      double depth_m) const {
    const SecondOrder::Sums own = pairs.sums(first_, last_), all = pairs.sums(0, SecondOrder::kBins);
    const auto limited = [](double value, double reference) {
        const double most = kMostAdded * reference;
        return std::clamp(value, std::min(-most, most), std::max(-most, most));
    };
    SecondOrderPlan plan{.radius = radius_, .reach = radius_, .depth_m = depth_m, .moves = moves};
    const double each = 0.25 * gain * pairs.limit();
    plan.difference = each * limited(all.difference, own.difference) / own.together;
    // Where depth makes pairs of the same direction add, that alone does.
    const double sum = limited(all.sum, own.sum);
    if (own.shallow > 0.0 && sum > 0.0)
        plan.shallow = each * std::min(sum / own.shallow, kMostAdded);
    else if (constexpr double kNeedle = 1e-3; own.against > kNeedle * own.together)
        plan.sum = each * sum / own.against;
    plan.skewness = 6.0 * pairs.deviation_m *
                    (plan.difference * own.together + plan.sum * own.against + plan.shallow * own.shallow);
    // There most of what pairs add has twice their wavenumber.
    if (plan.shallow > 0.0) plan.reach = std::min(2 * radius_, largest_radius_);
    return plan;
}

}  // namespace pelagic
