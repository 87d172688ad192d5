// The sea that a weather gives, beside what was observed: mean square slopes (Cox & Munk 1954) and growth with fetch
// (Kahma & Calkoen 1992, up to the full development of Pierson & Moskowitz 1964).
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "core/base/constants.h"
#include "core/spectrum/cox_munk.h"
#include "core/spectrum/spectral_moments.h"

namespace {

using namespace pelagic;

void slopes() {
    std::printf("\nMean square slope, default sea\n  %-8s %8s %10s %8s %22s\n", "m/s", "mss", "Cox & Munk",
                "ratio", "up / cross (observed)");
    double worst = 0.0, least = 1e9, most = 0.0;
    for (double wind = 5.0; wind <= 20.0; wind += 2.5) {
        SeaState state;
        state.wind_speed_mps = wind;
        const SpectralMoments sea =
            moments(DirectionalSpectrum(state), 0.0, std::numeric_limits<double>::infinity());
        const CoxMunk observed = CoxMunk::at_wind(wind);
        const double up = sea.xx / sea.yy;
        std::printf("  %-8.1f %8.4f %10.4f %8.2f %14.2f (%.2f)\n", wind, sea.mss(), observed.total,
                    sea.mss() / observed.total, up, observed.up / observed.cross);
        worst = std::max(worst, std::abs(sea.mss() / observed.total - 1.0));
        least = std::min(least, up);
        most = std::max(most, up);
    }
    std::printf("  at most %.0f %% off, target 15: %s; up / cross %.2f … %.2f, target 1.3 … 1.6: %s\n",
                100.0 * worst, worst <= 0.15 ? "met" : "missed", least, most,
                least >= 1.3 && most <= 1.6 ? "met" : "missed");
}

double height_m(const SeaState& state) {
    return 4.0 * std::sqrt(DirectionalSpectrum(state).m0());
}

void growth() {
    std::printf("\nSignificant height [m], default sea; in brackets over the smaller of the two laws\n  %-8s",
                "m/s");
    for (const double fetch_km : {10.0, 30.0, 100.0, 300.0, 1000.0}) std::printf(" %11.0f km", fetch_km);
    double worst = 0.0;
    for (double wind = 5.0; wind <= 25.0; wind += 5.0) {
        std::printf("\n  %-8.0f", wind);
        for (const double fetch_km : {10.0, 30.0, 100.0, 300.0, 1000.0}) {
            SeaState state;
            state.wind_speed_mps = wind;
            state.fetch_m = 1e3 * fetch_km;
            SeaState developed = state;
            developed.spectrum = SpectrumKind::PiersonMoskowitz;
            developed.short_waves = ShortWaves::None;
            const double energy = 5.2e-7 * std::pow(kGravity * state.fetch_m / (wind * wind), 0.9);
            const double grown_m = 4.0 * std::sqrt(energy) * wind * wind / kGravity;
            const double ratio = height_m(state) / std::min(grown_m, height_m(developed));
            std::printf("   %5.2f (%.2f)", height_m(state), ratio);
            worst = std::max(worst, std::abs(ratio - 1.0));
        }
    }
    std::printf("\n  at most %.0f %% off, target 10: %s\n", 100.0 * worst, worst <= 0.1 ? "met" : "missed");
}

}  // namespace

int main() {
    slopes();
    growth();
}
