// The trains of a sea that feels its floor (core/waves/coast.h), at a chunk's points, in Highway's vectors of trains. As AddTrains()
// (core/evaluate/trains-inl.h), with S(x) for k·x: heights h cos θ, θ = ωt − S, slopes h ∇S sin θ + ∇h cos θ, displacements ∇S/k H sin θ. Of the gradient
// of the displacement the part is left out that ∇(∇S) has, d over a wavelength times the floor's slope.
//
// Included once per instruction set by files that use Highway's foreach_target (its own pattern of guards).
#if defined(PELAGIC_CORE_EVALUATE_COAST_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PELAGIC_CORE_EVALUATE_COAST_INL_H_
#undef PELAGIC_CORE_EVALUATE_COAST_INL_H_
#else
#define PELAGIC_CORE_EVALUATE_COAST_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

#include "core/base/constants.h"
#include "core/base/number.h"
#include "core/base/pack-inl.h"
#include "core/base/sincos-inl.h"
#include "core/evaluate/trains.h"
#include "core/plan/masks.h"

HWY_BEFORE_NAMESPACE();
namespace pelagic {
namespace HWY_NAMESPACE {
namespace coast_detail {
namespace hn = hwy::HWY_NAMESPACE;

#include "core/plan/filter.inl"
#include "core/waves/trains.inl"

// The nine cells round a place, and their weights: of the value, and of how it changes [1/m]. `beyond_m`: how far outside the map it is, which
// changes by `outwards`; `left`: of the map's gains there.
template <class T>
struct CoastTaps {
    std::array<std::size_t, 9> cell;
    std::array<T, 9> value, x, y;
    T beyond_m = T(0), left = T(1), left_x = T(0), left_y = T(0);
    glm::dvec2 outwards{0.0};
};

struct AxisTaps {
    std::array<int, 3> cell;
    std::array<double, 3> value, rate;
};

// Beyond the last cells, as at the edge; how far a place is beyond them is another thing.
inline AxisTaps AxisTapsOf(double at_cells, int count, double cell_m) {
    const double at = at_cells > 0.0 ? std::min(at_cells, static_cast<double>(count)) : 0.0;
    const int own = std::min(static_cast<int>(at), count - 1);
    const MaskWeights<double> w = mask_weights(at - own - 0.5);
    return {{std::max(own - 1, 0), own, std::min(own + 1, count - 1)},
            {w.before, w.here, w.after},
            {w.before_rate / cell_m, w.here_rate / cell_m, w.after_rate / cell_m}};
}

template <class T>
CoastTaps<T> CoastTapsOf(const Coast<T>& coast, glm::dvec2 place_m) {
    const glm::dvec2 at = (place_m - coast.from_m) / coast.cell_m;
    const AxisTaps columns = AxisTapsOf(at.x, coast.count.x, coast.cell_m.x),
                   rows = AxisTapsOf(at.y, coast.count.y, coast.cell_m.y);
    CoastTaps<T> taps;
    for (std::size_t j = 0; j < 3; ++j)
        for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t to = 3 * j + i;
            taps.cell[to] = coast.cell(columns.cell[i], rows.cell[j]);
            taps.value[to] = static_cast<T>(columns.value[i] * rows.value[j]);
            taps.x[to] = static_cast<T>(columns.rate[i] * rows.value[j]);
            taps.y[to] = static_cast<T>(columns.value[i] * rows.rate[j]);
        }
    const glm::dvec2 beyond_m = coast.beyond_m(place_m);
    const double far_m = glm::length(beyond_m);
    if (!(far_m > 0.0)) return taps;
    taps.outwards = beyond_m / far_m;
    taps.beyond_m = static_cast<T>(far_m);
    const CoastFade fade = coast_fade(far_m / coast.fade_m);
    taps.left = static_cast<T>(fade.left);
    taps.left_x = static_cast<T>(fade.rate / coast.fade_m * taps.outwards.x);
    taps.left_y = static_cast<T>(fade.rate / coast.fade_m * taps.outwards.y);
    return taps;
}

// θ/2π of each train at a point but for the floor's part, reduced in double.
template <class T>
HWY_INLINE void CyclesOf(const Trains<T>& trains, const double* start, double x, double y, std::size_t end,
                         std::vector<T>& out) {
    const hn::ScalableTag<double> d;
    HWY_ALIGN double reduced[hn::MaxLanes(d)];
    std::size_t i = 0;
    for (; i + hn::Lanes(d) <= end; i += hn::Lanes(d)) {
        const auto all = hn::NegMulAdd(
            hn::LoadU(d, &trains.ky_cycles_per_m[i]), hn::Set(d, y),
            hn::NegMulAdd(hn::LoadU(d, &trains.kx_cycles_per_m[i]), hn::Set(d, x), hn::LoadU(d, start + i)));
        hn::Store(hn::Sub(all, hn::Round(all)), d, reduced);
        for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) out[i + lane] = static_cast<T>(reduced[lane]);
    }
    for (; i < end; ++i) {
        const double all =
            std::fma(-trains.ky_cycles_per_m[i], y, std::fma(-trains.kx_cycles_per_m[i], x, start[i]));
        out[i] = static_cast<T>(all - std::nearbyint(all));
    }
}

// What one vector of trains has at the point.
template <class V>
struct LocalTrains {
    V cycles, kx, ky, height_m, height_x, height_y;  // the height, and how it changes
};

// A footprint: its width and stretch.
template <class T>
struct PointFootprint {
    T width_m, x, y;
};

template <class T>
struct PointSums {
    std::array<T, kFieldCount> fields{}, breaking{};
    T turn{}, breaking_turn{};
    UnresolvedMoments<T> hidden{};
};

// What is asked of a point.
struct Wants {
    bool height, horizontal, drift, rise, slope, gradient, breaking, hidden;
};

template <class T>
class CoastPoint {
    using D = hn::ScalableTag<T>;
    using V = hn::Vec<D>;

