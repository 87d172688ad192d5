#include "core/evaluate/kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/evaluate/kernels.cpp"
#include <hwy/foreach_target.h>
// foreach_target first: it includes this file once for each instruction set.
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>

#include "core/base/pack-inl.h"
#include "core/plan/copies.h"
#include "core/plan/grid_layout.h"

HWY_BEFORE_NAMESPACE();
namespace pelagic {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace {  // names are this file's own

#include "core/evaluate/surface.inl"
#include "core/plan/filter.inl"
#include "core/waves/spline.inl"
#include "core/waves/whitecaps.inl"
// After filter.inl, of which it is made.
#include "core/plan/copies.inl"

// A point's place in a grid: the node at or below it, and the rest, 0 … 1.
template <class T>
struct Places {
    using Index = hwy::MakeSigned<T>;
    alignas(64) std::array<Index, Chunk<T>::kPoints> node;
    alignas(64) std::array<T, Chunk<T>::kPoints> rest;
};

// A few doubles as numbers of T's own width.
template <class DD, class V>
HWY_INLINE auto Index(DD, V v, float /*width*/) {
    return hn::DemoteTo(hn::Rebind<std::int32_t, DD>(), v);
}
template <class DD, class V>
HWY_INLINE auto Index(DD, V v, double /*width*/) {
    return hn::ConvertTo(hn::RebindToSigned<DD>(), v);
}
template <class DD, class V>
HWY_INLINE auto Narrow(DD, V v, float /*width*/) {
    return hn::DemoteTo(hn::Rebind<float, DD>(), v);
}
template <class DD, class V>
HWY_INLINE V Narrow(DD, V v, double /*width*/) {
    return v;
}
template <class DD>
HWY_INLINE auto Widen(DD dd, const float* from) {
    return hn::PromoteTo(dd, hn::LoadU(hn::Rebind<float, DD>(), from));
}
template <class DD>
HWY_INLINE auto Widen(DD dd, const double* from) {
    return hn::LoadU(dd, from);
}

// Along one axis, in double: exact wherever in the world the origin is. A place that is no number, or so far
// that nothing of it is left, becomes 0.
template <class T>
void Locate(const GridArgs<T>& args, double origin_nodes, const double* nodes_of, const T* rest_m,
            std::size_t count, Places<T>& places) {
    const hn::ScalableTag<double> dd;
    using Wide = decltype(dd);
    const hn::Rebind<T, Wide> narrow;
    const hn::Rebind<hwy::MakeSigned<T>, Wide> index;
    const auto n = hn::Set(dd, args.n), per_n = hn::Set(dd, 1.0 / args.n);
    const auto scale = hn::Set(dd, args.nodes_per_m), origin = hn::Set(dd, origin_nodes);
    for (std::size_t i = 0; i < count; i += hn::Lanes(dd)) {
        const auto nodes =
            hn::MulAdd(Widen(dd, rest_m + i), scale, nodes_of ? hn::LoadU(dd, nodes_of + i) : origin);
        auto inside = hn::NegMulAdd(hn::Floor(hn::Mul(nodes, per_n)), n, nodes);
        // −1e-20 is rounded up to n itself, and the quotient may be off by a unit in its last place.
        inside = hn::IfThenElse(hn::Lt(inside, hn::Zero(dd)), hn::Add(inside, n), inside);
        inside = hn::IfThenElse(hn::Ge(inside, n), hn::Sub(inside, n), inside);
        inside = hn::IfThenElseZero(hn::And(hn::Ge(inside, hn::Zero(dd)), hn::Lt(inside, n)), inside);
        auto node = args.sampling == Sampling::Nodes ? hn::Round(inside) : hn::Floor(inside);
        const auto rest = hn::Sub(inside, node);
        node = hn::IfThenElse(hn::Lt(node, n), node, hn::Zero(dd));
        hn::StoreU(Index(dd, node, T()), index, places.node.data() + i);
        hn::StoreU(Narrow(dd, rest, T()), narrow, places.rest.data() + i);
    }
}

// Along one axis, in double as well.
template <class T>
void PlaceCopies(const CopyAxisArgs& args, const T* rest_m, std::size_t count, CopyAxis<T>& axis) {
    const hn::ScalableTag<double> dd;
    using Wide = decltype(dd);
    const hn::Rebind<T, Wide> narrow;
    const hn::Rebind<hwy::MakeSigned<T>, Wide> index;
    const auto scale = hn::Set(dd, args.cells_per_m), origin = hn::Set(dd, args.origin_from_middle);
    const auto half = hn::Set(dd, 0.5), most = hn::Set(dd, kFarthestCell);
    for (std::size_t i = 0; i < count; i += hn::Lanes(dd)) {
        auto cells = hn::MulAdd(Widen(dd, rest_m + i), scale, origin);
        cells = hn::IfThenElseZero(hn::Lt(hn::Abs(cells), most), cells);  // no number, or no place
        const auto cell = hn::Floor(hn::Add(cells, half));
        hn::StoreU(Index(dd, cell, T()), index, axis.code.data() + i);
        hn::StoreU(Narrow(dd, hn::Sub(cells, cell), T()), narrow, axis.rate.data() + i);
    }
    const hn::ScalableTag<T> d;
    using N = Pack<decltype(d)>;
    const hn::RebindToSigned<decltype(d)> di;
    const auto per_m = hn::Set(d, static_cast<T>(args.cells_per_m)), none = hn::Zero(d);
    for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
        const auto from_middle = hn::LoadU(d, axis.rate.data() + i);
        const CopyWeights<N> weights = copy_weights(N(hn::Abs(from_middle)));
        const auto side =
            hn::IfThenElse(hn::RebindMask(di, hn::Lt(from_middle, none)), hn::Set(di, 3), hn::Set(di, 1));
        const auto shown = hn::IfThenElseZero(hn::RebindMask(di, hn::Gt(weights.next.v, none)), side);
        const auto cell = hn::LoadU(di, axis.code.data() + i);
        hn::StoreU(hn::Add(hn::ShiftLeft<2>(cell), shown), di, axis.code.data() + i);
        hn::StoreU(weights.own.v, d, axis.own.data() + i);
        hn::StoreU(weights.next.v, d, axis.next.data() + i);
        hn::StoreU(hn::CopySignToAbs(hn::Mul(weights.rate.v, per_m), from_middle), d, axis.rate.data() + i);
    }
}

template <class T>
ChunkSpan<T> SpanOf(const Chunk<T>& chunk) {
    const hn::ScalableTag<T> d;
    const std::size_t lanes = hn::Lanes(d);
    ChunkSpan<T> span;
    const auto along = [&](const T* at, T& low, T& high) HWY_ATTR {
        low = high = at[0];
        T none = T(0);  // no number as soon as one isn't, or is infinite
        std::size_t i = 0;
        if (chunk.count >= lanes) {
            auto least = hn::LoadU(d, at), most = least, nones = hn::Mul(least, hn::Zero(d));
            for (i = lanes; i + lanes <= chunk.count; i += lanes) {
                const auto here = hn::LoadU(d, at + i);
                least = hn::Min(least, here);
                most = hn::Max(most, here);
                nones = hn::MulAdd(here, hn::Zero(d), nones);
            }
            none = hn::GetLane(hn::SumOfLanes(d, nones));
            low = hn::GetLane(hn::MinOfLanes(d, least));
            high = hn::GetLane(hn::MaxOfLanes(d, most));
        }
        for (; i < chunk.count; ++i) {
            low = std::min(low, at[i]);
            high = std::max(high, at[i]);
            none += at[i] * T(0);
        }
        span.is_finite = span.is_finite && none == T(0);
    };
    along(chunk.rest_x.data(), span.low_x, span.high_x);
    along(chunk.rest_y.data(), span.low_y, span.high_y);
    return span;
}

template <class T>
void AddNodes(const GridArgs<T>& args, Chunk<T>& chunk, const Places<T>& x, const Places<T>& y) {
    const hn::ScalableTag<T> d;
    const hn::RebindToSigned<decltype(d)> di;
    const auto stride = hn::Set(di, static_cast<hwy::MakeSigned<T>>(line_stride<T>(args.n)));
    const std::size_t lanes = hn::Lanes(d);
    for (std::size_t i = 0; i < chunk.count; i += lanes) {
        const auto first = hn::LoadU(di, x.node.data() + i);
        // Points that cross the tile's seam are read one by one: that is rare, although the row's extra
        // columns would allow a run.
        const auto at = hn::Add(hn::Mul(hn::LoadU(di, y.node.data() + i), stride), first);
        const auto begin = hn::GetLane(at);
        const bool run = hn::AllTrue(di, hn::Eq(at, hn::Add(hn::Set(di, begin), hn::Iota(di, 0))));
        for (std::size_t f = 0; f < kFieldCount; ++f) {
            if (!args.samples[f]) continue;
            auto value =
                run ? hn::LoadU(d, args.samples[f] + begin) : hn::GatherIndex(d, args.samples[f], at);
            if (const T* weight = weight_of(args, f)) value = hn::Mul(value, hn::LoadU(d, weight + i));
            T* sum = chunk.sums[f].data() + i;
            hn::StoreU(hn::Add(hn::LoadU(d, sum), value), d, sum);
        }
    }
}

// Points of one run have the same y and lie close together in x, as those of a patch do: the rows that they
// need are added up once, and what is left is a sum along x. A run may be a single point.
template <int P, class T>
void AddSpline(const GridArgs<T>& args, Chunk<T>& chunk, const Places<T>& x, const Places<T>& y) {
    constexpr std::size_t kTaps = P <= 4 ? 4 : 8;  // with zeros behind the last
    const hn::CappedTag<T, kTaps> taps;
    const hn::ScalableTag<T> d;
    const hn::CappedTag<T, 1> one;
    const std::size_t lanes = hn::Lanes(d), stride = line_stride<T>(args.n);
    const int n = args.n;
    const std::size_t count = args.count > 0 ? args.count : chunk.count;

    // Each point's weights along x, side by side.
    alignas(64) T weights[Chunk<T>::kPoints][kTaps];
    for (std::size_t i = 0; i < count; i += lanes) {
        Pack<decltype(d)> w[P];
        bspline_weights<P>(Pack<decltype(d)>(hn::LoadU(d, x.rest.data() + i)), w);
        alignas(64) T column[P][64 / sizeof(T)];
        for (int p = 0; p < P; ++p) hn::StoreU(w[p].v, d, column[p]);
        for (std::size_t j = 0; j < std::min(lanes, Chunk<T>::kPoints - i); ++j)
            for (std::size_t p = 0; p < kTaps; ++p) weights[i + j][p] = p < P ? column[p][j] : T(0);
    }
    const auto first_column = [&](std::size_t i) {
        const int column = static_cast<int>(x.node[i]) - P / 2 + 1;
        return column < 0 ? column + n : column;
    };

    // A run pays for the columns that it spans, and saves P − 1 rows of its points: beyond a few columns a
    // point, or across the seam of the period, the next one begins.
    constexpr int kColumnsPerPoint = 4;
    constexpr std::size_t kColumns = kColumnsPerPoint * Chunk<T>::kPoints + 2 * kTaps + 64 / sizeof(T);
    alignas(64) T columns[kColumns];
    for (std::size_t begin = 0, end; begin < count; begin = end) {
        int low = first_column(begin), high = low;
        for (end = begin + 1; end < count; ++end) {
            if (y.node[end] != y.node[begin] || y.rest[end] != y.rest[begin]) break;
            const int column = first_column(end);
            const int lower = std::min(low, column), upper = std::max(high, column);
            if (upper - lower > kColumnsPerPoint * static_cast<int>(end - begin + 1)) break;
            low = lower;
            high = upper;
        }
        Pack<decltype(one)> row_weight[P];
        bspline_weights<P>(Pack<decltype(one)>(hn::Set(one, y.rest[begin])), row_weight);
        std::size_t row[P];
        for (int p = 0; p < P; ++p) {
            int at = static_cast<int>(y.node[begin]) - P / 2 + 1 + p;
            // n may be smaller than the number of taps; a division for each row would cost more than the sums.
            while (at < 0) at += n;
            while (at >= n) at -= n;
            row[p] = static_cast<std::size_t>(at) * stride + low;
        }
        if (end == begin + 1) {  // scattered: rows and columns at once, nothing kept between
            for (std::size_t f = 0; f < kFieldCount; ++f) {
                const T* samples = args.samples[f];
                if (!samples) continue;
                auto sum = hn::Zero(taps);
                for (std::size_t k = 0; k < kTaps; k += hn::Lanes(taps)) {
                    auto column = hn::Mul(hn::Set(taps, hn::GetLane(row_weight[0].v)),
                                          hn::LoadU(taps, samples + row[0] + k));
                    for (int p = 1; p < P; ++p)
                        column = hn::MulAdd(hn::Set(taps, hn::GetLane(row_weight[p].v)),
                                            hn::LoadU(taps, samples + row[p] + k), column);
                    sum = hn::MulAdd(column, hn::Load(taps, weights[begin] + k), sum);
                }
                const T value = hn::GetLane(hn::SumOfLanes(taps, sum));
                const T* weight = weight_of(args, f);
                const std::size_t to = args.first + begin;
                chunk.sums[f][to] += weight ? weight[to] * value : value;
            }
            continue;
        }
        const std::size_t span = static_cast<std::size_t>(high - low) + kTaps;
        for (std::size_t f = 0; f < kFieldCount; ++f) {
            const T* samples = args.samples[f];
            if (!samples) continue;
            for (std::size_t k = 0; k < span; k += lanes) {
                auto sum =
                    hn::Mul(hn::Set(d, hn::GetLane(row_weight[0].v)), hn::LoadU(d, samples + row[0] + k));
                for (int p = 1; p < P; ++p)
                    sum = hn::MulAdd(hn::Set(d, hn::GetLane(row_weight[p].v)),
                                     hn::LoadU(d, samples + row[p] + k), sum);
                hn::StoreU(sum, d, columns + k);
            }
            const T* weight = weight_of(args, f);
            for (std::size_t i = begin; i < end; ++i) {
                const T* from = columns + (first_column(i) - low);
                auto sum = hn::Zero(taps);
                for (std::size_t k = 0; k < kTaps; k += hn::Lanes(taps))
                    sum = hn::MulAdd(hn::LoadU(taps, from + k), hn::Load(taps, weights[i] + k), sum);
                const T value = hn::GetLane(hn::SumOfLanes(taps, sum));
                const std::size_t to = args.first + i;
                chunk.sums[f][to] += weight ? weight[to] * value : value;
            }
        }
    }
}

template <class T>
void AddGrid(const GridArgs<T>& args, Chunk<T>& chunk) {
    Places<T> x, y;  // a vector's last lanes are somewhere in the grid, too
    const std::size_t count = args.count > 0 ? Chunk<T>::padded(args.count) : chunk.padded();
    Locate(args, args.origin_nodes_x, args.nodes_x, chunk.rest_x.data() + args.first, count, x);
    Locate(args, args.origin_nodes_y, args.nodes_y, chunk.rest_y.data() + args.first, count, y);
    if (args.sampling == Sampling::Nodes)
        AddNodes(args, chunk, x, y);
    else if (args.taps == 6)
        AddSpline<6>(args, chunk, x, y);
    else
        AddSpline<4>(args, chunk, x, y);
}

// Of a vector of points, those that there are.
template <class D, class T = hn::TFromD<D>>
HWY_INLINE void Put(D d, const Strided<glm::vec<3, T>>& out, std::size_t i, std::size_t count,
                    const std::array<Pack<D>, 3>& value) {
    const std::size_t lanes = hn::Lanes(d);
    if (out.stride_bytes == 3 * sizeof(T) && i + lanes <= count) {
        hn::StoreInterleaved3(value[0].v, value[1].v, value[2].v, d, &out[i].x);
        return;
    }
    alignas(64) T axis[3][64 / sizeof(T)];
    for (int a = 0; a < 3; ++a) hn::Store(value[a].v, d, axis[a]);
    for (std::size_t j = 0; j < std::min(lanes, count - i); ++j)
        out[i + j] = glm::vec<3, T>(axis[0][j], axis[1][j], axis[2][j]);
}
template <class D, class T = hn::TFromD<D>>
HWY_INLINE void Put(D d, const Strided<T>& out, std::size_t i, std::size_t count, Pack<D> value) {
    const std::size_t lanes = hn::Lanes(d);
    if (out.stride_bytes == sizeof(T) && i + lanes <= count) {
        hn::StoreU(value.v, d, &out[i]);
        return;
    }
    alignas(64) T values[64 / sizeof(T)];
    hn::Store(value.v, d, values);
    for (std::size_t j = 0; j < std::min(lanes, count - i); ++j) out[i + j] = values[j];
}

// What a chunk's pixels hide, as vectors: by point, or the same for all.
template <class T>
class Hidden {
  public:
    using D = hn::ScalableTag<T>;
    using N = Pack<D>;
    HWY_INLINE explicit Hidden(const DeriveArgs<T>& args) : args_(args) {
        if (args.hidden_of) return;
        const HiddenStrain<N> strain = strain_at(0);
        const StrainTraces<N> traces = strain_traces(strain);
        hn::Store(traces.second.v, D(), second_);
        hn::Store(traces.third.v, D(), third_);
    }
    HWY_INLINE N moment_at(std::size_t moment, std::size_t i) const {
        return args_.hidden_of ? N(hn::LoadU(D(), args_.hidden_of->moments[moment].data() + i))
                               : N(args_.hidden[moment]);
    }
    HWY_INLINE HiddenStrain<N> strain_at(std::size_t i) const {
        return {moment_at(kHiddenSlopes, i), moment_at(kHiddenSlopes + 1, i), moment_at(kHiddenSlopes + 2, i),
                moment_at(kHiddenSlopes + 3, i), moment_at(kHiddenSlopes + 4, i)};
    }
    HWY_INLINE StrainTraces<N> traces_of(const HiddenStrain<N>& strain) const {
        if (args_.hidden_of) return strain_traces(strain);
        return {N(hn::Load(D(), second_)), N(hn::Load(D(), third_))};
    }

