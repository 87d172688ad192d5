// Spray in pictures: against small steps through the sea itself, and what it must not change.
#include "core/scene/editions.h"
#include "plugin/light/light.h"
#include "plugin/render/picture_files.h"
#include "plugin/render/render.h"
#include "plugin/render/seen_drops.h"
#include "plugin/render/spray_map.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <numeric>
#include <vector>

#include "tests/plugin/render/exact_spray.h"
#include "tests/plugin/render/uniform_sky.h"

namespace pelagic {
namespace {

// A spray_storm, from among its crests.
Scene spray_storm(double gain) {
    Scene scene = scene_of_edition(1);
    scene.sea.wind_speed_mps = 22.0;
    scene.waves.cascades = {{1200.0, 256}, {180.0, 128}, {31.0, 128}};
    scene.quality.level = QualityLevel::Draft;
    scene.effects.spray = gain > 0.0;
    scene.effects.spray_gain = gain;
    scene.camera.resolution = {96, 54};
    scene.camera.position_m = {0.0, -60.0, 12.0};
    scene.camera.look_at_m = {0.0, 0.0, 8.0};
    return scene;
}

RenderOptions spray_options(const Scene& scene) {
    RenderOptions options = render_options(scene);
    options.samples = 1;
    return options;
}

Picture spray_picture(const Scene& scene, const RenderOptions& options, const Sky& sky = uniform_sky()) {
    Picture picture;
    Renderer(scene, options, sky, std::array{1}).render(1, picture);
    return picture;
}
Picture spray_picture(const Scene& scene) {
    return spray_picture(scene, spray_options(scene));
}

bool same_spray_bits(const Picture& a, const Picture& b) {
    return a.sea == b.sea && a.alpha == b.alpha && a.layers.size() == b.layers.size() &&
           std::memcmp(a.layers.data(), b.layers.data(), a.layers.size() * sizeof(SeaRadiance)) == 0;
}

double radiance_at(const Picture& picture, std::size_t i) {
    return static_cast<double>(radiance_of(picture.layers[i]).y);
}

Scene storm_of_drops(double gain) {
    Scene scene = spray_storm(gain);
    scene.effects.whitecap_law = WhitecapLaw::Callaghan2008;
    scene.effects.spray_law = SpraySource::Andreas1998;
    scene.effects.spray_drops = true;
    return scene;
}

bool is_finite(const Picture& picture) {
    return std::all_of(picture.layers.begin(), picture.layers.end(), [](const SeaRadiance& layers) {
        const glm::vec3 seen = radiance_of(layers);
        return std::isfinite(seen.x) && std::isfinite(seen.y) && std::isfinite(seen.z);
    });
}

// A parcel far away is spread over the pixels round it.
TEST(SprayDropsSeen, ADiscHidesAsMuchAsItsSection) {
    for (const double radius_px : {1.5, 2.3, 12.0})
        for (const double beside : {0.0, 0.31, 0.5}) {
            const SeenDrop drop{.at_px = {20.0 + beside, 20.0 - 0.7 * beside},
                                .radius_px = radius_px,
                                .section_px2 = 1e-4,
                                .distance_m = 10.0f,
                                .depth_m = 0.1f};
            double sum = 0.0;
            for (int y = 0; y < 40; ++y)
                for (int x = 0; x < 40; ++x)
                    sum += static_cast<double>(drop.hides({x + 0.5, y + 0.5}, 1e30f));
            EXPECT_NEAR(sum / 1e-4, 1.0, radius_px < 2.0 ? 0.06 : 0.02) << radius_px << " " << beside;
            EXPECT_EQ(drop.hides(drop.at_px, 9.0f), 0.0f) << "behind the sea";
            const SeenDrop dense{.section_px2 = 1e9, .distance_m = 1.0f, .depth_m = 1.0f};
            EXPECT_EQ(dense.hides({0.0, 0.0}, 9.0f), 1.0f);
        }
}

// Those of a moment ago are where they fly, straight on.
TEST(SprayDropsSeen, FlyOnFromWhereTheyWere) {
    const View view = view_at(storm_of_drops(1.0).camera, 1);
    SprayDrop drop{.position_m = view.position_m + 20.0 * view.forward,
                   .velocity_mps = {3.0, 1.0, -2.0},
                   .width_m = 1.0,
                   .section_m2 = 1.0};
    const Spray unlit;
    const auto seen = [&](double late_s) {
        return seen_drops({&drop, 1}, {.view = view, .spray = unlit, .late_s = late_s}).at(0);
    };
    const SeenDrop late = seen(0.25);
    EXPECT_NE(late.at_px, seen(0.0).at_px);
    drop.position_m += 0.25 * drop.velocity_mps;
    EXPECT_EQ(late.at_px, seen(0.0).at_px);
    EXPECT_EQ(late.distance_m, seen(0.0).distance_m);
}

// A place that drops have the more, the map has the less: their sum is the whole veil's.
TEST(SprayDropsSeen, TheVeilHasWhatTheyLack) {
    const Scene scene = storm_of_drops(1.0);
    const View view = view_at(scene.camera, 1);
    Scene veil = scene;
    veil.effects.spray_drops = false;
    const auto map_of = [&](const Scene& of, bool drops) {
        Frame<float> frame(
            std::make_shared<const Sea<float>>(picture_plan(of, std::array{1}, spray_options(of))));
        frame.set(of.shot.time_s(1));
        return make_spray_map(frame, view, projected_grid_options(*frame.sea().plan().from), {64, 64}, drops);
    };
    const Spray whole = map_of(veil, false), rest = map_of(scene, true), unseen = map_of(scene, false);
    const auto prepared = prepare(scene);
    const SprayLaw law = spray_law(prepared->scene, prepared->extent.significant_height_m);
    ASSERT_EQ(whole.texels.size(), rest.texels.size());
    for (int row = 0; row < whole.rows; ++row) {
        const double away_m = std::hypot(
            static_cast<double>(whole.first_m) * std::exp(static_cast<double>(whole.row_step) * row),
            view.position_m.z);
        const double left = std::lerp(1.0, 1.0 / law.with_drops(), drops_share(away_m));
        for (int column = 0; column < whole.columns; column += 7) {
            const auto i = static_cast<std::size_t>(row * whole.columns + column);
            const auto at = static_cast<double>(whole.texels[i].y);
            EXPECT_NEAR(static_cast<double>(rest.texels[i].y), left * at, 1e-5 * at + 1e-12) << away_m;
            EXPECT_NEAR(static_cast<double>(unseen.texels[i].y), at, 1e-5 * at + 1e-12);
        }
    }
}

TEST(SprayDropsSeen, AreFiniteInPicturesAndTheSameAloneAndInARun) {
    Scene scene = storm_of_drops(20.0);
    scene.waves.cascades = {{180.0, 128}, {31.0, 64}};
    scene.camera.resolution = {48, 27};
    Scene veil = scene;
    veil.effects.spray_drops = false;
    RenderOptions options = spray_options(scene);
    options.alpha = true;
    const Picture with = spray_picture(scene, options), without = spray_picture(veil, options);
    EXPECT_TRUE(is_finite(with));
    EXPECT_EQ(with.sea, without.sea);
    EXPECT_FALSE(same_spray_bits(with, without));
    for (const float alpha : with.alpha) EXPECT_TRUE(alpha >= 0.0f && alpha <= 1.001f);
    Renderer renderer(scene, options, uniform_sky(), std::array{1, 2});
    Picture run;
    for (const int frame : {2, 1}) renderer.render(frame, run);
    EXPECT_TRUE(same_spray_bits(with, run));
}

TEST(RenderedSpray, DimsAsMuchAsTheSeaItselfSays) {
    const double gain = 10.0;
    // From higher up the map's cells tell fewer of the patches apart that break. Each of those is so dense that spray spread evenly over
    // a cell takes more light than they do.
    // Torn spray is spread wider, and most of its thickness lies everywhere: +2 % from 12 m, +4 % from 40 m, −3 % from 400 m.
    struct Case {
        double height_m, most_error, most_rms;
        int edition = 1;
    };
    for (const auto [height_m, most_error, most_rms, edition] :
         {Case{12.0, 0.06, 0.06}, Case{40.0, 0.2, 0.12}, Case{400.0, 0.4, 0.25}, Case{40.0, 0.1, 0.08, 2}}) {
        Scene scene = spray_storm(edition == 1 ? gain : 1.0);
        if (edition == 2) {
            scene.effects.whitecap_law = WhitecapLaw::Callaghan2008;
            scene.effects.spray_law = SpraySource::Andreas1998;
        }
        scene.camera.position_m.z = height_m;
        scene.camera.look_at_m = {0.0, 10.0 * height_m, 0.0};
        RenderOptions options = spray_options(scene);
        options.layers = light_layers();
        options.layers.set(index(PictureLayer::Position));
        const Picture picture = spray_picture(scene, options);
        const View view = view_at(scene.camera, 1);
        Frame<float> frame(std::make_shared<const Sea<float>>(picture_plan(scene, std::array{1}, options)));
        frame.set(scene.shot.time_s(1));
        const ProjectedGridOptions grid = projected_grid_options(*frame.sea().plan().from);
        const Spray spray = make_spray_map(frame, view, grid, spray_map_size(640));
        std::vector<test::SprayRay> rays;
        for (std::size_t i = 0; i < picture.sea.size(); i += 13) {
            if (!picture.sea[i]) continue;
            const float* at = &picture.data[index(PictureLayer::Position)][3 * i];
            const glm::dvec3 way = glm::dvec3(at[0], at[1], at[2]) - view.position_m;
            const double length_m = glm::length(way);
            if (length_m < 8e3) rays.push_back({way / length_m, length_m});
        }
        rays = test::exact_rays(frame, view.position_m, grid.curvature_per_m, 0.5, rays, spray);
        ASSERT_GT(rays.size(), 100u);
        double mean = 0.0, exact_mean = 0.0, square = 0.0;
        for (const test::SprayRay& ray : rays) {
            const double left = std::exp(-ray.thickness);
            const auto seen = static_cast<double>(
                spray_before(spray, glm::vec3(ray.direction), static_cast<float>(ray.length_m), true)
                    .transmittance);
            mean += (1.0 - seen) / static_cast<double>(rays.size());
            exact_mean += (1.0 - left) / static_cast<double>(rays.size());
            square += (seen - left) * (seen - left) / static_cast<double>(rays.size());
        }
        std::printf("    from %.0f m: %.4f of the light is dimmed, exactly %.4f; rms of a ray %.4f\n",
                    height_m, mean, exact_mean, std::sqrt(square));
        EXPECT_GT(exact_mean, 0.002);
        EXPECT_NEAR(mean / exact_mean, 1.0, most_error);
        EXPECT_LE(std::sqrt(square), most_rms);
    }
}

// Rays take what lies between the map's places as linear. What lies aslant and is finer than rows are apart would be a row of puffs, one
// at each row that it crosses. So each place near the camera is nearly the mean of those before and behind it, and of those beside it.
TEST(RenderedSpray, RibbonsAreNoPuffsInRowsOfTheMap) {
    Scene scene = spray_storm(1.0);
    scene.sea.wind_speed_mps = 24.0;
    scene.effects.whitecap_law = WhitecapLaw::Callaghan2008;
    scene.effects.spray_law = SpraySource::Andreas1998;
    const View view = view_at(scene.camera, 1);
    Frame<float> frame(
        std::make_shared<const Sea<float>>(picture_plan(scene, std::array{1}, spray_options(scene))));
    const ProjectedGridOptions grid = projected_grid_options(*frame.sea().plan().from);
    for (const int width : {160, 240}) {
        double square = 0.0, by_rows = 0.0, by_columns = 0.0;
        for (const double time_s : {0.0, 7.0, 20.0}) {
            frame.set(time_s);
            const Spray spray = make_spray_map(frame, view, grid, spray_map_size(width));
            const auto at = [&](int column, int row) {
                return static_cast<double>(
                    spray.texels[static_cast<std::size_t>(row * spray.columns + column)].y);
            };
            for (int row = 1; row + 1 < spray.rows; ++row) {
                const double away_m =
                    static_cast<double>(spray.first_m) * std::exp(static_cast<double>(spray.row_step) * row);
                if (away_m < 10.0 || away_m > 200.0) continue;
                for (int column = 1; column + 1 < spray.columns; ++column) {
                    const auto off = [&](int columns, int rows) {
                        const double mean =
                            0.5 * (at(column - columns, row - rows) + at(column + columns, row + rows));
                        return (at(column, row) - mean) * (at(column, row) - mean);
                    };
                    square += at(column, row) * at(column, row);
                    by_rows += off(0, 1);
                    by_columns += off(1, 0);
                }
            }
        }
        ASSERT_GT(square, 0.0);
        std::printf("    map of a picture %d wide: off the mean of the next rows by %.3f, columns %.3f\n",
                    width, std::sqrt(by_rows / square), std::sqrt(by_columns / square));
        EXPECT_LT(by_rows, 0.3 * 0.3 * square);
        EXPECT_LT(by_columns, 0.3 * 0.3 * square);
    }
}

TEST(RenderedSpray, IsNoneWithoutTheKeyAndWithoutWind) {
    const Scene without = spray_storm(0.0);
    const Picture expected = spray_picture(without);
    EXPECT_FALSE(spray_options(without).lighting.spray);
    // A scene without spray has none, whatever the options say; and none of its light.
    RenderOptions options = spray_options(without);
    options.lighting.spray = true;
    EXPECT_TRUE(same_spray_bits(spray_picture(without, options), expected));
    Scene with = spray_storm(10.0);
    options = spray_options(with);
    EXPECT_TRUE(options.lighting.spray);
    options.lighting.spray = false;
    EXPECT_TRUE(same_spray_bits(spray_picture(with, options), expected));
    EXPECT_FALSE(same_spray_bits(spray_picture(with), expected));
    with.sea.wind_speed_mps = 0.0;
    EXPECT_FALSE(spray_options(with).lighting.spray);
    with = spray_storm(10.0);
    with.effects.whitecaps = false;
    EXPECT_FALSE(spray_options(with).lighting.spray);
}

// The plan, and so the transforms and bytes of a picture without spray, know nothing of it.
TEST(RenderedSpray, CostsNoTransform) {
    const Scene with = spray_storm(10.0), without = spray_storm(0.0);
    const Plan more = picture_plan(with, std::array{1}, spray_options(with)),
               less = picture_plan(without, std::array{1}, spray_options(without));
    EXPECT_EQ(more.transforms_per_frame(), less.transforms_per_frame());
    EXPECT_EQ(more.frame_bytes(), less.frame_bytes());
    EXPECT_EQ(less.queries[0].query.products, picture_plan(without, std::array{1}).queries[0].query.products);
    // The map is as fine whatever the number of samples.
    for (const int samples : {1, 3}) {
        const auto bytes = [samples](const Scene& scene) {
            RenderOptions options = spray_options(scene);
            options.samples = samples;
            return render_memory(scene, options, std::array{1}, {}, 2).bytes();
        };
        EXPECT_EQ(bytes(with),
                  bytes(without) + spray_map_bytes(spray_map_size(spray_storm(1.0).camera.resolution.x)));
    }
}

// Under one radiance everywhere nothing gets brighter than that: the furnace, with a sea that reflects less.
TEST(RenderedSpray, AddsNoMoreThanItTakes) {
    for (const double gain : {1.0, 30.0, 1e4}) {
        const Picture picture = spray_picture(spray_storm(gain));
        for (std::size_t i = 0; i < picture.layers.size(); ++i)
            ASSERT_LE(radiance_at(picture, i), static_cast<double>(kSkyRadiance) * (1.0 + 2e-5)) << gain;
    }
    // Nature's own is far too thin to be seen.
    const Picture natural = spray_picture(spray_storm(1.0)), none = spray_picture(spray_storm(0.0));
    double least = 0.0, sum = 0.0;
    for (std::size_t i = 0; i < none.layers.size(); ++i) {
        least += std::abs(radiance_at(natural, i) - radiance_at(none, i));
        sum += radiance_at(none, i);
    }
    EXPECT_GT(least, 0.0);
    EXPECT_LT(least, 0.02 * sum);
}

TEST(RenderedSpray, HasTheSameBitsOnAnyNumberOfThreadsAndInAnyRun) {
    const Scene scene = spray_storm(20.0);
    const Picture expected = spray_picture(scene);
    oneapi::tbb::task_arena alone(1);
    EXPECT_TRUE(same_spray_bits(alone.execute([&] { return spray_picture(scene); }), expected));
    // The last of many frames, whose camera comes nearer.
    Scene moves = scene;
    moves.shot.last_frame = 3;
    moves.camera.keys = {
        {.frame = 1, .position_m = scene.camera.position_m, .look_at_m = scene.camera.look_at_m},
        {.frame = 3, .position_m = {0.0, 0.0, 9.0}, .look_at_m = {0.0, 60.0, 5.0}}};
    Picture first, alone_first;
    Renderer run(moves, spray_options(moves), uniform_sky(), std::array{1, 2, 3});
    run.render(3, first);
    run.render(1, first);
    Renderer(moves, spray_options(moves), uniform_sky(), std::array{1}).render(1, alone_first);
    EXPECT_TRUE(same_spray_bits(first, alone_first));
}

TEST(RenderedSpray, HidesWhatATransparentSkyWouldShow) {
    const Scene scene = spray_storm(30.0);
    RenderOptions options = spray_options(scene);
    const Picture opaque = spray_picture(scene, options);
    options.alpha = true;
    const Picture picture = spray_picture(scene, options);
    double most = 0.0;
    for (std::size_t i = 0; i < picture.sea.size(); ++i) {
        const double alpha = static_cast<double>(picture.alpha[i]);
        if (picture.sea[i]) {
            EXPECT_EQ(alpha, 1.0);
        } else {
            // Over the sky it is the picture that has the sky.
            EXPECT_NEAR(radiance_at(picture, i) + (1.0 - alpha) * static_cast<double>(kSkyRadiance),
                        radiance_at(opaque, i), 1e-4);
            most = std::max(most, alpha);
        }
    }
    EXPECT_GT(most, 0.05);
    EXPECT_LT(picture.alpha.front(), 0.01f);
}

TEST(RenderedSpray, IsFiniteFromAnywhere) {
    Scene scene = spray_storm(100.0);
    scene.camera.resolution = {24, 16};
    const Sky sky = make_sky(scene);
    const auto check = [&](glm::dvec3 from, glm::dvec3 to) {
        scene.camera.position_m = from;
        scene.camera.look_at_m = to;
        RenderOptions options = spray_options(scene);
        options.shutter_frames = from.z < 100.0 ? 1.0 : 0.0;
        const Picture picture = spray_picture(scene, options, sky);
        for (const SeaRadiance& light : picture.layers)
            for (const glm::vec3& layer : {light.sun, light.sky, light.sea, light.foam, light.air})
                ASSERT_TRUE(std::isfinite(layer.x) && layer.x >= 0.0f) << from.z;
    };
    for (const bool round : {true, false}) {
        scene.surface.earth_curvature = round;
        check({0.0, 0.0, 20.0}, {0.0, 0.0, 0.0});         // straight down
        check({0.0, 0.0, 20.0}, {0.0, 0.0, 40.0});        // straight up
        check({0.0, 0.0, 20.0}, {0.0, 100.0, 20.0});      // level
        check({1e6, -1e6, 1e5}, {1e6, -1e6 + 1e5, 0.0});  // far
        check({0.0, 0.0, 1e5}, {0.0, 1e6, 0.0});
        check({0.0, 0.0, 1500.0}, {0.0, 0.1, 0.0});
    }
}

TEST(RenderedSpray, MakesOtherPicturesAndIsInTheirFingerprint) {
    const auto made_of = [](const Scene& scene) {
        return PictureFingerprint({.scene = scene,
                                   .options = spray_options(scene),
                                   .picture_content = "",
                                   .exposure_stops = 0.0})
            .of(1);
    };
    EXPECT_NE(made_of(spray_storm(0.0)), made_of(spray_storm(1.0)));
    EXPECT_NE(made_of(spray_storm(1.0)), made_of(spray_storm(2.0)));
}

}  // namespace
}  // namespace pelagic
