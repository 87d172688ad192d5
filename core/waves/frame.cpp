#include "core/waves/frame.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <glm/common.hpp>
#include <glm/vec3.hpp>
#include <initializer_list>
#include <map>
#include <memory>
#include <span>
#include <stdexcept>
#include <utility>

#include "core/base/constants.h"
#include "core/plan/mode_lattice.h"
#include "core/waves/loop.h"
#include "core/waves/spline.h"

namespace pelagic {
namespace {

// Columns that one task transforms before it writes them into the rows: one cache line of each row in single
// precision.
constexpr int kBlockColumns = 16;
constexpr int kBlockRows = 32;

// One FFTW plan per size.
template <class T>
class Transforms {
  public:
    using Parts = typename LineTransform<T>::Parts;
    LineTransform<T> of(int n, Parts parts = Parts::Apart) {
        return known_.try_emplace({n, parts}, n, parts).first->second;
    }

  private:
    std::map<std::pair<int, Parts>, LineTransform<T>> known_;
};

// Null where this sea doesn't need the buffer.
template <class T>
T* from(Buffer<T>& buffer, std::size_t at) {
    return buffer.empty() ? nullptr : buffer.data() + at;
}
template <class T>
const T* from(const Buffer<T>& buffer, std::size_t at) {
    return buffer.empty() ? nullptr : buffer.data() + at;
}

// Of a field's samples with the slack behind them that loops may write.
template <class T>
constexpr std::size_t plane_room(int n) {
    constexpr std::size_t kLine = 64 / sizeof(T);
    return (grid_samples<T>(n) + Buffer<T>::kSlack + kLine - 1) / kLine * kLine;
}

// Whether somebody asks for a horizontal field of a cascade.
bool is_displaced(const CascadePlan& cascade) {
    return std::any_of(cascade.grids.begin(), cascade.grids.end(),
                       [](const Grid& grid) { return (grid.fields & horizontal_fields()).any(); });
}

// The same of one whose displacement runs ahead, at some time.
bool leans(const Plan& plan, int cascade) {
    return plan.lean_rad > 0.0 && !plan.cascades[cascade].vessel && is_displaced(plan.cascades[cascade]);
}

// A wave that runs ahead by an angle is cosine times itself plus later() times its rate.
template <class T>
struct Turned {
    T cosine, sine;
    T later(double cycles_per_s) const {
        const T omega = static_cast<T>(kTwoPi * cycles_per_s);
        return omega > T(0) ? sine / omega : T(0);  // (0, 0) is no wave
    }
};
template <class T>
Turned<T> turned_by(double angle_rad) {
    return {static_cast<T>(std::cos(angle_rad)), static_cast<T>(std::sin(angle_rad))};
}

// The derivatives that a field's columns do for.
FieldSet made_from(const Grid& grid, Field field) {
    FieldSet derivatives;
    for (const AlongX& along : kAlongX)
        if (along.of == field) derivatives[index(along.derivative)] = grid.along_x[index(along.derivative)];
    return derivatives;
}

// The rows of a grid that are transformed: one or two ranges.
std::vector<std::pair<int, int>> row_ranges(const Grid& grid) {
    const int n = grid.resolution, end = grid.first_row + grid.rows;
    if (end <= n) return {{grid.first_row, end}};
    return {{grid.first_row, n}, {0, end - n}};
}

// Calls work(item) for each item, one item per task, and returns the sum of the results.
template <class Item, class Work>
long sum_of_each(const std::vector<Item>& items, Work&& work) {
    std::atomic<long> sum = 0;
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, items.size(), 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
            long part = 0;
            for (std::size_t i = range.begin(); i < range.end(); ++i) part += work(items[i]);
            sum += part;
        },
        tbb::simple_partitioner());
    return sum;
}

}  // namespace

template <class T>
struct Frame<T>::Scratch {
    // By mode of a block: of the waves, with what pairs of them add, and as their horizontal displacement has them.
    Heights waves, vertical, displaced;
    Heights growing;  // with their amplitudes' rates in the place of their amplitudes
    Buffer<T> through, chop_through;
    Buffer<T> line, lines;  // one spectrum before its 1-D transform; a block's results
};

template <class T>
struct Frame<T>::Scratches {
    tbb::enumerable_thread_specific<Scratch> of_thread;
};

template <class T>
Frame<T>::~Frame() = default;
template <class T>
Frame<T>::Frame(Frame&&) noexcept = default;
template <class T>
Frame<T>& Frame<T>::operator=(Frame&&) noexcept = default;

