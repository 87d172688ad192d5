// Sine and cosine of a phase in cycles for Highway's vectors, with one range reduction for both.
//
// Included once per instruction set by files that use Highway's foreach_target (its own pattern of guards).
#if defined(PELAGIC_CORE_BASE_SINCOS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PELAGIC_CORE_BASE_SINCOS_INL_H_
#undef PELAGIC_CORE_BASE_SINCOS_INL_H_
#else
#define PELAGIC_CORE_BASE_SINCOS_INL_H_
#endif

#include <hwy/highway.h>

#include "core/base/constants.h"

HWY_BEFORE_NAMESPACE();
namespace pelagic {
namespace HWY_NAMESPACE {

// sin(2πx) and cos(2πx), for |x| < 2^20 cycles in single precision and 2^50 in double. Large phases should be
// reduced in double first: their own rounding limits the accuracy. Taylor series over ± an eighth of a cycle:
// error 1.2e-7 in single precision, 3e-16 in double.
template <class D, class V = hwy::HWY_NAMESPACE::Vec<D>>
HWY_INLINE void SinCosCycles(D d, V cycles, V& sine, V& cosine) {
    namespace hn = hwy::HWY_NAMESPACE;
    using T = hn::TFromD<D>;
    const hn::RebindToSigned<D> di;
    const V quarters = hn::Round(hn::Mul(cycles, hn::Set(d, T(4))));
    const V angle = hn::Mul(hn::NegMulAdd(quarters, hn::Set(d, T(0.25)), cycles), hn::Set(d, T(kTwoPi)));
    const V square = hn::Mul(angle, angle);
    // Terms up to θ^(2n + 1)/(2n + 1)!: the remainder at θ = π/4 is below half a unit in the last place.
    constexpr int kTerms = sizeof(T) == 4 ? 4 : 8;
    V s = hn::Set(d, T(1)), c = hn::Set(d, T(1));
    for (int n = kTerms; n > 0; --n) {
        s = hn::NegMulAdd(hn::Mul(square, hn::Set(d, T(1.0 / (2.0 * n * (2.0 * n + 1.0))))), s,
                          hn::Set(d, T(1)));
        c = hn::NegMulAdd(hn::Mul(square, hn::Set(d, T(1.0 / ((2.0 * n + 1.0) * (2.0 * n + 2.0))))), c,
                          hn::Set(d, T(1)));
    }
    s = hn::Mul(s, angle);
    c = hn::NegMulAdd(hn::Mul(square, hn::Set(d, T(0.5))), c, hn::Set(d, T(1)));
    // A quarter cycle exchanges sine and cosine, half a cycle changes both signs.
    const auto quadrant = hn::ConvertTo(di, quarters);
    const auto one = hn::Set(di, 1), two = hn::Set(di, 2);
    const auto odd = hn::RebindMask(d, hn::TestBit(quadrant, one));
    const V sine_sign = hn::BitCast(d, hn::ShiftLeft<sizeof(T) * 8 - 2>(hn::And(quadrant, two)));
    const V cosine_sign =
        hn::BitCast(d, hn::ShiftLeft<sizeof(T) * 8 - 2>(hn::And(hn::Add(quadrant, one), two)));
    sine = hn::Xor(hn::IfThenElse(odd, c, s), sine_sign);
    cosine = hn::Xor(hn::IfThenElse(odd, s, c), cosine_sign);
}

}  // namespace HWY_NAMESPACE
}  // namespace pelagic
HWY_AFTER_NAMESPACE();

#endif
