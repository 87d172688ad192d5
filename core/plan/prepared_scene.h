// A valid scene with what follows from its weather alone: worked out once, and shared by whoever plans,
// builds and draws the scene.
#pragma once

#include <memory>
#include <optional>

#include "core/plan/extent.h"
#include "core/plan/masks.h"
#include "core/spectrum/directional_spectrum.h"
#include "core/spectrum/second_order.h"
#include "pelagic/scene.h"

namespace pelagic {

struct Weather;  // core/plan/weather.h

struct PreparedScene {
    Scene scene;
    DirectionalSpectrum spectrum;  // of scene.sea, with the gains of scene.waves
    SecondOrder second_order;      // of the spectrum; all 0 without the effect
    Extent extent;                 // extent_of()
    // masks_of(): a coast's is worked out over all of its cells.
    std::optional<MasksPlan> masks{};
    // Of a scene whose sea has keys, and the spectrum is then their mean; else null.
    std::shared_ptr<const Weather> weather{};
    // The keys of the wind's speed, of a moment of a scene where it changes: scene has the moment's.
    std::optional<NumberKeys> wind{};
};

// How far a wind that has keys has blown since the sea's time 0 [m], at a time.
double wind_way_m(const PreparedScene&, double t_s);

// plan_masks(), without a coast's where its depths aren't read yet, which make_plan() refuses.
std::optional<MasksPlan> masks_of(const Scene&, const DirectionalSpectrum&);

// Of a scene and what was worked out for it: of the spectrum's waves at the scene's choppiness, with crests to second order.
Extent extent_of(const Scene&, const DirectionalSpectrum&, const SecondOrder&,
                 const std::optional<MasksPlan>&);

// The scene must be valid (core/scene/validate.h). Some milliseconds: the spectrum's own integrals. Throws
// std::invalid_argument for a scene with a budget (core/scene/budget.h).
std::shared_ptr<const PreparedScene> prepare(Scene scene);

}  // namespace pelagic
