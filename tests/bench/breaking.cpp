// Where foam is: its mean over area at every footprint against the law, and how high on the waves it lies.

#include <array>
#include <cmath>
#include <cstdio>
#include <random>

#include "core/evaluate/values.h"
#include "core/scene/names.h"
#include "core/surface/patch.h"
#include "core/waves/whitecaps.h"
#include "tests/bench/timing.h"

namespace pelagic::bench {
namespace {

std::vector<glm::vec2> scattered(int count, unsigned seed) {
    std::mt19937 generator(seed);
    std::uniform_real_distribution<float> inside(-5000.0f, 5000.0f);
    std::vector<glm::vec2> points(count);
    for (glm::vec2& point : points) {
        point.x = inside(generator);
        point.y = inside(generator);
    }
    return points;
}

Scene sea(SpectrumKind spectrum, double wind_mps, int seed) {
    Scene scene;
    scene.effects.foam_decay_s = 0.0;  // all foam breaks now
    scene.shot.seed = static_cast<std::uint64_t>(seed);
    scene.sea.spectrum = spectrum;
    scene.sea.wind_speed_mps = wind_mps;
    return scene;
}

// Shares of the sea's area; each footprint sees the same places of the same seas. A seed has tiles of its own, whose foam
// differs by some 9 % at 8 m/s, so there are many.
void footprints() {
    constexpr std::array kFootprints_m{0.02, 0.05, 0.2, 0.5, 2.0, 10.0, 50.0, 200.0};
    constexpr int kSeeds = 16, kPoints = 50000;
    std::printf("Coverage over area, of the law's; footprints [m]\n  %-12s %5s", "", "m/s");
    for (const double footprint_m : kFootprints_m) std::printf(" %6g", footprint_m);
    std::printf("\n");
    std::vector<Query> queries;
    for (const double footprint_m : kFootprints_m) {
        Query& query = queries.emplace_back();
        query.name = "points";
        query.products = products(Product::Breaking, Product::JacobianMoments);
        query.cell_m = query.pixel_m = {footprint_m};
    }
    double worst = 0.0;
    for (const SpectrumKind spectrum : {SpectrumKind::Jonswap, SpectrumKind::Elfouhaily})
        for (const double wind_mps : {8.0, 10.0, 14.0}) {
            std::array<double, kFootprints_m.size()> foam{}, area{};
            for (int seed = 1; seed <= kSeeds; ++seed) {
                Frame<float> frame(
                    std::make_shared<const Sea<float>>(make_plan(sea(spectrum, wind_mps, seed), queries)));
                frame.set(3.0);
                const auto rest = scattered(kPoints, static_cast<unsigned>(seed));
                for (std::size_t q = 0; q < queries.size(); ++q) {
                    Values values;
                    QueryRunner<float>().run(frame, static_cast<int>(q),
                                             {.count = rest.size(), .rest_m = {rest.data()}}, values);
                    for (std::size_t i = 0; i < rest.size(); ++i) {
                        const glm::vec3 j = values.vectors(Product::JacobianMoments)[i];
                        const double own = sea_area(JacobianMoments<double>{j.x, j.y, j.z}, true);
                        area[q] += own;
                        foam[q] += own * static_cast<double>(values.numbers(Product::Breaking)[i]);
                    }
                }
            }
            std::printf("  %-12s %5g", std::string(word_of(spectrum)).c_str(), wind_mps);
            for (std::size_t q = 0; q < queries.size(); ++q) {
                const double of_law = foam[q] / area[q] / law_coverage(sea(spectrum, wind_mps, 1));
                worst = std::max(worst, std::abs(of_law - 1.0));
                std::printf(" %6.3f", of_law);
            }
            std::printf("\n");
        }
    std::printf("  furthest off: %.1f %%   target 5 %%: %s\n", 100.0 * worst, verdict(worst <= 0.05));
}

// Over cells of half a metre.
void heights() {
    constexpr int kSide = 1024, kSeeds = 4;
    std::printf(
        "\nActive foam, cells of 0.5 m over 512 m, %d seeds: its mean elevation, and how much of it lies where "
        "coverage > 0.5\n  %-12s %5s %16s %10s %12s\n",
        kSeeds, "", "m/s", "breaking_from_m", "elevation", "dense part");
    const auto points = rest_points<float>({.per_side = kSide, .spacing_m = 0.5, .first_m = -256.0});
    for (const SpectrumKind spectrum : {SpectrumKind::Elfouhaily, SpectrumKind::Jonswap})
        for (const double from_m : {0.0, 0.5, 1.0, 2.0, 4.0}) {
            double foam = 0.0, high = 0.0, dense = 0.0;
            for (int seed = 1; seed <= kSeeds; ++seed) {
                Scene scene = sea(spectrum, 14.0, seed);
                scene.effects.breaking_from_m = from_m;
                Query query;
                query.name = "cells";
                query.products = products(Product::Position, Product::Breaking);
                query.cell_m = query.pixel_m = {0.5};
                Frame<float> frame(std::make_shared<const Sea<float>>(make_plan(scene, {query})));
                frame.set(3.0);
                Values values;
                QueryRunner<float>().run(frame, 0, {.count = points.size(), .rest_m = {points.data()}},
                                         values);
                double height2 = 0.0, foam_height = 0.0;
                for (std::size_t i = 0; i < points.size(); ++i) {
                    const double w = static_cast<double>(values.numbers(Product::Breaking)[i]),
                                 z = static_cast<double>(values.vectors(Product::Position)[i].z);
                    height2 += z * z;
                    foam += w;
                    foam_height += w * z;
                    if (w > 0.5) dense += w;
                }
                high += foam_height / std::sqrt(height2 / static_cast<double>(points.size()));
            }
            std::printf("  %-12s %5g %16g %8.2f σ %10.0f %%", std::string(word_of(spectrum)).c_str(), 14.0,
                        from_m, high / foam, 100.0 * dense / foam);
            if (spectrum == SpectrumKind::Elfouhaily && from_m == Effects{}.breaking_from_m)
                std::printf("   targets 1 σ, 25 %%: %s", verdict(high >= foam && dense >= 0.25 * foam));
            std::printf("\n");
        }
}

}  // namespace
}  // namespace pelagic::bench

int main() {
    pelagic::bench::footprints();
    pelagic::bench::heights();
}
