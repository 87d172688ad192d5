// Waves that feel the floor of a coast (Waves::coast): each train's phase and amplitude over depths that vary slowly from place to place.
//
// Geometric optics (WKB): a train of frequency ω has the phase S(x) − ωt, |∇S| = k(ω, d), and its energy goes along ∇S at the group's
// speed, ∇·(k̂ c_g E) = 0. S is marched along one of the map's axes, S_u = √(k² − S_v²) (Heun's steps, one-sided differences of second
// order, and Godunov's choice between them, which takes the earliest of arrivals that cross); the flux c_g E cos α along with it,
// conservatively. The axis is the one along which the floor falls, for trains within 69° of it; where it falls along neither clearly, and
// for all others, the axis that the train comes nearest to. Those come in over the map's side as at sea, and turn from there on.
// Trains enter at the map's edge as they are in sea.depth_m, by Snell's law.
//
// Where rays cross, E is no more than kMostCoastEnergy of what came in. A train that turns more than 75° from the march goes on at 75°, and
// ends where it turns back (S_v ≥ k). No energy goes on where the water is shallower than kCoastShore_m, but the phase does, as in sea.depth_m.
// Behind land the phase is the earliest arrival from beside, |S_v| ≤ k, and the flux spreads across the march as wide as Fresnel diffraction
// does on the mean, ∂f/∂u = ∂/∂v(1/(2k) ∂f/∂v): a lee fills over √(λx/2π). That is no pattern of diffraction, which has fringes.
//
// Outside the map gains go back to 1 over `fade_m`, and phases to the plain trains', slowly enough that wavenumbers change by a fifth at most.
//
// Breaking takes energy from all trains alike, by Thornton and Guza 1983: ε = (3√π/16) ρ g f_p H_rms⁷/(γ⁴ d⁵), γ = 0.42. Their law is of a
// random sea: of one train alone, and of each for itself, the height is at most kMostCoastHeight of the depth.
#pragma once

#include <cstddef>
#include <glm/common.hpp>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "core/plan/coast.h"
#include "core/plan/trains.h"
#include "core/waves/trains.h"

namespace pelagic {

// Whether a train that goes this way is marched along y: of the floor's mean slope over the map, as deep as waves feel it, the larger part
// says so, if it is larger by far and the train goes that way at all; else the train does.
bool coast_goes_along_y(const CoastDepths& depths, glm::dvec2 direction);

// What becomes of one train of unit energy without breaking, parallel to the depths.
struct CoastWave {
    std::vector<double> phase;     // S − k₀·x from the map's corner [rad]
    std::vector<double> energy;    // 0 … kMostCoastEnergy
    std::vector<glm::dvec2> flux;  // energy times the group's velocity [m/s]
};
// A train of this frequency [rad/s] that comes from water of `depth_m` along a unit vector.
CoastWave march_coast(const CoastDepths& depths, double depth_m, double omega, glm::dvec2 direction);

// What breaking leaves of a sea's energy, and the share of its waves that break, parallel to the depths. `m0` [m²] and `flux` [m³/s] without it;
// `towards`: where the sea comes from goes; peak_hz: of its spectrum.
struct CoastBreaking {
    std::vector<double> left, broken;
};
CoastBreaking break_on_coast(const CoastDepths& depths, std::span<const double> m0,
                             std::span<const glm::dvec2> flux, glm::dvec2 towards, double peak_hz);

// All of a sea's trains on its coast. Between cells' middles phases and amplitudes are quadratic B-splines, as pictures of masks are
// (core/plan/masks.h): the surface is C¹, beyond the map's edge too, where they fade.
template <class T>
struct Coast : CoastSurf<T> {
    using CoastSurf<T>::count, CoastSurf<T>::fade_m;
    // Of each cell side by side, the trains that feel the floor, longest first: `stride` numbers, a multiple of 64 bytes.
    std::size_t feeling = 0, stride = 0;
    std::vector<T> phase;   // (S − k₀·x)/2π [cycles]
    std::vector<T> gain;    // of amplitudes
    std::vector<T> others;  // that of all trains too short to feel it, a number a cell
    // Of each train of the sea, with zeros for a vector that begins at the last: its wavevector where it comes from [rad/m], its height [m], its
    // angular frequency, how far it moves water to the side over height times wavenumber [m], for its displacement and for that of the waves that
    // break, and how much of these is resolved at best.
    std::vector<T> kx, ky, height_m, omega, sideways_m, breaking_sideways_m, breaking;
    std::vector<T>
        longest_m;  // no deeper water makes it longer, nor the way back to plain trains beyond the map
    // Of each train that feels the floor, one over how far beyond the map its phase fades [1/m].
    std::vector<T> phase_fade_per_m;

    // The largest gain of each train that feels the floor, and of the others; the largest of gain times wavenumber [rad/m] of the former.
    std::vector<double> most_gain, most_sideways;
};

// Of make_trains()'s. The scene must have waves.coast, and its depths.
template <class T>
Coast<T> make_coast(const PreparedScene& prepared, const TrainsPlan& plan, const Trains<T>& trains,
                    const Breaking& breaking);

// How much of a place foams because waves break on the floor there: where the sea is `height_m` high, seen through cells so wide. It lies on the highest
// crests, over kRoller of the share of waves that break; cells too wide for crests have that much throughout.
inline constexpr double kRoller = 0.25;  // of a breaking wave's length: by eye
// Of coast.glsl as well: the least share of a place that breaks, how sharp a crest's foam ends, in deviations, and quick_deviate()'s numbers.
inline constexpr double kLeastSurf = 1e-4, kSurfSharpness = 4.0, kLogistic = 1.702, kLeastDeviate = -7.0;
template <class T>
double coast_foam(const CoastSurf<T>& coast, glm::dvec2 place_m, double height_m, double cell_m,
                  const FootprintFilter& filter);
// The standard normal deviate below which a share lies, within 0.01 of the share, −7 … 7 (Bowling et al. 2009).
double quick_deviate(double share);

// Between what a train's local numbers lie over a rectangle of the world.
struct CoastRange {
    bool is_anything = false;  // of phase and wavevector: nothing is known there
    double phase_lo = 0.0, phase_hi = 0.0, gain_lo = 0.0, gain_hi = 0.0;
    glm::dvec2 k_lo{0.0}, k_hi{0.0};  // of ∇S [rad/m]
    double most_sideways = 0.0;       // of gain times wavenumber

    double most_wavenumber() const;
};
template <class T>
CoastRange coast_range(const Coast<T>& coast, std::size_t train, glm::dvec2 min_m, glm::dvec2 max_m);

}  // namespace pelagic
