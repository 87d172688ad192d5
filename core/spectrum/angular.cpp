#include "core/spectrum/angular.h"

#include <algorithm>
#include <cmath>

#include "core/base/constants.h"
#include "core/spectrum/gauss.h"

namespace pelagic {

namespace {

struct Turned {
    double turns;  // whole
    double rest;   // −π … π
};

Turned reduce(double theta) {
    const double turns = std::nearbyint(theta / kTwoPi);
    return {turns, std::clamp(theta - turns * kTwoPi, -kPi, kPi)};
}

// Γ(s + 1)/Γ(s + ½). With w = s + ¼ the logarithm's asymptotic series has even powers only (from DLMF 5.11.8,
// the Bernoulli polynomials at ¼ and ¾ being opposite): ½ ln w + 1/(64 w²) − 5/(2048 w⁴) + 61/(49152 w⁶) −
// 1385/(1048576 w⁸). From w = 8 on the next term is below 3e-12; smaller s climb there by Γ(x + 1) = x Γ(x).
double gamma_ratio(double s) {
    double factor = 1.0;
    while (s < 8.0) {
        factor *= (s + 0.5) / (s + 1.0);
        s += 1.0;
    }
    const double w = s + 0.25;
    const double q = 1.0 / (w * w);
    const double series =
        q * (1.0 / 64.0 + q * (-5.0 / 2048.0 + q * (61.0 / 49152.0 + q * (-1385.0 / 1048576.0))));
    return factor * std::sqrt(w) * std::exp(series);
}

// The continued fraction of the incomplete beta function (DLMF 8.17.22) by Lentz's method.
double beta_fraction(double a, double b, double x) {
    constexpr double kTiny = 1e-300;
    const auto away_from_zero = [](double v) { return std::abs(v) < kTiny ? kTiny : v; };
    double c = 1.0;
    double d = 1.0 / away_from_zero(1.0 - (a + b) * x / (a + 1.0));
    double h = d;
    for (int m = 1; m < 10000; ++m) {
        const double even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        d = 1.0 / away_from_zero(1.0 + even * d);
        c = away_from_zero(1.0 + even / c);
        h *= d * c;
        const double odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        d = 1.0 / away_from_zero(1.0 + odd * d);
        c = away_from_zero(1.0 + odd / c);
        const double change = d * c;
        h *= change;
        if (std::abs(change - 1.0) < 1e-15) break;
    }
    return h;
}

}  // namespace

// --- CosinePower ---

CosinePower::CosinePower(double s) : s_(s), norm_(gamma_ratio(s) / (2.0 * std::sqrt(kPi))) {}

double CosinePower::density(double theta) const {
    const double c = std::cos(0.5 * theta);
    return norm_ * std::pow(c * c, s_);
}

// ∫₀^θ = ½ I(sin²(θ/2); ½, s + ½), the regularised incomplete beta function (substitute u = sin²(θ/2)).
double CosinePower::cumulative(double theta) const {
    const Turned t = reduce(theta);
    const double sine = std::sin(0.5 * std::abs(t.rest)), cosine = std::cos(0.5 * t.rest);
    const double b = s_ + 0.5;
    const double x = sine * sine, y = cosine * cosine;
    const double front = 2.0 * norm_ * sine * cosine * std::pow(y, s_);  // x^½ y^b / B(½, b)
    double half;
    if (x < 1.5 / (b + 2.5)) {
        half = front * beta_fraction(0.5, b, x);
    } else {
        half = 0.5 - 0.5 * front * beta_fraction(b, 0.5, y) / b;
    }
    return t.turns + std::copysign(half, t.rest);
}

// Γ(s + 1)²/(Γ(s + n + 1) Γ(s − n + 1)) = Π (s − j)/(s + 1 + j).
std::complex<double> CosinePower::harmonic(int n) const {
    double product = 1.0;
    for (int j = 0; j < n; ++j) product *= (s_ - j) / (s_ + 1.0 + j);
    return product;
}

// --- SechSquared ---

SechSquared::SechSquared(double beta) : beta_(beta), norm_(0.5 / std::tanh(beta * kPi)) {}

double SechSquared::density(double theta) const {
    const double sech = 1.0 / std::cosh(beta_ * reduce(theta).rest);
    return norm_ * beta_ * sech * sech;
}

double SechSquared::cumulative(double theta) const {
    const Turned t = reduce(theta);
    return t.turns + norm_ * std::tanh(beta_ * t.rest);
}

// No closed form on the circle. The integrand is even; panels of a quarter of the hump's width, or of the
// cosine's.
std::complex<double> SechSquared::harmonic(int n) const {
    const auto& rule = GaussLegendre<8>::rule();
    const double end = std::min(kPi, 20.0 / beta_);  // sech²(20) = 1.7e-17
    const int panels = static_cast<int>(std::ceil(end * std::max(0.5 * beta_, 0.5 * n))) + 1;
    double sum = 0.0;
    for (int i = 0; i < panels; ++i) {
        sum += rule.integrate(end * i / panels, end * (i + 1) / panels, [&](double theta) {
            const double sech = 1.0 / std::cosh(beta_ * theta);
            return sech * sech * std::cos(n * theta);
        });
    }
    return 2.0 * norm_ * beta_ * sum;
}

// --- CosineSquared ---

double CosineSquared::density(double theta) const {
    const double c = std::cos(theta);
    return c > 0.0 ? 2.0 / kPi * c * c : 0.0;
}

double CosineSquared::cumulative(double theta) const {
    const Turned t = reduce(theta);
    const double inside = std::clamp(t.rest, -0.5 * kPi, 0.5 * kPi);
    return t.turns + (inside + 0.5 * std::sin(2.0 * inside)) / kPi;
}

// (1/π) ∫ (1 + cos 2θ) cos nθ over the half circle.
std::complex<double> CosineSquared::harmonic(int n) const {
    const auto half_circle = [](int m) { return m == 0 ? kPi : 2.0 * std::sin(0.5 * m * kPi) / m; };
    return (half_circle(n) + 0.5 * (half_circle(n + 2) + half_circle(std::abs(n - 2)))) / kPi;
}

// --- SecondHarmonic ---

// m = (9/8) cos θ − (1/8) cos 3θ, and cos 2θ · m = ½ cos θ + (9/16) cos 3θ − (1/16) cos 5θ.

double SecondHarmonic::density(double theta) const {
    const double c = std::cos(theta);
    return (1.0 + delta_ * (2.0 * c * c - 1.0)) * (1.0 + 0.5 * c * (3.0 - c * c)) / kTwoPi;
}

double SecondHarmonic::cumulative(double theta) const {
    const Turned t = reduce(theta);
    const double r = t.rest;
    const double odd_part =
        9.0 / 8.0 * std::sin(r) - std::sin(3.0 * r) / 24.0 +
        delta_ * (0.5 * std::sin(r) + 3.0 / 16.0 * std::sin(3.0 * r) - std::sin(5.0 * r) / 80.0);
    return t.turns + (r + 0.5 * delta_ * std::sin(2.0 * r) + odd_part) / kTwoPi;
}

std::complex<double> SecondHarmonic::harmonic(int n) const {
    switch (n) {
        case 0:
            return 1.0;
        case 1:
            return 9.0 / 16.0 + 0.25 * delta_;
        case 2:
            return 0.5 * delta_;
        case 3:
            return -1.0 / 16.0 + 9.0 / 32.0 * delta_;
        case 5:
            return -delta_ / 32.0;
        default:
            return 0.0;
    }
}

// --- MaximumEntropy ---

MaximumEntropy::MaximumEntropy(std::complex<double> c1, std::complex<double> c2) {
    const double first = std::abs(c1);
    if (first > kMaxFirst) c1 *= kMaxFirst / first;
    const double room = 1.0 - std::norm(c1);
    const std::complex<double> excess = c2 - c1 * c1;
    const double second = std::abs(excess);
    if (second > kMaxSecond * room) c2 = c1 * c1 + excess * (kMaxSecond * room / second);

    c1_ = c1;
    phi1_ = (c1 - c2 * std::conj(c1)) / room;
    phi2_ = c2 - c1 * phi1_;
    variance_ = (1.0 - phi1_ * std::conj(c1) - phi2_ * std::conj(c2)).real();
}

double MaximumEntropy::density(double theta) const {
    const std::complex<double> w = std::polar(1.0, -theta);
    return variance_ / (kTwoPi * std::norm(1.0 - w * (phi1_ + w * phi2_)));
}

// The coefficients obey c_n = φ1 c_{n−1} + φ2 c_{n−2}, so c_n = a p1ⁿ + b p2ⁿ with p the roots of p² = φ1 p + φ2.
MaximumEntropy::Poles MaximumEntropy::find_poles() const {
    // Equal roots would need another form. Set 1e-5 apart they give the same D to 1e-10, and rounding costs as much.
    std::complex<double> discriminant = 0.25 * phi1_ * phi1_ + phi2_;
    if (std::abs(discriminant) < 2.5e-11) discriminant = 2.5e-11;
    const std::complex<double> root = std::sqrt(discriminant);
    const std::complex<double> p1 = 0.5 * phi1_ + root, p2 = 0.5 * phi1_ - root;
    return {p1, p2, (c1_ - p2) / (p1 - p2)};
}

// 2π D = −1 + 2 Re Σ_{n≥0} c_n wⁿ (w = e^{−iθ}) integrates to θ + 2 Im Σ a_j ln(1 − p_j w). |p_j| < 1 keeps each logarithm on
// its principal branch.
double MaximumEntropy::cumulative(double theta) const {
    const Poles poles = find_poles();
    const Turned t = reduce(theta);
    const auto antiderivative = [&](const std::complex<double>& w) {
        return (poles.share * std::log(1.0 - poles.first * w) +
                (1.0 - poles.share) * std::log(1.0 - poles.second * w))
                   .imag() /
               kPi;
    };
    return t.turns + t.rest / kTwoPi + antiderivative(std::polar(1.0, -t.rest)) - antiderivative(1.0);
}

// The roots of p² = φ1 p + φ2 are the poles in w; ln |p| is their distance in θ.
double MaximumEntropy::scale() const {
    const std::complex<double> root = std::sqrt(0.25 * phi1_ * phi1_ + phi2_);
    const double largest = std::max(std::abs(0.5 * phi1_ + root), std::abs(0.5 * phi1_ - root));
    return largest > 0.0 ? -std::log(largest) : 1.0;
}

double MaximumEntropy::numerator() const {
    return variance_ / kTwoPi;
}

// |1 − φ1 w − φ2 w²|² = 1 + |φ1|² + |φ2|² − 2 Re (φ1 − φ1* φ2) w − 2 Re φ2 w².
std::array<double, 5> MaximumEntropy::denominator() const {
    const std::complex<double> once = phi1_ - std::conj(phi1_) * phi2_;
    return {1.0 + std::norm(phi1_) + std::norm(phi2_), -2.0 * once.real(), -2.0 * once.imag(),
            -2.0 * phi2_.real(), -2.0 * phi2_.imag()};
}

std::complex<double> MaximumEntropy::harmonic(int n) const {
    std::complex<double> before = std::conj(c1_), value = 1.0;  // c_{−1}, c_0
    for (int i = 0; i < n; ++i) {
        const std::complex<double> next = phi1_ * value + phi2_ * before;
        before = value;
        value = next;
    }
    return value;
}

}  // namespace pelagic
