// The second wave model: a sum of trochoid wave trains (Bruneton, Neyret, Holzschuch 2010, §3.2).
//
//   P(x,t) = (x + Σ k̂ H sin θ, Σ h cos θ),   θ = ωt − k·x + φ                                     (Eq. 2)
//
// h is the vertical, H the horizontal amplitude: choppiness · coth(kd) · h, limited to kH ≤ 1, where the
// train's surface would loop over itself. Each train stands for a bin of the spectrum: h = √(2E), E the
// energy in the bin (the integral, not a sample of it), direction and phase drawn at random.
#pragma once

#include <array>
#include <cstddef>
#include <glm/vec2.hpp>
#include <vector>

#include "core/plan/fields.h"
#include "core/plan/filter.h"
#include "core/plan/trains.h"
#include "core/scene/scene.h"
#include "core/spectrum/directional_spectrum.h"
#include "core/spectrum/spectral_moments.h"
#include "core/waves/realisation.h"

namespace pelagic {

// The moments that a pixel's hidden waves are asked for: the slopes' first, then those of the Jacobian.
inline constexpr std::size_t kHiddenSlopes = 3;
inline constexpr std::array<double SpectralMoments::*, 8> kHiddenMoments{
    &SpectralMoments::xx,   &SpectralMoments::xy,   &SpectralMoments::yy,   &SpectralMoments::xxxx,
    &SpectralMoments::xxxy, &SpectralMoments::xxyy, &SpectralMoments::xyyy, &SpectralMoments::yyyy};
template <class T>
using HiddenMoments = std::array<T, kHiddenMoments.size()>;  // parallel to kHiddenMoments

template <class T>
HiddenMoments<T> hidden_moments(const SpectralMoments& moments) {
    HiddenMoments<T> out;
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = static_cast<T>(moments.*kHiddenMoments[i]);
    return out;
}

// Immutable; each array by train, longest first.
template <class T>
struct Trains {
    std::vector<double> kx_cycles_per_m, ky_cycles_per_m;  // double, like all phases: exact far away and late
    std::vector<double> cycles_per_s;                      // ω/2π, rounded to the loop where there is one
    std::vector<double> start_cycles;                      // φ/2π, 0 … 1
    std::vector<double> height_m, horizontal_m;            // h and H
    std::vector<double> wavelength_m;

    // Each field's factor on cos θ (height, horizontal velocity, strain) or on sin θ (the others).
    std::array<std::vector<T>, kFieldCount> amplitude;

    // Moments of each train at weight 1, of trains 0 … i − 1, and of trains i … with what is outside the
    // range.
    std::vector<SpectralMoments> alone, before, from;
    SpectralMoments outside;  // what the spectrum holds beyond the range: never shown, never missing

    // The same for the vectorised query: of each train, and from[i].
    std::vector<HiddenMoments<T>> hidden_alone, hidden_from;
    std::vector<T> wavelength, steepness2;  // λ [m], (kH)²

    std::size_t count() const { return height_m.size(); }
};

// The plan must be the scene's (resolve_trains). Σh²/2 is m0 of the range to
// 1e-6. The same scene gives the same trains, to the bit.
template <class T>
Trains<T> make_trains(const PreparedScene& prepared, const TrainsPlan& plan);

// Everything: all trains and what is outside their range. Jacobian moments times choppiness².
// A train's slope variance along k̂ is (kh)²/(1 + √(1 − k²H²)) (appendix A, for H ≠ h, and without the
// cancellation of its 1 − √(1 − k²h²)).
template <class T>
SpectralMoments total(const Trains<T>& trains);

// What a footprint lets through: trains with weight w have amplitudes wh and wH. A sum looked up for those
// with weight 1, work for those between.
template <class T>
SpectralMoments resolved(const Trains<T>& trains, const FootprintFilter& filter, double footprint_m);

// What it hides: total − resolved (§7.1; Eq. 4 as printed sums (1 − w)h and loses variance where trains
// fade), summed without the subtraction: every variance ≥ 0, 0 exactly where nothing is hidden.
template <class T>
SpectralMoments hidden(const Trains<T>& trains, const FootprintFilter& filter, double footprint_m);

// The trains as seen through a cell (positions) and a pixel (slopes): the same at all times.
struct Footprints {
    double cell_m = 0.0, pixel_m = 0.0;
};
template <class T>
Realisation realisation(const Trains<T>& trains, const FootprintFilter& filter, const Footprints& footprints);

// Each train's phase θ/2π at a place and time, reduced to ±½ without rounding the products first.
// reduced_time_s: within the loop, where there is one (core/waves/loop.h).
template <class T>
std::vector<double> phases_at(const Trains<T>& trains, glm::dvec2 origin_m, double reduced_time_s);

}  // namespace pelagic
