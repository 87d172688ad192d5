// Gauss–Legendre quadrature on an interval: nodes and weights on [−1, 1], found once by Newton's method.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace pelagic {

template <std::size_t N>
struct GaussLegendre {
    std::array<double, N> node{};
    std::array<double, N> weight{};

    GaussLegendre() {
        for (std::size_t i = 0; i < N; ++i) {
            double x = -std::cos(std::numbers::pi * (static_cast<double>(i) + 0.75) /
                                 (static_cast<double>(N) + 0.5));
            double slope = 1.0;
            for (int step = 0; step < 20; ++step) {
                double before = 1.0, value = x;
                for (std::size_t n = 2; n <= N; ++n) {
                    const double degree = static_cast<double>(n);
                    const double next = ((2.0 * degree - 1.0) * x * value - (degree - 1.0) * before) / degree;
                    before = value;
                    value = next;
                }
                slope = static_cast<double>(N) * (x * value - before) / (x * x - 1.0);
                x -= value / slope;
            }
            node[i] = x;
            weight[i] = 2.0 / ((1.0 - x * x) * slope * slope);
        }
    }

    static const GaussLegendre& rule() {
        static const GaussLegendre once;
        return once;
    }

    // ∫ from a to b of f.
    template <class F>
    double integrate(double a, double b, F&& f) const {
        const double half = 0.5 * (b - a), middle = 0.5 * (a + b);
        double sum = 0.0;
        for (std::size_t i = 0; i < N; ++i) sum += weight[i] * f(middle + half * node[i]);
        return half * sum;
    }
};

}  // namespace pelagic
