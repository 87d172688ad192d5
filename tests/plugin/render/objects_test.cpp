// Bodies before the camera: where their light, their shadow and their mirror image are, of seas for which that is known.
#include "plugin/render/objects.h"

#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfStringAttribute.h>
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <glm/geometric.hpp>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/base/build_watch.h"
#include "core/base/constants.h"
#include "core/lighting/object.h"
#include "core/surface/view.h"
#include "pelagic/cage.h"
#include "plugin/light/light.h"
#include "plugin/render/cryptomatte.h"
#include "plugin/render/picture_files.h"
#include "plugin/render/render.h"
#include "plugin/render/sea_light.h"
#include "tests/plugin/render/uniform_sky.h"

namespace pelagic {
namespace {

// Boxes by their corners, outwards; of a hull one lacks its top, of a dome its bottom.
constexpr std::uint32_t kAll = 6, kTop = 5, kBottom = 4;
struct Box {
    glm::vec3 least, most;
    std::uint32_t lacks = kAll;
};
std::shared_ptr<const ObjectMesh> boxes(const std::vector<Box>& of, const ObjectMaterial& material) {
    ObjectMeshData mesh;
    mesh.materials = {material};
    for (const Box& box : of) {
        const auto first = static_cast<std::uint32_t>(mesh.points_m.size());
        for (int i = 0; i < 8; ++i)
            mesh.points_m.emplace_back(i & 1 ? box.most.x : box.least.x, i & 2 ? box.most.y : box.least.y,
                                       i & 4 ? box.most.z : box.least.z);
        struct Face {
            std::array<std::uint32_t, 4> corners;
            glm::vec3 normal;
        };
        const std::array<Face, 6> faces{{{{0, 4, 6, 2}, {-1, 0, 0}},
                                         {{1, 3, 7, 5}, {1, 0, 0}},
                                         {{0, 1, 5, 4}, {0, -1, 0}},
                                         {{2, 6, 7, 3}, {0, 1, 0}},
                                         {{0, 2, 3, 1}, {0, 0, -1}},
                                         {{4, 5, 7, 6}, {0, 0, 1}}}};
        for (std::uint32_t f = 0; f < faces.size(); ++f) {
            if (f == box.lacks) continue;
            for (const auto& corners : {std::array{0, 1, 2}, std::array{0, 2, 3}}) {
                for (const int corner : corners) {
                    mesh.triangles.push_back(first + faces[f].corners[corner]);
                    mesh.normals.push_back(faces[f].normal);
                }
                mesh.material.push_back(0);
            }
        }
    }
    return std::make_shared<const ObjectMesh>(std::move(mesh));
}
std::shared_ptr<const ObjectMesh> box(glm::vec3 least, glm::vec3 most, const ObjectMaterial& material = {}) {
    return boxes({{least, most}}, material);
}

// Black but for a radiance of 1 times the object's glow over a thousand.
const ObjectMaterial kGlows{
    .name = "lamp", .colour = glm::vec3(0.0f), .roughness = 1.0f, .glow = glm::vec3(1.0f)};

SceneObject object(std::shared_ptr<const ObjectMesh> mesh, const std::string& name = "box") {
    SceneObject object;
    object.name = name;
    object.mesh = std::move(mesh);
    return object;
}

Scene calm_scene() {
    Scene scene;
    scene.camera.resolution = {96, 64};
    scene.quality.level = QualityLevel::Draft;
    scene.waves.cascades = {{250.0, 64}, {30.0, 64}};
    scene.sea.wind_speed_mps = 0.0;
    scene.surface.earth_curvature = false;
    scene.water.body = false;
    return scene;
}

// A uniform sky, and the sun in it.
Sky sunny_sky(double elevation_deg, double azimuth_deg, float angular_radius = 0.00465f) {
    Sky sky = uniform_sky();
    const double e = elevation_deg * kPi / 180.0, a = azimuth_deg * kPi / 180.0;
    sky.sun_direction =
        glm::vec3(glm::dvec3(std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)));
    sky.sun_angular_radius = angular_radius;
    sky.sun_radiance = glm::vec3(20.0f / (static_cast<float>(kPi) * angular_radius * angular_radius));
    sky.sun_irradiance = glm::vec3(20.0f * sky.sun_direction.z);
    return sky;
}

RenderOptions options_of(const Scene& scene, const std::string& layers = "all", int samples = 1) {
    RenderOptions options = render_options(scene);
    options.layers = parse_picture_layers(layers);
    options.samples = samples;
    // A draft's sky has another fit of Fresnel's term.
    options.lighting.sky_quality = SkyQuality::Nine;
    options.lighting.fresnel = FresnelFit::Exact;
    return options;
}

Picture picture_of(const Scene& scene, const RenderOptions& options, const Sky& sky = uniform_sky(),
                   int frame = 1) {
    Renderer renderer(scene, options, sky, std::array{frame});
    Picture picture;
    renderer.render(frame, picture);
    return picture;
}

glm::vec3 vector_of(const Picture& picture, PictureLayer layer, std::size_t pixel) {
    const std::vector<float>& of = picture.data[index(layer)];
    return {of[3 * pixel], of[3 * pixel + 1], of[3 * pixel + 2]};
}
float number_of(const Picture& picture, PictureLayer layer, std::size_t pixel) {
    return picture.data[index(layer)][pixel];
}
bool shows_object(const Picture& picture, std::size_t pixel) {
    return !picture.sea[pixel] && number_of(picture, PictureLayer::Depth, pixel) < 1e9f;
}
std::size_t count_of(const Picture& picture, const auto& is) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < picture.layers.size(); ++i) count += is(i);
    return count;
}
glm::dvec2 middle_of(const Picture& picture, std::size_t pixel) {
    const auto width = static_cast<std::size_t>(picture.resolution.x);
    return {static_cast<double>(pixel % width) + 0.5, static_cast<double>(pixel / width) + 0.5};
}

double fresnel(double cosine) {
    constexpr double n = 1.34;
    const double t = std::sqrt(1.0 - (1.0 - cosine * cosine) / (n * n));
    const double s = (cosine - n * t) / (cosine + n * t), p = (n * cosine - t) / (n * cosine + t);
    return 0.5 * (s * s + p * p);
}

// Where a ray meets a box, by its slabs: infinite if nowhere.
double distance_to_box(glm::dvec3 from, glm::dvec3 towards, glm::dvec3 least, glm::dvec3 most) {
    double near = 0.0, far = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 3; ++i) {
        const double a = (least[i] - from[i]) / towards[i], b = (most[i] - from[i]) / towards[i];
        near = std::max(near, std::min(a, b));
        far = std::min(far, std::max(a, b));
    }
    return near <= far ? near : std::numeric_limits<double>::infinity();
}

// A glowing box on calm water shows where its slabs are, and upside down where those of its mirror image are. There Fresnel's part of
// its light has taken the place of the sky's.
TEST(Objects, StandAndAreMirroredWhereGeometrySays) {
    Scene scene = calm_scene();
    scene.camera.position_m = {1.0, -40.0, 6.0};
    scene.objects = {object(box({-4, -3, -1}, {5, 3, 5}, kGlows))};
    scene.objects[0].glow_cd_m2 = 12000.0;
    const Picture picture = picture_of(scene, options_of(scene, "all", 2));
    Scene without = scene;
    without.objects.clear();
    const Picture sea = picture_of(without, options_of(without, "all", 2));
    const View view = view_at(scene.camera, 1);
    int seen = 0, mirrored = 0, apart = 0;
    for (std::size_t i = 0; i < picture.layers.size(); ++i) {
        const glm::dvec3 towards = view.direction(middle_of(picture, i));
        const auto meets = [&](glm::dvec3 ray, double z) {
            const glm::dvec3 from(view.position_m.x, view.position_m.y, z * view.position_m.z);
            return distance_to_box(from, ray, {-4, -3, 0}, {5, 3, 5});
        };
        // The eye's own mirror image looks up.
        const bool is_seen = meets(towards, 1.0) < 1e9;
        const bool is_mirrored =
            !is_seen && towards.z < 0.0 && meets({towards.x, towards.y, -towards.z}, -1.0) < 1e9;
        const glm::vec3 object = vector_of(picture, PictureLayer::Object, i),
                        reflection = vector_of(picture, PictureLayer::Reflection, i);
        const glm::vec3 left = light_of(picture, i);
        if (shows_object(picture, i) != is_seen) ++apart;
        if (is_seen && shows_object(picture, i) && object.y > 11.999f) {
            ++seen;
            EXPECT_GE(left.y, 11.999f);
            EXPECT_LE(left.y, 14.0f);  // what is mirrored by a rough skin
        }
        if (!is_mirrored || !picture.sea[i]) continue;
        const double expected = fresnel(-towards.z) * (12.0 - static_cast<double>(kSkyRadiance));
        if (std::abs(static_cast<double>(reflection.y) - expected) > 0.02 * expected + 0.02) {
            ++apart;  // on an edge
            continue;
        }
        ++mirrored;
        EXPECT_EQ(picture.layers[i].sky, sea.layers[i].sky);
    }
    EXPECT_GT(seen, 250);
    EXPECT_GT(mirrored, 150);
    EXPECT_LT(apart, 55);  // what the edges of both are
}