template <class T>
Frame<T>::Frame(std::shared_ptr<const Sea<T>> sea)
    : sea_(std::move(sea)), kernels_(kernels<T>()), scratches_(std::make_unique<Scratches>()) {
    const Plan& plan = sea_->plan();
    Transforms<T> transforms;
    std::size_t samples = 0;
    for (const CascadePlan& cascade : plan.cascades)
        for (const Grid& grid : cascade.grids)
            samples += grid.fields.count() * plane_room<T>(grid.resolution);
    samples_ = Buffer<T>::uncleared(std::exchange(samples, 0));
    for (int c = 0; c < static_cast<int>(plan.cascades.size()); ++c) {
        const CascadePlan& planned = plan.cascades[c];
        const Cascade<T>& cascade = sea_->cascades()[c];
        std::vector<GridState> grids;
        for (int g = 0; g < static_cast<int>(planned.grids.size()); ++g) {
            const Grid& grid = planned.grids[g];
            const int n = grid.resolution;
            // The sea's keep the bits of files that are there, and powers of two their recorded plans.
            const bool is_paired = planned.vessel && !std::has_single_bit(static_cast<unsigned>(n));
            GridState made{transforms.of(n, is_paired ? LineTransform<T>::Parts::Paired
                                                      : LineTransform<T>::Parts::Apart),
                           {},
                           {}};
            if (grid.sampling == Sampling::Spline) {
                made.prefilter = Buffer<T>(2 * static_cast<std::size_t>(grid.radius) - 1);
                for (int m = 1 - grid.radius; m < grid.radius; ++m)
                    made.prefilter[m + grid.radius - 1] =
                        static_cast<T>(bspline_prefilter(m, n, plan.knobs.spline_taps));
            }
            for (std::size_t f = 0; f < kFieldCount; ++f) {
                if (!grid.fields[f]) continue;
                made.planes[f] = {samples_.data() + samples, grid_samples<T>(n)};
                samples += plane_room<T>(n);
                // set() writes all others that are read.
                T* const cleared =
                    grid.rows < n ? made.planes[f].data() : std::to_address(made.planes[f].end());
                std::fill(cleared, samples_.data() + samples, T(0));
                if (grid.along_x[f]) continue;  // with those of what it is of
                for (const auto& [from, end] : row_ranges(grid))
                    for (int first = from; first < end; first += kBlockRows)
                        rows_.push_back(
                            {c, g, static_cast<Field>(f), first, std::min(kBlockRows, end - first)});
            }
            line_values_ = std::max(line_values_, 2 * line_stride<T>(n));
            grids.push_back(std::move(made));
        }
        grids_.push_back(std::move(grids));
        if (planned.vessel) vessels_.emplace_back(cascade, *planned.vessel, plan.from->spectrum.dispersion());
        if (planned.second_order)
            second_order_.emplace(sea_, c, transforms.of(planned.second_order->resolution));
        for (int mx = 0; mx < cascade.radius; mx += kBlockColumns) {
            const Block block{c, mx, std::min(kBlockColumns, cascade.radius - mx)};
            block_modes_ = std::max(block_modes_, cascade.columns[mx + block.columns] - cascade.columns[mx]);
            blocks_.push_back(block);
        }
    }
    const auto modes_of = [&](const Block& block) {
        const std::vector<std::size_t>& columns = sea_->cascades()[block.cascade].columns;
        return columns[block.first_mx + block.columns] - columns[block.first_mx];
    };
    std::stable_sort(blocks_.begin(), blocks_.end(),
                     [&](const Block& a, const Block& b) { return modes_of(a) > modes_of(b); });
    std::stable_sort(rows_.begin(), rows_.end(), [&](const Rows& a, const Rows& b) {
        return plan.cascades[a.cascade].grids[a.grid].resolution >
               plan.cascades[b.cascade].grids[b.grid].resolution;
    });
}

template <class T>
Frame<T>::Frame(std::shared_ptr<const SeaOverTime<T>> shot) : Frame(shot->first()) {
    if (shot->plan().from->weather) shot_ = std::move(shot);
}

