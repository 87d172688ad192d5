#include "core/waves/mode_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/waves/mode_kernels.cpp"
#include <hwy/foreach_target.h>
// foreach_target first: it includes this file once for each instruction set.
#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/constants.h"
#include "core/base/random-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pelagic {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace {  // names are this file's own

using D = hn::ScalableTag<double>;
using V = hn::Vec<D>;

HWY_INLINE V Set(double value) {
    return hn::Set(D(), value);
}

// The first `count` lanes, rounded to T: behind them somebody else's modes may stand.
template <class T>
HWY_INLINE void Store(V value, std::size_t count, T* to) {
    const D d;
    const hn::Rebind<T, D> narrow;
    hn::Vec<decltype(narrow)> rounded;
    if constexpr (sizeof(T) == sizeof(double))
        rounded = value;
    else
        rounded = hn::DemoteTo(narrow, value);
    if (count >= hn::Lanes(d)) {
        hn::StoreU(rounded, narrow, to);
    } else {
        HWY_ALIGN T lanes[kSumLanes];
        hn::Store(rounded, narrow, lanes);
        std::copy(lanes, lanes + count, to);
    }
}

template <class T>
void Amplitudes(const AmplitudeArgs<T>& args) {
    const D d;
    const hn::RebindToUnsigned<D> bits;
    const hn::RebindToSigned<D> whole;
    static_assert(HWY_MAX_BYTES / sizeof(double) <= kSumLanes || HWY_TARGET == HWY_SCALAR);
    const auto cascade = hn::Set(bits, std::uint64_t{args.cascade}), none = hn::Zero(bits);
    const auto mx = hn::Set(whole, std::int64_t{args.mx});
    for (std::size_t i = 0; i < args.count; i += hn::Lanes(d)) {
        const std::size_t left = args.count - i;
        const auto my =
            hn::Iota(whole, static_cast<std::int64_t>(args.first_my) + static_cast<std::int64_t>(i));
        // A mode's counter is (cascade, mx, my, 0), negative numbers wrapped as 32 bits do.
        const auto draw = [&](V energy, auto x, auto y, T* re, T* im, double sign) HWY_ATTR {
            V a = hn::Zero(d), b = hn::Zero(d);
            const auto held = hn::Gt(energy, hn::Zero(d));
            if (!hn::AllFalse(d, held)) {
                NormalPairs(d, args.seed, cascade, hn::BitCast(bits, x), hn::BitCast(bits, y), none, a, b);
                const V scale = hn::IfThenElseZero(held, hn::Mul(Set(0.5), hn::Sqrt(energy)));
                a = hn::Mul(scale, a);
                b = hn::Mul(hn::Mul(scale, Set(sign)), b);
            }
            Store(a, left, re + i);
            Store(b, left, im + i);
        };
        const auto valid = hn::FirstN(d, left);
        draw(hn::IfThenElseZero(valid, hn::LoadU(d, args.energy + i)), mx, my, args.forward_re,
             args.forward_im, 1.0);
        draw(hn::IfThenElseZero(valid, hn::LoadU(d, args.opposite + i)), hn::Neg(mx), hn::Neg(my),
             args.backward_re, args.backward_im, -1.0);
    }
}

struct Mode {
    V k, omega, ratio;  // coth(kd)
};

// As Dispersion has them.
HWY_INLINE Mode ModeAt(const Dispersion& dispersion, int mx, V my, double step) {
    const D d;
    const V k = hn::Mul(Set(step), hn::Sqrt(hn::MulAdd(my, my, Set(static_cast<double>(mx) * mx))));
    V tanh = Set(1.0), ratio = Set(1.0);
    const V kd = hn::Mul(k, Set(std::min(dispersion.depth_m, 1e300)));
    const auto shallow = hn::Lt(kd, Set(Dispersion::kDeep));
    if (!hn::AllFalse(d, shallow)) {
        tanh = hn::IfThenElse(shallow, hn::Tanh(d, hn::Min(kd, Set(Dispersion::kDeep))), tanh);
        ratio = hn::Div(Set(1.0), tanh);
    }
    const V stiffness = hn::Add(Set(kGravity), hn::Mul(hn::Mul(Set(kCapillarity), k), k));
    return {k, hn::Sqrt(hn::Mul(hn::Mul(k, stiffness), tanh)), ratio};
}