// Bright and dark squares, `checks` of them along each side of a box.
std::shared_ptr<const ObjectMesh> with_checker(const ObjectMesh& of, int checks, int texels_a_check) {
    const int side = checks * texels_a_check;
    std::vector<std::uint16_t> rgb;
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x)
            // 0.75 and 0.25 as half floats
            rgb.insert(rgb.end(), 3, (x / texels_a_check + y / texels_a_check) % 2 == 0 ? 0x3a00 : 0x3400);
    ObjectMeshData mesh = of.data();
    mesh.images = {std::make_shared<const ObjectImage>(side, side, std::move(rgb))};
    for (ObjectMaterial& material : mesh.materials) material.image = 0;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const glm::vec3 n = glm::abs(mesh.normals[i]),
                        at = (mesh.points_m[mesh.triangles[i]] - glm::vec3(of.least_m())) /
                             glm::vec3(of.most_m() - of.least_m());
        mesh.image_at.push_back(n.x > 0.5f   ? glm::vec2(at.y, at.z)
                                : n.y > 0.5f ? glm::vec2(at.x, at.z)
                                             : glm::vec2(at.x, at.y));
    }
    return std::make_shared<const ObjectMesh>(std::move(mesh));
}

// The colour that a body shows: where its light lies between that of a black one and that of a white one.
std::vector<double> shown_colours(Scene scene, const RenderOptions& options) {
    std::array<Picture, 3> pictures;
    const std::shared_ptr<const ObjectMesh> mesh = scene.objects[0].mesh;
    for (int i = 0; i < 3; ++i) {
        if (i < 2) {
            ObjectMeshData plain = mesh->data();
            plain.images.clear(), plain.image_at.clear();
            for (ObjectMaterial& material : plain.materials) {
                material.image = -1;
                material.colour = glm::vec3(static_cast<float>(i));
            }
            scene.objects[0].mesh = std::make_shared<const ObjectMesh>(std::move(plain));
        } else {
            scene.objects[0].mesh = mesh;
        }
        pictures[static_cast<std::size_t>(i)] = picture_of(scene, options);
    }
    std::vector<double> shown;
    for (std::size_t i = 0; i < pictures[0].layers.size(); ++i) {
        const auto light = [&](std::size_t of) {
            return static_cast<double>(vector_of(pictures[of], PictureLayer::Object, i).y);
        };
        shown.push_back(light(1) > light(0) ? (light(2) - light(0)) / (light(1) - light(0)) : std::nan(""));
    }
    return shown;
}

TEST(Objects, HaveThePicturesOfTheirMaterials) {
    constexpr int kChecks = 2;
    const glm::dvec3 least(-8, -3, 0.5), most(8, 3, 8.5);
    Scene scene = calm_scene();
    scene.camera.position_m = {14.0, -30.0, 6.0};
    scene.camera.look_at_m = {0.0, 0.0, 4.0};
    scene.objects = {object(with_checker(*box(glm::vec3(least), glm::vec3(most)), kChecks, 128))};
    const View view = view_at(scene.camera, 1);
    const std::vector<double> shown = shown_colours(scene, options_of(scene, "all", 1));
    int right = 0, beside = 0;
    const auto width = static_cast<std::size_t>(view.resolution.x);
    for (std::size_t i = 0; i < shown.size(); ++i) {
        const glm::dvec3 towards =
            view.direction({static_cast<double>(i % width) + 0.5, static_cast<double>(i / width) + 0.5});
        const double away = distance_to_box(view.position_m, towards, least, most);
        if (!(away < 1e9) || std::isnan(shown[i])) continue;
        const glm::dvec3 at =
            (view.position_m + away * towards - least) / (most - least) * static_cast<double>(kChecks);
        // The side in front, and the one to the right.
        const bool is_front = std::abs(at.y) < 1e-6, is_right = std::abs(at.x - kChecks) < 1e-6;
        if (!is_front && !is_right) continue;
        const glm::dvec2 place(is_front ? at.x : at.y, at.z), in_check = glm::fract(place);
        // Half of the sample's width on the side, and two texels of the coarser level, which is up to twice as wide: there two squares are mixed.
        const glm::dvec2 a_check = glm::dvec2(is_front ? 16.0 : 6.0, 8.0) / static_cast<double>(kChecks);
        const double sample_m = view.pixel_tangent() * away;
        const glm::dvec2 rim =
            2.5 * sample_m / std::abs(is_front ? towards.y : towards.x) / a_check + 2.0 / 128;
        if (glm::any(glm::lessThan(in_check, rim)) || glm::any(glm::greaterThan(in_check, 1.0 - rim))) {
            ++beside;
            EXPECT_GT(shown[i], 0.25 - 1e-3);
            EXPECT_LT(shown[i], 0.75 + 1e-3);
            continue;
        }
        const bool is_bright = (static_cast<int>(place.x) + static_cast<int>(place.y)) % 2 == 0;
        EXPECT_NEAR(shown[i], is_bright ? 0.75 : 0.25, 1e-4) << place.x << ' ' << place.y;
        ++right;
    }
    EXPECT_GT(right, 400);
    EXPECT_GT(beside, 100);
}

// Squares much smaller than pixels are their mean, seen straight on and along the surface; and the sea's mirror image of them is that of a
// plain body.
TEST(Objects, HavePicturesThatAreTheirMeanFarAway) {
    Scene scene = calm_scene();
    scene.camera.position_m = {150.0, -300.0, 30.0};
    scene.camera.look_at_m = {0.0, 0.0, 10.0};
    const auto plain = box({-60, -40, -1}, {60, 40, 40}, {.name = "grey", .colour = glm::vec3(0.5f)});
    scene.objects = {object(with_checker(*plain, 512, 2))};
    int seen = 0;
    for (const double shown : shown_colours(scene, options_of(scene, "all", 1)))
        if (!std::isnan(shown)) {
            // Levels keep the mean to a half float's rounding.
            EXPECT_NEAR(shown, 0.5, 1e-3);
            ++seen;
        }
    EXPECT_GT(seen, 300);
    const Picture with = picture_of(scene, options_of(scene, "all", 1));
    scene.objects[0].mesh = plain;
    const Picture grey = picture_of(scene, options_of(scene, "all", 1));
    double most = 0.0;
    for (std::size_t i = 0; i < with.layers.size(); ++i)
        most = std::max(most, std::abs(static_cast<double>(vector_of(with, PictureLayer::Reflection, i).y -
                                                           vector_of(grey, PictureLayer::Reflection, i).y)));
    EXPECT_LT(most, 2e-3);
}

// A body as bright as the sky behind it changes nothing where the sea mirrors it, however rough the sea is.
TEST(Objects, AsBrightAsTheSkyAreNotSeenInTheWater) {
    Scene scene = calm_scene();
    scene.sea.wind_speed_mps = 9.0;
    scene.camera.position_m = {0.0, -40.0, 5.0};
    scene.objects = {object(box({-6, -3, -2}, {6, 3, 9}, kGlows))};
    for (const double times : {1.0, 2.0}) {
        scene.objects[0].glow_cd_m2 = times * 1000.0 * static_cast<double>(kSkyRadiance);
        const Picture picture = picture_of(scene, options_of(scene));
        double most = 0.0;
        for (std::size_t i = 0; i < picture.layers.size(); ++i)
            most = std::max(most,
                            std::abs(static_cast<double>(vector_of(picture, PictureLayer::Reflection, i).y)));
        EXPECT_EQ(most < 2e-5, times == 1.0) << most;
        EXPECT_EQ(most > 0.2, times == 2.0) << most;
    }
}

// The mean of what is mirrored on a rough sea: under a uniform sky a body that is all of the sky's other side takes as much as the sea
// shows of it. A wall as long and as high as half the sky, as bright as nothing.
TEST(Objects, TakeFromTheSeaWhatItShowsOfTheSkyBehindThem) {
    Scene scene = calm_scene();
    scene.sea.wind_speed_mps = 7.0;
    scene.effects.whitecaps = false;
    scene.camera.position_m = {0.0, -30.0, 8.0};
    scene.camera.look_at_m = {0.0, 10.0, 0.0};
    ObjectMaterial black;
    black.colour = glm::vec3(0.0f);
    // Round the whole sea and over it, but the eye is within.
    scene.objects = {object(boxes({{{-4000, -4000, -3000}, {4000, 4000, 3000}, kBottom}}, black))};
    RenderOptions options = options_of(scene, "all", 2);
    options.lighting.second_reflection = false;
    options.lighting.sky_quality = SkyQuality::Integral;
    const Picture picture = picture_of(scene, options);
    double taken = 0.0, sky = 0.0;
    for (std::size_t i = 0; i < picture.layers.size(); ++i) {
        if (!picture.sea[i]) continue;
        taken -= static_cast<double>(vector_of(picture, PictureLayer::Reflection, i).y);
        sky += static_cast<double>(picture.layers[i].sky.y);
    }
    EXPECT_GT(sky, 100.0);
    EXPECT_NEAR(taken / sky, 1.0, 0.02);
}

// A pole's shadow on calm water ends where the sun's ray over its top comes down, and is as blurred there as the sun's disc is wide.
TEST(Objects, ShadowTheSeaBySunsDisc) {
    Scene scene = calm_scene();
    scene.camera.resolution = {128, 128};
    scene.camera.position_m = {6.0, 0.0, 60.0};
    scene.camera.look_at_m = {6.0, 0.0, 0.0};
    scene.camera.fov_deg = 30.0;
    scene.objects = {object(box({-60, -40, 8}, {0, 40, 10}))};
    constexpr double kElevation = 40.0;
    constexpr float kRadius = 0.05f;
    const Sky sky = sunny_sky(kElevation, 180.0, kRadius);  // the shadow falls to +x
    const Picture picture = picture_of(scene, options_of(scene, "all", 3), sky);
    // Along +x the upper edge casts it: x = height / tan of the elevation of the disc's place.
    const double e = kElevation * kPi / 180.0, end = 10.0 / std::tan(e);
    const auto row = static_cast<std::size_t>(picture.resolution.y / 2);
    double width = 0.0;
    const double step = 2.0 * 60.0 * std::tan(15.0 * kPi / 180.0) / picture.resolution.x;
    double crossing = 0.0, before = 0.0;
    for (int x = 0; x < picture.resolution.x; ++x) {
        const std::size_t i =
            row * static_cast<std::size_t>(picture.resolution.x) + static_cast<std::size_t>(x);
        const double at = vector_of(picture, PictureLayer::Position, i).x;
        if (!picture.sea[i] || at < 4.0) continue;
        double share = 0.0;  // over rows, of chance
        for (int r = -20; r < 20; ++r)
            share += static_cast<double>(number_of(picture, PictureLayer::Shadow,
                                                   i + static_cast<std::size_t>(r * picture.resolution.x))) /
                     40.0;
        if (before < 0.5 && share >= 0.5) crossing = at;
        if (share > 0.02 && share < 0.98) width += step;
        before = share;
    }
    EXPECT_NEAR(crossing, end, 1.5 * step);
    // From the disc's lowest place to its highest; the outer fiftieth of light is a tenth of that on each side.
    const double penumbra = 10.0 / std::tan(e - kRadius) - 10.0 / std::tan(e + kRadius);
    EXPECT_NEAR(width, 0.84 * penumbra, 0.2 * penumbra);
}

