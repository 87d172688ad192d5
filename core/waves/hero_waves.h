// Hero waves (waves.heroes): a crest of height A at the place x₀ and the time t₀, and round it what a Gaussian sea most
// likely has round such a crest (Lindgren 1970; Boccotti 1983; Tromans, Anaturk and Hagemeijer 1991, "NewWave"), in the sea as it is there.
//
// A sea is η = Re Σ a_j e^{iθ_j} with E|a_j|²/2 = E_j. Six values are asked of it at (x₀, t₀):
//   η = A,  ∂η/∂x = ∂η/∂y = ∂η/∂t = 0,  D = 0,
// so that it is the highest there and then (one that is lower than the sea's own may be a saddle), the last two so that the crest stands
// at x₀ in the world and not where the displacement takes it. Each is a sum over the modes, b = Re B a. Of all seas with these values
// the most likely one, given the sea a, is
//   a + E B† C⁻¹ (wanted − b),  C = Re B E B†,
// and all heroes are asked for together. What is added is a sum of trains of its own, which any place and time evaluates, so
// that no tile repeats it: kHeroTrains modes a hero, of equal energy, their wavenumbers and directions spread evenly over the
// spectrum's. Modes and b are of the waves that hold kHeroEnergy of the sea's energy, whatever is asked of the sea: shorter ones would
// have their slope undone by long ones, and a plan may lack them. They ride on the hero; in its height there are those of
// kHeroHeightEnergy. It is of the first order: it doesn't lean, and has no part in the pairs of second order.
#pragma once

#include <glm/vec2.hpp>
#include <span>
#include <vector>

#include "core/plan/prepared_scene.h"
#include "core/plan/trains.h"

namespace pelagic {

// At a place at rest and a time.
struct LocalWaves {
    double height_m = 0.0;
    glm::dvec2 slope{0.0};           // ∂η/∂x, ∂η/∂y by the place at rest
    double rate_mps = 0.0;           // ∂η/∂t
    glm::dvec2 displacement_m{0.0};  // sideways

    LocalWaves& operator+=(const LocalWaves& other);
};

struct HeroMode {
    double wavelength_m = 0.0;
    glm::dvec2 direction{1.0, 0.0};  // of travel
    double cycles_per_s = 0.0;       // rounded to the loop where there is one
    double horizontal_ratio = 0.0;   // of the horizontal amplitude over the vertical: choppiness coth(kd)

    glm::dvec2 cycles_per_m() const { return direction / wavelength_m; }
};

// A train as those of core/waves/trains.h.
struct HeroTrain {
    HeroMode mode;
    double height_m = 0.0;      // amplitude
    double start_cycles = 0.0;  // φ/2π
};

// When a hero stands, within the loop where there is one [s].
double hero_time_s(const Scene& scene, const HeroWave& hero);

// What is to be added so that each hero stands. `around`: of the sea's waves up to TrainsPlan::hero_ends, without them, at each
// hero's place and time. A hero in a place where those before it leave no choice (closer than a small part of a wave, in place and
// time) is as they make it. Empty: no heroes, or a sea without waves. The same scene gives the same trains, bit for bit.
std::vector<HeroTrain> hero_trains(const PreparedScene& prepared, std::span<const LocalWaves> around);

// How a hero stands in a calm, as its trains make it.
struct HeroShape {
    double height_m = 0.0;
    double compression = 0.0;  // 1 − J along the way that is most compressed
};
HeroShape hero_shape(std::span<const HeroTrain> trains, glm::dvec2 place_m, double reduced_time_s);

}  // namespace pelagic
