#include "core/spectrum/spectrum_table.h"

#include <algorithm>
#include <cmath>

#include "core/base/constants.h"

namespace pelagic {
namespace {

constexpr int kNodes = TableTerm::kCoefficients;
constexpr double kWidestPanel = 1.12;  // from end to end; a swell's hump is 14 % wide in k

using Values = std::array<double, kNodes>;

// Chebyshev nodes on [−1, 1], none at the ends, where a law may jump.
double node(int i) {
    return std::cos(kPi * (i + 0.5) / kNodes);
}

// The powers' coefficients of the polynomial through the values at the nodes.
Values interpolate(const Values& at_nodes) {
    struct Chebyshev {
        double cosine[kNodes][kNodes];  // T_m at node j, times 2/n; m = 0: 1/n
        double power[kNodes][kNodes]{};  // T_m's coefficient of t^p
        Chebyshev() {
            for (int m = 0; m < kNodes; ++m)
                for (int j = 0; j < kNodes; ++j)
                    cosine[m][j] = (m == 0 ? 1.0 : 2.0) / kNodes * std::cos(m * kPi * (j + 0.5) / kNodes);
            power[0][0] = power[1][1] = 1.0;
            for (int m = 2; m < kNodes; ++m)
                for (int p = 0; p < kNodes; ++p)
                    power[m][p] = (p > 0 ? 2.0 * power[m - 1][p - 1] : 0.0) - power[m - 2][p];
        }
    };
    static const Chebyshev table;
    Values out{};
    for (int m = 0; m < kNodes; ++m) {
        double coefficient = 0.0;
        for (int j = 0; j < kNodes; ++j) coefficient += table.cosine[m][j] * at_nodes[j];
        for (int p = 0; p < kNodes; ++p) out[p] += coefficient * table.power[m][p];
    }
    return out;
}

struct Sampled {
    double norm, parameter;
};
struct Sample {
    Sampled operator()(const CosinePower& shape) const { return {shape.norm(), shape.sharpness()}; }
    Sampled operator()(const SechSquared& shape) const { return {shape.norm() * shape.beta(), shape.beta()}; }
    Sampled operator()(const CosineSquared&) const { return {2.0 / kPi, 0.0}; }
    Sampled operator()(const SecondHarmonic& shape) const { return {1.0 / kTwoPi, shape.delta()}; }
    Sampled operator()(const MaximumEntropy& shape) const { return {shape.numerator(), 0.0}; }
};

}  // namespace

SpectrumTable::SpectrumTable(const DirectionalSpectrum& spectrum) {
    if (spectrum.panels().empty()) return;
    kinks_.assign(spectrum.kinks().begin(), spectrum.kinks().end());
    kinks_.insert(kinks_.end(), {spectrum.panels().front(), spectrum.panels().back()});
    std::sort(kinks_.begin(), kinks_.end());
    kinks_.erase(std::unique(kinks_.begin(), kinks_.end()), kinks_.end());

    // Widths that count as 1: those of a swell's hump in deep water, in k, and of its spreading.
    constexpr double kUsualWidth = 0.14, kSwellInOmega = SwellEnergy::kRelativeWidth;
    for (std::size_t i = 0; i + 1 < kinks_.size(); ++i) {
        const double ratio = kinks_[i + 1] / kinks_[i];
        const int pieces = std::max(1, static_cast<int>(std::ceil(std::log(ratio) / std::log(kWidestPanel))));
        for (int piece = 0; piece < pieces; ++piece) {
            TablePanel panel;
            panel.k_lo = piece == 0 ? kinks_[i] : panels_.back().k_hi;
            panel.k_hi = piece + 1 == pieces ? kinks_[i + 1]
                                             : kinks_[i] * std::pow(ratio, (piece + 1.0) / pieces);
            panel.first_term = terms_.size();
            const double middle = 0.5 * (panel.k_lo + panel.k_hi), half = 0.5 * (panel.k_hi - panel.k_lo);
            std::array<WavePoint, kNodes> points;
            for (int n = 0; n < kNodes; ++n)
                points[n] = wave_point(spectrum.dispersion(), middle + half * node(n));
            const WavePoint& at_middle = points[kNodes / 2];
            panel.width = std::min(1.0, kSwellInOmega / kUsualWidth * at_middle.omega /
                                            (at_middle.k * at_middle.domega_dk));
            for (const WaveSystem& system : spectrum.systems()) {
                Values amplitude{}, parameter{};
                double largest = 0.0;
                AngularShape shape = CosineSquared();
                for (int n = 0; n < kNodes; ++n) {
                    amplitude[n] = system.energy(points[n]) / points[n].k;
                    largest = std::max(largest, amplitude[n]);
                }
                if (!(largest > 0.0)) continue;
                for (int n = 0; n < kNodes; ++n) {
                    shape = system.shape(points[n]);
                    const auto [norm, value] = std::visit(Sample(), shape);
                    amplitude[n] *= norm;
                    parameter[n] = value;
                }
                TableTerm term{.shape = shape.index(),
                               .cos_direction = std::cos(system.direction()),
                               .sin_direction = std::sin(system.direction()),
                               .amplitude = interpolate(amplitude),
                               .parameter = interpolate(parameter)};
                if (const auto* measured = std::get_if<MaximumEntropy>(&shape))
                    term.denominator = measured->denominator();
                const double scale = std::visit([](const auto& s) { return s.scale(); }, shape);
                panel.width = std::min(panel.width, scale / kUsualWidth);
                terms_.push_back(term);
            }
            panel.terms = terms_.size() - panel.first_term;
            panels_.push_back(panel);
        }
    }
}

}  // namespace pelagic