template <class T>
void Frequencies(const FrequencyArgs<T>& args) {
    const D d;
    for (std::size_t i = 0; i < args.count; i += hn::Lanes(d)) {
        const V my = hn::Iota(d, static_cast<double>(args.first_my) + static_cast<double>(i));
        const Mode mode = ModeAt(args.dispersion, args.mx, my, args.step);
        V cycles = hn::Div(mode.omega, Set(kTwoPi));
        if (args.loop_s > 0.0) {
            const V in_loop = hn::Floor(hn::Add(hn::Mul(cycles, Set(args.loop_s)), Set(0.5)));
            cycles = hn::Div(hn::Max(Set(1.0), in_loop), Set(args.loop_s));
        }
        // (0, 0) is no wave.
        const auto wave = hn::Gt(mode.k, hn::Zero(d));
        Store(hn::IfThenElseZero(wave, cycles), args.count - i, args.cycles_per_s + i);
        if (!args.chop) continue;
        const V chop = hn::Div(hn::Mul(Set(args.choppiness), mode.ratio), mode.k);
        Store(hn::IfThenElseZero(wave, chop), args.count - i, args.chop + i);
    }
}

void Column(const ColumnArgs& args) {
    const D d;
    for (std::size_t i = 0; i < args.count; i += hn::Lanes(d)) {
        const V my = hn::Iota(d, static_cast<double>(i));
        const Mode mode = ModeAt(args.dispersion, args.mx, my, args.step);
        const auto wave = hn::Gt(mode.k, hn::Zero(d));
        const V same = hn::LoadU(d, args.same + i), opposite = hn::LoadU(d, args.opposite + i);
        // On the axes the mirror image is the mode itself.
        const auto two = hn::Gt(hn::Mul(my, Set(args.mx)), hn::Zero(d));
        const V below = hn::IfThenElseZero(two, hn::LoadU(d, args.below + i));
        const V above = hn::IfThenElseZero(two, hn::LoadU(d, args.above + i));
        const V per_k = hn::IfThenElseZero(wave, hn::Div(Set(1.0), mode.k));
        const V first = hn::Add(same, opposite), second = hn::Add(below, above);
        const V first_net = hn::Sub(same, opposite), second_net = hn::Sub(below, above);
        const V chop = hn::Mul(hn::Mul(Set(args.choppiness), mode.ratio), per_k);
        hn::StoreU(hn::Add(first, second), d, args.out.even + i);
        hn::StoreU(hn::Sub(first, second), d, args.out.odd + i);
        hn::StoreU(hn::Mul(per_k, hn::Add(first_net, second_net)), d, args.out.east + i);
        hn::StoreU(hn::Mul(per_k, hn::Sub(first_net, second_net)), d, args.out.north + i);
        hn::StoreU(per_k, d, args.out.per_k + i);
        hn::StoreU(hn::IfThenElseZero(wave, hn::Div(Set(1.0), mode.omega)), d, args.out.per_omega + i);
        hn::StoreU(hn::IfThenElseZero(wave, hn::Mul(chop, chop)), d, args.out.chop2 + i);
    }
}

