// Calm and rough places (waves.masks): the sea's amplitude as a function of the place at rest, m(x), the product of all masks.
//
// The surface is η = m h, its displacement m D, both of the sea without masks. So slopes are m ∇h + h ∇m, the gradient of the displacement
// likewise (∂Dx/∂y and ∂Dy/∂x then differ), velocities m times theirs; of what a pixel hides slopes have m² Σ + (∇m ⊗ ∇m) m0, displacement
// gradients m² V. Whitecaps keep their threshold: a calm has none, nor had it any before. m is C¹, so that normals are continuous.
//
// Ripples, waves below 50 cm, have a gain of their own, r: what kSlick_m's footprint lets through stays, of the rest r times its
// amplitude is left. Its gradient isn't counted: ripples are millimetres high.
#pragma once

#include <glm/vec2.hpp>
#include <optional>
#include <vector>

#include "core/base/number.h"
#include "core/plan/filter.h"
#include "core/spectrum/spectral_moments.h"
#include "pelagic/scene.h"

namespace pelagic {

#include "core/plan/masks.inl"

// The footprint through which a slick's waves pass [m]: whole from 50 cm on, none below 25 cm. A level of views, all of which are powers of
// two; the mean square slope that it leaves is that of Cox and Munk's slicks (1954), 0.008 + 1.56e-3 U, within 0.002 from 5 to 14 m/s.
inline constexpr double kSlick_m = 0.125;

struct MasksPlan {
    struct Mask {
        glm::dvec2 middle_m{0.0}, along{1.0, 0.0};
        glm::dvec2 inner_per_m{0.0}, outer_per_m{0.0};  // one over the half axes
        double reach_m = 0.0;                           // from the middle: beyond it there is none
        double waves = 1.0, ripples = 1.0, foam = 1.0;
    };
    std::vector<Mask> masks;  // those that change something
    bool changes_waves = false, calms_ripples = false, calms_foam = false;
    bool has_strips = false;  // of vessels, which calm ripples as well (core/plan/wake_strip.h)

    // The least and the largest gain of waves in a rectangle, or beyond.
    struct Gains {
        double least = 1.0, largest = 1.0;
    };
    Gains gains_in(glm::dvec2 min_m, glm::dvec2 max_m) const;
    double largest() const;
    MaskGains<double> at(glm::dvec2 place_m) const;
};

// None where no mask changes anything.
std::optional<MasksPlan> plan_masks(const Scene& scene);

// How much higher than it is shown a hero stands in the sea without masks, at most kMostHeroRaise; and how the gain of waves changes there
// over itself [1/m]: m η is level where η is not.
struct HeroMask {
    double raise = 1.0;
    glm::dvec2 change_per_m{0.0};
};
inline constexpr double kMostHeroRaise = 10.0;
HeroMask hero_mask(const Scene& scene, const HeroWave& hero);

// The slopes that a slick's footprint hides, in expectation; of other moments there are none.
SpectralMoments slick_moments(const DirectionalSpectrum& spectrum, const FootprintFilter& filter);

}  // namespace pelagic
