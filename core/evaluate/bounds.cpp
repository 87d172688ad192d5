#include "core/evaluate/bounds.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>
#include <queue>
#include <stdexcept>

#include "core/base/constants.h"
#include "core/evaluate/prepared_query.h"
#include "core/plan/grid_layout.h"
#include "core/surface/footprint_levels.h"

namespace pelagic {
namespace {

using Interval = DisplacementBounds::Interval;

constexpr std::array<Field, 3> kFields{Field::Height, Field::Dx, Field::Dy};
// Cells along the side of a pyramid's finest block.
constexpr int kBlockCells = 2;
// The rounding error of evaluate(), relative to the largest number that it adds up: some forty products and sums.
template <class T>
constexpr double kRounding = 64.0 * static_cast<double>(std::numeric_limits<T>::epsilon());

std::array<Interval DisplacementBounds::*, 3> axes() {
    return {&DisplacementBounds::z, &DisplacementBounds::dx, &DisplacementBounds::dy};
}

void widen(Interval& interval, double by) {
    interval.lo -= by;
    interval.hi += by;
}
void include(Interval& interval, const Interval& other) {
    interval.lo = std::min(interval.lo, other.lo);
    interval.hi = std::max(interval.hi, other.hi);
}
void include(DisplacementBounds& bounds, const DisplacementBounds& other) {
    for (const auto axis : axes()) include(bounds.*axis, other.*axis);
}

// How far bounds lie beyond what is surely reached, relative to that.
double excess(const DisplacementBounds& bounds, const DisplacementBounds& reached) {
    double most = 0.0;
    for (const auto axis : axes()) {
        const Interval &is = bounds.*axis, &sure = reached.*axis;
        const double beyond = std::max(is.hi - sure.hi, sure.lo - is.lo);
        if (beyond > 0.0) most = std::max(most, beyond / std::max(sure.hi - sure.lo, 1e-3 * beyond));
    }
    return most;
}

// cos of a phase [cycles] that lies within `by` of `cycles`.
Interval cosine(double cycles, double by) {
    if (by >= 0.5) return {-1.0, 1.0};
    const double phase = std::abs(cycles - std::round(cycles));
    const double a = std::cos(kTwoPi * (phase - by)), b = std::cos(kTwoPi * (phase + by));
    return {0.5 - phase <= by ? -1.0 : std::min(a, b), phase <= by ? 1.0 : std::max(a, b)};
}

// Whether a grid's spline is bounded by its coefficients at half the spacing: four times tighter for four times the
// work, which only small grids are worth.
bool is_refined(const Grid& grid) {
    constexpr int kLargestResolution = 512;
    return grid.sampling == Sampling::Spline && grid.resolution <= kLargestResolution;
}

// A periodic row with what is read before its first and behind its last value.
template <class T>
void lay_out(const T* row, int n, int before, std::vector<T>& out) {
    for (std::size_t i = 0; i < out.size(); ++i) {
        const int at = static_cast<int>(i) - before;
        out[i] = row[at < 0 ? at + n : at % n];
    }
}

// The same periodic spline's coefficients at half the spacing, 2n × 2n: knots inserted (Lane and Riesenfeld
// 1980), whose mask is the binomial coefficients of P over 2^(P−1) along each axis.
template <class T>
std::vector<T> refined_spline(const T* samples, int n, int taps) {
    // Masks over the coefficients from one before the place to two behind it: for new coefficients on a node, and
    // halfway to the next.
    constexpr T kOnQuintic[] = {T(6) / 32, T(20) / 32, T(6) / 32, 0},
                kHalfQuintic[] = {T(1) / 32, T(15) / 32, T(15) / 32, T(1) / 32},
                kOnCubic[] = {T(1) / 8, T(6) / 8, T(1) / 8, 0}, kHalfCubic[] = {0, T(1) / 2, T(1) / 2, 0};
    const T* on = taps == 6 ? kOnQuintic : kOnCubic;
    const T* half = taps == 6 ? kHalfQuintic : kHalfCubic;
    const auto side = static_cast<std::size_t>(2 * n), stride = line_stride<T>(n);
    std::vector<T> wide(side * n), refined(side * side), row(n + 4);
    for (int y = 0; y < n; ++y) {
        lay_out(samples + y * stride, n, 1, row);
        const T* c = row.data();
        T* to = wide.data() + y * side;
        for (int i = 0; i < n; ++i) {
            to[2 * i] = on[0] * c[i] + on[1] * c[i + 1] + on[2] * c[i + 2];
            to[2 * i + 1] = half[0] * c[i] + half[1] * c[i + 1] + half[2] * c[i + 2] + half[3] * c[i + 3];
        }
    }
    for (int i = 0; i < n; ++i) {
        const T* c[4];
        for (int j = 0; j < 4; ++j) c[j] = wide.data() + side * ((i + j - 1 + n) % n);
        T *first = refined.data() + side * (2 * i), *second = first + side;
        for (std::size_t x = 0; x < side; ++x) {
            first[x] = on[0] * c[0][x] + on[1] * c[1][x] + on[2] * c[2][x];
            second[x] = half[0] * c[0][x] + half[1] * c[1][x] + half[2] * c[2][x] + half[3] * c[3][x];
        }
    }
    return refined;
}

// Each value becomes the extreme of the `window` values from it on; those at the end have fewer.
template <class T, class Extreme>
void extremes_ahead(std::vector<T>& values, std::vector<T>& scratch, int window, const Extreme& extreme) {
    const int count = static_cast<int>(values.size());
    scratch.resize(values.size());
    for (int covered = 1; covered < window;) {
        const int step = std::min(covered, window - covered);
        const T* from = values.data();
        T* to = scratch.data();
        for (int i = 0; i + step < count; ++i) to[i] = extreme(from[i], from[i + step]);
        std::copy(values.end() - step, values.end(), scratch.end() - step);
        values.swap(scratch);
        covered += step;
    }
}

Interval times(const Interval& weight, const Interval& value) {  // weight ≥ 0
    return {value.lo * (value.lo < 0.0 ? weight.hi : weight.lo),
            value.hi * (value.hi > 0.0 ? weight.hi : weight.lo)};
}

// The shifted tiles that a block reads; more than two along an axis are bounded together.
struct BlendedTile {
    Interval weight;
    glm::dvec2 offset;  // in tiles
};
struct BlendedTiles {
    int count = 0;
    std::array<BlendedTile, 4> of{};
    double most = 2.0;  // of the sum of their weights: √2 along each axis
};

// Along an axis, a tile's blending weight at this distance from its cell's middle.
double blend_weight(double distance) {
    if (distance <= 0.5) return blend_weights(distance).own;
    return distance < 0.5 + 0.5 * kBlendRamp ? blend_weights(1.0 - distance).next : 0.0;
}

// For a block between these corners, in cells.
BlendedTiles tiles_of(uint key, glm::dvec2 from, glm::dvec2 to) {
    constexpr double kHalf = 0.5 + 0.5 * kBlendRamp;
    glm::dvec2 first, last;
    for (int axis = 0; axis < 2; ++axis) {
        const double slack = 1e-6 + 1e-14 * std::max(std::abs(from[axis]), std::abs(to[axis]));
        from[axis] -= slack;
        to[axis] += slack;
        first[axis] = std::ceil(from[axis] - kHalf);
        last[axis] = std::floor(to[axis] + kHalf);
        if (!(last[axis] - first[axis] <= 1.0) || !(std::abs(first[axis]) < 0x1p62)) return {};
    }
    const auto weight = [&](int axis, double cell) -> Interval {
        const double low = cell - from[axis], high = to[axis] - cell;  // to either end
        const double near = std::max({-low, -high, 0.0}), far = std::max(low, high);
        return {blend_weight(far), blend_weight(near)};
    };
    BlendedTiles tiling;
    for (double j = first.y; j <= last.y; ++j)
        for (double i = first.x; i <= last.x; ++i) {
            const Interval x = weight(0, i), y = weight(1, j);
            const TileOffset<double> offset =
                tile_offset<double>(key, static_cast<uint>(static_cast<std::int64_t>(i)),
                                    static_cast<uint>(static_cast<std::int64_t>(j)));
            tiling.of[static_cast<std::size_t>(tiling.count++)] = {{x.lo * y.lo, x.hi * y.hi},
                                                                   {offset.x, offset.y}};
        }
    return tiling;
}

// Blocks first … last of an axis of a period: one piece, or two where they lie across its seam.
struct Pieces {
    int count = 0;
    std::array<std::array<int, 2>, 2> of{};
};
Pieces pieces_of(double from_cells, double to_cells, int n) {
    // The query reduces a place to its tile in another order; rounding may make the two differ by this much.
    const double slack = 1e-6 + 1e-14 * std::max(std::abs(from_cells), std::abs(to_cells));
    const double first = std::floor(from_cells - slack), last = std::floor(to_cells + slack);
    if (!(last - first + 1.0 < n)) return {1, {{{0, (n - 1) / kBlockCells}}}};
    const double tile = std::floor(first / n) * n;
    const int begin = static_cast<int>(first - tile), end = static_cast<int>(last - tile);
    if (end < n) return {1, {{{begin / kBlockCells, end / kBlockCells}}}};
    return {2, {{{begin / kBlockCells, (n - 1) / kBlockCells}, {0, (end - n) / kBlockCells}}}};
}

}  // namespace

glm::dvec2 DisplacementBounds::reach_m() const {
    return {std::max(std::abs(dx.lo), std::abs(dx.hi)), std::max(std::abs(dy.lo), std::abs(dy.hi))};
}

template <class T>
FrameBounds<T>::FrameBounds(const Frame<T>& frame, int query_index, FootprintRange cells)
    : frame_(&frame),
      planned_(&frame.sea().plan().queries.at(query_index)),
      query_(query_index),
      sampled_(planned_->query.products[index(Product::Displacement)] ? Product::Displacement
                                                                      : Product::Position),
      cells_(cells) {
    const Plan& plan = frame.sea().plan();
    const Query& query = planned_->query;
    if (!(query.products[index(Product::Position)] || query.products[index(Product::Displacement)]))
        throw std::invalid_argument("query \"" + query.name + "\" holds no positions to bound");
    if (!(cells.finest_m >= 0.0) || !(cells.coarsest_m >= cells.finest_m))
        throw std::invalid_argument("footprints to bound must rise from 0 or more");
    // From the level at or below the finest footprint to the one at or above the coarsest. Footprints beyond the
    // query's levels count as its first or last.
    const std::vector<double>& levels_m = query.cell_m;
    const auto above = std::upper_bound(levels_m.begin() + 1, levels_m.end(), cells.finest_m);
    const auto first = above - levels_m.begin() - 1;
    const auto last = std::min<std::ptrdiff_t>(
        std::lower_bound(levels_m.begin() + first, levels_m.end(), cells.coarsest_m) - levels_m.begin(),
        std::ssize(levels_m) - 1);
    levels_.assign(planned_->cell_levels.begin() + first, planned_->cell_levels.begin() + last + 1);
    // A slick's points lie between their own level and what a slick leaves.
    if (cells.finest_m < kSlick_m)
        levels_.insert(levels_.end(), planned_->calm_cells.begin(), planned_->calm_cells.end());
    for (double* of : {&cells_.finest_m, &cells_.coarsest_m}) *of = std::max(*of, levels_m.front());
    if (plan.trains && !query.only_cascade) {
        const Trains<T>& trains = frame.sea().trains();
        for (std::size_t i = 0; i < trains.count(); ++i) {
            if (const Coast<T>* coast =
                    frame.sea().coast().get()) {  // its weights are those of its local length
                if (!(static_cast<double>(coast->longest_m[i]) > plan.filter.n_min * cells_.finest_m)) break;
                finest_weight_.push_back(1.0);
                coarsest_weight_.push_back(1.0);
                continue;
            }
            const double k = kTwoPi / trains.wavelength_m[i];
            finest_weight_.push_back(plan.filter.weight(k, cells_.finest_m));
            if (finest_weight_.back() == 0.0) {  // the longest come first
                finest_weight_.pop_back();
                break;
            }
            coarsest_weight_.push_back(plan.filter.weight(k, cells_.coarsest_m));
        }
    }
    refresh();
}

template <class T>
void FrameBounds<T>::refresh() {
    if (!frame_->is_set()) throw std::invalid_argument("the frame has no time yet: call set() first");
    const Plan& plan = frame_->sea().plan();
    planned_ = &plan.queries.at(query_);
    if (const Trains<T>& trains = frame_->sea().trains(); !finest_weight_.empty())
        for (std::size_t f = 0; f < kFields.size(); ++f) {
            const std::vector<T>& amplitude = trains.amplitude[index(kFields[f])];
            train_amplitudes_[f].assign(amplitude.begin(), amplitude.begin() + std::ssize(finest_weight_));
            if (plan.dropped[index(kFields[f])]) train_amplitudes_[f].assign(finest_weight_.size(), 0.0);
        }
    struct Place {
        int cascade, grid;
        bool operator==(const Place&) const = default;
    };
    std::vector<Place> places;
    grid_of_level_.assign(levels_.size(), {});
    grids_.clear();
    smallest_block_m_ = 0.0;
    for (int c = 0; c < static_cast<int>(plan.cascades.size()); ++c)
        for (std::size_t l = 0; l < levels_.size(); ++l) {
            const int g = plan.cascades[c].grid_of_level[levels_[l]];
            if (g < 0) continue;
            const auto found = std::find(places.begin(), places.end(), Place{c, g});
            grid_of_level_[l].push_back(static_cast<int>(found - places.begin()));
            if (found != places.end()) continue;
            places.push_back({c, g});
            GridBounds& grid = grids_.emplace_back();
            grid.size_m = plan.cascades[c].size_m;
            if (plan.cascades[c].vessel) grid.middle_m = frame_->tile_middle_m(c);
            if (plan.cascades[c].has_random_tiling && !planned_->query.only_cascade)
                grid.tiling_key = tiling_key(plan.from->scene.shot.seed, c);
            const Grid& planned = plan.cascades[c].grids[g];
            grid.n = planned.resolution * (is_refined(planned) ? 2 : 1);
            const double block_m = 0.5 * kBlockCells * grid.size_m / grid.n;
            smallest_block_m_ = places.size() == 1 ? block_m : std::min(smallest_block_m_, block_m);
        }
    tbb::parallel_for(std::size_t(0), places.size() * kFields.size(), [&](std::size_t i) {
        const Place& place = places[i / kFields.size()];
        const std::size_t field = i % kFields.size();
        grids_[i / kFields.size()].fields[field] = pyramid_of(place.cascade, place.grid, kFields[field]);
    });
    times_set_ = frame_->times_set();
}

// A point between nodes i and i + 1 reads the taps round them or, where grids are read at nodes, one of the two.
template <class T>
typename FrameBounds<T>::Pyramid FrameBounds<T>::pyramid_of(int cascade, int grid, Field field) const {
    const T* samples = frame_->samples(cascade, grid, field);
    Pyramid pyramid;
    if (!samples) return pyramid;
    const Plan& plan = frame_->sea().plan();
    const Grid& planned = plan.cascades[cascade].grids[grid];
    const int taps = planned.sampling == Sampling::Nodes ? 2 : plan.knobs.spline_taps;
    const int window = kBlockCells + taps - 1, before = taps / 2 - 1;
    std::vector<T> refined;
    int n = planned.resolution;
    std::size_t stride = line_stride<T>(n);
    if (is_refined(planned)) {
        refined = refined_spline(samples, n, taps);
        samples = refined.data();
        stride = n *= 2;
    }
    // Across the rows first, a row of blocks at a time, then along each.
    Level level;
    level.side = (n + kBlockCells - 1) / kBlockCells;
    const auto side = static_cast<std::size_t>(level.side);
    level.low.resize(side * side);
    level.high.resize(side * side);
    std::vector<T> low(n), high(n), row(n + window + kBlockCells), scratch;
    const auto lower = [](T a, T b) { return std::min(a, b); };
    const auto higher = [](T a, T b) { return std::max(a, b); };
    for (std::size_t block = 0; block < side; ++block) {
        for (int i = 0; i < window; ++i) {
            const int y = static_cast<int>(block) * kBlockCells - before + i;
            const T* from = samples + static_cast<std::size_t>((y % n + n) % n) * stride;
            for (int x = 0; x < n; ++x) {
                low[x] = i == 0 ? from[x] : std::min(low[x], from[x]);
                high[x] = i == 0 ? from[x] : std::max(high[x], from[x]);
            }
        }
        const auto along = [&](const std::vector<T>& values, const auto& extreme, T* to) {
            lay_out(values.data(), n, before, row);
            extremes_ahead(row, scratch, window, extreme);
            for (std::size_t x = 0; x < side; ++x) to[x] = row[x * kBlockCells];
        };
        along(low, lower, &level.low[block * side]);
        along(high, higher, &level.high[block * side]);
    }
    pyramid.levels.push_back(std::move(level));
    while (pyramid.levels.back().side > 1) {
        const Level& fine = pyramid.levels.back();
        Level coarse;
        coarse.side = (fine.side + 1) / 2;
        const std::size_t count = static_cast<std::size_t>(coarse.side) * coarse.side;
        coarse.low.assign(count, std::numeric_limits<T>::infinity());
        coarse.high.assign(count, -std::numeric_limits<T>::infinity());
        for (int y = 0; y < fine.side; ++y)
            for (int x = 0; x < fine.side; ++x) {
                const std::size_t from = static_cast<std::size_t>(y) * fine.side + x,
                                  to = static_cast<std::size_t>(y / 2) * coarse.side + x / 2;
                coarse.low[to] = std::min(coarse.low[to], fine.low[from]);
                coarse.high[to] = std::max(coarse.high[to], fine.high[from]);
            }
        pyramid.levels.push_back(std::move(coarse));
    }
    return pyramid;
}

template <class T>
DisplacementBounds::Interval FrameBounds<T>::interval_of(const GridBounds& grid, const Pyramid& field,
                                                         glm::dvec2 from_m, glm::dvec2 to_m) {
    constexpr int kMostBlocks = 4;  // along an axis: coarser blocks serve longer pieces
    const double per_m = grid.n / grid.size_m;
    const Pieces x = pieces_of(from_m.x * per_m, to_m.x * per_m, grid.n),
                 y = pieces_of(from_m.y * per_m, to_m.y * per_m, grid.n);
    Interval found;
    for (int py = 0; py < y.count; ++py)
        for (int px = 0; px < x.count; ++px) {
            const auto [x0, x1] = x.of[px];
            const auto [y0, y1] = y.of[py];
            int l = 0;
            while (std::max((x1 >> l) - (x0 >> l), (y1 >> l) - (y0 >> l)) >= kMostBlocks) ++l;
            const Level& level = field.levels[l];
            for (int j = y0 >> l; j <= y1 >> l; ++j)
                for (int i = x0 >> l; i <= x1 >> l; ++i) {
                    const std::size_t at = static_cast<std::size_t>(j) * level.side + i;
                    include(found, {static_cast<double>(level.low[at]), static_cast<double>(level.high[at])});
                }
        }
    return found;
}

// `cycles`: the trains' phases at origin_m, where the block's coordinates begin.
template <class T>
DisplacementBounds FrameBounds<T>::bounds_of(const Block& block, const std::vector<double>& cycles,
                                             glm::dvec2 origin_m) const {
    constexpr DisplacementBounds kNone{{0.0, 0.0}, {0.0, 0.0}, {0.0, 0.0}};
    DisplacementBounds bounds, of_vessels = kNone;
    for (const std::vector<int>& of_level : grid_of_level_) {
        DisplacementBounds sum = kNone, vessels_sum = kNone;
        for (const int g : of_level) {
            const GridBounds& grid = grids_[g];
            glm::dvec2 from_m = origin_m + block.min_m, to_m = origin_m + block.max_m;
            bool is_within = true;
            if (grid.middle_m) {
                const glm::dvec2 half(0.5 * grid.size_m), low = *grid.middle_m - half,
                                                          high = *grid.middle_m + half;
                is_within =
                    glm::all(glm::greaterThanEqual(from_m, low)) && glm::all(glm::lessThanEqual(to_m, high));
                if (glm::any(glm::greaterThan(from_m, high)) || glm::any(glm::lessThan(to_m, low))) continue;
                from_m = glm::max(from_m, low);
                to_m = glm::min(to_m, high);
            }
            const auto tiling = grid.tiling_key
                                    ? tiles_of(*grid.tiling_key, from_m / grid.size_m, to_m / grid.size_m)
                                    : BlendedTiles{1, {{{{1.0, 1.0}, glm::dvec2(0.0)}}}};
            for (std::size_t f = 0; f < kFields.size(); ++f) {
                const Pyramid& pyramid = grid.fields[f];
                if (pyramid.levels.empty()) continue;
                const Level& all = pyramid.levels.back();
                const Interval whole{static_cast<double>(all.low[0]), static_cast<double>(all.high[0])};
                Interval found{0.0, 0.0};
                if (tiling.count == 0)  // too many: their weights add up to this at most
                    found = times({0.0, tiling.most}, whole);
                for (int i = 0; i < tiling.count; ++i) {
                    const BlendedTile& copy = tiling.of[static_cast<std::size_t>(i)];
                    const glm::dvec2 by_m = copy.offset * grid.size_m;
                    const Interval shown =
                        times(copy.weight, interval_of(grid, pyramid, from_m + by_m, to_m + by_m));
                    found.lo += shown.lo;
                    found.hi += shown.hi;
                }
                const double rounding = grid.tiling_key ? 4.0 * kRounding<T> : kRounding<T>;
                widen(found, rounding * std::max(-whole.lo, whole.hi));
                if (!is_within) include(found, {0.0, 0.0});
                DisplacementBounds& to = grid.middle_m ? vessels_sum : sum;
                Interval& axis = to.*axes()[f];
                axis.lo += found.lo;
                axis.hi += found.hi;
            }
        }
        include(bounds, sum);
        include(of_vessels, vessels_sum);
    }
    const Trains<T>& trains = frame_->sea().trains();
    const glm::dvec2 middle = 0.5 * (block.min_m + block.max_m), half = 0.5 * (block.max_m - block.min_m);
    // Waves that are long against the block are bounded together, by the sums of their values and slopes at its
    // middle; the rest is of second order, |a| δ²/2 where the phase turns by δ. The others are bounded one by one.
    constexpr double kSmooth = 1.0;
    const Coast<T>* coast = frame_->sea().coast().get();
    if (coast) add_coast(*coast, block, cycles, origin_m, bounds);
    std::array<glm::dvec2, 3> slopes{glm::dvec2(0.0), glm::dvec2(0.0), glm::dvec2(0.0)};
    for (std::size_t i = 0; i < finest_weight_.size() && !coast; ++i) {
        const double kx = trains.kx_cycles_per_m[i], ky = trains.ky_cycles_per_m[i];
        const double phase = cycles[i] - kx * middle.x - ky * middle.y;
        const double by = std::abs(kx) * half.x + std::abs(ky) * half.y + 1e-9, radians = kTwoPi * by;
        const double weight = 0.5 * (finest_weight_[i] + coarsest_weight_[i]);
        const double weight_by = 0.5 * (finest_weight_[i] - coarsest_weight_[i]) + kRounding<T>;
        const bool is_smooth = radians < kSmooth;
        const double cosine_at = std::cos(kTwoPi * phase), sine_at = std::sin(kTwoPi * phase);
        const Interval cosine_of = is_smooth ? Interval() : cosine(phase, by),
                       sine_of = is_smooth ? Interval() : cosine(phase - 0.25, by);
        for (std::size_t f = 0; f < kFields.size(); ++f) {
            const double amplitude = train_amplitudes_[f][i];
            if (amplitude == 0.0) continue;
            Interval& axis = bounds.*axes()[f];
            widen(axis, std::abs(amplitude) * weight_by);
            const double shown = weight * amplitude;
            if (is_smooth) {
                const double value = shown * (f == 0 ? cosine_at : sine_at);
                axis.lo += value;
                axis.hi += value;
                // Along κ the phase falls.
                const double slope = shown * (f == 0 ? sine_at : -cosine_at) * kTwoPi;
                slopes[f] += slope * glm::dvec2(kx, ky);
                widen(axis, 0.5 * std::abs(shown) * radians * radians);
            } else {
                const Interval& wave = f == 0 ? cosine_of : sine_of;
                axis.lo += std::min(shown * wave.lo, shown * wave.hi);
                axis.hi += std::max(shown * wave.lo, shown * wave.hi);
            }
        }
    }
    for (std::size_t f = 0; f < kFields.size(); ++f)
        widen(bounds.*axes()[f], std::abs(slopes[f].x) * half.x + std::abs(slopes[f].y) * half.y);
    if (const auto& masks = frame_->sea().plan().masks; masks && !planned_->query.only_cascade) {
        const MasksPlan::Gains gains = masks->gains_in(origin_m + block.min_m, origin_m + block.max_m);
        const double rounding = 1.0 + kRounding<T> * static_cast<double>(masks->masks.size());
        for (const auto axis : axes())
            bounds.*axis = times({gains.least / rounding, gains.largest * rounding}, bounds.*axis);
    }
    for (const auto axis : axes()) {
        (bounds.*axis).lo += (of_vessels.*axis).lo;
        (bounds.*axis).hi += (of_vessels.*axis).hi;
    }
    return bounds;
}

// Each train between what its local phase, way and height can be there.
template <class T>
void FrameBounds<T>::add_coast(const Coast<T>& coast, const Block& block, const std::vector<double>& cycles,
                               glm::dvec2 origin_m, DisplacementBounds& bounds) const {
    const Plan& plan = frame_->sea().plan();
    const Trains<T>& trains = frame_->sea().trains();
    const glm::dvec2 middle = 0.5 * (block.min_m + block.max_m), half = 0.5 * (block.max_m - block.min_m);
    const auto product = [](const Interval& a, const Interval& b) {
        const auto [lo, hi] = std::minmax({a.lo * b.lo, a.lo * b.hi, a.hi * b.lo, a.hi * b.hi});
        return Interval{lo, hi};
    };
    for (std::size_t i = 0; i < finest_weight_.size(); ++i) {
        const CoastRange range = coast_range(coast, i, origin_m + block.min_m, origin_m + block.max_m);
        const double height_m = trains.height_m[i], sideways_m = static_cast<double>(coast.sideways_m[i]);
        const double kx = trains.kx_cycles_per_m[i], ky = trains.ky_cycles_per_m[i];
        const double floor_phase = 0.5 * (range.phase_lo + range.phase_hi);
        const double phase = cycles[i] - kx * middle.x - ky * middle.y - floor_phase;
        const double by =
            range.is_anything
                ? 1.0
                : std::abs(kx) * half.x + std::abs(ky) * half.y + 0.5 * (range.phase_hi - range.phase_lo) +
                      1e-9 +
                      kRounding<T> * (1.0 + std::max(std::abs(range.phase_lo), std::abs(range.phase_hi)));
        Interval weight{0.0, 1.0};
        if (!range.is_anything) {
            // The least |∇S| is 0 where a component may vanish.
            glm::dvec2 least(0.0);
            for (int axis = 0; axis < 2; ++axis)
                if (range.k_lo[axis] * range.k_hi[axis] > 0.0)
                    least[axis] = std::min(std::abs(range.k_lo[axis]), std::abs(range.k_hi[axis]));
            const double k_least = std::hypot(least.x, least.y);
            weight = {plan.filter.weight(range.most_wavenumber(), cells_.coarsest_m),
                      k_least > 0.0 ? plan.filter.weight(k_least, cells_.finest_m) : 1.0};
            widen(weight, kRounding<T>);
        }
        const Interval gain =
            product({std::max(range.is_anything ? 0.0 : range.gain_lo, 0.0), range.gain_hi}, weight);
        const double slack = kRounding<T> * range.gain_hi * height_m;
        if (!plan.dropped[index(Field::Height)]) {
            Interval height = product(product(gain, {height_m, height_m}), cosine(phase, by));
            widen(height, slack);
            bounds.z.lo += height.lo;
            bounds.z.hi += height.hi;
        }
        // k̂ H is ∇S times h, and no further than 1/k.
        const Interval wave = cosine(phase - 0.25, by);
        const double most_m = sideways_m * height_m * range.most_sideways;
        for (int axis = 0; axis < 2; ++axis) {
            if (plan.dropped[index(axis == 0 ? Field::Dx : Field::Dy)]) continue;
            Interval way{-most_m, most_m};
            if (!range.is_anything) {
                const double to_side = sideways_m * height_m;
                Interval local = product(gain, {to_side * range.k_lo[axis], to_side * range.k_hi[axis]});
                if (to_side * range.gain_hi * range.most_wavenumber() * range.most_wavenumber() > 1.0)
                    include(local, {0.0, 0.0});
                way = {std::max(way.lo, local.lo), std::min(way.hi, local.hi)};
            }
            Interval moved = product(way, wave);
            widen(moved, kRounding<T> * most_m + slack);
            Interval& to = axis == 0 ? bounds.dx : bounds.dy;
            to.lo += moved.lo;
            to.hi += moved.hi;
        }
    }
}

// Splits the blocks whose bounds lie farthest beyond what the region surely reaches, until none lies far beyond. The
// displacements at the blocks' middles are surely reached.
template <class T>
DisplacementBounds FrameBounds<T>::region(const RestRegion& region, int most_blocks) const {
    constexpr double kTolerance = 0.05;  // of what is surely reached
    constexpr std::size_t kAtOnce = 32;
    check_current();
    for (int axis = 0; axis < 2; ++axis)
        if (!(region.min_m[axis] <= region.max_m[axis]) || !std::isfinite(region.min_m[axis]) ||
            !std::isfinite(region.max_m[axis]))
            throw std::invalid_argument("a region reaches from its least to its greatest corner, finite");
    if (most_blocks < 1) throw std::invalid_argument("a region is at least one block");
    const glm::dvec2 origin_m = 0.5 * (region.min_m + region.max_m);
    const std::vector<double> cycles =
        finest_weight_.empty() ? std::vector<double>()
                               : phases_at(frame_->sea().trains(), origin_m, frame_->time_within_loop_s());
    const Block whole{region.min_m - origin_m, region.max_m - origin_m};
    if (most_blocks == 1) return bounds_of(whole, cycles, origin_m);

    struct Part {
        Block block;
        DisplacementBounds bounds;
        double excess;
        bool operator<(const Part& other) const { return excess < other.excess; }
    };
    DisplacementBounds settled, reached;
    std::priority_queue<Part> parts;
    const PreparedQuery<T> query(*frame_, query_, products(sampled_), origin_m);
    std::vector<Block> blocks{whole};
    std::vector<glm::vec<2, T>> middles;
    std::vector<glm::vec<3, T>> moved;
    const std::vector<T> cells_m(2 * kAtOnce, static_cast<T>(cells_.finest_m));
    const auto add = [&] {
        middles.clear();
        for (const Block& block : blocks) middles.emplace_back(0.5 * (block.min_m + block.max_m));
        moved.resize(middles.size());
        Results<T> results;
        results.set(VectorProduct::checked(sampled_), {moved.data()});
        query.evaluate({.origin_m = origin_m,
                        .count = middles.size(),
                        .rest_m = {middles.data()},
                        .cell_m = {cells_m.data()}},
                       results);
        for (std::size_t i = 0; i < blocks.size(); ++i) {
            glm::dvec3 at(moved[i]);
            if (sampled_ == Product::Position) at -= glm::dvec3(glm::dvec2(middles[i]), 0.0);
            for (const auto& [axis, value] :
                 {std::pair(&DisplacementBounds::dx, at.x), std::pair(&DisplacementBounds::dy, at.y),
                  std::pair(&DisplacementBounds::z, at.z)})
                include(reached.*axis, {value, value});
        }
        for (const Block& block : blocks) {
            const DisplacementBounds bounds = bounds_of(block, cycles, origin_m);
            parts.push({block, bounds, excess(bounds, reached)});
        }
        blocks.clear();
    };
    add();
    for (int count = 1; !parts.empty();) {
        while (!parts.empty() && blocks.size() < 2 * kAtOnce) {
            const Part part = parts.top();
            parts.pop();
            const glm::dvec2 side = part.block.max_m - part.block.min_m;
            const int longer = side.y > side.x ? 1 : 0;
            if (count >= most_blocks || side[longer] <= smallest_block_m_ ||
                excess(part.bounds, reached) <= kTolerance) {
                include(settled, part.bounds);
                continue;
            }
            Block low = part.block, high = part.block;
            low.max_m[longer] = high.min_m[longer] =
                0.5 * (part.block.min_m[longer] + part.block.max_m[longer]);
            blocks.push_back(low);
            blocks.push_back(high);
            ++count;
        }
        if (!blocks.empty()) add();
    }
    return settled;
}

template <class T>
DisplacementBounds FrameBounds<T>::everywhere() const {
    check_current();
    constexpr double kAll_m = 1e300;  // longer than every tile and every wave
    return bounds_of({glm::dvec2(-kAll_m), glm::dvec2(kAll_m)}, std::vector<double>(finest_weight_.size()),
                     glm::dvec2(0.0));
}

template <class T>
const FrameBounds<T>& BoundsByLevel<T>::from_level(double level_m) const {
    const std::lock_guard lock(lock_);
    std::unique_ptr<FrameBounds<T>>& bounds = bounds_[level_m];
    if (bounds && bounds->is_current()) return *bounds;
    // By this thread alone, which must not take up other work meanwhile: that might wait for the lock.
    tbb::task_arena(1).execute([&] {
        if (!bounds)
            bounds = std::make_unique<FrameBounds<T>>(
                *frame_, static_cast<int>(query_),
                FootprintRange{.finest_m = level_m, .coarsest_m = 2.0 * level_m});
        else
            bounds->refresh();
    });
    return *bounds;
}

template <class T>
const FrameBounds<T>& BoundsByLevel<T>::of_cell(double cell_m) const {
    const double from_m = std::max(cell_m, finest_cell_m());
    return from_level(from_m > 0.0 ? level_below_m(from_m) : 0.0);
}

template class BoundsByLevel<float>;
template class BoundsByLevel<double>;
template class FrameBounds<float>;
template class FrameBounds<double>;

}  // namespace pelagic