template <class T>
void Frame<T>::set(double t_s, const std::atomic<bool>* cancel) {
    if (!(std::abs(t_s) <= kLatest_s))
        throw std::invalid_argument("a frame's time must be a number of at most 1e12 s to either side of 0");
    if (!is_whole_) throw std::logic_error("a frame whose samples were given back takes no time");
    const auto go_on = [cancel] { stop_if(cancel); };
    is_set_ = false;  // stays so if a task throws
    ++times_set_;
    time_s_ = t_s;
    if (shot_) {
        sea_ = shot_->at(t_s);
        if (second_order_) second_order_->take(sea_);
    }
    time_within_loop_s_ = pelagic::time_within_loop_s(t_s, sea_->loop_s());
    if (second_order_) {
        stop_if(cancel);
        executed_lines_ += second_order_->set(time_within_loop_s_);
    }
    strips_.clear();
    for (VesselWaves& vessel : vessels_) {
        vessel.set(t_s, cancel);
        strips_.emplace_back(vessel.plan(), t_s);
    }
    executed_lines_ +=
        sum_of_each(blocks_, [&](const Block& block) { return go_on(), transform_columns(block); });
    executed_lines_ += sum_of_each(rows_, [&](const Rows& rows) { return go_on(), transform_rows(rows); });
    const Plan& plan = sea_->plan();
    for (const Rows& rows : rows_)
        if (const Grid& grid = plan.cascades[rows.cascade].grids[rows.grid]; rows.first == grid.first_row)
            executed_transforms_ += 1 + static_cast<long>(made_from(grid, rows.field).count());
    for (int c = static_cast<int>(plan.sea_cascades()); c < static_cast<int>(plan.cascades.size()); ++c)
        for (int g = 0; g < static_cast<int>(plan.cascades[c].grids.size()); ++g) fade(c, g);
    squares_.assign(vessels_.size(), {});
    for (std::size_t v = 0; v < vessels_.size(); ++v) {
        const int c = static_cast<int>(plan.sea_cascades() + v);
        squares_[v].resize(plan.cascades[c].grids.size());
        if (plan.hides_slopes(c))
            tbb::parallel_for(std::size_t(0), squares_[v].size(),
                              [&](std::size_t g) { squares_[v][g] = squares_of(c, static_cast<int>(g)); });
    }
    is_set_ = true;
}

template <class T>
std::vector<glm::vec3> Frame<T>::squares_of(int cascade, int grid) const {
    const T *x = samples(cascade, grid, Field::SlopeX), *y = samples(cascade, grid, Field::SlopeY);
    const int n = sea_->plan().cascades[cascade].grids[grid].resolution;
    if (!x || !y || n < kSlopeBlocks) return {};  // waves as long as blocks
    std::vector<glm::vec3> sums(static_cast<std::size_t>(kSlopeBlocks) * kSlopeBlocks, glm::vec3(0.0f));
    std::vector<int> counts(sums.size());
    // At nodes, of which a spline's have its coefficients; of fine grids at as many as tell blocks' means.
    const bool is_spline = sea_->plan().cascades[cascade].grids[grid].sampling == Sampling::Spline;
    T quintic[6], cubic[4];
    bspline_weights<6>(T(0), quintic);
    bspline_weights<4>(T(0), cubic);
    const T one = T(1);
    const int spline_taps = sea_->plan().knobs.spline_taps, taps = is_spline ? spline_taps - 1 : 1,
              before = taps / 2;
    const T* weights = !is_spline ? &one : spline_taps == 6 ? quintic : cubic;
    const int step = std::max(1, n / (8 * kSlopeBlocks));
    for (int j = 0; j < n; j += step)
        for (int i = 0; i < n; i += step) {
            glm::vec<2, T> slope(T(0));
            for (int q = 0; q < taps; ++q)
                for (int p = 0; p < taps; ++p) {
                    const std::size_t from =
                        static_cast<std::size_t>((j + q - before + n) % n) * line_stride<T>(n) +
                        static_cast<std::size_t>((i + p - before + n) % n);
                    slope += weights[q] * weights[p] * glm::vec<2, T>(x[from], y[from]);
                }
            const auto to =
                static_cast<std::size_t>(j * kSlopeBlocks / n * kSlopeBlocks + i * kSlopeBlocks / n);
            sums[to] += glm::vec3(slope.x * slope.x, slope.x * slope.y, slope.y * slope.y);
            ++counts[to];
        }
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i] /= static_cast<float>(counts[i]);
    return sums;
}