  private:
    const DeriveArgs<T>& args_;
    alignas(64) T second_[64 / sizeof(T)], third_[64 / sizeof(T)];
};

// J in a chunk's pixels, and the coverage that follows: two loops, because the second is one long chain of
// operations, of which a CPU has more under way at once when they stand alone.
template <class T>
void DeriveWhitecaps(const DeriveArgs<T>& args) {
    using D = hn::ScalableTag<T>;
    using N = Pack<D>;
    const D d;
    const Chunk<T>& chunk = *args.chunk;
    const Hidden<T> hidden(args);
    const auto moments = args.results.vectors(Product::JacobianMoments);
    const auto foam = args.results.numbers(Product::Coverage);
    alignas(64) typename Chunk<T>::Values mean, variance, third;
    for (std::size_t i = 0; i < chunk.count; i += hn::Lanes(d)) {
        const auto at = [&](Field field) HWY_ATTR {
            return N(hn::LoadU(d, args.breaking->sums[index(field)].data() + i));
        };
        const HiddenStrain<N> strain = hidden.strain_at(i);
        const JacobianMoments<N> j =
            jacobian_moments(at(Field::Dxx), at(Field::Dyy), at(Field::Dxy),
                             at(Field::Dxy) + N(hn::LoadU(d, args.breaking->turn.data() + i)), strain,
                             hidden.traces_of(strain));
        if (moments) Put(d, moments, i, chunk.count, std::array<N, 3>{j.mean, j.variance, j.third});
        hn::StoreU(j.mean.v, d, mean.data() + i);
        hn::StoreU(j.variance.v, d, variance.data() + i);
        hn::StoreU(j.third.v, d, third.data() + i);
    }
    if (!foam) return;
    const auto cover = [&](const auto& threshold_at) HWY_ATTR {
        for (std::size_t i = 0; i < chunk.count; i += hn::Lanes(d)) {
            const JacobianMoments<N> j{N(hn::LoadU(d, mean.data() + i)), N(hn::LoadU(d, variance.data() + i)),
                                       N(hn::LoadU(d, third.data() + i))};
            Put(d, foam, i, chunk.count, coverage(j, threshold_at(i), args.third_moment));
        }
    };
    if (const T* of = args.whitecap_threshold_of)
        cover([&](std::size_t i) HWY_ATTR { return N(hn::LoadU(d, of + i)); });
    else
        cover([&](std::size_t) HWY_ATTR { return N(args.whitecap_threshold); });
}

template <class T>
void Derive(const DeriveArgs<T>& args) {
    using D = hn::ScalableTag<T>;
    using N = Pack<D>;
    const D d;
    const Chunk<T>& chunk = *args.chunk;
    const Results<T>& results = args.results;
    const std::size_t count = chunk.count;
    const auto at = [&](Field field, std::size_t i)
                        HWY_ATTR { return N(hn::LoadU(d, chunk.sums[index(field)].data() + i)); };
    const auto dyx = [&](std::size_t i)
                         HWY_ATTR { return at(Field::Dxy, i) + N(hn::LoadU(d, chunk.turn.data() + i)); };
    using Vector = std::array<N, 3>;
    const auto each = [&](const Strided<glm::vec<3, T>>& out, const auto& value) HWY_ATTR {
        if (!out) return;
        for (std::size_t i = 0; i < count; i += hn::Lanes(d)) Put(d, out, i, count, value(i));
    };
    each(results.vectors(Product::Displacement), [&](std::size_t i) HWY_ATTR {
        return Vector{at(Field::Dx, i), at(Field::Dy, i), at(Field::Height, i)};
    });
    each(results.vectors(Product::Position), [&](std::size_t i) HWY_ATTR {
        return Vector{at(Field::Dx, i) + N(hn::LoadU(d, chunk.rest_x.data() + i)),
                      at(Field::Dy, i) + N(hn::LoadU(d, chunk.rest_y.data() + i)), at(Field::Height, i)};
    });
    each(results.vectors(Product::Velocity), [&](std::size_t i) HWY_ATTR {
        return Vector{at(Field::VelocityX, i), at(Field::VelocityY, i), at(Field::VelocityZ, i)};
    });
    each(results.vectors(Product::Normal), [&](std::size_t i) HWY_ATTR {
        const SurfaceNormal<N> normal =
            surface_normal(at(Field::SlopeX, i), at(Field::SlopeY, i), at(Field::Dxx, i), at(Field::Dyy, i),
                           at(Field::Dxy, i), dyx(i));
        return Vector{normal.x, normal.y, normal.z};
    });
    const Hidden<T> hidden(args);
    const auto at_rest = [&](std::size_t i) HWY_ATTR {
        return SlopeVariances<N>{hidden.moment_at(0, i), hidden.moment_at(2, i), hidden.moment_at(1, i)};
    };
    each(results.vectors(Product::SlopeVariance), [&](std::size_t i) HWY_ATTR {
        const SlopeVariances<N> carried =
            carried_slopes(at_rest(i), at(Field::Dxx, i), at(Field::Dyy, i), at(Field::Dxy, i), dyx(i));
        return Vector{carried.xx, carried.yy, carried.xy};
    });
    each(results.vectors(Product::SlopeVarianceAtRest), [&](std::size_t i) HWY_ATTR {
        const SlopeVariances<N> rest = at_rest(i);
        return Vector{rest.xx, rest.yy, rest.xy};
    });
    if (results.holds(Product::JacobianMoments) || results.holds(Product::Coverage)) DeriveWhitecaps(args);
}

EvaluateKernels<float> TableOfFloat() {
    return {&AddGrid<float>, &Derive<float>, &SpanOf<float>, &PlaceCopies<float>};
}
EvaluateKernels<double> TableOfDouble() {
    return {&AddGrid<double>, &Derive<double>, &SpanOf<double>, &PlaceCopies<double>};
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace pelagic
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelagic {
HWY_EXPORT(TableOfFloat);
HWY_EXPORT(TableOfDouble);

template <>
EvaluateKernels<float> evaluate_kernels() {
    return HWY_DYNAMIC_DISPATCH(TableOfFloat)();
}
template <>
EvaluateKernels<double> evaluate_kernels() {
    return HWY_DYNAMIC_DISPATCH(TableOfDouble)();
}

}  // namespace pelagic
#endif