void Moments(const MomentArgs& args) {
    const D d;
    V m0 = hn::Zero(d), m_minus1 = m0, y1 = m0, y2 = m0, east = m0, north = m0;
    V s0 = m0, s1 = m0, s2 = m0, s3 = m0, s4 = m0;
    const auto weight = [&](V per_k, double footprint_m) HWY_ATTR {  // FootprintFilter::weight
        const V samples = hn::Mul(Set(kTwoPi / footprint_m), per_k);
        const V x = hn::Mul(hn::Sub(samples, Set(args.filter.n_min)),
                            Set(1.0 / (args.filter.n_max - args.filter.n_min)));
        const V inside = hn::Min(hn::Max(x, hn::Zero(d)), Set(1.0));
        return hn::Mul(hn::Mul(inside, inside), hn::NegMulAdd(Set(2.0), inside, Set(3.0)));
    };
    for (int my = args.first_my; my < args.end_my; my += static_cast<int>(hn::Lanes(d))) {
        const auto valid = hn::FirstN(d, static_cast<std::size_t>(args.end_my - my));
        const V per_k = hn::LoadU(d, args.column.per_k + my);
        V w = hn::IfThenElseZero(valid, Set(1.0));
        if (args.footprint_a > 0.0) w = hn::Mul(w, weight(per_k, args.footprint_a));
        if (args.footprint_b > 0.0) w = hn::Mul(w, weight(per_k, args.footprint_b));
        const V ky = hn::Mul(hn::Iota(d, static_cast<double>(my)), Set(args.step));
        const V even = hn::Mul(w, hn::LoadU(d, args.column.even + my));
        const V odd_y = hn::Mul(hn::Mul(w, hn::LoadU(d, args.column.odd + my)), ky);
        const V chop2 = hn::LoadU(d, args.column.chop2 + my);
        const V ky2 = hn::Mul(ky, ky), gradient = hn::Mul(chop2, even), gradient_y = hn::Mul(chop2, odd_y);
        const V gradient_y2 = hn::Mul(gradient, ky2);
        m0 = hn::Add(m0, even);
        m_minus1 = hn::MulAdd(even, hn::LoadU(d, args.column.per_omega + my), m_minus1);
        y1 = hn::Add(y1, odd_y);
        y2 = hn::MulAdd(even, ky2, y2);
        s0 = hn::Add(s0, gradient);
        s1 = hn::Add(s1, gradient_y);
        s2 = hn::Add(s2, gradient_y2);
        s3 = hn::MulAdd(gradient_y, ky2, s3);
        s4 = hn::MulAdd(gradient_y2, ky2, s4);
        east = hn::MulAdd(w, hn::LoadU(d, args.column.east + my), east);
        north = hn::MulAdd(hn::Mul(w, ky), hn::LoadU(d, args.column.north + my), north);
    }
    const double x = args.mx * args.step;
    std::size_t at = 0;
    const auto add = [&](V sum, double scale) HWY_ATTR {  // in kSpectralMoments' order
        double* lanes = args.sum->data() + kSumLanes * at++;
        hn::StoreU(hn::MulAdd(sum, Set(scale), hn::LoadU(d, lanes)), d, lanes);
    };
    add(m0, 1.0);
    add(m_minus1, 1.0);
    add(m0, x * x);
    add(y1, x);
    add(y2, 1.0);
    add(s0, x * x * x * x);
    add(s1, x * x * x);
    add(s2, x * x);
    add(s3, x);
    add(s4, 1.0);
    add(east, x);
    add(north, 1.0);
}

template <class T>
ModeKernels<T> Table() {
    return {&Amplitudes<T>, &Frequencies<T>, &Column, &Moments};
}
std::pair<ModeKernels<float>, ModeKernels<double>> Tables() {
    return {Table<float>(), Table<double>()};
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace pelagic
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelagic {
HWY_EXPORT(Tables);

template <class T>
ModeKernels<T> mode_kernels() {
    return std::get<ModeKernels<T>>(HWY_DYNAMIC_DISPATCH(Tables)());
}
template ModeKernels<float> mode_kernels();
template ModeKernels<double> mode_kernels();

SpectralMoments sum_of_lanes(const MomentLanes& lanes) {
    SpectralMoments out;
    for (std::size_t m = 0; m < kSpectralMoments.size(); ++m)
        for (std::size_t i = 0; i < kSumLanes; ++i) out.*kSpectralMoments[m] += lanes[kSumLanes * m + i];
    return out;
}

}  // namespace pelagic
#endif
