#include "core/effects/foam_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/effects/foam_kernels.cpp"
#include <hwy/foreach_target.h>
// foreach_target first: it includes this file once for each instruction set.
#include <hwy/highway.h>

#include <bit>

#include "core/base/pack-inl.h"
#include "core/plan/foam.h"

HWY_BEFORE_NAMESPACE();
namespace pelagic {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace {  // names are this file's own

#include "core/waves/whitecaps.inl"

using D = hn::ScalableTag<float>;
using N = Pack<D>;
using Half = hn::Rebind<std::uint16_t, D>;
using Whole = hn::RebindToUnsigned<D>;

void Place(const FoamAxisArgs& args, std::size_t first, std::size_t end, FoamAxis& axis) {
    const hn::ScalableTag<double> dd;
    const hn::Rebind<std::int32_t, decltype(dd)> index;
    const hn::Rebind<float, decltype(dd)> narrow;
    constexpr double kCells = FoamPlan::kTileCells;
    const auto origin = hn::Set(dd, args.origin_m), per_m = hn::Set(dd, args.cells_per_m);
    for (std::size_t i = first; i < end; i += hn::Lanes(dd)) {
        auto cells = hn::Mul(hn::Add(origin, hn::LoadU(dd, args.rest_m + i)), per_m);
        cells =
            hn::IfThenElseZero(hn::Lt(hn::Abs(cells), hn::Set(dd, 1e15)), cells);  // no number, or no place
        const auto node = hn::Floor(cells), tile = hn::Floor(hn::Mul(node, hn::Set(dd, 1.0 / kCells)));
        hn::StoreU(tile, dd, axis.tile.data() + i);
        hn::StoreU(hn::DemoteTo(index, hn::Sub(node, hn::Mul(tile, hn::Set(dd, kCells)))), index,
                   axis.node.data() + i);
        hn::StoreU(hn::DemoteTo(narrow, hn::Sub(cells, node)), narrow, axis.rest.data() + i);
    }
}

void Between(const ResidualFoam& tile, const FoamAxis& x, const FoamAxis& y, std::size_t first,
             std::size_t end, float* foam, float* aged) {
    const D d;
    const hn::RebindToSigned<D> di;
    constexpr int kSide = FoamPlan::kTileCells + 1;
    for (std::size_t i = first; i < end; i += hn::Lanes(d)) {
        const auto there = hn::FirstN(d, end - i);
        const auto corner =
            hn::IfThenElse(hn::RebindMask(di, there),
                           hn::Add(hn::Mul(hn::LoadU(di, y.node.data() + i), hn::Set(di, kSide)),
                                   hn::LoadU(di, x.node.data() + i)),
                           hn::Set(di, y.node[i] * kSide + x.node[i]));
        const N to_x(hn::LoadU(d, x.rest.data() + i)), to_y(hn::LoadU(d, y.rest.data() + i));
        const auto blend = [&](const auto& at) HWY_ATTR {
            const auto between = [&](const float* v) HWY_ATTR {
                const auto along_x = [&](const float* row) HWY_ATTR {
                    const N from(at(row)), to(at(row + 1));
                    return from + to_x * (to - from);
                };
                const N low = along_x(v), high = along_x(v + kSide);
                return low + to_y * (high - low);
            };
            hn::BlendedStore(between(tile.foam).v, there, d, foam + i);
            hn::BlendedStore(between(tile.aged).v, there, d, aged + i);
        };
        // Corners that lie close together, as those of a patch's row do, are looked up in one vector of them.
        const std::int32_t least = hn::GetLane(hn::MinOfLanes(di, corner));
        if (hn::GetLane(hn::MaxOfLanes(di, corner)) - least < static_cast<std::int32_t>(hn::Lanes(d))) {
            const auto lane = hn::IndicesFromVec(d, hn::Sub(corner, hn::Set(di, least)));
            blend([&](const float* row)
                      HWY_ATTR { return hn::TableLookupLanes(hn::LoadU(d, row + least), lane); });
        } else {
            blend([&](const float* row) HWY_ATTR { return hn::GatherIndex(d, row, corner); });
        }
    }
}

void Add(const ResidualFoam& left, const float* breaking, const float* under, std::size_t count, float* all,
         float* age_s) {
    const D d;
    for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
        const N active(hn::LoadU(d, breaking + i)), foam(hn::LoadU(d, left.foam + i));
        const N residual = residual_foam(foam, active, N(hn::LoadU(d, under + i))), total = active + residual;
        const auto is_left = residual > N(0);
        const N age = residual / select<D>(is_left, total, N(1)) *
                      (N(hn::LoadU(d, left.aged + i)) / select<D>(is_left, foam, N(1)));
        hn::StoreU(total.v, d, all + i);
        hn::StoreU(hn::IfThenElseZero(is_left, age.v), d, age_s + i);
    }
}

void Deviates(const float* mean, const float* variance, const float* third, const float* threshold,
              bool third_moment, std::span<float> y) {
    const D d;
    constexpr float kLeastVariance = 1e-10f;  // where no breaking wave is unresolved, Φ is a step
    for (std::size_t i = 0; i < y.size(); i += hn::Lanes(d)) {
        const N v = maximum(N(hn::LoadU(d, variance + i)), N(kLeastVariance)), sigma = square_root(v);
        N z = (N(hn::LoadU(d, threshold + i)) - N(hn::LoadU(d, mean + i))) / sigma;
        z = minimum(maximum(z, N(-kFarthestFoamDeviate)), N(kFarthestFoamDeviate));
        if (third_moment) z = whitecaps_detail::to_normal(z, N(hn::LoadU(d, third + i)) / v / sigma).y;
        z = minimum(maximum(z, N(-kFarthestFoamDeviate)), N(kFarthestFoamDeviate));
        hn::StoreU(z.v, d, y.data() + i);
    }
}

// Φ(y) and its integral, y Φ(y) + φ(y).
struct Normal {
    N below, integral;
};
HWY_INLINE Normal NormalOf(N y) {
    const N below = N(0.5) * complementary_error(y * N(-0.70710678118654752440));
    return {below, y * below + N(0.39894228040143267794) * exponential(N(-0.5) * y * y)};
}

// The mean of Φ where y goes from a to b evenly.
HWY_INLINE N MeanBetween(N a, const Normal& at_a, N b, const Normal& at_b) {
    constexpr float kLevel = 0.02f;  // nearer, the difference of the integrals has too few digits
    const N way = b - a;
    const auto is_level = magnitude(way) < N(kLevel);
    const N mean = (at_b.integral - at_a.integral) / select<D>(is_level, N(1), way);
    return select<D>(is_level, N(0.5) * (at_a.below + at_b.below), mean);
}

// y at quarters of the interval by the polynomial through all six: breaking is shorter than a step.
constexpr float kQuarter[6] = {0.0093994140625f, -0.0845947265625f, 0.845947265625f,
                               0.281982421875f,  -0.0604248046875f, 0.0076904296875f};
void Share(const float* const y[6], std::span<std::uint16_t> share) {
    const D d;
    const Half half;
    const Whole whole;
    constexpr auto kNothing =
        static_cast<std::uint16_t>((std::bit_cast<std::uint32_t>(kNoFoamShare) + 0x8000u) >> 16);
    for (std::size_t i = 0; i < share.size(); i += hn::Lanes(d)) {
        const auto at = [&](int sample) HWY_ATTR { return N(hn::LoadU(d, y[sample] + i)); };
        const auto near_quarter = [&](int from, int way) HWY_ATTR {
            N y_there(0);
            for (int j = 0; j < 6; ++j) y_there += N(kQuarter[j]) * at(from + way * j);
            return y_there;
        };
        const N middle = N(150.0 / 256.0) * (at(2) + at(3)) - N(25.0 / 256.0) * (at(1) + at(4)) +
                         N(3.0 / 256.0) * (at(0) + at(5));
        const N way[5] = {at(2), near_quarter(0, 1), middle, near_quarter(5, -1), at(3)};
        const N most = maximum(maximum(maximum(way[0], way[1]), maximum(way[2], way[3])), way[4]);
        const auto is_nothing = most < N(kNoFoamDeviate);
        if (hn::AllTrue(d, is_nothing)) {  // so are most nodes at most times
            hn::StoreU(hn::Set(half, kNothing), half, share.data() + i);
            continue;
        }
        Normal before = NormalOf(way[0]);
        N mean(0);
        for (int part = 0; part < 4; ++part) {
            const Normal after = NormalOf(way[part + 1]);
            mean += N(0.25) * MeanBetween(way[part], before, way[part + 1], after);
            before = after;
        }
        mean = select<D>(is_nothing, N(kNoFoamShare), minimum(maximum(mean, N(kNoFoamShare)), N(1)));
        const auto bits = hn::Add(hn::BitCast(whole, mean.v), hn::Set(whole, 0x8000u));
        const auto upper = hn::BitCast(hn::RebindToSigned<Whole>(), hn::ShiftRight<16>(bits));
        hn::StoreU(hn::DemoteTo(half, upper), half, share.data() + i);
    }
}

void Sum(std::span<const FoamShares> shares, std::span<float> foam, std::span<float> age) {
    const D d;
    const Half half;
    const Whole whole;
    for (std::size_t i = 0; i < foam.size(); i += hn::Lanes(d)) {
        auto foam_sum = hn::Zero(d), age_sum = hn::Zero(d);
        for (const FoamShares& of : shares) {
            const auto bits = hn::ShiftLeft<16>(hn::PromoteTo(whole, hn::LoadU(half, of.share + i)));
            const auto share = hn::BitCast(d, bits);
            foam_sum = hn::MulAdd(share, hn::Set(d, of.foam), foam_sum);
            age_sum = hn::MulAdd(share, hn::Set(d, of.age), age_sum);
        }
        hn::StoreU(foam_sum, d, foam.data() + i);
        hn::StoreU(age_sum, d, age.data() + i);
    }
}

FoamKernels Table() {
    return {&Place, &Between, &Add, &Deviates, &Share, &Sum};
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace pelagic
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelagic {
HWY_EXPORT(Table);

FoamKernels foam_kernels() {
    return HWY_DYNAMIC_DISPATCH(Table)();
}

}  // namespace pelagic
#endif
