// Caustics beside rays of the sun that know only Fresnel and Snell.
#include "plugin/render/floor_light.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include "core/evaluate/evaluate.h"
#include "core/lighting/lighting.h"
#include "core/plan/plan.h"
#include "core/scene/keys.h"
#include "core/waves/sea.h"
#include "plugin/light/light.h"
#include "plugin/render/render.h"

namespace pelagic {
namespace {

constexpr double kDegree = 0.017453292519943295;
constexpr int kSide = 256;

struct Lit {
    Floor floor;
    WaterBody water;
    Sky sky;
    std::shared_ptr<const Sea<float>> sea;
    std::shared_ptr<Frame<float>> frame;
    double texel_m = 0.0;
};

Scene lagoon(double depth_m, double wind_mps = 4.0) {
    Scene scene;
    scene.sea.wind_speed_mps = wind_mps;
    scene.sea.fetch_m = 2e3;
    scene.sea.depth_m = depth_m;
    scene.water.type = WaterType::JerlovIB;
    scene.waves.cascades = {{.size_m = 60.0, .resolution = 128}, {.size_m = 11.0, .resolution = 128}};
    return scene;
}

// Deep at first, and then not.
TEST(FloorLight, OfADepthThatChangesIsCountedWhereItShows) {
    const auto bytes = [](const Scene& scene) {
        return render_memory(scene, render_options(scene), std::array{1}, {}, 1).bytes();
    };
    const auto pattern = [&](Scene scene) {
        const std::size_t with = bytes(scene);
        scene.water.caustics = 0.0;
        return with - bytes(scene);
    };
    Scene scene = lagoon(300.0);
    scene.waves.second_order = 0.0;
    scene.camera.position_m = {0.0, 0.0, 50.0};
    EXPECT_EQ(pattern(scene), 0u);
    Scene shallow = scene;
    shallow.sea.depth_m = 5.0;
    ASSERT_FALSE(set_value(scene, key_of("sea.depth_m"), NumberKeys{{{1, 300.0}, {40, 40.0}, {80, 5.0}}}));
    EXPECT_GT(pattern(scene), 0u);
    EXPECT_EQ(pattern(scene), pattern(shallow));
}

View above(glm::dvec2 place, double height_m = 3.0) {
    View view;
    view.position_m = glm::dvec3(place, height_m);
    view.right = {1.0, 0.0, 0.0};
    view.up = {0.0, 1.0, 0.0};
    view.forward = {0.0, 0.0, -1.0};
    return view;
}

Lit lit(const Scene& scene, double elevation_deg, const View& view) {
    Lit made{
        .floor = Floor(scene.sea.depth_m), .water = make_water(scene), .sky = {}, .sea = {}, .frame = {}};
    made.sky.sun_direction = glm::vec3(glm::dvec3(std::cos(elevation_deg * kDegree) * std::cos(0.7),
                                                  std::cos(elevation_deg * kDegree) * std::sin(0.7),
                                                  std::sin(elevation_deg * kDegree)));
    made.sky.sun_angular_radius = 0.00465f;
    const auto prepared = prepare(scene);
    const double finest_m = 0.002;
    const Query query = view_query(
        *prepared, {.products = {}, .finest_cell_m = finest_m, .finest_pixel_m = finest_m, .points = 1000});
    made.sea = std::make_shared<const Sea<float>>(make_plan(prepared, {query}, {.double_precision = false}));
    made.frame = std::make_shared<Frame<float>>(made.sea);
    made.frame->set(3.0);
    light_floor(made.floor, *made.frame,
                {.view = view,
                 .water = made.water,
                 .sun_direction = made.sky.sun_direction,
                 .sun_angular_radius = made.sky.sun_angular_radius,
                 .finest_m = finest_m,
                 .side = kSide});
    if (made.floor.has_light()) made.texel_m = 1.0 / static_cast<double>(made.floor.seen_from({}).light.z);
    return made;
}

// The finer map's texel at a column and row.
float texel(const Floor& floor, int column, int row) {
    return floor.values()[static_cast<std::size_t>(row) * kSide + static_cast<std::size_t>(column)];
}

TEST(FloorLight, KeepsItsMeanAndGathersWhereWavesFocus) {
    for (const double elevation : {25.0, 60.0, 90.0})
        for (const double depth : {0.4, 2.5, 8.0}) {
            const Lit made = lit(lagoon(depth), elevation, above({10.0, -4.0}));
            ASSERT_TRUE(made.floor.has_light());
            for (int map = 0; map < 2; ++map) {
                double sum = 0.0, squares = 0.0;
                for (int i = 0; i < kSide * kSide; ++i) {
                    const auto value = static_cast<double>(
                        made.floor.values()[static_cast<std::size_t>(map * kSide * kSide + i)]);
                    ASSERT_TRUE(std::isfinite(value) && value >= 0.0);
                    sum += value;
                    squares += value * value;
                }
                const double mean = sum / (kSide * kSide);
                // A map of 2 depths has few of the longest waves.
                EXPECT_NEAR(mean, 1.0, map == 0 ? 0.1 : 0.015) << depth << ' ' << elevation << ' ' << map;
                if (map > 0) continue;
                EXPECT_GT(std::sqrt(squares / (kSide * kSide) - mean * mean), depth < 1.0 ? 0.05 : 0.15)
                    << depth << ' ' << elevation;
            }
        }
}

TEST(FloorLight, IsThatOfRaysThroughTheSurface) {
    Scene scene = lagoon(2.5);
    scene.waves.choppiness = 0.0;  // so that places at rest are as dense as rays
    const Lit made = lit(scene, 50.0, above({0.0, 0.0}));
    const glm::dvec3 to_sun(made.sky.sun_direction);
    // Twelve bins a side over the map's middle half.
    constexpr int kBins = 12, kTexels = kSide / 2 / kBins;
    const FloorSeen seen = made.floor.seen_from({});
    const glm::dvec2 corner = glm::dvec2(seen.light.x, seen.light.y) + 0.25 * kSide * made.texel_m;
    const double width_m = kBins * kTexels * made.texel_m;
    std::vector<double> bins(kBins * kBins);
    std::mt19937 random(5);
    std::uniform_real_distribution<float> uniform(-1.0f, 2.0f);
    std::normal_distribution<double> usual;
    constexpr std::size_t kRays = 3'200'000;
    std::vector<glm::vec2> rest(kRays);
    for (glm::vec2& place : rest)
        place = glm::vec2(corner) + static_cast<float>(width_m) * glm::vec2(uniform(random), uniform(random));
    std::vector<glm::vec3> position(kRays), normal(kRays), hidden(kRays);
    const std::vector<float> width(kRays, static_cast<float>(made.texel_m));
    Results<float> results;
    results.set(Product::Position, {position.data()});
    results.set(Product::Normal, {normal.data()});
    results.set(Product::SlopeVariance, {hidden.data()});
    evaluate(
        *made.frame, 0,
        Points<float>{
            .count = kRays, .rest_m = {rest.data()}, .cell_m = {width.data()}, .pixel_m = {width.data()}},
        results);
    double sum = 0.0;
    for (std::size_t i = 0; i < kRays; ++i) {
        // With slopes that the surface doesn't resolve, drawn by chance.
        const glm::dvec2 slope = -glm::dvec2(normal[i]) / static_cast<double>(normal[i].z) +
                                 glm::sqrt(glm::dvec2(hidden[i])) * glm::dvec2(usual(random), usual(random));
        const glm::dvec3 n = glm::normalize(glm::dvec3(-slope, 1.0)),
                         ray = glm::refract(-to_sun, n, 1.0 / 1.34);
        const double c = glm::dot(n, to_sun), t = -glm::dot(n, ray);
        const double s = (c - 1.34 * t) / (c + 1.34 * t), p = (t - 1.34 * c) / (t + 1.34 * c);
        const double light = c / n.z * (1.0 - 0.5 * (s * s + p * p));
        sum += light;
        const glm::dvec2 hit = glm::dvec2(position[i]) + glm::dvec2(ray) / -ray.z * (position[i].z + 2.5);
        const glm::ivec2 bin(glm::floor((hit - corner) / width_m * static_cast<double>(kBins)));
        if (bin.x >= 0 && bin.y >= 0 && bin.x < kBins && bin.y < kBins)
            bins[static_cast<std::size_t>(bin.y * kBins + bin.x)] += light;
    }
    double squares = 0.0, spread = 0.0;
    for (int y = 0; y < kBins; ++y)
        for (int x = 0; x < kBins; ++x) {
            double mean = 0.0;
            for (int v = 0; v < kTexels; ++v)
                for (int u = 0; u < kTexels; ++u)
                    mean += static_cast<double>(
                                texel(made.floor, kSide / 4 + x * kTexels + u, kSide / 4 + y * kTexels + v)) /
                            (kTexels * kTexels);
            const double rays = bins[static_cast<std::size_t>(y * kBins + x)] / sum * 9.0 * kBins * kBins;
            squares += (mean - rays) * (mean - rays);
            spread += (rays - 1.0) * (rays - 1.0);
        }
    // 0.043: rays' own sums err by 0.02, and hidden slopes spread light along the axes alone, as one width for the whole map.
    EXPECT_LT(std::sqrt(squares / (kBins * kBins)), 0.06);
    EXPECT_GT(std::sqrt(spread / (kBins * kBins)), 0.12);
}

TEST(FloorLight, IsTheSameWhereverTheCameraIsAndOnOneThread) {
    const Scene scene = lagoon(2.5);
    const Lit here = lit(scene, 50.0, above({0.0, 0.0})), there = lit(scene, 50.0, above({1.3, -0.8}));
    const FloorSeen a = here.floor.seen_from({}), b = there.floor.seen_from({});
    const glm::ivec2 moved(
        glm::round((glm::vec2(b.light) - glm::vec2(a.light)) / static_cast<float>(here.texel_m)));
    ASSERT_NE(moved, glm::ivec2(0));
    for (int y = 80; y < 160; y += 7)
        for (int x = 80; x < 160; x += 7) {
            const float other = texel(there.floor, x, y);
            // How much is hidden is asked at a few places of each map.
            EXPECT_NEAR(texel(here.floor, x + moved.x, y + moved.y), other, 0.01f + 0.01f * other)
                << x << ' ' << y;
        }
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    EXPECT_EQ(lit(scene, 50.0, above({0.0, 0.0})).floor.values(), here.floor.values());
}

// A frame is the same whichever others are planned with it, nearer ones too, and whichever was rendered before.
TEST(FloorLight, OfAFrameDependsOnNoOtherFrame) {
    Scene scene = lagoon(2.5);
    scene.camera.resolution = {64, 36};
    scene.quality.level = QualityLevel::Preview;
    scene.camera.keys = {{.frame = 1, .position_m = {0.0, 0.0, 12.0}, .look_at_m = {12.0, 0.0, 0.0}},
                         {.frame = 2, .position_m = {0.0, 0.0, 0.6}, .look_at_m = {3.0, 0.0, 0.0}}};
    const RenderOptions options = render_options(scene);
    const auto rendered = [&](std::vector<int> planned, std::vector<int> frames) {
        Renderer renderer(scene, options, make_sky(scene), planned);
        Picture picture;
        for (const int frame : frames) renderer.render(frame, picture);
        return picture;
    };
    const Picture alone = rendered({1}, {1}), together = rendered({1, 2}, {2, 1});
    ASSERT_EQ(alone.layers.size(), together.layers.size());
    for (std::size_t i = 0; i < alone.layers.size(); ++i)
        ASSERT_EQ(alone.layers[i].sea, together.layers[i].sea) << i;
}

TEST(FloorLight, IsEvenOnACalmDay) {
    const Lit made = lit(lagoon(2.5, 0.0), 40.0, above({0.0, 0.0}));
    for (int i = 0; i < kSide; ++i) EXPECT_NEAR(texel(made.floor, i, 200), 1.0f, 2e-3f);
}

TEST(FloorLight, IsNoneWhereNothingOfItShows) {
    EXPECT_FALSE(lit(lagoon(200.0), 50.0, above({0.0, 0.0})).floor.has_light());
    EXPECT_FALSE(
        lit(lagoon(std::numeric_limits<double>::infinity()), 50.0, above({0.0, 0.0})).floor.has_light());
    EXPECT_FALSE(lit(lagoon(2.5), -3.0, above({0.0, 0.0})).floor.has_light());
}

}  // namespace
}  // namespace pelagic
