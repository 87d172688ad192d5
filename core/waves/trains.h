// The second wave model: a sum of trochoid wave trains (Bruneton, Neyret, Holzschuch 2010, §3.2).
//
//   P(x,t) = (x + Σ k̂ H sin θ, Σ h cos θ),   θ = ωt − k·x + φ                                     (Eq. 2)
//
// h is the vertical and H the horizontal amplitude: H = choppiness · coth(kd) · h, limited to kH ≤ 1, beyond
// which the train's surface would fold over. Each train stands for one bin of the spectrum: h = √(2E), where
// E is the bin's energy (the integral, not a sample). Phases are drawn at random, directions evenly
// from the bins' distributions.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/vec2.hpp>
#include <optional>
#include <span>
#include <vector>

#include "core/base/buffer.h"
#include "core/plan/breaking.h"
#include "core/plan/fields.h"
#include "core/plan/filter.h"
#include "core/plan/trains.h"
#include "core/spectrum/directional_spectrum.h"
#include "core/spectrum/spectral_moments.h"
#include "core/waves/hero_waves.h"
#include "core/waves/realisation.h"
#include "pelagic/scene.h"

namespace pelagic {

// The moments of the waves that a pixel leaves unresolved: slopes first, then those of the Jacobian.
inline constexpr std::size_t kUnresolvedSlopes = 3;
inline constexpr std::array<double SpectralMoments::*, 8> kUnresolvedMoments{
    &SpectralMoments::xx,   &SpectralMoments::xy,   &SpectralMoments::yy,   &SpectralMoments::xxxx,
    &SpectralMoments::xxxy, &SpectralMoments::xxyy, &SpectralMoments::xyyy, &SpectralMoments::yyyy};
template <class T>
using UnresolvedMoments = std::array<T, kUnresolvedMoments.size()>;  // parallel to kUnresolvedMoments

template <class T>
UnresolvedMoments<T> unresolved_moments(const SpectralMoments& moments) {
    UnresolvedMoments<T> out;
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = static_cast<T>(moments.*kUnresolvedMoments[i]);
    return out;
}

// Immutable. Every array is indexed by train, longest wavelength first.
template <class T>
struct Trains {
    std::vector<double> kx_cycles_per_m, ky_cycles_per_m;  // double: phases stay exact far away and late
    std::vector<double> cycles_per_s;                      // ω/2π, rounded to the loop where there is one
    std::vector<double> start_cycles;                      // φ/2π, 0 … 1
    std::vector<double> height_m, horizontal_m;            // h and H
    std::vector<double> wavelength_m;

    // Each field's factor: on cos θ for height, horizontal velocity and displacement gradient, on sin θ for the
    // others.
    std::array<std::vector<T>, kFieldCount> amplitude;

    // Of trains whose amplitudes change: what VelocityX and VelocityY have on sin θ, and VelocityZ on cos θ, besides.
    std::array<std::vector<T>, 3> growth;

    // Moments of each train at weight 1; of trains 0 … i − 1; of trains i and up, with those outside the
    // range.
    std::vector<SpectralMoments> alone, before, from;
    SpectralMoments outside;  // moments beyond the range, and of bins beyond their trains: never resolved

    // The weight with which a train's displacement gradient is resolved at best (Breaking::footprint_m); 0 of trains
    // that don't break. The moments of `alone` have only the part that it lets through; the rest is in `outside`.
    std::vector<T> breaking;

    // `alone` and `from` again, as the vectorised query reads them.
    std::vector<UnresolvedMoments<T>> unresolved_alone, unresolved_from;
    std::vector<T> wavelength;  // λ [m]

