#include "core/plan/spray.h"

#include <cmath>

#include "core/base/constants.h"
#include "core/plan/effects.h"
#include "core/scene/limits.h"
#include "core/scene/text.h"

namespace pelagic {

double spray_source(double wind_speed_mps, double radius_um) {
    const double b = (0.380 - std::log10(radius_um)) / 0.650;
    return 1.373 * std::pow(wind_speed_mps, 3.41) * std::pow(radius_um, -3.0) *
           (1.0 + 0.057 * std::pow(radius_um, 1.05)) * std::pow(10.0, 1.19 * std::exp(-b * b));
}

SprayLaw spray_law(double wind_speed_mps) {
    // Simpson's rule over the logarithm of the radius: 64 steps are exact to 1e-8.
    constexpr int kSteps = 64;
    const double step = std::log(SprayLaw::kLargest_um / SprayLaw::kSmallest_um) / kSteps;
    double number = 0.0, area_um2 = 0.0,
           volume_um3 = 0.0;  // fluxes of droplets, of their sections, of their volumes
    for (int i = 0; i <= kSteps; ++i) {
        const double r_um = SprayLaw::kSmallest_um * std::exp(i * step);
        const double weight = (i == 0 || i == kSteps ? 1.0 : i % 2 == 1 ? 4.0 : 2.0) * step / 3.0;
        const double flux = weight * r_um * spray_source(wind_speed_mps, r_um);
        number += flux;
        area_um2 += flux * kPi * r_um * r_um;
        volume_um3 += flux * 4.0 / 3.0 * kPi * r_um * r_um * r_um;
    }
    constexpr double kM2PerUm2 = 1e-12, kM3PerUm3 = 1e-18;
    return {.number_flux_per_m2_s = number,
            .mass_flux_kg_per_m2_s = volume_um3 * kM3PerUm3 * SprayLaw::kDroplet_kg_per_m3,
            .extinction_per_m =
                SprayLaw::kExtinctionEfficiency * area_um2 * kM2PerUm2 / SprayLaw::kDeposition_mps};
}

SprayLaw spray_law(const Scene& scene) {
    if (!is_on(Effect::Spray, scene)) return {};
    SprayLaw law = spray_law(scene.sea.wind_speed_mps);
    for (double* part : {&law.number_flux_per_m2_s, &law.mass_flux_kg_per_m2_s, &law.extinction_per_m})
        *part *= scene.effects.spray_gain;
    return law;
}

std::string spray_warning(const Scene& scene) {
    Scene natural = scene;
    natural.effects.spray_gain = 1.0;
    if (!is_on(Effect::Spray, natural) || !(scene.sea.wind_speed_mps > 0.0)) return {};
    if (!is_on(Effect::Spray, scene)) return "effects.spray_gain = 0 leaves no spray";
    constexpr double kSeen = 0.01;  // of the light straight up, on average: over crests it is ten times that
    const double seen_thickness = -std::log1p(-kSeen), thickness = spray_law(scene).optical_thickness();
    if (thickness >= seen_thickness) return {};
    const double needed = seen_thickness / spray_law(scene.sea.wind_speed_mps).optical_thickness();
    const double digit = std::pow(10.0, std::floor(std::log10(needed)));
    const double gain = std::ceil(needed / digit) * digit;
    const double percent = -100.0 * std::expm1(-thickness),
                 scale = std::pow(10.0, 1.0 - std::floor(std::log10(percent)));
    return "the spray takes " + number_text(std::round(percent * scale) / scale) +
           " % of the light that falls through it, too little to be seen; " +
           (limits::kSprayGain.holds(gain)
                ? "a picture shows it from effects.spray_gain = " + number_text(gain) + " on"
                : std::string("in so little wind no effects.spray_gain shows it"));
}

}  // namespace pelagic
