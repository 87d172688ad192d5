// Where a sea's energy is: the directional wavenumber spectrum of a SeaState, wind sea and swells together.
//
// The sea is a list of wave systems (wave_system.h), each with its own energy law, spreading and direction:
//
//   Ψ(k) = Σ S_k(k) D(k, θ − θ_system) / k,   S_k = S(ω) dω/dk,   ∬ Ψ d²k = ∫ S_k dk = m0 = Var(η),   Hs = 4
//   √m0.
//
// Every value is evaluated from the formulas themselves, without tables: exact to rounding, the same bits on
// every call and safe to call from any number of threads.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "core/spectrum/dispersion.h"
#include "core/spectrum/wave_system.h"
#include "pelagic/scene.h"

namespace pelagic {

class DirectionalSpectrum {
  public:
    // Throws std::invalid_argument when the spectrum is "file" and there are no usable bins; every other
    // SeaState that validate() accepts gives a finite spectrum. No wind and no swell: empty().
    explicit DirectionalSpectrum(const SeaState& sea, std::span<const BandGain> gains = {});

    // The sum of these shares (≥ 0) of seas; at least one. Over this depth: of seas of another one, their frequencies.
    struct Part {
        const DirectionalSpectrum* sea;
        double share;
    };
    DirectionalSpectrum(std::span<const Part> parts, const Dispersion& dispersion);

    bool empty() const { return systems_.empty(); }
    bool is_calm() const;              // no waves but the rings of rain, whose peaks don't count
    double m0() const { return m0_; }  // [m²], over all wavenumbers, to 1e-6

    // S_k(k) [m³]; 0 for k ≤ 0, and outside panels().
    double omnidirectional(double k) const;

    // Σ S_k D [m³/rad] at wavenumber k, travelling towards theta [rad, counter-clockwise from +x]; Ψ(kx, ky)
    // = polar / k.
    double polar(double k, double theta) const;

    // ∫ polar dθ from theta0 to theta1 [m³]; the angles may be any multiple of 2π away, and theta1 < theta0
    // gives the negative. Closed forms throughout, so that a needle of a swell costs no accuracy: better than
    // 1e-10 of S_k.
    double arc(double k, double theta0, double theta1) const;

    // Peak of the system with the most energy [rad/m]; kCalmPeakWavenumber for a calm sea.
    double peak_wavenumber() const;

    // Smallest peak among the systems that hold at least 2 % of m0.
    double longest_peak_wavenumber() const;

    const Dispersion& dispersion() const { return dispersion_; }
    std::span<const WaveSystem> systems() const { return systems_; }

    // Wavenumbers, rising, between which S_k and the spreading are smooth on the scale of one panel
    // (neighbours at most 12 % apart, every kink and jump among them): eight Gauss–Legendre nodes a panel
    // integrate to 1e-7 of m0. Outside the first and last there is less than 1e-12 of m0. Empty for an empty
    // sea.
    std::span<const double> panels() const { return panels_; }

    // use(from, to) for each panel, or part of one, between k_lo and k_hi, rising.
    template <class Use>
    void for_panels(double k_lo, double k_hi, Use&& use) const {
        if (panels_.empty()) return;
        const double first = std::max(k_lo, panels_.front()), last = std::min(k_hi, panels_.back());
        auto next = std::upper_bound(panels_.begin(), panels_.end(), first);
        for (double from = first; from < last;) {
            const double to = next != panels_.end() ? std::min(*next++, last) : last;
            use(from, to);
            from = to;
        }
    }

    // The wavenumbers among panels() where S_k or the spreading has a kink or a jump.
    std::span<const double> kinks() const { return kinks_; }

    static constexpr double kCalmPeakWavenumber = 1.0;  // rad/m: a finite answer where there is no wave

  private:
    void add_up();  // what follows from the systems

    Dispersion dispersion_;
    std::vector<WaveSystem> systems_;
    std::vector<double> panels_;
    std::vector<double> kinks_;
    double m0_ = 0.0;
};

}  // namespace pelagic
