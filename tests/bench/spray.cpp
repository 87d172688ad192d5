// Spray over a square kilometre against the formulas: mass flux and vertical optical thickness of a bake's volumes, eight seas
// for each wind, nature's gain.
//   spray [SEEDS] [VOXEL_M]      default 8 and 2

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "tests/plugin/bake/spray_balance.h"

namespace {

using namespace pelagic;

struct Mean {
    double value = 0.0, error = 0.0;  // and its standard error
};
Mean mean_of(const std::vector<double>& values) {
    const auto count = static_cast<double>(values.size());
    double sum = 0.0, squares = 0.0;
    for (const double value : values) sum += value;
    for (const double value : values) squares += (value - sum / count) * (value - sum / count);
    return {sum / count, std::sqrt(squares / (count - 1.0) / count)};
}

void print_wind(double wind_mps, int seeds, double voxel_m) {
    constexpr double kSide_m = 1000.0;
    const SprayLaw law = spray_law(wind_mps);
    std::vector<double> flux, thickness, flux_by_breaking, thickness_by_breaking;
    for (int seed = 1; seed <= seeds; ++seed) {
        Scene scene = test::spray_shot(wind_mps, kSide_m, voxel_m);
        scene.shot.seed = static_cast<std::uint64_t>(seed);
        const test::SprayBalance balance = test::spray_balance(scene);
        flux.push_back(balance.mass_flux);
        thickness.push_back(balance.optical_thickness);
        flux_by_breaking.push_back(balance.mass_flux / balance.breaking);
        thickness_by_breaking.push_back(balance.optical_thickness / balance.breaking);
    }
    const auto print = [&](const char* what, double of_law, const char* unit,
                           const std::vector<double>& plain, const std::vector<double>& divided) {
        const Mean mean = mean_of(plain), by_breaking = mean_of(divided);
        double worst = 0.0;
        for (const double one : divided) worst = std::max(worst, std::abs(one - 1.0));
        const double errors = std::abs(mean.value - 1.0) / mean.error;
        const bool is_met = std::abs(by_breaking.value - 1.0) <= 0.02 && errors <= 3.0;
        std::printf(
            "  %4.0f m/s  %-18s %9.3g %-4s  %.3f ± %.3f (%.1f errors)   %.4f, farthest sea %.4f   %s\n",
            wind_mps, what, of_law, unit, mean.value, mean.error, errors, by_breaking.value, worst,
            is_met ? "met" : "missed");
    };
    print("mass flux", law.mass_flux_kg_per_m2_s * kSide_m * kSide_m, "kg/s", flux, flux_by_breaking);
    print("optical thickness", law.optical_thickness(), "", thickness, thickness_by_breaking);
    std::fflush(stdout);
}

}  // namespace

int main(int count, char** arguments) {
    const int seeds = count > 1 ? std::atoi(arguments[1]) : 8;
    const double voxel_m = count > 2 ? std::atof(arguments[2]) : 2.0;
    std::printf(
        "Spray over 1 km2, gain 1, %d seeds, voxels of %g m: the formulas'; the mean over that, within three errors; that "
        "by what breaks, within 2 %%\n",
        seeds, voxel_m);
    for (const double wind_mps : {10.0, 15.0, 20.0, 25.0}) print_wind(wind_mps, seeds, voxel_m);
}
