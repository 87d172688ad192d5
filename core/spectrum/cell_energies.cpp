#include "core/spectrum/cell_energies.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "core/base/constants.h"
#include "core/base/disc.h"
#include "core/spectrum/gauss.h"

namespace pelagic {
namespace {

constexpr double kPolarWithin = 8.0, kSixteenWithin = 48.0, kFourWithin = 192.0;

}  // namespace

// Points that are evaluated together, all in one panel.
struct CellEnergies::Nodes {
    static constexpr std::size_t kMost = 256;
    std::size_t count = 0;
    std::array<double, kMost + kDensitySlack> k, cosine, sine, weight;
    std::array<double, kMost + kDensitySlack> same, opposite, below, above;

    void put(double at_k, double x, double y, double w) {
        k[count] = at_k;
        cosine[count] = x;
        sine[count] = y;
        weight[count++] = w;
    }
};

CellEnergies::CellEnergies(const SpectrumTable& table, double size_m, double k_lower, double k_upper)
    : table_(table),
      kernels_(density_kernels()),
      step_(kTwoPi / size_m),
      k_lower_(k_lower),
      k_upper_(k_upper) {
    for (const double k : table.kinks()) cuts_.push_back(k / step_);
    cuts_.push_back(k_lower / step_);
    if (std::isfinite(k_upper)) cuts_.push_back(k_upper / step_);

    const double lower = k_lower / step_, upper = k_upper / step_;
    const auto until = [&](double radius, Rule rule, std::size_t panel) {
        const double end = radius * radius;
        if (end > (rings_.empty() ? 0.0 : rings_.back().end)) rings_.push_back({end, rule, panel});
    };
    for (std::size_t p = 0; p < table.panels().size(); ++p) {
        const TablePanel& panel = table.panels()[p];
        const double from = std::max(panel.k_lo / step_, lower), to = std::min(panel.k_hi / step_, upper);
        if (!(to > from)) continue;
        until(from, Rule::Nothing, p);
        until(std::min(to, kPolarWithin / panel.width), Rule::Polar, p);
        until(std::min(to, kSixteenWithin / panel.width), Rule::Sixteen, p);
        until(std::min(to, kFourWithin / panel.width), Rule::Four, p);
        until(to, Rule::One, p);
    }
    rings_.push_back({std::numeric_limits<double>::infinity(), Rule::Nothing, 0});
}

void CellEnergies::column(int mx, int height, const FourWays& energy) const {
    const int end = height + 1;
    // Cells that a cut crosses: their nearest corner is inside it, their farthest outside.
    std::vector<char> is_cut(end, 0);
    const double near_x = std::max(mx - 0.5, 0.0), far_x = mx + 0.5;
    for (const double cut : cuts_) {
        const double square = cut * cut, at_near = square - near_x * near_x;
        if (!(at_near > 0.0)) continue;
        const double at_far = square - far_x * far_x;
        const double first = at_far > 0.0 ? std::floor(std::sqrt(at_far) + 0.5) : 0.0;
        const double last = std::ceil(std::sqrt(at_near) + 0.5);
        for (int my = static_cast<int>(std::min<double>(first, end)); my < end && my <= last; ++my) {
            const double near_y = std::max(my - 0.5, 0.0), far_y = my + 0.5;
            if (near_y * near_y < at_near && far_y * far_y > at_far) is_cut[my] = 1;
        }
    }

    const auto put = [&](int my, const Sum& sum) {
        energy.same[my] = sum.same;
        energy.opposite[my] = sum.opposite;
        energy.below[my] = sum.below;
        energy.above[my] = sum.above;
    };
    int my = 0;
    for (const Ring& ring : rings_) {
        const int ring_end = first_beyond(ring.end, mx, end);
        while (my < ring_end) {
            if (mx == 0 && my == 0) {
                put(my++, {});
            } else if (is_cut[my]) {
                put(my, cell(mx, my, true));
                ++my;
            } else if (ring.rule == Rule::Nothing) {
                put(my++, {});
            } else if (ring.rule == Rule::Polar || ring.rule == Rule::Sixteen) {
                put(my, cell(mx, my, ring.rule == Rule::Polar));
                ++my;
            } else {
                int run_end = my + 1;
                while (run_end < ring_end && !is_cut[run_end]) ++run_end;
                run(ring, mx, my, run_end, energy);
                my = run_end;
            }
        }
        if (my == end) break;
    }
}

// Many cells at once, far out: the same few nodes in each.
void CellEnergies::run(const Ring& ring, int mx, int first_my, int end_my, const FourWays& energy) const {
    static constexpr double kOffset = 0.28867513459481287;  // 1/(2√3): two Gauss nodes in a cell
    static constexpr std::array<double, 2> kTwo{-kOffset, kOffset};
    static constexpr std::array<double, 1> kOne{0.0};
    const auto offsets =
        ring.rule == Rule::Four ? std::span<const double>(kTwo) : std::span<const double>(kOne);
    const double weight = step_ * step_ / static_cast<double>(offsets.size() * offsets.size());
    const TablePanel& panel = table_.panels()[ring.panel];
    std::array<double, Nodes::kMost + kDensitySlack> k, cosine, sine;
    for (int my = first_my; my < end_my; my += static_cast<int>(Nodes::kMost)) {
        const auto count = std::min<std::size_t>(end_my - my, Nodes::kMost);
        const FourWays sum{energy.same + my, energy.opposite + my, energy.below + my, energy.above + my};
        for (double* values : {sum.same, sum.opposite, sum.below, sum.above})
            std::fill_n(values, count + kDensitySlack, 0.0);
        for (const double dx : offsets)
            for (const double dy : offsets) {
                kernels_.column(mx + dx, dy, my, step_, count, k.data(), cosine.data(), sine.data());
                for (const TableTerm& term : table_.terms(panel))
                    kernels_.add_density(panel, term, weight, count, k.data(), cosine.data(), sine.data(),
                                         sum);
            }
    }
    if (mx > 0) return;
    // Column 0's mirror images are modes of the column itself: the same bits on both sides.
    std::copy(energy.same + first_my, energy.same + end_my, energy.above + first_my);
    std::copy(energy.opposite + first_my, energy.opposite + end_my, energy.below + first_my);
}

// A cell of the first quadrant and its mirror images. On an axis half of the cell lies in the quadrant, and
// the other half is in one of the images.
CellEnergies::Sum CellEnergies::cell(int mx, int my, bool is_polar) const {
    Sum sum;
    is_polar ? polar(mx, my, sum) : sixteen(mx, my, sum);
    if (mx == 0) {
        sum.same = sum.above = sum.same + sum.above;
        sum.opposite = sum.below = sum.opposite + sum.below;
    } else if (my == 0) {
        sum.same = sum.below = sum.same + sum.below;
        sum.opposite = sum.above = sum.opposite + sum.above;
    }
    return sum;
}

// ∬ Ψ k dk dθ. A place on the circle of radius k is given by its coordinate p on the axis that is farther away; with
// q = √(k² − p²) on the other axis dθ = dp/q. Where the circle enters or leaves the cell by a corner, p's range has a
// kink in k, and where it touches a side a square root. The substitution k = a + (b − a) t²(3 − 2t) makes both ends
// smooth.
void CellEnergies::polar(int mx, int my, Sum& sum) const {
    const bool is_turned = my > mx;  // p along x then
    const int along = std::min(mx, my), across = std::max(mx, my);
    const double p0 = std::max(along - 0.5, 0.0) * step_, p1 = (along + 0.5) * step_;
    const double q0 = (across - 0.5) * step_, q1 = (across + 0.5) * step_;
    std::array<double, 4> corners{std::hypot(p0, q0), std::hypot(p1, q0), std::hypot(p0, q1),
                                  std::hypot(p1, q1)};
    std::sort(corners.begin(), corners.end());
    const auto panels = table_.panels();
    if (panels.empty()) return;
    const double lo = std::max({corners.front(), k_lower_, panels.front().k_lo});
    const double hi = std::min({corners.back(), k_upper_, panels.back().k_hi});
    if (!(hi > lo)) return;

    const auto& radial = GaussLegendre<8>::rule();
    const auto& angular = GaussLegendre<4>::rule();
    constexpr double kWidestPiece = 0.4;  // rad: 1/q is smooth across it
    constexpr double kUsualWidth = 0.14;  // rad, of a panel of width 1
    Nodes nodes;
    std::size_t p = std::upper_bound(panels.begin(), panels.end(), lo,
                                     [](double k, const TablePanel& panel) { return k < panel.k_hi; }) -
                    panels.begin();
    for (double from = lo; p < panels.size() && from < hi; ++p) {
        const double panel_end = std::min(hi, panels[p].k_hi);
        const double piece_angle = std::min(kWidestPiece, kUsualWidth * panels[p].width);
        while (from < panel_end) {
            const auto corner = std::upper_bound(corners.begin(), corners.end(), from);
            const double to = corner == corners.end() ? panel_end : std::min(panel_end, *corner);
            for (std::size_t i = 0; i < radial.node.size(); ++i) {
                const double t = 0.5 + 0.5 * radial.node[i];
                const double k = from + (to - from) * t * t * (3.0 - 2.0 * t);
                const double dk = 0.5 * radial.weight[i] * 6.0 * t * (1.0 - t) * (to - from);
                const double first = std::max(p0, std::sqrt(std::max(k * k - q1 * q1, 0.0)));
                const double last = std::min(p1, std::sqrt(std::max(k * k - q0 * q0, 0.0)));
                if (!(last > first)) continue;
                const int pieces = static_cast<int>(std::ceil((last - first) / (q0 * piece_angle)));
                const double half = 0.5 * (last - first) / pieces;
                for (int piece = 0; piece < pieces; ++piece) {
                    const double middle = first + (2 * piece + 1) * half;
                    if (nodes.count + angular.node.size() > Nodes::kMost) add(p, nodes, sum);
                    for (std::size_t j = 0; j < angular.node.size(); ++j) {
                        const double at = middle + half * angular.node[j];
                        const double q = std::sqrt(k * k - at * at);
                        const double weight = dk * k * half * angular.weight[j] / q;
                        is_turned ? nodes.put(k, at / k, q / k, weight) : nodes.put(k, q / k, at / k, weight);
                    }
                }
            }
            from = to;
        }
        add(p, nodes, sum);
    }
}

void CellEnergies::sixteen(int mx, int my, Sum& sum) const {
    const double x0 = std::max(mx - 0.5, 0.0) * step_, x1 = (mx + 0.5) * step_;
    const double y0 = std::max(my - 0.5, 0.0) * step_, y1 = (my + 0.5) * step_;
    const auto& rule = GaussLegendre<4>::rule();
    constexpr std::size_t kCount = 16;
    std::array<double, kCount> k, x, y, weight;
    for (std::size_t i = 0; i < kCount; ++i) {
        x[i] = 0.5 * (x0 + x1) + 0.5 * (x1 - x0) * rule.node[i / 4];
        y[i] = 0.5 * (y0 + y1) + 0.5 * (y1 - y0) * rule.node[i % 4];
        weight[i] = 0.25 * (x1 - x0) * (y1 - y0) * rule.weight[i / 4] * rule.weight[i % 4];
        k[i] = std::sqrt(x[i] * x[i] + y[i] * y[i]);
    }
    // Panel by panel: the cell may lie in several.
    const auto panels = table_.panels();
    std::size_t p = std::upper_bound(panels.begin(), panels.end(), *std::min_element(k.begin(), k.end()),
                                     [](double at, const TablePanel& panel) { return at < panel.k_hi; }) -
                    panels.begin();
    Nodes nodes;
    for (std::size_t done = 0; p < panels.size() && done < kCount; ++p) {
        for (std::size_t i = 0; i < kCount; ++i)
            if (k[i] >= panels[p].k_lo && k[i] < panels[p].k_hi)
                nodes.put(k[i], x[i] / k[i], y[i] / k[i], weight[i]);
        done += nodes.count;
        add(p, nodes, sum);
    }
}

void CellEnergies::add(std::size_t panel, Nodes& nodes, Sum& sum) const {
    if (nodes.count == 0) return;
    const FourWays density{nodes.same.data(), nodes.opposite.data(), nodes.below.data(), nodes.above.data()};
    for (std::size_t i = 0; i < kDensitySlack; ++i) {  // whole vectors of numbers
        nodes.k[nodes.count + i] = nodes.k[nodes.count - 1];
        nodes.cosine[nodes.count + i] = nodes.sine[nodes.count + i] = 0.0;
    }
    for (double* values : {density.same, density.opposite, density.below, density.above})
        std::fill_n(values, nodes.count + kDensitySlack, 0.0);
    const TablePanel& in = table_.panels()[panel];
    for (const TableTerm& term : table_.terms(in))
        kernels_.add_density(in, term, 1.0, nodes.count, nodes.k.data(), nodes.cosine.data(),
                             nodes.sine.data(), density);
    for (std::size_t i = 0; i < nodes.count; ++i) {
        sum.same += nodes.weight[i] * nodes.same[i];
        sum.opposite += nodes.weight[i] * nodes.opposite[i];
        sum.below += nodes.weight[i] * nodes.below[i];
        sum.above += nodes.weight[i] * nodes.above[i];
    }
    nodes.count = 0;
}

}  // namespace pelagic