  public:
    CoastPoint(const Coast<T>& coast, const FootprintFilter& filter, const Wants& wants,
               const PointFootprint<T>& cell, const PointFootprint<T>& pixel)
        : coast_(coast), filter_(filter), wants_(wants), cell_(cell), pixel_(pixel) {
        for (V& sum : field_) sum = hn::Zero(D());
        for (V& sum : breaking_) sum = hn::Zero(D());
        for (V& sum : hidden_) sum = hn::Zero(D());
        turn_ = breaking_turn_ = hn::Zero(D());
    }

    // Trains i … i + lanes − 1. What isn't shown is hidden whole.
    HWY_INLINE void add(std::size_t i, const LocalTrains<V>& at, bool is_shown) {
        const D d;
        const V k2 = hn::MulAdd(at.kx, at.kx, hn::MulAdd(at.ky, at.ky, hn::Set(d, T(1e-20))));
        const V k = hn::Sqrt(k2), per_k = hn::Div(hn::Set(d, T(1)), k);
        const V unit_x = hn::Mul(at.kx, per_k), unit_y = hn::Mul(at.ky, per_k);
        // H = choppiness coth(kd) h, and coth(kd) goes with k: ω² = g k tanh(kd).
        const auto sideways = [&](const std::vector<T>& of, V& limited) HWY_ATTR {
            const V wanted = hn::Mul(hn::Mul(hn::LoadU(d, &of[i]), k), at.height_m);
            limited = hn::Min(wanted, per_k);
            return hn::Gt(wanted, per_k);
        };
        V sine = hn::Zero(d), cosine = sine, w = sine;
        if (is_shown) SinCosCycles(d, at.cycles, sine, cosine);
        const auto add = [&](V* to, Field field, V value)
                             HWY_ATTR { to[index(field)] = hn::Add(to[index(field)], value); };
        if (is_shown && (wants_.height || wants_.horizontal || wants_.drift || wants_.rise)) {
            const V of_cell = weight(cell_, k, unit_x, unit_y), s = hn::Mul(of_cell, sine),
                    c = hn::Mul(of_cell, cosine);
            V wide;
            sideways(coast_.sideways_m, wide);
            const V omega = hn::LoadU(d, &coast_.omega[i]);
            if (wants_.height) add(field_, Field::Height, hn::Mul(at.height_m, c));
            if (wants_.horizontal) {
                add(field_, Field::Dx, hn::Mul(hn::Mul(unit_x, wide), s));
                add(field_, Field::Dy, hn::Mul(hn::Mul(unit_y, wide), s));
            }
            if (wants_.drift) {
                const V speed = hn::Mul(hn::Mul(omega, wide), c);
                add(field_, Field::VelocityX, hn::Mul(unit_x, speed));
                add(field_, Field::VelocityY, hn::Mul(unit_y, speed));
            }
            if (wants_.rise) add(field_, Field::VelocityZ, hn::Neg(hn::Mul(hn::Mul(omega, at.height_m), s)));
        }
        if (!wants_.slope && !wants_.gradient && !wants_.breaking && !wants_.hidden) return;
        if (is_shown) w = weight(pixel_, k, unit_x, unit_y);
        if (is_shown && wants_.slope) {
            const V s = hn::Mul(hn::Mul(w, sine), at.height_m), c = hn::Mul(w, cosine);
            add(field_, Field::SlopeX, hn::MulAdd(at.kx, s, hn::Mul(at.height_x, c)));
            add(field_, Field::SlopeY, hn::MulAdd(at.ky, s, hn::Mul(at.height_y, c)));
        }
        if (!wants_.gradient && !wants_.breaking && !wants_.hidden) return;
        V wide;
        const auto is_limited = sideways(coast_.breaking_sideways_m, wide);
        // How H changes; at its limit hardly.
        const V grows =
            hn::IfThenZeroElse(is_limited, hn::Mul(hn::LoadU(d, &coast_.breaking_sideways_m[i]), k));
        const V wide_x = hn::Mul(grows, at.height_x), wide_y = hn::Mul(grows, at.height_y);
        const auto gradient = [&](V weight, V* to, V& turn) HWY_ATTR {
            const V c = hn::Mul(hn::Mul(weight, cosine), hn::Mul(k, wide)), s = hn::Mul(weight, sine);
            add(to, Field::Dxx,
                hn::NegMulAdd(hn::Mul(unit_x, unit_x), c, hn::Mul(hn::Mul(unit_x, wide_x), s)));
            add(to, Field::Dyy,
                hn::NegMulAdd(hn::Mul(unit_y, unit_y), c, hn::Mul(hn::Mul(unit_y, wide_y), s)));
            add(to, Field::Dxy,
                hn::NegMulAdd(hn::Mul(unit_x, unit_y), c, hn::Mul(hn::Mul(unit_x, wide_y), s)));
            turn = hn::MulAdd(hn::NegMulAdd(unit_x, wide_y, hn::Mul(unit_y, wide_x)), s, turn);
        };
        const V most = hn::LoadU(d, &coast_.breaking[i]), seen = hn::Min(w, most);
        if (is_shown && wants_.gradient) gradient(w, field_, turn_);
        if (is_shown && wants_.breaking) gradient(seen, breaking_, breaking_turn_);
        if (!wants_.hidden) return;
        const V half = hn::Set(d, T(0.5)), part = hn::Mul(half, unresolved_part(Pack<D>(w)).v);
        const V height2 = hn::Mul(at.height_m, at.height_m);
        const auto slopes = [&](V a, V b, V change_a, V change_b) HWY_ATTR {
            return hn::Mul(part, hn::MulAdd(hn::Mul(a, b), height2, hn::Mul(change_a, change_b)));
        };
        const auto hide = [&](std::size_t m, V value) HWY_ATTR { hidden_[m] = hn::Add(hidden_[m], value); };
        hide(0, slopes(at.kx, at.kx, at.height_x, at.height_x));
        hide(1, slopes(at.kx, at.ky, at.height_x, at.height_y));
        hide(2, slopes(at.ky, at.ky, at.height_y, at.height_y));
        // What isn't resolved at best counts with the waves outside.
        const V kh = hn::Mul(k, wide);
        const V pressed =
            hn::Mul(hn::Mul(half, hn::NegMulAdd(seen, seen, hn::Mul(most, most))), hn::Mul(kh, kh));
        const V xx = hn::Mul(unit_x, unit_x), xy = hn::Mul(unit_x, unit_y), yy = hn::Mul(unit_y, unit_y);
        hide(3, hn::Mul(pressed, hn::Mul(xx, xx)));
        hide(4, hn::Mul(pressed, hn::Mul(xx, xy)));
        hide(5, hn::Mul(pressed, hn::Mul(xx, yy)));
        hide(6, hn::Mul(pressed, hn::Mul(xy, yy)));
        hide(7, hn::Mul(pressed, hn::Mul(yy, yy)));
    }

