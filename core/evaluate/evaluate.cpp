#include "core/evaluate/evaluate.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

#include "core/base/number.h"
#include "core/evaluate/kernels.h"
#include "core/evaluate/trains.h"

namespace pelagic {
namespace {

// A point's place on a ladder of footprints: (1 − t) of the lower rung and t of the next.
template <class T>
struct Rung {
    std::size_t lower = 0;
    T t = T(0);
};

template <class T>
Rung<T> rung_of(const std::vector<double>& ladder_m, const Strided<const T>& footprint_m, std::size_t point) {
    if (!footprint_m || ladder_m.size() == 1) return {};
    const double wanted = std::min(static_cast<double>(footprint_m[point]), ladder_m.back());
    if (!(wanted > ladder_m.front())) return {};  // the finest rung, for a footprint that is no number, too
    const auto above = std::upper_bound(ladder_m.begin() + 1, ladder_m.end() - 1, wanted);
    const std::size_t upper = static_cast<std::size_t>(above - ladder_m.begin());
    const double lower_m = ladder_m[upper - 1], upper_m = ladder_m[upper];
    return {upper - 1, static_cast<T>((wanted - lower_m) / (upper_m - lower_m))};
}

#include "core/evaluate/hidden.inl"

// What a rung of pixels hides of `whole`: less what passes through the cascades.
template <class T>
HiddenMoments<T> hidden_at(const QueryStatistics& statistics, const Rung<T>& rung,
                           const HiddenMoments<double>& whole) {
    const double t = static_cast<double>(rung.t);
    const auto left = [&](std::size_t moment) {
        const auto m = kHiddenMoments[moment];
        const double here = statistics.resolved[rung.lower].*m;
        if (!(t > 0.0)) return whole[moment] - here;  // there may be no next rung
        return whole[moment] - blended_moment(here, statistics.resolved_next[rung.lower].*m,
                                              statistics.resolved[rung.lower + 1].*m, t);
    };
    const auto hidden = possible_moments(
        PixelMoments<double>(left(0), left(1), left(2), left(3), left(4), left(5), left(6), left(7)));
    const auto narrow = [](double value) { return static_cast<T>(value); };
    return {narrow(hidden.xx),   narrow(hidden.xy),   narrow(hidden.yy),   narrow(hidden.xxxx),
            narrow(hidden.xxxy), narrow(hidden.xxyy), narrow(hidden.xyyy), narrow(hidden.yyyy)};
}

// A view beginning at a later point.
template <class Value>
Strided<Value> from_point(const Strided<Value>& view, std::size_t first) {
    return view ? Strided<Value>{&view[first], view.stride_bytes} : view;
}

// Everything about a query that is the same for all points.
template <class T>
class Evaluation {
  public:
    Evaluation(const Frame<T>& frame, int query_index, const Points<T>& points, const Results<T>& results)
        : frame_(frame),
          plan_(frame.sea().plan()),
          planned_(plan_.queries[query_index]),
          statistics_(frame.sea().statistics(query_index)),
          points_(points),
          results_(results),
          kernels_(evaluate_kernels<T>()) {
        const ProductSet given = results.given();
        needed_ = fields_of(given) & ~plan_.dropped;
        hidden_wanted_ = (given & hidden_products()).any();
        ladder_ = (points.cell_m && planned_.cell_levels.size() > 1) ||
                  (points.pixel_m && planned_.pixel_levels.size() > 1);
        has_trains_ = plan_.trains && !planned_.query.only_cascade;
        if (has_trains_)
            start_cycles_ = phases_at(frame.sea().trains(), points.origin_m, frame.time_within_loop_s());
        for (const std::vector<int>* levels : {&planned_.cell_levels, &planned_.pixel_levels})
            for (int level : *levels) {
                if (std::find(levels_.begin(), levels_.end(), level) != levels_.end()) continue;
                levels_.push_back(level);
                grids_.push_back(grids_of(level));
            }
        // Only where trains see each point's own pixel, or cascades a ladder, do points differ.
        uniform_hidden_ =
            !(has_trains_ && points.pixel_m) && !(points.pixel_m && planned_.pixel_levels.size() > 1);
        if (hidden_wanted_ && uniform_hidden_)
            hidden_ =
                hidden_at<T>(statistics_, {},
                             hidden_moments<double>(has_trains_ ? hidden(frame.sea().trains(), plan_.filter,
                                                                         planned_.query.pixel_m.front())
                                                                : statistics_.whole));
    }

