// Cascades of copies at random offsets: the sum by hand, its derivatives, its statistics, and one sea whoever asks.
#include "core/plan/random_tiling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

#include "core/evaluate/bounds.h"
#include "core/evaluate/prepared_query.h"
#include "tests/core/waves/samples.h"

namespace pelagic {
namespace {

using namespace test;

constexpr std::array kSizes{64.0, 18.0};

Scene copied_sea() {
    Scene scene;
    scene.sea.wind_speed_mps = 5.0;
    scene.sea.fetch_m = 3e3;
    scene.shot.seed = 5;
    scene.waves.tiling = Tiling::Random;
    scene.waves.cascades = {{kSizes[0], 64}, {kSizes[1], 64}};
    scene.quality.level = QualityLevel::Reference;
    scene.effects.breaking_from_m = 0.0;
    return scene;
}

// Near borders and corners of both cascades' cells, and anywhere.
template <class T>
std::vector<glm::vec<2, T>> places(int count) {
    std::vector<glm::vec<2, T>> rest = random_points<T>(900.0, count);
    for (const auto& away : random_points<T>(8.0, count, 2))
        rest.push_back(away + glm::vec<2, T>(T(32), T(96)));
    for (const auto& away : random_points<T>(8.0, count, 3))
        rest.push_back(away + glm::vec<2, T>(T(9), T(5)));
    return rest;
}

// A point's copies along an axis: cells, weights, and what these change by.
struct Along {
    std::array<std::int64_t, 2> cell;
    std::array<double, 2> weight, slope;
};
Along along(double x, double size_m) {
    const double cell = std::floor(x / size_m + 0.5), from = x / size_m - cell;
    const BlendWeights<double> w = blend_weights(std::abs(from));
    const double side = from < 0.0 ? -1.0 : 1.0;
    const auto own = static_cast<std::int64_t>(cell);
    return {{own, own + static_cast<std::int64_t>(side)},
            {w.own, w.next},
            {-w.next * w.rate * side / size_m, w.own * w.rate * side / size_m}};
}

// The tiles, each asked for by itself, add up to the sea by the rule.
TEST(RandomTiling, AddUpToTheSeaByTheRule) {
    const Scene scene = copied_sea();
    const ProductSet wanted = products(Displacement, Velocity);
    std::vector<Query> queries{unfiltered(wanted)};
    for (int c = 0; c < 2; ++c) {
        queries.push_back(unfiltered(wanted));
        queries.back().only_cascade = c;
    }
    const auto frame = frame_of<double>(scene, queries, 2.5);
    const auto rest = places<double>(300);
    for (const glm::dvec2 origin : {glm::dvec2(0.0), glm::dvec2(1e8, -3e7)}) {
        const auto sea = sample(frame, 0, rest, {.origin_m = origin, .cell_m = {}, .pixel_m = {}});
        std::vector<glm::dvec3> sum(rest.size(), glm::dvec3(0.0)), velocity = sum;
        for (int c = 0; c < 2; ++c)
            for (std::size_t i = 0; i < rest.size(); ++i) {
                const glm::dvec2 x = origin + rest[i];
                const Along ax = along(x.x, kSizes[c]), ay = along(x.y, kSizes[c]);
                for (int copy = 0; copy < 4; ++copy) {
                    const int p = copy % 2, q = copy / 2;
                    const double weight = ax.weight[p] * ay.weight[q];
                    if (weight == 0.0) continue;
                    const auto offset = tile_offset<double>(tiling_key(5, c), static_cast<uint>(ax.cell[p]),
                                                            static_cast<uint>(ay.cell[q]));
                    const auto tile = sample(frame, 1 + c, std::vector<glm::dvec2>{rest[i]},
                                             {.origin_m = origin + kSizes[c] * glm::dvec2(offset.x, offset.y),
                                              .cell_m = {},
                                              .pixel_m = {}});
                    sum[i] += weight * tile.vectors(Displacement)[0];
                    velocity[i] += weight * tile.vectors(Velocity)[0];
                }
            }
        for (std::size_t i = 0; i < rest.size(); ++i)
            for (int a = 0; a < 3; ++a) {
                ASSERT_NEAR(sea.vectors(Displacement)[i][a], sum[i][a], 1e-6) << i;
                ASSERT_NEAR(sea.vectors(Velocity)[i][a], velocity[i][a], 1e-6) << i;
            }
    }
}

// Positions go over borders without a step, and normals and J are theirs: by differences of positions, in ramps and corners
// and where a ramp begins.
TEST(RandomTiling, HaveTheNormalsAndTheJacobianOfTheirPositions) {
    const auto frame = frame_of<double>(
        copied_sea(), {unfiltered(products(Position, Normal, Product::JacobianMoments))}, 2.5);
    auto rest = places<double>(300);
    for (double along : {kPlainHalf * 64.0, 0.5 * 64.0, 64.0 - kPlainHalf * 64.0, kPlainHalf * 18.0, 9.0})
        for (double across : {0.0, 3.0, kPlainHalf * 64.0, 32.0, 9.0})
            for (double sign : {-1.0, 1.0}) {
                rest.push_back({sign * along, across});
                rest.push_back({across, sign * along});
            }
    constexpr double kStep = 1e-4;
    for (const glm::dvec2 origin : {glm::dvec2(0.0), glm::dvec2(64e6, -1.28e8)}) {
        const Where<double> at{.origin_m = origin, .cell_m = {}, .pixel_m = {}};
        const auto moved = [&](glm::dvec2 by) {
            std::vector<glm::dvec2> there = rest;
            for (glm::dvec2& x : there) x += by;
            return sample(frame, 0, there, at).vectors(Position);
        };
        const auto east = moved({kStep, 0.0}), west = moved({-kStep, 0.0}), north = moved({0.0, kStep}),
                   south = moved({0.0, -kStep});
        const auto answers = sample(frame, 0, rest, at);
        double turned = 0.0;
        for (std::size_t i = 0; i < rest.size(); ++i) {
            const glm::dvec3 tx = (east[i] - west[i]) / (2.0 * kStep),
                             ty = (north[i] - south[i]) / (2.0 * kStep);
            const glm::dvec3 across = glm::cross(tx, ty);
            ASSERT_NEAR(glm::length(answers.vectors(Normal)[i] - glm::normalize(across)), 0.0, 2e-5) << i;
            ASSERT_NEAR(answers.vectors(Product::JacobianMoments)[i].x, across.z, 2e-5) << i;
            turned = std::max(turned, std::abs(tx.y - ty.x));
        }
        EXPECT_GT(turned, 1e-3);  // Dxy and Dyx do differ somewhere
    }
}

// A normal doesn't need the cell's positions to be asked for.
TEST(RandomTiling, HaveTheSameNormalsWithoutPositions) {
    const Scene scene = copied_sea();
    const auto alone =
        frame_of<double>(scene, {filtered(products(Normal, Product::JacobianMoments), 0.5)}, 2.5);
    const auto together =
        frame_of<double>(scene, {filtered(products(Position, Normal, Product::JacobianMoments), 0.5)}, 2.5);
    const auto rest = places<double>(300);
    const auto a = sample(alone, 0, rest), b = sample(together, 0, rest);
    EXPECT_EQ(a.vectors(Normal), b.vectors(Normal));
    EXPECT_EQ(a.vectors(Product::JacobianMoments), b.vectors(Product::JacobianMoments));
}

// Single precision is that of one tile, wherever.
TEST(RandomTiling, AreTheSameInSinglePrecision) {
    Scene scene = copied_sea();
    scene.quality.level = QualityLevel::Final;
    const std::vector<Query> queries{filtered(products(Displacement, Normal), 0.25)};
    const auto narrow = frame_of<float>(scene, queries, 2.5);
    const auto wide = frame_of<double>(scene, queries, 2.5);
    const auto rest = places<float>(300);
    const std::vector<glm::dvec2> rest_wide(rest.begin(), rest.end());
    for (const glm::dvec2 origin : {glm::dvec2(0.0), glm::dvec2(1e8, -3e7)}) {
        const auto a = sample(narrow, 0, rest, {.origin_m = origin, .cell_m = {}, .pixel_m = {}});
        const auto b = sample(wide, 0, rest_wide, {.origin_m = origin, .cell_m = {}, .pixel_m = {}});
        for (std::size_t i = 0; i < rest.size(); ++i) {
            ASSERT_NEAR(glm::length(glm::dvec3(a.vectors(Displacement)[i]) - b.vectors(Displacement)[i]), 0.0,
                        2e-5);
            ASSERT_NEAR(glm::length(glm::dvec3(a.vectors(Normal)[i]) - b.vectors(Normal)[i]), 0.0, 5e-5);
        }
    }
}

// A point's answer depends on the point alone, to the bit, whichever points are asked with it: on several levels, for ellipses too.
TEST(RandomTiling, AnswerEachPointAloneToTheBit) {
    Query query = unfiltered(products(Position, Normal, Velocity, Product::Breaking));
    query.cell_m = {0.5, 1.0, 2.0, 4.0};
    query.pixel_m = {0.25, 0.5, 1.0, 2.0, 4.0};
    const auto frame = frame_of<float>(copied_sea(), {query}, 2.5);
    const auto rest = places<float>(300);
    std::vector<float> cell_m, pixel_m;
    std::vector<glm::vec2> axis_m;
    for (const glm::vec2 size : random_points<float>(4.0, static_cast<int>(rest.size()), 4)) {
        cell_m.push_back(2.0f + size.x);
        pixel_m.push_back(0.25f * (2.0f + size.x));
        axis_m.push_back(size.y > 0.0f ? glm::vec2(0.0f) : 2.0f * size);
    }
    const auto ask = [&](std::size_t first, std::size_t count) {
        ProductArrays<float> out;
        out.resize(query.products, count);
        evaluate(frame, 0,
                 Points<float>{.count = count,
                               .rest_m = {rest.data() + first},
                               .cell_m = {cell_m.data() + first},
                               .pixel_m = {pixel_m.data() + first},
                               .pixel_axis_m = {axis_m.data() + first}},
                 out.results());
        return out;
    };
    const auto all = ask(0, rest.size());
    for (std::size_t i = 0; i < rest.size(); ++i) {
        const auto one = ask(i, 1);
        for (const Product product : {Position, Normal, Velocity})
            ASSERT_EQ(one.vectors(VectorProduct::checked(product))[0],
                      all.vectors(VectorProduct::checked(product))[i])
                << i;
        ASSERT_EQ(one.numbers(Product::Breaking)[0], all.numbers(Product::Breaking)[i]) << i;
    }
}

// What a row of a patch keeps for the row above (RowPlaces, TilingPlaces) changes nothing: not where copies blend along either axis, nor
// where a row lies elsewhere.
TEST(RandomTiling, GiveAPatchTheBitsOfItsPointsAlone) {
    const auto frame =
        frame_of<float>(copied_sea(), {unfiltered(products(Position, Normal, Product::Breaking))}, 2.5);
    constexpr std::size_t kRow = 300, kRows = 70;
    std::vector<glm::vec2> rest;
    for (std::size_t j = 0; j < kRows; ++j)
        for (std::size_t i = 0; i < kRow; ++i)
            rest.emplace_back(0.31f * static_cast<float>(i) - 60.0f + (j == 7 ? 0.1f : 0.0f),
                              0.9f * static_cast<float>(j) - 40.0f);
    const PreparedQuery<float> prepared(frame, 0, products(Position, Normal, Product::Breaking));
    const auto values_of = [&](std::size_t first, std::size_t count) {
        ProductArrays<float> values;
        values.resize(products(Position, Normal, Product::Breaking), count);
        // On one thread, which meets the rows one after another.
        prepared.evaluate_alone(
            {.count = count, .rest_m = {rest.data() + first}, .cell_m = {}, .pixel_m = {}}, values.results());
        return values;
    };
    auto all = values_of(0, rest.size());
    for (std::size_t i = 0; i < rest.size(); i += 13) {
        auto one = values_of(i, 1);
        for (const Product product : {Position, Normal})
            ASSERT_EQ(one.vectors(VectorProduct::checked(product))[0],
                      all.vectors(VectorProduct::checked(product))[i])
                << i;
        ASSERT_EQ(one.numbers(Product::Breaking)[0], all.numbers(Product::Breaking)[i]) << i;
    }
}

// A place that is no number, or infinite, leaves the points beside it alone, wherever among them it stands.
TEST(RandomTiling, AnswerBesideWhatIsNoNumber) {
    const auto frame = frame_of<float>(copied_sea(), {unfiltered(products(Position))}, 2.5);
    const auto heights_of = [&](const std::vector<glm::vec2>& rest) {
        return sample(frame, 0, rest, {.origin_m = {}, .cell_m = {}, .pixel_m = {}}).vectors(Position);
    };
    std::vector<glm::vec2> good(40, glm::vec2(100.0f, -140.0f));
    for (std::size_t i = 0; i < good.size(); ++i) good[i].x += 0.05f * static_cast<float>(i);
    const auto expected = heights_of(good);
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN(),
                    kInf = std::numeric_limits<float>::infinity();
    for (const float odd : {kNan, kInf, -kInf})
        for (const std::size_t at : {std::size_t(0), good.size() / 2, good.size()}) {
            auto rest = good;
            rest.insert(rest.begin() + static_cast<std::ptrdiff_t>(at), glm::vec2(odd));
            auto heights = heights_of(rest);
            heights.erase(heights.begin() + static_cast<std::ptrdiff_t>(at));
            for (std::size_t i = 0; i < good.size(); ++i)
                ASSERT_EQ(heights[i], expected[i]) << odd << ' ' << at;
        }
}

// An ellipse is the mean of its taps, each of which shows the copies of its own place.
TEST(RandomTiling, AreFilteredByEllipsesAsOneTileIs) {
    Scene scene = copied_sea();
    scene.waves.choppiness = 0.0;
    Query query = unfiltered(products(Normal));
    query.pixel_m = {0.25, 0.5, 1.0, 2.0, 4.0};
    const auto frame = frame_of<double>(scene, {query}, 2.5);
    const auto rest = places<double>(100);
    const std::vector<double> width(rest.size(), 0.5);
    const std::vector<glm::dvec2> axis(rest.size(), glm::dvec2(1e-3, 0.5005));  // hardly longer than wide
    ProductArrays<double> ellipse;
    ellipse.resize(query.products, rest.size());
    evaluate(frame, 0,
             Points<double>{.count = rest.size(),
                            .rest_m = {rest.data()},
                            .pixel_m = {width.data()},
                            .pixel_axis_m = {axis.data()}},
             ellipse.results());
    const auto round = sample(frame, 0, rest, {.origin_m = {}, .cell_m = {}, .pixel_m = width});
    for (std::size_t i = 0; i < rest.size(); ++i)
        ASSERT_NEAR(glm::length(ellipse.vectors(Normal)[i] - round.vectors(Normal)[i]), 0.0, 1e-3) << i;
}

// Heights' variance over many cells is that of the tile, slopes' is larger by the weights' gradient, and no more.
TEST(RandomTiling, KeepTheVariances) {
    Scene scene = copied_sea();
    scene.waves.choppiness = 0.0;
    scene.waves.cascades = {{64.0, 64}};
    Scene periodic = scene;
    periodic.waves.tiling = Tiling::Periodic;
    const std::vector<Query> queries{unfiltered(products(Displacement, Normal))};
    const auto copies = frame_of<double>(scene, queries), one = frame_of<double>(periodic, queries);
    const auto rest = random_points<double>(64.0 * 60.0, 400000);
    struct Variances {
        double height, slope;
    };
    const auto variances = [&](const Frame<double>& frame) {
        const auto values = sample(frame, 0, rest);
        return Variances{mean_of(values.vectors(Displacement), [](const auto& d) { return d.z * d.z; }),
                         mean_of(values.vectors(Normal),
                                 [](const auto& n) { return (n.x * n.x + n.y * n.y) / (n.z * n.z); })};
    };
    const Variances with = variances(copies), without = variances(one);
    EXPECT_NEAR(with.height / without.height, 1.0, 0.02);
    const double beyond = 2.0 * kBlendSlopes * without.height / (64.0 * 64.0);
    EXPECT_NEAR((with.slope - beyond) / without.slope, 1.0, 0.015);
    EXPECT_LT(beyond / without.slope, 0.005);
}

// Today's sea stays: each cascade repeats after its size. With copies it doesn't, but is the same tile round the origin.
TEST(RandomTiling, ArePeriodicWhereTheSceneSaysSo) {
    Scene scene = copied_sea();
    scene.waves.cascades = {{64.0, 64}};
    Scene periodic = scene;
    periodic.waves.tiling = Tiling::Periodic;
    const std::vector<Query> queries{unfiltered(products(Displacement))};
    const auto copies = frame_of<double>(scene, queries), one = frame_of<double>(periodic, queries);
    const auto rest = random_points<double>(2.0 * kPlainHalf * 64.0, 300);
    const auto here = sample(one, 0, rest), middle = sample(copies, 0, rest);
    EXPECT_EQ(here.vectors(Displacement), middle.vectors(Displacement));
    const Where<double> away{.origin_m = {128.0, -64.0}, .cell_m = {}, .pixel_m = {}};
    const auto there = sample(one, 0, rest, away), elsewhere = sample(copies, 0, rest, away);
    double most = 0.0;
    for (std::size_t i = 0; i < rest.size(); ++i) {
        ASSERT_NEAR(here.vectors(Displacement)[i].z, there.vectors(Displacement)[i].z, 1e-12);
        most = std::max(most,
                        std::abs(middle.vectors(Displacement)[i].z - elsewhere.vectors(Displacement)[i].z));
    }
    EXPECT_GT(most, 0.1);
}

// The sea is the same for every surface, wherever its camera is and whichever frames are asked for: its points' cells and
// pixels are 8 m, as those of every surface may be.
TEST(RandomTiling, AreOneSeaForEverySurface) {
    Scene scene;
    scene.waves.tiling = Tiling::Random;
    scene.surface.size_m = 2048.0;
    scene.surface.resolution = 256;
    scene.quality.level = QualityLevel::Preview;
    scene.output.attributes = {MeshAttribute::Normal};
    const auto rest = random_points<float>(5000.0, 400);
    const std::vector<float> footprint(rest.size(), 8.0f);
    std::vector<glm::vec3> first_position, first_normal;
    for (const SurfaceKind kind : {SurfaceKind::Patch, SurfaceKind::ProjectedGrid, SurfaceKind::Planet})
        for (const glm::dvec3 camera : {glm::dvec3(0.0, -60.0, 4.0), glm::dvec3(2e4, 1e3, 300.0)})
            for (const int frames : {1, 3}) {
                scene.surface.kind = kind;
                scene.camera.position_m = camera;
                scene.shot.last_frame = frames;
                std::vector<int> numbers;
                for (int f = 1; f <= frames; ++f) numbers.push_back(f);
                const Plan plan = plan_bake(prepare(scene), numbers);
                const auto frame = frame_of<float>(scene, plan, 1.0);
                ProductArrays<float> values;
                values.resize(products(Position, Normal), rest.size());
                evaluate(frame, 0,
                         Points<float>{.count = rest.size(),
                                       .rest_m = {rest.data()},
                                       .cell_m = {footprint.data()},
                                       .pixel_m = {footprint.data()}},
                         values.results());
                if (first_position.empty()) {
                    first_position = values.vectors(Position);
                    first_normal = values.vectors(Normal);
                }
                for (std::size_t i = 0; i < rest.size(); ++i) {
                    ASSERT_NEAR(glm::length(values.vectors(Position)[i] - first_position[i]), 0.0, 1e-3) << i;
                    ASSERT_NEAR(glm::length(values.vectors(Normal)[i] - first_normal[i]), 0.0, 1e-3) << i;
                }
            }
}

// No point leaves the bounds of a region, with or without borders in it, nor those of everything.
TEST(RandomTiling, StayWithinTheirBounds) {
    const auto frame = frame_of<float>(copied_sea(), {unfiltered(products(Displacement))}, 2.5);
    const FrameBounds<float> bounds(frame, 0);
    const DisplacementBounds everywhere = bounds.everywhere();
    for (const double size_m : {3.0, 20.0, 150.0})
        for (const glm::dvec2 middle :
             {glm::dvec2(0.0), glm::dvec2(32.0, 96.0), glm::dvec2(9.0, 5.0), glm::dvec2(1e8, 32.0)}) {
            const auto rest = random_points<float>(size_m, 4000);
            const auto values = sample(frame, 0, rest, {.origin_m = middle, .cell_m = {}, .pixel_m = {}});
            const DisplacementBounds region = bounds.region({middle - 0.5 * size_m, middle + 0.5 * size_m});
            double high = -1e9;
            for (const glm::vec3& d : values.vectors(Displacement)) {
                high = std::max<double>(high, d.z);
                for (const DisplacementBounds* of : {&region, &everywhere}) {
                    ASSERT_LE(of->z.lo, d.z);
                    ASSERT_GE(of->z.hi, d.z);
                    ASSERT_LE(of->dx.lo, d.x);
                    ASSERT_GE(of->dx.hi, d.x);
                    ASSERT_LE(of->dy.lo, d.y);
                    ASSERT_GE(of->dy.hi, d.y);
                }
            }
            EXPECT_LT(region.z.hi - high,
                      0.2 * (everywhere.z.hi - everywhere.z.lo));  // and isn't far from them
        }
}

// What the plan adds where copies blend: the fields that the weights' gradient needs, and only where it does.
TEST(RandomTiling, AskForWhatTheirGradientNeeds) {
    Scene scene = copied_sea();
    const auto transforms = [&](Tiling tiling, const Query& query) {
        scene.waves.tiling = tiling;
        return make_plan(scene, {query}).transforms_per_frame();
    };
    const Query mesh = filtered(products(Position, Normal), 0.5), map = filtered(products(Normal), 0.5);
    EXPECT_EQ(transforms(Tiling::Random, mesh), transforms(Tiling::Periodic, mesh));
    EXPECT_EQ(transforms(Tiling::Periodic, map), 2 * 5);
    EXPECT_EQ(transforms(Tiling::Random, map), 2 * 8);
    Query small = map;  // within the middle of the larger cascade's first cell
    small.lattice = Lattice{-10.0, 0.5, 10.0};
    EXPECT_EQ(transforms(Tiling::Random, small), 5 + 8);
    EXPECT_EQ(make_plan(scene, {small}).cascades[0].grids[0].sampling, Sampling::Nodes);
    EXPECT_EQ(make_plan(scene, {small}).cascades[1].grids[0].sampling, Sampling::Spline);
}

}  // namespace
}  // namespace pelagic
