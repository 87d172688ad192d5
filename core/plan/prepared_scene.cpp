#include "core/plan/prepared_scene.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "core/base/constants.h"
#include "core/plan/effects.h"
#include "core/plan/masks.h"
#include "core/plan/trains.h"
#include "core/plan/vessels.h"
#include "core/plan/weather.h"
#include "core/scene/budget.h"
#include "core/scene/number_keys.h"

namespace pelagic {

std::shared_ptr<const PreparedScene> prepare(Scene scene) {
    if (has_budget(scene.quality))
        throw std::invalid_argument(
            std::string(scene.quality.max_error ? "quality.max_error" : "quality.frame_ms") +
            " isn't resolved yet: a plan takes settings, which a host chooses for a budget before it (pelagic explain "
            "says which)");
    scene = without_still_keys(std::move(scene));
    if (std::ranges::any_of(scene.keyed, is_of_sea)) return prepare_weather(std::move(scene));
    DirectionalSpectrum spectrum(scene.sea, scene.waves.band_gains);
    const SecondOrder second =
        is_on(Effect::SecondOrder, scene) ? pelagic::second_order(spectrum) : SecondOrder();
    std::optional<MasksPlan> masks = masks_of(scene, spectrum);
    const Extent extent = extent_of(scene, spectrum, second, masks);
    return std::make_shared<const PreparedScene>(
        PreparedScene{std::move(scene), std::move(spectrum), second, extent, std::move(masks)});
}

std::optional<MasksPlan> masks_of(const Scene& scene, const DirectionalSpectrum& spectrum) {
    const bool is_read = !scene.waves.coast || scene.waves.coast_depths;
    return is_read ? plan_masks(scene, spectrum) : plan_masks(scene);
}

Extent extent_of(const Scene& scene, const DirectionalSpectrum& spectrum, const SecondOrder& second,
                 const std::optional<MasksPlan>& masks) {
    const Choppiness choppiness = Choppiness::asked(scene);
    Extent extent = expected_extent(spectrum, choppiness);
    // Of a value x deviations high, a skewness s makes one of x + s (x² − 1)/6 (Cornish and Fisher 1938).
    const double skewness =
        std::abs(second.skewness()) * second.limit() * scene.waves.second_order * choppiness.largest();
    extent.height_m *= 1.0 + skewness * (kExtentDeviations - 1.0 / kExtentDeviations) / 6.0;
    // A hero takes of the sea's variance what it has of its own shape: η = ρA + √(1 − ρ²) 5σ is highest at √(A² + (5σ)²).
    double hero_m = 0.0;
    for (const HeroWave& hero : scene.waves.heroes)
        hero_m = std::max(hero_m, hero_mask(masks, hero).raise * std::abs(hero.height_m));
    if (spectrum.m0() > 0.0) {
        extent.height_m = std::hypot(extent.height_m, hero_m);
        extent.reach_m = std::hypot(extent.reach_m, choppiness.largest() * hero_m);
    }
    if (masks) {
        extent.height_m *= masks->largest();
        extent.reach_m *= masks->largest();
        for (double& deviation_m : extent.unresolved.deviation_m) deviation_m *= masks->largest();
    }
    if (scene.waves.coast && scene.waves.model == WaveModel::Trochoid && spectrum.m0() > 0.0) {
        // On a coast waves rise to kMostCoastEnergy at most. So high, σ, they go farthest to the side where they have broken down to 0.28 d, half
        // of kMostCoastHeight: σ coth(kd) ≤ σ √(g/d)/ω.
        const double rise = std::sqrt(kMostCoastEnergy), deviation_m = rise * std::sqrt(spectrum.m0()),
                     depth_m = deviation_m / (0.5 * kMostCoastHeight / std::sqrt(2.0)),
                     omega = spectrum.dispersion().omega(spectrum.longest_peak_wavenumber());
        extent.height_m *= rise;
        extent.reach_m =
            std::max(rise * extent.reach_m, kExtentDeviations * choppiness.largest() * deviation_m *
                                                std::sqrt(kGravity / depth_m) / omega);
        for (double& of : extent.unresolved.deviation_m) of *= rise;
    }
    for (const VesselPlan& vessel : plan_vessels(scene)) {
        extent.height_m += vessel.highest_m(scene.sea.depth_m);
        extent.reach_m += choppiness.largest() * vessel.highest_m(scene.sea.depth_m);
    }
    return extent;
}

}  // namespace pelagic
