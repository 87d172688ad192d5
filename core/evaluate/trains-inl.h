// The trains' fields at a chunk's points, in Highway's vectors: Bruneton, Neyret, Holzschuch 2010, Eqs. 2 and 3, and
// the unresolved variances of Eq. 4 (§7.1). Formulas and signs: core/waves/trains.h.
//
// Included once per instruction set by files that use Highway's foreach_target (its own pattern of guards).
#if defined(PELAGIC_CORE_EVALUATE_TRAINS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PELAGIC_CORE_EVALUATE_TRAINS_INL_H_
#undef PELAGIC_CORE_EVALUATE_TRAINS_INL_H_
#else
#define PELAGIC_CORE_EVALUATE_TRAINS_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <type_traits>

#include "core/base/pack-inl.h"
#include "core/base/sincos-inl.h"
#include "core/evaluate/trains.h"

HWY_BEFORE_NAMESPACE();
namespace pelagic {
namespace HWY_NAMESPACE {
namespace trains_detail {
namespace hn = hwy::HWY_NAMESPACE;

#include "core/plan/filter.inl"
#include "core/waves/trains.inl"

// A vector of points, kept in double to form phases with.
template <class Wide>
struct DoublePoints {
    hn::Vec<Wide> x, y;

    // (start − κ·x) of one train, reduced.
    HWY_INLINE hn::Vec<Wide> cycles(Wide d, double start, double kx, double ky) const {
        const auto all =
            hn::NegMulAdd(hn::Set(d, ky), y, hn::NegMulAdd(hn::Set(d, kx), x, hn::Set(d, start)));
        return hn::Sub(all, hn::Round(all));
    }
};

// The phases of T's points: reduced in double, then rounded to T.
template <class D, class Enable = void>
class Phases {  // single: two vectors of double to one of T
    using Half = hn::Half<D>;
    using Wide = hn::Rebind<double, Half>;

  public:
    HWY_INLINE Phases(D, hn::Vec<D> x, hn::Vec<D> y)
        : low_{hn::PromoteTo(Wide(), hn::LowerHalf(Half(), x)),
               hn::PromoteTo(Wide(), hn::LowerHalf(Half(), y))}
#if HWY_TARGET != HWY_SCALAR
          ,
          high_{hn::PromoteTo(Wide(), hn::UpperHalf(Half(), x)),
                hn::PromoteTo(Wide(), hn::UpperHalf(Half(), y))}
#endif
    {
    }
    HWY_INLINE hn::Vec<D> operator()(double start, double kx, double ky) const {
        const auto low = hn::DemoteTo(Half(), low_.cycles(Wide(), start, kx, ky));
#if HWY_TARGET == HWY_SCALAR
        return low;  // a vector of one point has no upper half
#else
        return hn::Combine(D(), hn::DemoteTo(Half(), high_.cycles(Wide(), start, kx, ky)), low);
#endif
    }

  private:
    DoublePoints<Wide> low_;
#if HWY_TARGET != HWY_SCALAR
    DoublePoints<Wide> high_;
#endif
};

template <class D>
class Phases<D, std::enable_if_t<sizeof(hn::TFromD<D>) == 8>> {
  public:
    HWY_INLINE Phases(D, hn::Vec<D> x, hn::Vec<D> y) : points_{x, y} {}
    HWY_INLINE hn::Vec<D> operator()(double start, double kx, double ky) const {
        return points_.cycles(D(), start, kx, ky);
    }

  private:
    DoublePoints<D> points_;
};

// Which trains pass a footprint: [0, full) for every point of a vector whole, from `any` on for none.
// Neighbouring vectors differ by a train or so: the search starts where the last one ended.
template <class T>
class Zone {
  public:
    Zone(const Trains<T>& trains, const FootprintFilter& filter)
        : wavelength_(trains.wavelength.data()),
          count_(trains.count()),
          // Footprints that let a wave pass whole or not at all, over its wavelength.
          whole_(static_cast<T>(1.0 / filter.n_max)),
          none_(static_cast<T>(1.0 / filter.n_min)),
          n_min_(static_cast<T>(filter.n_min)),
          per_range_(static_cast<T>(1.0 / (filter.n_max - filter.n_min))) {}