// In the full shadow all that the sea shows of the sun is gone, and nothing of the sky's light.
TEST(Objects, LeaveTheSkysLightInTheirShadow) {
    Scene scene = calm_scene();
    scene.sea.wind_speed_mps = 8.0;
    scene.water.body = true;
    scene.camera.position_m = {20.0, 0.0, 25.0};
    scene.camera.look_at_m = {10.0, 0.0, 0.0};
    scene.objects = {object(box({-400, -200, 30}, {-1, 200, 500}))};
    const Sky sky = sunny_sky(60.0, 180.0);
    Sky dark = sky;
    dark.sun_radiance = dark.sun_irradiance = glm::vec3(0.0f);
    const Picture shadowed = picture_of(scene, options_of(scene), sky);
    scene.objects.clear();
    const Picture unlit = picture_of(scene, options_of(scene), dark),
                  lit = picture_of(scene, options_of(scene), sky);
    std::size_t in_shadow = 0;
    for (std::size_t i = 0; i < lit.layers.size(); ++i) {
        if (!lit.sea[i] || number_of(shadowed, PictureLayer::Shadow, i) > 0.0f) continue;
        ++in_shadow;
        ASSERT_EQ(shadowed.layers[i].sun, glm::vec3(0.0f));
        ASSERT_EQ(shadowed.layers[i].sea, unlit.layers[i].sea);
        ASSERT_EQ(shadowed.layers[i].sky, lit.layers[i].sky);
        ASSERT_GT(lit.layers[i].sea.y, shadowed.layers[i].sea.y);
    }
    EXPECT_GT(in_shadow, 300u);
}

// An open hull that lies 1 m deep in the water: inside one sees its bottom.
TEST(Objects, KeepTheWaterOutOfTheirHulls) {
    Scene scene = calm_scene();
    scene.camera.position_m = {0.0, -6.0, 12.0};
    scene.camera.look_at_m = {0.0, 0.0, 0.0};
    scene.camera.fov_deg = 40.0;
    const auto hull = boxes({{{-3, -2, -1}, {3, 2, 1}, kTop}}, {});
    // Between the hulls of a catamaran there is water, whatever lies below.
    const auto open_ended = boxes(
        {{{-3, -2, -1}, {3, -1.8f, 1}}, {{-3, 1.8f, -1}, {3, 2, 1}}, {{-3, -2, -1.2f}, {3, 2, -1}}}, {});
    const std::size_t middle = static_cast<std::size_t>(
        scene.camera.resolution.y / 2 * scene.camera.resolution.x + scene.camera.resolution.x / 2);
    scene.objects = {object(hull)};
    const Picture dry = picture_of(scene, options_of(scene));
    EXPECT_FALSE(dry.sea[middle]);
    EXPECT_NEAR(vector_of(dry, PictureLayer::Position, middle).z, -1.0f, 1e-3f);
    EXPECT_EQ(count_of(dry,
                       [&](std::size_t i) {
                           const glm::vec3 at = vector_of(dry, PictureLayer::Position, i);
                           return dry.sea[i] && std::abs(at.x) < 2.99f && std::abs(at.y) < 1.99f;
                       }),
              0u);
    scene.objects = {object(open_ended)};
    EXPECT_TRUE(picture_of(scene, options_of(scene)).sea[middle]);
}

// A holdout is black, with alpha 0, but the sea has its shadow and its mirror image.
TEST(Objects, AsHoldoutsAreLeftOut) {
    Scene scene = calm_scene();
    scene.camera.position_m = {0.0, -40.0, 6.0};
    scene.objects = {object(box({-5, -3, -1}, {5, 3, 5}))};
    const Sky sky = sunny_sky(50.0, 90.0);
    RenderOptions options = options_of(scene);
    options.alpha = true;
    const Picture body = picture_of(scene, options, sky);
    scene.objects[0].holdout = true;
    const Picture held = picture_of(scene, options, sky);
    std::size_t out = 0;
    for (std::size_t i = 0; i < body.layers.size(); ++i) {
        if (shows_object(body, i)) {
            ++out;
            ASSERT_EQ(body.alpha[i], 1.0f);
            ASSERT_GT(light_of(body, i).y, 0.0f);
            ASSERT_EQ(held.alpha[i], 0.0f);
            ASSERT_EQ(light_of(held, i), glm::vec3(0.0f));
        } else {
            ASSERT_EQ(held.alpha[i], body.alpha[i]);
            ASSERT_EQ(light_of(held, i), light_of(body, i));
        }
    }
    EXPECT_GT(out, 200u);
    EXPECT_GT(
        count_of(held, [&](std::size_t i) { return vector_of(held, PictureLayer::Reflection, i).y != 0.0f; }),
        50u);
    EXPECT_GT(count_of(held,
                       [&](std::size_t i) {
                           return number_of(held, PictureLayer::Shadow, i) == 0.0f && held.sea[i];
                       }),
              20u);
}

// The earth hides what stands low and far; and waves what they are higher than.
TEST(Objects, AreHiddenByTheSea) {
    Scene scene = calm_scene();
    scene.camera.position_m = {0.0, 0.0, 2.0};
    scene.camera.look_at_m = {0.0, 1000.0, 2.0};
    scene.camera.fov_deg = 2.0;
    scene.objects = {object(box({-200, 0, -2}, {200, 20, 8}))};
    scene.objects[0].north_m = 20000.0;
    const auto seen = [&] {
        const Picture picture = picture_of(scene, options_of(scene));
        return count_of(picture, [&](std::size_t i) { return shows_object(picture, i); });
    };
    const std::size_t flat = seen();
    EXPECT_GT(flat, 40u);
    scene.surface.earth_curvature = true;  // over the horizon, at 5 km, 20 km are another 17 m lower
    EXPECT_EQ(seen(), 0u);
    scene.objects[0].up_m = 17.0;
    EXPECT_GT(seen(), flat / 4);

    Scene storm = calm_scene();
    storm.sea.wind_speed_mps = 20.0;
    storm.camera.position_m = {0.0, -60.0, 8.0};
    storm.objects = {object(box({-3, -3, -30}, {3, 3, -20}))};
    const Picture below = picture_of(storm, options_of(storm));
    EXPECT_EQ(count_of(below, [&](std::size_t i) { return shows_object(below, i); }), 0u);
}

// All layers of light add up, nothing is nowhere, and threads are no matter.
TEST(Objects, AddUpOnAnyNumberOfThreads) {
    Scene scene = calm_scene();
    scene.sea.wind_speed_mps = 12.0;
    scene.water.body = true;
    scene.effects.spray = true;
    scene.camera.position_m = {0.0, -14.0, 2.5};
    scene.camera.look_at_m = {0.0, 0.0, 1.5};
    ObjectMaterial varnish{.name = "varnish", .colour = glm::vec3(0.6f, 0.2f, 0.1f), .roughness = 0.1f};
    scene.objects = {object(box({-4, -2, -1}, {4, 2, 2}, varnish), "hull"),
                     object(box({2, -1, 1}, {3, 1, 6}), "mast"),
                     object(box({-9, -1, -1}, {-6, 1, 2}), "raft"),
                     object(box({2.3f, -0.2f, 6.0f}, {2.7f, 0.2f, 6.4f}, kGlows), "lamp")};
    scene.objects[0].floats = scene.objects[2].floats = true;
    scene.objects[3].glow_cd_m2 = 1e6;
    scene.objects[0].caustics = 1.0;
    const Sky sky = daylight_sky({.sun_elevation_deg = 3.0, .sun_azimuth_deg = 80.0}, 64);
    std::vector<Picture> pictures;
    for (const int threads : {1, 2}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                        static_cast<std::size_t>(threads));
        pictures.push_back(picture_of(scene, options_of(scene, "all", 2), sky));
    }
    for (std::size_t layer = 0; layer < kPictureLayerCount; ++layer)
        EXPECT_EQ(pictures[0].data[layer].size(), pictures[1].data[layer].size());
    std::size_t reflected = 0;
    for (std::size_t i = 0; i < pictures[0].layers.size(); ++i) {
        const Picture& picture = pictures[0];
        ASSERT_EQ(std::memcmp(&picture.layers[i], &pictures[1].layers[i], sizeof(SeaRadiance)), 0);
        const glm::vec3 sum = light_of(picture, i),
                        reflection = vector_of(picture, PictureLayer::Reflection, i);
        const glm::vec3 parts =
            radiance_of(picture.layers[i]) + vector_of(picture, PictureLayer::Object, i) + reflection;
        reflected += reflection.y != 0.0f;
        for (int c = 0; c < 3; ++c) {
            ASSERT_TRUE(std::isfinite(sum[c]) && sum[c] >= 0.0f) << i;
            ASSERT_NEAR(parts[c], sum[c], 1e-5f * (1.0f + sum[c]));
        }
    }
    EXPECT_GT(reflected, 100u);
    for (std::size_t layer = 0; layer < kPictureLayerCount; ++layer) {
        const std::vector<float>&one = pictures[0].data[layer], &two = pictures[1].data[layer];
        ASSERT_FALSE(kPictureLayers[layer].of_objects && one.empty());
        if (one.empty()) continue;
        EXPECT_EQ(std::memcmp(one.data(), two.data(), one.size() * sizeof(float)), 0) << layer;
    }
}

