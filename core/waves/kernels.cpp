#include "core/waves/kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/waves/kernels.cpp"
#include <hwy/foreach_target.h>
// foreach_target comes first: it includes this file once per instruction set.
#include <hwy/highway.h>

#include <cstring>
#include <utility>

#include "core/base/pack-inl.h"
#include "core/base/sincos-inl.h"
#include "core/waves/transform.h"

HWY_BEFORE_NAMESPACE();
namespace pelagic {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace {  // local to this file

#include "core/plan/filter.inl"

// ωt in cycles, reduced in double before it is rounded to T: as exact after ten weeks as at 0 (at any time
// where the CPU has a fused multiply-add). Also ω.
template <class D, class V = hn::Vec<D>>
HWY_INLINE void PhaseAndOmega(D d, const double* cycles_per_s, double time_s, V& phase, V& omega) {
    if constexpr (sizeof(hn::TFromD<D>) == sizeof(double)) {
        const V cycles = hn::LoadU(d, cycles_per_s), time = hn::Set(d, time_s);
        phase = hn::MulSub(cycles, time, hn::Round(hn::Mul(cycles, time)));
        omega = hn::Mul(cycles, hn::Set(d, kTwoPi));
    } else {
        const hn::Half<D> half;
        const hn::Repartition<double, D> wide;
        const auto time = hn::Set(wide, time_s), two_pi = hn::Set(wide, kTwoPi);
        const auto low = hn::LoadU(wide, cycles_per_s);
        const auto high = hn::LoadU(wide, cycles_per_s + hn::Lanes(wide));
        const auto high_rest = hn::MulSub(high, time, hn::Round(hn::Mul(high, time)));
        const auto low_rest = hn::MulSub(low, time, hn::Round(hn::Mul(low, time)));
        phase = hn::Combine(d, hn::DemoteTo(half, high_rest), hn::DemoteTo(half, low_rest));
        omega = hn::Combine(d, hn::DemoteTo(half, hn::Mul(high, two_pi)),
                            hn::DemoteTo(half, hn::Mul(low, two_pi)));
    }
}

template <class T>
void Advance(const AdvanceArgs<T>& args) {
    const hn::ScalableTag<T> d;
    for (std::size_t i = 0; i < args.count; i += hn::Lanes(d)) {
        hn::Vec<decltype(d)> phase, omega, sine, cosine;
        PhaseAndOmega(d, args.cycles_per_s + i, args.time_s, phase, omega);
        SinCosCycles(d, phase, sine, cosine);
        const auto fr = hn::LoadU(d, args.forward_re + i), fi = hn::LoadU(d, args.forward_im + i);
        const auto br = hn::LoadU(d, args.backward_re + i), bi = hn::LoadU(d, args.backward_im + i);
        const auto going_re = hn::MulAdd(fr, cosine, hn::Mul(fi, sine));
        const auto going_im = hn::NegMulAdd(fr, sine, hn::Mul(fi, cosine));
        const auto coming_re = hn::NegMulAdd(bi, sine, hn::Mul(br, cosine));
        const auto coming_im = hn::MulAdd(br, sine, hn::Mul(bi, cosine));
        hn::StoreU(hn::Add(going_re, coming_re), d, args.height_re + i);
        hn::StoreU(hn::Add(going_im, coming_im), d, args.height_im + i);
        if (args.rate_re) {  // iω (backward part − forward part)
            hn::StoreU(hn::Mul(omega, hn::Sub(going_im, coming_im)), d, args.rate_re + i);
            hn::StoreU(hn::Mul(omega, hn::Sub(coming_re, going_re)), d, args.rate_im + i);
        }
    }
}

// FootprintFilter::weight (core/plan/filter.h) for waves given by k².
template <class D, class V = hn::Vec<D>>
HWY_INLINE V Weight(D d, V k2, double footprint_m, double n_min, double n_max) {
    using T = hn::TFromD<D>;
    const V samples = hn::Div(hn::Set(d, static_cast<T>(kTwoPi / footprint_m)), hn::Sqrt(k2));
    return footprint_weight(Pack<D>(samples), Pack<D>(n_min), Pack<D>(1.0 / (n_max - n_min))).v;
}

template <class T>
void Through(const ThroughArgs<T>& args) {
    const hn::ScalableTag<T> d;
    const auto kx2 = hn::Set(d, args.kx * args.kx), step = hn::Set(d, args.step);
    for (int my = -args.half_height; my <= args.half_height; my += static_cast<int>(hn::Lanes(d))) {
        auto through = hn::Set(d, args.prefilter_x);
        if (args.footprint_m > 0.0) {
            const auto ky = hn::Mul(hn::Iota(d, static_cast<T>(my)), step);
            through = hn::Mul(through,
                              Weight(d, hn::MulAdd(ky, ky, kx2), args.footprint_m, args.n_min, args.n_max));
        }
        if (args.prefilter) through = hn::Mul(through, hn::LoadU(d, args.prefilter + my));
        hn::StoreU(through, d, args.through + my);
        if (args.chop) hn::StoreU(hn::Mul(through, hn::LoadU(d, args.chop + my)), d, args.chop_through + my);
    }
}

// A field's factor on h(k,t), or on ∂h/∂t for velocities: sign · chop · kx^a · ky^b, times i for odd
// derivatives. Tessendorf 2001, Eqs. 19, 20, 29 and their derivatives. D has +i, which sharpens the crests;
// his printed −i flattens them.
struct Factor {
    bool of_rate, choppy, imaginary;
    int kx_power, ky_power;
    double sign;
};

HWY_INLINE Factor FactorOf(Field field) {
    switch (field) {
        case Field::Height:
            return {false, false, false, 0, 0, 1.0};
        case Field::Dx:
            return {false, true, true, 1, 0, 1.0};
        case Field::Dy:
            return {false, true, true, 0, 1, 1.0};
        case Field::SlopeX:
            return {false, false, true, 1, 0, 1.0};
        case Field::SlopeY:
            return {false, false, true, 0, 1, 1.0};
        case Field::Dxx:
            return {false, true, false, 2, 0, -1.0};
        case Field::Dyy:
            return {false, true, false, 0, 2, -1.0};
        case Field::Dxy:
            return {false, true, false, 1, 1, -1.0};
        case Field::VelocityX:
            return {true, true, true, 1, 0, 1.0};
        case Field::VelocityY:
            return {true, true, true, 0, 1, 1.0};
        case Field::VelocityZ:
            return {true, false, false, 0, 0, 1.0};
    }
    return {};
}

template <int kKyPower, bool kImaginary, class T>
HWY_INLINE void Segment(const LineArgs<T>& args, const Factor& factor, int first_my, int count, T* out_re,
                        T* out_im) {
    const hn::ScalableTag<T> d;
    const T* re = (factor.of_rate ? args.rate_re : args.height_re) + first_my;
    const T* im = (factor.of_rate ? args.rate_im : args.height_im) + first_my;
    const T* through = (factor.choppy ? args.chop_through : args.through) + first_my;
    T column = static_cast<T>(factor.sign);
    for (int i = 0; i < factor.kx_power; ++i) column *= args.kx;
    const auto scale = hn::Set(d, column), step = hn::Set(d, args.step);
    for (int i = 0; i < count; i += static_cast<int>(hn::Lanes(d))) {
        auto by = hn::Mul(scale, hn::LoadU(d, through + i));
        if constexpr (kKyPower > 0) {
            const auto ky = hn::Mul(hn::Iota(d, static_cast<T>(first_my + i)), step);
            by = hn::Mul(by, ky);
            if constexpr (kKyPower > 1) by = hn::Mul(by, ky);
        }
        const auto a = hn::Mul(by, hn::LoadU(d, re + i)), b = hn::Mul(by, hn::LoadU(d, im + i));
        hn::StoreU(kImaginary ? hn::Neg(b) : a, d, out_re + i);
        hn::StoreU(kImaginary ? a : b, d, out_im + i);
    }
}

template <int kKyPower, bool kImaginary, class T>
HWY_INLINE void LineOf(const LineArgs<T>& args, const Factor& factor) {
    const int h = args.half_height;
    const std::size_t gap = static_cast<std::size_t>(args.n - 2 * h - 1) * sizeof(T);
    // In this order: vector stores may run past the end of one segment into the next.
    Segment<kKyPower, kImaginary>(args, factor, 0, h + 1, args.line_re, args.line_im);
    std::memset(args.line_re + h + 1, 0, gap);
    std::memset(args.line_im + h + 1, 0, gap);
    Segment<kKyPower, kImaginary>(args, factor, -h, h, args.line_re + args.n - h, args.line_im + args.n - h);
}

template <class T>
void Line(const LineArgs<T>& args) {
    const Factor factor = FactorOf(args.field);
    if (factor.ky_power == 0)
        factor.imaginary ? LineOf<0, true>(args, factor) : LineOf<0, false>(args, factor);
    else if (factor.ky_power == 1)
        factor.imaginary ? LineOf<1, true>(args, factor) : LineOf<1, false>(args, factor);
    else
        LineOf<2, false>(args, factor);
}

// Transposes a block of 16 × 16 bytes: 4 × 4 floats or 2 × 2 doubles.
HWY_INLINE void Turn(const float* from, std::size_t from_stride, float* to, std::size_t to_stride) {
    const hn::Full128<float> d;
    const hn::Full128<double> pairs;
    const auto a = hn::LoadU(d, from), b = hn::LoadU(d, from + from_stride);
    const auto c = hn::LoadU(d, from + 2 * from_stride), e = hn::LoadU(d, from + 3 * from_stride);
    const auto ab_low = hn::BitCast(pairs, hn::InterleaveLower(d, a, b));
    const auto ab_high = hn::BitCast(pairs, hn::InterleaveUpper(d, a, b));
    const auto ce_low = hn::BitCast(pairs, hn::InterleaveLower(d, c, e));
    const auto ce_high = hn::BitCast(pairs, hn::InterleaveUpper(d, c, e));
    hn::StoreU(hn::BitCast(d, hn::InterleaveLower(pairs, ab_low, ce_low)), d, to);
    hn::StoreU(hn::BitCast(d, hn::InterleaveUpper(pairs, ab_low, ce_low)), d, to + to_stride);
    hn::StoreU(hn::BitCast(d, hn::InterleaveLower(pairs, ab_high, ce_high)), d, to + 2 * to_stride);
    hn::StoreU(hn::BitCast(d, hn::InterleaveUpper(pairs, ab_high, ce_high)), d, to + 3 * to_stride);
}
HWY_INLINE void Turn(const double* from, std::size_t from_stride, double* to, std::size_t to_stride) {
    const hn::Full128<double> d;
    const auto a = hn::LoadU(d, from), b = hn::LoadU(d, from + from_stride);
    hn::StoreU(hn::InterleaveLower(d, a, b), d, to);
    hn::StoreU(hn::InterleaveUpper(d, a, b), d, to + to_stride);
}

template <class T>
void Scatter(const ScatterArgs<T>& args) {
    constexpr int kSide = 16 / sizeof(T), kAhead = 32;
    const std::size_t stride = line_stride<T>(args.n), from_stride = 2 * stride;
    for (int part = 0; part < 2; ++part) {
        const T* from = args.lines + part * stride;
        T* to = args.rows + part * (stride / 2) + args.first_column;
        int row = args.first_row;
        for (; row + kSide <= args.end_row; row += kSide) {
            // Each row lies in another page, beyond which hardware prefetchers don't look.
            for (int i = 0; i < kSide; ++i) __builtin_prefetch(to + (row + kAhead + i) * stride, 1);
            int column = 0;
            for (; column + kSide <= args.columns; column += kSide)
                Turn(from + column * from_stride + row, from_stride, to + row * stride + column, stride);
            for (; column < args.columns; ++column)
                for (int i = row; i < row + kSide; ++i)
                    to[i * stride + column] = from[column * from_stride + i];
        }
        for (; row < args.end_row; ++row)
            for (int column = 0; column < args.columns; ++column)
                to[row * stride + column] = from[column * from_stride + row];
    }
}

template <class T>
void Pair(const PairArgs<T>& args) {
    const std::size_t half = line_stride<T>(args.n) / 2;
    const auto put = [&](auto d, int m) HWY_ATTR {
        const auto xr = hn::LoadU(d, args.first + m), xi = hn::LoadU(d, args.first + half + m);
        auto yr = hn::Zero(d), yi = hn::Zero(d);
        if (args.second) {
            yr = hn::LoadU(d, args.second + m);
            yi = hn::LoadU(d, args.second + half + m);
        }
        hn::StoreU(hn::Sub(xr, yi), d, args.line_re + m);
        hn::StoreU(hn::Add(xi, yr), d, args.line_im + m);
        // Conjugates go to −m. For m = 0 that is one place past the line's end, into the slack.
        const int mirrored = args.n - m - static_cast<int>(hn::Lanes(d)) + 1;
        hn::StoreU(hn::Reverse(d, hn::Add(xr, yi)), d, args.line_re + mirrored);
        hn::StoreU(hn::Reverse(d, hn::Sub(yr, xi)), d, args.line_im + mirrored);
    };
    const hn::ScalableTag<T> d;
    const hn::CappedTag<T, 1> one;
    const int lanes = static_cast<int>(hn::Lanes(d));
    int m = 0;
    for (; m + lanes <= args.radius; m += lanes) put(d, m);
    for (; m < args.radius; ++m) put(one, m);
    const std::size_t gap = static_cast<std::size_t>(args.n - 2 * args.radius + 1) * sizeof(T);
    std::memset(args.line_re + args.radius, 0, gap);
    std::memset(args.line_im + args.radius, 0, gap);
}

// Loads values of T as double.
template <class D, class T>
HWY_INLINE hn::Vec<D> Wide(D d, const T* from) {
    if constexpr (sizeof(T) == sizeof(double))
        return hn::LoadU(d, from);
    else
        return hn::PromoteTo(d, hn::LoadU(hn::Rebind<T, D>(), from));
}

template <class T>
void Realise(const RealiseArgs<T>& args) {
    const hn::ScalableTag<double> d;
    const auto kx = hn::Set(d, args.kx), two_pi = hn::Set(d, kTwoPi);
    auto m0 = hn::Zero(d), m_minus1 = hn::Zero(d), mss = hn::Zero(d), east = hn::Zero(d), north = hn::Zero(d);
    for (int i = 0; i < args.count; i += static_cast<int>(hn::Lanes(d))) {
        const auto ky = hn::Mul(hn::Iota(d, static_cast<double>(args.first_my + i)), hn::Set(d, args.step));
        const auto k2 = hn::MulAdd(kx, kx, hn::Mul(ky, ky));
        const auto held = hn::And(hn::FirstN(d, static_cast<std::size_t>(args.count - i)),
                                  hn::Gt(k2, hn::Zero(d)));  // (0, 0) is no wave
        const auto weight2 = [&](double footprint_m) HWY_ATTR {
            const auto w =
                footprint_m > 0.0 ? Weight(d, k2, footprint_m, args.n_min, args.n_max) : hn::Set(d, 1.0);
            return hn::IfThenElseZero(held, hn::Mul(w, w));
        };
        const auto cell = weight2(args.cell_m), pixel = weight2(args.pixel_m);
        const auto re = Wide(d, args.height_re + i), im = Wide(d, args.height_im + i);
        const auto twice = hn::Set(d, 2.0);  // the mode and its conjugate at −k
        const auto height2 = hn::Mul(twice, hn::MulAdd(re, re, hn::Mul(im, im)));
        const auto resolved = hn::Mul(cell, height2);
        m0 = hn::Add(m0, resolved);
        const auto omega = hn::Mul(two_pi, hn::LoadU(d, args.cycles_per_s + i));
        m_minus1 = hn::Add(m_minus1, hn::IfThenElseZero(held, hn::Div(resolved, omega)));
        mss = hn::MulAdd(hn::Mul(pixel, k2), height2, mss);
        // forward is h0(k) and travels along +k; backward is conj(h0(−k)) and travels along −k.
        const auto fr = Wide(d, args.forward_re + i), fi = Wide(d, args.forward_im + i);
        const auto br = Wide(d, args.backward_re + i), bi = Wide(d, args.backward_im + i);
        const auto net = hn::Sub(hn::MulAdd(fr, fr, hn::Mul(fi, fi)), hn::MulAdd(br, br, hn::Mul(bi, bi)));
        const auto along = hn::IfThenElseZero(held, hn::Div(hn::Mul(cell, net), hn::Sqrt(k2)));
        east = hn::MulAdd(along, kx, east);
        north = hn::MulAdd(along, ky, north);
    }
    args.sums[0] += hn::GetLane(hn::SumOfLanes(d, m0));
    args.sums[1] += hn::GetLane(hn::SumOfLanes(d, m_minus1));
    args.sums[2] += hn::GetLane(hn::SumOfLanes(d, mss));
    args.sums[3] += hn::GetLane(hn::SumOfLanes(d, east));
    args.sums[4] += hn::GetLane(hn::SumOfLanes(d, north));
}

template <class T>
Kernels<T> Table() {
    return {&Advance<T>, &Through<T>, &Line<T>, &Scatter<T>, &Pair<T>, &Realise<T>};
}
std::pair<Kernels<float>, Kernels<double>> Tables() {
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
Kernels<T> kernels() {
    return std::get<Kernels<T>>(HWY_DYNAMIC_DISPATCH(Tables)());
}
template Kernels<float> kernels();
template Kernels<double> kernels();

}  // namespace pelagic
#endif