template <class T>
glm::dvec3 Frame<T>::hidden_slopes(int cascade, int grid, glm::dvec2 place_m) const {
    const std::vector<std::vector<glm::vec3>>& of = squares_[vessel_of(cascade)];
    const auto finest = std::ranges::find_if(of, [](const auto& squares) { return !squares.empty(); });
    if (finest == of.end()) return glm::dvec3(0.0);
    const std::vector<glm::vec3>* shown = grid < 0 ? nullptr : &of[static_cast<std::size_t>(grid)];
    const glm::dvec2 at = place_m * (kSlopeBlocks / sea_->plan().cascades[cascade].size_m) - 0.5,
                     whole = glm::floor(at);
    const auto inside = [](double block) {
        return static_cast<std::size_t>(block - std::floor(block / kSlopeBlocks) * kSlopeBlocks) %
               kSlopeBlocks;
    };
    glm::dvec3 sum(0.0);
    for (const double j : {0.0, 1.0})
        for (const double i : {0.0, 1.0}) {
            const std::size_t block = inside(whole.y + j) * kSlopeBlocks + inside(whole.x + i);
            const double weight = (1.0 - std::abs(at.x - whole.x - i)) * (1.0 - std::abs(at.y - whole.y - j));
            sum += weight * glm::dvec3((*finest)[block] -
                                       (shown && !shown->empty() ? (*shown)[block] : glm::vec3(0.0f)));
        }
    return sum;
}

template <class T>
void Frame<T>::release(int cascade, int grid, Field field) {
    is_set_ = is_whole_ = false;
    std::span<T> plane = std::exchange(grids_[cascade][grid].planes[index(field)], {});
    if (!plane.empty())
        samples_.give_back(static_cast<std::size_t>(plane.data() - samples_.data()), plane.size());
}

template <class T>
typename Frame<T>::Scratch& Frame<T>::scratch() const {
    Scratch& scratch = scratches_->of_thread.local();
    if (scratch.line.empty()) {
        const Plan& plan = sea_->plan();
        const auto want = [&](std::initializer_list<Buffer<T>*> buffers, std::size_t count) {
            for (Buffer<T>* buffer : buffers) *buffer = Buffer<T>(count);
        };
        want({&scratch.through}, block_modes_);
        if (plan.has_gradients()) want({&scratch.chop_through}, block_modes_);
        const bool moves = std::any_of(plan.cascades.begin(), plan.cascades.end(),
                                       [](const CascadePlan& cascade) { return cascade.moves(); });
        const auto want_heights = [&](Heights& heights, bool with_rates) {
            want({&heights.re, &heights.im}, block_modes_);
            if (with_rates) want({&heights.rate_re, &heights.rate_im}, block_modes_);
        };
        want_heights(scratch.waves, moves || plan.lean_rad > 0.0);
        if (second_order_) want_heights(scratch.vertical, moves);
        if (plan.lean_rad > 0.0 || shot_) want_heights(scratch.displaced, moves);
        if (shot_ && moves) want_heights(scratch.growing, true);
        want({&scratch.lines}, kBlockColumns * line_values_);
        want({&scratch.line}, line_values_);  // allocated last: the check above relies on it
    }
    return scratch;
}

// Computes h(k,t) of a block's modes, and ∂h/∂t where a query asks for velocities.
template <class T>
void Frame<T>::advance(const Block& block, Scratch& at) const {
    const Cascade<T>& cascade = sea_->cascades()[block.cascade];
    const std::size_t first = cascade.columns[block.first_mx];
    const Plan& plan = sea_->plan();
    const bool has_rates = plan.cascades[block.cascade].moves() || leans(plan, block.cascade);
    if (plan.cascades[block.cascade].vessel)
        return vessels_[vessel_of(block.cascade)].heights(
            block.first_mx, block.columns, at.waves.re.data(), at.waves.im.data(),
            has_rates ? at.waves.rate_re.data() : nullptr, has_rates ? at.waves.rate_im.data() : nullptr);
    kernels_.advance({.forward_re = cascade.forward_re.data() + first,
                      .forward_im = cascade.forward_im.data() + first,
                      .backward_re = cascade.backward_re.data() + first,
                      .backward_im = cascade.backward_im.data() + first,
                      .cycles_per_s = cascade.cycles_per_s.data() + first,
                      .time_s = time_within_loop_s_,
                      .count = cascade.columns[block.first_mx + block.columns] - first,
                      .height_re = at.waves.re.data(),
                      .height_im = at.waves.im.data(),
                      .rate_re = has_rates ? at.waves.rate_re.data() : nullptr,
                      .rate_im = has_rates ? at.waves.rate_im.data() : nullptr});
}