// The light that waves mirror onto a side has the pattern of mirrored_sun.h, and the mean that it has without; it is the same in a part of the
// picture.
Scene scene_with_side() {
    Scene scene = calm_scene();
    scene.camera.resolution = {64, 32};
    scene.sea.wind_speed_mps = 3.0;
    scene.waves.cascades = {{60.0, 128}, {9.0, 128}};
    scene.camera.position_m = {0.0, -14.0, 2.0};
    scene.camera.look_at_m = {0.0, 0.0, 1.5};
    scene.objects = {object(box({-6, -1, -2}, {6, 1, 4}))};
    return scene;
}
TEST(Objects, HaveTheSunsPatternOnTheirSides) {
    Scene scene = scene_with_side();
    const Sky sky = sunny_sky(20.0, 260.0);
    double sum = 0.0, mean = 0.0, squares = 0.0;
    for (const int frame : {1, 40, 80, 120, 160, 200}) {
        const auto picture_with = [&](double caustics, RenderOptions options) {
            scene.objects[0].caustics = caustics;
            return picture_of(scene, options, sky, frame);
        };
        const RenderOptions options = options_of(scene, "all", 1);
        const Picture without = picture_with(0.0, options), with = picture_with(1.0, options);
        int count = 0;
        for (std::size_t i = 0; i < with.layers.size(); ++i) {
            const glm::vec3 more =
                vector_of(with, PictureLayer::Object, i) - vector_of(without, PictureLayer::Object, i);
            if (!shows_object(with, i)) {
                ASSERT_NEAR(static_cast<double>(more.y), 0.0, 1e-4);
                continue;
            }
            ++count;
            const auto light = static_cast<double>(vector_of(without, PictureLayer::Object, i).y);
            sum += static_cast<double>(more.y);
            mean += light;
            squares += static_cast<double>(more.y * more.y);
            ASSERT_TRUE(std::isfinite(more.y));
        }
        EXPECT_GT(count, 600);
        if (frame > 1) continue;
        RenderOptions part = options;
        part.region = PixelWindow{{10, 8}, {40, 24}};
        const Picture region = picture_with(1.0, part);
        for (int y = 0; y < 16; ++y)
            for (int x = 0; x < 30; ++x)
                EXPECT_EQ(
                    vector_of(region, PictureLayer::Object, static_cast<std::size_t>(30 * y + x)),
                    vector_of(with, PictureLayer::Object, static_cast<std::size_t>(64 * (y + 8) + x + 10)));
    }
    EXPECT_NEAR(sum / mean, 0.0, 0.02);
    EXPECT_GT(squares, 10.0);
}

// Nor does it have another mean where the wind's short waves are gone, and water has no body.
TEST(Objects, HaveTheSunsPatternOfTheWavesThatAreThere) {
    Scene scene = scene_with_side();
    scene.camera.resolution = {32, 16};
    scene.sea.wind_speed_mps = 8.0;
    scene.waves.band_gains = {{.from_m = 1e-4, .to_m = 1.0, .gain = 0.0}};
    const Sky sky = sunny_sky(5.0, 260.0);
    double more = 0.0, size = 0.0;
    for (const int frame : {1, 60, 120, 180}) {
        std::array<Picture, 2> pictures;
        for (const int on : {0, 1}) {
            scene.objects[0].caustics = on;
            pictures[static_cast<std::size_t>(on)] = picture_of(scene, options_of(scene), sky, frame);
        }
        for (std::size_t i = 0; i < pictures[0].layers.size(); ++i) {
            if (!shows_object(pictures[0], i)) continue;
            const auto of = static_cast<double>((vector_of(pictures[1], PictureLayer::Object, i) -
                                                 vector_of(pictures[0], PictureLayer::Object, i))
                                                    .y);
            more += of;
            size += std::abs(of);
        }
    }
    EXPECT_GT(size, 1.0);
    EXPECT_LT(std::abs(more), 0.5 * size) << size;
}

// It is as bright 100 km away, where a sea that repeats is the same; on any number of threads; and a holdout has none.
TEST(Objects, HaveTheSunsPatternFarOutAndBesideHoldouts) {
    Scene scene = scene_with_side();
    scene.waves.cascades = {{50.0, 128}, {10.0, 128}};
    scene.waves.tiling = Tiling::Periodic;
    scene.objects = {object(box({-6, -1, -2}, {2, 1, 4}), "hull"),
                     object(box({3, -1, -2}, {6, 1, 4}), "held")};
    scene.objects[1].holdout = true;
    const Sky sky = sunny_sky(20.0, 260.0);
    const auto picture_with = [&](double caustics, int threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                        static_cast<std::size_t>(threads));
        for (SceneObject& of : scene.objects) of.caustics = caustics;
        return picture_of(scene, options_of(scene), sky);
    };
    const Picture without = picture_with(0.0, 2), one = picture_with(1.0, 1), two = picture_with(1.0, 2);
    constexpr double kFar_m = 1e5;
    scene.camera.position_m.x += kFar_m;
    scene.camera.look_at_m.x += kFar_m;
    for (SceneObject& of : scene.objects) of.east_m += kFar_m;
    const Picture far = picture_with(1.0, 2);
    double differs = 0.0, pattern = 0.0;
    std::size_t held = 0;
    for (std::size_t i = 0; i < one.layers.size(); ++i) {
        ASSERT_EQ(light_of(one, i), light_of(two, i)) << i;
        if (!shows_object(without, i)) continue;
        const glm::vec3 of = vector_of(two, PictureLayer::Object, i);
        if (light_of(without, i) == glm::vec3(0.0f)) {
            ++held;
            ASSERT_EQ(light_of(two, i), glm::vec3(0.0f));
        }
        pattern += std::abs(static_cast<double>(of.y - vector_of(without, PictureLayer::Object, i).y));
        differs += std::abs(static_cast<double>(of.y - vector_of(far, PictureLayer::Object, i).y));
    }
    EXPECT_GT(held, 50u);
    EXPECT_GT(pattern, 10.0);
    EXPECT_LT(
        differs,
        0.3 * pattern);  // its texels lie otherwise over the waves: 0.11; of other waves it would be some 1.4
}

// Each has its planes, and one at a time is found.
TEST(Objects, CountTheSunsPatternInTheirMemory) {
    Scene scene = scene_with_side();
    const auto bytes = [&](std::size_t bodies, double caustics) {
        scene.objects.assign(bodies, scene.objects[0]);
        for (std::size_t i = 0; i < bodies; ++i) {
            scene.objects[i].name = "box " + std::to_string(i);
            scene.objects[i].caustics = caustics;
        }
        return render_memory(scene, options_of(scene), std::array{1}, {}, 1).bytes();
    };
    const auto of = [&](std::size_t bodies) { return bytes(bodies, 1.0) - bytes(bodies, 0.0); };
    EXPECT_EQ(of(1), MirroredSun::bytes() + MirroredSun::finding_bytes());
    EXPECT_EQ(of(5), 5 * MirroredSun::bytes() + MirroredSun::finding_bytes());
}

// A body that floats follows long waves: where it lies on the water it shows as much above it as in a calm.
TEST(Objects, FloatOnTheWaves) {
    Scene scene = calm_scene();
    scene.sea.wind_speed_mps = 14.0;
    scene.camera.resolution = {32, 24};
    scene.camera.position_m = {0.0, -30.0, 30.0};
    scene.objects = {object(box({-1, -1, -1}, {1, 1, 1}))};
    scene.objects[0].floats = true;
    const RenderOptions options = options_of(scene);
    std::vector<int> frames;
    for (int frame = 1; frame <= 241; frame += 24) frames.push_back(frame);
    Renderer renderer(scene, options, uniform_sky(), frames);
    float lowest = 1e9f, highest = -1e9f;
    for (const int frame : frames) {
        Picture picture;
        renderer.render(frame, picture);
        float top = -1e9f, water = 0.0f, near = 1e9f;
        for (std::size_t i = 0; i < picture.layers.size(); ++i) {
            const glm::vec3 at = vector_of(picture, PictureLayer::Position, i);
            if (shows_object(picture, i)) top = std::max(top, at.z);
            if (const float away = glm::length(glm::vec2(at)); picture.sea[i] && away < near) {
                near = away;
                water = at.z;
            }
        }
        ASSERT_LT(near, 3.0f);
        EXPECT_NEAR(top, water + 1.0f, 0.6f) << frame;
        lowest = std::min(lowest, top);
        highest = std::max(highest, top);
    }
    EXPECT_GT(highest - lowest, 1.0f);
}

