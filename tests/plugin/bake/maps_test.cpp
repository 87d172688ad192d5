// Maps as they lie on disk, read by OpenEXR.

#include "plugin/bake/maps.h"

#include <ImfDoubleAttribute.h>
#include <ImfIntAttribute.h>
#include <ImfMultiPartInputFile.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/glm.hpp>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "core/base/constants.h"
#include "core/evaluate/evaluate.h"
#include "core/plan/random_tiling.h"
#include "core/scene/names.h"
#include "plugin/bake/bake.h"
#include "tests/plugin/bake/read_exr.h"

namespace {

using namespace pelagic;
namespace fs = std::filesystem;

class BakedMaps : public ::testing::Test {
  protected:
    void SetUp() override {
        scene_.shot.last_frame = 1;
        scene_.sea.wind_speed_mps = 12.0;
        scene_.waves.cascades = {{.size_m = 600.0, .resolution = 128}};
        scene_.waves.tiling = Tiling::Periodic;  // the patch is a period
        scene_.waves.second_order = 0.0;         // heights are those of the waves alone
        scene_.surface.size_m = 600.0;
        scene_.surface.resolution = 4;
        scene_.output.mesh = MeshFormat::None;
        scene_.output.map_resolution = 128;
        folder_ = fs::temp_directory_path() / ("pelagic-maps-" + std::to_string(getpid()));
        fs::remove_all(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }
    fs::path bake_map(MapKind kind, const char* file) {
        scene_.output.maps = {kind};
        bake(scene_, {.out = folder_, .frames = {}, .progress = {}, .cancel = nullptr});
        return folder_ / file;
    }

    Scene scene_;
    fs::path folder_;
};

TEST_F(BakedMaps, HeightsHaveTheVarianceOfTheirRealisation) {
    const auto heights =
        test::read_scanlines(bake_map(MapKind::Displacement, "maps/sea.displacement.0001.exr"), "B");
    double mean = 0.0, squares = 0.0;
    for (const float z : heights.values) mean += static_cast<double>(z);
    mean /= static_cast<double>(heights.values.size());
    for (const float z : heights.values)
        squares += (static_cast<double>(z) - mean) * (static_cast<double>(z) - mean);
    Frame<float> frame(std::make_shared<const Sea<float>>(plan_bake(scene_)));
    frame.set(0.0);
    const double expected = frame.realisation(0).m0;
    // Parseval; single-precision transforms leave about 1e-6.
    EXPECT_NEAR(squares / static_cast<double>(heights.values.size()) / expected, 1.0, 1e-5);
}

TEST_F(BakedMaps, LieAsAMapWithNorthOnTop) {
    // The texel in column i, j rows from the bottom, is the sea at (−L/2 + i L/N, −L/2 + j L/N), asked for
    // directly.
    const fs::path file = bake_map(MapKind::Displacement, "maps/sea.displacement.0001.exr");
    Frame<float> frame(std::make_shared<const Sea<float>>(plan_bake(scene_)));
    frame.set(0.0);
    const int i = 17, j = 101;
    const double spacing_m = 600.0 / 128.0;
    const glm::vec2 rest(-300.0 + i * spacing_m, -300.0 + j * spacing_m);
    glm::vec3 displacement(0.0f);
    Results<float> results;
    results.set(Product::Displacement, {&displacement});
    evaluate(frame, 0, Points<float>{.count = 1, .rest_m = {&rest}}, results);
    for (int c = 0; c < 3; ++c)
        EXPECT_EQ(test::read_scanlines(file, std::string(1, "RGB"[c])).at(i, j), displacement[c])
            << "channel " << c;
}

TEST_F(BakedMaps, WhitecapLevelsComeFromMoments) {
    const fs::path file = bake_map(MapKind::Whitecaps, "maps/sea.whitecaps.0001.exr");
    const auto mean = test::read_level(file, "jacobianMean", 0),
               variance = test::read_level(file, "jacobianVariance", 0);
    const auto coarse_mean = test::read_level(file, "jacobianMean", 1),
               coarse_variance = test::read_level(file, "jacobianVariance", 1);
    const auto coarse_coverage = test::read_level(file, "R", 1);
    ASSERT_EQ(coarse_mean.n, 64);
    // A periodic map: the tent round column 2i has ¼, ½, ¼.
    const auto tent = [&](int x, int y, auto&& value) {
        double sum = 0.0;
        for (int dy = -1; dy <= 1; ++dy)
            for (int dx = -1; dx <= 1; ++dx)
                sum += (dx ? 0.25 : 0.5) * (dy ? 0.25 : 0.5) *
                       value((2 * x + dx + 128) % 128, (2 * y + dy + 128) % 128);
        return sum;
    };
    for (const auto& [x, y] : {std::pair{0, 0}, {5, 40}, {63, 63}}) {
        const double m = tent(x, y, [&](int i, int j) { return static_cast<double>(mean.at(i, j)); });
        const double m2 = tent(x, y, [&](int i, int j) {
            return static_cast<double>(variance.at(i, j)) +
                   static_cast<double>(mean.at(i, j)) * static_cast<double>(mean.at(i, j));
        });
        EXPECT_NEAR(coarse_mean.at(x, y), m, 1e-6);
        EXPECT_NEAR(coarse_variance.at(x, y), m2 - m * m, 1e-6);  // single precision of values near 1
        EXPECT_GE(coarse_coverage.at(x, y), 0.0f);
    }
    // The last level is the whole patch: its coverage is that of the sea, not 0 or 1, and near the mean of
    // level 0.
    double fine_coverage = 0.0;
    const auto coverage = test::read_level(file, "R", 0);
    for (const float w : coverage.values)
        fine_coverage += static_cast<double>(w) / static_cast<double>(coverage.values.size());
    const double whole = static_cast<double>(test::read_level(file, "R", 7).at(0, 0));
    // One Pearson curve for the whole against one per texel: they agree to some ten percent of a coverage of
    // 2 %.
    EXPECT_NEAR(whole / fine_coverage, 1.0, 0.25);
    // And it is not the average of level 0, which a filter of thresholded coverage would give.
    EXPECT_GT(std::abs(whole / fine_coverage - 1.0), 1e-4);
}

// What breaks has its gain in coarser levels as well, and a sea with places repeats nowhere.
TEST_F(BakedMaps, WhitecapLevelsHaveTheGainsOfPlaces) {
    scene_.effects.foam_decay_s = 0.0;
    const auto level_of = [&](int level) {
        const fs::path file = bake_map(MapKind::Whitecaps, "maps/sea.whitecaps.0001.exr");
        return test::read_level(file, "R", level);
    };
    const auto plain = level_of(0);
    scene_.waves.masks = {
        {.east_m = -150.0, .length_m = 240.0, .width_m = 1200.0, .edge_m = 30.0, .foam = 0.0}};
    for (const int l : {0, 2}) {
        const auto foam = level_of(l);
        double within = 0.0, beyond = 0.0;
        for (int y = foam.n / 4; y < 3 * foam.n / 4; ++y)
            for (int x = 0; x < foam.n; ++x) {
                const double east_m = -300.0 + 600.0 * x / foam.n, of = static_cast<double>(foam.at(x, y));
                if (l == 0 && east_m > 10.0) {
                    EXPECT_EQ(foam.at(x, y), plain.at(x, y));
                }
                if (std::abs(east_m + 150.0) < 100.0) within += of;
                if (east_m > 10.0) beyond += of;
            }
        EXPECT_EQ(within, 0.0) << l;
        EXPECT_GT(beyond, 0.01) << l;
    }
}

// Beside rays of the sun that know only Fresnel and Snell, and meet the slopes that the map doesn't resolve by chance.
TEST_F(BakedMaps, FloorsHaveTheLightOfRaysThroughTheSea) {
    constexpr int kSide = 128, kTexels = 4, kBins = kSide / kTexels;
    constexpr double kSize_m = 20.0, kDepth_m = 2.5, kTexel_m = kSize_m / kSide;
    scene_.sea.wind_speed_mps = 4.0;
    scene_.sea.fetch_m = 2e3;
    scene_.sea.depth_m = kDepth_m;
    scene_.waves.choppiness = 0.0;  // so that places at rest are as dense as rays
    scene_.waves.cascades = {{.size_m = kSize_m, .resolution = 256}};
    scene_.surface.size_m = kSize_m;
    scene_.light.sun_elevation_deg = 50.0;
    scene_.light.sun_azimuth_deg = 20.0;
    const auto light = test::read_level(bake_map(MapKind::Floor, "maps/sea.floor.0001.exr"), "R", 0);
    ASSERT_EQ(light.n, kSide);
    Frame<float> frame(std::make_shared<const Sea<float>>(plan_bake(scene_)));
    frame.set(scene_.shot.time_s(1));
    constexpr std::size_t kRays = 2'000'000;
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(-kSize_m, kSize_m);
    std::normal_distribution<double> usual;
    std::vector<glm::vec2> rest(kRays);
    for (glm::vec2& place : rest) place = glm::vec2(uniform(random), uniform(random));
    std::vector<glm::vec3> position(kRays), normal(kRays), hidden(kRays);
    Results<float> results;
    results.set(Product::Position, {position.data()});
    results.set(Product::Normal, {normal.data()});
    results.set(Product::SlopeVariance, {hidden.data()});
    const float width = static_cast<float>(kTexel_m);
    Points<float> points{.count = kRays, .rest_m = {rest.data()}};
    points.pixel_m = points.cell_m = {&width, 0};
    evaluate(frame, 0, points, results);
    const double elevation = glm::radians(50.0), azimuth = glm::radians(20.0);
    const glm::dvec3 to_sun(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                            std::sin(elevation));
    std::vector<double> bins(kBins * kBins);
    double sum = 0.0;
    for (std::size_t i = 0; i < kRays; ++i) {
        const glm::dvec2 slope = -glm::dvec2(normal[i]) / static_cast<double>(normal[i].z) +
                                 glm::sqrt(glm::dvec2(hidden[i])) * glm::dvec2(usual(random), usual(random));
        const glm::dvec3 n = glm::normalize(glm::dvec3(-slope, 1.0)),
                         ray = glm::refract(-to_sun, n, 1.0 / 1.34);
        const double c = glm::dot(n, to_sun), t = -glm::dot(n, ray);
        const double across = (c - 1.34 * t) / (c + 1.34 * t), along = (t - 1.34 * c) / (t + 1.34 * c);
        const double power = c / n.z * (1.0 - 0.5 * (across * across + along * along));
        sum += power;
        const glm::dvec2 hit = glm::dvec2(position[i]) +
                               glm::dvec2(ray) / -ray.z * (static_cast<double>(position[i].z) + kDepth_m);
        const glm::ivec2 bin(glm::floor((hit + 0.5 * kSize_m + 0.5 * kTexel_m) / (kTexels * kTexel_m)));
        if (bin.x >= 0 && bin.y >= 0 && bin.x < kBins && bin.y < kBins)
            bins[static_cast<std::size_t>(bin.y * kBins + bin.x)] += power;
    }
    double mean = 0.0, squares = 0.0, spread = 0.0;
    for (const float value : light.values) mean += static_cast<double>(value) / (kSide * kSide);
    for (int y = 0; y < kBins; ++y)
        for (int x = 0; x < kBins; ++x) {
            double here = 0.0;
            for (int v = 0; v < kTexels; ++v)
                for (int u = 0; u < kTexels; ++u)
                    here +=
                        static_cast<double>(light.at(x * kTexels + u, y * kTexels + v)) / (kTexels * kTexels);
            // Rays are sown over twice the patch's side.
            const double rays = bins[static_cast<std::size_t>(y * kBins + x)] / sum * 4.0 * kBins * kBins;
            squares += (here - rays) * (here - rays) / (kBins * kBins);
            spread += (rays - 1.0) * (rays - 1.0) / (kBins * kBins);
        }
    EXPECT_NEAR(mean, 1.0, 2e-3);
    // 0.065: the rays' own sums err by 0.045.
    EXPECT_LT(std::sqrt(squares), 0.08);
    EXPECT_GT(std::sqrt(spread), 0.2);
}

// Where the floor is uneven, has a shore, and goes to no floor at all, all light still arrives somewhere, in a net where the sun is high. A sun that
// is down has no pattern, and neither has a floor so deep that its light comes from all over the sea.
TEST_F(BakedMaps, FloorsOfAnyDepthAndSunAreLit) {
    scene_.sea.wind_speed_mps = 5.0;
    scene_.sea.depth_file = fs::path(PELAGIC_SOURCE_DIR) / "examples" / "data" / "atoll.exr";
    scene_.sea.depth_size_m = 400.0;
    scene_.sea.depth_north_m = -60.0;
    scene_.surface.size_m = 60.0;
    scene_.waves.cascades = {{.size_m = 60.0, .resolution = 128}};
    for (const double elevation_deg : {90.0, 30.0, 4.0, 0.0, -10.0}) {
        SCOPED_TRACE(elevation_deg);
        scene_.light.sun_elevation_deg = elevation_deg;
        const auto light = test::read_level(bake_map(MapKind::Floor, "maps/sea.floor.0001.exr"), "R", 0);
        double mean = 0.0, squares = 0.0;
        for (const float value : light.values) {
            ASSERT_TRUE(std::isfinite(value) && value >= 0.0f);
            mean += static_cast<double>(value) / (128.0 * 128.0);
            squares += static_cast<double>(value * value) / (128.0 * 128.0);
        }
        EXPECT_NEAR(mean, 1.0, 0.05);
        if (elevation_deg > 20.0) {
            EXPECT_GT(squares - mean * mean, 0.01);
        }
        EXPECT_EQ(squares > mean * mean, elevation_deg > 2.0);
    }
    scene_.sea.depth_file = SeaState{}.depth_file;
    scene_.sea.depth_size_m = SeaState{}.depth_size_m;
    scene_.sea.depth_north_m = 0.0;
    scene_.light.sun_elevation_deg = 50.0;
    for (const double depth_m : {4e3, 1e6}) {
        SCOPED_TRACE(depth_m);
        scene_.sea.depth_m = depth_m;
        for (const float value :
             test::read_level(bake_map(MapKind::Floor, "maps/sea.floor.0001.exr"), "R", 0).values)
            ASSERT_NEAR(value, 1.0f, 0.05f);
    }
}

// What Blender, Cycles and OpenImageIO show of a file, found in the real ones by tests/addon/maps.py: red, green and
// blue, if no channel is in a layer, and the fourth channel as alpha.
TEST_F(BakedMaps, AreAPictureToEveryProgram) {
    scene_.sea.depth_m = 30.0;
    for (const Word<MapKind>& kind : words_of(MapKind{})) {
        SCOPED_TRACE(kind.word);
        const fs::path path =
            bake_map(kind.value, ("maps/sea." + std::string(kind.word) + ".0001.exr").c_str());
        Imf::MultiPartInputFile parts(path.c_str());
        EXPECT_EQ(parts.parts(), 1);
        const Imf::ChannelList& channels = parts.header(0).channels();
        std::set<std::string> layers;
        channels.layers(layers);
        EXPECT_TRUE(layers.empty());
        int count = 0;
        for (auto at = channels.begin(); at != channels.end(); ++at) ++count;
        for (const char* name : {"R", "G", "B"}) EXPECT_NE(channels.findChannel(name), nullptr) << name;
        if (count == 3) continue;
        ASSERT_NE(channels.findChannel("A"), nullptr);
        for (const float alpha : test::read_level(path, "A", 0).values) ASSERT_EQ(alpha, 1.0f);
    }
}

TEST_F(BakedMaps, SlopeVarianceOfACoarserLevelHidesMore) {
    const fs::path file = bake_map(MapKind::SlopeVariance, "maps/sea.slope-variance.0001.exr");
    const Plan plan = plan_bake(scene_);
    const Sea<float> sea(plan);
    double before = 0.0;
    for (int level = 0; level <= 7; ++level) {
        const auto texels = test::read_level(file, "R", level).values;
        double mean = 0.0;
        for (const float xx : texels) mean += static_cast<double>(xx) / static_cast<double>(texels.size());
        EXPECT_GE(mean, (1.0 - 1e-6) * before);  // but for the rounding of the sum
        before = mean;
        // Carried by the waves that the level's texels show.
        const auto [least, most] = std::minmax_element(texels.begin(), texels.end());
        if (level < 3) {
            EXPECT_GT(*most, 1.05f * *least) << level;
        }
    }
    // A texel of 600 m shows nothing: the whole spectrum's variance.
    EXPECT_NEAR(before / sea.total().xx, 1.0, 1e-5);
}

// A level's texels are the query's answers there, for texels of that size.
TEST_F(BakedMaps, SlopeVarianceOfALevelIsTheQuerys) {
    scene_.output.map_resolution = 100;  // halved and rounded down: 50, 25, 12, …
    const fs::path file = bake_map(MapKind::SlopeVariance, "maps/sea.slope-variance.0001.exr");
    Query query;
    query.name = "levels";
    query.products = products(Product::SlopeVariance);
    query.pixel_m = {6.0, 12.0, 24.0, 50.0};
    query.cell_m = {6.0};
    Frame<float> frame(std::make_shared<const Sea<float>>(make_plan(scene_, {query})));
    frame.set(scene_.shot.time_s(1));
    for (int level = 0; level < 4; ++level) {
        const test::Plane texels = test::read_level(file, "R", level);
        const int n = 100 >> level;
        for (const int i : {0, n / 3, n - 1}) {
            const auto at = [&](int t) {
                return -300.0f + 6.0f * std::round(static_cast<float>(t) * 100.0f / static_cast<float>(n));
            };
            const glm::vec2 rest(at(i), at(n / 2));
            const float footprint_m = static_cast<float>(query.pixel_m[static_cast<std::size_t>(level)]);
            glm::vec3 expected(0.0f);
            Results<float> results;
            results.set(Product::SlopeVariance, {&expected});
            Points<float> points{.count = 1, .rest_m = {&rest}};
            points.pixel_m = {&footprint_m};
            evaluate(frame, 0, points, results);
            EXPECT_NEAR(texels.at(i, n / 2), expected.x, 1e-3f * expected.x) << level << ' ' << i;
        }
    }
}

// A tile's are at rest, the same everywhere: what carries them is the whole sea.
TEST_F(BakedMaps, SlopeVarianceOfATileIsAtRest) {
    scene_.output.cascade_tiles = true;
    const fs::path file = bake_map(MapKind::SlopeVariance, "tiles/sea.slope-variance.0.0001.exr");
    for (const int level : {0, 2}) {
        const auto texels = test::read_level(file, "R", level).values;
        EXPECT_EQ(std::vector<float>(texels.size(), texels.front()),
                  std::vector<float>(texels.begin(), texels.end()));
    }
}

// The value of a band-limited periodic tile [n × n texels over L] at x, y in texels: exact.
double between_texels(const test::Plane& tile, double x, double y) {
    const auto weights = [&](double at) {
        std::vector<double> w;
        for (int i = 0; i < tile.n; ++i) {
            const double u = kPi * (at - i), tangent = std::tan(u / tile.n);
            w.push_back(std::abs(tangent) < 1e-12 ? std::cos(u) : std::sin(u) / tangent / tile.n);
        }
        return w;
    };
    const std::vector<double> along_x = weights(x), along_y = weights(y);
    double sum = 0.0;
    for (int j = 0; j < tile.n; ++j)
        for (int i = 0; i < tile.n; ++i) sum += along_x[i] * along_y[j] * static_cast<double>(tile.at(i, j));
    return sum;
}

// What a file says of itself is enough to lay its copies: by the rule of core/plan/random_tiling.h the tiles add up to the sea.
TEST_F(BakedMaps, TilesOfRandomCopiesAddUpToTheSeaByTheirHeaders) {
    scene_.waves.cascades = {{.size_m = 64.0, .resolution = 64}};
    scene_.waves.tiling = Tiling::Random;
    scene_.surface.size_m = 128.0;
    scene_.output.map_resolution = 512;  // fine enough to filter nothing
    scene_.output.cascade_tiles = true;
    const fs::path file = bake_map(MapKind::Displacement, "tiles/sea.displacement.0.0001.exr");
    const auto tile = test::read_scanlines(file, "B");
    const auto sea = test::read_scanlines(folder_ / "maps/sea.displacement.0001.exr", "B");
    const Imf::InputFile input(file.c_str());
    const double size_m = input.header().typedAttribute<Imf::DoubleAttribute>("size").value();
    const double ramp = input.header().typedAttribute<Imf::DoubleAttribute>("copiesRamp").value();
    const auto key = static_cast<uint>(input.header().typedAttribute<Imf::IntAttribute>("copiesKey").value());
    ASSERT_EQ(ramp, kBlendRamp);
    for (const int row : {7, 128, 250, 383, 386})
        for (const int column : {3, 120, 131, 256, 380, 389}) {
            const glm::dvec2 at(-64.0 + 0.25 * column, -64.0 + 0.25 * row);
            double sum = 0.0;
            for (int j = -1; j <= 1; ++j)
                for (int i = -1; i <= 1; ++i) {
                    const auto weight = [&](double distance) {
                        return distance <= 0.5 ? blend_weights(distance).own
                                               : blend_weights(std::max(1.0 - distance, 0.0)).next;
                    };
                    const double share =
                        weight(std::abs(at.x / size_m - i)) * weight(std::abs(at.y / size_m - j));
                    if (share == 0.0) continue;
                    const auto offset = tile_offset<double>(key, static_cast<uint>(i), static_cast<uint>(j));
                    const glm::dvec2 texel =
                        ((at / size_m) + glm::dvec2(offset.x, offset.y) + 0.5) * double(tile.n);
                    sum += share * between_texels(tile, texel.x, texel.y);
                }
            EXPECT_NEAR(sum, static_cast<double>(sea.at(column, row)), 2e-5) << column << ", " << row;
        }
}

TEST(TentWeights, SumToOneAndKeepCornersOnCorners) {
    for (const auto& [fine, coarse] : {std::pair{8, 4}, {5, 2}, {3, 1}, {2, 1}})
        for (const bool periodic : {false, true}) {
            const TentWeights weights = tent_weights(fine, coarse, periodic);
            for (int i = 0; i < coarse; ++i) {
                double sum = 0.0, heaviest = 0.0;
                int at = -1;
                for (const auto& tap : weights.taps[i]) {
                    sum += tap.weight;
                    if (tap.weight > heaviest) heaviest = tap.weight, at = tap.texel;
                }
                EXPECT_NEAR(sum, 1.0, 1e-12);
                EXPECT_NEAR(at, i * static_cast<double>(fine) / coarse, 0.5);
            }
        }
}

TEST(NormalMips, StayUnitAndFinite) {
    std::vector<glm::vec3> full;
    for (int i = 0; i < 16; ++i) full.push_back(i % 2 ? glm::vec3(1, 0, 0) : glm::vec3(-1, 0, 0));  // cancel
    const auto levels = normal_mips({.n = 4, .texels = full, .periodic = true});
    ASSERT_EQ(levels.size(), 2u);
    for (const auto& level : levels)
        for (const glm::vec3& n : level.texels) EXPECT_NEAR(glm::dot(n, n), 1.0f, 1e-5f);
}

}  // namespace
