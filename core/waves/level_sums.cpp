#include "core/waves/level_sums.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/base/constants.h"
#include "core/base/disc.h"

namespace pelagic {

LevelSums::LevelSums(double size_m, int radius, const FootprintFilter& filter,
                     std::vector<FootprintPair> pairs)
    : step_(kTwoPi / size_m), filter_(filter), pairs_(std::move(pairs)) {
    // Four rings an octave. The ring in which a footprint stops letting waves through whole is summed with weights.
    constexpr double kRingsAnOctave = 4.0;
    for (int i = 0; rings_.empty() || rings_.back() < static_cast<double>(radius) * radius; ++i)
        rings_.push_back(std::exp2(2.0 * i / kRingsAnOctave));

    constexpr double kRounding = 1.0 - 1e-12;  // of the weight at its octave's end
    for (const FootprintPair& pair : pairs_) {
        const double coarsest_m = std::max(pair.a_m, pair.b_m);
        // In modes: shorter waves than `none` don't pass, longer ones than `whole` do.
        const double whole = coarsest_m > 0.0 ? size_m / (filter.n_max * coarsest_m) * kRounding
                                              : std::numeric_limits<double>::infinity();
        const double none =
            coarsest_m > 0.0 ? size_m / (filter.n_min * coarsest_m) : std::numeric_limits<double>::infinity();
        const double resolved = static_cast<double>(pair.radius) * pair.radius;
        const auto rings = static_cast<std::size_t>(
            std::upper_bound(rings_.begin(), rings_.end(), std::min(whole * whole, resolved)) -
            rings_.begin());
        const Slot slot{.a_m = pair.a_m,
                        .b_m = pair.b_m,
                        .radius = pair.radius,
                        .whole_rings = rings,
                        .from = rings > 0 ? rings_[rings - 1] : 0.0,
                        .end = std::min(none * none, resolved)};
        const auto same = std::find_if(slots_.begin(), slots_.end(), [&](const Slot& other) {
            return other.a_m == slot.a_m && other.b_m == slot.b_m && other.radius == slot.radius;
        });
        slot_of_pair_.push_back(same - slots_.begin());
        if (same == slots_.end()) slots_.push_back(slot);
    }
}

void LevelSums::add(void (*moments)(const MomentArgs&), const ColumnSums& column, int mx, int height,
                    Part& part) const {
    const auto add_range = [&](int first, int end, double a_m, double b_m, MomentLanes& sum) {
        if (first < end)
            moments({.column = column,
                     .mx = mx,
                     .first_my = first,
                     .end_my = end,
                     .step = step_,
                     .filter = filter_,
                     .footprint_a = a_m,
                     .footprint_b = b_m,
                     .sum = &sum});
    };
    int my = 0;
    for (std::size_t ring = 0; ring < rings_.size() && my <= height; ++ring) {
        const int end = first_beyond(rings_[ring], mx, height + 1);
        add_range(my, end, 0.0, 0.0, part[ring]);
        my = end;
    }
    for (std::size_t s = 0; s < slots_.size(); ++s) {
        const Slot& slot = slots_[s];
        add_range(first_beyond(slot.from, mx, height + 1), first_beyond(slot.end, mx, height + 1), slot.a_m,
                  slot.b_m, part[rings_.size() + s]);
    }
}

SpectralMoments LevelSums::finish(const std::vector<Part>& parts) const {
    std::vector<SpectralMoments> sums(rings_.size() + slots_.size());
    for (const Part& part : parts)
        for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += sum_of_lanes(part[i]);
    std::vector<SpectralMoments> within(rings_.size() + 1);  // sums of the first rings
    for (std::size_t ring = 0; ring < rings_.size(); ++ring) (within[ring + 1] = within[ring]) += sums[ring];
    for (std::size_t p = 0; p < pairs_.size(); ++p) {
        const std::size_t slot = slot_of_pair_[p];
        *pairs_[p].sum += within[slots_[slot].whole_rings];
        *pairs_[p].sum += sums[rings_.size() + slot];
    }
    return within.back();
}

}  // namespace pelagic
