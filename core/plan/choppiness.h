// How far each wave moves water to the side: the factor λ of its horizontal displacement.
//
// Dupuy and Bruneton 2012, Eq. 1: each pattern has a λ of its own. A pattern is a band of wavenumbers, so λ is a function of
// the wavenumber, constant from edge to edge. Where all waves have the same, there is one band.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/spectrum/directional_spectrum.h"
#include "pelagic/scene.h"

namespace pelagic {

class Choppiness {
  public:
    // The same for all waves.
    Choppiness(double of_all = 1.0);
    // As the scene asks: waves.choppiness, or what a cascade of the fft model says of its own waves.
    static Choppiness asked(const Scene& scene);
    // What a sea is built with: 0 where less than kLeastShown is asked for. Such waves are displaced by less than a
    // ten-thousandth of their height, and in single precision J, next to 1, keeps too few digits of the displacement
    // gradient to tell where it breaks: half a step is 0.2 % of J's deviation here, and more below.
    static constexpr double kLeastShown = 1e-4;
    Choppiness built() const;

    bool is_of_all() const { return bands_.size() == 1; }  // one for all waves
    double largest() const { return largest_; }
    // Whether any wave moves water to the side.
    bool moves() const { return largest_ > 0.0; }
    // λ of wavenumber k ≥ 0 [rad/m].
    double at(double k) const {
        std::size_t band = 0;
        while (band + 1 < bands_.size() && k >= bands_[band].k_end) ++band;
        return bands_[band].choppiness;
    }
    // use(from, to, share) for each band's part of k_lo ≤ k < k_hi, rising; share: λ over largest(), and 1 where that is 0.
    template <class Use>
    void for_bands(double k_lo, double k_hi, Use&& use) const {
        double begin = 0.0;
        for (const Band& band : bands_) {
            const double from = std::max(begin, k_lo), to = std::min(band.k_end, k_hi);
            if (from < to) use(from, to, largest_ > 0.0 ? band.choppiness / largest_ : 1.0);
            begin = band.k_end;
        }
    }

    // The same for each panel of the spectrum, or part of one, in which there is one λ.
    template <class Use>
    void for_panels(const DirectionalSpectrum& spectrum, double k_lo, double k_hi, Use&& use) const {
        for_bands(k_lo, k_hi, [&](double begin, double end, double share) {
            spectrum.for_panels(begin, end, [&](double from, double to) { use(from, to, share); });
        });
    }

  private:
    struct Band {
        double k_end;  // [rad/m]; infinite for the last
        double choppiness;
    };
    Choppiness(std::vector<Band> bands);

    std::vector<Band> bands_;
    double largest_ = 0.0;
};

}  // namespace pelagic
