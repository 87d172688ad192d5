#include "core/evaluate/prepared_query.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "core/base/number.h"
#include "core/evaluate/taps.h"
#include "core/evaluate/trains.h"
#include "core/scene/limits.h"

namespace pelagic {
namespace {

#include "core/evaluate/unresolved.inl"

constexpr std::array kDisplacementGradients{Field::Dxx, Field::Dyy, Field::Dxy};

// What a pixel's level leaves unresolved of `whole`: what the cascades don't resolve, and `beside` on top of it.
template <class T>
UnresolvedMoments<T> unresolved_at(const QueryStatistics& statistics, const LevelBlend<T>& blend,
                                   const UnresolvedMoments<double>& whole,
                                   const UnresolvedMoments<double>& beside = {}) {
    const double t = static_cast<double>(blend.t);
    const auto left = [&](std::size_t moment) {
        const auto m = kUnresolvedMoments[moment];
        const double here = statistics.resolved[blend.lower].*m;
        if (!(t > 0.0)) return whole[moment] - here + beside[moment];  // there may be no next level
        return beside[moment] + whole[moment] -
               blended_moment(here, statistics.resolved_next[blend.lower].*m,
                              statistics.resolved[blend.lower + 1].*m, t);
    };
    const auto unresolved = possible_moments(
        PixelMoments<double>(left(0), left(1), left(2), left(3), left(4), left(5), left(6), left(7)));
    const auto narrow = [](double value) { return static_cast<T>(value); };
    return {narrow(unresolved.xx),   narrow(unresolved.xy),   narrow(unresolved.yy),
            narrow(unresolved.xxxx), narrow(unresolved.xxxy), narrow(unresolved.xxyy),
            narrow(unresolved.xyyy), narrow(unresolved.yyyy)};
}

// A view beginning at a later point.
template <class Value>
Strided<Value> from_point(const Strided<Value>& view, std::size_t first) {
    return view ? Strided<Value>{&view[first], view.stride_bytes} : view;
}

}  // namespace

template <class T>
struct PreparedQuery<T>::Call {
    const Points<T>& points;
    const Results<T>& results;
    const Place& place;
    FieldSet needed;  // except those of the waves that break
    bool breaks;      // something of the waves that break is wanted
    bool wants_unresolved, has_levels;
    bool differ_in_unresolved;  // where trains use each point's own pixel, or cascades have levels
};

// What a chunk of a sea with masks needs besides.
template <class T>
struct PreparedQuery<T>::MaskWork {
    MaskChunk<T> gains;
    Chunk<T> calm;                     // as a slick leaves it
    Chunk<T> values, breaking_values;  // heights and horizontal displacements in the derivatives' footprints
    ChunkFootprints<T> calm_cells, calm_pixels;
    alignas(64) typename Chunk<T>::Values calm_share_of_cells, calm_share_of_pixels;
    bool has_values = false;

    static void begin(Chunk<T>& chunk, const Chunk<T>& like) {
        chunk.count = like.count;
        chunk.rest_x = like.rest_x;
        chunk.rest_y = like.rest_y;
        for (auto& sum : chunk.sums) std::fill(sum.begin(), sum.begin() + like.padded(), T(0));
        std::fill(chunk.turn.begin(), chunk.turn.begin() + like.padded(), T(0));
    }
};

// The state of one chunk.
template <class T>
struct PreparedQuery<T>::Work {
    Chunk<T> chunk, breaking;
    UnresolvedChunk<T> unresolved_of;
    ChunkFootprints<T> cells, pixels, breaking_pixels;
    GustChunk<T> gusts;
    FieldSet needed;
    bool apart;  // the displacement gradient of the waves that break is in `breaking`, not in `chunk`
    std::optional<MaskWork> masks{};  // of a sea that has some
    bool masked = false;              // whether they change something at the chunk's points
    bool of_vessels = false;  // what is added now: vessels' waves, which masks don't change, or the sea
    std::array<TilingPlaces<T>, limits::kCascades> tiling;  // of the chunk's points, by cascade
    TilingReader<T> tiling_reader;
    std::vector<std::vector<std::unique_ptr<RowPlaces<T>>>> places;  // of grids by level; empty: not kept
    std::uint64_t row = 0;  // that the chunk's x belong to; 0: x are not compared with those before
};

// How points are cut into chunks: in their order; or, of a patch, by columns of pieces of its rows, one above the other.
template <class T>
struct PreparedQuery<T>::Cut {
    static constexpr std::size_t kBlock = 32;
    std::size_t rows, row_points, width;