template <class T>
void Frame<T>::grow(const Block& block, Scratch& at) const {
    const Cascade<T>& cascade = sea_->cascades()[block.cascade];
    const std::size_t first = cascade.columns[block.first_mx];
    const std::size_t count = cascade.columns[block.first_mx + block.columns] - first;
    kernels_.advance({.forward_re = cascade.growth[0].data() + first,
                      .forward_im = cascade.growth[1].data() + first,
                      .backward_re = cascade.growth[2].data() + first,
                      .backward_im = cascade.growth[3].data() + first,
                      .cycles_per_s = cascade.cycles_per_s.data() + first,
                      .time_s = time_within_loop_s_,
                      .count = count,
                      .height_re = at.growing.re.data(),
                      .height_im = at.growing.im.data(),
                      .rate_re = at.growing.rate_re.data(),
                      .rate_im = at.growing.rate_im.data()});
    const Turned<T> turned = turned_by<T>(lean_rad());
    const bool is_leaning = leans(sea_->plan(), block.cascade);
    for (std::size_t i = 0; i < count; ++i) {
        at.waves.rate_re[i] += at.growing.re[i];
        at.waves.rate_im[i] += at.growing.im[i];
        if (!is_leaning) continue;
        const T later = turned.later(cascade.cycles_per_s[first + i]);
        at.displaced.rate_re[i] += turned.cosine * at.growing.re[i] + later * at.growing.rate_re[i];
        at.displaced.rate_im[i] += turned.cosine * at.growing.im[i] + later * at.growing.rate_im[i];
    }
}

template <class T>
void Frame<T>::add_second_order(const Block& block, Scratch& at) const {
    const Cascade<T>& cascade = sea_->cascades()[block.cascade];
    const std::size_t first = cascade.columns[block.first_mx];
    const std::size_t count = cascade.columns[block.first_mx + block.columns] - first;
    const bool has_rates = !at.vertical.rate_re.empty();
    std::copy_n(at.waves.re.data(), count, at.vertical.re.data());
    std::copy_n(at.waves.im.data(), count, at.vertical.im.data());
    if (has_rates) {
        std::copy_n(at.waves.rate_re.data(), count, at.vertical.rate_re.data());
        std::copy_n(at.waves.rate_im.data(), count, at.vertical.rate_im.data());
    }
    const std::optional<DisplacementAt>& displacement = sea_->displacement();
    const T share = displacement ? static_cast<T>(displacement->pairs) : T(1),
            share_per_s = displacement ? static_cast<T>(displacement->pairs_per_s) : T(0);
    const int end = std::min(block.first_mx + block.columns, second_order_->reach());
    for (int mx = block.first_mx; mx < end; ++mx) {
        const PairModes<T> pairs = second_order_->column(mx);
        const std::size_t to = cascade.middle(mx) - first - static_cast<std::size_t>(pairs.half_height);
        for (std::size_t i = 0; i < 2 * static_cast<std::size_t>(pairs.half_height) + 1; ++i) {
            at.vertical.re[to + i] += share * pairs.height_re[i];
            at.vertical.im[to + i] += share * pairs.height_im[i];
            if (!pairs.rate_re) continue;
            at.vertical.rate_re[to + i] += share * pairs.rate_re[i];
            at.vertical.rate_im[to + i] += share * pairs.rate_im[i];
            if (share_per_s == T(0)) continue;
            at.vertical.rate_re[to + i] += share_per_s * pairs.height_re[i];
            at.vertical.rate_im[to + i] += share_per_s * pairs.height_im[i];
        }
    }
}

// A wave's rate over its frequency is the wave a quarter of a period later, whichever way it goes.
template <class T>
void Frame<T>::lean(const Block& block, Scratch& at) const {
    const Cascade<T>& cascade = sea_->cascades()[block.cascade];
    const std::size_t first = cascade.columns[block.first_mx];
    const std::size_t count = cascade.columns[block.first_mx + block.columns] - first;
    const Turned<T> turned = turned_by<T>(lean_rad());
    const T cosine = turned.cosine, sine = turned.sine;
    const Heights& from = at.waves;
    Heights& to = at.displaced;
    for (std::size_t i = 0; i < count; ++i) {
        const T omega = static_cast<T>(kTwoPi * cascade.cycles_per_s[first + i]);
        const T later = turned.later(cascade.cycles_per_s[first + i]);
        to.re[i] = cosine * from.re[i] + later * from.rate_re[i];
        to.im[i] = cosine * from.im[i] + later * from.rate_im[i];
        if (to.rate_re.empty()) continue;
        to.rate_re[i] = cosine * from.rate_re[i] - sine * omega * from.re[i];
        to.rate_im[i] = cosine * from.rate_im[i] - sine * omega * from.im[i];
    }
    const double turns_by = sea_->displacement() ? sea_->displacement()->lean_rad_per_s : 0.0;
    if (turns_by == 0.0 || to.rate_re.empty()) return;
    const Turned<T> quarter{T(0), T(1)};  // the angle's own change
    for (std::size_t i = 0; i < count; ++i) {
        const T by = static_cast<T>(turns_by), later = quarter.later(cascade.cycles_per_s[first + i]);
        to.rate_re[i] += by * (cosine * later * from.rate_re[i] - sine * from.re[i]);
        to.rate_im[i] += by * (cosine * later * from.rate_im[i] - sine * from.im[i]);
    }
}

