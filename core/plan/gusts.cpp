#include "core/plan/gusts.h"

#include <cmath>
#include <cstdint>

#include "core/base/constants.h"
#include "core/base/random.h"

namespace pelagic {

std::array<double, GustsPlan::kWaves> GustsPlan::cycles_at(glm::dvec2 origin_m,
                                                           double time_within_loop_s) const {
    const auto within = [](double cycles) { return cycles - std::floor(cycles); };
    std::array<double, kWaves> cycles{};
    for (std::size_t i = 0; i < waves.size(); ++i) {
        const Wave& wave = waves[i];
        cycles[i] =
            within(within(wave.cycles_per_m.x * origin_m.x) + within(wave.cycles_per_m.y * origin_m.y) -
                   within(wave.cycles_per_s * time_within_loop_s) + wave.start_cycles);
    }
    return cycles;
}

GustsPlan plan_gusts(const Scene& scene) {
    const SeaState& sea = scene.sea;
    constexpr double kLongest = 2.0, kShortest = 0.25;  // of the gusts' size
    constexpr double kLonger = 3.0;                     // along the wind than across it
    // Of the wind 10 m up: that at 2 m, by the logarithmic profile over a roughness of 0.2 mm (Taylor 1938: gusts drift
    // with the wind that carries them).
    constexpr double kCarried = 0.85;
    constexpr double kPressed = 0.5;               // of a wavelength is left where it is pressed together
    constexpr double kGoldenTurn = 0.61803398875;  // directions far from each other, however many
    constexpr std::uint32_t kStream = 0x74737567;  // no cascade's

    GustsPlan plan;
    plan.strength = sea.gust_strength;
    const double towards = sea.wind_direction_deg * kPi / 180.0;
    const glm::dvec2 along(std::cos(towards), std::sin(towards)), across(-along.y, along.x);
    const double loop_s = scene.shot.sea_loop_s();
    const auto random = [&](int wave) {
        return philox({static_cast<std::uint32_t>(wave), 0, 0, kStream}, scene.shot.seed);
    };
    const auto unit = [](std::uint32_t bits) { return static_cast<double>(bits) * 0x1p-32; };
    const double first_turn = unit(random(GustsPlan::kWaves)[0]);
    double variance = 0.0;
    for (int i = 0; i < GustsPlan::kWaves; ++i) {
        const auto bits = random(i);
        const double octave = (i + unit(bits[0])) / GustsPlan::kWaves;
        const double size = kLongest * std::pow(kShortest / kLongest, octave);
        const double angle = kPi * (first_turn + i * kGoldenTurn);
        const double k = 1.0 / (size * sea.gust_size_m);
        const double k_along = k * std::cos(angle) / std::sqrt(kLonger),
                     k_across = k * std::sin(angle) * std::sqrt(kLonger);
        GustsPlan::Wave& wave = plan.waves[static_cast<std::size_t>(i)];
        wave.cycles_per_m = k_along * along + k_across * across;
        wave.along = wave.cycles_per_m * (1.0 / std::hypot(wave.cycles_per_m.x, wave.cycles_per_m.y));
        wave.cycles_per_s = kCarried * sea.wind_speed_mps * k_along;
        // A slow gust stands still in a short loop: one round in it would be faster than any wind.
        if (loop_s > 0.0) wave.cycles_per_s = std::round(wave.cycles_per_s * loop_s) / loop_s;
        wave.start_cycles = unit(bits[1]);
        wave.amplitude =
            std::cbrt(size);  // Kolmogorov 1941: the wind differs by the third root of the distance
        wave.shortest_m = kPressed / std::hypot(k_along, k_across);
        variance += 0.5 * wave.amplitude * wave.amplitude;
    }
    for (GustsPlan::Wave& wave : plan.waves) wave.amplitude /= std::sqrt(variance);
    return plan;
}

}  // namespace pelagic
