#include "core/spectrum/measured.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>

#include "core/base/constants.h"

namespace pelagic {

namespace {

std::string name(const MeasuredSpectrum& measured) {
    return "measured spectrum" + (measured.station.empty() ? "" : " of " + measured.station) +
           (measured.time.empty() ? "" : " at " + measured.time);
}

void refuse_unusable(const MeasuredSpectrum& measured) {
    const auto& bins = measured.bins;
    if (bins.size() < 2) throw std::invalid_argument(name(measured) + ": needs two frequencies or more");
    for (std::size_t i = 0; i < bins.size(); ++i) {
        const double below = i == 0 ? 0.0 : bins[i - 1].frequency_hz;
        if (!(bins[i].frequency_hz > below) || !std::isfinite(bins[i].frequency_hz)) {
            throw std::invalid_argument(name(measured) + ": frequencies must rise, from above 0 Hz");
        }
        if (!(bins[i].density_m2_per_hz >= 0.0) || !std::isfinite(bins[i].density_m2_per_hz)) {
            throw std::invalid_argument(name(measured) + ": the density at " +
                                        std::to_string(bins[i].frequency_hz) +
                                        " Hz must be a number from 0 up");
        }
    }
}

constexpr double kEquilibrium = 4.0, kSaturation = 5.0;

// The last bin that is more than rounding; in a sea so calm that there is none, the last with anything in it,
// and bins.size() when all are empty.
std::size_t last_kept(const std::vector<MeasuredSpectrum::Bin>& bins) {
    for (const double least : {MeasuredEnergy::kLeastDensity, 0.0}) {
        for (std::size_t i = bins.size(); i-- > 0;) {
            const double density = bins[i].density_m2_per_hz;
            if (density >= least && density > 0.0) return i;
        }
    }
    return bins.size();
}

// The exponent n of the tail f⁻ⁿ from the last reliable bins above the peak.
double tail_exponent(const std::vector<MeasuredSpectrum::Bin>& bins, double peak_hz) {
    constexpr double kAbovePeak = 1.5;      // the tail's slope begins about there
    constexpr std::size_t kMostBins = 8;    // the end of the band, not its whole
    constexpr std::size_t kFewestBins = 3;  // fewer give no slope

    std::vector<double> x, y;
    for (std::size_t i = bins.size(); i-- > 0 && x.size() < kMostBins;) {
        if (bins[i].frequency_hz <= kAbovePeak * peak_hz) break;
        if (bins[i].density_m2_per_hz < MeasuredEnergy::kReliableDensity) continue;
        x.push_back(std::log(bins[i].frequency_hz));
        y.push_back(std::log(bins[i].density_m2_per_hz));
    }
    if (x.size() < kFewestBins) return kSaturation;

    const double count = static_cast<double>(x.size());
    const double mean_x = std::accumulate(x.begin(), x.end(), 0.0) / count;
    const double mean_y = std::accumulate(y.begin(), y.end(), 0.0) / count;
    double xx = 0.0, xy = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        xx += (x[i] - mean_x) * (x[i] - mean_x);
        xy += (x[i] - mean_x) * (y[i] - mean_y);
    }
    return std::clamp(-xy / xx, kEquilibrium, kSaturation);
}

// A of the tail A f⁻ⁿ that goes on from the last three bins up to `last`, by their mean.
double tail_level(const std::vector<MeasuredSpectrum::Bin>& bins, std::size_t last, double exponent) {
    double sum = 0.0;
    int count = 0;
    for (std::size_t i = last + 1; i-- > 0 && count < 3; ++count) {
        sum += bins[i].density_m2_per_hz * std::pow(bins[i].frequency_hz, exponent);
    }
    return sum / count;
}

struct Coefficients {
    std::complex<double> c1, c2;
};

Coefficients coefficients(const MeasuredSpectrum::Bin& bin) {
    return {{bin.c1_re, bin.c1_im}, {bin.c2_re, bin.c2_im}};
}

// ∫ f⁻ⁿ df.
double power_integral(double exponent, double f0, double f1) {
    const double m = exponent - 1.0;
    return (std::pow(f0, -m) - std::pow(f1, -m)) / m;
}

}  // namespace