template <class T>
double Frame<T>::lean_rad() const {
    return sea_->displacement() ? sea_->displacement()->lean_rad : sea_->plan().lean_rad;
}

template <class T>
void Frame<T>::press(const Block& block, Scratch& at) const {
    const Plan& plan = sea_->plan();
    const Cascade<T>& cascade = sea_->cascades()[block.cascade];
    const std::size_t first = cascade.columns[block.first_mx],
                      count = cascade.columns[block.first_mx + block.columns] - first;
    const std::optional<DisplacementAt>& displacement = sea_->displacement();
    const T share = displacement ? static_cast<T>(displacement->share) : T(1),
            share_per_s = displacement ? static_cast<T>(displacement->share_per_s) : T(0);
    const Heights& from = leans(plan, block.cascade) ? at.displaced : at.waves;
    Heights& to = at.displaced;
    if (plan.cascades[block.cascade].moves())
        for (std::size_t i = 0; i < count; ++i) {
            const T grows =
                cascade.widening.empty() ? share_per_s : share_per_s + share * cascade.widening[first + i];
            to.rate_re[i] = share * from.rate_re[i] + grows * from.re[i];
            to.rate_im[i] = share * from.rate_im[i] + grows * from.im[i];
        }
    for (std::size_t i = 0; i < count; ++i) {
        to.re[i] = share * from.re[i];
        to.im[i] = share * from.im[i];
    }
}

// Computes the spectrum of a block's columns at this time once. Then, for each field of each grid, writes the
// columns' spectra, transforms them along y and scatters the results into the rows.
template <class T>
long Frame<T>::transform_columns(const Block& block) {
    const Plan& plan = sea_->plan();
    const Cascade<T>& cascade = sea_->cascades()[block.cascade];
    const CascadePlan& planned = plan.cascades[block.cascade];
    Scratch& at = scratch();
    advance(block, at);
    const bool is_leaning = leans(plan, block.cascade);
    if (is_leaning) lean(block, at);
    if (!cascade.growth[0].empty()) grow(block, at);
    const bool is_pressed = (sea_->displacement() || !cascade.widening.empty()) && is_displaced(planned);
    if (is_pressed) press(block, at);
    const bool has_pairs = second_order_ && second_order_->cascade() == block.cascade;
    if (has_pairs) add_second_order(block, at);
    const T step = static_cast<T>(kTwoPi / cascade.size_m);
    long lines = 0;
    for (std::size_t g = 0; g < planned.grids.size(); ++g) {
        const Grid& grid = planned.grids[g];
        GridState& state = grids_[block.cascade][g];
        const int columns = std::min(block.columns, grid.radius - block.first_mx);
        // The scratch index of a column's my = 0.
        const auto middle = [&](int column) {
            return cascade.middle(block.first_mx + column) - cascade.columns[block.first_mx];
        };
        for (int column = 0; column < columns; ++column) {
            const int mx = block.first_mx + column;
            const T* prefilter = state.prefilter.empty() ? nullptr : state.prefilter.data() + grid.radius - 1;
            kernels_.through(
                {.half_height = half_height(grid.radius, mx),
                 .kx = static_cast<T>(mx) * step,
                 .step = step,
                 .footprint_m = plan.levels[grid.level].footprint_m,
                 .n_min = plan.filter.n_min,
                 .n_max = plan.filter.n_max,
                 .prefilter = prefilter,
                 .prefilter_x = prefilter ? prefilter[mx] : T(1),
                 .chop = cascade.chop.empty() ? nullptr : cascade.chop.data() + cascade.middle(mx),
                 .through = at.through.data() + middle(column),
                 .chop_through = from(at.chop_through, middle(column))});
        }
        const std::size_t stride = line_stride<T>(grid.resolution);
        for (std::size_t f = 0; f < kFieldCount && columns > 0; ++f) {
            if (!grid.fields[f] || grid.along_x[f]) continue;
            // The horizontal displacement has no second order: where points stand at rest is chosen so.
            const Heights& heights = has_pairs && vertical_fields()[f]                      ? at.vertical
                                     : (is_leaning || is_pressed) && horizontal_fields()[f] ? at.displaced
                                                                                            : at.waves;
            for (int column = 0; column < columns; ++column) {
                const int mx = block.first_mx + column;
                const std::size_t m = middle(column);
                kernels_.line({.field = static_cast<Field>(f),
                               .half_height = half_height(grid.radius, mx),
                               .n = grid.resolution,
                               .kx = static_cast<T>(mx) * step,
                               .step = step,
                               .height_re = heights.re.data() + m,
                               .height_im = heights.im.data() + m,
                               .rate_re = from(heights.rate_re, m),
                               .rate_im = from(heights.rate_im, m),
                               .through = at.through.data() + m,
                               .chop_through = from(at.chop_through, m),
                               .line_re = at.line.data(),
                               .line_im = at.line.data() + stride});
                state.transform.execute(at.line.data(), at.lines.data() + 2 * stride * column);
            }
            for (const auto& [from, end] : row_ranges(grid))
                kernels_.scatter({.lines = at.lines.data(),
                                  .columns = columns,
                                  .first_column = block.first_mx,
                                  .n = grid.resolution,
                                  .rows = state.planes[f].data(),
                                  .first_row = from,
                                  .end_row = end});
            lines += columns;
        }
    }
    return lines;
}

