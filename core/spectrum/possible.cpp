#include "core/spectrum/possible.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "core/base/constants.h"
#include "core/scene/number_keys.h"
#include "core/scene/text.h"
#include "core/scene/validate.h"
#include "core/spectrum/wave_system.h"

namespace pelagic {
namespace {

struct Limit {
    double height_m;
    bool is_depths;
};

Limit highest(double k, const Dispersion& dispersion) {
    constexpr double kMiche = 0.142;
    const double steepest = kMiche * kTwoPi / k * std::tanh(k * dispersion.depth_m);
    const double deepest = WaveSystem::kMostHeightOverDepth * dispersion.depth_m;
    return {std::min(steepest, deepest), deepest < steepest};
}

// Two digits are enough for a limit; rounded down.
std::string two_digits(double value) {
    const double digits = 1.0 - std::floor(std::log10(value));
    const double scale = std::pow(10.0, digits);
    return number_text(std::floor(value * scale + 1e-9) / scale);
}

void check(std::vector<Problem>& problems, const std::string& key, double height_m, double k,
           const Dispersion& dispersion, const std::string& remedy) {
    const Limit limit = highest(k, dispersion);
    constexpr double kRounding = 1.0 + 1e-9;
    if (!(height_m > limit.height_m * kRounding)) return;
    const std::string why = limit.is_depths ? "is more than water of " + number_text(dispersion.depth_m) +
                                                  " m can carry: higher waves have broken"
                                            : "is more than waves can have that are " +
                                                  two_digits(kTwoPi / k) + " m long: they break";
    problems.push_back({key, number_text(height_m), why, "0 … " + two_digits(limit.height_m) + remedy});
}

}  // namespace

std::vector<Problem> impossible_waves(const SeaState& sea) {
    std::vector<Problem> problems;
    const Dispersion dispersion{sea.depth_m};
    for (std::size_t i = 0; i < sea.swell.size(); ++i) {
        const Swell& swell = sea.swell[i];
        check(problems, "sea.swell[" + std::to_string(i) + "].height_m", swell.height_m,
              dispersion.wavenumber(kTwoPi / swell.period_s), dispersion, ", or a longer period");
    }
    if (sea.significant_height_m) {
        const std::vector<WaveSystem> systems = WaveSystem::sea(sea, dispersion);
        const bool has_waves = !systems.empty() && systems.front().m0() > 0.0;
        if (!has_waves && *sea.significant_height_m > 0.0)
            problems.push_back({"sea.significant_height_m", number_text(*sea.significant_height_m),
                                sea.measured ? "the measured spectrum has no waves to be that high"
                                             : "without wind there are no waves to be that high",
                                sea.measured
                                    ? "0, or another spectrum_time"
                                    : "0, or more sea.wind_speed_mps; a swell has its own height_m"});
        if (has_waves && *sea.significant_height_m > 0.0)
            check(problems, "sea.significant_height_m", *sea.significant_height_m,
                  systems.front().peak_wavenumber(), dispersion,
                  ", or more wind or fetch, which make longer waves");
    }
    return problems;
}

std::vector<Problem> impossible_waves(const Scene& scene) {
    const std::set<int> frames = frames_of_sea(scene);
    if (frames.empty()) return impossible_waves(scene.sea);
    std::vector<Problem> problems;
    for (const int frame : frames)
        for (Problem& problem : impossible_waves(scene_at(scene, frame).sea)) {
            problem.value += " at frame " + std::to_string(frame);
            problems.push_back(std::move(problem));
        }
    return problems;
}

std::vector<Problem> problems_of(const Scene& scene) {
    std::vector<Problem> problems = validate(scene);
    return problems.empty() ? impossible_waves(scene) : problems;
}

}  // namespace pelagic
