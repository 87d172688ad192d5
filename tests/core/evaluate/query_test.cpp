// The query's contract: strides, refusals, footprints per point.
#include <gtest/gtest.h>
#include <limits>
#include <memory>
#include <stdexcept>

#include <cmath>
#include "core/spectrum/directional_spectrum.h"
#include "core/spectrum/spectral_moments.h"
#include "tests/core/waves/samples.h"

namespace pelagic {
namespace {

using namespace test;

Scene small_sea() {
    Scene scene;
    scene.waves.cascades = {{200.0, 96}, {50.0, 96}};
    return scene;
}
ProductSet all_products() {
    return ~lasting_products();
}

TEST(Query, WritesWhereTheCallerWantsItAndNowhereElse) {
    const auto frame = frame_of<float>(small_sea(), {filtered(all_products(), 1.0)}, 1.0);
    const auto points = random_points<float>(100.0, 300);
    const auto packed = sample(frame, 0, points);
    // Interleaved as a host's vertices may be, with sentinels between.
    struct Vertex {
        glm::vec3 position;
        float before = -7.0f;
        glm::vec3 normal;
        float coverage;
        float after = -7.0f;
    };
    std::vector<Vertex> vertices(points.size());
    Results<float> results;
    results.set(Product::Position, {&vertices[0].position, sizeof(Vertex)});
    results.set(Product::Normal, {&vertices[0].normal, sizeof(Vertex)});
    results.set(Product::Breaking, {&vertices[0].coverage, sizeof(Vertex)});
    evaluate(frame, 0,
             {.origin_m = {}, .count = points.size(), .rest_m = {points.data()}, .cell_m = {}, .pixel_m = {}},
             results);
    for (std::size_t i = 0; i < points.size(); ++i) {
        EXPECT_EQ(vertices[i].position, packed.vectors(Position)[i]);
        EXPECT_EQ(vertices[i].normal, packed.vectors(Normal)[i]);
        EXPECT_EQ(vertices[i].coverage, packed.numbers(Product::Breaking)[i]);
        EXPECT_EQ(vertices[i].before, -7.0f);
        EXPECT_EQ(vertices[i].after, -7.0f);
        EXPECT_EQ(packed.vectors(Position)[i], packed.vectors(Displacement)[i] + glm::vec3(points[i], 0.0f));
    }
}

TEST(Query, RefusesAFrameWithoutATime) {
    const Scene scene = small_sea();
    const Frame<float> frame(
        std::make_shared<const Sea<float>>(make_plan(scene, {unfiltered(products(Product::Displacement))})));
    EXPECT_THROW(sample(frame, 0, random_points<float>(100.0, 3)), std::invalid_argument);
}

// Places so far off that single precision has no tile left, and footprints that are no number: nothing is
// read outside the grids, and what does not contain the place itself is finite.
TEST(Query, StaysInsideItsGridsWhateverThePlace) {
    Query levels = filtered(all_products(), 1.0);
    levels.cell_m = levels.pixel_m = {1.0, 2.0};
    const auto frame = frame_of<float>(small_sea(), {levels}, 1.0);
    std::vector<glm::vec2> points{{1e20f, -1e20f}, {3e38f, 0.0f}};
    for (int i = 0; i < 2000; ++i) {
        const float far = 1e16f * std::pow(1.01f, static_cast<float>(i % 1000));
        points.emplace_back(i < 1000 ? far : -far, 0.37f * far);
    }
    for (const glm::vec3& d : sample(frame, 0, points).vectors(Displacement))
        for (int axis = 0; axis < 3; ++axis) ASSERT_LT(std::abs(d[axis]), 100.0f);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    std::vector<glm::vec3> normal(1);
    Results<float> results;
    results.set(Product::Normal, {normal.data()});
    evaluate(frame, 0,
             {.origin_m = {}, .count = 1, .rest_m = {points.data()}, .cell_m = {&nan}, .pixel_m = {&nan}},
             results);
    EXPECT_TRUE(std::isfinite(normal[0].x));
}

TEST(Query, RefusesWhatItDoesNotHold) {
    const auto frame = frame_of<float>(small_sea(), {unfiltered(products(Product::Displacement))});
    const auto points = random_points<float>(100.0, 3);
    const Points<float> at{
        .origin_m = {}, .count = 3, .rest_m = {points.data()}, .cell_m = {}, .pixel_m = {}};
    for (const ProductRow& row : kProductTable) {
        if (row.product == Product::Displacement) continue;
        Values values;
        values.resize(products(row.product), 3);
        EXPECT_THROW(evaluate(frame, 0, at, values.results()), std::invalid_argument) << row.name;
    }
    EXPECT_THROW(evaluate(frame, 1, at, {}), std::exception);
    EXPECT_THROW(evaluate(frame, -1, at, {}), std::exception);
    EXPECT_NO_THROW(evaluate(frame, 0, at, {}));
    EXPECT_NO_THROW(evaluate(frame, 0, {}, {}));
}

Query levels(ProductSet wanted) {
    Query query = unfiltered(wanted);
    query.cell_m = query.pixel_m = {0.5, 1.0, 2.0, 4.0};
    return query;
}

// On one of the levels a query is the uniform query of that footprint, to rounding; outside it holds its ends.
TEST(Levels, IsTheUniformQueryOnItsLevels) {
    std::vector<Query> queries{levels(all_products())};
    for (double level : {0.5, 1.0, 2.0, 4.0}) queries.push_back(filtered(all_products(), level));
    const auto frame = frame_of<float>(small_sea(), queries, 1.0);
    const auto points = random_points<float>(100.0, 200);
    const auto at = [&](float footprint) {
        const std::vector<float> same(points.size(), footprint);
        return sample(frame, 0, points, {.origin_m = {}, .cell_m = same, .pixel_m = same});
    };
    const struct {
        float footprint;
        int query;
    } cases[] = {{0.5f, 1}, {1.0f, 2}, {2.0f, 3}, {4.0f, 4}, {0.01f, 1}, {100.0f, 4}};
    for (const auto& c : cases) {
        const auto blended = at(c.footprint), uniform = sample(frame, c.query, points);
        for (std::size_t i = 0; i < points.size(); ++i) {
            for (int axis = 0; axis < 3; ++axis) {
                EXPECT_NEAR(blended.vectors(Displacement)[i][axis], uniform.vectors(Displacement)[i][axis],
                            1e-5)
                    << c.footprint;
                EXPECT_NEAR(blended.vectors(Normal)[i][axis], uniform.vectors(Normal)[i][axis], 1e-5)
                    << c.footprint;
                EXPECT_NEAR(blended.vectors(SlopeVariance)[i][axis], uniform.vectors(SlopeVariance)[i][axis],
                            1e-7)
                    << c.footprint;
                EXPECT_NEAR(blended.vectors(Product::JacobianMoments)[i][axis],
                            uniform.vectors(Product::JacobianMoments)[i][axis], 1e-5)
                    << c.footprint;
            }
            EXPECT_NEAR(blended.numbers(Product::Breaking)[i], uniform.numbers(Product::Breaking)[i], 1e-4)
                << c.footprint;
        }
    }
    // Across a level: no step. The blend's slope is bounded by the levels' own difference, some 0.5 per
    // footprint.
    for (float level : {1.0f, 2.0f}) {
        const auto below = at(level * (1.0f - 1e-5f)), above = at(level * (1.0f + 1e-5f));
        for (std::size_t i = 0; i < points.size(); ++i) {
            EXPECT_NEAR(below.vectors(Displacement)[i].z, above.vectors(Displacement)[i].z, 1e-4);
            EXPECT_NEAR(below.vectors(Normal)[i].x, above.vectors(Normal)[i].x, 1e-4);
            EXPECT_NEAR(below.vectors(SlopeVariance)[i].x, above.vectors(SlopeVariance)[i].x, 1e-6);
        }
    }
}

// Between levels too resolved + residual is the spectrum's: the residual is that of the blended weights. The
// statistics of one point's footprint, many points, eight seeds.
TEST(Levels, ConservesSlopeVarianceBetweenItsLevels) {
    for (float footprint : {0.7f, 1.4f, 3.1f}) {
        double sum_xx = 0.0, sum_yy = 0.0, sum_xy = 0.0;
        SpectralMoments spectrum;
        for (int seed = 1; seed <= 8; ++seed) {
            Scene scene = small_sea();
            scene.shot.seed = seed;
            scene.sea.wind_direction_deg = 30.0;
            scene.waves.choppiness = 0.0;
            const auto frame =
                frame_of<float>(scene, {levels(products(Product::Normal, Product::SlopeVariance))});
            const auto points = tile_points<float>(200.0, 150);
            const std::vector<float> same(points.size(), footprint);
            const auto samples = sample(frame, 0, points, {.origin_m = {}, .cell_m = same, .pixel_m = same});
            const auto moment = [&](int a, int b) {
                return mean_of(samples.vectors(Normal),
                               [&](auto n) { return double(n[a] / n.z) * double(n[b] / n.z); });
            };
            sum_xx += (moment(0, 0) + samples.vectors(SlopeVariance)[0].x) / 8.0;
            sum_yy += (moment(1, 1) + samples.vectors(SlopeVariance)[0].y) / 8.0;
            sum_xy += (moment(0, 1) + samples.vectors(SlopeVariance)[0].z) / 8.0;
            spectrum = moments(DirectionalSpectrum(scene.sea), 0.0, std::numeric_limits<double>::infinity());
        }
        EXPECT_NEAR((sum_xx + sum_yy) / spectrum.mss(), 1.0, 0.03) << footprint;
        EXPECT_NEAR(sum_xx / spectrum.xx, 1.0, 0.05) << footprint;
        EXPECT_NEAR(sum_yy / spectrum.yy, 1.0, 0.05) << footprint;
        EXPECT_NEAR(sum_xy, spectrum.xy, 0.03 * spectrum.mss()) << footprint;
    }
}

}  // namespace
}  // namespace pelagic
