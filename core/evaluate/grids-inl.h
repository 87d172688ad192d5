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
#include <type_traits>

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

// Values go to `own` at the points `in_own`, to `next` at others (TilingRange).
template <class T>
struct Targets {
    FieldValues<T>&own, &next;
    PointRange in_own{};

    FieldValues<T>& of(std::size_t point) const {
        return point >= in_own.first && point < in_own.end ? own : next;
    }
    // Whether a vector from this point on may be written whole: values beyond its own points are written again later.
    bool takes_whole(std::size_t first, std::size_t lanes) const {
        return first >= in_own.first && first + lanes <= in_own.end;
    }
};

// Where the values of at most a vector of points go.
template <class T>
class PartedTarget {
  public:
    using D = hn::ScalableTag<T>;
    HWY_INLINE PartedTarget(const Targets<T>& targets, PointRange points)
        : targets_(targets), first_(points.first) {
        const D d;
        const auto until = [&](std::size_t end) HWY_ATTR {
            return hn::FirstN(d, end > first_ ? std::min(end - first_, hn::Lanes(d)) : 0);
        };
        const auto there = until(points.end);
        in_own_ = hn::And(there, hn::AndNot(until(targets.in_own.first), until(targets.in_own.end)));
        in_next_ = hn::AndNot(in_own_, there);
        has_own_ = !hn::AllFalse(d, in_own_);
        has_next_ = !hn::AllFalse(d, in_next_);
    }
    HWY_INLINE void put(std::size_t field, hn::Vec<D> value) const {
        const D d;
        if (has_own_) hn::BlendedStore(value, in_own_, d, targets_.own[field].data() + first_);
        if (has_next_) hn::BlendedStore(value, in_next_, d, targets_.next[field].data() + first_);
    }