// Each complex transform yields two real rows.
template <class T>
long Frame<T>::transform_rows(const Rows& rows) {
    const Grid& grid = sea_->plan().cascades[rows.cascade].grids[rows.grid];
    GridState& state = grids_[rows.cascade][rows.grid];
    const int n = grid.resolution;
    const std::size_t stride = line_stride<T>(n);
    Scratch& at = scratch();
    const T step = static_cast<T>(kTwoPi / sea_->plan().cascades[rows.cascade].size_m);
    const FieldSet derivatives = made_from(grid, rows.field);
    long lines = 0;
    const auto transform = [&](const T* from, T* row, int y) {
        ++lines;
        kernels_.pair({.first = from,
                       .second = y + 1 < n ? from + stride : nullptr,
                       .radius = grid.radius,
                       .n = n,
                       .line_re = at.line.data(),
                       .line_im = at.line.data() + stride});
        state.transform.execute(at.line.data(), row);
        for (T* real : {row, row + stride})
            for (std::size_t i = 0; i < kRowSkirt; ++i)
                real[n + i] = real[i];  // N may be shorter than the skirt, which then repeats itself
    };
    for (int y = rows.first; y < rows.first + rows.count; y += 2) {
        T* const row = state.planes[index(rows.field)].data() + y * stride;
        for (std::size_t f = 0; f < kFieldCount; ++f) {
            if (!derivatives[f]) continue;
            for (int line = 0; line < (y + 1 < n ? 2 : 1); ++line) {
                const T *re = row + line * stride, *im = re + stride / 2;
                T *to_re = at.lines.data() + line * stride, *to_im = to_re + stride / 2;
                for (int m = 0; m < grid.radius; ++m) {
                    const T kx = static_cast<T>(m) * step;
                    to_re[m] = -kx * im[m];
                    to_im[m] = kx * re[m];
                }
            }
            transform(at.lines.data(), state.planes[f].data() + y * stride, y);
        }
        transform(row, row, y);  // the last: its columns were theirs
    }
    return lines;
}

template <class T>
void Frame<T>::fade(int cascade, int grid) {
    const CascadePlan& planned = sea_->plan().cascades[cascade];
    const int n = planned.grids[grid].resolution;
    const glm::dvec2 middle_m = tile_middle_m(cascade);
    const auto fades = [&](double middle) {
        std::vector<TileFade> all(static_cast<std::size_t>(n));
        for (std::size_t node = 0; node < all.size(); ++node) {
            const double turns = static_cast<double>(node) / n - middle / planned.size_m;
            all[node] = tile_fade((turns - std::round(turns)) * planned.size_m, planned.size_m);
        }
        return all;
    };
    const std::vector<TileFade> x = fades(middle_m.x), y = fades(middle_m.y);
    for (const auto& [first, end] : row_ranges(planned.grids[grid]))
        tbb::parallel_for(
            first, end, [&](int row) { fade_row(cascade, grid, row, x, y[static_cast<std::size_t>(row)]); });
}

