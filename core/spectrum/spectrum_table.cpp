#include "core/spectrum/spectrum_table.h"

#include <algorithm>
#include <cmath>

#include "core/base/constants.h"
#include "core/spectrum/directed.h"

namespace pelagic {
namespace {

constexpr int kNodes = TableTerm::kCoefficients;
// Widths that count as 1: a swell's hump in deep water, relative to k, and its spreading [rad].
constexpr double kUsualWidth = 0.14;
constexpr double kWidestPanel = 0.09;  // relative to k, where the hump has its usual width

using Values = std::array<double, kNodes>;

// Chebyshev nodes on [−1, 1], none at the ends, where a law may jump.
double node(int i) {
    return std::cos(kPi * (i + 0.5) / kNodes);
}

// The powers' coefficients of the polynomial through the values at the nodes.
Values interpolate(const Values& at_nodes) {
    struct Chebyshev {
        double cosine[kNodes][kNodes];   // T_m at node j, times 2/n; m = 0: 1/n
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

// How wide a swell's hump is at this wavenumber: half as wide where waves feel the bottom, a third where they
// are capillary. Wind seas' peaks are no narrower.
double hump_width(const WavePoint& point) {
    return std::min(1.0,
                    SwellEnergy::kRelativeWidth / kUsualWidth * point.omega / (point.k * point.domega_dk));
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

// Measures a buoy's directions, which are absolute, from the mean towards which directionality narrows them.
void turn_to_centre(TableTerm& term, double centre) {
    const std::array<double, 5> d = term.denominator;
    const double c = std::cos(centre), s = std::sin(centre), c2 = std::cos(2.0 * centre),
                 s2 = std::sin(2.0 * centre);
    term.denominator = {d[0], d[1] * c + d[2] * s, d[2] * c - d[1] * s, d[3] * c2 + d[4] * s2,
                        d[4] * c2 - d[3] * s2};
    term.cos_direction = c;
    term.sin_direction = s;
}

// How much the parameters of the spreadings change from k0 to k1, as logarithms: in young seas under strong wind they
// vanish within a few per cent of k. Parameters near 0 count as equal to 0.
double parameter_change(const DirectionalSpectrum& spectrum, double k0, double k1) {
    constexpr double kNearZero = 0.01;
    double most = 0.0;
    for (const WaveSystem& system : spectrum.systems()) {
        const auto at = [&](double k) {
            const AngularShape shape = system.shape(wave_point(spectrum.dispersion(), k));
            return std::log(kNearZero + std::abs(std::visit(Sample(), shape).parameter));
        };
        most = std::max(most, std::abs(at(k1) - at(k0)));
    }
    return most;
}

// Where the panel that begins at k ends; the last two before the kink share what is left.
double panel_end(const DirectionalSpectrum& spectrum, double k, double kink) {
    constexpr double kMostChange = 0.5;
    double step = 1.0 + kWidestPanel * hump_width(wave_point(spectrum.dispersion(), k));
    while (parameter_change(spectrum, k, std::min(kink, k * step)) > kMostChange) step = std::sqrt(step);
    if (k * step >= kink) return kink;
    return k * step * step >= kink ? std::sqrt(k * kink) : k * step;
}

}  // namespace

SpectrumTable::SpectrumTable(const DirectionalSpectrum& spectrum) {
    if (spectrum.panels().empty()) return;
    kinks_.assign(spectrum.kinks().begin(), spectrum.kinks().end());
    kinks_.insert(kinks_.end(), {spectrum.panels().front(), spectrum.panels().back()});
    std::sort(kinks_.begin(), kinks_.end());
    kinks_.erase(std::unique(kinks_.begin(), kinks_.end()), kinks_.end());

    for (std::size_t i = 0; i + 1 < kinks_.size(); ++i) {
        for (double k = kinks_[i]; k < kinks_[i + 1];) {
            TablePanel panel;
            panel.k_lo = k;
            panel.k_hi = k = panel_end(spectrum, k, kinks_[i + 1]);
            panel.first_term = terms_.size();
            const double middle = 0.5 * (panel.k_lo + panel.k_hi), half = 0.5 * (panel.k_hi - panel.k_lo);
            std::array<WavePoint, kNodes> points;
            for (int n = 0; n < kNodes; ++n)
                points[n] = wave_point(spectrum.dispersion(), middle + half * node(n));
            panel.width = hump_width(points[kNodes / 2]);
            for (const WaveSystem& system : spectrum.systems()) {
                Values amplitude{}, parameter{}, alike{};
                double largest = 0.0;
                const double directionality = system.directionality(), own = std::min(directionality, 1.0);
                AngularShape shape = CosineSquared();
                for (int n = 0; n < kNodes; ++n) {
                    amplitude[n] = system.energy(points[n]) / points[n].k;
                    largest = std::max(largest, amplitude[n]);
                }
                if (!(largest > 0.0)) continue;
                for (int n = 0; n < kNodes; ++n) {
                    shape = system.shape(points[n]);
                    const auto [norm, value] = std::visit(Sample(), shape);
                    alike[n] = (1.0 - own) / kTwoPi * amplitude[n];
                    amplitude[n] *= own * norm;
                    parameter[n] = value;
                }
                TableTerm term{.shape = shape.index(),
                               .cos_direction = std::cos(system.direction()),
                               .sin_direction = std::sin(system.direction()),
                               .amplitude = interpolate(amplitude),
                               .parameter = interpolate(parameter),
                               .directionality = std::max(directionality, 1.0)};
                if (const auto* measured = std::get_if<MaximumEntropy>(&shape)) {
                    term.denominator = measured->denominator();
                    if (directionality > 1.0) turn_to_centre(term, measured->centre());
                }
                const double scale = std::visit([](const auto& s) { return s.scale(); }, shape);
                panel.width = std::min(panel.width, scale / term.directionality / kUsualWidth);
                terms_.push_back(term);
                if (!(own < 1.0)) continue;
                TableTerm isotropic = term;  // cos⁰
                isotropic.shape = AngularShape(CosinePower(0.0)).index();
                isotropic.parameter = {};
                isotropic.amplitude = interpolate(alike);
                terms_.push_back(isotropic);
            }
            panel.terms = terms_.size() - panel.first_term;
            panels_.push_back(panel);
        }
    }
}

}  // namespace pelagic
