// A shape of angular.h made narrower or wider: sea.directionality.
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>

#include "core/base/constants.h"
#include "core/spectrum/angular.h"

namespace pelagic {

template <class Shape>
Harmonics harmonics_of(const Shape& shape) {
    if constexpr (requires { shape.harmonics(); })
        return shape.harmonics();
    else
        return {shape.harmonic(1), shape.harmonic(2), shape.harmonic(4)};
}

// Where a shape is centred [rad]: 0, but for a buoy's, whose directions are absolute.
template <class Shape>
double centre_of(const Shape& shape) {
    if constexpr (requires { shape.centre(); })
        return shape.centre();
    else
        return 0.0;
}

// directionality κ > 1: D(φ(θ)) dφ/dθ with tan(φ/2) = κ tan(θ/2), angles from the centre: the circle drawn towards the centre
// by a Möbius transformation, which turns densities into densities; near the centre κ times as narrow. κ < 1: κ of D, and
// 1 − κ of waves from all directions alike (the same transformation would send them backwards). 1: D.
template <class Shape>
class Directed {
  public:
    Directed(const Shape& shape, double directionality) : shape_(shape), kappa_(directionality) {}

    double density(double theta) const {
        if (kappa_ < 1.0) return kappa_ * shape_.density(theta) + (1.0 - kappa_) / kTwoPi;
        const double half = 0.5 * (theta - centre()), c = std::cos(half), s = std::sin(half);
        return shape_.density(centre() + turned(theta - centre(), kappa_)) * kappa_ /
               (c * c + kappa_ * kappa_ * s * s);
    }
    // Up to a constant.
    double cumulative(double theta) const {
        if (kappa_ < 1.0) return kappa_ * shape_.cumulative(theta) + (1.0 - kappa_) * theta / kTwoPi;
        return shape_.cumulative(centre() + turned(theta - centre(), kappa_));
    }
    // ∫ D(φ) e^{inθ(φ)} dφ, e^{iθ} = (e^{iφ} + r)/(1 + r e^{iφ}).
    Harmonics harmonics() const {
        if (kappa_ < 1.0) return harmonics_of(shape_).scaled(kappa_);
        const double r = (kappa_ - 1.0) / (kappa_ + 1.0);
        if constexpr (requires { shape_.centre(); }) {
            const std::complex<double> back = std::polar(1.0, -centre());
            const auto moved = [&](std::complex<double> w) { return (w * back + r) / (1.0 + r * w * back); };
            const auto square = [](std::complex<double> z) { return z * z; };
            return Harmonics{shape_.mean(moved), shape_.mean([&](auto w) { return square(moved(w)); }),
                             shape_.mean([&](auto w) { return square(square(moved(w))); })}
                .turned(centre());
        } else {
            return harmonics_by_rule(r);
        }
    }

  private:
    // Of an even shape by the midpoint rule, which is made for what is periodic. In φ = u + sin u, because an almost isotropic
    // CosinePower has a cusp at π. All in one pass over half of the circle.
    Harmonics harmonics_by_rule(double r) const {
        constexpr int kLeastSteps = 128;
        const int steps =
            std::max(kLeastSteps, static_cast<int>(kPi / (0.1 * std::min(shape_.scale(), 2.0 / kappa_))));
        Harmonics sum;
        for (int i = 0; i < steps; ++i) {
            const double u = kPi * (i + 0.5) / steps, phi = u + std::sin(u), c = std::cos(phi);
            const double weight = 2.0 * ((1.0 + std::cos(u)) * (kPi / steps) * shape_.density(phi));
            double real = 1.0 / (1.0 + r * (r + 2.0 * c)) * (c * (1.0 + r * r) + 2.0 * r);
            for (std::complex<double>* n : {&sum.first, &sum.second, &sum.fourth}) {
                *n += weight * real;
                real = 2.0 * real * real - 1.0;  // of twice the angle
            }
        }
        return sum;
    }

    double centre() const { return centre_of(shape_); }
    // 2 atan(factor tan(θ/2)), and whole turns stay turns.
    static double turned(double theta, double factor) {
        const double turns = std::nearbyint(theta / kTwoPi) * kTwoPi, half = 0.5 * (theta - turns);
        return turns + 2.0 * std::atan2(factor * std::sin(half), std::cos(half));
    }

    const Shape& shape_;
    double kappa_;
};

}  // namespace pelagic
