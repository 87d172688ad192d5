#include "tests/core/spectrum/cell_energy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "core/base/constants.h"
#include "core/spectrum/gauss.h"

namespace pelagic::oracle {

namespace {

// At most nine numbers, kept in order as they come.
struct ShortSorted {
    std::array<double, 9> value{};
    std::size_t count = 0;

    void insert(double v) {
        std::size_t i = count++;
        for (; i > 0 && value[i - 1] > v; --i) value[i] = value[i - 1];
        value[i] = v;
    }
};

// ∫ polar dθ over the part of the circle of radius k that lies in the rectangle. The circle meets the four
// lines in at most eight angles; between neighbours it is in or out as a whole.
double arc_in_rectangle(const DirectionalSpectrum& spectrum, const Cell& cell, double k) {
    ShortSorted angles;
    const auto add = [&](double angle) { angles.insert(angle < 0.0 ? angle + kTwoPi : angle); };
    for (double x : {cell.kx0, cell.kx1}) {
        if (std::abs(x) >= k) continue;
        const double angle = std::acos(x / k);
        add(angle);
        add(-angle);
    }
    for (double y : {cell.ky0, cell.ky1}) {
        if (std::abs(y) >= k) continue;
        const double angle = std::asin(y / k);
        add(angle);
        add(kPi - angle);
    }
    const auto inside = [&](double angle) {
        const double x = k * std::cos(angle), y = k * std::sin(angle);
        return x > cell.kx0 && x < cell.kx1 && y > cell.ky0 && y < cell.ky1;
    };
    if (angles.count == 0) return inside(0.0) ? spectrum.arc(k, 0.0, kTwoPi) : 0.0;

    double sum = 0.0;
    for (std::size_t i = 0; i < angles.count; ++i) {
        const double from = angles.value[i];
        const double to = i + 1 < angles.count ? angles.value[i + 1] : angles.value[0] + kTwoPi;
        if (to > from && inside(0.5 * (from + to))) sum += spectrum.arc(k, from, to);
    }
    return sum;
}

struct RadialRange {
    double lo, hi;
};

// Distances of the rectangle's nearest and farthest points from the origin.
RadialRange radial_range(const Cell& cell) {
    const double near_x = std::max({cell.kx0, -cell.kx1, 0.0}), near_y = std::max({cell.ky0, -cell.ky1, 0.0});
    const double far_x = std::max(std::abs(cell.kx0), std::abs(cell.kx1));
    const double far_y = std::max(std::abs(cell.ky0), std::abs(cell.ky1));
    return {std::hypot(near_x, near_y), std::hypot(far_x, far_y)};
}

std::span<const double> between(std::span<const double> sorted, const RadialRange& range) {
    const auto first = std::upper_bound(sorted.begin(), sorted.end(), range.lo);
    const auto last = std::lower_bound(first, sorted.end(), range.hi);
    return {first, last};
}

// ∫ dk of the arcs. Between the radii where the arcs' ends change sides, and the spectrum's panels, the
// integrand is smooth but for square roots where a side is touched: k = a + (b − a) t²(3 − 2t) takes them
// away at both ends.
double polar_energy(const DirectionalSpectrum& spectrum, const Cell& cell, const RadialRange& range) {
    const auto panels = spectrum.panels();
    const double lo = std::max(range.lo, panels.front()), hi = std::min(range.hi, panels.back());
    if (!(hi > lo)) return 0.0;

    ShortSorted sides;
    sides.insert(hi);
    const auto add = [&](double k) {
        if (k > lo && k < hi) sides.insert(k);
    };
    for (double x : {cell.kx0, cell.kx1}) {
        if (cell.ky0 < 0.0 && cell.ky1 > 0.0) add(std::abs(x));
        for (double y : {cell.ky0, cell.ky1}) add(std::hypot(x, y));
    }
    if (cell.kx0 < 0.0 && cell.kx1 > 0.0) {
        for (double y : {cell.ky0, cell.ky1}) add(std::abs(y));
    }

    const auto inner = between(panels, {lo, hi});
    const auto& rule = GaussLegendre<6>::rule();
    auto panel = inner.begin();
    double sum = 0.0, from = lo;
    for (std::size_t side = 0; side < sides.count;) {
        double to = sides.value[side];
        if (panel != inner.end() && *panel < to) {
            to = *panel++;
        } else {
            ++side;
        }
        if (!(to > from)) continue;
        sum += rule.integrate(0.0, 1.0, [&](double t) {
            const double k = from + (to - from) * t * t * (3.0 - 2.0 * t);
            return 6.0 * t * (1.0 - t) * (to - from) * arc_in_rectangle(spectrum, cell, k);
        });
        from = to;
    }
    return sum;
}

// Both spectrum and arc are smooth across the cell.
double product_energy(const DirectionalSpectrum& spectrum, const Cell& cell) {
    const auto& rule = GaussLegendre<3>::rule();
    return rule.integrate(cell.ky0, cell.ky1, [&](double ky) {
        return rule.integrate(cell.kx0, cell.kx1, [&](double kx) {
            const double k = std::sqrt(kx * kx + ky * ky);
            return spectrum.polar(k, std::atan2(ky, kx)) / k;
        });
    });
}

}  // namespace

double cell_energy(const DirectionalSpectrum& spectrum, const Cell& cell) {
    if (spectrum.empty()) return 0.0;
    const RadialRange whole = radial_range(cell);
    const RadialRange band{std::max(whole.lo, cell.k_lo), std::min(whole.hi, cell.k_hi)};
    if (!(band.hi > band.lo)) return 0.0;

    // From here a cell is a small fraction of every feature's width: a swell's hump is 4 cells wide, a
    // measured needle of 2° one.
    constexpr double kFarInCells = 32.0;
    const double side = std::max(cell.kx1 - cell.kx0, cell.ky1 - cell.ky0);
    const bool far = whole.lo > kFarInCells * side && band.lo == whole.lo && band.hi == whole.hi &&
                     between(spectrum.kinks(), whole).empty();
    return std::max(0.0, far ? product_energy(spectrum, cell) : polar_energy(spectrum, cell, band));
}

}  // namespace pelagic::oracle