    std::size_t full() const { return full_; }
    std::size_t any() const { return any_; }

    void move_to(T smallest_m, T largest_m) {
        walk(full_, [&](std::size_t i) { return largest_m <= wavelength_[i] * whole_; });
        walk(any_, [&](std::size_t i) { return smallest_m < wavelength_[i] * none_; });
    }
    // The first train of which nothing passes, near a guess.
    std::size_t end_of(T footprint_m, std::size_t guess) const {
        walk(guess, [&](std::size_t i) { return footprint_m < wavelength_[i] * none_; });
        return guess;
    }

    // The weight of train i. Exactly 1 and 0 outside the blend, whatever rounding does to the cubic, so that
    // a point doesn't depend on its neighbours in the vector.
    template <class D, class V = hn::Vec<D>>
    HWY_INLINE V weight(D d, std::size_t i, V footprint_m) const {
        const V one = hn::Set(d, T(1));
        const Pack<D> samples(hn::Div(hn::Set(d, wavelength_[i]), footprint_m));
        const V smooth = footprint_weight(samples, Pack<D>(n_min_), Pack<D>(per_range_)).v;
        const V between = hn::IfThenElse(hn::Le(footprint_m, hn::Set(d, wavelength_[i] * whole_)), one,
                                         hn::Min(smooth, one));
        return hn::IfThenElseZero(passes(d, i, footprint_m), between);
    }
    template <class D, class V = hn::Vec<D>>
    HWY_INLINE hn::Mask<D> passes(D d, std::size_t i, V footprint_m) const {
        return hn::Lt(footprint_m, hn::Set(d, wavelength_[i] * none_));
    }

  private:
    template <class Passes>
    void walk(std::size_t& i, Passes&& passes_whole) const {
        while (i < count_ && passes_whole(i)) ++i;
        while (i > 0 && !passes_whole(i - 1)) --i;
    }

    const T* wavelength_;
    std::size_t count_;
    T whole_, none_, n_min_, per_range_;
    std::size_t full_ = 0, any_ = 0;
};

// The footprints of a vector's points.
template <class D>
struct Ellipses {
    hn::Vec<D> width_m, x, y;  // x, y: TrainArgs::Stretch
    bool are_round;

