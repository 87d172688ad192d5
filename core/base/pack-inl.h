// Highway's vectors with the operators and functions of core/base/number.h.
//
// Included once per instruction set by files that use Highway's foreach_target (its own pattern of guards).
#if defined(PELAGIC_CORE_BASE_PACK_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PELAGIC_CORE_BASE_PACK_INL_H_
#undef PELAGIC_CORE_BASE_PACK_INL_H_
#else
#define PELAGIC_CORE_BASE_PACK_INL_H_
#endif

#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace pelagic {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <class D>
struct Pack {
    using T = hn::TFromD<D>;
    using V = hn::Vec<D>;
    V v;

    HWY_INLINE Pack() : v(hn::Zero(D())) {}
    HWY_INLINE Pack(V values) : v(values) {}
    HWY_INLINE explicit Pack(int same) : v(hn::Set(D(), static_cast<T>(same))) {}
    HWY_INLINE explicit Pack(float same) : v(hn::Set(D(), static_cast<T>(same))) {}
    HWY_INLINE explicit Pack(double same) : v(hn::Set(D(), static_cast<T>(same))) {}

    friend HWY_INLINE Pack operator+(Pack a, Pack b) { return hn::Add(a.v, b.v); }
    friend HWY_INLINE Pack operator-(Pack a, Pack b) { return hn::Sub(a.v, b.v); }
    friend HWY_INLINE Pack operator*(Pack a, Pack b) { return hn::Mul(a.v, b.v); }
    friend HWY_INLINE Pack operator/(Pack a, Pack b) { return hn::Div(a.v, b.v); }
    friend HWY_INLINE Pack operator-(Pack a) { return hn::Neg(a.v); }
    HWY_INLINE Pack& operator+=(Pack b) { return *this = *this + b; }
    friend HWY_INLINE auto operator<(Pack a, Pack b) { return hn::Lt(a.v, b.v); }
    friend HWY_INLINE auto operator>(Pack a, Pack b) { return hn::Gt(a.v, b.v); }
};

template <class D>
HWY_INLINE Pack<D> select(hn::Mask<D> which, Pack<D> yes, Pack<D> no) {
    return hn::IfThenElse(which, yes.v, no.v);
}
template <class D>
HWY_INLINE Pack<D> minimum(Pack<D> a, Pack<D> b) {
    return hn::Min(a.v, b.v);
}
template <class D>
HWY_INLINE Pack<D> maximum(Pack<D> a, Pack<D> b) {
    return hn::Max(a.v, b.v);
}
template <class D>
HWY_INLINE Pack<D> magnitude(Pack<D> x) {
    return hn::Abs(x.v);
}
template <class D>
HWY_INLINE Pack<D> minus_product(Pack<D> c, Pack<D> a, Pack<D> b) {
    return hn::NegMulAdd(a.v, b.v, c.v);
}
template <class D>
HWY_INLINE Pack<D> square_root(Pack<D> x) {
    return hn::Sqrt(x.v);
}

// Halley's iteration, started with an exponent a third of x's. Relative error below 4e-7 in single precision
// and 1e-15 in double. Returns 1e-10 for |x| < 1e-30.
template <class D>
HWY_INLINE Pack<D> cube_root(Pack<D> x) {
    using T = hn::TFromD<D>;
    const D d;
    const hn::RebindToSigned<D> di;
    // The bits of a positive float, read as an integer, approximate its log2, scaled and biased like the
    // exponent.
    constexpr double kScale = sizeof(T) == 4 ? double(1 << 23) : double(std::int64_t(1) << 52);
    constexpr double kBias = sizeof(T) == 4 ? 127.0 : 1023.0;
    // Centres the error of that piecewise linear logarithm.
    constexpr double kMiddle = 0.0430;
    const auto size = hn::Max(hn::Abs(x.v), hn::Set(d, T(1e-30)));
    const auto logarithm = hn::ConvertTo(d, hn::BitCast(di, size));
    const auto third = hn::MulAdd(logarithm, hn::Set(d, T(1.0 / 3.0)),
                                  hn::Set(d, T(kScale * (kBias - kMiddle) * (2.0 / 3.0))));
    auto y = hn::BitCast(d, hn::ConvertTo(di, third));
    for (int i = 0; i < (sizeof(T) == 4 ? 2 : 3); ++i) {
        const auto cube = hn::Mul(hn::Mul(y, y), y);
        y = hn::Mul(
            y, hn::Div(hn::MulAdd(hn::Set(d, T(2)), size, cube), hn::MulAdd(hn::Set(d, T(2)), cube, size)));
    }
    return hn::CopySign(y, x.v);
}

template <class D>
HWY_INLINE Pack<D> exponential(Pack<D> x) {
    return hn::Exp(D(), x.v);
}

// erfc(x) = exp(−x²) f(t)/(1 + 2x) for x ≥ 0 with t = (x − 3)/(x + 3); erfc(x) = 2 − erfc(−x) below 0. f is a
// Chebyshev series, fitted at 64 nodes to erfc computed with 40 digits. Relative error 2e-6 in single
// precision (from rounding x²) and 4e-15 in double, where the result is a normal number.
template <class D>
HWY_INLINE Pack<D> complementary_error(Pack<D> x) {
    using T = hn::TFromD<D>;
    const D d;
    constexpr double kSeries[] = {
        0.5 * 2.3551251483931200926, 0.0053539045396156767694,   -0.093775503422842090522,
        0.054366525557443220495,     -0.018976596707845207386,   0.0044534260614627115695,
        -0.00063355317105531469398,  0.000017661719523171591851, 0.000012841532864056670734,
        -2.0072285659059914438e-6,   -1.8075227904148371024e-7,  7.5498283438250928278e-8,
        1.8856685238386027905e-9,    -2.6995190497983639975e-9,  -1.4600791199391049408e-11,
        1.0361607445969489676e-10,   1.4757159766234730087e-12,  -4.2773400643969108248e-12,
        -2.0792249285979899778e-13,  1.8134502003176962422e-13,  1.9734255745447388335e-14,
        -7.2879437375926731569e-15,  -1.5169878690228115683e-15, 2.3514112258781403516e-16};
    constexpr int kTerms = sizeof(T) == 4 ? 12 : 24;
    const auto size = hn::Abs(x.v);
    const auto t = hn::Div(hn::Sub(size, hn::Set(d, T(3))), hn::Add(size, hn::Set(d, T(3))));
    const auto twice_t = hn::Add(t, t);
    auto next = hn::Zero(d), after = hn::Zero(d);  // Clenshaw's recurrence
    for (int k = kTerms - 1; k > 0; --k) {
        const auto now = hn::Add(hn::MulSub(twice_t, next, after), hn::Set(d, T(kSeries[k])));
        after = next;
        next = now;
    }
    const auto f = hn::Add(hn::MulSub(t, next, after), hn::Set(d, T(kSeries[0])));
    const auto tail = hn::Div(hn::Mul(hn::Exp(d, hn::Neg(hn::Mul(size, size))), f),
                              hn::MulAdd(hn::Set(d, T(2)), size, hn::Set(d, T(1))));
    return hn::IfThenElse(hn::Lt(x.v, hn::Zero(d)), hn::Sub(hn::Set(d, T(2)), tail), tail);
}

}  // namespace HWY_NAMESPACE
}  // namespace pelagic
HWY_AFTER_NAMESPACE();

#endif
