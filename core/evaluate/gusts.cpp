#include "core/evaluate/gusts.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/evaluate/gusts.cpp"
#include <hwy/foreach_target.h>
// foreach_target first: it includes this file once for each instruction set.
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>

#include "core/base/pack-inl.h"
#include "core/base/sincos-inl.h"
#include "core/plan/filter.h"

HWY_BEFORE_NAMESPACE();
namespace pelagic {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace {  // names are this file's own

template <class D>
HWY_INLINE Pack<D> sine_of_cycles(Pack<D> cycles) {
    hn::Vec<D> sine, cosine;
    SinCosCycles(D(), cycles.v, sine, cosine);
    return sine;
}
template <class D>
HWY_INLINE Pack<D> cosine_of_cycles(Pack<D> cycles) {
    hn::Vec<D> sine, cosine;
    SinCosCycles(D(), cycles.v, sine, cosine);
    return cosine;
}

#include "core/plan/filter.inl"
#include "core/plan/masks.inl"
#include "core/waves/gusts.inl"

template <class N, class Terms>
HWY_INLINE N ValueOf(const Terms& terms, N x) {
    N sum(0);
    for (std::size_t n = terms.size(); n-- > 0;) sum = sum * x + N(terms[n]);
    return sum;
}

template <class T, class N>
HWY_INLINE N FrontsWind(const GustArgs<T>& args, N x, N y, N width, N axis_x, N axis_y, N level) {
    const GustsPlan& plan = args.gusts->plan;
    const N beyond = N(0.5) * maximum(width, square_root(axis_x * axis_x + axis_y * axis_y));
    N wind(1);
    for (std::size_t f = 0; f < plan.fronts.size(); ++f) {
        const GustsPlan::Front& front = plan.fronts[f];
        const glm::dvec2 from = args.phases->from_fronts[f];
        const N east = x + N(from.x), north = y + N(from.y), reach = N(front.reach_m) + beyond;
        // Out of reach it is 1, whatever the vector's other points are; what is no number isn't.
        const auto is_beyond = hn::Ge((east * east + north * north).v, (reach * reach).v);
        if (hn::AllTrue(hn::ScalableTag<T>(), is_beyond)) continue;
        const N along_x(front.along.x), along_y(front.along.y);
        const N own = front_wind(
            east, north, along_x, along_y, N(front.half_m.x), N(front.half_m.y), N(front.edge_m),
            square_root(length2_along(width, axis_x, axis_y, along_x, along_y)),
            square_root(length2_along(width, axis_x, axis_y, -along_y, along_x)), N(front.wind), level);
        wind = wind * select(is_beyond, N(1), own);
    }
    return minimum(maximum(wind, N(plan.weakest)), N(plan.strongest));
}

// What fronts of a wind add to the threshold.
template <class N>
HWY_INLINE N FrontsThreshold(const Gusts& gusts, N wind, N kept) {
    N even(0), patchy(0);
    const auto add = [&](const Gusts::Bend& bend, N farther) {
        farther = maximum(farther, N(0));
        even += N(bend.even) * farther;
        patchy += N(bend.patchy) * farther;
    };
    for (const Gusts::Bend& bend : gusts.stronger) add(bend, wind - N(bend.wind));
    for (const Gusts::Bend& bend : gusts.weaker) add(bend, N(bend.wind) - wind);
    return even + patchy * patchy_share(kept);
}

template <class T>
void GustsAt(const GustArgs<T>& args, GustChunk<T>& chunk) {
    using D = hn::ScalableTag<T>;
    using N = Pack<D>;
    const D d;
    const FootprintFilter filter;
    const N n_min(filter.n_min), per_range(1.0 / (filter.n_max - filter.n_min));
    const bool has_fronts = !args.gusts->plan.fronts.empty();
    for (std::size_t i = 0; i < args.padded; i += hn::Lanes(d)) {
        const N x(hn::Load(d, args.rest_x + i)), y(hn::Load(d, args.rest_y + i));
        const N width(hn::Load(d, chunk.width_m.data() + i));
        N axis_x(0), axis_y(0);
        if (chunk.has_ellipses) {
            axis_x = hn::Load(d, chunk.axis_x.data() + i);
            axis_y = hn::Load(d, chunk.axis_y.data() + i);
        }
        GustSum<N> sum{};
        for (std::size_t w = 0; w < GustsPlan::kWaves; ++w) {
            const GustsPlan::Wave& wave = args.gusts->plan.waves[w];
            const N cycles =
                x * N(wave.cycles_per_m.x) + y * N(wave.cycles_per_m.y) + N(args.phases->cycles[w]);
            const N length =
                square_root(length2_along(width, axis_x, axis_y, N(wave.along.x), N(wave.along.y)));
            const N weight = footprint_weight(N(wave.shortest_m) / length, n_min, per_range);
            sum = with_gust(sum, N(wave.amplitude), cycles, weight);
        }
        const N level = gust_level(sum.resolved);
        N factor = N(1) + N(args.gusts->plan.strength) * level;
        N threshold = ValueOf(args.gusts->of_level, level) + ValueOf(args.gusts->of_kept, sum.kept);
        if (has_fronts) {
            const N wind = FrontsWind(args, x, y, width, axis_x, axis_y, level);
            factor = factor * wind;
            // Beyond all fronts it stays as it is, to the bit.
            if (!hn::AllTrue(d, hn::Eq(wind.v, N(1).v)))
                threshold = minimum(threshold + FrontsThreshold(*args.gusts, wind, sum.kept),
                                    maximum(threshold, N(args.gusts->most)));
        }
        hn::Store(factor.v, d, chunk.factor.data() + i);
        hn::Store(threshold.v, d, chunk.whitecap_threshold.data() + i);
    }
}

void GustsOfFloat(const GustArgs<float>& args, GustChunk<float>& chunk) {
    GustsAt(args, chunk);
}
void GustsOfDouble(const GustArgs<double>& args, GustChunk<double>& chunk) {
    GustsAt(args, chunk);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace pelagic
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelagic {
HWY_EXPORT(GustsOfFloat);
HWY_EXPORT(GustsOfDouble);

template <>
void gusts_at(const GustArgs<float>& args, GustChunk<float>& chunk) {
    HWY_DYNAMIC_DISPATCH(GustsOfFloat)(args, chunk);
}
template <>
void gusts_at(const GustArgs<double>& args, GustChunk<double>& chunk) {
    HWY_DYNAMIC_DISPATCH(GustsOfDouble)(args, chunk);
}

GustPhases gust_phases(const GustsPlan& plan, glm::dvec2 origin_m, double time_within_loop_s) {
    return {plan.cycles_at(origin_m, time_within_loop_s), plan.from_fronts(origin_m, time_within_loop_s)};
}

template <class T>
void GustChunk<T>::take(const Points<T>& points, T only_m, std::size_t first, std::size_t count) {
    constexpr std::size_t kLongest = Chunk<T>::kLongestVector;
    const std::size_t padded = (count + kLongest - 1) / kLongest * kLongest;
    std::fill_n(width_m.begin(), padded, only_m);
    if (points.pixel_m)
        for (std::size_t i = 0; i < count; ++i) {
            const T width = points.pixel_m[first + i];
            width_m[i] = width > only_m ? width : only_m;  // also where it is no number
        }
    has_ellipses = static_cast<bool>(points.pixel_axis_m);
    if (!has_ellipses) return;
    std::fill_n(axis_x.begin(), padded, T(0));
    std::fill_n(axis_y.begin(), padded, T(0));
    for (std::size_t i = 0; i < count; ++i) {
        const glm::vec<2, T> axis = points.pixel_axis_m[first + i];
        if (!std::isfinite(axis.x * axis.x + axis.y * axis.y)) continue;
        axis_x[i] = axis.x;
        axis_y[i] = axis.y;
    }
}

template <class T>
void whitecap_thresholds(const Gusts& gusts, double time_within_loop_s, const Points<T>& points,
                         double pixel_m, std::span<float> thresholds) {
    const GustPhases phases = gust_phases(gusts.plan, points.origin_m, time_within_loop_s);
    Chunk<T> chunk;
    GustChunk<T> of;
    for (std::size_t first = 0; first < points.count; first += Chunk<T>::kPoints) {
        chunk.count = std::min(Chunk<T>::kPoints, points.count - first);
        std::fill_n(chunk.rest_x.begin(), chunk.padded(), T(0));
        std::fill_n(chunk.rest_y.begin(), chunk.padded(), T(0));
        for (std::size_t i = 0; i < chunk.count; ++i) {
            chunk.rest_x[i] = points.rest_m[first + i].x;
            chunk.rest_y[i] = points.rest_m[first + i].y;
        }
        of.take(points, static_cast<T>(pixel_m), first, chunk.count);
        gusts_at<T>({.gusts = &gusts,
                     .phases = &phases,
                     .rest_x = chunk.rest_x.data(),
                     .rest_y = chunk.rest_y.data(),
                     .padded = chunk.padded()},
                    of);
        for (std::size_t i = 0; i < chunk.count; ++i)
            thresholds[first + i] = static_cast<float>(of.whitecap_threshold[i]);
    }
}

template struct GustChunk<float>;
template struct GustChunk<double>;
template void whitecap_thresholds(const Gusts&, double, const Points<float>&, double, std::span<float>);
template void whitecap_thresholds(const Gusts&, double, const Points<double>&, double, std::span<float>);

}  // namespace pelagic
#endif
