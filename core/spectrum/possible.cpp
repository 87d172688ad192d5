#include "core/spectrum/possible.h"

#include <algorithm>
#include <cmath>

#include "core/base/constants.h"
#include "core/scene/text.h"
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

// Two digits are enough for a limit, rounded down.
std::string height_text(double height_m) {
    const double unit = std::pow(10.0, std::floor(std::log10(height_m)) - 1.0);
    return "0 … " + number_text(std::floor(height_m / unit + 1e-9) * unit);
}

void check(std::vector<Problem>& problems, const std::string& key, double height_m, double k,
           const Dispersion& dispersion, const std::string& remedy) {
    const Limit limit = highest(k, dispersion);
    if (!(height_m > limit.height_m)) return;
    const std::string why =
        limit.is_depths
            ? "is more than water of " + number_text(dispersion.depth_m) + " m can carry: higher waves have broken"
            : "is more than waves can have that are " + short_number_text(kTwoPi / k) + " m long: they break";
    problems.push_back({key, number_text(height_m), why, height_text(limit.height_m) + remedy});
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
        if (!systems.empty())
            check(problems, "sea.significant_height_m", *sea.significant_height_m,
                  systems.front().peak_wavenumber(), dispersion, ", or more wind or fetch, which make longer waves");
    }
    return problems;
}

}  // namespace pelagic
