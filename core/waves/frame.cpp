#include "core/waves/frame.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>

#include "core/base/constants.h"
#include "core/plan/mode_lattice.h"
#include "core/waves/spline.h"

namespace pelagic {
namespace {

// Re-using one FFTW plan per size.
template <class T>
InverseTransform<T> transform_of(std::map<int, InverseTransform<T>>& known, int n) {
    const auto found = known.find(n);
    return found != known.end() ? found->second : known.emplace(n, InverseTransform<T>(n)).first->second;
}

template <class Work>
void for_each_mode(int radius, Work&& work) {
    std::size_t at = 0;
    for (int my = 0; radius > 0 && my <= radius; ++my) {
        const int first = row_first(radius, my), last = first + row_length(radius, my);
        for (int mx = first; mx < last; ++mx, ++at) work(at, mx, my);
    }
}

// A field's factor on h(k,t), or on ∂h/∂t for velocities: real, or real times i.
template <class T>
struct Factor {
    T value;
    bool imaginary;
    bool of_rate;
};

// Tessendorf 2001, Eqs. 19, 20, 29 and their derivatives; D with +i, which sharpens the crests (his printed
// −i flattens them). chop = choppiness · coth(kd)/k.
template <class T>
Factor<T> factor(Field field, T kx, T ky, T chop) {
    switch (field) {
        case Field::Height:
            return {T(1), false, false};
        case Field::Dx:
            return {chop * kx, true, false};
        case Field::Dy:
            return {chop * ky, true, false};
        case Field::SlopeX:
            return {kx, true, false};
        case Field::SlopeY:
            return {ky, true, false};
        case Field::Dxx:
            return {-chop * kx * kx, false, false};
        case Field::Dyy:
            return {-chop * ky * ky, false, false};
        case Field::Dxy:
            return {-chop * kx * ky, false, false};
        case Field::VelocityX:
            return {chop * kx, true, true};
        case Field::VelocityY:
            return {chop * ky, true, true};
        case Field::VelocityZ:
            return {T(1), false, true};
    }
    return {};
}

}  // namespace

template <class T>
Frame<T>::Frame(std::shared_ptr<const Sea<T>> sea) : sea_(std::move(sea)) {
    const Plan& plan = sea_->plan();
    std::map<int, InverseTransform<T>> transforms;
    for (std::size_t c = 0; c < plan.cascades.size(); ++c) {
        const CascadePlan& planned = plan.cascades[c];
        const int radius = sea_->cascades()[c].radius;
        const std::size_t modes = half_plane_modes(radius);
        State state;
        state.height.resize(modes);
        if (planned.moves()) state.rate.resize(modes);
        for (const Grid& grid : planned.grids) {
            GridState made{{}, {}, transform_of(transforms, grid.resolution), {}};
            if (grid.sampling == Sampling::Spline)
                for (int m = 0; m <= radius; ++m)
                    made.prefilter.push_back(static_cast<T>(bspline_prefilter(
                        std::min(m, grid.resolution / 2 - 1), grid.resolution, plan.knobs.spline_taps)));
            const double footprint_m = plan.levels[grid.level].footprint_m;
            const double step = kTwoPi / planned.size_m;
            made.weight.resize(modes);
            for_each_mode(radius, [&](std::size_t at, int mx, int my) {
                // What this grid cannot hold has weight 0 already; the test keeps an index from wrapping.
                const bool held = 2 * std::max(std::abs(mx), my) < grid.resolution;
                made.weight[at] =
                    held ? static_cast<T>(plan.filter.weight(step * std::hypot(mx, my), footprint_m)) : T(0);
            });
            for (std::size_t i = 0; i < grid.transforms.size(); ++i)
                made.buffers.emplace_back(static_cast<std::size_t>(grid.resolution) * grid.resolution);
            state.grids.push_back(std::move(made));
        }
        states_.push_back(std::move(state));
    }
}

template <class T>
void Frame<T>::set(double t_s) {
    if (!(std::abs(t_s) <= kLatest_s))
        throw std::invalid_argument("a frame's time must be a number of at most 1e12 s to either side of 0");
    time_s_ = reduced_time_s_ = t_s;
    if (const double loop_s = sea_->loop_s(); loop_s > 0.0) {
        // Modulo the loop, so that its last frame meets its first to the bit.
        reduced_time_s_ -= loop_s * std::floor(t_s / loop_s);
        // Rounding of (f − 1)/fps and of the division.
        const double same_s = 4.0 * std::numeric_limits<double>::epsilon() * std::max(std::abs(t_s), loop_s);
        if (loop_s - reduced_time_s_ < same_s || reduced_time_s_ < same_s) reduced_time_s_ = 0.0;
    }
    tbb::parallel_for(0, static_cast<int>(states_.size()), [&](int c) { advance(c); });

    struct Task {
        int cascade, grid, transform;
        int cost;
    };
    std::vector<Task> tasks;
    for (int c = 0; c < static_cast<int>(states_.size()); ++c)
        for (int g = 0; g < static_cast<int>(states_[c].grids.size()); ++g)
            for (int i = 0; i < static_cast<int>(states_[c].grids[g].buffers.size()); ++i)
                tasks.push_back({c, g, i, states_[c].grids[g].transform.n()});
    // The large ones first: the small ones then fill the gaps.
    std::stable_sort(tasks.begin(), tasks.end(),
                     [](const Task& a, const Task& b) { return a.cost > b.cost; });
    std::atomic<long> executed = 0;
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, tasks.size(), 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
            for (std::size_t i = range.begin(); i < range.end(); ++i)
                fill(tasks[i].cascade, tasks[i].grid, tasks[i].transform, executed);
        },
        tbb::simple_partitioner());
    executed_transforms_ += executed;
    is_set_ = true;
}