std::vector<double> bin_edges(const MeasuredSpectrum& measured) {
    const auto& bins = measured.bins;
    const std::size_t n = bins.size();
    const auto f = [&](std::size_t i) { return bins[i].frequency_hz; };

    // All solutions of e_{i+1} = 2 f_i − e_i are one solution plus (−1)^i δ: δ is the median of what the
    // midpoints ask for.
    std::vector<double> edges(n + 1);
    edges[0] = f(0) - 0.5 * (f(1) - f(0));
    for (std::size_t i = 0; i < n; ++i) edges[i + 1] = 2.0 * f(i) - edges[i];
    std::vector<double> wanted;
    for (std::size_t i = 1; i < n; ++i) {
        const double miss = 0.5 * (f(i - 1) + f(i)) - edges[i];
        wanted.push_back(i % 2 == 0 ? miss : -miss);
    }
    std::nth_element(wanted.begin(), wanted.begin() + wanted.size() / 2, wanted.end());
    const double delta = wanted[wanted.size() / 2];
    for (std::size_t i = 0; i <= n; ++i) edges[i] += i % 2 == 0 ? delta : -delta;

    bool separate = edges[0] > 0.0;
    for (std::size_t i = 0; i < n; ++i) separate = separate && edges[i] < f(i) && f(i) < edges[i + 1];
    if (separate) return edges;

    for (std::size_t i = 1; i < n; ++i) edges[i] = 0.5 * (f(i - 1) + f(i));
    edges[0] = std::max(0.5 * f(0), f(0) - 0.5 * (f(1) - f(0)));
    edges[n] = f(n - 1) + 0.5 * (f(n - 1) - f(n - 2));
    return edges;
}

double binned_m0(const MeasuredSpectrum& measured) {
    const std::vector<double> edges = bin_edges(measured);
    double sum = 0.0;
    for (std::size_t i = 0; i < measured.bins.size(); ++i) {
        sum += measured.bins[i].density_m2_per_hz * (edges[i + 1] - edges[i]);
    }
    return sum;
}

MeasuredEnergy::MeasuredEnergy(const MeasuredSpectrum& measured) {
    refuse_unusable(measured);
    const auto& bins = measured.bins;
    const auto density = [&](std::size_t i) { return bins[i].density_m2_per_hz; };
    const auto fullest = std::max_element(bins.begin(), bins.end(), [](const auto& a, const auto& b) {
        return a.density_m2_per_hz < b.density_m2_per_hz;
    });
    const double peak_hz = fullest->frequency_hz;
    peak_omega_ = kTwoPi * peak_hz;

    const std::size_t last = last_kept(bins);
    const std::vector<double> edges_hz = bin_edges(measured);
    const auto width = [&](std::size_t i) { return edges_hz[i + 1] - edges_hz[i]; };
    if (last == bins.size()) {  // not a wave in the whole hour
        edges_ = {kTwoPi * edges_hz.front(), kTwoPi * edges_hz.back(), kTwoPi * edges_hz.back()};
        bands_ = {Band{0.0, 0.0, 0.0}};
        return;
    }

    // The tail gets the energy of the bins that it replaces. Those may be mere rounding: so it stays within a factor
    // of the tail that continues the bins before it.
    constexpr double kMostChange = 3.0;
    tail_exponent_ = tail_exponent(bins, peak_hz);
    const double tail_hz = edges_hz[last + 1], end_hz = edges_hz.back();
    const double unit = power_integral(tail_exponent_, tail_hz, end_hz);
    double rest = 0.0;
    for (std::size_t i = last + 1; i < bins.size(); ++i) rest += density(i) * width(i);
    double amplitude = tail_level(bins, last, tail_exponent_);
    if (unit > 0.0) amplitude = std::clamp(rest / unit, amplitude / kMostChange, amplitude * kMostChange);
    const double tail_start = amplitude * std::pow(tail_hz, -tail_exponent_);

    // Edge values, then the parabola of each band.
    std::vector<double> at_edge(last + 2);
    at_edge.front() = 0.5 * density(0);
    for (std::size_t i = 1; i <= last; ++i) {
        at_edge[i] = (width(i) * density(i - 1) + width(i - 1) * density(i)) / (width(i - 1) + width(i));
    }
    at_edge.back() = tail_start;
    double below_tail = 0.0;
    for (std::size_t i = 0; i <= last; ++i) {
        const double left = at_edge[i], slope = at_edge[i + 1] - left;
        const double bend = 6.0 * density(i) - 3.0 * (left + at_edge[i + 1]);
        Band band{left, slope, bend};
        if (bend < 0.0) {
            const double x = 0.5 * (1.0 + slope / bend);
            if (x > 0.0 && x < 1.0 && left + x * (slope + bend * (1.0 - x)) < 0.0)
                band = {density(i), 0.0, 0.0};
        }
        bands_.push_back(band);
        edges_.push_back(kTwoPi * edges_hz[i]);
        below_tail += density(i) * width(i);
    }
    edges_.push_back(kTwoPi * tail_hz);
    edges_.push_back(kTwoPi * end_hz);

    const double scale = (below_tail + rest) / (below_tail + amplitude * unit) / kTwoPi;  // S(ω) = E(f)/2π
    for (Band& band : bands_) band = {band.left * scale, band.slope * scale, band.bend * scale};
    tail_amplitude_ = tail_start * scale;
}