template <class T>
void Frame<T>::fade_row(int cascade, int grid, int row, const std::vector<TileFade>& along,
                        const TileFade& y) {
    GridState& state = grids_[cascade][grid];
    const int n = sea_->plan().cascades[cascade].grids[grid].resolution;
    const auto line = [&](std::size_t field) {
        const std::span<T> plane = state.planes[field];
        return plane.empty() ? nullptr : plane.data() + static_cast<std::size_t>(row) * line_stride<T>(n);
    };
    for (int i = 0; i < n; ++i) {
        const TileFade& x = along[static_cast<std::size_t>(i)];
        const T share = static_cast<T>(x.share * y.share);
        if (share == T(1)) continue;
        for (const Gradient& gradient : kGradients)  // before what they are derivatives of
            if (T* to = line(index(gradient.derivative)), *of = line(index(gradient.of)); to && of)
                to[i] = share * to[i] + of[i] * static_cast<T>(gradient.along_y ? x.share * y.rate_per_m
                                                                                : x.rate_per_m * y.share);
        for (std::size_t f = 0; f < kFieldCount; ++f)
            if (T* values = line(f); values && gradient_fields(FieldSet().set(f)).none()) values[i] *= share;
    }
    for (std::size_t f = 0; f < kFieldCount; ++f)
        if (T* values = line(f))
            for (std::size_t i = 0; i < kRowSkirt; ++i) values[n + static_cast<int>(i)] = values[i];
}

template <class T>
std::size_t Frame<T>::held_bytes() const {
    std::size_t samples = 0;
    for (const std::vector<GridState>& grids : grids_)
        for (const GridState& grid : grids)
            for (const std::span<T> plane : grid.planes) samples += plane.size();
    return samples * sizeof(T);
}

template <class T>
Realisation Frame<T>::realisation(int query) const {
    const Query& asked = sea_->plan().queries.at(query).query;
    return realisation(query, {asked.cell_m.front(), asked.pixel_m.front()});
}

template <class T>
Realisation Frame<T>::realisation(int query, const Footprints& footprints) const {
    const Plan& plan = sea_->plan();
    const Query& asked = plan.queries.at(query).query;
    constexpr int kSums = 5;
    // Blocks run in parallel; their sums are added in block order, so that rounding is the same every time.
    std::vector<std::array<double, kSums>> parts(blocks_.size(), std::array<double, kSums>{});
    tbb::parallel_for(std::size_t(0), blocks_.size(), [&](std::size_t b) {
        const Block& block = blocks_[b];
        if (asked.only_cascade && *asked.only_cascade != block.cascade) return;
        if (plan.cascades[block.cascade].vessel) return;
        const Cascade<T>& cascade = sea_->cascades()[block.cascade];
        const double step = kTwoPi / cascade.size_m;
        Scratch& at = scratch();
        advance(block, at);
        for (int mx = block.first_mx; mx < block.first_mx + block.columns; ++mx) {
            const std::size_t end = cascade.columns[mx + 1];
            // Column mx = 0 stores my and −my, which are conjugates: count one half.
            const std::size_t first = mx == 0 ? cascade.middle(0) : cascade.columns[mx];
            const std::size_t local = first - cascade.columns[block.first_mx];
            kernels_.realise({.height_re = at.waves.re.data() + local,
                              .height_im = at.waves.im.data() + local,
                              .forward_re = cascade.forward_re.data() + first,
                              .forward_im = cascade.forward_im.data() + first,
                              .backward_re = cascade.backward_re.data() + first,
                              .backward_im = cascade.backward_im.data() + first,
                              .cycles_per_s = cascade.cycles_per_s.data() + first,
                              .first_my = static_cast<int>(first) - static_cast<int>(cascade.middle(mx)),
                              .count = static_cast<int>(end - first),
                              .kx = mx * step,
                              .step = step,
                              .cell_m = footprints.cell_m,
                              .pixel_m = footprints.pixel_m,
                              .n_min = plan.filter.n_min,
                              .n_max = plan.filter.n_max,
                              .sums = parts[b].data()});
        }
    });
    Realisation sum;
    for (const auto& part : parts) sum += Realisation{part[0], part[1], part[2], part[3], part[4]};
    if (plan.trains && !asked.only_cascade)
        sum += pelagic::realisation(sea_->trains(), plan.filter, footprints);
    return sum;
}

template class Frame<float>;
template class Frame<double>;

}  // namespace pelagic