    void run(std::size_t first, Chunk<T>& chunk, HiddenChunk<T>& hidden_of) const {
        chunk.count = std::min(Chunk<T>::kPoints, points_.count - first);
        const auto take = [&](const auto& rest_m) {
            for (std::size_t i = 0; i < chunk.count; ++i) {
                const glm::vec<2, T> rest = rest_m[i];
                chunk.rest_x[i] = rest.x;
                chunk.rest_y[i] = rest.y;
            }
        };
        if (points_.rest_m.stride_bytes == sizeof(glm::vec<2, T>))
            take(&points_.rest_m[first]);  // side by side: in vectors
        else
            take(from_point(points_.rest_m, first));
        std::fill(chunk.rest_x.begin() + chunk.count, chunk.rest_x.end(), T(0));
        std::fill(chunk.rest_y.begin() + chunk.count, chunk.rest_y.end(), T(0));
        // What isn't needed, or is zero in this scene, is read as 0 where a product asks for it.
        for (typename Chunk<T>::Values& sum : chunk.sums) sum.fill(T(0));
        if (ladder_)
            add_ladder(first, chunk, hidden_of);
        else
            for (std::size_t i = 0; i < levels_.size(); ++i) {
                FieldSet fields;
                if (levels_[i] == planned_.cell_levels.front()) fields |= cell_fields();
                if (levels_[i] == planned_.pixel_levels.front()) fields |= ~cell_fields();
                add_grids(grids_[i], {fields, nullptr, nullptr}, chunk);
            }
        add_own_footprints(first, chunk, hidden_of);
        kernels_.derive({.chunk = &chunk,
                         .results = results_.from_point(first),
                         .hidden = hidden_,
                         .hidden_of = hidden_wanted_ && !uniform_hidden_ ? &hidden_of : nullptr,
                         .whitecap_threshold = static_cast<T>(frame_.sea().whitecap_threshold()),
                         .third_moment = plan_.knobs.third_moment});
    }

  private:
    // How a level's grids count at a chunk's points.
    struct Share {
        FieldSet fields;
        const T *cell_weight, *pixel_weight;
    };

    // A level's grids, cascade after cascade; those through which nothing passes have nothing to add.
    std::vector<GridArgs<T>> grids_of(int level) const {
        std::vector<GridArgs<T>> grids;
        for (int c = 0; c < static_cast<int>(plan_.cascades.size()); ++c) {
            const CascadePlan& cascade = plan_.cascades[c];
            const int g = cascade.grid_of_level[level];
            if (g < 0) continue;
            const Grid& grid = cascade.grids[g];
            // The origin's own phase within the tile, in double: the rest of the way is short.
            const auto phase = [&](double x) {
                const double tiles = x / cascade.size_m;
                return (tiles - std::floor(tiles)) * grid.resolution;
            };
            GridArgs<T> args{.sampling = grid.sampling,
                             .taps = plan_.knobs.spline_taps,
                             .n = grid.resolution,
                             .nodes_per_m = grid.resolution / cascade.size_m,
                             .origin_nodes_x = phase(points_.origin_m.x),
                             .origin_nodes_y = phase(points_.origin_m.y),
                             .cell_group = cell_fields()};
            for (std::size_t f = 0; f < kFieldCount; ++f)
                if (needed_[f]) args.samples[f] = frame_.samples(c, g, static_cast<Field>(f));
            grids.push_back(args);
        }
        return grids;
    }

    void add_grids(const std::vector<GridArgs<T>>& grids, const Share& share, Chunk<T>& chunk) const {
        if (share.fields.none()) return;
        for (GridArgs<T> args : grids) {
            bool any = false;
            for (std::size_t f = 0; f < kFieldCount; ++f) {
                if (!share.fields[f]) args.samples[f] = nullptr;
                any = any || args.samples[f];
            }
            if (!any) continue;
            args.cell_weight = share.cell_weight;
            args.pixel_weight = share.pixel_weight;
            kernels_.add_grid(args, chunk);
        }
    }

    // Each point between two rungs: the levels one after another, each with the points' shares in it.
    void add_ladder(std::size_t first, Chunk<T>& chunk, HiddenChunk<T>& hidden_of) const {
        std::array<Rung<T>, Chunk<T>::kPoints> cell, pixel;
        for (std::size_t i = 0; i < chunk.count; ++i) {
            cell[i] = rung_of(planned_.query.cell_m, points_.cell_m, first + i);
            pixel[i] = rung_of(planned_.query.pixel_m, points_.pixel_m, first + i);
        }
        typename Chunk<T>::Values cell_weight, pixel_weight;
        const auto shares = [&](const std::vector<int>& levels, int level, const auto& rungs,
                                typename Chunk<T>::Values& weight) {
            bool any = false;
            weight.fill(T(0));
            for (std::size_t i = 0; i < chunk.count; ++i) {
                if (levels[rungs[i].lower] == level) weight[i] += T(1) - rungs[i].t;
                if (rungs[i].t > T(0) && levels[rungs[i].lower + 1] == level) weight[i] += rungs[i].t;
                any = any || weight[i] > T(0);
            }
            return any;
        };
        for (std::size_t l = 0; l < levels_.size(); ++l) {
            FieldSet fields;
            if (shares(planned_.cell_levels, levels_[l], cell, cell_weight)) fields |= cell_fields();
            if (shares(planned_.pixel_levels, levels_[l], pixel, pixel_weight)) fields |= ~cell_fields();
            add_grids(grids_[l], {fields, cell_weight.data(), pixel_weight.data()}, chunk);
        }
        if (!hidden_wanted_ || uniform_hidden_ || has_trains_) return;
        const HiddenMoments<double> whole = hidden_moments<double>(statistics_.whole);
        for (std::size_t i = 0; i < chunk.count; ++i) {
            const HiddenMoments<T> left = hidden_at<T>(statistics_, pixel[i], whole);
            for (std::size_t m = 0; m < left.size(); ++m) hidden_of.moments[m][i] = left[m];
        }
    }

