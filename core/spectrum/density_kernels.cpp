#include "core/spectrum/density_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/spectrum/density_kernels.cpp"
#include <hwy/foreach_target.h>
// foreach_target first: it includes this file once for each instruction set.
#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include "core/base/constants.h"

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

void Column(double x_cells, double y_offset, int first_my, double step, std::size_t count, double* k,
            double* cosine, double* sine) {
    const D d;
    const V x = Set(x_cells * step);
    for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
        const V my = hn::Iota(d, static_cast<double>(first_my) + static_cast<double>(i));
        const V y = hn::Mul(hn::Add(my, Set(y_offset)), Set(step));
        const V length = hn::Sqrt(hn::MulAdd(x, x, hn::Mul(y, y)));
        hn::StoreU(length, d, k + i);
        hn::StoreU(hn::Div(x, length), d, cosine + i);
        hn::StoreU(hn::Div(y, length), d, sine + i);
    }
}

HWY_INLINE V Polynomial(const std::array<double, TableTerm::kCoefficients>& coefficients, V t) {
    V value = Set(coefficients.back());
    for (int i = TableTerm::kCoefficients - 2; i >= 0; --i)
        value = hn::MulAdd(value, t, Set(coefficients[i]));
    return value;
}

// The shapes of core/spectrum/angular.h without their norms, in one direction and its opposite: `c` and `s`
// are cosine and sine of the angle to the system's direction.
struct Both {
    V same, opposite;
};

struct CosinePowerShape {
    V s;
    HWY_INLINE CosinePowerShape(const TableTerm&, V parameter) : s(hn::Max(parameter, hn::Zero(D()))) {}
    HWY_INLINE Both operator()(V c, V) const {
        const D d;
        const V half = Set(0.5), least = Set(1e-300);  // keeps 0⁰ at 1
        const V with = hn::Max(hn::MulAdd(half, c, half), least);
        const V against = hn::Max(hn::NegMulAdd(half, c, half), least);
        return {hn::Exp(d, hn::Mul(s, hn::Log(d, with))), hn::Exp(d, hn::Mul(s, hn::Log(d, against)))};
    }
};

struct SechSquaredShape {
    V twice_beta;
    HWY_INLINE SechSquaredShape(const TableTerm&, V parameter) : twice_beta(hn::Add(parameter, parameter)) {}
    HWY_INLINE Both operator()(V c, V) const {
        const D d;
        const V one = Set(1.0);
        const V angle = hn::Acos(d, hn::Min(hn::Max(c, Set(-1.0)), one));
        const auto sech2 = [&](V away) HWY_ATTR {
            const V q = hn::Exp(d, hn::Neg(hn::Mul(twice_beta, away)));
            const V sum = hn::Add(one, q);
            return hn::Div(hn::Mul(Set(4.0), q), hn::Mul(sum, sum));
        };
        return {sech2(angle), sech2(hn::Sub(Set(kPi), angle))};
    }
};

struct CosineSquaredShape {
    HWY_INLINE CosineSquaredShape(const TableTerm&, V) {}
    HWY_INLINE Both operator()(V c, V) const {
        const V with = hn::Max(c, hn::Zero(D())), against = hn::Max(hn::Neg(c), hn::Zero(D()));
        return {hn::Mul(with, with), hn::Mul(against, against)};
    }
};

struct SecondHarmonicShape {
    V delta;
    HWY_INLINE SecondHarmonicShape(const TableTerm&, V parameter) : delta(parameter) {}
    HWY_INLINE Both operator()(V c, V) const {
        const V one = Set(1.0), c2 = hn::Mul(c, c);
        const V even = hn::MulAdd(delta, hn::Sub(hn::Add(c2, c2), one), one);
        const V odd = hn::Mul(hn::Mul(Set(0.5), c), hn::Sub(Set(3.0), c2));
        return {hn::Mul(even, hn::Add(one, odd)), hn::Mul(even, hn::Sub(one, odd))};
    }
};

struct MaximumEntropyShape {
    const std::array<double, 5>& d;
    HWY_INLINE MaximumEntropyShape(const TableTerm& term, V) : d(term.denominator) {}
    HWY_INLINE Both operator()(V c, V s) const {
        const V twice_c = hn::Add(c, c);
        const V even = hn::MulAdd(Set(d[3]), hn::MulSub(twice_c, c, Set(1.0)),
                                  hn::MulAdd(Set(d[4]), hn::Mul(twice_c, s), Set(d[0])));
        const V odd = hn::MulAdd(Set(d[1]), c, hn::Mul(Set(d[2]), s));
        const V one = Set(1.0);
        return {hn::Div(one, hn::Add(even, odd)), hn::Div(one, hn::Sub(even, odd))};
    }
};

