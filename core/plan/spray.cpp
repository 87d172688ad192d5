#include "core/plan/spray.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "core/base/constants.h"
#include "core/plan/effects.h"
#include "core/plan/wind_profile.h"
#include "core/scene/limits.h"
#include "core/scene/text.h"

namespace pelagic {
namespace {

constexpr double kM2PerUm2 = 1e-12, kM3PerUm3 = 1e-18;

// Simpson's rule over the logarithm: take(radius, weight of dr).
template <class Take>
void over_radii(double smallest_um, double largest_um, int steps, const Take& take) {
    const double step = std::log(largest_um / smallest_um) / steps;
    for (int i = 0; i <= steps; ++i) {
        const double r_um = smallest_um * std::exp(i * step);
        take(r_um, (i == 0 || i == steps ? 1.0 : i % 2 == 1 ? 4.0 : 2.0) * step / 3.0 * r_um);
    }
}

double monahan_source(double wind_speed_mps, double radius_um) {
    const double b = (0.380 - std::log10(radius_um)) / 0.650;
    return 1.373 * std::pow(wind_speed_mps, 3.41) * std::pow(radius_um, -3.0) *
           (1.0 + 0.057 * std::pow(radius_um, 1.05)) * std::pow(10.0, 1.19 * std::exp(-b * b));
}

SprayLaw monahan_law(double wind_speed_mps) {
    constexpr double kSmallest_um = 0.8, kLargest_um = 10.0;
    constexpr double kScaleHeight_m = 2.0;
    constexpr double kDeposition_mps = 0.01;  // concentration = flux / this
    double number = 0.0, area_um2 = 0.0,
           volume_um3 = 0.0;  // fluxes of droplets, of their sections, of their volumes
    over_radii(kSmallest_um, kLargest_um, 64, [&](double r_um, double weight) {
        const double flux = weight * monahan_source(wind_speed_mps, r_um);
        number += flux;
        area_um2 += flux * kPi * r_um * r_um;
        volume_um3 += flux * 4.0 / 3.0 * kPi * r_um * r_um * r_um;
    });
    return {.number_flux_per_m2_s = number,
            .mass_flux_kg_per_m2_s = volume_um3 * kM3PerUm3 * SprayLaw::kDroplet_kg_per_m3,
            .over_foam = {SprayLaw::kExtinctionEfficiency * area_um2 * kM2PerUm2 / kDeposition_mps,
                          kScaleHeight_m}};
}

// Andreas' ranges of r80 [µm], in each of which the source is a power of it.
constexpr std::array kBounds_um{10.0, 37.5, 100.0, 250.0};
constexpr std::array kPowers{-1.0, -2.8, -8.0};

// At 14 m, where Smith's was.
double wind_at_14_m(const WindProfile& wind) {
    return wind.at(14.0);
}

double smith_source(double wind_14_mps, double radius_um) {
    const auto mode = [&](double lg, double width, double at_um) {
        const double x = std::log(radius_um / at_um);
        return std::pow(10.0, lg) * std::exp(-width * x * x);
    };
    return mode(0.0676 * wind_14_mps + 2.43, 3.1, 2.1) +
           mode(0.959 * std::sqrt(wind_14_mps) - 1.476, 3.3, 9.2);
}

// The source over that of Smith's at 10 µm.
double andreas_shape(double radius_um) {
    double shape = 3.5;
    for (std::size_t i = 0; i < kPowers.size(); ++i)
        shape *=
            std::pow(std::clamp(radius_um, kBounds_um[i], kBounds_um[i + 1]) / kBounds_um[i], kPowers[i]);
    return shape;
}

double blowing(double wind_speed_mps) {
    constexpr double kNone_mps = 8.0, kAll_mps = 10.0;
    const double x = std::clamp((wind_speed_mps - kNone_mps) / (kAll_mps - kNone_mps), 0.0, 1.0);
    return x * x * (3.0 - 2.0 * x);
}

constexpr double kFastestSeen_mps = 32.0;

// The radii that each stand for as much of the thickness of what counts from r80 = kSmallest_um on, which is a bound of the source's
// ranges. thickness: of radii in rising order.
struct ThicknessOf {
    double radius_um, thickness;
};
SprayDropsLaw drops_of(const std::vector<ThicknessOf>& parts) {
    SprayDropsLaw drops;
    for (const ThicknessOf& part : parts) drops.optical_thickness += part.thickness;
    double below = 0.0;
    std::size_t next = 0;
    for (const ThicknessOf& part : parts) {
        below += part.thickness;
        while (next < drops.radii_um.size() && (static_cast<double>(next) + 0.5) * drops.optical_thickness <=
                                                   below * static_cast<double>(drops.radii_um.size()))
            drops.radii_um[next++] = part.radius_um;
    }
    while (next < drops.radii_um.size()) drops.radii_um[next++] = parts.back().radius_um;
    return drops;
}

SprayLaw andreas_law(double wind_speed_mps, double significant_height_m, bool has_drops) {
    const double blown = blowing(wind_speed_mps);
    if (!(blown > 0.0)) return {};
    const double wind_mps = std::min(wind_speed_mps, kFastestSeen_mps);
    const WindProfile wind(wind_mps);
    const double friction_mps = wind.friction_mps(),
                 at_10_um = blown * smith_source(wind_at_14_m(wind), 10.0);
    constexpr double kFlattest_m = 0.1, kCounts_m = 20.0, kKarman = 0.4;
    const double flat_m = std::max(0.25 * significant_height_m, kFlattest_m);
    const double rest = std::log((flat_m + kCounts_m) / flat_m),
                 turbulent_mps = friction_mps * friction_mps / wind_mps;
    SprayLaw law;
    double extinction_per_m = 0.0, thickness = 0.0;
    std::vector<ThicknessOf> of_drops;
    for (std::size_t i = 0; i < kPowers.size(); ++i)
        over_radii(kBounds_um[i], kBounds_um[i + 1], 32, [&](double r80_um, double weight) {
            const double flux = weight * at_10_um * andreas_shape(r80_um);
            const double r_um = std::pow(r80_um / 0.518, 1.0 / 0.976), section_um2 = kPi * r_um * r_um;
            const double falls_mps = settling_mps(r_um);
            const double deposited_mps = falls_mps / -std::expm1(-falls_mps / turbulent_mps);
            const double power = 1.0 - falls_mps / (kKarman * friction_mps);
            const double above = std::abs(power) < 1e-6 ? rest : std::expm1(power * rest) / power;
            const double k = SprayLaw::kExtinctionEfficiency * kM2PerUm2 * section_um2 * flux / deposited_mps;
            law.number_flux_per_m2_s += flux;
            law.mass_flux_kg_per_m2_s +=
                SprayLaw::kDroplet_kg_per_m3 * kM3PerUm3 * 4.0 / 3.0 * r_um * section_um2 * flux;
            extinction_per_m += k;
            thickness += k * flat_m * (1.0 + above);
            if (kBounds_um[i] >= SprayDropsLaw::kSmallest_um)
                of_drops.push_back({r_um, k * flat_m * (1.0 + above)});
        });
    // The air soon mixes what is small; what is torn off crests is low and falls. So ribbons have most of the extinction, haze of the thickness,
    // and both together the law's: how much either has is chosen, by eye.
    constexpr double kHazeExtinction = 0.1, kHazeThickness = 0.75;
    const double haze_per_m = kHazeExtinction * extinction_per_m;
    law.haze = {haze_per_m, kHazeThickness * thickness / haze_per_m};
    law.ribbons.extinction_per_m = (1.0 - kHazeExtinction) * extinction_per_m * glm::dvec3(1.0, 0.5, 0.15);
    law.ribbons.step_m *= (1.0 - kHazeThickness) * thickness / law.ribbons.optical_thickness();
    if (has_drops) {
        // Ribbons are where crests have just broken, as those drops are. In seas of 15 m and more they would hardly be enough.
        constexpr double kMost = 0.9;
        const double of_ribbons = law.ribbons.optical_thickness();
        law.drops = drops_of(of_drops);
        law.drops.optical_thickness = std::min(law.drops.optical_thickness, kMost * of_ribbons);
        law.ribbons.extinction_per_m *= 1.0 - law.drops.optical_thickness / of_ribbons;
    }
    return law;
}

}  // namespace

double SprayRibbons::thinned(glm::dvec3 extinctions, double lift_steps) {
    if (!(lift_steps > 0.0) || !(extinctions.x > 0.0)) return 1.0;
    const double whole = 0.5 * extinctions.x + 1.25 * extinctions.y + 2.0 * extinctions.z;
    return whole / (whole + 0.25 * lift_steps * extinctions.x);
}

double SprayRibbons::mean(glm::dvec3 extinctions, double from_m, double to_m, double lift_m) const {
    if (!(to_m > 0.0) || !(from_m < top_m())) return 0.0;
    extinctions *= thinned(extinctions, lift_m / step_m);
    const std::array at{0.0, extinctions.x, extinctions.y, extinctions.z, 0.0};
    const std::array heights_m{0.5 * lift_m, lift_m, lift_m + kHeights[1] * step_m,
                               lift_m + kHeights[2] * step_m, lift_m + kHeights[3] * step_m};
    double sum = 0.0;
    for (std::size_t i = 0; i + 1 < at.size(); ++i) {
        const double low = heights_m[i], high = heights_m[i + 1];
        if (!(high > low)) continue;
        const double from = std::clamp(from_m, low, high), to = std::clamp(to_m, low, high);
        sum += (to - from) * std::lerp(at[i], at[i + 1], (0.5 * (from + to) - low) / (high - low));
    }
    return sum / (to_m - from_m);
}

double settling_mps(double radius_um) {
    constexpr double kAir_kg_per_m3 = 1.2, kViscosity_Pa_s = 1.8e-5;
    const double r_m = radius_um * 1e-6;
    const double stokes_mps =
        2.0 / 9.0 * (SprayLaw::kDroplet_kg_per_m3 - kAir_kg_per_m3) * kGravity * r_m * r_m / kViscosity_Pa_s;
    // Its drag grows with the speed: each step halves the error at least.
    double speed_mps = stokes_mps;
    for (int i = 0; i < 50; ++i) {
        const double reynolds = 2.0 * kAir_kg_per_m3 * speed_mps * r_m / kViscosity_Pa_s;
        speed_mps = 0.5 * (speed_mps + stokes_mps / (1.0 + 0.15 * std::pow(reynolds, 0.687)));
    }
    return speed_mps;
}

double spray_source(SpraySource source, double wind_speed_mps, double radius_um) {
    if (source == SpraySource::Monahan1986) return monahan_source(wind_speed_mps, radius_um);
    return blowing(wind_speed_mps) * andreas_shape(radius_um) *
           smith_source(wind_at_14_m(WindProfile(std::min(wind_speed_mps, kFastestSeen_mps))), 10.0);
}

SprayLaw spray_law(SpraySource source, double wind_speed_mps, double significant_height_m, bool has_drops) {
    return source == SpraySource::Monahan1986 ? monahan_law(wind_speed_mps)
                                              : andreas_law(wind_speed_mps, significant_height_m, has_drops);
}

SprayLaw spray_law(const Scene& scene, double significant_height_m) {
    if (!is_on(Effect::Spray, scene)) return {};
    SprayLaw law = spray_law(scene.effects.spray_law, scene.sea.wind_speed_mps, significant_height_m,
                             scene.effects.spray_drops);
    const double gain = scene.effects.spray_gain;
    for (double* part :
         {&law.number_flux_per_m2_s, &law.mass_flux_kg_per_m2_s, &law.over_foam.extinction_per_m,
          &law.haze.extinction_per_m, &law.drops.optical_thickness})
        *part *= gain;
    law.ribbons.extinction_per_m *= gain;
    return law;
}

bool has_spray(const Scene& scene) {
    return spray_law(scene, 1.0).extinction_per_m() > 0.0;
}

std::string spray_warning(const Scene& scene, double significant_height_m) {
    Scene natural = scene;
    natural.effects.spray_gain = 1.0;
    if (!is_on(Effect::Spray, natural) || !(scene.sea.wind_speed_mps > 0.0)) return {};
    if (!is_on(Effect::Spray, scene)) return "effects.spray_gain = 0 leaves no spray";
    constexpr double kSeen = 0.01;  // of the light straight up, on average: over crests it is ten times that
    const double seen_thickness = -std::log1p(-kSeen),
                 thickness = spray_law(scene, significant_height_m).optical_thickness();
    if (thickness >= seen_thickness) return {};
    if (!(thickness > 0.0)) return "so little wind tears no spray off crests; it takes 9 m/s";
    const double needed = seen_thickness / spray_law(natural, significant_height_m).optical_thickness();
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
