// Whitecap coverage from moments of J, at every mip level, against thresholding J itself on a 16 times finer
// grid.
//
// One tile, whose waves the fine grid shows all: its thresholded J is the truth. In the first sea the map's
// texels show them all, too, and mips alone are judged (plugin/bake/maps.h: levels are made of moments). In
// the second there are waves down to the fine grid's own Nyquist, of which the map knows what the spectrum
// says: no map that doesn't hold them can tell which of its texels they break in. Thresholds are quantiles of
// the fine J: coverages as rare as wanted.

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>

#include "core/evaluate/evaluate.h"
#include "core/scene/cascade_bands.h"
#include "core/surface/patch.h"
#include "core/waves/whitecaps.h"
#include "plugin/bake/maps.h"
#include "tests/bench/timing.h"

namespace pelagic::bench {
namespace {

constexpr double kTile_m = 100.0;
constexpr int kFiner = 16, kMap = 256, kFine = kFiner * kMap;

Query tile_query(const char* name, int n, double footprint_m) {
    Query query;
    query.name = name;
    query.products = products(Product::JacobianMoments);
    query.cell_m = query.pixel_m = {footprint_m};
    query.points = static_cast<std::size_t>(n) * n;
    query.lattice = Lattice{-0.5 * kTile_m, kTile_m / n};
    query.only_cascade = 0;
    return query;
}

std::vector<glm::vec3> moments_of(const Frame<float>& frame, int query, int n) {
    const auto points =
        rest_points<float>({.per_side = n, .spacing_m = kTile_m / n, .first_m = -0.5 * kTile_m});
    std::vector<glm::vec3> moments(points.size());
    Results<float> results;
    results.set(Product::JacobianMoments, {moments.data()});
    evaluate(frame, query, Points<float>{.count = points.size(), .rest_m = {points.data()}}, results);
    return moments;
}

// The part of each texel of an n × n map (centred on its corner, as maps' texels are) where fine J <
// threshold.
std::vector<double> thresholded(const std::vector<float>& fine, int n, float threshold) {
    const int ratio = kFine / n;
    std::vector<double> coverage(static_cast<std::size_t>(n) * n, 0.0);
    const auto texel = [&](int i) { return ((i + ratio / 2) / ratio) % n; };
    for (int y = 0; y < kFine; ++y)
        for (int x = 0; x < kFine; ++x)
            if (fine[static_cast<std::size_t>(y) * kFine + x] < threshold)
                coverage[static_cast<std::size_t>(texel(y)) * n + texel(x)] += 1.0;
    for (double& w : coverage) w /= static_cast<double>(ratio) * ratio;
    return coverage;
}

struct Error {
    double bias = 0.0, rms = 0.0;
};

Error error_of(const std::vector<JacobianMoments<float>>& moments, const std::vector<double>& truth,
               float threshold, bool third_moment) {
    Error error;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        const double e = static_cast<double>(coverage(moments[i], threshold, third_moment)) - truth[i];
        error.bias += e;
        error.rms += e * e;
    }
    error.bias /= static_cast<double>(truth.size());
    error.rms = std::sqrt(error.rms / static_cast<double>(truth.size()));
    return error;
}

// `waves`: a resolution whose waves there are.
void sea(double wind_mps, int waves) {
    Scene scene;
    scene.sea.wind_speed_mps = wind_mps;
    // The second tile is there to end the first one's band, at its last modes.
    constexpr int kSmall = 32;
    scene.waves.cascades = {{kTile_m, waves}, {1.02 * kBandModes * 2.0 * kTile_m / waves, kSmall}};
    const double shown_m = waves == kMap ? 0.0 : kTile_m / kMap;
    Frame<float> frame(std::make_shared<const Sea<float>>(
        make_plan(scene, {tile_query("fine", kFine, 0.0), tile_query("map", kMap, shown_m)})));
    frame.set(3.0);
    std::vector<float> fine;
    for (const glm::vec3& j : moments_of(frame, 0, kFine)) fine.push_back(j.x);
    std::vector<JacobianMoments<float>> map;
    for (const glm::vec3& j : moments_of(frame, 1, kMap)) map.push_back({j.x, j.y, j.z});
    std::vector<MipLevel<JacobianMoments<float>>> levels =
        moment_mips({.n = kMap, .texels = map, .periodic = true});
    levels.insert(levels.begin(), {kMap, map});

    std::vector<float> sorted = fine;
    for (const double wanted : {0.005, 0.03, 0.1}) {
        const auto quantile =
            sorted.begin() + static_cast<std::ptrdiff_t>(wanted * static_cast<double>(sorted.size()));
        std::nth_element(sorted.begin(), quantile, sorted.end());
        const float threshold = *quantile;
        std::printf(
            "  wind %g m/s, W = %g, waves down to %.2g m\n    texels      bias       rms   relative bias    "
            "two moments: bias"
            "       rms   relative bias\n",
            wind_mps, wanted, 2.0 * kTile_m / waves);
        Error worst;
        for (const auto& level : levels) {
            const std::vector<double> truth = thresholded(fine, level.n, threshold);
            const Error three = error_of(level.texels, truth, threshold, true),
                        two = error_of(level.texels, truth, threshold, false);
            worst = {std::max(worst.bias, std::abs(three.bias)), std::max(worst.rms, three.rms)};
            std::printf("    %4d^2 %10.5f %9.5f %14.1f %% %20.5f %9.5f %14.1f %%\n", level.n, three.bias,
                        three.rms, 100.0 * three.bias / wanted, two.bias, two.rms, 100.0 * two.bias / wanted);
        }
        std::printf(
            "    worst: |bias| %.5f <= 0.01 %s, rms %.5f <= 0.025 %s, relative bias %.1f %% <= 25 %% %s\n",
            worst.bias, verdict(worst.bias <= 0.01), worst.rms, verdict(worst.rms <= 0.025),
            100.0 * worst.bias / wanted, verdict(worst.bias <= 0.25 * wanted));
    }
}

}  // namespace
}  // namespace pelagic::bench

int main() {
    std::printf(
        "Whitecap coverage from three moments of J against thresholding a 16 x finer grid, %g m tile, each "
        "mip "
        "level\n",
        pelagic::bench::kTile_m);
    for (const int waves : {pelagic::bench::kMap, pelagic::bench::kFine})
        for (const double wind_mps : {10.0, 15.0}) pelagic::bench::sea(wind_mps, waves);
}
