#include "core/waves/vessel_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/waves/vessel_kernels.cpp"
#include <hwy/foreach_target.h>
// foreach_target comes first: it includes this file once per instruction set.
#include <hwy/highway.h>

#include "core/base/pack-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pelagic {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace {  // local to this file

#include "core/plan/filter.inl"

using D = hn::ScalableTag<float>;
using N = Pack<D>;

HWY_INLINE N At(const float* from, std::size_t i) {
    return hn::LoadU(D(), from + i);
}

struct Complex {
    N re, im;
    friend HWY_INLINE Complex operator*(Complex a, Complex b) {
        return {hn::NegMulAdd(a.im.v, b.im.v, (a.re * b.re).v), hn::MulAdd(a.im.v, b.re.v, (a.re * b.im).v)};
    }
    friend HWY_INLINE Complex operator*(N a, Complex b) { return {a * b.re, a * b.im}; }
    friend HWY_INLINE Complex operator+(Complex a, Complex b) { return {a.re + b.re, a.im + b.im}; }
};
HWY_INLINE Complex At(const float* re, const float* im, std::size_t i) {
    return {At(re, i), At(im, i)};
}
HWY_INLINE Complex At(const PlanePhase& phase, std::size_t i) {
    return Complex{N(phase.x_re), N(phase.x_im)} * At(phase.y_re, phase.y_im, i);
}
HWY_INLINE void Put(Complex value, float* re, float* im, std::size_t i) {
    hn::StoreU(value.re.v, D(), re + i);
    hn::StoreU(value.im.v, D(), im + i);
}
HWY_INLINE bool IsZero(N a) {
    return hn::AllTrue(D(), hn::Eq(a.v, hn::Zero(D())));
}
HWY_INLINE Complex Conjugate(Complex a) {
    return {a.re, -a.im};
}

// sin q/q, of which the sine is known.
HWY_INLINE N Sinc(N q, N sine) {
    const auto is_small = magnitude(q) < N(0.05);
    return select(is_small, N(1) - q * q * N(1.0 / 6.0), sine / select(is_small, N(1), q));
}

// 3 (sin u − u cos u)/u³, the transform of a parabola; 1 at 0.
HWY_INLINE N Parabola(N u, Complex turn) {
    const N square = u * u;
    const auto is_small = magnitude(u) < N(1);
    const N series =
        N(1) + square * (N(-1.0 / 10.0) + square * (N(1.0 / 280.0) + square * (N(-1.0 / 15120.0) +
                                                                               square * N(1.0 / 1330560.0))));
    const N far = select(is_small, N(1), u);
    return select(is_small, series, N(3) * (turn.im - u * turn.re) / (far * far * far));
}

HWY_INLINE N Displaced(const HullArgs& hull, N kx, N ky, std::size_t i) {
    const N x(hull.along_x), y(hull.along_y);
    return At(hull.depth, i) * Parabola((kx * x + ky * y) * N(hull.half_length_m), At(hull.bow, i)) *
           Parabola((ky * x - kx * y) * N(hull.half_beam_m), At(hull.board, i));
}

void Stretch(const StretchArgs& args) {
    const N kx(args.kx), ux(args.ux), uy(args.uy), half(args.half_s);
    for (std::size_t i = 0; i < args.count; i += hn::Lanes(D())) {
        const N ky = At(args.ky, i), ku = kx * ux + ky * uy, omega = At(args.omega, i);
        const Complex half_turn = At(args.cosine, args.sine, i), turn = half_turn * half_turn,
                      way = At(args.half_way, i), lift = At(args.place, i);
        const N both = way.im * half_turn.re, beside = way.re * half_turn.im;
        const N hull = half * ku * Displaced(args.hull, kx, ky, i);  // half of it to either sum
        const Complex made{lift.im, -lift.re};
        Put(turn * At(args.later_re, args.later_im, i) +
                (hull * Sinc((ku + omega) * half, both + beside)) * (half_turn * made),
            args.later_re, args.later_im, i);
        Put(Conjugate(turn) * At(args.earlier_re, args.earlier_im, i) +
                (hull * Sinc((ku - omega) * half, both - beside)) * (Conjugate(half_turn) * made),
            args.earlier_re, args.earlier_im, i);
    }
}

void Lift(const LiftArgs& args) {
    const N kx(args.kx), ux(args.ux), uy(args.uy);
    for (std::size_t i = 0; i < args.count; i += hn::Lanes(D())) {
        const N ky = At(args.ky, i);
        const Complex place = At(args.place, i);
        const N hull = (kx * ux + ky * uy) * Displaced(args.hull, kx, ky, i);
        Put(At(args.re, args.im, i) + hull * Complex{place.im, -place.re}, args.re, args.im, i);
    }
}

HWY_INLINE N Within(N from, N half, N per_edge) {
    return smooth_rise(minimum(maximum((half - magnitude(from)) * per_edge, N(0)), N(1)));
}

void Block(const BlockArgs& args) {
    const N x(args.from_x), y(args.from_y), age(args.age_s), share(args.share), half(args.half_m),
        per_edge(args.per_edge_m);
    for (std::size_t i = 0; i < args.count; i += hn::Lanes(D())) {
        const Complex turn = At(args.turn_re, args.turn_im, i);
        const N east = age * At(args.group_x, i), north = age * At(args.group_y, i);
        // e^{i(k·x + ωt)} goes against k.
        const N later = share * Within(x - east, half, per_edge) * Within(y - north, half, per_edge),
                earlier = share * Within(x + east, half, per_edge) * Within(y + north, half, per_edge);
        const auto add = [&](Complex sum, N weight, const float* re, const float* im) {
            // Most of what is old has left the tile: it isn't read.
            return IsZero(weight) ? sum : sum + weight * (At(args.place, i) * At(re, im, i));
        };
        Put(add(turn * At(args.later_re, args.later_im, i), later, args.of_later_re, args.of_later_im),
            args.later_re, args.later_im, i);
        Put(add(Conjugate(turn) * At(args.earlier_re, args.earlier_im, i), earlier, args.of_earlier_re,
                args.of_earlier_im),
            args.earlier_re, args.earlier_im, i);
    }
}

VesselKernels Table() {
    return {.stretch = Stretch, .lift = Lift, .block = Block};
}

}  // namespace
VesselKernels VesselTable() {
    return Table();
}
}  // namespace HWY_NAMESPACE
}  // namespace pelagic
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelagic {

HWY_EXPORT(VesselTable);

VesselKernels vessel_kernels() {
    return HWY_DYNAMIC_DISPATCH(VesselTable)();
}

}  // namespace pelagic
#endif
