// A cascade's grids read at a chunk's points, by B-splines or at their nodes, in Highway's vectors.
//
// Included once per instruction set by files that use Highway's foreach_target (its own pattern of guards).
#if defined(PELAGIC_CORE_EVALUATE_GRIDS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PELAGIC_CORE_EVALUATE_GRIDS_INL_H_
#undef PELAGIC_CORE_EVALUATE_GRIDS_INL_H_
#else
#define PELAGIC_CORE_EVALUATE_GRIDS_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "core/base/pack-inl.h"
#include "core/evaluate/kernels.h"
#include "core/plan/grid_layout.h"

HWY_BEFORE_NAMESPACE();
namespace pelagic {
namespace HWY_NAMESPACE {
namespace grids_detail {
namespace hn = hwy::HWY_NAMESPACE;

#include "core/waves/spline.inl"

// By point, with room for a vector that begins at the last one.
template <class T>
constexpr std::size_t kRoom = Chunk<T>::kPoints + Chunk<T>::kLongestVector;

// The points' places in a grid: the node at or below each, and the rest, 0 … 1.
template <class T>
struct Places {
    using Index = hwy::MakeSigned<T>;
    alignas(64) std::array<Index, kRoom<T>> node;
    alignas(64) std::array<T, kRoom<T>> rest;
};

// What a grid has at the points, by field.
template <class T>
using FieldValues = std::array<std::array<T, kRoom<T>>, kFieldCount>;

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
            PointRange range, Places<T>& places) {
    const hn::ScalableTag<double> dd;
    using Wide = decltype(dd);
    const hn::Rebind<T, Wide> narrow;
    const hn::Rebind<hwy::MakeSigned<T>, Wide> index;
    const auto n = hn::Set(dd, args.n), per_n = hn::Set(dd, 1.0 / args.n);
    const auto scale = hn::Set(dd, args.nodes_per_m), origin = hn::Set(dd, origin_nodes);
    for (std::size_t i = range.first; i < range.end; i += hn::Lanes(dd)) {
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

template <class T>
void ReadNodes(const GridArgs<T>& args, PointRange range, const Places<T>& x, const Places<T>& y,
               FieldValues<T>& values) {
    const hn::ScalableTag<T> d;
    const hn::RebindToSigned<decltype(d)> di;
    const auto stride = hn::Set(di, static_cast<hwy::MakeSigned<T>>(line_stride<T>(args.n)));
    const std::size_t lanes = hn::Lanes(d);
    for (std::size_t i = range.first; i < range.end; i += lanes) {
        const std::size_t count = std::min(lanes, range.end - i);
        // Lanes beyond the last point read the first node.
        const auto within = hn::FirstN(di, count);
        const auto first = hn::IfThenElseZero(within, hn::LoadU(di, x.node.data() + i));
        const auto row = hn::IfThenElseZero(within, hn::LoadU(di, y.node.data() + i));
        // Points that cross the tile's seam are read one by one: that is rare, although the row's extra
        // columns would allow a run.
        const auto at = hn::Add(hn::Mul(row, stride), first);
        const auto begin = hn::GetLane(at);
        const bool run = hn::AllTrue(di, hn::Eq(at, hn::Add(hn::Set(di, begin), hn::Iota(di, 0))));
        for (std::size_t f = 0; f < kFieldCount; ++f) {
            if (!args.samples[f]) continue;
            const auto value =
                run ? hn::LoadU(d, args.samples[f] + begin) : hn::GatherIndex(d, args.samples[f], at);
            hn::StoreU(value, d, values[f].data() + i);
        }
    }
}

// A cascade's grid at points, by B-splines of P taps along each axis.
template <int P, class T>
class SplineReader {
  public:
    SplineReader(const GridArgs<T>& args, const Places<T>& x, const Places<T>& y, FieldValues<T>& values)
        : args_(args), x_(x), y_(y), values_(values) {}

    // Points of one run have the same y and lie close together in x, as those of a patch do: the rows that they
    // need are added up once, and what is left is a sum along x.
    void Read(PointRange range) {
        WeighColumns(range);
        WeighRows(range);
        for (std::size_t begin = range.first; begin < range.end;) {
            const Run run = RunFrom(begin, range.end);
            if (run.points.end == begin + 1)
                ReadAlone(begin);
            else
                ReadRun(run);
            begin = run.points.end;
        }
    }

  private:
    using D = hn::ScalableTag<T>;
    using N = Pack<D>;
    static constexpr std::size_t kTaps = P <= 4 ? 4 : 8;  // with zeros behind the last
    // Of at most 256 bits: what a point alone is summed in, and the order of every point's sum.
    using Taps = hn::CappedTag<T, std::min(kTaps, 32 / sizeof(T))>;
    static constexpr int kGroup = static_cast<int>(hn::MaxLanes(Taps()));
    // A run pays for the columns that it spans, and saves P − 1 rows of its points: beyond a few columns a
    // point, or across the seam of the period, the next one begins.
    static constexpr int kColumnsPerPoint = 4;
    static constexpr std::size_t kColumns = kColumnsPerPoint * Chunk<T>::kPoints + P + 4 * (64 / sizeof(T));

    using Index = typename Places<T>::Index;

    struct Run {
        PointRange points;
        Index low, high;  // its first columns
    };
    struct Rows {
        std::size_t at[P];  // where they begin
        T weight[P];
    };

    // The points' weights along x, and the first of each one's columns.
    void WeighColumns(PointRange range) {
        const D d;
        const hn::RebindToSigned<D> di;
        const std::size_t lanes = hn::Lanes(d);
        const auto n = hn::Set(di, args_.n), before = hn::Set(di, P / 2 - 1), none = hn::Zero(di);
        for (std::size_t i = range.first; i < range.end; i += lanes) {
            N w[P];
            bspline_weights<P>(N(hn::LoadU(d, x_.rest.data() + i)), w);
            for (int p = 0; p < P; ++p) hn::StoreU(w[p].v, d, column_weights_[p].data() + i);
            const auto column = hn::Sub(hn::LoadU(di, x_.node.data() + i), before);
            hn::StoreU(hn::Add(column, hn::IfThenElseZero(hn::Lt(column, none), n)), di, column_.data() + i);
        }
    }

    // The points' weights along y.
    void WeighRows(PointRange range) {
        const D d;
        N before, w[P];
        bool is_first = true;
        for (std::size_t i = range.first; i < range.end; i += hn::Lanes(d)) {
            const auto rest = hn::LoadU(d, y_.rest.data() + i);
            // In a row of a patch all points have one place between two rows.
            if (is_first || !hn::AllTrue(d, hn::Eq(rest, before.v))) bspline_weights<P>(N(rest), w);
            before = rest;
            is_first = false;
            for (int p = 0; p < P; ++p) hn::StoreU(w[p].v, d, row_weights_[p].data() + i);
        }
    }

    Run RunFrom(std::size_t begin, std::size_t last) const {
        const hn::ScalableTag<T> d;
        const hn::RebindToSigned<decltype(d)> di;
        const std::size_t lanes = hn::Lanes(d);
        Run run{{begin, begin + 1}, column_[begin], column_[begin]};
        if (begin + 1 == last || y_.node[begin + 1] != y_.node[begin]) return run;
        const auto node = hn::Set(di, y_.node[begin]);
        const auto rest = hn::Set(d, y_.rest[begin]);
        const auto grow = [&](Index low, Index high, std::size_t count) {
            low = std::min(run.low, low);
            high = std::max(run.high, high);
            if (high - low > kColumnsPerPoint * static_cast<Index>(run.points.end - begin + count))
                return false;
            run.low = low;
            run.high = high;
            run.points.end += count;
            return true;
        };
        // A vector of points at a time, as long as all of them belong to it.
        for (std::size_t& end = run.points.end; end + lanes <= last;) {
            if (!hn::AllTrue(di, hn::Eq(hn::LoadU(di, y_.node.data() + end), node)) ||
                !hn::AllTrue(d, hn::Eq(hn::LoadU(d, y_.rest.data() + end), rest)))
                break;
            const auto columns = hn::LoadU(di, column_.data() + end);
            if (!grow(hn::GetLane(hn::MinOfLanes(di, columns)), hn::GetLane(hn::MaxOfLanes(di, columns)),
                      lanes))
                break;
        }
        while (run.points.end < last) {
            const std::size_t end = run.points.end;
            if (y_.node[end] != y_.node[begin] || y_.rest[end] != y_.rest[begin]) break;
            if (!grow(column_[end], column_[end], 1)) break;
        }
        return run;
    }

    Rows RowsOf(std::size_t point, Index column) const {
        Rows rows;
        for (int p = 0; p < P; ++p) {
            rows.weight[p] = row_weights_[p][point];
            int at = static_cast<int>(y_.node[point]) - P / 2 + 1 + p;
            // n may be smaller than the number of taps; a division for each row would cost more than the sums.
            while (at < 0) at += args_.n;
            while (at >= args_.n) at -= args_.n;
            rows.at[p] =
                static_cast<std::size_t>(at) * line_stride<T>(args_.n) + static_cast<std::size_t>(column);
        }
        return rows;
    }

    // The rows' sum at columns k and on.
    template <class D>
    static HWY_INLINE hn::Vec<D> SumRows(D d, const T* samples, const Rows& rows, std::size_t k) {
        auto sum = hn::Mul(hn::Set(d, rows.weight[0]), hn::LoadU(d, samples + rows.at[0] + k));
        for (int p = 1; p < P; ++p)
            sum = hn::MulAdd(hn::Set(d, rows.weight[p]), hn::LoadU(d, samples + rows.at[p] + k), sum);
        return sum;
    }

    // A run's rows added up, for all fields, from whole vectors on; then a vector of points at a time.
    void ReadRun(const Run& run) {
        const D d;
        const std::size_t lanes = hn::Lanes(d);
        const Index low = run.low - run.low % static_cast<Index>(lanes);
        const Rows rows = RowsOf(run.points.first, low);
        const std::size_t span = (static_cast<std::size_t>(run.high - low) + P + lanes - 1) / lanes * lanes;
        T* columns = columns_;
        for (const T* samples : args_.samples) {
            if (!samples) continue;
            for (std::size_t k = 0; k < span; k += lanes)
                hn::Store(SumRows(d, samples, rows, k), d, columns + k);
            columns += span;
        }
        for (std::size_t i = run.points.first; i < run.points.end; i += lanes)
            ReadPoints({i, std::min(i + lanes, run.points.end)}, low, span);
    }

    // Of at most a vector of points. Where their columns lie close together each tap is looked up in one vector of columns, or in two.
    void ReadPoints(PointRange points, Index low, std::size_t span) {
        const D d;
        const hn::RebindToSigned<D> di;
        const auto there = hn::FirstN(di, points.end - points.first);
        auto column = hn::LoadU(di, column_.data() + points.first);
        column = hn::IfThenElse(there, column, hn::Set(di, column_[points.first]));
        const Index first = hn::GetLane(hn::MinOfLanes(di, column));
        const Index vectors =
            (hn::GetLane(hn::MaxOfLanes(di, column)) - first) / static_cast<Index>(hn::Lanes(d)) + 1;
        if (vectors > 2) {
            const std::size_t middle = Apart(points);
            ReadPoints({points.first, middle}, low, span);
            return ReadPoints({middle, points.end}, low, span);
        }
        const auto from = hn::Sub(column, hn::Set(di, first));
        const T* columns = columns_ + (first - low);
        if (vectors == 1) return SumTaps(points, Lookup<1>(from), columns, span);
        SumTaps(points, Lookup<2>(from), columns, span);
    }

    // Where points that lie far apart part: at the seam of the period, or in their middle.
    std::size_t Apart(PointRange points) const {
        const auto lanes = static_cast<Index>(hn::Lanes(D()));
        std::size_t next = points.first + 1;
        while (next < points.end && std::abs(column_[next] - column_[next - 1]) < lanes) ++next;
        return next < points.end ? next : points.first + (points.end - points.first) / 2;
    }

    // The points' columns in V vectors of them; `from`: where each one's lies.
    template <int V>
    struct Lookup {
        using DI = hn::RebindToSigned<D>;
        HWY_INLINE explicit Lookup(hn::Vec<DI> from)
            : lane(hn::IndicesFromVec(D(), hn::And(from, hn::Set(DI(), kLast)))),
              is_beyond(hn::RebindMask(D(), hn::Gt(from, hn::Set(DI(), kLast)))) {}
        HWY_INLINE N operator()(const T* columns) const {
            const D d;
            const auto near = hn::TableLookupLanes(hn::LoadU(d, columns), lane);
            if constexpr (V == 1) return near;
            return hn::IfThenElse(is_beyond, hn::TableLookupLanes(hn::LoadU(d, columns + hn::Lanes(d)), lane),
                                  near);
        }
        static constexpr Index kLast = static_cast<Index>(hn::MaxLanes(D())) - 1;
        decltype(hn::IndicesFromVec(D(), hn::Zero(DI()))) lane;
        hn::Mask<D> is_beyond;
    };

    template <int V>
    HWY_INLINE void SumTaps(PointRange points, const Lookup<V>& tap_at, const T* columns, std::size_t span) {
        const D d;
        const auto there = hn::FirstN(d, points.end - points.first);
        N w[P], taps[P];
        for (int p = 0; p < P; ++p) w[p] = hn::LoadU(d, column_weights_[p].data() + points.first);
        for (std::size_t f = 0; f < kFieldCount; ++f) {
            if (!args_.samples[f]) continue;
            for (int p = 0; p < P; ++p) taps[p] = tap_at(columns + p);
            columns += span;
            // As ReadAlone() adds them, so that a point's value is the same in any company.
            N sum[P];
            for (int p = 0; p < P; ++p)
                sum[p % kGroup] =
                    p < kGroup ? w[p] * taps[p] : N(hn::MulAdd(taps[p].v, w[p].v, sum[p % kGroup].v));
            for (int half = kGroup / 2; half > 0; half /= 2)
                for (int p = 0; p < half && p + half < P; ++p) sum[p] += sum[p + half];
            hn::StoreU(hn::IfThenElseZero(there, sum[0].v), d, values_[f].data() + points.first);
        }
    }

    // Rows and columns at once, nothing kept between.
    void ReadAlone(std::size_t point) {
        const Taps taps;
        const Rows rows = RowsOf(point, column_[point]);
        alignas(64) T weights[kTaps] = {};
        for (int p = 0; p < P; ++p) weights[p] = column_weights_[p][point];
        for (std::size_t f = 0; f < kFieldCount; ++f) {
            const T* samples = args_.samples[f];
            if (!samples) continue;
            auto sum = hn::Zero(taps);
            for (std::size_t k = 0; k < kTaps; k += hn::Lanes(taps))
                sum = hn::MulAdd(SumRows(taps, samples, rows, k), hn::Load(taps, weights + k), sum);
            values_[f][point] = hn::GetLane(hn::SumOfLanes(taps, sum));
        }
    }

    const GridArgs<T>& args_;
    const Places<T>&x_, &y_;
    FieldValues<T>& values_;
    std::array<Index, kRoom<T>> column_;
    std::array<std::array<T, kRoom<T>>, P> column_weights_, row_weights_;
    alignas(64) T columns_[kFieldCount * kColumns];  // of the wanted fields, one after another
};

// Adds what was read.
template <class T>
void AddValues(const GridArgs<T>& args, const FieldValues<T>& values, Chunk<T>& chunk) {
    const hn::ScalableTag<T> d;
    for (std::size_t f = 0; f < kFieldCount; ++f) {
        if (!args.samples[f]) continue;
        const T* weight = weight_of(args, f);
        T* sums = chunk.sums[f].data();
        for (std::size_t i = 0; i < chunk.count; i += hn::Lanes(d)) {
            auto value = hn::LoadU(d, values[f].data() + i);
            if (weight) value = hn::Mul(value, hn::LoadU(d, weight + i));
            hn::Store(hn::Add(hn::Load(d, sums + i), value), d, sums + i);
        }
    }
}

// The same of copies, with their weights w and these weights' gradient (core/plan/copies.h).
template <class T>
void AddCopies(const GridArgs<T>& args, const CopyArgs<T>& copies, const FieldValues<T>& values,
               Chunk<T>& chunk) {
    const hn::ScalableTag<T> d;
    using N = Pack<decltype(d)>;
    const std::size_t lanes = hn::Lanes(d);
    const auto value = [&](Field f, std::size_t i) HWY_ATTR { return N(hn::LoadU(d, &values[index(f)][i])); };
    const auto add = [&](T* sums, std::size_t f, N what, std::size_t i) HWY_ATTR {
        if (const T* share = weight_of(args, f)) what = N(hn::LoadU(d, share + i)) * what;
        hn::Store(hn::Add(hn::Load(d, sums + i), what.v), d, sums + i);
    };
    const auto wanted = [&](Field f) { return copies.wanted[index(f)] && args.samples[index(f)]; };
    for (std::size_t r = 0, next = 0; r < copies.range_count; ++r) {
        const PointRange range = copies.ranges[r];
        for (std::size_t i = std::max(next, range.first / lanes * lanes); i < range.end; i += lanes) {
            next = i + lanes;
            const auto of = [&](const T* values_of) HWY_ATTR { return N(hn::LoadU(d, values_of + i)); };
            const N x = of(copies.x.weight), y = of(copies.y.weight), w = x * y;
            const N wx = N(copies.x.sign) * of(copies.x.other) * of(copies.x.rate) * y;
            const N wy = N(copies.y.sign) * of(copies.y.other) * of(copies.y.rate) * x;
            for (std::size_t f = 0; f < kFieldCount; ++f) {
                if (!wanted(static_cast<Field>(f))) continue;
                N sum = w * value(static_cast<Field>(f), i);
                for (const Gradient& row : kGradients)
                    if (index(row.derivative) == f && args.samples[index(row.of)])
                        sum += (row.along_y ? wy : wx) * value(row.of, i);
                add(chunk.sums[f].data(), f, sum, i);
            }
            if (wanted(Field::Dxy) && args.samples[index(Field::Dx)])
                add(chunk.turn.data(), index(Field::Dxy), wx * value(Field::Dy, i) - wy * value(Field::Dx, i),
                    i);
        }
    }
}

template <class T>
void AddGrid(const GridArgs<T>& args, Chunk<T>& chunk) {
    const PointRange all{0, chunk.count};
    const CopyArgs<T>* copies = args.copies;
    const PointRange* ranges = copies ? copies->ranges : &all;
    const std::size_t range_count = copies ? copies->range_count : 1;
    Places<T> x, y;
    // In order: beyond a range's last point a vector writes into the next one's places.
    for (std::size_t r = 0; r < range_count; ++r) {
        Locate(args, args.origin_nodes_x, copies ? copies->nodes_x : nullptr, chunk.rest_x.data(), ranges[r],
               x);
        Locate(args, args.origin_nodes_y, copies ? copies->nodes_y : nullptr, chunk.rest_y.data(), ranges[r],
               y);
    }
    FieldValues<T> values;
    // What vectors meet between the ranges, and beyond the last point, has to be a number.
    const bool is_whole = range_count == 1 && ranges[0].first == 0 && ranges[0].end == chunk.count;
    for (std::size_t f = 0; f < kFieldCount; ++f)
        if (args.samples[f])
            std::fill(values[f].begin() + (is_whole ? chunk.count : 0), values[f].begin() + chunk.padded(),
                      T(0));
    const auto read = [&](auto&& reader) {
        for (std::size_t r = 0; r < range_count; ++r) reader(ranges[r]);
    };
    if (args.sampling == Sampling::Nodes) {
        read([&](PointRange range) { ReadNodes(args, range, x, y, values); });
    } else if (args.taps == 6) {
        SplineReader<6, T> reader(args, x, y, values);
        read([&](PointRange range) { reader.Read(range); });
    } else {
        SplineReader<4, T> reader(args, x, y, values);
        read([&](PointRange range) { reader.Read(range); });
    }
    if (copies)
        AddCopies(args, *copies, values, chunk);
    else
        AddValues(args, values, chunk);
}

}  // namespace grids_detail
}  // namespace HWY_NAMESPACE
}  // namespace pelagic
HWY_AFTER_NAMESPACE();

#endif
