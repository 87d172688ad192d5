// One wave system: a wind sea or a swell, with its energy law, its spreading and its direction.
#pragma once

#include <complex>
#include <variant>
#include <vector>

#include "core/scene/scene.h"
#include "core/spectrum/cosine.h"
#include "core/spectrum/donelan_banner.h"
#include "core/spectrum/elfouhaily.h"
#include "core/spectrum/hasselmann.h"
#include "core/spectrum/jonswap.h"
#include "core/spectrum/measured.h"
#include "core/spectrum/omega2.h"
#include "core/spectrum/phillips.h"
#include "core/spectrum/pierson_moskowitz.h"
#include "core/spectrum/swell.h"
#include "core/spectrum/tma.h"
#include "core/spectrum/wave_point.h"

namespace pelagic {

// Laws in ω have density(ω) [m² s] and peak_omega(); laws in k have density_k(k) [m³] and peak_wavenumber().
using EnergyLaw =
    std::variant<PiersonMoskowitz, Jonswap, Tma, Elfouhaily, Omega2, Phillips, SwellEnergy, MeasuredEnergy>;

// Laws in ω have at(ω), laws in k at_wavenumber(k); each gives one of the shapes of angular.h.
using SpreadingLaw = std::variant<HasselmannSpreading, DonelanBannerSpreading, CosineSpreading,
                                  ElfouhailySpreading, SwellSpreading, MeasuredSpreading>;

class WaveSystem {
  public:
    static WaveSystem wind_sea(const SeaState& sea, const Dispersion& dispersion);
    static WaveSystem swell(const Swell& swell, const Dispersion& dispersion);
    // Throws std::invalid_argument, see MeasuredEnergy.
    static WaveSystem measured(const SeaState& sea, const Dispersion& dispersion);

    // S_k [m³], viscous cutoff included; 0 outside panels(), where the laws' quotients of vanishing numbers
    // end.
    double energy(const WavePoint& point) const;

    // D [1/rad] of waves travelling towards theta [rad], and its integral from theta0 to theta1.
    double density(const WavePoint& point, double theta) const;
    double share(const WavePoint& point, double theta0, double theta1) const;

    // ∫ D e^{inθ} dθ, n ≥ 0.
    std::complex<double> harmonic(const WavePoint& point, int n) const;

    // D's shape at this wavenumber, about direction() [rad].
    AngularShape shape(const WavePoint& point) const;
    double direction() const { return direction_; }

    double peak_wavenumber() const { return peak_wavenumber_; }  // of the frequency spectrum's peak [rad/m]
    double m0() const { return m0_; }                            // [m²]

    // Rising wavenumbers: the range that holds all but 1e-12 of m0 cut into panels (see
    // DirectionalSpectrum::panels).
    const std::vector<double>& panels() const { return panels_; }
    const std::vector<double>& kinks() const { return kinks_; }

  private:
    WaveSystem(EnergyLaw energy, SpreadingLaw spreading, double direction, const Dispersion& dispersion);
    double law_energy(const WavePoint& point) const;
    void find_panels(const Dispersion& dispersion);

    EnergyLaw energy_;
    SpreadingLaw spreading_;
    double direction_;
    double peak_wavenumber_ = 0.0;
    double m0_ = 0.0;
    std::vector<double> panels_;
    std::vector<double> kinks_;
};

// Peak wavenumber [rad/m] of an energy law.
double peak_wavenumber(const EnergyLaw& law, const Dispersion& dispersion);

}  // namespace pelagic