    std::size_t pieces() const { return (row_points + width - 1) / width; }
    std::size_t chunks() const { return rows * pieces(); }
    PointRange chunk(std::size_t c) const {
        const std::size_t of_block = kBlock * pieces(), block = c / of_block, above = block * kBlock;
        const std::size_t high = std::min(kBlock, rows - above), in_block = c - block * of_block;
        const std::size_t begin = (above + in_block % high) * row_points, piece = in_block / high * width;
        return {begin + piece, begin + std::min(piece + width, row_points)};
    }
};

template <class T>
typename PreparedQuery<T>::Cut PreparedQuery<T>::cut(const Call& call) const {
    constexpr std::size_t kPoints = Chunk<T>::kPoints, kVector = Chunk<T>::kLongestVector;
    const Points<T>& points = call.points;
    const Cut all{1, points.count, kPoints};
    const bool has_splines = std::any_of(levels_.begin(), levels_.end(), [](const LevelGrids& level) {
        return std::any_of(level.grids.begin(), level.grids.end(),
                           [](const GridArgs<T>& grid) { return grid.sampling == Sampling::Spline; });
    });
    if (call.has_levels || !has_splines) return all;
    std::size_t row = 1;
    while (row < points.count && points.rest_m[row].y == points.rest_m[0].y) ++row;
    if (row == points.count || row < kPoints / 2 || points.count % row != 0) return all;
    const std::size_t pieces = (row + kPoints - 1) / kPoints;
    return {points.count / row, row, ((row + pieces - 1) / pieces + kVector - 1) / kVector * kVector};
}

template <class T>
PreparedQuery<T>::PreparedQuery(const Frame<T>& frame, int query_index, ProductSet wanted,
                                glm::dvec2 origin_m, const Whitecaps* whitecaps)
    : frame_(&frame),
      query_(query_index),
      wanted_(wanted),
      kernels_(evaluate_kernels<T>()),
      given_whitecaps_(whitecaps) {
    take_sea();
    const Plan& plan = frame.sea().plan();
    const Query& query = planned_->query;
    ProductSet held = query.products & ~lasting_products();
    if ((query.products & lasting_products()).any()) held.set(index(Product::Breaking));
    for (const ProductRow& row : kProductTable)
        if (wanted[index(row.product)] && !held[index(row.product)])
            throw std::invalid_argument("query \"" + query.name + "\" does not hold \"" + row.name +
                                        (query.products[index(row.product)]
                                             ? "\" at one time alone: ask a SeaAtTime"
                                             : "\": ask for it when the plan is made"));
    has_trains_ = plan.trains && !query.only_cascade;
    has_coast_ = has_trains_ && frame.sea().coast();
    has_surf_ = frame.sea().has_surf() && !query.only_cascade;
    has_random_tiling_ = !query.only_cascade &&
                         std::any_of(plan.cascades.begin(), plan.cascades.end(),
                                     [](const CascadePlan& cascade) { return cascade.has_random_tiling; });
    breaks_ = (wanted & breaking_products()).any();
    has_masks_ = plan.masks && !query.only_cascade;
    sea_cascades_ = plan.sea_cascades();
    has_vessels_ = sea_cascades_ < plan.cascades.size() && !query.only_cascade;
    for (int c = static_cast<int>(sea_cascades_); c < static_cast<int>(plan.cascades.size()); ++c)
        if (plan.hides_slopes(c)) hiding_vessels_.push_back(c);
    for (const std::vector<int>* levels :
         {&planned_->cell_levels, &planned_->pixel_levels, &planned_->breaking_levels, &planned_->calm_cells,
          &planned_->calm_pixels})
        for (const int level : *levels)
            if (std::none_of(levels_.begin(), levels_.end(),
                             [&](const LevelGrids& there) { return there.level == level; }))
                levels_.push_back({level, {}, {}, {}, {}});
    for (const CascadePlan& cascade : plan.cascades)
        whole_m_.push_back(static_cast<T>(whole_footprint_m(cascade, plan.filter)));
    place_.origin_m = origin_m;
    refresh();
}

template <class T>
void PreparedQuery<T>::take_sea() {
    const Sea<T>& sea = frame_->sea();
    planned_ = &sea.plan().queries.at(query_);
    statistics_ = &sea.statistics(query_);
    ellipses_ = &sea.ellipses(query_);
    whitecaps_ = given_whitecaps_ ? given_whitecaps_ : &sea.whitecaps();
}

template <class T>
void PreparedQuery<T>::refresh() {
    if (!frame_->is_set()) throw std::invalid_argument("the frame has no time yet: call set() first");
    take_sea();
    const Plan& plan = frame_->sea().plan();
    const Query& query = planned_->query;
    // A cascade's own tile is periodic and only a part of the sea: it has no gusts.
    gusts_ = whitecaps_->gusts && !query.only_cascade && (wanted_ & gusty_products()).any()
                 ? &*whitecaps_->gusts
                 : nullptr;
    if ((wanted_ & unresolved_products()).any())
        unresolved_ = unresolved_at<T>(
            *statistics_, {0, T(0)},
            unresolved_moments<double>(
                has_trains_ ? unresolved(frame_->sea().trains(), plan.filter, query.pixel_m.front())
                            : statistics_->whole));
    FieldSet needed = fields_of(wanted_) & ~plan.dropped;
    if (breaks_) needed |= displacement_gradient_fields();
    if (breaks_ && has_surf_) needed |= fields(Field::Height);
    if (has_random_tiling_ || has_masks_) needed |= gradient_fields(needed) & ~plan.dropped;
    for (LevelGrids& of : levels_) {
        of.grids.clear();
        of.cascades.clear();
        of.breaks_alike.clear();
        of.of_cascade.assign(plan.cascades.size(), -1);
        for (int c = 0; c < static_cast<int>(plan.cascades.size()); ++c) {
            const CascadePlan& cascade = plan.cascades[c];
            const int g = cascade.grid_of_level[of.level];
            if (g < 0) continue;
            const Grid& grid = cascade.grids[g];
            of.of_cascade[c] = static_cast<int>(of.grids.size());
            of.breaks_alike.push_back(breaks_ &&
                                      cascade.grid_of_level[planned_->pixel_levels.front()] ==
                                          cascade.grid_of_level[planned_->breaking_levels.front()]);
            of.cascades.push_back(c);
            GridArgs<T>& args = of.grids.emplace_back();
            args.sampling = grid.sampling;
            args.taps = plan.knobs.spline_taps;
            args.n = grid.resolution;
            args.size_m = cascade.size_m;
            args.nodes_per_m = grid.resolution / cascade.size_m;
            args.cell_group = cell_fields();
            for (std::size_t f = 0; f < kFieldCount; ++f)
                if (needed[f]) args.samples[f] = frame_->samples(c, g, static_cast<Field>(f));
        }
    }
    place_ = place_of(place_.origin_m);
    times_set_ = frame_->times_set();
}

template <class T>
typename PreparedQuery<T>::Place PreparedQuery<T>::place_of(glm::dvec2 origin_m) const {
    Place place{origin_m, {}, {}, {}, {}};
    const Plan& plan = frame_->sea().plan();
    for (std::size_t c = 0; has_random_tiling_ && c < sea_cascades_; ++c)
        place.tiling.emplace_back(tiling_key(plan.from->scene.shot.seed, static_cast<int>(c)),
                                  plan.cascades[c].size_m, origin_m);
    for (const LevelGrids& of : levels_) {
        std::vector<glm::dvec2>& nodes = place.nodes.emplace_back();
        for (const GridArgs<T>& grid : of.grids) {
            // The origin's own phase within the tile, in double: the rest of the way is short.
            const auto phase = [&](double x) {
                const double tiles = x / grid.size_m;
                return (tiles - std::floor(tiles)) * grid.n;
            };
            nodes.emplace_back(phase(origin_m.x), phase(origin_m.y));
        }
    }
    if (has_trains_)
        place.start_cycles = phases_at(frame_->sea().trains(), origin_m, frame_->time_within_loop_s());
    if (gusts_) place.gusts = gust_phases(gusts_->plan, origin_m, frame_->time_within_loop_s());
    return place;
}

template <class T>
typename PreparedQuery<T>::Call PreparedQuery<T>::call(const Points<T>& points, const Results<T>& results,
                                                       const Place& place) const {
    const ProductSet given = results.given();
    const bool many_pixels = planned_->pixel_levels.size() > 1;
    FieldSet needed = fields_of(given & ~breaking_products());
    if (has_surf_ && given[index(Product::Breaking)]) needed |= fields(Field::Height);
    return {
        .points = points,
        .results = results,
        .place = place,
        .needed = needed & ~frame_->sea().plan().dropped,
        .breaks = (given & breaking_products()).any(),
        .wants_unresolved = (given & unresolved_products()).any(),
        .has_levels = (points.cell_m && planned_->cell_levels.size() > 1) || (points.pixel_m && many_pixels),
        .differ_in_unresolved = (points.pixel_m && (has_trains_ || many_pixels)) || has_coast_};
}

template <class T>
void PreparedQuery<T>::evaluate(const Points<T>& points, const Results<T>& results) const {
    evaluate_by(points, results, false);
}

template <class T>
void PreparedQuery<T>::evaluate_alone(const Points<T>& points, const Results<T>& results) const {
    evaluate_by(points, results, true);
}

template <class T>
void PreparedQuery<T>::evaluate_by(const Points<T>& points, const Results<T>& results, bool alone) const {
    const ProductSet given = results.given();
    for (const ProductRow& row : kProductTable)
        if (given[index(row.product)] && !wanted_[index(row.product)])
            throw std::invalid_argument("query \"" + planned_->query.name + "\" was prepared without \"" +
                                        row.name + "\"");
    if (!is_current())
        throw std::logic_error("the frame was set to another time: refresh() makes the query valid again");
    if ((points.cell_axis_m && !points.cell_m) || (points.pixel_axis_m && !points.pixel_m))
        throw std::invalid_argument("a footprint's long axis needs its width as well");
    if ((points.cell_axis_m || points.pixel_axis_m) && planned_->query.lattice)
        throw std::invalid_argument("query \"" + planned_->query.name +
                                    "\" is of a lattice, whose footprints are round");
    if (points.count == 0) return;
    const auto at = [&](const Place& place) {
        const Call call = this->call(points, results, place);
        const Cut cut = this->cut(call);
        const auto work = [&](std::size_t begin, std::size_t end) {
            Work of_thread;
            if (cut.rows > 1) keep_places(of_thread);
            for (std::size_t c = begin; c < end; ++c) run(call, cut.chunk(c), of_thread);
        };
        const std::size_t chunks = cut.chunks();
        if (alone || chunks == 1) return work(0, chunks);
        tbb::parallel_for(
            tbb::blocked_range<std::size_t>(0, chunks),
            [&](const tbb::blocked_range<std::size_t>& range) { work(range.begin(), range.end()); });
    };
    if (points.origin_m == place_.origin_m)
        at(place_);
    else
        at(place_of(points.origin_m));
}

template <class T>
void PreparedQuery<T>::keep_places(Work& work) const {
    for (const LevelGrids& level : levels_) {
        auto& of_level = work.places.emplace_back();
        for (const GridArgs<T>& grid : level.grids)
            of_level.push_back(
                grid.sampling == Sampling::Spline ? std::make_unique_for_overwrite<RowPlaces<T>>() : nullptr);
    }
    work.row = 1;
}

template <class T>
void PreparedQuery<T>::run(const Call& call, PointRange of, Work& work) const {
    Chunk<T>& chunk = work.chunk;
    const Plan& plan = frame_->sea().plan();
    const std::size_t first = of.first, before = std::exchange(chunk.count, of.end - of.first);
    const std::size_t padded = chunk.padded();
    bool is_same = before == chunk.count;
    const auto take = [&](const auto& rest_m) {
        for (std::size_t i = 0; i < chunk.count; ++i) {
            const glm::vec<2, T> rest = rest_m[i];
            is_same &= chunk.rest_x[i] == rest.x;
            chunk.rest_x[i] = rest.x;
            chunk.rest_y[i] = rest.y;
        }
    };
    if (call.points.rest_m.stride_bytes == sizeof(glm::vec<2, T>))
        take(&call.points.rest_m[first]);  // side by side: in vectors
    else
        take(from_point(call.points.rest_m, first));
    if (work.row != 0 && !is_same) ++work.row;
    for (auto* rest : {&chunk.rest_x, &chunk.rest_y})
        std::fill(rest->begin() + chunk.count, rest->begin() + padded + Chunk<T>::kLongestVector, T(0));
    // Fields that aren't needed, or are zero in this scene, are 0 for products that ask for them.
    for (typename Chunk<T>::Values& sum : chunk.sums) std::fill(sum.begin(), sum.begin() + padded, T(0));
    std::fill(chunk.turn.begin(), chunk.turn.begin() + padded, T(0));
    if (call.has_levels) {
        const Query& query = planned_->query;
        const double longest = frame_->sea().plan().knobs.longest_ellipse;
        work.cells.take(query.cell_m, call.points.cell_m, call.points.cell_axis_m, longest, first,
                        chunk.count);
        work.pixels.take(query.pixel_m, call.points.pixel_m, call.points.pixel_axis_m, longest, first,
                         chunk.count);
    }
    for (std::size_t c = 0; c < call.place.tiling.size(); ++c) work.tiling[c].forget(work.row);
    work.apart = breaks_apart(call, work);
    if (has_masks_) {
        if (!work.masks) work.masks.emplace();
        work.masked = work.masks->gains.take(*plan.masks, frame_->strips(), call.points.origin_m, chunk);
    }
    work.needed = call.needed;
    if (call.breaks && !work.apart) work.needed |= displacement_gradient_fields();
    if (work.apart) {
        work.breaking.count = chunk.count;
        work.breaking.rest_x = chunk.rest_x;
        work.breaking.rest_y = chunk.rest_y;
        for (const Field field : kDisplacementGradients) {
            auto& sum = work.breaking.sums[index(field)];
            std::fill(sum.begin(), sum.begin() + padded, T(0));
        }
        std::fill(work.breaking.turn.begin(), work.breaking.turn.begin() + padded, T(0));
    }
    const auto add = [&](bool of_vessels) {
        work.of_vessels = of_vessels;
        call.has_levels ? add_levels(call, work) : add_only_footprint(call, work);
    };
    add(false);
    if (work.masked) {
        if (work.masks->gains.has_ripples) calm_ripples(call, work);
        add_values(call, work);
    }
    add_own_footprints(call, first, work);
    if (work.masked) mask_chunks(call, work);
    if (has_vessels_) add(true);
    work.of_vessels = false;
    const bool hides_vessels = has_vessels_ && call.wants_unresolved && hide_vessels(call, work);
    const bool has_gusts = gusts_ && (call.results.given() & gusty_products()).any();
    if (has_gusts) take_gusts(call, first, work);
    kernels_.derive(
        {.chunk = &chunk,
         .breaking = work.apart ? &work.breaking : &chunk,
         .results = call.results.from_point(first),
         .unresolved = unresolved_,
         .unresolved_of = call.wants_unresolved && (call.differ_in_unresolved || work.masked || hides_vessels)
                              ? &work.unresolved_of
                              : nullptr,
         .whitecap_threshold = static_cast<T>(whitecaps_->threshold),
         .whitecap_threshold_of = has_gusts ? work.gusts.whitecap_threshold.data() : nullptr,
         .third_moment = plan.knobs.third_moment,
         .rest_normal =
             call.points.rest_normal ? from_point(call.points.rest_normal, first) : call.points.rest_normal});
    const auto unresolved = call.results.vectors(Product::SlopeVariance);
    if (has_gusts && unresolved)
        for (std::size_t i = 0; i < chunk.count; ++i) unresolved[first + i] *= work.gusts.factor[i];
    if (const auto breaking = call.results.numbers(Product::Breaking); breaking && has_surf_) {
        for (std::size_t i = 0; i < chunk.count; ++i) {
            const double finest_m = planned_->query.cell_m.front(),
                         given_m = call.points.cell_m ? static_cast<double>(call.points.cell_m[first + i])
                                                      : finest_m,
                         cell_m = given_m > finest_m ? given_m : finest_m;  // also for one that is no number
            const double more =
                frame_->sea().surf_foam(call.place.origin_m + glm::dvec2(chunk.rest_x[i], chunk.rest_y[i]),
                                        static_cast<double>(chunk.sums[index(Field::Height)][i]), cell_m);
            breaking[first + i] += (T(1) - breaking[first + i]) * static_cast<T>(more);
        }
    }
    if (const auto breaking = call.results.numbers(Product::Breaking); breaking && work.masked)
        for (std::size_t i = 0; i < chunk.count; ++i) breaking[first + i] *= work.masks->gains.foam[i];
}

template <class T>
void PreparedQuery<T>::calm_ripples(const Call& call, Work& work) const {
    MaskWork& masks = *work.masks;
    const Query& query = planned_->query;
    Chunk<T>& chunk = work.chunk;
    const auto share = [&](const std::vector<int>& calm, const std::vector<double>& levels_m,
                           const ChunkFootprints<T>& of, typename Chunk<T>::Values& shares,
                           ChunkFootprints<T>& to) {
        to.any_round = to.any_ellipse = false;
        for (std::size_t i = 0; i < chunk.count; ++i) {
            const double footprint_m = call.has_levels ? levels_m[of.of[i].blend.lower] : levels_m.front();
            shares[i] = !calm.empty() && footprint_m < kSlick_m ? T(1) - masks.gains.ripples[i] : T(0);
            to.of[i] = call.has_levels && shares[i] > T(0) ? of.of[i] : Footprint<T>{};
            to.of[i].blend = {};
            to.of[i].width_m = static_cast<T>(kSlick_m);
            to.of[i].is_ellipse = to.of[i].is_ellipse && to.of[i].length_m > to.of[i].width_m;
            (to.of[i].is_ellipse ? to.any_ellipse : to.any_round) = true;
        }
    };
    share(planned_->calm_cells, query.cell_m, work.cells, masks.calm_share_of_cells, masks.calm_cells);
    share(planned_->calm_pixels, query.pixel_m, work.pixels, masks.calm_share_of_pixels, masks.calm_pixels);
    FieldSet fields;
    if (!planned_->calm_cells.empty()) fields |= cell_fields();
    if (!planned_->calm_pixels.empty()) fields |= ~cell_fields();
    fields &= work.needed;
    if (fields.none()) return;
    masks.begin(masks.calm, chunk);
    if (call.has_levels) {
        const Seen cells{planned_->calm_cells, masks.calm_cells},
            pixels{planned_->calm_pixels, masks.calm_pixels};
        FieldSet round;
        if (masks.calm_cells.any_round) round |= cell_fields();
        if (masks.calm_pixels.any_round) round |= ~cell_fields();
        add_round(call, round & fields, cells, pixels, work, masks.calm);
        if (masks.calm_cells.any_ellipse) add_ellipses(call, cell_fields() & fields, cells, work, masks.calm);
        if (masks.calm_pixels.any_ellipse)
            add_ellipses(call, ~cell_fields() & fields, pixels, work, masks.calm);
    } else {
        for (std::size_t l = 0; l < levels_.size(); ++l) {
            FieldSet here;
            if (std::ranges::count(planned_->calm_cells, levels_[l].level)) here |= cell_fields();
            if (std::ranges::count(planned_->calm_pixels, levels_[l].level)) here |= ~cell_fields();
            add_grids(call, l, {.fields = here & fields}, work, masks.calm);
        }
    }
    const auto mix = [&](const auto& calm, const auto& shares, auto& to) {
        for (std::size_t i = 0; i < chunk.count; ++i)
            if (shares[i] > T(0)) to[i] += shares[i] * (calm[i] - to[i]);
    };
    for (std::size_t f = 0; f < kFieldCount; ++f)
        if (fields[f])
            mix(masks.calm.sums[f], cell_fields()[f] ? masks.calm_share_of_cells : masks.calm_share_of_pixels,
                chunk.sums[f]);
    if (fields[index(Field::Dxy)]) mix(masks.calm.turn, masks.calm_share_of_pixels, chunk.turn);
}

template <class T>
void PreparedQuery<T>::add_values(const Call& call, Work& work) const {
    MaskWork& masks = *work.masks;
    masks.has_values = masks.gains.has_edges && ((work.needed & ~cell_fields()).any() || work.apart);
    if (!masks.has_values) return;
    const FieldSet values = fields(Field::Height, Field::Dx, Field::Dy) & ~frame_->sea().plan().dropped;
    masks.begin(masks.values, work.chunk);
    masks.begin(masks.breaking_values, work.chunk);
    const auto add = [&](const std::vector<int>& levels, const ChunkFootprints<T>& footprints, Chunk<T>& to) {
        if (!call.has_levels) {
            for (std::size_t l = 0; l < levels_.size(); ++l)
                if (levels_[l].level == levels.front()) add_grids(call, l, {.fields = values}, work, to);
            return;
        }
        const Seen seen{levels, footprints};
        if (footprints.any_round) add_round(call, values, seen, seen, work, to);
        if (footprints.any_ellipse) add_ellipses(call, values, seen, work, to);
    };
    if ((work.needed & ~cell_fields()).any()) add(planned_->pixel_levels, work.pixels, masks.values);
    if (work.apart) add(planned_->breaking_levels, work.breaking_pixels, masks.breaking_values);
}

template <class T>
void PreparedQuery<T>::mask_chunks(const Call& call, Work& work) const {
    MaskWork& masks = *work.masks;
    masks.gains.has_edges = masks.has_values;  // else nobody asks for derivatives
    mask_sums(masks.gains, masks.values, work.chunk);
    if (work.apart) mask_sums(masks.gains, masks.breaking_values, work.breaking);
    if (call.wants_unresolved) mask_unresolved(call, work);
}

template <class T>
void PreparedQuery<T>::mask_unresolved(const Call& call, Work& work) const {
    const MaskWork& masks = *work.masks;
    auto& moments = work.unresolved_of.moments;
    const std::size_t count = work.chunk.count;
    if (!call.differ_in_unresolved)
        for (std::size_t m = 0; m < moments.size(); ++m)
            std::fill_n(moments[m].begin(), work.chunk.padded(), unresolved_[m]);
    const UnresolvedMoments<double> slick = unresolved_moments<double>(frame_->sea().slick());
    const double whole_m0 = has_trains_ ? frame_->sea().trains().outside.m0 : statistics_->whole.m0;
    for (std::size_t i = 0; i < count; ++i) {
        const LevelBlend<T> blend = call.has_levels ? work.pixels.of[i].blend : LevelBlend<T>{};
        if (const T kept = masks.gains.ripples[i]; kept != T(1)) {
            // What is hidden besides a slick's waves: by coarse pixels and grids, or by the ellipse as long as a slick is wide.
            const auto left = [&](std::size_t m) { return static_cast<double>(moments[m][i]) - slick[m]; };
            const auto possible =
                possible_moments(PixelMoments<double>(left(0), left(1), left(2), 0.0, 0.0, 0.0, 0.0, 0.0));
            std::array<double, kUnresolvedSlopes> calmed{possible.xx, possible.xy, possible.yy};
            if (call.has_levels && masks.calm_pixels.of[i].is_ellipse) {
                Footprint<T> calm = masks.calm_pixels.of[i];
                calm.blend = level_blend_of(planned_->query.pixel_m, calm.width_m);
                const UnresolvedMoments<double> beside = beside_round(calm);
                if (beside[0] + beside[2] > calmed[0] + calmed[2])
                    std::copy_n(beside.begin(), calmed.size(), calmed.begin());
            }
            for (std::size_t m = 0; m < calmed.size(); ++m)
                moments[m][i] = hidden_with_ripples(moments[m][i], static_cast<T>(calmed[m]), kept);
        }
        const T waves = masks.gains.waves[i], x = masks.gains.x[i], y = masks.gains.y[i];
        for (auto& moment : moments) moment[i] *= waves * waves;
        if (x == T(0) && y == T(0)) continue;
        const double t = static_cast<double>(blend.t), shown = statistics_->resolved[blend.lower].m0;
        const double hidden =
            whole_m0 - (t > 0.0 ? blended_moment(shown, statistics_->resolved_next[blend.lower].m0,
                                                 statistics_->resolved[blend.lower + 1].m0, t)
                                : shown);
        const T hidden_m2 = static_cast<T>(std::max(hidden, 0.0));
        moments[0][i] += x * x * hidden_m2;
        moments[1][i] += x * y * hidden_m2;
        moments[2][i] += y * y * hidden_m2;
    }
}

// Between levels waves that the finer one shows whole and the coarser one not at all have (1 − t)² of their variance.
template <class T>
bool PreparedQuery<T>::hide_vessels(const Call& call, Work& work) const {
    auto& moments = work.unresolved_of.moments;
    const Plan& plan = frame_->sea().plan();
    typename Chunk<T>::Values within;
    bool any = false;
    for (const int cascade : hiding_vessels_) {
        if (!is_within(cascade, call.place.origin_m, work.chunk, within.data())) continue;
        if (!any && !call.differ_in_unresolved && !work.masked)
            for (std::size_t m = 0; m < moments.size(); ++m)
                std::fill_n(moments[m].begin(), work.chunk.padded(), unresolved_[m]);
        any = true;
        for (std::size_t i = 0; i < work.chunk.count; ++i) {
            if (within[i] == T(0)) continue;
            const LevelBlend<T> blend = call.has_levels ? work.pixels.of[i].blend : LevelBlend<T>{};
            const glm::dvec2 place_m =
                call.place.origin_m + glm::dvec2(work.chunk.rest_x[i], work.chunk.rest_y[i]);
            const auto hidden = [&](std::size_t level) {
                return frame_->hidden_slopes(
                    cascade, plan.cascades[cascade].grid_of_level[planned_->pixel_levels[level]], place_m);
            };
            glm::dvec3 sum = hidden(blend.lower);
            if (const double t = static_cast<double>(blend.t); t > 0.0)
                sum += t * (2.0 - t) * (hidden(blend.lower + 1) - sum);
            // A covariance, whatever rounding and blending leave.
            const double xx = std::max(sum.x, 0.0), yy = std::max(sum.z, 0.0), most = std::sqrt(xx * yy);
            moments[0][i] += static_cast<T>(xx);
            moments[1][i] += static_cast<T>(std::clamp(sum.y, -most, most));
            moments[2][i] += static_cast<T>(yy);
        }
    }
    return any;
}

template <class T>
void PreparedQuery<T>::take_gusts(const Call& call, std::size_t first, Work& work) const {
    const Chunk<T>& chunk = work.chunk;
    work.gusts.take(call.points, static_cast<T>(planned_->query.pixel_m.front()), first, chunk.count);
    gusts_at<T>({.gusts = gusts_,
                 .phases = &call.place.gusts,
                 .rest_x = chunk.rest_x.data(),
                 .rest_y = chunk.rest_y.data(),
                 .padded = chunk.padded()},
                work.gusts);
}

// Where pixels are finer than the breaking waves' finest footprint, where trains differ for the same pixel, and where
// the surface has no displacement gradient at all.
template <class T>
bool PreparedQuery<T>::breaks_apart(const Call& call, const Work& work) const {
    const Plan& plan = frame_->sea().plan();
    if (!call.breaks) return false;
    if (!plan.choppiness.moves() || (has_trains_ && plan.breaking.footprint_m > 0.0)) return true;
    const std::vector<int>&pixel = planned_->pixel_levels, &breaking = planned_->breaking_levels;
    if (!call.has_levels) return pixel.front() != breaking.front();
    for (std::size_t i = 0; i < work.chunk.count; ++i) {
        const Footprint<T>& of = work.pixels.of[i];
        if (pixel[of.blend.lower] != breaking[of.blend.lower]) return true;
    }
    return false;
}

// All points have the query's only footprints. A grid that the waves that break share with the normals is read once.
template <class T>
void PreparedQuery<T>::add_only_footprint(const Call& call, Work& work) const {
    const auto add = [&](Part part) {
        for (std::size_t l = 0; l < levels_.size(); ++l) {
            FieldSet fields;
            if (levels_[l].level == planned_->cell_levels.front()) fields |= cell_fields();
            if (levels_[l].level == planned_->pixel_levels.front()) fields |= ~cell_fields();
            add_grids(call, l, {.fields = fields & work.needed, .part = part}, work, work.chunk);
        }
    };
    if (!work.apart) return add(Part::All);
    const bool has_gradients =
        !work.of_vessels && (work.needed & displacement_gradient_fields()) == displacement_gradient_fields();
    if (has_gradients) {
        add(Part::Alike);
        for (const Field field : kDisplacementGradients)
            std::copy_n(work.chunk.sums[index(field)].begin(), work.chunk.padded(),
                        work.breaking.sums[index(field)].begin());
        std::copy_n(work.chunk.turn.begin(), work.chunk.padded(), work.breaking.turn.begin());
    }
    add(has_gradients ? Part::Other : Part::All);
    for (std::size_t l = 0; l < levels_.size(); ++l)
        if (levels_[l].level == planned_->breaking_levels.front())
            add_grids(
                call, l,
                {.fields = displacement_gradient_fields(), .part = has_gradients ? Part::Other : Part::All},
                work, work.breaking);
}

template <class T>
bool PreparedQuery<T>::is_within(int cascade, glm::dvec2 origin_m, const Chunk<T>& chunk, T* within) const {
    const glm::vec<2, T> from(origin_m - frame_->tile_middle_m(cascade));
    const T half = static_cast<T>(0.5 * frame_->sea().plan().cascades[cascade].size_m);
    bool any = false;
    std::fill_n(within, chunk.padded(), T(0));
    for (std::size_t i = 0; i < chunk.count; ++i) {
        const bool is_in =
            std::abs(from.x + chunk.rest_x[i]) < half && std::abs(from.y + chunk.rest_y[i]) < half;
        within[i] = is_in ? T(1) : T(0);
        any = any || is_in;
    }
    return any;
}

template <class T>
void PreparedQuery<T>::add_grids(const Call& call, std::size_t level, const Share& share, Work& work,
                                 Chunk<T>& chunk) const {
    if (share.fields.none()) return;
    const std::vector<GridArgs<T>>& grids = levels_[level].grids;
    typename Chunk<T>::Values cells, pixels;
    for (std::size_t g = 0; g < grids.size(); ++g) {
        const auto c = static_cast<std::size_t>(levels_[level].cascades[g]);
        if (work.of_vessels != (c >= sea_cascades_)) continue;
        if (share.part != Part::All && levels_[level].breaks_alike[g] != (share.part == Part::Alike))
            continue;
        GridArgs<T> args = grids[g];
        bool any = false;
        for (std::size_t f = 0; f < kFieldCount; ++f) {
            if (!share.fields[f]) args.samples[f] = nullptr;
            any = any || args.samples[f];
        }
        if (!any) continue;
        args.origin_nodes_x = call.place.nodes[level][g].x;
        args.origin_nodes_y = call.place.nodes[level][g].y;
        args.cell_weight = share.cell_weight;
        args.pixel_weight = share.pixel_weight;
        if (work.of_vessels) {
            if (!is_within(static_cast<int>(c), call.place.origin_m, chunk, cells.data())) continue;
            std::copy_n(cells.begin(), chunk.padded(), pixels.begin());
            for (std::size_t i = 0; i < chunk.count; ++i) {
                if (share.cell_weight) cells[i] *= share.cell_weight[i];
                if (share.pixel_weight) pixels[i] *= share.pixel_weight[i];
            }
            args.cell_weight = cells.data();
            args.pixel_weight = pixels.data();
        }
        if (work.row != 0) args.places = work.places[level][g].get();
        args.row = work.row;
        if (!has_random_tiling_ || work.of_vessels) {
            kernels_.add_grid(args, chunk);
            continue;
        }
        add_tiles(grids[g], args, share.fields, call.place.tiling[c], work.tiling[c], work.tiling_reader,
                  chunk, kernels_);
    }
}

// Each point between two levels. Round footprints: the levels one after another, each with the points' shares in it.
// Ellipses: see add_ellipses().
template <class T>
void PreparedQuery<T>::add_levels(const Call& call, Work& work) const {
    auto& [chunk, breaking, unresolved_of, cells, pixels, breaking_pixels, gusts, needed, apart, masks,
           masked, of_vessels, tiling, tiling_reader, places, row] = work;
    const Seen by_cell{planned_->cell_levels, cells}, by_pixel{planned_->pixel_levels, pixels};
    FieldSet round;
    if (cells.any_round) round |= cell_fields();
    if (pixels.any_round) round |= ~cell_fields();
    add_round(call, round & needed, by_cell, by_pixel, work, chunk);
    if (cells.any_ellipse) add_ellipses(call, cell_fields() & needed, by_cell, work, chunk);
    if (pixels.any_ellipse) add_ellipses(call, ~cell_fields() & needed, by_pixel, work, chunk);
    if (apart) {
        breaking_pixels.take_breaking(pixels, frame_->sea().plan().breaking, chunk.count);
        const Seen by_breaking{planned_->breaking_levels, breaking_pixels};
        if (breaking_pixels.any_round)
            add_round(call, displacement_gradient_fields(), by_cell, by_breaking, work, breaking);
        if (breaking_pixels.any_ellipse)
            add_ellipses(call, displacement_gradient_fields(), by_breaking, work, breaking);
    }
    if (work.of_vessels) return;
    if (!call.wants_unresolved || !call.differ_in_unresolved || has_trains_) return;
    const UnresolvedMoments<double> whole = unresolved_moments<double>(statistics_->whole);
    for (auto& moment : unresolved_of.moments)
        std::fill(moment.begin() + chunk.count, moment.begin() + chunk.padded(), T(0));
    for (std::size_t i = 0; i < chunk.count; ++i) {
        const UnresolvedMoments<T> left =
            unresolved_at<T>(*statistics_, pixels.of[i].blend, whole, beside_round(pixels.of[i]));
        for (std::size_t m = 0; m < left.size(); ++m) unresolved_of.moments[m][i] = left[m];
    }
}

template <class T>
void PreparedQuery<T>::add_round(const Call& call, FieldSet fields, const Seen& cells, const Seen& pixels,
                                 Work& work, Chunk<T>& chunk) const {
    if (fields.none()) return;
    const std::size_t count = chunk.count, padded = chunk.padded();
    typename Chunk<T>::Values cell_weight, pixel_weight;
    const auto shares = [&](const Seen& seen, int level, typename Chunk<T>::Values& weight) {
        const auto& [of, footprints] = seen;
        bool any = false;
        std::fill(weight.begin(), weight.begin() + padded, T(0));
        for (std::size_t i = 0; i < count; ++i) {
            if (footprints.of[i].is_ellipse) continue;
            const LevelBlend<T>& blend = footprints.of[i].blend;
            if (of[blend.lower] == level) weight[i] += T(1) - blend.t;
            if (blend.t > T(0) && of[blend.lower + 1] == level) weight[i] += blend.t;
            any = any || weight[i] > T(0);
        }
        return any;
    };
    const FieldSet of_cells = fields & cell_fields(), of_pixels = fields & ~cell_fields();
    for (std::size_t l = 0; l < levels_.size(); ++l) {
        const int level = levels_[l].level;
        FieldSet here;
        if (of_cells.any() && shares(cells, level, cell_weight)) here |= of_cells;
        if (of_pixels.any() && shares(pixels, level, pixel_weight)) here |= of_pixels;
        add_grids(call, l, {here, cell_weight.data(), pixel_weight.data()}, work, chunk);
    }
}

template <class T>
UnresolvedMoments<double> PreparedQuery<T>::beside_round(const Footprint<T>& pixel) const {
    if (!pixel.is_ellipse) return {};
    return ellipses_->unresolved(static_cast<double>(pixel.blend.lower) + static_cast<double>(pixel.blend.t),
                                 static_cast<double>(pixel.length_m / pixel.width_m),
                                 static_cast<double>(std::atan2(pixel.axis.y, pixel.axis.x)));
}

// Points whose footprints are ellipses: each of a cascade's grids is read at their taps (core/plan/taps.inl), which
// are gathered to chunks of their own.
template <class T>
void PreparedQuery<T>::add_ellipses(const Call& call, FieldSet fields, const Seen& seen, const Work& work,
                                    Chunk<T>& chunk) const {
    if (fields.none()) return;
    const auto& [levels, footprints] = seen;
    std::size_t lowest = levels.size(), highest = 0;
    for (std::size_t i = 0; i < chunk.count; ++i) {
        if (!footprints.of[i].is_ellipse) continue;
        lowest = std::min(lowest, footprints.of[i].blend.lower);
        highest = std::max(highest, footprints.of[i].blend.lower);
    }
    highest = std::min(highest + 1, levels.size() - 1);
    const auto level_of = [&](std::size_t level) {
        std::size_t l = 0;
        while (levels_[l].level != levels[level]) ++l;
        return l;
    };
    const Plan& plan = frame_->sea().plan();
    TapChunk<T> taps;
    typename Chunk<T>::Values within;
    for (std::size_t c = work.of_vessels ? sea_cascades_ : 0;
         c < (work.of_vessels ? whole_m_.size() : sea_cascades_); ++c) {
        if (work.of_vessels && !is_within(static_cast<int>(c), call.place.origin_m, chunk, within.data()))
            continue;
        const auto grid_of = [&](std::size_t level) { return plan.cascades[c].grid_of_level[levels[level]]; };
        for (std::size_t level = lowest; level <= highest; ++level) {
            // Levels that let everything through whole share a grid.
            const int grid = grid_of(level);
            if (grid < 0 || (level > lowest && grid == grid_of(level - 1))) continue;
            const std::size_t l = level_of(level);
            const auto g = static_cast<std::size_t>(levels_[l].of_cascade[c]);
            taps.begin(levels_[l].grids[g], call.place.nodes[l][g], fields,
                       has_random_tiling_ && !work.of_vessels ? &call.place.tiling[c] : nullptr, kernels_);
            for (std::size_t i = 0; i < chunk.count; ++i) {
                const Footprint<T>& footprint = footprints.of[i];
                if (!footprint.is_ellipse || (work.of_vessels && within[i] == T(0))) continue;
                const LevelBlend<T>& at = footprint.blend;
                T share = grid_of(at.lower) == grid ? T(1) - at.t : T(0);
                if (at.t > T(0) && grid_of(at.lower + 1) == grid) share += at.t;
                if (share > T(0)) taps.add(i, footprint, share, whole_m_[c], chunk);
            }
            taps.flush(chunk);
        }
    }
}

// The trains, filtered by each point's own footprints, and what they leave unresolved together with the cascades.
template <class T>
void PreparedQuery<T>::add_own_footprints(const Call& call, std::size_t first, Work& work) const {
    if (!has_trains_) return;
    auto& [chunk, breaking, unresolved_of, cells, pixels, breaking_pixels, gusts, needed, apart, masks,
           masked, of_vessels, tiling, tiling_reader, places, row] = work;
    const Points<T>& points = call.points;
    const std::size_t padded = chunk.padded();
    struct Own {
        typename Chunk<T>::Values width, x, y;
    };
    Own cell, pixel;
    const auto own = [&](const Strided<const T>& footprint_m, const Strided<const glm::vec<2, T>>& axis_m,
                         double finest_m, Own& of) -> typename TrainArgs<T>::Stretch {
        const T finest = static_cast<T>(finest_m);
        for (std::size_t i = 0; i < padded; ++i) {
            const T wanted = i < chunk.count ? footprint_m[first + i] : finest;
            of.width[i] = wanted > finest ? wanted : finest;  // the finest for one that is no number, too
        }
        if (!axis_m) return {};
        for (std::size_t i = 0; i < padded; ++i) {
            const glm::vec<2, T> axis = i < chunk.count ? axis_m[first + i] : glm::vec<2, T>(T(0));
            const T length2 = axis.x * axis.x + axis.y * axis.y,
                    beyond2 = length2 - of.width[i] * of.width[i];
            const bool is_ellipse = beyond2 > T(0) && std::isfinite(length2);
            const T by = is_ellipse ? std::sqrt(beyond2 / length2) : T(0);
            of.x[i] = is_ellipse ? by * axis.x : T(0);
            of.y[i] = is_ellipse ? by * axis.y : T(0);
        }
        return {of.x.data(), of.y.data()};
    };
    const Query& query = planned_->query;
    typename TrainArgs<T>::Stretch cell_stretch, pixel_stretch;
    if (points.cell_m) cell_stretch = own(points.cell_m, points.cell_axis_m, query.cell_m.front(), cell);
    if (points.pixel_m)
        pixel_stretch = own(points.pixel_m, points.pixel_axis_m, query.pixel_m.front(), pixel);
    const Plan& plan = frame_->sea().plan();
    const bool varied = call.wants_unresolved && call.differ_in_unresolved;
    if (varied)
        for (auto& moment : unresolved_of.moments)
            std::fill(moment.begin() + chunk.count, moment.begin() + padded, T(0));
    const TrainArgs<T> all{.trains = &frame_->sea().trains(),
                           .coast = frame_->sea().coast().get(),
                           .origin_m = call.place.origin_m,
                           .start_cycles = call.place.start_cycles.data(),
                           .filter = plan.filter,
                           .wanted = needed,
                           .cell_m = static_cast<T>(query.cell_m.front()),
                           .pixel_m = static_cast<T>(query.pixel_m.front()),
                           .cell_of = points.cell_m ? cell.width.data() : nullptr,
                           .pixel_of = points.pixel_m ? pixel.width.data() : nullptr,
                           .cell_stretch = cell_stretch,
                           .pixel_stretch = pixel_stretch,
                           .unresolved = varied ? &unresolved_of : nullptr,
                           .breaking = apart ? &breaking : nullptr};
    add_trains<T>(all, chunk);
    if (masked && masks->has_values) {
        TrainArgs<T> values = all;
        values.wanted = pelagic::fields(Field::Height, Field::Dx, Field::Dy) & ~plan.dropped;
        values.cell_m = all.pixel_m;
        values.cell_of = all.pixel_of;
        values.cell_stretch = all.pixel_stretch;
        values.unresolved = nullptr;
        values.breaking = nullptr;
        add_trains<T>(values, masks->values);
        // The waves that break are long against a pixel that tells them from the others.
        if (apart) add_trains<T>(values, masks->breaking_values);
    }
    if (!varied || plan.cascades.empty()) return;
    for (std::size_t i = 0; i < chunk.count; ++i) {
        UnresolvedMoments<double> whole;
        for (std::size_t m = 0; m < whole.size(); ++m)
            whole[m] = static_cast<double>(unresolved_of.moments[m][i]);
        const UnresolvedMoments<T> left =
            call.has_levels
                ? unresolved_at<T>(*statistics_, pixels.of[i].blend, whole, beside_round(pixels.of[i]))
                : unresolved_at<T>(*statistics_, {}, whole);
        for (std::size_t m = 0; m < left.size(); ++m) unresolved_of.moments[m][i] = left[m];
    }
}

template class PreparedQuery<float>;
template class PreparedQuery<double>;

}  // namespace pelagic