    std::size_t count() const { return height_m.size(); }
};

// The plan must be made from the same scene (resolve_trains). Σh²/2 equals m0 of the range to 1e-6. The same scene
// gives the same trains, bit for bit.
template <class T>
Trains<T> make_trains(const PreparedScene& prepared, const TrainsPlan& plan,
                      const FootprintFilter& filter = {},
                      const std::optional<Breaking>& breaking = {});  // the plan's; none: the scene's

// Adds the trains of hero waves. They are no part of the random sea: their moments are 0, so that nothing is hidden of it or
// counted twice.
template <class T>
void add_heroes(Trains<T>& trains, std::span<const HeroTrain> heroes, const FootprintFilter& filter,
                const Breaking& breaking, const Dispersion& dispersion);

// By how much waves have turned until a time [cycles], less whole turns.
struct Turns {
    std::vector<Buffer<double>> modes;  // by cascade
    std::vector<double> trains;
};
// Waves over a depth that changes (DepthAt), at a time.
struct OverDepth {
    double depth_m, depth_mps, time_s;
    Turns turns;
    // d/dt coth(kd) [1/s]
    double ratio_per_s(double k) const {
        const double down = std::sinh(std::min(k * depth_m, 300.0));
        return -k * depth_mps / (down * down);
    }
};
// a·b minus the nearest whole number, without the rounding error of the product.
inline double fraction_of_product(double a, double b) {
    const double product = a * b;
    return (product - std::round(product)) + std::fma(a, b, -product);
}

// The trains between two seas of one plan (core/plan/weather.h).
struct TrainsBetween {
    double share, rate_per_s;             // of the energies of the second, and its rate [1/s]
    double choppiness, choppiness_per_s;  // of the time
    double breaking;                      // over that of `breaking`
    const OverDepth* over = nullptr;      // where the depth changes
};
template <class T>
Trains<T> blended(const Trains<T>& first, const Trains<T>& second, const TrainsBetween& between,
                  const Dispersion& dispersion, const Breaking& breaking);

// The moments of all trains and of what lies outside their range. Jacobian moments are of the waves that break, and
// include choppiness². A train's slope variance along k̂ is (kh)²/2, by position at rest, as a cascade's is. Where a
// trochoid's own crest is compressed (appendix A: (kh)²/(1 + √(1 − k²H²)) by area of sea), that is counted with the
// waves that carry it (core/evaluate/surface.inl).
template <class T>
SpectralMoments total(const Trains<T>& trains);

// The moments that a footprint resolves: a train of weight w has amplitudes wh and wH. Trains of weight 1
// come from a table of partial sums; only the partial weights are computed.
template <class T>
SpectralMoments resolved(const Trains<T>& trains, const FootprintFilter& filter, double footprint_m);

// The moments that a footprint leaves unresolved: total − resolved (§7.1), summed without the subtraction, so that
// every variance is ≥ 0 and exactly 0 where everything is resolved. (Eq. 4 as printed sums (1 − w)h and loses
// variance where trains fade.)
template <class T>
SpectralMoments unresolved(const Trains<T>& trains, const FootprintFilter& filter, double footprint_m);

// The trains as filtered for a cell (positions) and a pixel (slopes), at any time.
struct Footprints {
    double cell_m = 0.0, pixel_m = 0.0;
};
template <class T>
Realisation realisation(const Trains<T>& trains, const FootprintFilter& filter, const Footprints& footprints);

// What trains up to these ends have at a place and a time, none filtered.
template <class T>
LocalWaves local_waves(const Trains<T>& trains, glm::dvec2 place_m, double reduced_time_s,
                       const HeroEnds& ends);

// θ/2π at a place and time, reduced to ±½; the products are not rounded before.
double phase_at(glm::dvec2 cycles_per_m, double cycles_per_s, double start_cycles, glm::dvec2 place_m,
                double reduced_time_s);
// Each train's phase θ/2π at a place and time, reduced to ±½; the products are not rounded before.
// reduced_time_s: time within the loop, where there is one (core/waves/loop.h).
template <class T>
std::vector<double> phases_at(const Trains<T>& trains, glm::dvec2 origin_m, double reduced_time_s);

}  // namespace pelagic