// h(k,t) and its rate, for each mode.
template <class T>
void Frame<T>::advance(int c) {
    const Cascade<T>& cascade = sea_->cascades()[c];
    State& state = states_[c];
    const std::size_t count = state.height.size();
    constexpr std::size_t kBlock = 4096;
    tbb::parallel_for(std::size_t(0), (count + kBlock - 1) / kBlock, [&](std::size_t block) {
        for (std::size_t i = block * kBlock; i < std::min(count, (block + 1) * kBlock); ++i) {
            // The phase in cycles, reduced in double before it is rounded: as exact after ten weeks as at 0.
            const double cycles = cascade.cycles_per_s[i] * reduced_time_s_;
            const T phase = static_cast<T>(kTwoPi * (cycles - std::round(cycles)));
            const T omega = static_cast<T>(kTwoPi * cascade.cycles_per_s[i]);
            const T cosine = std::cos(phase), sine = std::sin(phase);
            const std::complex<T> f = cascade.forward[i], b = cascade.backward[i];
            const std::complex<T> going(f.real() * cosine + f.imag() * sine,
                                        f.imag() * cosine - f.real() * sine);
            const std::complex<T> coming(b.real() * cosine - b.imag() * sine,
                                         b.imag() * cosine + b.real() * sine);
            state.height[i] = going + coming;
            const std::complex<T> d = coming - going;  // ∂h/∂t = iω (coming − going)
            if (!state.rate.empty()) state.rate[i] = {-omega * d.imag(), omega * d.real()};
        }
    });
}