    PointSums<T> sums() const {
        const D d;
        PointSums<T> out;
        for (std::size_t f = 0; f < kFieldCount; ++f) {
            out.fields[f] = hn::GetLane(hn::SumOfLanes(d, field_[f]));
            out.breaking[f] = hn::GetLane(hn::SumOfLanes(d, breaking_[f]));
        }
        out.turn = hn::GetLane(hn::SumOfLanes(d, turn_));
        out.breaking_turn = hn::GetLane(hn::SumOfLanes(d, breaking_turn_));
        for (std::size_t m = 0; m < out.hidden.size(); ++m)
            out.hidden[m] = hn::GetLane(hn::SumOfLanes(d, hidden_[m]));
        return out;
    }

  private:
    HWY_INLINE V weight(const PointFootprint<T>& of, V k, V unit_x, V unit_y) const {
        const D d;
        if (!(of.width_m > T(0))) return hn::Set(d, T(1));
        const V stretch = hn::MulAdd(hn::Set(d, of.x), unit_x, hn::Mul(hn::Set(d, of.y), unit_y));
        const V along = hn::Sqrt(hn::MulAdd(stretch, stretch, hn::Set(d, of.width_m * of.width_m)));
        const V samples = hn::Div(hn::Set(d, static_cast<T>(kTwoPi)), hn::Mul(k, along));
        return footprint_weight(Pack<D>(samples), Pack<D>(filter_.n_min),
                                Pack<D>(1.0 / (filter_.n_max - filter_.n_min)))
            .v;
    }

