#include "core/spectrum/spectral_moments.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "core/base/constants.h"
#include "core/spectrum/gauss.h"

namespace pelagic {

double SpectralMoments::significant_height_m() const {
    return 4.0 * std::sqrt(m0);
}

double SpectralMoments::energy_period_s() const {
    return m0 > 0.0 ? 2.0 * kPi * m_minus1 / m0 : 0.0;
}

double SpectralMoments::mean_direction() const {
    return std::atan2(north, east);
}

SpectralMoments moments_of(const Wave& wave) {
    const auto [kx, ky] = std::array{wave.k.x, wave.k.y};
    const double length = std::hypot(kx, ky);
    const double gradient = wave.chop * wave.chop * wave.energy;
    SpectralMoments out;
    out.m0 = wave.energy;
    out.m_minus1 = wave.energy / wave.omega;
    out.xx = kx * kx * wave.energy;
    out.xy = kx * ky * wave.energy;
    out.yy = ky * ky * wave.energy;
    out.xxxx = gradient * kx * kx * kx * kx;
    out.xxxy = gradient * kx * kx * kx * ky;
    out.xxyy = gradient * kx * kx * ky * ky;
    out.xyyy = gradient * kx * ky * ky * ky;
    out.yyyy = gradient * ky * ky * ky * ky;
    out.east = wave.energy * kx / length;
    out.north = wave.energy * ky / length;
    return out;
}

SpectralMoments moments(const DirectionalSpectrum& spectrum, double k_lo, double k_hi) {
    SpectralMoments out;
    std::complex<double> first{};
    const auto& rule = GaussLegendre<8>::rule();
    spectrum.for_panels(k_lo, k_hi, [&](double from, double to) {
        const double half = 0.5 * (to - from), middle = 0.5 * (to + from);
        for (std::size_t node = 0; node < rule.node.size(); ++node) {
            const double k = middle + half * rule.node[node];
            const WavePoint point = wave_point(spectrum.dispersion(), k);
            const double ratio = spectrum.dispersion().horizontal_ratio(k);
            for (const WaveSystem& system : spectrum.systems()) {
                const double energy = half * rule.weight[node] * system.energy(point);
                if (!(energy > 0.0)) continue;
                const auto [c1, c2, c4] = system.harmonics(point);
                out.m0 += energy;
                out.m_minus1 += energy / point.omega;
                first += energy * c1;

                // cos²θ = (1 + cos 2θ)/2, …
                const double slope = k * k * energy;
                out.xx += 0.5 * slope * (1.0 + c2.real());
                out.xy += 0.5 * slope * c2.imag();
                out.yy += 0.5 * slope * (1.0 - c2.real());

                // cos⁴θ = (3 + 4 cos 2θ + cos 4θ)/8, cos³θ sin θ = (2 sin 2θ + sin 4θ)/8, …
                const double eighth = 0.125 * slope * ratio * ratio;
                out.xxxx += eighth * (3.0 + 4.0 * c2.real() + c4.real());
                out.xxxy += eighth * (2.0 * c2.imag() + c4.imag());
                out.xxyy += eighth * (1.0 - c4.real());
                out.xyyy += eighth * (2.0 * c2.imag() - c4.imag());
                out.yyyy += eighth * (3.0 - 4.0 * c2.real() + c4.real());
            }
        }
    });
    out.east = first.real();
    out.north = first.imag();
    return out;
}

}  // namespace pelagic