    // How long they are along a train's way. A round one stays what it is, to the bit.
    template <class T = hn::TFromD<D>>
    HWY_INLINE hn::Vec<D> along(D d, const Trains<T>& trains, std::size_t i) const {
        if (are_round) return width_m;
        const T unit_x = static_cast<T>(trains.kx_cycles_per_m[i] * trains.wavelength_m[i]),
                unit_y = static_cast<T>(trains.ky_cycles_per_m[i] * trains.wavelength_m[i]);
        const auto stretch = hn::MulAdd(x, hn::Set(d, unit_x), hn::Mul(y, hn::Set(d, unit_y)));
        const auto length = hn::Sqrt(hn::MulAdd(stretch, stretch, hn::Mul(width_m, width_m)));
        return hn::IfThenElse(hn::Eq(stretch, hn::Zero(d)), width_m, length);
    }
    HWY_INLINE hn::Vec<D> longest() const {
        return are_round ? width_m : hn::Sqrt(hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(width_m, width_m))));
    }
    template <class T>
    HWY_INLINE void move(Zone<T>& zone) const {
        const D d;
        zone.move_to(hn::GetLane(hn::MinOfLanes(d, width_m)), hn::GetLane(hn::MaxOfLanes(d, longest())));
    }
};

// Those of a chunk's points in `valid`, from `base` on; without any of their own all have the same.
template <class T, class D, class Valid>
HWY_INLINE Ellipses<D> EllipsesOf(D d, const T* of, T uniform_m,
                                  const typename TrainArgs<T>::Stretch& stretch, std::size_t base,
                                  Valid valid) {
    const auto footprint = [&](const T* each, T only) {
        return each ? hn::IfThenElse(valid, hn::LoadU(d, each + base), hn::Set(d, each[base]))
                    : hn::Set(d, only);
    };
    return {footprint(of, uniform_m), footprint(stretch.x, T(0)), footprint(stretch.y, T(0)), !stretch.x};
}

// What the footprints leave unresolved, for the points of one vector. Each point's trains beyond its own end come as
// one sum, looked up, and those of the blend one by one.
template <class T, class D, class V = hn::Vec<D>>
HWY_INLINE void UnresolvedOf(D d, const Trains<T>& trains, const Zone<T>& zone, const Ellipses<D>& footprints,
                             UnresolvedChunk<T>& unresolved, std::size_t base) {
    const V footprint_m = footprints.width_m;
    V sum[kUnresolvedMoments.size()];
    const std::size_t longest_end = zone.end_of(hn::GetLane(hn::MaxOfLanes(d, footprint_m)), zone.any());
    if (longest_end == zone.any()) {  // the usual case, and cheaper: all points end with the same train
        for (std::size_t m = 0; m < kUnresolvedMoments.size(); ++m)
            sum[m] = hn::Set(d, trains.unresolved_from[zone.any()][m]);
    } else {
        HWY_ALIGN T each_m[hn::MaxLanes(d)];
        hn::Store(footprint_m, d, each_m);
        HWY_ALIGN T looked_up[kUnresolvedMoments.size()][hn::MaxLanes(d)];
        std::size_t end = zone.any();
        for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) {
            end = zone.end_of(each_m[lane], end);
            for (std::size_t m = 0; m < kUnresolvedMoments.size(); ++m)
                looked_up[m][lane] = trains.unresolved_from[end][m];
        }
        for (std::size_t m = 0; m < kUnresolvedMoments.size(); ++m) sum[m] = hn::LoadU(d, looked_up[m]);
    }
    for (std::size_t i = zone.full(); i < zone.any(); ++i) {
        const V w = zone.weight(d, i, footprints.along(d, trains, i));
        // The displacement gradient counts relative to what is resolved of it at best; the rest is in the sum of the
        // waves outside.
        const V most = hn::Set(d, trains.breaking[i]);
        const V gradient_weight = hn::IfThenElse(hn::Gt(most, w), hn::Div(w, most), hn::Set(d, T(1)));
        // Else it is in the looked-up sum.
        const auto blends = zone.passes(d, i, footprint_m);
        const V part = hn::IfThenElseZero(blends, unresolved_part(Pack<D>(w)).v),
                gradient_part = hn::IfThenElseZero(blends, unresolved_part(Pack<D>(gradient_weight)).v);
        for (std::size_t m = 0; m < kUnresolvedMoments.size(); ++m)
            sum[m] = hn::MulAdd(m < kUnresolvedSlopes ? part : gradient_part,
                                hn::Set(d, trains.unresolved_alone[i][m]), sum[m]);
    }
    for (std::size_t m = 0; m < kUnresolvedMoments.size(); ++m)
        hn::Store(sum[m], d, &unresolved.moments[m][base]);
}

}  // namespace trains_detail