// What Embree says that it takes, of a fine mesh that two bodies share and of a coarse one.
TEST(Objects, RaysHoldWhatIsSaid) {
    ObjectMeshData mesh{.points_m = {}, .triangles = {}, .normals = {}, .material = {}, .materials = {{}}};
    constexpr std::uint32_t kSide = 256;
    for (std::uint32_t y = 0; y <= kSide; ++y)
        for (std::uint32_t x = 0; x <= kSide; ++x)
            mesh.points_m.emplace_back(x, y, 3.0 * std::sin(0.1 * x) * std::sin(0.07 * y));
    for (std::uint32_t y = 0; y < kSide; ++y)
        for (std::uint32_t x = 0; x < kSide; ++x) {
            const std::uint32_t a = y * (kSide + 1) + x;
            for (const std::uint32_t corner : {a, a + 1, a + kSide + 2, a, a + kSide + 2, a + kSide + 1})
                mesh.triangles.push_back(corner);
        }
    mesh.normals.assign(mesh.triangles.size(), glm::vec3(0.0f, 0.0f, 1.0f));
    mesh.material.assign(mesh.triangles.size() / 3, 0);
    const auto fine = std::make_shared<const ObjectMesh>(std::move(mesh)),
               coarse = box({-1, -1, -1}, {1, 1, 1});
    for (const std::vector<const ObjectMesh*>& meshes :
         {std::vector{coarse.get()}, std::vector{fine.get(), fine.get()}}) {
        const auto rays = make_ray_scene(meshes);
        rays->place(std::vector(meshes.size(), glm::mat4x3(1.0f)));
        const std::size_t held = rays->bytes(), said = ray_scene_bytes(meshes);
        EXPECT_LE(held, said);
        EXPECT_GE(held, meshes.front() == fine.get() ? said / 3 : std::size_t{1});
    }
}

// The names' identifiers as the specification's own examples have them, and shares that are what the samples show.
TEST(Objects, HaveMattesByTheirNames) {
    EXPECT_EQ(murmur_hash(""), 0u);
    EXPECT_EQ(murmur_hash("hello"), 0x248bfa47u);
    EXPECT_EQ(murmur_hash("hello, world"), 0x149bbb7fu);
    EXPECT_EQ(murmur_hash("The quick brown fox jumps over the lazy dog"), 0x2e4ff723u);
    for (int i = 0; i < 4096; ++i) {
        const auto bits = std::bit_cast<std::uint32_t>(matte_id("object" + std::to_string(i)));
        const std::uint32_t exponent = bits >> 23 & 0xff;
        ASSERT_TRUE(exponent > 0 && exponent < 255);
    }
    Scene scene = calm_scene();
    scene.camera.position_m = {0.0, -20.0, 4.0};
    scene.objects = {object(box({-3, -1, -1}, {0, 1, 3}), "port"),
                     object(box({0, -1, -1}, {3, 1, 3}), "starboard")};
    const Picture picture = picture_of(scene, options_of(scene, "all", 4));
    std::map<float, double> shares;
    for (std::size_t i = 0; i < picture.layers.size(); ++i) {
        const float* const of = picture.data[index(PictureLayer::Cryptomatte)].data() + kMatteFloats * i;
        float sum = 0.0f;
        for (std::size_t rank = 0; rank < kMatteRanks; ++rank) {
            const float id = of[2 * rank], share = of[2 * rank + 1];
            sum += share;
            if (share > 0.0f) shares[id] += static_cast<double>(share);
            ASSERT_TRUE(rank == 0 || share <= of[2 * rank - 1]);
            ASSERT_TRUE(share > 0.0f || id == 0.0f);
        }
        ASSERT_LE(sum, 1.00001f);
    }
    EXPECT_EQ(shares.size(), 3u);
    EXPECT_GT(shares[matte_id("port")], 100.0);
    EXPECT_NEAR(shares[matte_id("port")], shares[matte_id("starboard")], 0.03 * shares[matte_id("port")]);
    EXPECT_GT(shares[matte_id("sea")], 1000.0);
}

// What lies in calm water is seen through its surface where Snell's law has it, as much as the water lets through; from in the water
// straight.
TEST(Objects, AreSeenThroughTheWater) {
    Scene scene = calm_scene();
    scene.water.body = true;
    scene.camera.fov_deg = 40.0;
    scene.camera.position_m = {0.0, -8.0, 10.0};
    const glm::dvec3 least(-2, -1.5, -2.5), most(2, 1.5, -1.5);
    scene.objects = {object(box(glm::vec3(least), glm::vec3(most), kGlows))};
    scene.objects[0].glow_cd_m2 = 1e5;
    const RenderOptions options = options_of(scene);
    Renderer renderer(scene, options, uniform_sky(), std::array{1});
    Picture picture;
    renderer.render(1, picture);
    const WaterBody water = make_water(scene);
    const View view = view_at(scene.camera, 1);
    int seen = 0, apart = 0;
    for (std::size_t i = 0; i < picture.layers.size(); ++i) {
        const glm::dvec3 towards = view.direction(middle_of(picture, i));
        const glm::dvec3 place = view.position_m - view.position_m.z / towards.z * towards;
        const glm::dvec3 refracted = glm::refract(towards, glm::dvec3(0.0, 0.0, 1.0), 1.0 / 1.34);
        const double distance = distance_to_box(place, refracted, least, most);
        const float shown = vector_of(picture, PictureLayer::Reflection, i).y;
        if ((distance < 1e9) != (shown > 10.0f)) {
            ++apart;
            continue;
        }
        if (distance > 1e9) continue;
        ++seen;
        const double left = static_cast<double>(water_lets_through(water, static_cast<float>(distance)).y);
        EXPECT_NEAR(shown, 100.0 * left * (1.0 - fresnel(-towards.z)) / (1.34 * 1.34), 1.0);
    }
    EXPECT_GT(seen, 300);
    EXPECT_LT(apart, 8);

    scene.camera.position_m = {0.0, -8.0, -2.0};
    scene.camera.look_at_m = {0.0, 0.0, -2.0};
    const Picture below = picture_of(scene, options);
    const auto middle = static_cast<std::size_t>(scene.camera.resolution.x) *
                            static_cast<std::size_t>(scene.camera.resolution.y / 2) +
                        static_cast<std::size_t>(scene.camera.resolution.x / 2);
    const double left = static_cast<double>(water_lets_through(water, 6.5f).y);
    EXPECT_NEAR(vector_of(below, PictureLayer::Object, middle).y, 100.0 * left / (1.34 * 1.34), 0.5);
    EXPECT_NEAR(number_of(below, PictureLayer::Depth, middle), 6.5f, 1e-3f);
}

// Motion vectors follow a body's path, and end where the next frame shows the same place of it.
TEST(Objects, MoveByTheirPath) {
    Scene scene = calm_scene();
    scene.camera.position_m = {0.0, -40.0, 6.0};
    scene.objects = {object(box({-4, -3, -1}, {5, 3, 5}))};
    scene.objects[0].path = "1 -10 0, 25 14 12";
    scene.objects[0].interpolation = CameraInterpolation::Linear;
    const RenderOptions options = options_of(scene);
    Renderer renderer(scene, options, uniform_sky(), std::array{8, 9});
    Picture now, next;
    renderer.render(8, now);
    renderer.render(9, next);
    const glm::dvec2 size(now.resolution);
    int looked_at = 0;
    for (std::size_t i = 0; i < now.layers.size(); ++i) {
        if (!shows_object(now, i)) continue;
        const float* const way = now.data[index(PictureLayer::Motion)].data() + 4 * i;
        const glm::dvec2 to = middle_of(now, i) + glm::dvec2(way[0], -way[1]);
        const auto pixel = static_cast<std::size_t>(to.y) * static_cast<std::size_t>(size.x) +
                           static_cast<std::size_t>(to.x);
        if (!shows_object(next, pixel)) continue;  // an edge
        ++looked_at;
        // A frame is 1 m to the east and half a metre to the north.
        const glm::vec3 went =
            vector_of(next, PictureLayer::Position, pixel) - vector_of(now, PictureLayer::Position, i);
        EXPECT_NEAR(went.x, 1.0f, 0.5f);  // a pixel is 0.4 m
        EXPECT_NEAR(went.y, 0.5f, 1.6f);  // on the deck one is longer
    }
    EXPECT_GT(looked_at, 250);
}

// The file says by which names: its header as a reader of mattes takes it.
TEST(Objects, HaveMattesInTheirFiles) {
    Scene scene = calm_scene();
    scene.camera.position_m = {0.0, -20.0, 4.0};
    scene.objects = {object(box({-3, -1, -1}, {3, 1, 3}), "a \"b\" \\ c")};
    const RenderOptions options = options_of(scene, "cryptomatte");
    const Sky sky = uniform_sky();
    const Picture picture = picture_of(scene, options, sky);
    const std::string path = testing::TempDir() + "objects_test.exr";
    {
        const std::string bytes = encode_exr({scene, options, sky, "", 1.0f}, picture, 1);
        std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    }
    const Imf::InputFile file(path.c_str());
    const auto text = [&](const std::string& name) {
        const auto* found = file.header().findTypedAttribute<Imf::StringAttribute>(name);
        return found ? found->value() : "none";
    };
    // murmur_hash("CryptoObject") begins so.
    EXPECT_EQ(text("cryptomatte/3ae39a5/name"), "CryptoObject");
    EXPECT_EQ(text("cryptomatte/3ae39a5/hash"), "MurmurHash3_32");
    EXPECT_EQ(text("cryptomatte/3ae39a5/conversion"), "uint32_to_float32");
    char body[9], sea[9];
    std::snprintf(body, sizeof(body), "%08x", std::bit_cast<std::uint32_t>(matte_id("a \"b\" \\ c")));
    std::snprintf(sea, sizeof(sea), "%08x", std::bit_cast<std::uint32_t>(matte_id("sea")));
    EXPECT_EQ(text("cryptomatte/3ae39a5/manifest"),
              std::string(R"({"a \"b\" \\ c":")") + body + R"(","sea":")" + sea + "\"}");
    // Identifiers come through the file to the last bit.
    const std::size_t pixels = picture.layers.size();
    std::vector<float> id(pixels), share(pixels);
    Imf::FrameBuffer buffer;
    const std::size_t row = sizeof(float) * static_cast<std::size_t>(picture.resolution.x);
    buffer.insert("CryptoObject00.r",
                  Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(id.data()), sizeof(float), row));
    buffer.insert("CryptoObject00.g",
                  Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(share.data()), sizeof(float), row));
    Imf::InputFile again(path.c_str());
    again.setFrameBuffer(buffer);
    again.readPixels(0, picture.resolution.y - 1);
    for (std::size_t i = 0; i < pixels; ++i) {
        const float* const expected =
            picture.data[index(PictureLayer::Cryptomatte)].data() + kMatteFloats * i;
        ASSERT_EQ(std::bit_cast<std::uint32_t>(id[i]), std::bit_cast<std::uint32_t>(expected[0]));
        ASSERT_EQ(share[i], expected[1]);
    }
    std::remove(path.c_str());
}