// Any of these shapes with a directionality above 1: core/spectrum/directed.h, by half angles.
template <class Shape>
struct DirectedShape {
    Shape shape;
    V kappa;
    HWY_INLINE DirectedShape(const TableTerm& term, V parameter)
        : shape(term, parameter), kappa(Set(term.directionality)) {}
    HWY_INLINE Both operator()(V c, V s) const { return {drawn(c, s), drawn(hn::Neg(c), hn::Neg(s))}; }

  private:
    HWY_INLINE V drawn(V c, V s) const {
        const V one = Set(1.0), near = hn::Add(one, c), far = hn::Mul(hn::Mul(kappa, kappa), hn::Sub(one, c));
        const V by = hn::Div(one, hn::Add(near, far)), twice = hn::Mul(hn::Add(kappa, kappa), by);
        return hn::Mul(twice, shape(hn::Mul(hn::Sub(near, far), by), hn::Mul(twice, s)).same);
    }
};

template <class Shape>
HWY_INLINE void AddTerm(const TablePanel& panel, const TableTerm& term, double weight, std::size_t count,
                        const double* k, const double* cosine, const double* sine, const FourWays& sum) {
    const D d;
    const V middle = Set(0.5 * (panel.k_lo + panel.k_hi)), per_half = Set(2.0 / (panel.k_hi - panel.k_lo));
    const V to_x = Set(term.cos_direction), to_y = Set(term.sin_direction), scale = Set(weight);
    for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
        const V t = hn::Mul(hn::Sub(hn::LoadU(d, k + i), middle), per_half);
        // The polynomial of a spectrum that vanishes may swing below 0 by its own error.
        const V amplitude = hn::Mul(scale, hn::Max(Polynomial(term.amplitude, t), hn::Zero(d)));
        const Shape shape(term, Polynomial(term.parameter, t));
        const V x = hn::LoadU(d, cosine + i), y = hn::LoadU(d, sine + i);
        const V xx = hn::Mul(x, to_x), yy = hn::Mul(y, to_y), xy = hn::Mul(x, to_y), yx = hn::Mul(y, to_x);
        const Both along = shape(hn::Add(xx, yy), hn::Sub(yx, xy));
        const Both across = shape(hn::Sub(xx, yy), hn::Neg(hn::Add(yx, xy)));
        const auto add = [&](double* to, V value) HWY_ATTR {
            hn::StoreU(hn::MulAdd(amplitude, value, hn::LoadU(d, to + i)), d, to + i);
        };
        add(sum.same, along.same);
        add(sum.opposite, along.opposite);
        add(sum.below, across.same);
        add(sum.above, across.opposite);
    }
}

template <class Shape>
void AddShape(const TablePanel& panel, const TableTerm& term, double weight, std::size_t count,
              const double* k, const double* cosine, const double* sine, const FourWays& sum) {
    if (term.directionality > 1.0)
        AddTerm<DirectedShape<Shape>>(panel, term, weight, count, k, cosine, sine, sum);
    else
        AddTerm<Shape>(panel, term, weight, count, k, cosine, sine, sum);
}

void AddDensity(const TablePanel& panel, const TableTerm& term, double weight, std::size_t count,
                const double* k, const double* cosine, const double* sine, const FourWays& sum) {
    switch (term.shape) {  // in AngularShape's order
        case 0:
            return AddShape<CosinePowerShape>(panel, term, weight, count, k, cosine, sine, sum);
        case 1:
            return AddShape<SechSquaredShape>(panel, term, weight, count, k, cosine, sine, sum);
        case 2:
            return AddShape<CosineSquaredShape>(panel, term, weight, count, k, cosine, sine, sum);
        case 3:
            return AddShape<SecondHarmonicShape>(panel, term, weight, count, k, cosine, sine, sum);
        case 4:
            return AddShape<MaximumEntropyShape>(panel, term, weight, count, k, cosine, sine, sum);
    }
}

DensityKernels Table() {
    return {&Column, &AddDensity};
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace pelagic
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelagic {
HWY_EXPORT(Table);

DensityKernels density_kernels() {
    return HWY_DYNAMIC_DISPATCH(Table)();
}

}  // namespace pelagic
#endif
