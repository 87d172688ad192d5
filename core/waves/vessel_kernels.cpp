#include "core/waves/vessel_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/waves/vessel_kernels.cpp"
#include <hwy/foreach_target.h>
// foreach_target comes first: it includes this file once per instruction set.
#include <hwy/highway.h>

#include "core/base/pack-inl.h"
#include "core/base/sincos-inl.h"

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
    const N x(hull.ahead_x), y(hull.ahead_y);
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

// How far a place lies within an edge, in widths of it.
HWY_INLINE N Depth(N from, N half, N per_edge) {
    return (half - magnitude(from)) * per_edge;
}
HWY_INLINE N Within(N depth) {
    return smooth_rise(minimum(maximum(depth, N(0)), N(1)));
}

void Blocks(const BlocksArgs& args) {
    constexpr std::size_t kAhead = 4 * 64 / sizeof(float);
    const N half(args.half_m), per_edge(args.per_edge_m);
    for (std::size_t i = 0; i < args.count; i += hn::Lanes(D())) {
        const N group_x = At(args.group_x, i), group_y = At(args.group_y, i);
        Complex later{N(0), N(0)}, earlier{N(0), N(0)};
        bool any = false;  // the oldest have left
        for (const pelagic::Block& block : args.blocks) {
            if (any) {
                const Complex turn = At(block.turn_re, block.turn_im, i);
                later = turn * later;
                earlier = Conjugate(turn) * earlier;
            }
            const N x(block.from_x), y(block.from_y), age(block.age_s), share(block.share);
            const N east = age * group_x, north = age * group_y;
            // Most of what is old has left the tile: it isn't read.
            const auto add = [&](Complex& sum, N from_x, N from_y, const float* re, const float* im) {
                const N across = Depth(from_x, half, per_edge), up = Depth(from_y, half, per_edge),
                        least = minimum(across, up);
                if (hn::AllFalse(D(), least > N(0))) return;
                any = true;
                // There are more arrays than hardware prefetchers follow.
                __builtin_prefetch(re + i + kAhead);
                __builtin_prefetch(im + i + kAhead);
                const N weight =
                    hn::AllFalse(D(), least < N(1)) ? share : share * Within(across) * Within(up);
                sum = sum + weight * (At(block.place, i) * At(re, im, i));
            };
            // e^{i(k·x + ωt)} goes against k.
            add(later, x - east, y - north, block.later_re, block.later_im);
            add(earlier, x + east, y + north, block.earlier_re, block.earlier_im);
        }
        Put(later, args.later_re, args.later_im, i);
        Put(earlier, args.earlier_re, args.earlier_im, i);
    }
}

void Turn(const TurnArgs& args) {
    const hn::ScalableTag<double> wide;
    const hn::Rebind<float, decltype(wide)> narrow;
    const auto duration = hn::Set(wide, args.duration_s);
    for (std::size_t i = 0; i < args.count; i += hn::Lanes(wide)) {
        const auto cycles = hn::DemoteTo(narrow, hn::Mul(duration, hn::LoadU(wide, args.cycles_per_s + i)));
        hn::Vec<decltype(narrow)> sine, cosine;
        SinCosCycles(narrow, cycles, sine, cosine);
        hn::StoreU(cosine, narrow, args.cosine + i);
        hn::StoreU(sine, narrow, args.sine + i);
    }
}

VesselKernels Table() {
    return {.stretch = Stretch, .lift = Lift, .blocks = Blocks, .turn = Turn};
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
