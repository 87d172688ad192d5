// A valid scene with what follows from its weather alone: worked out once, and shared by whoever plans,
// builds and draws the scene.
#pragma once

#include <memory>
#include <string>

#include "core/plan/extent.h"
#include "core/scene/scene.h"
#include "core/spectrum/directional_spectrum.h"

namespace pelagic {

struct PreparedScene {
    Scene scene;
    DirectionalSpectrum spectrum;  // of scene.sea, with the gains of scene.waves
    Extent extent;                 // of the spectrum's waves at the scene's choppiness
    // Of a scene with a budget (budget.h): what was chosen for its mesh and why, for people, and whether that holds it.
    std::string budget{};
    bool holds_budget = true;
};

// The scene must be valid (core/scene/validate.h). Some milliseconds: the spectrum's own integrals. A budget is turned into the
// keys of the mesh that it asks for, which takes longer the more of the surface's points must be looked at.
std::shared_ptr<const PreparedScene> prepare(Scene scene);

}  // namespace pelagic
