// What the spectrum's tests measure with: plain rules, independent of the code under test, and the seas they
// try.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "pelagic/scene.h"

namespace pelagic::oracle {

inline constexpr double kPi = std::numbers::pi;
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Simpson's rule with 2n intervals.
template <class F>
double simpson(double a, double b, int n, F&& f) {
    const double h = (b - a) / (2 * n);
    double sum = f(a) + f(b);
    for (int i = 1; i < 2 * n; ++i) sum += (i % 2 == 1 ? 4.0 : 2.0) * f(a + i * h);
    return sum * h / 3.0;
}

// The least and the most of some numbers, as tests print them.
struct Extent {
    double least = kInfinity, most = -kInfinity;
    void add(double value) {
        least = std::min(least, value);
        most = std::max(most, value);
    }
    std::string text() const { return std::to_string(least) + " … " + std::to_string(most); }
};

// ∫ f dx over the logarithm of x.
template <class F>
double log_simpson(double a, double b, int n, F&& f) {
    return simpson(std::log(a), std::log(b), n, [&](double u) { return std::exp(u) * f(std::exp(u)); });
}

inline const std::vector<SpectrumKind> kAnalytic = {
    SpectrumKind::PiersonMoskowitz, SpectrumKind::Jonswap, SpectrumKind::Jonswap1973, SpectrumKind::Tma,
    SpectrumKind::Elfouhaily,       SpectrumKind::Omega2,  SpectrumKind::Phillips};

inline const std::vector<SpreadingKind> kSpreadings = {SpreadingKind::Hasselmann,
                                                       SpreadingKind::DonelanBanner, SpreadingKind::Cosine,
                                                       SpreadingKind::Elfouhaily};

// A made-up hour of a buoy: a swell at 0.09 Hz under a wind sea at 0.2 Hz on NDBC's grid of frequencies,
// densities rounded to 0.01, one direction missing.
inline MeasuredSpectrum made_up_buoy() {
    std::vector<double> hz = {0.0200};
    for (double f = 0.0325; f < 0.093; f += 0.005) hz.push_back(f);
    for (double f = 0.1000; f < 0.351; f += 0.01) hz.push_back(f);
    for (double f = 0.3650; f < 0.486; f += 0.02) hz.push_back(f);
    MeasuredSpectrum sea;
    sea.station = "made up";
    for (double f : hz) {
        const double swell = 6.0 * std::exp(-0.5 * std::pow((f - 0.09) / 0.008, 2));
        const double wind = 5e-4 * std::pow(f, -5.0) * std::exp(-1.25 * std::pow(0.2 / f, 4));
        const double r1 = f < 0.13 ? 0.93 : 0.8, direction = f < 0.13 ? 2.0 : 0.3 + f;
        const double density = std::round(100.0 * (swell + wind)) / 100.0;
        sea.bins.push_back({f, density, r1 * std::cos(direction), r1 * std::sin(direction),
                            std::pow(r1, 3) * std::cos(2 * direction),
                            std::pow(r1, 3) * std::sin(2 * direction), true});
    }
    sea.bins[36].has_direction = false;  // 0.32 Hz, in the tail: of little weight in the mean direction
    return sea;
}

}  // namespace pelagic::oracle
