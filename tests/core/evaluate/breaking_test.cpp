// Waves break, ripples don't: effects.breaking_from_m in everything that has coverage.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/scene/editions.h"
#include "core/waves/whitecaps.h"
#include "tests/core/waves/samples.h"

namespace pelagic {
namespace {

using namespace test;

struct SeaKind {
    const char* name;
    void (*set)(Scene&);
};
constexpr SeaKind kSeas[] = {
    {"cascades", [](Scene&) {}},
    {"trains", [](Scene& s) { s.waves.model = WaveModel::Trochoid; }},
    {"trains and cascades",
     [](Scene& s) {
         s.waves.model = WaveModel::Trochoid;
         s.waves.cascades = {{40.0, 256}, {7.0, 128}};
         s.waves.shortest_m = 5.0;
     }},
    {"no choppiness", [](Scene& s) { s.waves.choppiness = 0.0; }},
    {"trains without choppiness",
     [](Scene& s) {
         s.waves.model = WaveModel::Trochoid;
         s.waves.choppiness = 0.0;
     }},
    {"cascades of different choppiness",
     [](Scene& s) {
         s.waves.cascades = {{600.0, 192, 0.6}, {60.0, 160, 1.6}, {8.0, 128, 0.0}};
     }},
    {"a few metres", [](Scene& s) { s.effects.breaking_from_m = 3.3; }},
};

Scene scene_of(const SeaKind& sea, double wind_mps = 14.0) {
    Scene scene;
    scene.effects.foam_decay_s = 0.0;  // all foam breaks now
    scene.sea.wind_speed_mps = wind_mps;
    sea.set(scene);
    return scene;
}

const ProductSet kFoam = products(Product::Breaking, Product::JacobianMoments);

// A pixel finer than what breaks sees what the finest of those sees, however the points are asked for. With ripples that
// break none of these holds.
TEST(Breaking, FinerPixelsSeeTheSameFoam) {
    const auto points = random_points<double>(200.0, 300);
    for (const SeaKind& sea : kSeas) {
        SCOPED_TRACE(sea.name);
        const Scene scene = scene_of(sea);
        const double finest_m = 0.5 * scene.effects.breaking_from_m;
        const ProductSet all = kFoam | products(Position, Normal);
        std::vector<Query> queries;
        for (const double footprint_m : {finest_m, 0.5 * finest_m, 0.1 * finest_m, 0.01})
            queries.push_back(filtered(footprint_m < 0.1 ? all : kFoam, footprint_m));
        const int levels = static_cast<int>(queries.size());
        queries.push_back(filtered(all, 0.0));
        queries.back().pixel_m = {0.03125, 0.0625, 0.125, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0};
        const auto frame = frame_of<double>(scene, queries, 4.0);
        const auto wanted = sample(frame, 0, points);
        double most = 0.0;
        const auto expect_same = [&](const ProductArrays<double>& found) {
            for (std::size_t i = 0; i < points.size(); ++i) {
                const glm::dvec3 a = wanted.vectors(Product::JacobianMoments)[i],
                                 b = found.vectors(Product::JacobianMoments)[i];
                ASSERT_NEAR(a.x, b.x, 2e-5) << i;  // each level's grid has a spline of its own
                ASSERT_NEAR(a.y, b.y, 1e-7) << i;
                ASSERT_NEAR(wanted.numbers(Product::Breaking)[i], found.numbers(Product::Breaking)[i], 2e-3)
                    << i;
                most = std::max(most, wanted.numbers(Product::Breaking)[i]);
            }
        };
        for (int q = 1; q < levels; ++q) expect_same(sample(frame, q, points));
        Where<double> where;
        where.pixel_m.assign(points.size(), 0.04);
        expect_same(sample(frame, levels, points, where));
        EXPECT_GT(most, 0.5);
    }
}

// An ellipse that is longer than what breaks, and finer across.
TEST(Breaking, LongPixelsHideAlongTheirAxisAlone) {
    for (const SeaKind& sea : {kSeas[0], kSeas[5]}) {
        SCOPED_TRACE(sea.name);
        const auto points = random_points<double>(1200.0, 12000);
        Query query = filtered(kFoam, 0.0);
        query.pixel_m = {0.03125, 0.0625, 0.125, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0};
        const auto frame = frame_of<double>(scene_of(sea), {query}, 4.0);
        const auto mean_of_foam = [&](double width_m, glm::dvec2 axis_m) {
            const std::vector<double> widths(points.size(), width_m);
            const std::vector<glm::dvec2> axes(points.size(), axis_m);
            ProductArrays<double> values;
            values.resize(kFoam, points.size());
            Points<double> asked{.count = points.size(), .rest_m = {points.data()}};
            asked.pixel_m = {widths.data()};
            asked.pixel_axis_m = {axes.data()};
            evaluate(frame, 0, asked, values.results());
            double variance = 0.0, j2 = 0.0;
            for (const glm::dvec3& j : values.vectors(Product::JacobianMoments)) {
                variance += j.y / static_cast<double>(points.size());
                j2 += (j.x - 1.0) * (j.x - 1.0) / static_cast<double>(points.size());
            }
            return std::pair(variance, j2);
        };
        const auto [round_unresolved, round_shown] = mean_of_foam(0.05, {0.05, 0.0});
        for (const glm::dvec2 axis : {glm::dvec2(0.4, 0.0), glm::dvec2(3.0, 0.0), glm::dvec2(0.0, 3.0)}) {
            const auto [unresolved, shown] = mean_of_foam(0.5, axis);
            EXPECT_NEAR((unresolved + shown) / (round_unresolved + round_shown), 1.0, 0.03);
            if (glm::length(axis) < 0.5)
                EXPECT_NEAR(unresolved / round_unresolved, 1.0, 1e-9);
            else
                EXPECT_GT(unresolved, 1.1 * round_unresolved);
        }
    }
}

// Over area, the law's at every footprint.
TEST(Breaking, FoamIsTheLawsAtEveryFootprint) {
    for (const SeaKind& sea : kSeas) {
        SCOPED_TRACE(sea.name);
        const Scene scene = scene_of(sea);
        const auto points = random_points<float>(3000.0, 40000);
        std::vector<Query> queries;
        for (const double footprint_m : {0.02, 0.5, 4.0, 100.0})
            queries.push_back(filtered(kFoam, footprint_m));
        const auto frame = frame_of<float>(scene, queries, 3.0);
        for (int q = 0; q < static_cast<int>(queries.size()); ++q) {
            const auto values = sample(frame, q, points);
            double foam = 0.0, area = 0.0;
            for (std::size_t i = 0; i < points.size(); ++i) {
                const glm::dvec3 j(values.vectors(Product::JacobianMoments)[i]);
                const double own = sea_area(pelagic::JacobianMoments<double>{j.x, j.y, j.z}, true);
                area += own;
                foam += own * static_cast<double>(values.numbers(Product::Breaking)[i]);
            }
            EXPECT_NEAR(foam / area / law_coverage(scene), 1.0, 0.15) << q;  // one tile's peak waves
        }
    }
}

// However little choppiness there is. Where copies of tiles blend, the displacement gradient that a level sea breaks by has no part of the
// weights: from choppiness 0 to the least that counts, some of the foam moves there, and the bound is wider.
TEST(Breaking, FoamIsTheLawsAtEveryChoppiness) {
    const auto points = random_points<float>(3000.0, 20000);
    Scene scene = scene_of_edition(1);  // more of it breaks: one tile is a better mean
    scene.effects.foam_decay_s = 0.0;   // all foam breaks now
    scene.sea.wind_speed_mps = 14.0;
    for (const Tiling tiling : {Tiling::Periodic, Tiling::Random}) {
        scene.waves.tiling = tiling;
        std::vector<float> before;
        double of_none = 0.0;
        for (const double choppiness :
             {0.0, 1e-8, 1e-6, 0.999e-4, 1e-4, 3e-4, 1e-3, 3e-3, 0.01, 0.03, 0.1, 0.3, 1.0}) {
            SCOPED_TRACE(choppiness);
            scene.waves.choppiness = choppiness;
            const auto frame = frame_of<float>(scene, {filtered(kFoam | products(Position), 0.5)}, 3.0);
            const auto values = sample(frame, 0, points);
            double foam = 0.0, area = 0.0, changed = 0.0, all = 0.0;
            for (std::size_t i = 0; i < points.size(); ++i) {
                const glm::dvec3 j(values.vectors(Product::JacobianMoments)[i]);
                const double own = sea_area(pelagic::JacobianMoments<double>{j.x, j.y, j.z}, true);
                const double coverage = static_cast<double>(values.numbers(Product::Breaking)[i]);
                area += own;
                foam += own * coverage;
                all += coverage;
                if (!before.empty()) changed += std::abs(coverage - static_cast<double>(before[i]));
                // Nor does the surface jump where it begins to be displaced.
                ASSERT_LE(glm::length(glm::vec2(values.vectors(Position)[i]) - points[i]),
                          5.0 * choppiness + 2e-4);
            }
            const double of_law = foam / area / law_coverage(scene);
            if (before.empty()) of_none = of_law;
            EXPECT_NEAR(of_law, 1.0, 0.15);  // one tile's peak waves
            if (choppiness <= 0.01) {
                EXPECT_NEAR(of_law, of_none, 0.01);
                EXPECT_LT(changed / all, tiling == Tiling::Periodic ? 0.01 : 0.1);
            }
            before = values.numbers(Product::Breaking);
        }
    }
}

// Where no wave is that long, or none that is has any steepness.
TEST(Breaking, RipplesMakeNoFoam) {
    for (const double fetch_m : {1.0, 30.0}) {
        Scene scene;
        scene.effects.foam_decay_s = 0.0;  // all foam breaks now
        scene.sea.fetch_m = fetch_m;
        for (const WaveModel model : {WaveModel::Fft, WaveModel::Trochoid}) {
            scene.waves.model = model;
            const auto frame = frame_of<float>(scene, {filtered(kFoam, 0.01), filtered(kFoam, 10.0)});
            for (int q = 0; q < 2; ++q)
                for (const float w :
                     sample(frame, q, random_points<float>(5.0, 300)).numbers(Product::Breaking))
                    EXPECT_LT(w, 1e-4f) << fetch_m;  // a hundredth of the law's
        }
        scene.waves.model = WaveModel::Fft;
        scene.effects.breaking_from_m = 0.0;  // as they would, if they broke
        const auto frame = frame_of<float>(scene, {filtered(kFoam, 10.0)});
        EXPECT_NEAR(sample(frame, 0, random_points<float>(5.0, 3)).numbers(Product::Breaking)[0],
                    law_coverage(scene), 0.1 * law_coverage(scene));
    }
}

}  // namespace
}  // namespace pelagic