    // The trains, which see each point's own footprints, and what all together hide.
    void add_own_footprints(std::size_t first, Chunk<T>& chunk, HiddenChunk<T>& hidden_of) const {
        if (!has_trains_) return;
        typename Chunk<T>::Values cell, pixel;
        const auto own = [&](const Strided<const T>& footprint_m, double finest_m,
                             typename Chunk<T>::Values& of) {
            const T finest = static_cast<T>(finest_m);
            for (std::size_t i = 0; i < Chunk<T>::kPoints; ++i) {
                const T wanted = i < chunk.count ? footprint_m[first + i] : finest;
                of[i] = wanted > finest ? wanted : finest;  // the finest for one that is no number, too
            }
        };
        const Query& query = planned_.query;
        if (points_.cell_m) own(points_.cell_m, query.cell_m.front(), cell);
        if (points_.pixel_m) own(points_.pixel_m, query.pixel_m.front(), pixel);
        const bool varied = hidden_wanted_ && !uniform_hidden_;
        add_trains<T>({.trains = &frame_.sea().trains(),
                       .start_cycles = start_cycles_.data(),
                       .filter = plan_.filter,
                       .wanted = needed_,
                       .cell_m = static_cast<T>(query.cell_m.front()),
                       .pixel_m = static_cast<T>(query.pixel_m.front()),
                       .cell_of = points_.cell_m ? cell.data() : nullptr,
                       .pixel_of = points_.pixel_m ? pixel.data() : nullptr,
                       .hidden = varied ? &hidden_of : nullptr},
                      chunk);
        if (!varied || plan_.cascades.empty()) return;
        for (std::size_t i = 0; i < chunk.count; ++i) {
            HiddenMoments<double> whole;
            for (std::size_t m = 0; m < whole.size(); ++m)
                whole[m] = static_cast<double>(hidden_of.moments[m][i]);
            const HiddenMoments<T> left =
                hidden_at<T>(statistics_, rung_of(query.pixel_m, points_.pixel_m, first + i), whole);
            for (std::size_t m = 0; m < left.size(); ++m) hidden_of.moments[m][i] = left[m];
        }
    }

    const Frame<T>& frame_;
    const Plan& plan_;
    const PlannedQuery& planned_;
    const QueryStatistics& statistics_;
    const Points<T>& points_;
    const Results<T>& results_;
    EvaluateKernels<T> kernels_;
    FieldSet needed_;
    bool hidden_wanted_ = false, ladder_ = false, has_trains_ = false, uniform_hidden_ = true;
    HiddenMoments<T> hidden_{};
    std::vector<double> start_cycles_;
    std::vector<int> levels_;
    std::vector<std::vector<GridArgs<T>>> grids_;  // parallel to levels_
};

}  // namespace

template <class T>
void evaluate(const Frame<T>& frame, int query_index, const Points<T>& points, const Results<T>& results) {
    const Query& query = frame.sea().plan().queries.at(query_index).query;
    if (!frame.is_set()) throw std::invalid_argument("the frame has no time yet: call set() first");
    const ProductSet given = results.given();
    for (const ProductRow& row : kProductTable)
        if (given[index(row.product)] && !query.products[index(row.product)])
            throw std::invalid_argument("query \"" + query.name + "\" does not hold \"" + row.name +
                                        "\": ask for it when the plan is made");
    const Evaluation<T> evaluation(frame, query_index, points, results);
    constexpr std::size_t kPoints = Chunk<T>::kPoints;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, (points.count + kPoints - 1) / kPoints),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                          Chunk<T> chunk;
                          HiddenChunk<T> hidden_of{};
                          for (std::size_t c = range.begin(); c < range.end(); ++c)
                              evaluation.run(c * kPoints, chunk, hidden_of);
                      });
}

template void evaluate(const Frame<float>&, int, const Points<float>&, const Results<float>&);
template void evaluate(const Frame<double>&, int, const Points<double>&, const Results<double>&);

}  // namespace pelagic
