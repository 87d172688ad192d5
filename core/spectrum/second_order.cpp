#include "core/spectrum/second_order.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/base/constants.h"
#include "core/spectrum/gauss.h"

namespace pelagic {
namespace {

constexpr std::size_t kDirections = 24;

// Waves that stand for a part of the spectrum.
struct Node {
    double k, theta, share;  // share: of m0
    std::size_t bin;
};

double coth(double kd) {
    return kd < Dispersion::kDeep ? 1.0 / std::tanh(kd) : 1.0;
}

}  // namespace

PairKernels pair_kernels(double k1, double theta1, double k2, double theta2, double depth_m) {
    const double cosine = std::cos(theta1 - theta2), dot = k1 * k2 * cosine;
    const auto slow = [&](double k) { return k * std::min(std::tanh(k * depth_m), 1.0); };  // ω²/g
    const double r1 = slow(k1), r2 = slow(k2), s1 = std::sqrt(r1), s2 = std::sqrt(r2);
    const double square = k1 * k1 + k2 * k2;
    const double apart = std::sqrt(std::max(square - 2.0 * dot, 0.0)),
                 together = std::sqrt(std::max(square + 2.0 * dot, 0.0));
    // Sharma and Dean 1981: the potential of a pair. That of the difference of two equal waves is a constant: its limit is 0.
    const double rest1 = k1 * k1 - r1 * r1, rest2 = k2 * k2 - r2 * r2;
    const double slower = s1 - s2, faster = s1 + s2;
    const double below = slower * slower - (apart > 0.0 ? slow(apart) : 0.0);
    double difference = 0.0;
    if (std::abs(below) > 1e-12 * (r1 + r2))
        difference = (slower * (s2 * rest1 - s1 * rest2) + 2.0 * slower * slower * (dot + r1 * r2)) / below;
    const double above = faster * faster - (together > 0.0 ? slow(together) : 0.0);
    const double sum = (faster * (s1 * rest2 + s2 * rest1) + 2.0 * faster * faster * (dot - r1 * r2)) / above;
    const double per = 1.0 / (s1 * s2);
    const double displaced = cosine * (k1 * coth(k2 * depth_m) + k2 * coth(k1 * depth_m));
    return {.difference = (difference - dot - r1 * r2) * per + r1 + r2 + displaced,
            .sum = (sum - dot + r1 * r2) * per + r1 + r2 - displaced,
            .displaced = displaced};
}

double shallow_wavenumber(double k, double depth_m) {
    const double c = coth(k * depth_m);
    return 3.0 * k * c * (c - 1.0) * (c + 1.0);
}

SecondOrder::Sums& SecondOrder::Sums::operator+=(const Sums& other) {
    difference += other.difference;
    sum += other.sum;
    together += other.together;
    against += other.against;
    shallow += other.shallow;
    return *this;
}

SecondOrder::Sums SecondOrder::sums(std::size_t first, std::size_t last) const {
    Sums all;
    for (std::size_t i = first; i < last; ++i)
        for (std::size_t j = first; j < last; ++j) all += pairs[i][j];
    return all;
}

// E[η³] = 3 E[η₁² η₂]; the displaced part of K⁻ is that of K⁺ with the other sign.
double SecondOrder::skewness() const {
    const Sums all = sums(0, kBins);
    return 1.5 * (all.difference + all.sum) * deviation_m;
}

double SecondOrder::limit() const {
    const double skewness = std::abs(this->skewness());
    return skewness > kLargestSkewness ? kLargestSkewness / skewness : 1.0;
}

SecondOrder second_order(const DirectionalSpectrum& spectrum) {
    SecondOrder result;
    if (!(spectrum.m0() > 0.0)) return result;
    result.deviation_m = std::sqrt(spectrum.m0());

    // The spectrum's panels, cut up until the energy up to a wavenumber is known finely.
    struct Part {
        double k, energy;
    };
    constexpr int kCuts = 16;
    std::vector<Part> parts;
    double whole = 0.0;
    const auto& rule = GaussLegendre<4>::rule();
    spectrum.for_panels(0.0, std::numeric_limits<double>::infinity(), [&](double from, double to) {
        for (int cut = 0; cut < kCuts; ++cut) {
            const double half = 0.5 * (to - from) / kCuts, middle = from + (2 * cut + 1) * half;
            for (std::size_t n = 0; n < rule.node.size(); ++n) {
                const double k = middle + half * rule.node[n];
                const double energy = half * rule.weight[n] * spectrum.omnidirectional(k);
                if (!(energy > 0.0)) continue;
                parts.push_back({k, energy});
                whole += energy;
            }
        }
    });
    if (parts.empty()) return result;

    std::vector<Node> nodes;
    result.edges.front() = parts.front().k;
    std::size_t next = 0;
    double before = 0.0;
    for (std::size_t bin = 0; bin < SecondOrder::kBins; ++bin) {
        const double end = whole * static_cast<double>(bin + 1) / SecondOrder::kBins;
        double energy = 0.0, logs = 0.0;
        while (next < parts.size() &&
               (before + energy + 0.5 * parts[next].energy < end || bin + 1 == SecondOrder::kBins)) {
            energy += parts[next].energy;
            logs += parts[next].energy * std::log(parts[next].k);
            ++next;
        }
        before += energy;
        result.edges[bin + 1] = parts[std::min(next, parts.size() - 1)].k;
        if (!(energy > 0.0)) continue;
        // Its mean direction's neighbourhood may be narrow: arcs hold all of it, whatever their width.
        const double k = std::exp(logs / energy), density = spectrum.omnidirectional(k);
        if (!(density > 0.0)) continue;
        for (std::size_t d = 0; d < kDirections; ++d) {
            const double width = kTwoPi / kDirections, theta = (static_cast<double>(d) - 0.5) * width;
            const double part = spectrum.arc(k, theta, theta + width) / density;
            constexpr double kLeast = 1e-4;
            if (part > kLeast) nodes.push_back({k, theta + 0.5 * width, part * energy / whole, bin});
        }
    }
    const double depth_m = spectrum.dispersion().depth_m;
    for (std::size_t a = 0; a < nodes.size(); ++a)
        for (std::size_t b = a; b < nodes.size(); ++b) {
            const Node &first = nodes[a], &second = nodes[b];
            const double share = (a == b ? 1.0 : 2.0) * first.share * second.share;
            const PairKernels kernels = pair_kernels(first.k, first.theta, second.k, second.theta, depth_m);
            const double mean = share * std::sqrt(first.k * second.k),
                         cosine = std::cos(first.theta - second.theta);
            result.pairs[first.bin][second.bin] +=
                {.difference = share * kernels.difference,
                 .sum = share * kernels.sum,
                 .together = mean * (1.0 + cosine),
                 .against = mean * (1.0 - cosine),
                 .shallow = share * std::sqrt(shallow_wavenumber(first.k, depth_m) *
                                              shallow_wavenumber(second.k, depth_m))};
        }
    return result;
}

}  // namespace pelagic