double MeasuredEnergy::density(double omega) const {
    const double tail = edges_[bands_.size()], end = edges_.back();
    if (!(omega >= edges_.front())) return 0.0;
    if (omega >= tail) {
        const double to_end = std::pow(std::min(omega, end) / tail, -tail_exponent_);
        return tail_amplitude_ * to_end * (omega > end ? std::pow(omega / end, -kSaturation) : 1.0);
    }
    const auto above = std::upper_bound(edges_.begin(), edges_.begin() + bands_.size() + 1, omega);
    const std::size_t i = static_cast<std::size_t>(above - edges_.begin()) - 1;
    const double x = (omega - edges_[i]) / (edges_[i + 1] - edges_[i]);
    const Band& band = bands_[i];
    return std::max(0.0, band.left + x * (band.slope + band.bend * (1.0 - x)));
}

MeasuredSpreading::MeasuredSpreading(const MeasuredSpectrum& measured, double wind_direction_rad) {
    refuse_unusable(measured);
    const auto& bins = measured.bins;
    const std::vector<double> edges_hz = bin_edges(measured);
    for (std::size_t i = 1; i < edges_hz.size(); ++i) edges_.push_back(kTwoPi * edges_hz[i]);

    const auto usable = [](const MeasuredSpectrum::Bin& bin) {
        return bin.has_direction && std::isfinite(bin.c1_re) && std::isfinite(bin.c1_im) &&
               std::isfinite(bin.c2_re) && std::isfinite(bin.c2_im);
    };
    std::vector<std::size_t> known;
    for (std::size_t i = 0; i < bins.size(); ++i) {
        if (usable(bins[i])) known.push_back(i);
    }
    std::vector<Coefficients> each;
    for (std::size_t i = 0; i < bins.size(); ++i) {
        if (known.empty()) {  // cos⁸(θ/2): s/(s + 1) and s(s − 1)/((s + 1)(s + 2)) at s = 4
            each.push_back({std::polar(0.8, wind_direction_rad), std::polar(0.4, 2.0 * wind_direction_rad)});
            continue;
        }
        const auto at_or_above = std::lower_bound(known.begin(), known.end(), i);
        const std::size_t high = at_or_above == known.end() ? known.back() : *at_or_above;
        const std::size_t low = high <= i || at_or_above == known.begin() ? high : *(at_or_above - 1);
        const double span = bins[high].frequency_hz - bins[low].frequency_hz;
        const double x = span > 0.0 ? (bins[i].frequency_hz - bins[low].frequency_hz) / span : 0.0;
        const Coefficients from = coefficients(bins[low]), to = coefficients(bins[high]);
        each.push_back({from.c1 + x * (to.c1 - from.c1), from.c2 + x * (to.c2 - from.c2)});
    }

    const std::size_t last = std::min(last_kept(bins), bins.size() - 1);
    for (std::size_t i = 0; i <= last; ++i) bands_.emplace_back(each[i].c1, each[i].c2);
    edges_.resize(last + 1);

    const auto mean_from = [&](std::size_t first) {
        Coefficients sum{};
        double energy = 0.0;
        for (std::size_t i = first; i < bins.size(); ++i) {
            const double share = bins[i].density_m2_per_hz * (edges_hz[i + 1] - edges_hz[i]);
            energy += share;
            sum.c1 += share * each[i].c1;
            sum.c2 += share * each[i].c2;
        }
        return energy > 0.0 ? std::optional(Coefficients{sum.c1 / energy, sum.c2 / energy}) : std::nullopt;
    };
    const Coefficients tail =
        mean_from(last + 1).value_or(mean_from(last < 2 ? 0 : last - 2).value_or(each[last]));
    bands_.emplace_back(tail.c1, tail.c2);
}

const MaximumEntropy& MeasuredSpreading::at(double omega) const {
    const auto above = std::upper_bound(edges_.begin(), edges_.end(), omega);
    return bands_[static_cast<std::size_t>(above - edges_.begin())];
}

}  // namespace pelagic