// One pair of real fields A, B: the spectrum of A + iB into the buffer, then its inverse transform.
template <class T>
void Frame<T>::fill(int c, int g, int transform, std::atomic<long>& executed) {
    const Cascade<T>& cascade = sea_->cascades()[c];
    const Grid& grid = sea_->plan().cascades[c].grids[g];
    const State& state = states_[c];
    const GridState& grid_state = state.grids[g];
    const TransformBuffer<T>& buffer = grid_state.buffers[transform];
    const int n = grid.resolution;
    std::fill_n(buffer.data(), buffer.size(), std::complex<T>(0));

    const std::optional<Field> first = grid.transforms[transform][0], second = grid.transforms[transform][1];
    const T step = static_cast<T>(kTwoPi / cascade.size_m);
    const auto spectrum_of = [&](Field field, std::size_t at, T kx, T ky) {
        const Factor<T> by = factor(field, kx, ky, cascade.chop.empty() ? T(0) : cascade.chop[at]);
        const std::complex<T> h = by.of_rate ? state.rate[at] : state.height[at];
        return by.imaginary ? std::complex<T>(-by.value * h.imag(), by.value * h.real()) : by.value * h;
    };
    for_each_mode(cascade.radius, [&](std::size_t at, int mx, int my) {
        T weight = grid_state.weight[at];
        if (weight == T(0)) return;
        if (!grid_state.prefilter.empty())
            weight *= grid_state.prefilter[std::abs(mx)] * grid_state.prefilter[my];
        const T kx = static_cast<T>(mx) * step, ky = static_cast<T>(my) * step;
        const std::complex<T> a = weight * spectrum_of(*first, at, kx, ky);
        const std::complex<T> b = second ? weight * spectrum_of(*second, at, kx, ky) : std::complex<T>(0);
        const int x = mx < 0 ? mx + n : mx, mirrored_x = mx > 0 ? n - mx : -mx;
        const int mirrored_y = my > 0 ? n - my : 0;
        // The transform takes y side by side. Both fields are real: at −k stand their conjugates.
        buffer.data()[static_cast<std::size_t>(x) * n + my] = {a.real() - b.imag(), a.imag() + b.real()};
        buffer.data()[static_cast<std::size_t>(mirrored_x) * n + mirrored_y] = {a.real() + b.imag(),
                                                                                b.real() - a.imag()};
    });
    grid_state.transform.execute(buffer);
    ++executed;
}

template <class T>
Realisation Frame<T>::realisation(int query) const {
    const Plan& plan = sea_->plan();
    const Query& asked = plan.queries.at(query).query;
    Realisation sum;
    for (std::size_t c = 0; c < states_.size(); ++c) {
        const Cascade<T>& cascade = sea_->cascades()[c];
        if (cascade.radius == 0 || (asked.only_cascade && *asked.only_cascade != static_cast<int>(c)))
            continue;
        const double step = kTwoPi / cascade.size_m;
        std::vector<std::size_t> row_offset{0};
        for (int my = 0; my <= cascade.radius; ++my)
            row_offset.push_back(row_offset.back() +
                                 static_cast<std::size_t>(row_length(cascade.radius, my)));
        // Rows side by side, added up in their order.
        std::vector<Realisation> rows(row_offset.size() - 1);
        tbb::parallel_for(0, static_cast<int>(rows.size()), [&](int my) {
            Realisation& row = rows[static_cast<std::size_t>(my)];
            for (std::size_t at = row_offset[my]; at < row_offset[my + 1]; ++at) {
                const int mx = row_first(cascade.radius, my) + static_cast<int>(at - row_offset[my]);
                const double k = step * std::hypot(mx, my);
                const double cell_weight = plan.filter.weight(k, asked.cell_m.front());
                const double pixel_weight = plan.filter.weight(k, asked.pixel_m.front());
                // Twice: the mode and its mirror image.
                const double height2 = 2.0 * std::norm(std::complex<double>(states_[c].height[at]));
                row.m0 += cell_weight * cell_weight * height2;
                row.m_minus1 += cell_weight * cell_weight * height2 / (kTwoPi * cascade.cycles_per_s[at]);
                row.mss += pixel_weight * pixel_weight * k * k * height2;
                // forward is h0(k), which travels along +k; backward belongs to −k.
                const double net = std::norm(std::complex<double>(cascade.forward[at])) -
                                   std::norm(std::complex<double>(cascade.backward[at]));
                row.east += cell_weight * cell_weight * net * step * mx / k;
                row.north += cell_weight * cell_weight * net * step * my / k;
            }
        });
        for (const Realisation& row : rows) {
            sum.m0 += row.m0;
            sum.m_minus1 += row.m_minus1;
            sum.mss += row.mss;
            sum.east += row.east;
            sum.north += row.north;
        }
    }
    return sum;
}

template class Frame<float>;
template class Frame<double>;

}  // namespace pelagic
