// The price list of resolution: what a coarser mesh hides, and what comes back for it.

#include <algorithm>
#include <cstdio>

#include "core/evaluate/evaluate.h"
#include "core/surface/patch.h"
#include "core/waves/whitecaps.h"

namespace pelagic::bench {
namespace {

constexpr int kQuads[] = {64, 128, 256, 512, 1024};

struct Means {
    double resolved_mss = 0.0, unresolved_mss = 0.0, spectrum_mss = 0.0, coverage = 0.0;
};

Means means_of(const Scene& scene) {
    Frame<float> frame(std::make_shared<const Sea<float>>(plan_bake(scene)));
    frame.set(3.0);
    const int n = scene.surface.resolution;
    const auto points = rest_points<float>(
        {.per_side = n, .spacing_m = scene.surface.size_m / n, .first_m = -0.5 * scene.surface.size_m});
    std::vector<glm::vec3> normal(points.size()), variance(points.size());
    std::vector<float> whitecaps(points.size());
    Results<float> results;
    results.set(Product::Normal, {normal.data()});
    results.set(Product::SlopeVariance, {variance.data()});
    results.set(Product::Breaking, {whitecaps.data()});
    evaluate(frame, 0, Points<float>{.count = points.size(), .rest_m = {points.data()}}, results);
    Means means;
    means.spectrum_mss = frame.sea().total().mss();
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double sx = static_cast<double>(normal[i].x / normal[i].z),
                     sy = static_cast<double>(normal[i].y / normal[i].z);
        means.resolved_mss += sx * sx + sy * sy;
        means.unresolved_mss += static_cast<double>(variance[i].x + variance[i].y);
        means.coverage += static_cast<double>(whitecaps[i]);
    }
    for (double* sum : {&means.resolved_mss, &means.unresolved_mss, &means.coverage})
        *sum /= static_cast<double>(points.size());
    return means;
}

void slopes() {
    std::printf(
        "\nSlopes over 200 m, default sea without choppiness, mean of 8 seeds\n  %-8s %10s %10s %16s\n",
        "quads", "resolved", "unresolved", "sum / spectrum");
    for (const int quads : kQuads) {
        Means sum;
        for (int seed = 1; seed <= 8; ++seed) {
            Scene scene;
            scene.effects.foam_decay_s = 0.0;  // all foam breaks now
            scene.shot.seed = static_cast<std::uint64_t>(seed);
            scene.waves.choppiness = 0.0;
            scene.surface.resolution = quads;
            const Means one = means_of(scene);
            sum.resolved_mss += one.resolved_mss / 8.0;
            sum.unresolved_mss += one.unresolved_mss / 8.0;
            sum.spectrum_mss = one.spectrum_mss;
        }
        std::printf("  %-8d %10.5f %10.5f %16.4f\n", quads, sum.resolved_mss, sum.unresolved_mss,
                    (sum.resolved_mss + sum.unresolved_mss) / sum.spectrum_mss);
    }
}

void whitecap_table() {
    std::printf("\nWhitecap coverage over 1 km^2\n  %-10s %12s", "wind [m/s]", "observed");
    for (const int quads : kQuads) std::printf(" %8d^2", quads);
    std::printf("   largest change\n");
    for (const double wind : {6.0, 8.0, 10.0, 14.0, 20.0}) {
        Scene scene;
        scene.effects.foam_decay_s = 0.0;  // all foam breaks now
        scene.sea.wind_speed_mps = wind;
        scene.surface.size_m = 1000.0;
        std::printf("  %-10g %12.5f", wind, law_coverage(scene));
        double least = 1.0, most = 0.0;
        for (const int quads : kQuads) {
            scene.surface.resolution = quads;
            const double w = means_of(scene).coverage;
            least = std::min(least, w);
            most = std::max(most, w);
            std::printf(" %10.5f", w);
        }
        std::printf("   %.1f %%\n", 100.0 * (most / least - 1.0));
    }
}

}  // namespace
}  // namespace pelagic::bench

int main() {
    pelagic::bench::slopes();
    pelagic::bench::whitecap_table();
}