// A sphere of triangles with the normals of a round one: of few, unless told.
std::shared_ptr<const ObjectMesh> coarse_sphere(float radius, const glm::vec3& middle, int high_steps = 6,
                                                const ObjectMaterial& material = {.name = "white",
                                                                                  .colour = glm::vec3(0.8f),
                                                                                  .roughness = 1.0f}) {
    const int round_steps = high_steps == 6 ? 10 : 2 * high_steps;
    ObjectMeshData mesh;
    mesh.materials = {material};
    const auto at = [&](int row, int column) {
        const double high = kPi * row / high_steps, round = 2.0 * kPi * column / round_steps;
        return glm::vec3(
            glm::dvec3(std::sin(high) * std::cos(round), std::sin(high) * std::sin(round), std::cos(high)));
    };
    for (int row = 0; row < high_steps; ++row)
        for (int column = 0; column < round_steps; ++column)
            for (const auto& corners : {std::array{std::pair(row, column), std::pair(row + 1, column),
                                                   std::pair(row + 1, column + 1)},
                                        std::array{std::pair(row, column), std::pair(row + 1, column + 1),
                                                   std::pair(row, column + 1)}}) {
                if (corners[0] == corners[1] || (row == 0 && corners[2].first == 0) ||
                    (row == high_steps - 1 && corners[1].first == high_steps &&
                     corners[2].first == high_steps))
                    continue;
                for (const auto& [r, c] : corners) {
                    mesh.triangles.push_back(static_cast<std::uint32_t>(mesh.points_m.size()));
                    mesh.points_m.push_back(middle + radius * at(r, c));
                    mesh.normals.push_back(at(r, c));
                }
                mesh.material.push_back(0);
            }
    return std::make_shared<const ObjectMesh>(std::move(mesh));
}

// The shadow's edge on a coarse sphere is that of its normals: what they turn to the sun has it, also where its triangle faces away.
TEST(Objects, HaveTheShadowOfTheirSmoothNormals) {
    Scene scene = calm_scene();
    scene.camera.position_m = {0.0, -12.0, 6.0};
    scene.camera.look_at_m = {0.0, 0.0, 6.0};
    scene.camera.fov_deg = 24.0;
    scene.objects = {object(coarse_sphere(2.0f, {0, 0, 6}))};
    const Sky sky = sunny_sky(35.0, 0.0, 0.002f);
    const Picture picture = picture_of(scene, options_of(scene), sky);
    int sunny = 0, dark = 0, shadowed = 0, lit = 0;
    for (std::size_t i = 0; i < picture.layers.size(); ++i) {
        if (!shows_object(picture, i)) continue;
        const float height = glm::dot(vector_of(picture, PictureLayer::Normal, i), sky.sun_direction),
                    share = number_of(picture, PictureLayer::Shadow, i);
        if (height > 0.03f) ++sunny, dark += share < 0.5f;
        if (height < -0.25f) ++shadowed, lit += share > 0.5f;
    }
    EXPECT_GT(sunny, 500);
    EXPECT_GT(shadowed, 200);
    EXPECT_LE(dark, sunny / 100);
    EXPECT_LE(lit, shadowed / 100);
}

// Inside of a closed hull there is no light, whatever its walls would send on without walls round them.
TEST(Objects, AreDarkInTheirClosedHulls) {
    Scene scene = calm_scene();
    scene.camera.position_m = {0.0, -3.0, 4.0};
    scene.camera.look_at_m = {0.0, 3.0, 4.0};
    ObjectMaterial white;
    white.colour = glm::vec3(1.0f);
    scene.objects = {object(box({-6, -4, 2}, {6, 4, 7}, white))};
    const Picture picture = picture_of(scene, options_of(scene), sunny_sky(50.0, 90.0));
    for (std::size_t i = 0; i < picture.layers.size(); ++i) {
        ASSERT_TRUE(shows_object(picture, i));
        ASSERT_LT(light_of(picture, i).y, 1e-4f) << i;
    }
}

// What no body hides has no grain, though the sky isn't uniform; and where something is hidden few rays have the mean of many.
TEST(Objects, AreAsBrightByFewRaysAsByMany) {
    Scene scene = calm_scene();
    scene.camera.resolution = {48, 32};
    scene.camera.position_m = {0.0, -14.0, 7.8};
    scene.camera.look_at_m = {0.0, 0.0, 7.8};
    scene.camera.fov_deg = 12.0;
    ObjectMaterial rough{.name = "plaster", .colour = glm::vec3(0.7f), .roughness = 0.8f};
    // Behind the camera: the sea before the wall isn't in its shadow.
    const Sky sky = daylight_sky({.sun_elevation_deg = 30.0, .sun_azimuth_deg = 250.0}, 64);
    const auto object_light = [&](int samples, int frame) {
        const Picture picture = picture_of(scene, options_of(scene, "none", samples), sky, frame);
        return picture.data[index(PictureLayer::Object)];
    };
    scene.objects = {object(box({-9, -3, 5}, {9, 3, 16}, rough))};  // all of the picture
    const std::vector<float> one = object_light(1, 1), two = object_light(1, 2);
    double sum = 0.0, apart = 0.0;
    for (std::size_t i = 0; i < one.size(); ++i) {
        sum += static_cast<double>(one[i]);
        apart += static_cast<double>(std::abs(one[i] - two[i]));
    }
    EXPECT_GT(sum, 1.0);
    EXPECT_LT(apart, 0.015 * sum);  // what its varnish has

    // A roof over it, out of the picture, whose shadow it is in: no edge is to be seen.
    scene.objects.push_back(object(box({-9, -7, 9}, {9, -3, 10}, rough), "roof"));
    const auto mean = [](const std::vector<float>& of) {
        double all = 0.0;
        for (const float value : of) all += static_cast<double>(value);
        return all / static_cast<double>(of.size());
    };
    const double few = mean(object_light(1, 1)), many = mean(object_light(8, 1));
    EXPECT_NEAR(few, many, 0.01 * many);
}

// The shadow's layer is of one sample in the middle: it has as many steps with many samples a pixel as with one.
TEST(Objects, HaveShadowsAsFineWithManySamples) {
    Scene scene = calm_scene();
    scene.camera.position_m = {6.0, 0.0, 60.0};
    scene.camera.look_at_m = {6.0, 0.0, 0.0};
    scene.camera.fov_deg = 30.0;
    scene.objects = {object(box({-60, -40, 8}, {0, 40, 10}))};
    std::set<float> steps;
    const Picture picture = picture_of(scene, options_of(scene, "shadow", 3), sunny_sky(40.0, 180.0, 0.05f));
    for (const float share : picture.data[index(PictureLayer::Shadow)]) steps.insert(share);
    EXPECT_GE(steps.size(), 15u);
}

// Of seven bodies in a pixel the smallest is left out, in whatever order they come.
TEST(Objects, HaveTheirLargestMattesInAnyOrder) {
    std::array<int, 8> order{0, 1, 2, 3, 4, 5, 6, 7};
    const auto share_of = [](int body) { return 0.02f + 0.03f * static_cast<float>(body); };
    std::array<float, kMatteFloats> expected{};
    for (std::size_t rank = 0; rank < kMatteRanks; ++rank) {
        expected[2 * rank] = static_cast<float>(8 - rank);
        expected[2 * rank + 1] = share_of(7 - static_cast<int>(rank));
    }
    for (int turn = 0; turn < 50; ++turn) {
        std::array<float, kMatteFloats> ranks{};
        for (const int body : order) {
            const float id = static_cast<float>(body + 1);
            if (!add_to_ranks(ranks, id, share_of(body))) keep_in_ranks(ranks, id, share_of(body));
        }
        sort_ranks(ranks);
        ASSERT_EQ(ranks, expected);
        std::next_permutation(order.begin(), order.end());
        std::rotate(order.begin(), order.begin() + 3, order.end());
    }
    // Samples that take turns: each by itself is no more than any rank.
    Scene scene = calm_scene();
    scene.camera.resolution = {1, 1};
    scene.camera.position_m = {0.0, -20.0, 5.0};
    scene.camera.look_at_m = {0.0, 0.0, 5.0};
    scene.camera.fov_deg = 20.0;
    for (int i = 0; i < 8; ++i) {
        const float left = static_cast<float>(i) - 4.0f;
        scene.objects.push_back(object(box({left, -1, 0}, {left + 1.0f, 1, 10}), "post" + std::to_string(i)));
    }
    const auto ranks_of = [&] {
        return picture_of(scene, options_of(scene, "cryptomatte", 8)).data[index(PictureLayer::Cryptomatte)];
    };
    const std::vector<float> forwards = ranks_of();
    std::reverse(scene.objects.begin(), scene.objects.end());
    EXPECT_EQ(ranks_of(), forwards);
    EXPECT_GT(forwards[11], 0.0f);
}