// See add_trains() in core/evaluate/trains.h.
template <class T>
std::size_t AddTrains(const TrainArgs<T>& args, Chunk<T>& chunk) {
    using namespace trains_detail;
    const hn::ScalableTag<T> d;
    using V = hn::Vec<decltype(d)>;
    const std::size_t lanes = hn::Lanes(d);
    const Trains<T>& trains = *args.trains;

    // Fields that share a weight and a product are taken together.
    const auto wants = [&](auto... field) { return (args.wanted[index(field)] || ...); };
    const bool height = wants(Field::Height), horizontal = wants(Field::Dx, Field::Dy);
    const bool rise = wants(Field::VelocityZ), drift = wants(Field::VelocityX, Field::VelocityY);
    const bool slope = wants(Field::SlopeX, Field::SlopeY),
               gradient = wants(Field::Dxx, Field::Dyy, Field::Dxy);
    const bool grows = !trains.growth[0].empty();
    const bool cell_wanted = height || horizontal || rise || drift,
               pixel_wanted = slope || gradient || args.breaking;

    Zone<T> cell(trains, args.filter), pixel(trains, args.filter);
    std::size_t evaluated = 0;
    for (std::size_t base = 0; base < chunk.count; base += lanes) {
        const std::size_t points = std::min(lanes, chunk.count - base);
        const auto valid = hn::FirstN(d, points);
        const auto cells = EllipsesOf<T>(d, args.cell_of, args.cell_m, args.cell_stretch, base, valid),
                   pixels = EllipsesOf<T>(d, args.pixel_of, args.pixel_m, args.pixel_stretch, base, valid);
        if (cell_wanted) cells.move(cell);
        if (pixel_wanted || args.unresolved) pixels.move(pixel);
        if (args.unresolved) UnresolvedOf(d, trains, pixel, pixels, *args.unresolved, base);

        const std::size_t cell_end = cell_wanted ? cell.any() : 0, pixel_end = pixel_wanted ? pixel.any() : 0;
        const std::size_t end = std::max(cell_end, pixel_end);
        if (end == 0) continue;
        evaluated += end * points;

        const Phases<decltype(d)> phases(d, hn::Load(d, &chunk.rest_x[base]),
                                         hn::Load(d, &chunk.rest_y[base]));
        V sum[kFieldCount], breaking[kFieldCount];
        for (std::size_t f = 0; f < kFieldCount; ++f) sum[f] = breaking[f] = hn::Zero(d);
        for (std::size_t i = 0; i < end; ++i) {
            V sine, cosine;
            SinCosCycles(d,
                         phases(args.start_cycles[i], trains.kx_cycles_per_m[i], trains.ky_cycles_per_m[i]),
                         sine, cosine);
            const auto add = [&](V* to, V wave, auto... field) {
                ((to[index(field)] =
                      hn::MulAdd(hn::Set(d, trains.amplitude[index(field)][i]), wave, to[index(field)])),
                 ...);
            };
            const auto weigh = [&](V weight, V& s, V& c) {
                s = hn::Mul(weight, s);
                c = hn::Mul(weight, c);
            };
            if (i < cell_end) {
                V s = sine, c = cosine;
                if (i >= cell.full()) weigh(cell.weight(d, i, cells.along(d, trains, i)), s, c);
                if (height) add(sum, c, Field::Height);
                if (horizontal) add(sum, s, Field::Dx, Field::Dy);
                if (drift) add(sum, c, Field::VelocityX, Field::VelocityY);
                if (rise) add(sum, s, Field::VelocityZ);
                if (grows) {
                    const auto grow = [&](Field field, std::size_t axis, V wave) HWY_ATTR {
                        sum[index(field)] =
                            hn::MulAdd(hn::Set(d, trains.growth[axis][i]), wave, sum[index(field)]);
                    };
                    grow(Field::VelocityX, 0, s);
                    grow(Field::VelocityY, 1, s);
                    grow(Field::VelocityZ, 2, c);
                }
            }
            if (i < pixel_end) {
                V s = sine, c = cosine, most = hn::Set(d, trains.breaking[i]);
                if (i >= pixel.full()) {
                    const V w = pixel.weight(d, i, pixels.along(d, trains, i));
                    weigh(w, s, c);
                    most = hn::Min(w, most);
                }
                if (args.breaking) add(breaking, hn::Mul(most, cosine), Field::Dxx, Field::Dyy, Field::Dxy);
                if (slope) add(sum, s, Field::SlopeX, Field::SlopeY);
                if (gradient) add(sum, c, Field::Dxx, Field::Dyy, Field::Dxy);
            }
        }
        const auto store = [&](V value, T* to) { hn::Store(hn::Add(hn::Load(d, to), value), d, to); };
        for (std::size_t f = 0; f < kFieldCount; ++f)
            if (args.wanted[f]) store(sum[f], &chunk.sums[f][base]);
        for (const Field field : {Field::Dxx, Field::Dyy, Field::Dxy})
            if (args.breaking) store(breaking[index(field)], &args.breaking->sums[index(field)][base]);
    }
    return evaluated;
}

}  // namespace HWY_NAMESPACE
}  // namespace pelagic
HWY_AFTER_NAMESPACE();

#endif
