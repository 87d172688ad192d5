#include "core/plan/gusts.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/base/constants.h"
#include "core/base/random.h"
#include "core/plan/masks.h"

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

GustsPlan::FromFronts GustsPlan::from_fronts(glm::dvec2 origin_m, double time_s) const {
    FromFronts from{};
    for (std::size_t i = 0; i < fronts.size(); ++i) from[i] = origin_m - fronts[i].middle_at(time_s);
    return from;
}

double GustsPlan::fronts_wind(glm::dvec2 place_m, double footprint_m, double time_s) const {
    const FromFronts from = from_fronts(place_m, time_s);
    double wind = 1.0;
    for (std::size_t i = 0; i < fronts.size(); ++i) {
        const Front& front = fronts[i];
        wind *= front_wind(from[i].x, from[i].y, front.along.x, front.along.y, front.half_m.x, front.half_m.y,
                           front.edge_m, footprint_m, footprint_m, front.wind, 0.0);
    }
    return std::clamp(wind, weakest, strongest);
}

bool has_fronts(const SeaState& sea) {
    return std::ranges::any_of(sea.gust_fronts, [](const GustFront& front) { return front.wind != 1.0; });
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
    for (const GustFront& front : sea.gust_fronts) {
        if (front.wind == 1.0) continue;
        const double turn = front.direction_deg * kPi / 180.0;
        const glm::dvec2 way(std::cos(turn), std::sin(turn)),
            half_m(0.5 * front.length_m, 0.5 * front.width_m);
        plan.fronts.push_back({.middle_m = {front.east_m, front.north_m},
                               .along = way,
                               .velocity_mps = loop_s > 0.0 ? glm::dvec2(0.0) : front.speed_mps * way,
                               .half_m = half_m,
                               .edge_m = front.edge_m,
                               .time_s = scene.shot.time_s(front.frame),
                               .reach_m = std::max(half_m.x, half_m.y) + front.edge_m,
                               .wind = front.wind});
        plan.weakest = std::min(plan.weakest, front.wind);
        plan.strongest = std::max(plan.strongest, front.wind);
    }
    return plan;
}

}  // namespace pelagic