// A holdout in the water is black with alpha 0, seen from in there.
TEST(Objects, AsHoldoutsAreLeftOutUnderWater) {
    Scene scene = calm_scene();
    scene.water.body = true;
    scene.camera.position_m = {0.0, -8.0, -2.0};
    scene.camera.look_at_m = {0.0, 0.0, -2.0};
    scene.objects = {object(box({-2, -1.5, -2.5}, {2, 1.5, -1.5}, kGlows))};
    scene.objects[0].glow_cd_m2 = 1e5;
    scene.objects[0].holdout = true;
    RenderOptions options = options_of(scene);
    options.alpha = true;
    const Picture picture = picture_of(scene, options);
    std::size_t out = 0;
    for (std::size_t i = 0; i < picture.layers.size(); ++i) {
        ASSERT_EQ(vector_of(picture, PictureLayer::Object, i), glm::vec3(0.0f));
        if (picture.alpha[i] > 0.0f) continue;
        ++out;
        ASSERT_EQ(light_of(picture, i), glm::vec3(0.0f));
        ASSERT_NEAR(number_of(picture, PictureLayer::Depth, i), 6.5f, 3.0f);
    }
    EXPECT_GT(out, 100u);
}

// Water is kept out of a hull by what lies in it as well: two bodies that lie in one another.
TEST(Objects, KeepTheWaterOutWithALoad) {
    Scene scene = calm_scene();
    scene.camera.position_m = {0.0, -6.0, 12.0};
    scene.camera.look_at_m = {0.0, 0.0, 0.0};
    scene.camera.fov_deg = 40.0;
    scene.objects = {object(boxes({{{-3, -2, -1}, {3, 2, 1}, kTop}}, {}), "hull"),
                     object(box({-1.5, -1, -0.9f}, {1.5, 1, -0.4f}), "load")};
    const Picture picture = picture_of(scene, options_of(scene));
    std::size_t load = 0;
    for (std::size_t i = 0; i < picture.layers.size(); ++i) {
        const glm::vec3 at = vector_of(picture, PictureLayer::Position, i);
        if (std::abs(at.x) > 2.9f || std::abs(at.y) > 1.9f) continue;
        ASSERT_FALSE(picture.sea[i]) << at.x << ' ' << at.y;
        load += std::abs(at.z + 0.4f) < 1e-3f;
    }
    EXPECT_GT(load, 100u);
}

// A body that floats in a pool lies as high as that one's water rests there, and not as its mean.
TEST(Objects, FloatOnACageWhereItIsHigh) {
    Scene scene = calm_scene();
    CageMesh pool;
    for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x)
            pool.points_m.emplace_back(10.0 * x, 10.0 * y, x == 1 ? 4.0 : 1.0 + 0.5 * x);
    for (int y = 0; y < 2; ++y)
        for (int x = 0; x < 2; ++x) {
            const std::int32_t first = 3 * y + x;
            pool.face_counts.push_back(4);
            for (const std::int32_t corner : {first, first + 1, first + 4, first + 3})
                pool.indices.push_back(corner);
        }
    scene.surface.kind = SurfaceKind::Cage;
    scene.surface.beyond = Beyond::Nothing;
    scene.surface.cage = std::make_shared<const Cage>(std::move(pool));
    scene.camera.position_m = {6.0, -14.0, 12.0};
    scene.camera.look_at_m = {6.0, 0.0, 2.0};
    scene.camera.fov_deg = 40.0;
    scene.objects = {object(box({-1, -1, -0.5f}, {1, 1, 1}))};
    scene.objects[0].floats = true;
    scene.objects[0].east_m = 6.0;
    const Picture picture = picture_of(scene, options_of(scene));
    float top = -1e9f, water = 0.0f, near = 1e9f;
    for (std::size_t i = 0; i < picture.layers.size(); ++i) {
        const glm::vec3 at = vector_of(picture, PictureLayer::Position, i);
        if (shows_object(picture, i)) top = std::max(top, at.z);
        if (const float away = glm::length(glm::vec2(at) - glm::vec2(6.0f, 0.0f));
            picture.sea[i] && away < near) {
            near = away;
            water = at.z;
        }
    }
    ASSERT_LT(near, 2.0f);
    EXPECT_NEAR(top, water + 1.0f, 0.35f);  // the surface leans
}

// Suns straight above and in the horizon, and a shutter that is open: finite, and of all of the sun's light no more than there is.
TEST(Objects, AreFiniteInAnyLightAndMotion) {
    Scene scene = calm_scene();
    scene.camera.resolution = {48, 32};
    scene.sea.wind_speed_mps = 9.0;
    scene.water.body = true;
    scene.camera.position_m = {0.0, -14.0, 2.5};
    scene.camera.look_at_m = {0.0, 0.0, 1.5};
    scene.objects = {
        object(boxes({{{-4, -2, -1}, {4, 2, 2}, kTop}}, {.name = "varnish", .roughness = 0.0f}), "hull"),
        object(coarse_sphere(1.0f, {5, 0, 0.5f}), "ball")};
    scene.objects[0].path = "1 -10 0, 25 14 12";
    scene.objects[1].floats = true;
    for (const double elevation : {90.0, 0.0, -0.2}) {
        RenderOptions options = options_of(scene, "all", 2);
        options.shutter_frames = elevation == 0.0 ? 0.5 : 0.0;
        const Sky sky = sunny_sky(elevation, 10.0);
        const Picture picture = picture_of(scene, options, sky, 10);
        std::size_t seen = 0;
        for (std::size_t i = 0; i < picture.layers.size(); ++i) {
            const glm::vec3 light = light_of(picture, i);
            ASSERT_TRUE(std::isfinite(light.x + light.y + light.z)) << elevation;
            ASSERT_GE(light.y, -1e-4f);
            seen += vector_of(picture, PictureLayer::Object, i).y > 0.0f;
        }
        EXPECT_GT(seen, 100u);
        for (const std::vector<float>& layer : picture.data)
            for (const float value : layer) ASSERT_TRUE(std::isfinite(value));
    }
    // As a run that is stopped: at once, and the next picture is whole.
    const RenderOptions options = options_of(scene);
    Renderer renderer(scene, options, uniform_sky(), std::array{10});
    Picture stopped, whole, again;
    renderer.render(10, whole);
    const std::atomic<bool> stop = true;
    EXPECT_THROW(renderer.render(10, stopped, {.cancel = &stop}), BuildCancelled);
    renderer.render(10, again);
    EXPECT_EQ(again.data[index(PictureLayer::Object)], whole.data[index(PictureLayer::Object)]);
}

// Without light of its own.
Sky dark_sky() {
    Sky sky = uniform_sky();
    sky.map = SkyMap(4, std::vector<glm::vec3>(16, glm::vec3(0.0f)));
    sky.sky_irradiance = glm::vec3(0.0f);
    return sky;
}

// Bodies on a calm sea, as pictures have them.
struct LitScene {
    explicit LitScene(const Scene& scene, const Sky& sky)
        : plan(picture_plan(scene, std::array{1})),
          sea(plan, render_options(scene).lighting, sky, {}),
          objects(scene) {
        sea.set(0.0);
        objects.place(sea.frame(), 1.0, {.rest_m = [](glm::dvec2) { return 0.0; }});
        objects.light(sea);
    }
    Plan plan;
    SeaLight<float> sea;
    LitObjects objects;
};

