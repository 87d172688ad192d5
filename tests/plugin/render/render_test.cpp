// Whole pictures, of seas for which something is known. Small ones: a few thousand pixels.
#include "plugin/render/render.h"
#include "plugin/light/light.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>
#include <numeric>
#include <set>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <vector>

#include "core/base/constants.h"
#include "core/surface/view.h"
#include "tests/plugin/render/uniform_sky.h"

namespace pelagic {
namespace {

Scene small_scene() {
    Scene scene;
    scene.camera.resolution = {64, 40};
    scene.quality.level = QualityLevel::Draft;
    scene.waves.cascades = {{250.0, 64}, {30.0, 64}};
    return scene;
}

// But for the rounding of the weights that the sky's texels are mixed with.
void expect_uniform_sky(const glm::vec3& radiance) {
    EXPECT_LE(glm::length(radiance - glm::vec3(kSkyRadiance)), 1e-6f * kSkyRadiance);
}

Scene calm_scene() {
    Scene scene = small_scene();
    scene.sea.wind_speed_mps = 0.0;
    return scene;
}

std::vector<int> all_frames(const Scene& scene) {
    std::vector<int> frames(static_cast<std::size_t>(scene.shot.last_frame - scene.shot.first_frame + 1));
    std::iota(frames.begin(), frames.end(), scene.shot.first_frame);
    return frames;
}

Picture picture_of(const Scene& scene, const RenderOptions& options, int frame = 1) {
    Renderer renderer(scene, options, uniform_sky(), all_frames(scene));
    Picture picture;
    renderer.render(frame, picture);
    return picture;
}
Picture picture_of(const Scene& scene, int frame = 1) {
    return picture_of(scene, render_options(scene), frame);
}

bool same_bits(const Picture& a, const Picture& b) {
    return a.resolution == b.resolution && a.sea == b.sea && a.layers.size() == b.layers.size() &&
           std::memcmp(a.layers.data(), b.layers.data(), a.layers.size() * sizeof(SeaRadiance)) == 0;
}

double largest_difference(const Picture& a, const Picture& b) {
    EXPECT_EQ(a.resolution, b.resolution);
    double most = 0.0;
    for (std::size_t i = 0; i < a.layers.size(); ++i)
        for (int c = 0; c < 3; ++c)
            most = std::max(most, std::abs(static_cast<double>(radiance_of(a.layers[i])[c]) -
                                           static_cast<double>(radiance_of(b.layers[i])[c])));
    return most;
}

void expect_finite(const Picture& picture) {
    for (const SeaRadiance& layers : picture.layers)
        for (const glm::vec3& layer : {layers.sun, layers.sky, layers.sea, layers.foam, layers.air})
            for (int c = 0; c < 3; ++c) ASSERT_TRUE(std::isfinite(layer[c]) && layer[c] >= 0.0f);
}

// Of unpolarised light on water, from Fresnel's amplitudes.
double fresnel(double cos_theta) {
    constexpr double n = 1.34;
    const double t = std::sqrt(1.0 - (1.0 - cos_theta * cos_theta) / (n * n));
    const double s = (cos_theta - n * t) / (cos_theta + n * t);
    const double p = (n * cos_theta - t) / (n * cos_theta + t);
    return 0.5 * (s * s + p * p);
}

// Under the same sky everywhere a mirror sends back F L, whatever lies in its direction, and the water (1 −
// F) times one colour. 0.016 of L: the fit of the effective term is asked to be within 0.015 of the exact
// one.
TEST(Render, FlatSeaUnderUniformSkyIsFresnelsAndTheWaters) {
    Scene scene = calm_scene();
    scene.surface.earth_curvature = false;
    scene.quality.level = QualityLevel::Preview;
    scene.water.body = false;  // a body's light depends on the eye's way through it
    const Picture picture = picture_of(scene);
    const View view = view_at(scene.camera, 1);
    double colour = 0.0;
    int sea = 0;
    for (int y = 0; y < picture.resolution.y; ++y)
        for (int x = 0; x < picture.resolution.x; ++x) {
            const std::size_t i = static_cast<std::size_t>(y) * picture.resolution.x + x;
            const SeaRadiance& pixel = picture.layers[i];
            const double cos_theta = -view.direction({x + 0.5, y + 0.5}).z;
            ASSERT_EQ(picture.sea[i], cos_theta > 0.0) << x << ", " << y;
            EXPECT_EQ(pixel.sun, glm::vec3(0.0f));
            EXPECT_EQ(pixel.foam, glm::vec3(0.0f));
            if (picture.sea[i] == 0) {
                expect_uniform_sky(pixel.sky);
                EXPECT_EQ(pixel.sea, glm::vec3(0.0f));
                continue;
            }
            ++sea;
            const double share = static_cast<double>(pixel.sky.y) / static_cast<double>(kSkyRadiance);
            EXPECT_NEAR(share, fresnel(cos_theta), 0.016) << "cos " << cos_theta;
            const double through = static_cast<double>(pixel.sea.y) / (1.0 - share);
            if (colour == 0.0) colour = through;
            // Near grazing 1 − F is a small difference of singles.
            EXPECT_NEAR(through, colour, 5e-5 * colour / (1.0 - share));
        }
    EXPECT_GT(sea, 1000);
    EXPECT_GT(colour, 0.0);
}

// The horizon of a calm sea lies where rays graze the sphere, and of a flat one where level rays go, on a row of its own.
TEST(Render, HorizonIsLevelAndInItsPlace) {
    Scene scene = calm_scene();
    for (const bool is_round : {true, false})
        for (const double height_m : {0.5, 60.0, 20e3}) {
            scene.surface.earth_curvature = is_round;
            const double dip = is_round ? std::acos(kEarthRadius_m / (kEarthRadius_m + height_m)) : 0.0;
            scene.camera.position_m = {3.0, -60.0, height_m};
            scene.camera.look_at_m = {3.0, 1e6, height_m - 1e5 * 0.73};
            const Picture picture = picture_of(scene);
            const View view = view_at(scene.camera, 1);
            for (int y = 0; y < picture.resolution.y; ++y)
                for (int x = 0; x < picture.resolution.x; ++x)
                    EXPECT_EQ(picture.sea[static_cast<std::size_t>(y) * picture.resolution.x + x],
                              view.direction({x + 0.5, y + 0.5}).z < -std::sin(dip))
                        << is_round << " " << height_m << " m: " << x << ", " << y;
        }
}

// However little lies between the eye and the water along the line of sight.
TEST(Render, WaterAtTheCamerasFeetIsSea) {
    struct Pose {
        double height_m, fov_deg;
    };
    for (const Pose& pose : {Pose{2.0, 179.0}, Pose{0.3, 170.0}, Pose{0.02, 50.0}}) {
        Scene scene = calm_scene();
        scene.camera.position_m = {0.0, 0.0, pose.height_m};
        scene.camera.look_at_m = {87.0, 0.0, pose.height_m - 50.0};
        scene.camera.fov_deg = pose.fov_deg;
        const Picture picture = picture_of(scene);
        const View view = view_at(scene.camera, 1);
        for (int y = 0; y < picture.resolution.y; ++y)
            for (int x = 0; x < picture.resolution.x; ++x)
                EXPECT_EQ(picture.sea[static_cast<std::size_t>(y) * picture.resolution.x + x],
                          view.direction({x + 0.5, y + 0.5}).z < 0.0)
                    << pose.height_m << " m, " << pose.fov_deg << " degrees: " << x << ", " << y;
    }
}

// Waves hide what is behind them and leave no holes: seen from above the crests, below the first sea of a
// column there is nothing but sea.
TEST(Render, AgitatedSeaHasNoHoles) {
    Scene scene = small_scene();
    scene.sea.wind_speed_mps = 20.0;
    for (const glm::dvec3 from :
         {glm::dvec3(0.0, -60.0, 30.0), glm::dvec3(1e6, 1e6, 30.0), glm::dvec3(0.0, -60.0, 8e3)}) {
        scene.camera.position_m = from;
        scene.camera.look_at_m = from + glm::dvec3(20.0, 60.0, -9.0);
        const Picture picture = picture_of(scene);
        expect_finite(picture);
        for (int x = 0; x < picture.resolution.x; ++x) {
            bool sea = false;
            for (int y = 0; y < picture.resolution.y; ++y) {
                const bool here = picture.sea[static_cast<std::size_t>(y) * picture.resolution.x + x] != 0;
                EXPECT_TRUE(here || !sea) << x << ", " << y;
                sea = sea || here;
            }
            EXPECT_TRUE(sea);
        }
    }
}

// Tiles of 200 m and 50 m repeat after 200 m: from any number of these away a camera sees the same sea. Places are
// singles relative to the camera's nadir, and phases doubles of which 1e9 m leave 1e-7 m.
TEST(Render, FarFromTheOriginThePictureIsTheSame) {
    Scene scene = small_scene();
    scene.waves.cascades = {{.size_m = 200.0, .resolution = 128}, {.size_m = 50.0, .resolution = 128}};
    scene.waves.tiling = Tiling::Periodic;
    scene.effects.foam_decay_s = 0.0;  // its cells don't repeat with the tiles
    scene.effects.foam_structure =
        0.0;  // a pattern that doesn't repeat with the tiles; FoamStructure.StaysWithTheWater
    for (const double height_m : {1.5, 40.0}) {
        const auto from = [&](glm::dvec2 place_m) {
            scene.camera.position_m = glm::dvec3(place_m + glm::dvec2(3.5, -60.25), height_m);
            scene.camera.look_at_m = scene.camera.position_m + glm::dvec3(20.0, 60.0, -0.1 * height_m);
            return picture_of(scene);
        };
        const Picture here = from({0.0, 0.0});
        for (const glm::dvec2 away_m :
             {glm::dvec2(1e6, -1e6), glm::dvec2(-1e7, 1e7), glm::dvec2(1e8), glm::dvec2(-9.999e8, 9.999e8)}) {
            SCOPED_TRACE(std::to_string(height_m) + " m high, at " + std::to_string(away_m.x));
            const Picture there = from(away_m);
            expect_finite(there);
            // Measured: 3e-6.
            EXPECT_LE(largest_difference(here, there), 2e-5 * static_cast<double>(kSkyRadiance));
            EXPECT_EQ(here.sea, there.sea);
        }
    }
}

TEST(Render, SameBitsForAnyNumberOfThreadsAndOrderOfFrames) {
    Scene scene = small_scene();
    scene.camera.resolution = {150, 90};  // more than a band
    RenderOptions options{.lighting = render_options(scene).lighting, .samples = 3};
    const auto on_threads = [&](int threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                        static_cast<std::size_t>(threads));
        tbb::task_arena arena(threads);
        return arena.execute([&] { return picture_of(scene, options, 5); });
    };
    const Picture one = on_threads(1);
    EXPECT_TRUE(same_bits(one, on_threads(4)));
    Renderer renderer(scene, options, uniform_sky(), all_frames(scene));
    Picture again;
    renderer.render(9, again);
    EXPECT_FALSE(same_bits(one, again));  // the sea moves
    renderer.render(5, again);
    EXPECT_TRUE(same_bits(one, again));
    // Where each pixel has its own samples.
    scene.camera.resolution = {50, 30};
    scene.camera.f_stop = 2.0;
    options.samples = 2;
    options.shutter_frames = 0.5;
    EXPECT_TRUE(same_bits(on_threads(1), on_threads(4)));
}

// A picture with a shift of a quarter of its width shows on its left what one without shows on its right: the same but for
// grids that are laid out anew.
TEST(Render, AShiftedPictureGoesOnWhereTheOtherEnds) {
    Scene scene = small_scene();
    const Picture straight = picture_of(scene);
    scene.camera.shift_x = 0.25;
    scene.camera.shift_y = 0.125;  // 8 rows
    const Picture shifted = picture_of(scene);
    double apart = 0.0, same = 0.0, all = 0.0;
    for (int y = 8; y < 40; ++y)
        for (int x = 0; x < 48; ++x) {
            const auto light = [](const Picture& picture, int column, int row) {
                return static_cast<double>(
                    radiance_of(picture.layers[static_cast<std::size_t>(row * 64 + column)]).y);
            };
            apart += std::abs(light(shifted, x, y) - light(straight, x + 16, y - 8));
            same += std::abs(light(shifted, x, y) - light(straight, x, y));
            all += light(shifted, x, y);
        }
    EXPECT_LT(apart / all, 0.01);
    EXPECT_GT(same, 5.0 * apart);
}

// A wide aperture keeps what it is focused on, and blurs the rest; the mean light stays.
TEST(Render, ALensIsSharpWhereItIsFocused) {
    Scene scene = small_scene();
    scene.camera.resolution = {96, 40};
    scene.camera.position_m = {0.0, 0.0, 3.0};
    scene.camera.look_at_m = {0.0, 10.0, 2.0};
    RenderOptions options = render_options(scene);
    options.samples = 4;
    const Picture pinhole = picture_of(scene, options);
    scene.camera.sensor_width_mm = 900.0;  // a giant's camera: an aperture of some 1 m
    scene.camera.f_stop = 1.0;
    const auto error = [&](double focus_m, int first_row, int last_row) {
        scene.camera.focus_distance_m = focus_m;
        const Picture picture = picture_of(scene, options);
        double off = 0.0, all = 0.0;
        for (int i = first_row * 96; i < last_row * 96; ++i) {
            off += std::abs(
                static_cast<double>(radiance_of(picture.layers[i]).y - radiance_of(pinhole.layers[i]).y));
            all += static_cast<double>(radiance_of(pinhole.layers[i]).y);
        }
        return off / all;
    };
    // The last rows are some 11 m away.
    EXPECT_LT(2.0 * error(10.8, 36, 40), error(1000.0, 36, 40));
    EXPECT_LT(2.0 * error(1000.0, 12, 20), error(2.0, 12, 20));
}

// Half way between two keys the picture is that of a camera that stands there. 1e-4 of the sky: places are
// singles relative to the camera's nadir, and the way there is rounded another way.
TEST(Render, FollowsTheCamerasKeys) {
    Scene moving = calm_scene();
    moving.camera.keys = {{.frame = 1, .position_m = {0.0, -60.0, 4.0}, .look_at_m = {0.0, 0.0, 0.0}},
                          {.frame = 5, .position_m = {8.0, -20.0, 12.0}, .look_at_m = {40.0, 60.0, 2.0}}};
    Scene still = calm_scene();
    still.camera.position_m = {4.0, -40.0, 8.0};
    still.camera.look_at_m = {20.0, 30.0, 1.0};
    const Picture there = picture_of(still, 3);
    EXPECT_LE(largest_difference(picture_of(moving, 3), there), 1e-4 * static_cast<double>(kSkyRadiance));
    EXPECT_GT(largest_difference(picture_of(moving, 2), there), 1e-2 * static_cast<double>(kSkyRadiance));
}

TEST(Render, LookingUpIsSkyAlone) {
    Scene scene = small_scene();
    scene.camera.look_at_m = scene.camera.position_m + glm::dvec3(0.0, 1.0, 1.5);
    const Picture picture = picture_of(scene);
    EXPECT_EQ(std::ranges::count(picture.sea, 1), 0);
    for (const SeaRadiance& pixel : picture.layers) expect_uniform_sky(radiance_of(pixel));
}

// The surface above the camera is at -0.32 m.
TEST(Render, StaysFiniteAtTheSurfaceAndUnderIt) {
    Scene scene = small_scene();
    scene.sea.wind_speed_mps = 25.0;
    for (const bool has_body : {true, false})
        for (const double height_m : {0.0, -3.0, -1000.0, 1e-3, 1e6}) {
            scene.water.body = has_body;
            scene.camera.position_m = {0.0, 0.0, height_m};
            for (const glm::dvec3 towards :
                 {glm::dvec3(0.0, 1.0, 0.0), glm::dvec3(0.0, 0.0, -1.0), glm::dvec3(0.0, 0.0, 1.0)}) {
                scene.camera.look_at_m = scene.camera.position_m + towards;
                if (height_m < -1.0 && !has_body)
                    EXPECT_THROW(picture_of(scene), std::invalid_argument) << height_m;
                else
                    expect_finite(picture_of(scene));
            }
        }
}

// N × N samples show what N² × N² would in N² of their places, each in a row and a column of its own, on cells as large as before: an edge
// that is nearly level, as a horizon is, steps from pixel to pixel by 1/N² of the light, and not by 1/N. Their light is as much.
TEST(Render, SamplesOfAPixelStandAtHeightsOfTheirOwn) {
    Scene scene = small_scene();
    RenderOptions options{.lighting = render_options(scene).lighting, .samples = 2};
    options.alpha = true;
    const Picture averaged = picture_of(scene, options);
    Scene larger = scene;
    larger.camera.resolution *= 4;
    larger.surface.cell_px *= 4.0;
    options.samples = 1;
    const Picture fine = picture_of(larger, options);
    const auto width = static_cast<std::size_t>(scene.camera.resolution.x);
    glm::dvec3 light(0.0), light_of_fine(0.0);
    std::set<float> shares;
    for (std::size_t i = 0; i < averaged.layers.size(); ++i) {
        const std::size_t x = i % width, y = i / width;
        float sea = 0.0f;
        for (const auto& [right, down] : {std::pair{1, 0}, {3, 1}, {0, 2}, {2, 3}}) {
            const std::size_t at = (4 * y + static_cast<std::size_t>(down)) * 4 * width + 4 * x +
                                   static_cast<std::size_t>(right);
            sea += 0.25f * fine.alpha[at];
            light_of_fine += 0.25 * glm::dvec3(radiance_of(fine.layers[at]));
        }
        ASSERT_EQ(averaged.alpha[i], sea) << x << ' ' << y;
        shares.insert(sea);
        light += glm::dvec3(radiance_of(averaged.layers[i]));
    }
    EXPECT_GT(shares.size(), 2u);
    // Pixels that show both sea and sky know how much of each, as long as there is a sky.
    EXPECT_TRUE(averaged.skyline.empty());
    options = {.lighting = options.lighting, .samples = 2};
    const Picture with_sky = picture_of(scene, options);
    std::size_t next = 0;
    for (std::size_t i = 0; i < averaged.alpha.size(); ++i) {
        if (averaged.alpha[i] == 0.0f || averaged.alpha[i] == 1.0f) continue;
        ASSERT_LT(next, with_sky.skyline.size());
        const SkylinePixel& both = with_sky.skyline[next++];
        ASSERT_EQ(both.pixel, i);
        EXPECT_EQ(both.sky, 1.0f - averaged.alpha[i]);
        EXPECT_NEAR(both.light.y + radiance_of(averaged.layers[i]).y, radiance_of(with_sky.layers[i]).y,
                    1e-5f * radiance_of(with_sky.layers[i]).y);
    }
    EXPECT_GT(next, 20u);
    EXPECT_EQ(next, with_sky.skyline.size());
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(light[c] / light_of_fine[c], 1.0, 0.02);  // of finer footprints
}

// Waves that only the normals have lean to the eye as visible ones do: finer normals on the same mesh show as much light.
// With all of them seen alike the two differed by 8 % here.
TEST(Render, OneSampleShowsAsMuchLightAsMany) {
    Scene scene = small_scene();
    scene.camera.resolution = {96, 54};
    scene.sea.wind_speed_mps = 8.0;
    scene.waves.cascades = {{120.0, 256}, {9.0, 256}};
    scene.camera.position_m = {0.0, -60.0, 4.0};
    scene.camera.look_at_m = {0.0, 0.0, 0.0};
    RenderOptions options = render_options(scene);
    options.lighting.air = false;
    const auto light_of = [&](int samples) {
        options.samples = samples;
        const Picture picture = picture_of(scene, options);
        double sum = 0.0;
        for (std::size_t i = picture.layers.size() / 3; i < picture.layers.size(); ++i)
            sum += static_cast<double>(radiance_of(picture.layers[i]).y);
        return sum;
    };
    EXPECT_NEAR(light_of(1) / light_of(8), 1.0, 0.02);
}

// A term that is off leaves its layer black, and the other layers as they are but for the foam's share.
TEST(Render, TermsThatAreOffAreBlack) {
    Scene scene = small_scene();
    scene.sea.wind_speed_mps = 18.0;
    scene.water.bubbles = 0.0;  // they are there where foam is
    Sky sky = uniform_sky();
    sky.sun_direction = {0.0f, 0.8f, 0.6f};
    sky.sun_radiance = glm::vec3(1e5f);
    sky.sun_irradiance = glm::vec3(4.0f);
    const auto with = [&](LightingChoice lighting) {
        lighting.sky_quality = SkyQuality::One;
        Renderer renderer(scene, {.lighting = lighting}, sky, all_frames(scene));
        Picture picture;
        renderer.render(1, picture);
        return picture;
    };
    const Picture all = with({});
    const Picture sun = with({.sky = false, .water = false, .whitecaps = false});
    const Picture sea = with({.sun = false, .sky = false, .whitecaps = false});
    double foam = 0.0;
    for (std::size_t i = 0; i < all.layers.size(); ++i) {
        foam += static_cast<double>(all.layers[i].foam.x);
        const glm::vec3 none(0.0f);
        EXPECT_EQ(sun.layers[i].sea, none);
        EXPECT_EQ(sun.layers[i].foam, none);
        EXPECT_EQ(sea.layers[i].sky, none);
        EXPECT_EQ(sea.layers[i].sun, none);
        if (sun.sea[i] != 0) {
            EXPECT_EQ(sun.layers[i].sky, none);
        }
        EXPECT_GE(sun.layers[i].sun.x, all.layers[i].sun.x);
        EXPECT_GE(sea.layers[i].sea.x, all.layers[i].sea.x);
    }
    EXPECT_GT(foam, 0.0);
    scene.effects.whitecaps = false;
    for (const SeaRadiance& pixel : with(render_options(scene).lighting).layers)
        EXPECT_EQ(pixel.foam, glm::vec3(0.0f));
}

TEST(Render, QualityChoosesTheLighting) {
    Scene scene;
    const auto at = [&](QualityLevel level) {
        scene.quality.level = level;
        return render_options(scene).lighting;
    };
    EXPECT_EQ(at(QualityLevel::Draft).sky_quality, SkyQuality::One);
    EXPECT_EQ(at(QualityLevel::Draft).fresnel, FresnelFit::Paper);
    EXPECT_EQ(at(QualityLevel::Final).sky_quality, SkyQuality::Nine);
    EXPECT_EQ(at(QualityLevel::Final).fresnel, FresnelFit::Exact);
    EXPECT_EQ(at(QualityLevel::Reference).sky_quality, SkyQuality::Integral);
    EXPECT_TRUE(at(QualityLevel::Final).whitecaps);
    scene.effects.whitecaps = false;
    EXPECT_FALSE(at(QualityLevel::Final).whitecaps);
}

TEST(Render, TellsHowFarItIsAndStopsWhenAsked) {
    Scene scene = small_scene();
    Renderer renderer(scene, render_options(scene), uniform_sky(), all_frames(scene));
    Picture picture;
    double done = 0.0;
    renderer.render(1, picture, {.progress = [&](double part) {
                        EXPECT_GT(part, done);
                        done = part;
                    }});
    EXPECT_EQ(done, 1.0);
    const std::atomic<bool> stop = true;
    EXPECT_THROW(renderer.render(1, picture, {.cancel = &stop}), BuildCancelled);
}

TEST(Render, RefusesWhatItCannotDo) {
    Scene scene = small_scene();
    EXPECT_THROW(Renderer(scene, {.lighting = {}, .samples = 0}, uniform_sky(), all_frames(scene)),
                 std::invalid_argument);
    EXPECT_THROW(
        Renderer(scene, {.lighting = {}, .samples = kMostSamples + 1}, uniform_sky(), all_frames(scene)),
        std::invalid_argument);
    scene.camera.resolution = {65536, 2};
    EXPECT_THROW(Renderer(scene, {.lighting = {}, .samples = 8}, uniform_sky(), all_frames(scene)),
                 std::invalid_argument);
    scene.light.sky = "/nowhere/sky.exr";
    try {
        make_sky(scene);
        FAIL() << "a picture that isn't there";
    } catch (const std::invalid_argument& error) {
        EXPECT_NE(std::string(error.what()).find("/nowhere/sky.exr"), std::string::npos) << error.what();
    }
}

}  // namespace
}  // namespace pelagic