  private:
    const Targets<T>& targets_;
    std::size_t first_;
    hn::Mask<D> in_own_, in_next_;
    bool has_own_, has_next_;
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

// Along one axis, in double: exact wherever in the world the origin is. A place that is no number, or too far away to
// have digits left, becomes 0. origin(i): that of the vector of points from i on [nodes].
template <class T, class Origin>
void Locate(const GridArgs<T>& args, Origin origin, const T* rest_m, PointRange range, Places<T>& places) {
    const hn::ScalableTag<double> dd;
    using Wide = decltype(dd);
    const hn::Rebind<T, Wide> narrow;
    const hn::Rebind<hwy::MakeSigned<T>, Wide> index;
    const auto n = hn::Set(dd, args.n), per_n = hn::Set(dd, 1.0 / args.n);
    const auto scale = hn::Set(dd, args.nodes_per_m);
    for (std::size_t i = range.first; i < range.end; i += hn::Lanes(dd)) {
        const auto nodes = hn::MulAdd(Widen(dd, rest_m + i), scale, origin(i));
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

// The same, of points with one origin.
template <class T>
void LocateAll(const GridArgs<T>& args, double origin_nodes, const T* rest_m, PointRange range,
               Places<T>& places) {
    const hn::ScalableTag<double> dd;
    const auto origin = hn::Set(dd, origin_nodes);
    Locate(
        args, [origin](std::size_t) HWY_ATTR { return origin; }, rest_m, range, places);
}

// Where the points from `begin` on have another y than that one: a row of a patch ends there.
template <class T>
std::size_t EndOfLevel(const T* rest_y, std::size_t begin, std::size_t last) {
    const hn::ScalableTag<T> d;
    const auto y = hn::Set(d, rest_y[begin]);
    std::size_t end = begin + 1;
    while (end + hn::Lanes(d) <= last && hn::AllTrue(d, hn::Eq(hn::LoadU(d, rest_y + end), y)))
        end += hn::Lanes(d);
    while (end < last && rest_y[end] == rest_y[begin]) ++end;
    return end;
}

// `is_level`: all of the range have the first one's y, and y has no other place.
template <class T>
void ReadNodes(const GridArgs<T>& args, PointRange range, bool is_level, const Places<T>& x,
               const Places<T>& y, const Targets<T>& targets) {
    const hn::ScalableTag<T> d;
    const hn::RebindToSigned<decltype(d)> di;
    const auto stride = hn::Set(di, static_cast<hwy::MakeSigned<T>>(line_stride<T>(args.n)));
    const std::size_t lanes = hn::Lanes(d);
    for (std::size_t i = range.first; i < range.end; i += lanes) {
        const std::size_t count = std::min(lanes, range.end - i);
        // Lanes beyond the last point read the first node.
        const auto within = hn::FirstN(di, count);
        const auto first = hn::IfThenElseZero(within, hn::LoadU(di, x.node.data() + i));
        const auto row = is_level ? hn::Set(di, y.node[range.first])
                                  : hn::IfThenElseZero(within, hn::LoadU(di, y.node.data() + i));
        // Points that cross the tile's seam are read one by one: that is rare, although the row's extra
        // columns would allow a run.
        const auto at = hn::Add(hn::Mul(row, stride), first);
        const auto begin = hn::GetLane(at);
        const bool run = hn::AllTrue(di, hn::Eq(at, hn::Add(hn::Set(di, begin), hn::Iota(di, 0))));
        const bool is_whole = targets.takes_whole(i, lanes);
        const PartedTarget<T> target(targets, {i, i + count});
        for (std::size_t f = 0; f < kFieldCount; ++f) {
            if (!args.samples[f]) continue;
            const auto value =
                run ? hn::LoadU(d, args.samples[f] + begin) : hn::GatherIndex(d, args.samples[f], at);
            if (is_whole)
                hn::StoreU(value, d, targets.own[f].data() + i);
            else
                target.put(f, value);
        }
    }
}

// B-splines of P taps along each axis: the vectors in which one point is summed, and the order of every point's sum.
template <int P, class T>
struct SplineTaps {
    static constexpr std::size_t kTaps = P <= 4 ? 4 : 8;          // with zeros behind the last
    using D = hn::CappedTag<T, std::min(kTaps, 32 / sizeof(T))>;  // of at most 256 bits
    static constexpr int kGroup = static_cast<int>(hn::MaxLanes(D()));

    // Rows of a grid, and their weights.
    struct Rows {
        std::size_t at[P];  // where they begin, or a column of theirs
        T weight[P];
    };
    static HWY_INLINE void PlaceRows(const GridArgs<T>& args, hwy::MakeSigned<T> node, std::size_t column,
                                     std::size_t (&at)[P]) {
        for (int p = 0; p < P; ++p) {
            int row = static_cast<int>(node) - P / 2 + 1 + p;
            // n may be smaller than the number of taps; a division for each row would cost more than the sums.
            while (row < 0) row += args.n;
            while (row >= args.n) row -= args.n;
            at[p] = static_cast<std::size_t>(row) * line_stride<T>(args.n) + column;
        }
    }

    // The rows' sums in V vectors from column k on.
    template <int V, class Tag>
    static HWY_INLINE void SumRows(Tag d, const T* samples, const Rows& rows, std::size_t k,
                                   hn::Vec<Tag> (&sums)[V]) {
        for (int p = 0; p < P; ++p) {
            const auto weight = hn::Set(d, rows.weight[p]);
            const T* row = samples + rows.at[p] + k;
            for (int v = 0; v < V; ++v) {
                const auto columns = hn::LoadU(d, row + static_cast<std::size_t>(v) * hn::Lanes(d));
                sums[v] = p == 0 ? hn::Mul(weight, columns) : hn::MulAdd(weight, columns, sums[v]);
            }
        }
    }

    // Reads a point by itself. `rows`: from its first column on; `weights`: along x.
    static HWY_NOINLINE void ReadAlone(const GridArgs<T>& args, const Rows& rows,
                                       const hn::Vec<D> (&weights)[kTaps / kGroup], FieldValues<T>& values,
                                       std::size_t point) {
        const D d;
        for (std::size_t f = 0; f < kFieldCount; ++f) {
            const T* samples = args.samples[f];
            if (!samples) continue;
            auto sum = hn::Zero(d);
            for (std::size_t k = 0; k < kTaps / kGroup; ++k) {
                hn::Vec<D> of_rows[1];
                SumRows(d, samples, rows, k * kGroup, of_rows);
                sum = hn::MulAdd(of_rows[0], weights[k], sum);
            }
            values[f][point] =
                hn::GetLane(hn::SumOfLanes(d, sum));  // halves first, on x86: as SplineReader::SumTaps()
        }
    }
};

// Reads a cascade's grid at points one by one, whichever shifted tiles they lie in.
template <int P, class T>
class ScatteredReader {
  public:
    ScatteredReader(const GridArgs<T>& args, const Chunk<T>& chunk) : args_(args), chunk_(chunk) {}

    // nodes_x, nodes_y: where the points' origin lies.
    void Read(PointRange points, double nodes_x, double nodes_y, const Targets<T>& targets) {
        Places<T> x, y;
        LocateAll(args_, nodes_x, chunk_.rest_x.data(), points, x);
        LocateAll(args_, nodes_y, chunk_.rest_y.data(), points, y);
        ReadPlaced(points, x, y, [&](std::size_t i) { return To{&targets.of(i), i}; });
    }

    // Collects points of many ranges, which are read together: ReadTaken() has to follow the last.
    void Take(PointRange points, double nodes_x, double nodes_y, const Targets<T>& targets) {
        for (std::size_t i = points.first; i < points.end; ++i) {
            if (count_ == Chunk<T>::kPoints) ReadTaken();
            rest_x_[count_] = chunk_.rest_x[i];
            rest_y_[count_] = chunk_.rest_y[i];
            nodes_x_[count_] = nodes_x;
            nodes_y_[count_] = nodes_y;
            to_[count_++] = {&targets.of(i), i};
        }
    }
    void ReadTaken() {
        if (count_ == 0) return;
        const hn::ScalableTag<double> dd;
        const auto origin = [dd](const std::array<double, kRoom<T>>& nodes) {
            return [from = nodes.data(), dd](std::size_t i) HWY_ATTR { return hn::LoadU(dd, from + i); };
        };
        Places<T> x, y;
        Locate(args_, origin(nodes_x_), rest_x_.data(), {0, count_}, x);
        Locate(args_, origin(nodes_y_), rest_y_.data(), {0, count_}, y);
        ReadPlaced({0, count_}, x, y, [&](std::size_t j) { return to_[j]; });
        count_ = 0;
    }

  private:
    using D = hn::ScalableTag<T>;
    using N = Pack<D>;
    using Taps = SplineTaps<P, T>;
    struct To {
        FieldValues<T>* values;
        std::size_t point;
    };

    // A point's weights. Eight are put together from registers: a load that spans two stores would wait for both.
    static HWY_INLINE void Load(const T (&beside)[Taps::kTaps / 4][4 * hn::MaxLanes(D())], std::size_t at,
                                hn::Vec<typename Taps::D> (&weights)[Taps::kTaps / Taps::kGroup]) {
        const typename Taps::D d;
        if constexpr (Taps::kGroup <= 4) {
            for (std::size_t k = 0; k < Taps::kTaps; k += Taps::kGroup)
                weights[k / Taps::kGroup] = hn::Load(d, beside[k / 4] + at + k % 4);
        } else {
#if HWY_TARGET != HWY_SCALAR
            const hn::Half<typename Taps::D> four;
            weights[0] = hn::Combine(d, hn::Load(four, beside[1] + at), hn::Load(four, beside[0] + at));
#endif
        }
    }

    // `to`: where the values of one of them go.
    template <class Which>
    void ReadPlaced(PointRange points, const Places<T>& x, const Places<T>& y, Which to) {
        const D d;
        constexpr std::size_t kFours = Taps::kTaps / 4;
        for (std::size_t i = points.first; i < points.end; i += hn::Lanes(d)) {
            N some[P], w[Taps::kTaps];  // of those beyond P, zeros
            bspline_weights<P>(N(hn::LoadU(d, y.rest.data() + i)), some);
            alignas(64) T along_y[P][hn::MaxLanes(d)];
            for (int p = 0; p < P; ++p) hn::Store(some[p].v, d, along_y[p]);
            bspline_weights<P>(N(hn::LoadU(d, x.rest.data() + i)), some);
            std::copy_n(some, P, w);
            // Side by side for each point, in fours as they are loaded again.
            alignas(64) T beside[kFours][4 * hn::MaxLanes(d)];
            for (std::size_t h = 0; h < kFours; ++h)
                hn::StoreInterleaved4(w[4 * h].v, w[4 * h + 1].v, w[4 * h + 2].v, w[4 * h + 3].v, d,
                                      beside[h]);
            for (std::size_t j = 0; j < hn::Lanes(d) && i + j < points.end; ++j) {
                hn::Vec<typename Taps::D> along_x[Taps::kTaps / Taps::kGroup];
                Load(beside, 4 * j, along_x);
                typename Taps::Rows rows;
                auto column = x.node[i + j] - (P / 2 - 1);
                if (column < 0) column += args_.n;
                Taps::PlaceRows(args_, y.node[i + j], static_cast<std::size_t>(column), rows.at);
                for (int p = 0; p < P; ++p) rows.weight[p] = along_y[p][j];
                const To where = to(i + j);
                Taps::ReadAlone(args_, rows, along_x, *where.values, where.point);
            }
        }
    }

    const GridArgs<T>& args_;
    const Chunk<T>& chunk_;
    std::size_t count_ = 0;
    std::array<T, kRoom<T>> rest_x_, rest_y_;
    std::array<double, kRoom<T>> nodes_x_, nodes_y_;
    std::array<To, Chunk<T>::kPoints> to_;
};

// A cascade's grid at points of a patch's row, by B-splines of P taps along each axis.
template <int P, class T>
class SplineReader {
  public:
    SplineReader(const GridArgs<T>& args, const T* rest_x, const Places<T>& y, RowPlaces<T>& row,
                 const Targets<T>& targets)
        : args_(args), rest_x_(rest_x), y_(y), row_(row), targets_(targets) {
        if (args.row == 0 || row.row != args.row) row.part_count = 0;
        row.row = args.row;
    }

    // All of the range have the first one's y, and the places along y have no other. Points of one run lie close together in x, as
    // those of a patch do: the rows that they need are added up once, and what is left is a sum along x. `nodes_x`: where the points'
    // origin lies.
    void Read(PointRange range, double nodes_x) {
        range_ = range;
        PlaceRows();
        const Part* part = Known(nodes_x);
        if (!part) return Find(nodes_x);
        At(part->at);
        for (std::size_t r = part->first_run; r < part->end_run; ++r) ReadOne(row_.runs[r]);
    }

  private:
    using D = hn::ScalableTag<T>;
    using N = Pack<D>;
    using Taps = SplineTaps<P, T>;
    using Rows = typename Taps::Rows;
    // A run costs the columns that it spans, and saves P − 1 rows for each of its points. So the next run begins
    // where there would be more than a few columns a point, and at the seam of the period.
    static constexpr int kColumnsPerPoint = 4;
    static constexpr std::size_t kColumns = kColumnsPerPoint * Chunk<T>::kPoints + P + 4 * (64 / sizeof(T));

    using Index = typename Places<T>::Index;
    using Columns = typename RowPlaces<T>::Columns;
    using Run = typename RowPlaces<T>::Run;
    using Part = typename RowPlaces<T>::Part;

    // The next part, if the row before has kept it.
    const Part* Known(double nodes_x) {
        if (part_ >= row_.part_count) return nullptr;
        const Part& part = row_.parts[part_];
        if (part.points.first != range_.first || part.points.end != range_.end || part.nodes_x != nodes_x)
            return nullptr;
        ++part_;
        return &part;
    }

    // Places the points along x, keeps that where there is room, and reads them.
    void Find(double nodes_x) {
        Part part{range_, nodes_x, 0, 0, 0};
        if (part_ > 0) {
            const Part& last = row_.parts[part_ - 1];
            const std::size_t lanes = 64 / sizeof(T);
            part.at = last.at + (last.points.end - last.points.first + lanes - 1) / lanes * lanes;
            part.first_run = part.end_run = last.end_run;
        }
        bool is_kept = args_.row != 0 && part_ < row_.kParts &&
                       part.at + (range_.end - range_.first) + 64 / sizeof(T) <= row_.kRoom;
        if (!is_kept) {
            DropAll(part);
            part.at = 0;
        }
        At(part.at);
        WeighColumns(nodes_x);
        for (std::size_t begin = range_.first; begin < range_.end;) {
            if (part.end_run == row_.kRuns) {
                is_kept = false;
                DropAll(part);
            }
            Run& run = row_.runs[part.end_run++];
            run = RunFrom(begin, part.at);
            ReadOne(run);
            begin = run.points.end;
        }
        if (!is_kept) return;
        row_.parts[part_++] = part;
        row_.part_count = part_;
    }
    void DropAll(Part& part) {
        row_.part_count = part_ = 0;
        part.first_run = part.end_run = 0;
    }
    // Where the values of the range's points stand.
    void At(std::size_t at) {
        column_ = row_.column.data() + at - range_.first;
        for (int p = 0; p < P; ++p) column_weights_[p] = row_.weight[p].data() + at - range_.first;
    }
    void ReadOne(const Run& run) {
        if (run.points.end == run.points.first + 1)
            ReadAlone(run.points.first);
        else
            ReadRun(run);
    }

    // The points' weights along x, and the first of each one's columns.
    void WeighColumns(double nodes_x) {
        const D d;
        const hn::RebindToSigned<D> di;
        const std::size_t lanes = hn::Lanes(d);
        const auto n = hn::Set(di, args_.n), before = hn::Set(di, P / 2 - 1), none = hn::Zero(di);
        Places<T> x;
        LocateAll(args_, nodes_x, rest_x_, range_, x);
        for (std::size_t i = range_.first; i < range_.end; i += lanes) {
            N w[P];
            bspline_weights<P>(N(hn::LoadU(d, x.rest.data() + i)), w);
            for (int p = 0; p < P; ++p) hn::StoreU(w[p].v, d, column_weights_[p] + i);
            const auto column = hn::Sub(hn::LoadU(di, x.node.data() + i), before);
            hn::StoreU(hn::Add(column, hn::IfThenElseZero(hn::Lt(column, none), n)), di, column_ + i);
        }
    }

    void PlaceRows() {
        N w[P];
        bspline_weights<P>(N(hn::Set(D(), y_.rest[range_.first])), w);
        for (int p = 0; p < P; ++p) rows_.weight[p] = hn::GetLane(w[p].v);
        Taps::PlaceRows(args_, y_.node[range_.first], 0, rows_.at);
    }
    Rows RowsFrom(Index column) const {
        Rows rows = rows_;
        for (std::size_t& at : rows.at) at += static_cast<std::size_t>(column);
        return rows;
    }

    // Of at most a vector of points.
    Columns ColumnsOf(PointRange points) const {
        const hn::RebindToSigned<D> di;
        const auto there = hn::FirstN(di, points.end - points.first);
        const auto column =
            hn::IfThenElse(there, hn::LoadU(di, column_ + points.first), hn::Set(di, column_[points.first]));
        return {hn::GetLane(hn::MinOfLanes(di, column)), hn::GetLane(hn::MaxOfLanes(di, column))};
    }

    // Notes the columns of each vector of its points.
    Run RunFrom(std::size_t begin, std::size_t at) {
        const std::size_t lanes = hn::Lanes(D());
        Run run{{begin, begin}, {column_[begin], column_[begin]}, at + (begin - range_.first)};
        Columns* vector = row_.vectors.data() + run.vector;
        const auto grow = [&](Columns by, std::size_t count) {
            const Columns both{std::min(run.columns.low, by.low), std::max(run.columns.high, by.high)};
            if (both.high - both.low > kColumnsPerPoint * static_cast<Index>(run.points.end - begin + count))
                return false;
            run.columns = both;
            run.points.end += count;
            return true;
        };
        // A vector of points at a time, as long as all of them belong to it.
        for (; run.points.end < range_.end; ++vector) {
            const PointRange next{run.points.end, std::min(run.points.end + lanes, range_.end)};
            *vector = ColumnsOf(next);
            if (!grow(*vector, next.end - next.first)) break;
        }
        if (run.points.end == range_.end) return run;
        Columns& last = *vector;
        last = {column_[run.points.end], column_[run.points.end]};
        while (run.points.end < range_.end) {
            const std::size_t next = run.points.end;
            const Index column = column_[next];
            if (!grow({column, column}, 1)) break;
            last = {std::min(last.low, column), std::max(last.high, column)};
        }
        return run;
    }

    template <int V>
    static HWY_INLINE void StoreRows(const T* samples, const Rows& rows, std::size_t k, T* columns) {
        const D d;
        hn::Vec<D> sums[V];
        Taps::SumRows(d, samples, rows, k, sums);
        for (int v = 0; v < V; ++v)
            hn::Store(sums[v], d, columns + k + static_cast<std::size_t>(v) * hn::Lanes(d));
    }

    // Adds up a run's rows for all fields, in whole vectors, and then sums its points, a vector at a time.
    void ReadRun(const Run& run) {
        const D d;
        const std::size_t lanes = hn::Lanes(d);
        const Index low = run.columns.low - run.columns.low % static_cast<Index>(lanes);
        const Rows rows = RowsFrom(low);
        const std::size_t span =
            (static_cast<std::size_t>(run.columns.high - low) + P + lanes - 1) / lanes * lanes;
        T* columns = columns_;
        for (const T* samples : args_.samples) {
            if (!samples) continue;
            std::size_t k = 0;  // several vectors at a time, as one sum is a chain of operations
            for (; k + 4 * lanes <= span; k += 4 * lanes) StoreRows<4>(samples, rows, k, columns);
            if (k + 2 * lanes <= span) StoreRows<2>(samples, rows, k, columns), k += 2 * lanes;
            if (k < span) StoreRows<1>(samples, rows, k, columns);
            columns += span;
        }
        const Columns* of = row_.vectors.data() + run.vector;
        for (std::size_t i = run.points.first; i < run.points.end; i += lanes)
            ReadPoints({i, std::min(i + lanes, run.points.end)}, *of++, low, span);
    }

    // Of at most a vector of points. All taps are looked up in one vector of columns where that holds them, otherwise each in one or
    // two vectors of its own.
    void ReadPoints(PointRange points, Columns of, Index low, std::size_t span) {
        const D d;
        const hn::RebindToSigned<D> di;
        const auto lanes = static_cast<Index>(hn::Lanes(d));
        const Index way = of.high - of.low;
        if (way >= 2 * lanes) {
            const std::size_t middle = Apart(points);
            const PointRange before{points.first, middle}, after{middle, points.end};
            ReadPoints(before, ColumnsOf(before), low, span);
            return ReadPoints(after, ColumnsOf(after), low, span);
        }
        const auto there = hn::FirstN(di, points.end - points.first);
        const auto from =
            hn::IfThenElseZero(there, hn::Sub(hn::LoadU(di, column_ + points.first), hn::Set(di, of.low)));
        const T* columns = columns_ + (of.low - low);
        if (way + P <= lanes) return SumTaps<0>(points, from, columns, span);
        if (way < lanes) return SumTaps<1>(points, from, columns, span);
        SumTaps<2>(points, from, columns, span);
    }

    // Where to split points that lie far apart: at the seam of the period, or in their middle.
    std::size_t Apart(PointRange points) const {
        const auto lanes = static_cast<Index>(hn::Lanes(D()));
        std::size_t next = points.first + 1;
        while (next < points.end && std::abs(column_[next] - column_[next - 1]) < lanes) ++next;
        return next < points.end ? next : points.first + (points.end - points.first) / 2;
    }

    // Sums the taps at a vector of points. Each tap is looked up in V vectors of columns; where V is 0, one vector
    // holds all taps. `from`: the first column of each point.
    template <int V>
    void SumTaps(PointRange points, hn::Vec<hn::RebindToSigned<D>> from, const T* columns, std::size_t span) {
        const D d;
        if (targets_.takes_whole(points.first, hn::Lanes(d)))
            return SumTaps<V>(points.first, from, columns, span, targets_.own[0].data() + points.first,
                              kRoom<T>);
        alignas(64) T sums[kFieldCount][hn::MaxLanes(d)];
        SumTaps<V>(points.first, from, columns, span, sums[0], hn::MaxLanes(d));
        const PartedTarget<T> target(targets_, points);
        for (std::size_t f = 0; f < kFieldCount; ++f)
            if (args_.samples[f]) target.put(f, hn::Load(d, sums[f]));
    }
    // Into `sums`, in which fields are `apart` values apart.
    template <int V>
    HWY_INLINE void SumTaps(std::size_t first, hn::Vec<hn::RebindToSigned<D>> from, const T* columns,
                            std::size_t span, T* sums, std::size_t apart) {
        const D d;
        const hn::RebindToSigned<D> di;
        const auto last = hn::Set(di, static_cast<Index>(hn::Lanes(d)) - 1);
        const auto is_beyond = hn::RebindMask(d, hn::Gt(from, last));
        decltype(hn::IndicesFromVec(d, from)) lane[P];
        N w[P], taps[P];
        for (int p = 0; p < P; ++p) {
            lane[p] = hn::IndicesFromVec(d, hn::And(V == 0 ? hn::Add(from, hn::Set(di, p)) : from, last));
            w[p] = hn::LoadU(d, column_weights_[p] + first);
        }
        for (std::size_t f = 0; f < kFieldCount; ++f) {
            if (!args_.samples[f]) continue;
            for (int p = 0; p < P; ++p) {
                const T* from_tap = V == 0 ? columns : columns + p;
                auto tap = hn::TableLookupLanes(hn::LoadU(d, from_tap), lane[p]);
                if constexpr (V == 2)
                    tap = hn::IfThenElse(
                        is_beyond, hn::TableLookupLanes(hn::LoadU(d, from_tap + hn::Lanes(d)), lane[p]), tap);
                taps[p] = tap;
            }
            columns += span;
            // In the order of SplineTaps::ReadAlone(), so that a point's value doesn't depend on the points beside
            // it.
            N sum[P];
            for (int p = 0; p < P; ++p)
                sum[p % Taps::kGroup] = p < Taps::kGroup
                                            ? w[p] * taps[p]
                                            : N(hn::MulAdd(taps[p].v, w[p].v, sum[p % Taps::kGroup].v));
            for (int half = Taps::kGroup / 2; half > 0; half /= 2)
                for (int p = 0; p < half && p + half < P; ++p) sum[p] += sum[p + half];
            hn::StoreU(sum[0].v, d, sums + f * apart);
        }
    }

    void ReadAlone(std::size_t point) {
        alignas(64) T weights[Taps::kTaps] = {};
        for (int p = 0; p < P; ++p) weights[p] = column_weights_[p][point];
        hn::Vec<typename Taps::D> along_x[Taps::kTaps / Taps::kGroup];
        for (std::size_t k = 0; k < Taps::kTaps; k += Taps::kGroup)
            along_x[k / Taps::kGroup] = hn::Load(typename Taps::D(), weights + k);
        Taps::ReadAlone(args_, RowsFrom(column_[point]), along_x, targets_.of(point), point);
    }

    const GridArgs<T>& args_;
    const T* rest_x_;
    const Places<T>& y_;
    RowPlaces<T>& row_;
    std::size_t part_ = 0;  // of the row
    const Targets<T>& targets_;
    PointRange range_{};
    Rows rows_;                                      // of the range's y
    Index* column_ = nullptr;                        // by point of the range
    std::array<T*, P> column_weights_{};             // the same
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

// The same for the tiles of one side along x, with their weights w and these weights' gradient (core/plan/random_tiling.h).
template <class T>
void AddTiles(const GridArgs<T>& args, const TilingArgs<T>& tiling, const typename TilingArgs<T>::Side& side,
              const FieldValues<T>& values, Chunk<T>& chunk) {
    const hn::ScalableTag<T> d;
    using N = Pack<decltype(d)>;
    const std::size_t lanes = hn::Lanes(d);
    const auto value = [&](Field f, std::size_t i) HWY_ATTR { return N(hn::LoadU(d, &values[index(f)][i])); };
    const auto add = [&](T* sums, std::size_t f, N what, std::size_t i) HWY_ATTR {
        if (const T* share = weight_of(args, f)) what = N(hn::LoadU(d, share + i)) * what;
        hn::Store(hn::Add(hn::Load(d, sums + i), what.v), d, sums + i);
    };
    const auto wanted = [&](Field f) { return tiling.wanted[index(f)] && args.samples[index(f)]; };
    for (std::size_t r = 0, next = 0; r < side.count; ++r) {
        const PointRange range = side.points[r];
        for (std::size_t i = std::max(next, range.first / lanes * lanes); i < range.end; i += lanes) {
            next = i + lanes;
            const auto of = [&](const T* values_of) HWY_ATTR { return N(hn::LoadU(d, values_of + i)); };
            const N x = of(side.x.weight), y = of(tiling.y.weight), w = x * y;
            const N wx = N(side.x.sign) * of(side.x.other) * of(side.x.rate) * y;
            const N wy = N(tiling.y.sign) * of(tiling.y.other) * of(tiling.y.rate) * x;
            const auto none = hn::Zero(d);
            if (hn::AllTrue(d, hn::Eq(w.v, hn::Set(d, T(1)))) && hn::AllTrue(d, hn::Eq(wx.v, none)) &&
                hn::AllTrue(d, hn::Eq(wy.v, none))) {  // nothing blends here
                for (std::size_t f = 0; f < kFieldCount; ++f)
                    if (wanted(static_cast<Field>(f)))
                        add(chunk.sums[f].data(), f, value(static_cast<Field>(f), i), i);
                continue;
            }
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

// Shorter rows are read point by point. At some ten points both ways cost the same.
constexpr std::size_t kShortestRow = 8;

template <class T>
void AddGrid(const GridArgs<T>& args, Chunk<T>& chunk) {
    const PointRange whole{0, chunk.count};
    const TilingRange all{whole, whole, args.origin_nodes_x, args.origin_nodes_y};
    const TilingArgs<T>* tiling = args.tiling;
    const TilingRange* ranges = tiling ? tiling->ranges : &all;
    const std::size_t range_count = tiling ? tiling->range_count : 1;
    FieldValues<T> own, next;
    // Vectors compute with the values between the ranges and beyond the last point too: these must be numbers.
    const hn::ScalableTag<T> d;
    const auto clear = [&](FieldValues<T>& values, PointRange but) HWY_ATTR {
        const bool is_whole = but.first == 0 && but.end == chunk.count;
        const std::size_t first = is_whole ? (chunk.count - 1) / hn::Lanes(d) * hn::Lanes(d) : 0;
        for (std::size_t f = 0; f < kFieldCount; ++f)
            for (std::size_t i = first; args.samples[f] && i < chunk.count; i += hn::Lanes(d))
                hn::StoreU(hn::Zero(d), d, values[f].data() + i);
    };
    const auto shown = [&](const typename TilingArgs<T>::Side& side) {
        return side.count == 1 ? side.points[0] : PointRange{0, 0};
    };
    clear(own, tiling ? shown(tiling->sides[0]) : whole);
    if (tiling && tiling->sides[1].count > 0) clear(next, shown(tiling->sides[1]));
    Targets<T> targets{own, next, whole};
    Places<T> y;
    const T *rest_x = chunk.rest_x.data(), *rest_y = chunk.rest_y.data();
    // Of a row only the first point is placed along y.
    const auto read = [&](auto&& row, auto&& scattered) {
        for (std::size_t r = 0; r < range_count; ++r) {
            const TilingRange& range = ranges[r];
            targets.in_own = range.own;
            for (PointRange part = range.points; part.first < part.end; part = {part.end, range.points.end}) {
                const std::size_t end = EndOfLevel(rest_y, part.first, part.end);
                if (end - part.first < kShortestRow) {  // with the next ones, whatever they are
                    part.end = std::min(part.first + 64 / sizeof(T), part.end);
                    scattered(part, range);
                    continue;
                }
                part.end = end;
                LocateAll(args, range.nodes_y, rest_y, {part.first, part.first + 1}, y);
                row(part, range);
            }
        }
    };
    const auto by_splines = [&](auto taps, RowPlaces<T>& places) {
        SplineReader<taps, T> reader(args, rest_x, y, places, targets);
        ScatteredReader<taps, T> scattered(args, chunk);
        read([&](PointRange part, const TilingRange& range) { reader.Read(part, range.nodes_x); },
             [&](PointRange part, const TilingRange& range) {
                 if (range_count == 1)
                     scattered.Read(part, range.nodes_x, range.nodes_y, targets);
                 else
                     scattered.Take(part, range.nodes_x, range.nodes_y, targets);
             });
        scattered.ReadTaken();
    };
    if (args.sampling == Sampling::Nodes) {
        Places<T> x;
        const auto by_nodes = [&](PointRange part, const TilingRange& range, bool is_level) {
            LocateAll(args, range.nodes_x, rest_x, part, x);
            if (!is_level) LocateAll(args, range.nodes_y, rest_y, part, y);
            ReadNodes(args, part, is_level, x, y, targets);
        };
        read([&](PointRange part, const TilingRange& range) { by_nodes(part, range, true); },
             [&](PointRange part, const TilingRange& range) { by_nodes(part, range, false); });
    } else {
        RowPlaces<T> alone;
        RowPlaces<T>& places = args.places ? *args.places : alone;
        if (args.taps == 6)
            by_splines(std::integral_constant<int, 6>(), places);
        else
            by_splines(std::integral_constant<int, 4>(), places);
    }
    if (!tiling) return AddValues(args, own, chunk);
    AddTiles(args, *tiling, tiling->sides[0], own, chunk);
    if (tiling->sides[1].count > 0) AddTiles(args, *tiling, tiling->sides[1], next, chunk);
}

}  // namespace grids_detail
}  // namespace HWY_NAMESPACE
}  // namespace pelagic
HWY_AFTER_NAMESPACE();

#endif