// What rough facets mirror of lamps, by places on these and few rays, is what very many rays find; the few alone scatter much more, and
// show single bright pixels.
TEST(Lamps, GlitterWithoutBiasAndWithoutSparks) {
    Scene scene = calm_scene();
    // A lantern, and a dimmer red light that stands apart on the same body.
    auto mesh = boxes(
        {{{-0.4f, 29.6f, 7.6f}, {0.4f, 30.4f, 8.4f}}, {{5.0f, 29.8f, 3.0f}, {5.4f, 30.2f, 3.4f}}}, kGlows);
    ObjectMeshData data = mesh->data();
    data.materials.push_back(
        {.name = "red", .colour = glm::vec3(0.0f), .roughness = 1.0f, .glow = {0.5f, 0.02f, 0.01f}});
    for (std::size_t i = data.material.size() / 2; i < data.material.size(); ++i) data.material[i] = 1;
    scene.objects = {object(std::make_shared<const ObjectMesh>(std::move(data)))};
    scene.objects[0].glow_cd_m2 = 1e6;
    const LitScene lit(scene, uniform_sky());
    const LitObjects& objects = lit.objects;
    struct Case {
        glm::vec3 place, eye;
        float variance;
    };
    const LightingChoice choice{.whitecaps = false};
    // Seen from near and far, ripples and waves; and a mirror, which rays show.
    for (const auto& [place, eye, variance] :
         {Case{{0, 10, 0}, {0, -30, 6}, 0.02f}, Case{{3, 0, 0}, {0, -30, 6}, 0.05f},
          Case{{-3, -10, 0}, {0, -30, 6}, 0.06f}, Case{{1, 20, 0}, {0, -2000, 90}, 0.02f},
          Case{{0.5f, 8.5f, 0}, {0, -6, 6}, 0.0005f}, Case{{0.1f, 7.2f, 0}, {0, -15, 7.8f}, 1e-6f}}) {
        const SeaPoint point{.to_eye = glm::normalize(eye - place),
                             .slope_variance = {variance, 0.7f * variance, 0.1f * variance},
                             .slope_variance_at_rest = {variance, 0.7f * variance, 0.1f * variance}};
        const SeaFacets facets(choice, lit.sea.sky(), point);
        const auto by_rays = [&](const LitObjects::LampsInSea& lamps, std::uint32_t count,
                                 const SampleNumbers& numbers, bool all) {
            const SampleNumbers::Places places = numbers.places(77);
            glm::dvec3 sum(0.0);
            for (std::uint32_t k = 0; k < count; ++k) {
                glm::vec2 at = places.of(k, count);
                at.x = (static_cast<float>(k) + at.x) / static_cast<float>(count);
                const MirroredLight mirrored = facets.mirrored(at, count);
                if (!(mirrored.weight > 0.0f)) continue;
                const Ray ray{.from = lamps.place, .towards = mirrored.from};
                if (const RayHit hit = objects.nearest(ray); hit.is_hit()) {
                    const auto [light, part] = objects.lamp_met(lamps, ray, hit);
                    sum += glm::dvec3(mirrored.weight * (all ? 1.0f : part) * light);
                }
            }
            return sum;
        };
        constexpr std::uint32_t kRays = 64, kMany = 1 << 20, kPixels = 1500;
        const LitObjects::LampsInSea none = objects.lamps_in(facets, place, kRays, {});
        const glm::dvec3 expected = by_rays(none, kMany, {}, true);
        ASSERT_GT(expected.x, 0.0) << variance << ' ' << place.y;
        glm::dvec3 mean(0.0);
        double squares = 0.0, squares_of_rays = 0.0;
        std::vector<double> values;
        for (std::uint32_t pixel = 0; pixel < kPixels; ++pixel) {
            const SampleNumbers numbers{.x = pixel};
            const LitObjects::LampsInSea lamps = objects.lamps_in(facets, place, kRays, numbers);
            ASSERT_GT(lamps.count, 0u);
            const glm::dvec3 value =
                glm::dvec3(objects.mirrored_places(lamps, numbers)) + by_rays(lamps, kRays, numbers, false);
            mean += value / static_cast<double>(kPixels);
            values.push_back(value.x);
            squares += (value.x - expected.x) * (value.x - expected.x);
            const double rays = by_rays(lamps, kRays, numbers, true).x;
            squares_of_rays += (rays - expected.x) * (rays - expected.x);
        }
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(mean[c], expected[c], 0.02 * expected[c]) << c << ' ' << variance;
        // A mirror's rays have nearly none.
        EXPECT_LT(squares, std::max(squares_of_rays, kPixels * 4e-4 * expected.x * expected.x)) << variance;
        if (variance < 0.01f) continue;
        EXPECT_LT(4.0 * squares, squares_of_rays) << variance;
        std::sort(values.begin(), values.end());
        EXPECT_LT(values.back(), 10.0 * values[kPixels / 2]) << variance;
    }
}

// A ball of light: E = π L (r/d)² cos θ, however near. Behind a wall it is dark, and what is in the water lights nothing above it.
TEST(Lamps, LightWhatIsBelowThemByTheirDistance) {
    Scene scene = calm_scene();
    constexpr float kRadius = 0.5f, kHeight = 4.0f, kLight = 1000.0f;
    scene.objects = {object(coarse_sphere(kRadius, {0, 0, kHeight}, 48, kGlows)),
                     object(box({-20, 30, -1}, {20, 31, 40}), "wall")};
    scene.objects.push_back(object(coarse_sphere(kRadius, {0, 0, -3}, 6, kGlows), "in the water"));
    for (const std::size_t lamp : {0u, 2u})
        scene.objects[lamp].glow_cd_m2 = 1000.0 * static_cast<double>(kLight);
    const LitScene lit(scene, dark_sky());
    const auto irradiance = [&](const glm::vec3& place, const glm::vec3& normal) {
        glm::dvec3 sum(0.0);
        for (std::uint32_t pixel = 0; pixel < 500; ++pixel)
            sum += glm::dvec3(lit.objects.lamplight(place, normal, {.x = pixel})) / 500.0;
        return sum.y;
    };
    for (const glm::vec3& place : {glm::vec3(0, 0, 0), glm::vec3(3, 0, 0), glm::vec3(12, -9, 0),
                                   glm::vec3(100, 0, 0), glm::vec3(0, 0.3f, 3)})
        for (const glm::vec3& normal : {glm::vec3(0, 0, 1), glm::normalize(glm::vec3(-0.3f, 0.1f, 1))}) {
            const glm::dvec3 way = glm::dvec3(0, 0, kHeight) - glm::dvec3(place);
            const double d = glm::length(way);
            const double expected =
                kPi * kLight * kRadius * kRadius / (d * d) * glm::dot(way, glm::dvec3(normal)) / d;
            EXPECT_NEAR(irradiance(place, normal), expected, 0.02 * expected) << place.x << ' ' << place.y;
        }
    EXPECT_EQ(irradiance({0, 40, 0}, {0, 0, 1}), 0.0);
    EXPECT_EQ(irradiance({0, 0, 9}, {0, 0, 1}), 0.0);
    EXPECT_EQ(irradiance({0, 0, 2}, {0, 0, -1}), 0.0);
}

// The same in pictures: a diffuse floor under its varnish, and the water, which sends back of a lamp what it does of the sky.
TEST(Lamps, LightBodiesAndTheSea) {
    Scene scene = calm_scene();
    scene.water.body = true;
    scene.camera.position_m = {0.0, -14.0, 9.0};
    scene.camera.look_at_m = {0.0, 0.0, 0.0};
    scene.camera.fov_deg = 35.0;
    constexpr float kRadius = 0.4f, kLight = 1000.0f;
    const glm::dvec3 centre(0.0, 1.0, 12.0);
    scene.objects = {object(coarse_sphere(kRadius, glm::vec3(centre), 32, kGlows), "lamp")};
    scene.objects[0].glow_cd_m2 = 1000.0 * static_cast<double>(kLight);
    const auto beam = [&](const glm::dvec3& place) {
        const double d = glm::length(centre - place);
        return kPi * kLight * kRadius * kRadius / (d * d);
    };
    const RenderOptions options = options_of(scene);
    const Picture by_lamp = picture_of(scene, options, dark_sky());
    Scene without = scene;
    without.objects.clear();
    const Picture by_sky = picture_of(without, options_of(without), uniform_sky());
    double shown = 0.0, expected = 0.0;
    for (std::size_t i = 0; i < by_lamp.layers.size(); ++i) {
        if (!by_lamp.sea[i]) continue;
        const glm::dvec3 place(vector_of(by_lamp, PictureLayer::Position, i));
        shown += static_cast<double>(by_lamp.layers[i].sea.y);
        expected += static_cast<double>(by_sky.layers[i].sea.y) * beam(place) * (centre.z - place.z) /
                    glm::length(centre - place) / (kPi * static_cast<double>(kSkyRadiance));
    }
    EXPECT_GT(expected, 1.0);
    EXPECT_NEAR(shown, expected, 0.02 * expected);

    // Foam, by the slopes that are resolved.
    Scene windy = scene;
    windy.sea.wind_speed_mps = 16.0;
    windy.objects[0].mesh = coarse_sphere(kRadius, glm::vec3(centre), 32, kGlows);
    const Picture foam_by_lamp = picture_of(windy, options_of(windy), dark_sky());
    windy.objects.clear();
    const Picture foam_by_sky = picture_of(windy, options_of(windy), uniform_sky());
    shown = expected = 0.0;
    for (std::size_t i = 0; i < foam_by_lamp.layers.size(); ++i) {
        if (!foam_by_lamp.sea[i]) continue;
        const glm::dvec3 place(vector_of(foam_by_lamp, PictureLayer::Position, i)),
            normal(vector_of(foam_by_lamp, PictureLayer::Normal, i));
        shown += static_cast<double>(foam_by_lamp.layers[i].foam.y);
        expected += static_cast<double>(foam_by_sky.layers[i].foam.y) * beam(place) *
                    std::max(glm::dot(normal, glm::normalize(centre - place)), 0.0) /
                    (kPi * static_cast<double>(kSkyRadiance));
    }
    EXPECT_GT(expected, 0.1);
    EXPECT_NEAR(shown, expected, 0.05 * expected);

    const ObjectMaterial plaster{.name = "plaster", .colour = glm::vec3(0.6f), .roughness = 1.0f};
    scene.objects.push_back(object(box({-20, -12, -1}, {20, 20, 0.5f}, plaster), "floor"));
    const Picture on_floor = picture_of(scene, options_of(scene), dark_sky());
    shown = expected = 0.0;
    double brightest = 0.0;  // over what it should be
    for (std::size_t i = 0; i < on_floor.layers.size(); ++i) {
        const glm::dvec3 place(vector_of(on_floor, PictureLayer::Position, i));
        if (!shows_object(on_floor, i) || std::abs(place.z - 0.5) > 1e-3) continue;
        const glm::vec3 to_eye(glm::normalize(scene.camera.position_m - place)), normal(0.0f, 0.0f, 1.0f);
        Sky lamp = dark_sky();
        lamp.sun_direction = glm::vec3(glm::normalize(centre - place));
        lamp.sun_angular_radius = 0.01f;
        lamp.sun_radiance = glm::vec3(static_cast<float>(beam(place) / (kPi * 1e-4)));
        const float varnish =
                        object_of_sun({.colour = glm::vec3(0.0f), .roughness = 1.0f}, lamp, to_eye, normal).y,
                    passed = 1.0f - object_reflectance(to_eye.z, 1.0f);
        const double seen = static_cast<double>(vector_of(on_floor, PictureLayer::Object, i).y),
                     said = static_cast<double>(varnish) +
                            static_cast<double>(passed * 0.6f * lamp.sun_direction.z) * beam(place) / kPi;
        shown += seen;
        expected += said;
        brightest = std::max(brightest, seen / said);
    }
    EXPECT_LT(brightest, 3.0);
    EXPECT_GT(expected, 1.0);
    EXPECT_NEAR(shown, expected, 0.02 * expected);
}

}  // namespace
}  // namespace pelagic