    const Coast<T>& coast_;
    const FootprintFilter& filter_;
    const Wants& wants_;
    PointFootprint<T> cell_, pixel_;
    V field_[kFieldCount], breaking_[kFieldCount], turn_, breaking_turn_, hidden_[kUnresolvedMoments.size()];
};

}  // namespace coast_detail

// See add_trains() in core/evaluate/trains.h.
template <class T>
std::size_t AddCoastTrains(const TrainArgs<T>& args, Chunk<T>& chunk) {
    using namespace coast_detail;
    const hn::ScalableTag<T> d;
    using V = hn::Vec<decltype(d)>;
    const std::size_t lanes = hn::Lanes(d);
    const Trains<T>& trains = *args.trains;
    const Coast<T>& coast = *args.coast;
    const std::size_t count = trains.count(), feeling = coast.feeling;
    const auto wants = [&](auto... field) { return (args.wanted[index(field)] || ...); };
    const Wants wanted{.height = wants(Field::Height),
                       .horizontal = wants(Field::Dx, Field::Dy),
                       .drift = wants(Field::VelocityX, Field::VelocityY),
                       .rise = wants(Field::VelocityZ),
                       .slope = wants(Field::SlopeX, Field::SlopeY),
                       .gradient = wants(Field::Dxx, Field::Dyy, Field::Dxy),
                       .breaking = args.breaking != nullptr,
                       .hidden = args.unresolved != nullptr};
    const bool of_cells = wanted.height || wanted.horizontal || wanted.drift || wanted.rise,
               of_pixels = wanted.slope || wanted.gradient || wanted.breaking;
    std::vector<T> cycles(count + 64 / sizeof(T), T(0));
    const auto footprint = [](const T* each, T only, const typename TrainArgs<T>::Stretch& stretch,
                              std::size_t p) {
        return PointFootprint<T>{each ? each[p] : only, stretch.x ? stretch.x[p] : T(0),
                                 stretch.x ? stretch.y[p] : T(0)};
    };
    // The trains of which something passes: sorted by length where they come from; deeper water makes some longer.
    const auto end_of = [&](T footprint_m) {
        const T shortest_m = static_cast<T>(args.filter.n_min) * footprint_m;
        return static_cast<std::size_t>(
            std::partition_point(coast.longest_m.begin(), coast.longest_m.end(),
                                 [&](T longest_m) { return longest_m > shortest_m; }) -
            coast.longest_m.begin());
    };
    std::size_t evaluated = 0;
    for (std::size_t p = 0; p < chunk.count; ++p) {
        const PointFootprint<T> cell = footprint(args.cell_of, args.cell_m, args.cell_stretch, p),
                                pixel = footprint(args.pixel_of, args.pixel_m, args.pixel_stretch, p);
        const double x = static_cast<double>(chunk.rest_x[p]), y = static_cast<double>(chunk.rest_y[p]);
        const CoastTaps<T> taps = CoastTapsOf(coast, args.origin_m + glm::dvec2(x, y));
        const std::size_t shown = std::max(of_cells ? end_of(cell.width_m) : 0,
                                           of_pixels || wanted.hidden ? end_of(pixel.width_m) : 0);
        // What is hidden of those that feel the floor is summed here, of the others looked up.
        const std::size_t end = wanted.hidden ? std::max(shown, feeling) : shown;
        evaluated += end;
        CyclesOf(trains, args.start_cycles, x, y, std::min(shown + lanes, count), cycles);
        CoastPoint<T> point(coast, args.filter, wanted, cell, pixel);
        const std::size_t felt = std::min(feeling, end);
        for (std::size_t i = 0; i < felt; i += lanes) {
            V phase = hn::Zero(d), phase_x = phase, phase_y = phase, gain = phase, gain_x = phase,
              gain_y = phase;
            for (std::size_t t = 0; t < taps.cell.size(); ++t) {
                const std::size_t at = taps.cell[t] * coast.stride + i;
                const V s = hn::LoadU(d, &coast.phase[at]), g = hn::LoadU(d, &coast.gain[at]);
                const V value = hn::Set(d, taps.value[t]), rate_x = hn::Set(d, taps.x[t]),
                        rate_y = hn::Set(d, taps.y[t]);
                phase = hn::MulAdd(value, s, phase);
                phase_x = hn::MulAdd(rate_x, s, phase_x);
                phase_y = hn::MulAdd(rate_y, s, phase_y);
                gain = hn::MulAdd(value, g, gain);
                gain_x = hn::MulAdd(rate_x, g, gain_x);
                gain_y = hn::MulAdd(rate_y, g, gain_y);
            }
            if (taps.beyond_m > T(0)) {
                // As coast_fade(), of each train's own distance.
                const V one = hn::Set(d, T(1)), two = hn::Set(d, T(2)), three = hn::Set(d, T(3)),
                        six = hn::Set(d, T(6)), per_m = hn::LoadU(d, &coast.phase_fade_per_m[i]);
                const V t = hn::Min(hn::Mul(hn::Set(d, taps.beyond_m), per_m), one);
                const V left = hn::NegMulAdd(hn::Mul(t, t), hn::NegMulAdd(two, t, three), one);
                const V rate = hn::Mul(hn::Mul(six, per_m), hn::Mul(t, hn::Sub(t, one)));
                const V phase_rate = hn::Mul(phase, rate);
                phase_x = hn::MulAdd(left, phase_x,
                                     hn::Mul(phase_rate, hn::Set(d, static_cast<T>(taps.outwards.x))));
                phase_y = hn::MulAdd(left, phase_y,
                                     hn::Mul(phase_rate, hn::Set(d, static_cast<T>(taps.outwards.y))));
                phase = hn::Mul(left, phase);
                const V of_map = hn::Set(d, taps.left), more = hn::Sub(gain, one);
                gain_x = hn::MulAdd(of_map, gain_x, hn::Mul(hn::Set(d, taps.left_x), more));
                gain_y = hn::MulAdd(of_map, gain_y, hn::Mul(hn::Set(d, taps.left_y), more));
                gain = hn::MulAdd(of_map, more, one);
            }
            const V height = hn::IfThenElseZero(hn::FirstN(d, felt - i), hn::LoadU(d, &coast.height_m[i])),
                    turns = hn::Set(d, static_cast<T>(kTwoPi));
            const V all = hn::Sub(hn::LoadU(d, &cycles[i]), phase);
            point.add(i,
                      {.cycles = hn::Sub(all, hn::Round(all)),
                       .kx = hn::MulAdd(turns, phase_x, hn::LoadU(d, &coast.kx[i])),
                       .ky = hn::MulAdd(turns, phase_y, hn::LoadU(d, &coast.ky[i])),
                       .height_m = hn::Mul(height, gain),
                       .height_x = hn::Mul(height, gain_x),
                       .height_y = hn::Mul(height, gain_y)},
                      i < shown);
        }
        T gain = T(0), gain_x = T(0), gain_y = T(0);
        for (std::size_t t = 0; t < taps.cell.size(); ++t) {
            const T own = coast.others[taps.cell[t]];
            gain += taps.value[t] * own;
            gain_x += taps.x[t] * own;
            gain_y += taps.y[t] * own;
        }
        if (taps.beyond_m > T(0)) {
            const T more = gain - T(1);
            gain_x = taps.left * gain_x + taps.left_x * more;
            gain_y = taps.left * gain_y + taps.left_y * more;
            gain = T(1) + taps.left * more;
        }
        for (std::size_t i = feeling; i < end; i += lanes) {
            const V height = hn::IfThenElseZero(hn::FirstN(d, end - i), hn::LoadU(d, &coast.height_m[i]));
            point.add(i,
                      {.cycles = hn::LoadU(d, &cycles[i]),
                       .kx = hn::LoadU(d, &coast.kx[i]),
                       .ky = hn::LoadU(d, &coast.ky[i]),
                       .height_m = hn::Mul(height, hn::Set(d, gain)),
                       .height_x = hn::Mul(height, hn::Set(d, gain_x)),
                       .height_y = hn::Mul(height, hn::Set(d, gain_y))},
                      true);
        }
        const PointSums<T> sums = point.sums();
        for (std::size_t f = 0; f < kFieldCount; ++f)
            if (args.wanted[f]) chunk.sums[f][p] += sums.fields[f];
        if (wanted.gradient) chunk.turn[p] += sums.turn;
        if (args.breaking) {
            for (const Field field : {Field::Dxx, Field::Dyy, Field::Dxy})
                args.breaking->sums[index(field)][p] += sums.breaking[index(field)];
            args.breaking->turn[p] += sums.breaking_turn;
        }
        if (args.unresolved) {
            const UnresolvedMoments<T>& beyond = trains.unresolved_from[std::max(end, feeling)];
            for (std::size_t m = 0; m < beyond.size(); ++m)
                args.unresolved->moments[m][p] = sums.hidden[m] + gain * gain * beyond[m];
        }
    }
    return evaluated;
}

}  // namespace HWY_NAMESPACE
}  // namespace pelagic
HWY_AFTER_NAMESPACE();

#endif
