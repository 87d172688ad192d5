// One wave system: a wind sea or a swell, with its energy law, its spreading and its direction.
//
// A wind sea is two systems where SeaState::short_waves asks for it. The spectra were measured near their peaks; what they
// say of short waves gives half the slopes that sun glitter shows (Cox & Munk 1954), almost as many of them against the
// wind as with it. From 3 to 10 peak wavenumbers (of a buoy: from the end of its band to 3.3 times as far) the spectrum is
// blended into the short waves of Elfouhaily et al. 1997 under the same wind, with their spreading.
#pragma once

#include <complex>
#include <optional>
#include <variant>
#include <vector>

#include "core/spectrum/angular.h"
#include "core/spectrum/band_gains.h"
#include "core/spectrum/cosine.h"
#include "core/spectrum/donelan_banner.h"
#include "core/spectrum/elfouhaily.h"
#include "core/spectrum/hasselmann.h"
#include "core/spectrum/jonswap.h"
#include "core/spectrum/measured.h"
#include "core/spectrum/omega2.h"
#include "core/spectrum/phillips.h"
#include "core/spectrum/pierson_moskowitz.h"
#include "core/spectrum/rain.h"
#include "core/spectrum/swell.h"
#include "core/spectrum/tma.h"
#include "core/spectrum/wave_point.h"
#include "pelagic/scene.h"

namespace pelagic {

// Laws in ω have density(ω) [m² s] and peak_omega(); laws in k have density_k(k) [m³] and peak_wavenumber().
using EnergyLaw = std::variant<PiersonMoskowitz, JonswapShape, Tma, Elfouhaily, Omega2, Phillips, SwellEnergy,
                               MeasuredEnergy, RainRings>;

// Laws in ω have at(ω), laws in k at_wavenumber(k); each gives one of the shapes of angular.h.
using SpreadingLaw = std::variant<HasselmannSpreading, DonelanBannerSpreading, CosineSpreading,
                                  ElfouhailySpreading, SwellSpreading, MeasuredSpreading, IsotropicSpreading>;

// Where a system's energy begins or ends, by wavenumber [rad/m]: a quintic in ln k, twice differentiable at both ends.
struct Edge {
    double from = 0.0, to = 0.0;

    double rise(double k) const;  // 0 … 1
};

// The share of a system's energy that counts: right of one edge and left of another, where there are any.
struct Edges {
    std::optional<Edge> lower{}, upper{};

    double share(double k) const;
};

class WaveSystem {
  public:
    static WaveSystem swell(const Swell& swell, const Dispersion& dispersion);
    static WaveSystem rings(double rain_mm_h,
                            const Dispersion& dispersion);  // core/spectrum/rain.h; rain > 0
    // What SeaState has beside its swells: the wind's waves or the measured ones, and the short ones joined to them. Its
    // height is significant_height_m, or what follows from the law, but at most kMostHeightOverDepth times the depth: higher
    // waves have broken. Its peak is that of the law's sea when it has grown, or has still to grow, to that height (SeaState::growth);
    // directionality is that of the long waves. Empty without wind. Throws std::invalid_argument, see MeasuredEnergy.
    static std::vector<WaveSystem> sea(const SeaState& sea, const Dispersion& dispersion);

    // Hs over depth that waves can have (Thornton & Guza 1982 saw 0.42 … 0.6).
    static constexpr double kMostHeightOverDepth = 0.6;

    WaveSystem scaled(double energy_factor) const;
    // What rain leaves of it. A swell has only passed through, and a buoy's waves are what rain had left.
    WaveSystem rained_on(const RainDamping& rain, const Dispersion& dispersion) const;
    // With these gains on top of all else, and with this directionality.
    WaveSystem gained(const BandGains& gains, const Dispersion& dispersion) const;
    WaveSystem directed(double directionality) const;

    // S_k [m³], viscous cutoff included; 0 outside panels(), where the laws would divide vanishing numbers.
    double energy(const WavePoint& point) const;

    // D [1/rad] of waves travelling towards theta [rad], and its integral from theta0 to theta1.
    double density(const WavePoint& point, double theta) const;
    double share(const WavePoint& point, double theta0, double theta1) const;

    // ∫ D e^{inθ} dθ for n of 1, 2 and 4.
    Harmonics harmonics(const WavePoint& point) const;

    // D's shape at this wavenumber, about direction() [rad], before directionality() is applied (directed.h).
    AngularShape shape(const WavePoint& point) const;
    // A swell, or a buoy's waves, of which nobody says where they come from.
    bool may_be_swell() const {
        return std::holds_alternative<SwellEnergy>(energy_) ||
               std::holds_alternative<MeasuredEnergy>(energy_);
    }
    bool is_rings() const { return std::holds_alternative<RainRings>(energy_); }
    double direction() const { return direction_; }
    double directionality() const { return directionality_; }

    double peak_wavenumber() const { return peak_wavenumber_; }  // of the frequency spectrum's peak [rad/m]
    double m0() const { return m0_; }                            // [m²]
    double mss() const { return mss_; }                          // slope variance, of both directions

    // Rising wavenumbers: the range that holds all but 1e-12 of m0 cut into panels (see
    // DirectionalSpectrum::panels).
    const std::vector<double>& panels() const { return panels_; }
    const std::vector<double>& kinks() const { return kinks_; }

  private:
    WaveSystem(EnergyLaw energy, SpreadingLaw spreading, double direction, const Dispersion& dispersion,
               Edges edges = {});
    // The waves of this law and the wind's short ones joined to them.
    static std::vector<WaveSystem> with_short_waves(const SeaState& sea, const EnergyLaw& energy,
                                                    const Dispersion& dispersion);
    double law_energy(const WavePoint& point) const;
    void find_panels(const Dispersion& dispersion);
    void find_energy(const Dispersion& dispersion);  // panels, m0 and mss

    EnergyLaw energy_;
    SpreadingLaw spreading_;
    double direction_;
    Edges edges_;
    double scale_ = 1.0, directionality_ = 1.0;
    BandGains gains_;
    std::optional<RainDamping> rain_;
    double peak_wavenumber_ = 0.0;
    double m0_ = 0.0, mss_ = 0.0;
    std::vector<double> panels_;
    std::vector<double> kinks_;
};

// Peak wavenumber [rad/m] of an energy law.
double peak_wavenumber(const EnergyLaw& law, const Dispersion& dispersion);

}  // namespace pelagic
