// Bodies of a scene: meshes that are refused, their content, and where they are at a frame.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <memory>
#include <numbers>

#include "core/scene/object_pose.h"

namespace pelagic {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

ObjectMeshData triangle() {
    const glm::vec3 up(0.0f, 0.0f, 1.0f);
    return {.points_m = {{0.0f, 0.0f, 0.0f}, {2.0f, 0.0f, 0.0f}, {0.0f, 1.0f, -0.5f}},
            .triangles = {0, 1, 2},
            .normals = {up, up, up},
            .material = {0},
            .materials = {{.name = "paint"}}};
}

std::string refusal(const std::function<void(ObjectMeshData&)>& change) {
    ObjectMeshData data = triangle();
    change(data);
    try {
        ObjectMesh mesh(std::move(data));
    } catch (const std::invalid_argument& error) {
        return error.what();
    }
    return "";
}

TEST(ObjectMesh, HasABoxOfItsTriangles) {
    ObjectMeshData data = triangle();
    data.points_m.emplace_back(100.0f);  // of none
    const ObjectMesh mesh(data, {"a note"});
    EXPECT_EQ(mesh.least_m(), glm::dvec3(0.0, 0.0, -0.5));
    EXPECT_EQ(mesh.most_m(), glm::dvec3(2.0, 1.0, 0.0));
    EXPECT_GE(mesh.bytes(), 4 * sizeof(glm::vec3) + 3 * sizeof(glm::vec3) + 3 * 4 + 2);
    EXPECT_EQ(mesh.notes(), std::vector<std::string>{"a note"});
}

TEST(ObjectMesh, RefusesWhatIsNone) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_NE(refusal([](auto& m) { m.triangles.pop_back(); }).find("2 corners"), std::string::npos);
    EXPECT_NE(refusal([](auto& m) { m.triangles.clear(); }).find("no triangles"), std::string::npos);
    EXPECT_NE(refusal([](auto& m) { m.triangles[1] = 3; }).find("has the point 3; accepted: 0 … 2"),
              std::string::npos);
    EXPECT_NE(refusal([](auto& m) { m.points_m.clear(); }).find("accepted: 0 … -1"), std::string::npos);
    EXPECT_NE(refusal([](auto& m) { m.normals.pop_back(); }).find("2 normals"), std::string::npos);
    EXPECT_NE(refusal([](auto& m) { m.normals[1] *= 1.01f; }).find("corner 1 has another length"),
              std::string::npos);
    EXPECT_NE(refusal([&](auto& m) { m.normals[2].x = nan; }).find("corner 2 has another length"),
              std::string::npos);
    EXPECT_NE(refusal([](auto& m) { m.material.push_back(0); }).find("of 2 triangles"), std::string::npos);
    EXPECT_NE(refusal([](auto& m) { m.material[0] = 1; }).find("has the material 1"), std::string::npos);
    EXPECT_NE(refusal([](auto& m) { m.materials.clear(); }).find("0 materials"), std::string::npos);
    EXPECT_NE(refusal([&](auto& m) { m.points_m[2].y = nan; }).find("point 2 is outside"), std::string::npos);
    EXPECT_NE(refusal([](auto& m) { m.points_m[0].x = 2e6f; }).find("point 0 is outside"), std::string::npos);
    EXPECT_NE(refusal([](auto& m) { m.materials[0].roughness = -0.1f; }).find("\"paint\" has a number"),
              std::string::npos);
    EXPECT_NE(refusal([](auto& m) {
                  m.points_m[2] = {1.0f, 0.0f, 0.0f};
              }).find("has an area"),
              std::string::npos);
}

TEST(ObjectMesh, ContentIsAllThatIsInIt) {
    const std::string content = ObjectMesh(triangle()).content();
    EXPECT_EQ(content.size(), 16u);
    EXPECT_EQ(ObjectMesh(triangle(), {"a note"}).content(), content);
    const std::function<void(ObjectMeshData&)> changes[]{
        [](auto& m) { m.points_m[1].y = 0.25f; },
        [](auto& m) {
            m.triangles = {1, 2, 0};
        },
        [](auto& m) {
            m.normals[0] = {0.0f, 1.0f, 0.0f};
        },
        [](auto& m) { m.materials.push_back({}); },
        [](auto& m) { m.materials.push_back({}), m.material[0] = 1; },
        [](auto& m) { m.materials[0].name = "rust"; },
        [](auto& m) { m.materials[0].colour.z = 0.5f; },
        [](auto& m) { m.materials[0].roughness = 0.25f; },
        [](auto& m) { m.materials[0].glow.x = 1.0f; },
    };
    std::vector<std::string> seen{content};
    for (const auto& change : changes) {
        ObjectMeshData data = triangle();
        change(data);
        seen.push_back(ObjectMesh(data).content());
        for (std::size_t i = 0; i + 1 < seen.size(); ++i) EXPECT_NE(seen[i], seen.back());
    }
}

// ---- Pictures

constexpr std::uint16_t kHalfOne = 0x3c00;

std::shared_ptr<const ObjectImage> checker(int width, int height) {
    std::vector<std::uint16_t> rgb;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) rgb.insert(rgb.end(), 3, (x + y) % 2 == 0 ? kHalfOne : 0);
    return std::make_shared<const ObjectImage>(width, height, std::move(rgb));
}

TEST(ObjectImage, IsBetweenTexelsAndLevelsAndRepeats) {
    const auto image = checker(4, 2);
    ASSERT_EQ(image->levels().size(), 3u);
    EXPECT_EQ(image->levels()[1].width, 2);
    EXPECT_EQ(image->levels()[1].height, 1);
    EXPECT_EQ(image->mean(), glm::vec3(0.5f));
    for (const float shift : {-7.0f, 0.0f, 1.0f, 4096.0f}) {
        EXPECT_EQ(image->colour({shift + 0.125f, 0.25f}, 0.0f), glm::vec3(1.0f));  // texels' middles
        EXPECT_EQ(image->colour({shift + 0.375f, shift + 0.25f}, -1.0f), glm::vec3(0.0f));
        EXPECT_EQ(image->colour({shift + 0.1875f, 0.25f}, 0.0f), glm::vec3(0.75f));
        EXPECT_EQ(image->colour({shift, 0.25f}, 0.0f), glm::vec3(0.5f));  // between the last and the first
        EXPECT_EQ(image->colour({0.125f, shift + 0.25f}, 0.5f),
                  glm::vec3(0.75f));  // and a level that is grey
    }
    EXPECT_EQ(image->colour({0.3f, 0.1f}, 1e9f), glm::vec3(0.5f));
    // One texel is all there is; whatever the place.
    const ObjectImage red(1, 1, {kHalfOne, 0, 0});
    for (const glm::vec2 at : {glm::vec2(0.0f), glm::vec2(0.99999994f), glm::vec2(-1e4f, 1e4f)})
        EXPECT_EQ(red.colour(at, 0.5f), glm::vec3(1.0f, 0.0f, 0.0f));
}

// Levels of odd sides keep it too: their texels are of equal size, and the last is all of it.
TEST(ObjectImage, KeepsItsMean) {
    for (const auto& [width, height] : std::vector<std::pair<int, int>>{{5, 3}, {7, 1}, {1, 9}, {31, 17}}) {
        std::vector<std::uint16_t> rgb;
        double sum = 0.0;
        for (int i = 0; i < width * height; ++i) {
            const bool is_white = i * i % 7 < 3;
            rgb.insert(rgb.end(), 3, is_white ? kHalfOne : 0);
            sum += is_white;
        }
        const ObjectImage image(width, height, std::move(rgb));
        // A half float's rounding at each of at most five levels.
        EXPECT_NEAR(image.mean().y, sum / (width * height), 5 * 0x1p-12) << width << ' ' << height;
    }
}

TEST(ObjectImage, RefusesWhatIsNone) {
    const auto refused = [](int width, int height, std::vector<std::uint16_t> rgb) {
        try {
            const ObjectImage image(width, height, std::move(rgb));
        } catch (const std::invalid_argument& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_NE(refused(0, 1, {}).find("a picture of 0 x 1 texels; accepted: 1 … 16384 a side"),
              std::string::npos);
    EXPECT_NE(refused(1, 20000, {}).find("accepted: 1 … 16384"), std::string::npos);
    EXPECT_NE(refused(1, 1, {0, 0}).find("has 2 numbers; accepted: 3"), std::string::npos);
    for (const int bits : {0x3c01, 0x7c00, 0x7e00, 0x8001, 0xfe00})  // above 1, infinite, none, below 0
        EXPECT_NE(
            refused(1, 1, {0, static_cast<std::uint16_t>(bits), 0}).find("has a number outside the range"),
            std::string::npos);
    EXPECT_NE(refusal([](auto& m) { m.materials[0].image = 0; }).find("has the picture 0"),
              std::string::npos);
    EXPECT_NE(refusal([](auto& m) {
                  m.images = {checker(2, 2)}, m.materials[0].image = 0;
              }).find("has the picture 0"),
              std::string::npos);
    EXPECT_NE(refusal([](auto& m) { m.image_at.resize(2); }).find("2 places in pictures"), std::string::npos);
    EXPECT_NE(refusal([](auto& m) {
                  m.image_at.resize(3, glm::vec2(std::nanf("")));
              }).find("of corner 0 is outside"),
              std::string::npos);
}

TEST(ObjectImage, CountsInAMeshsContentAndBytes) {
    const auto mesh = [](const std::shared_ptr<const ObjectImage>& image, float at = 0.0f) {
        ObjectMeshData data = triangle();
        data.images = {image};
        data.image_at.assign(3, glm::vec2(at));
        data.materials[0].image = 0;
        return ObjectMesh(std::move(data));
    };
    const std::string content = mesh(checker(4, 2)).content();
    EXPECT_NE(content, ObjectMesh(triangle()).content());
    EXPECT_EQ(content, mesh(checker(4, 2)).content());
    EXPECT_NE(content, mesh(checker(2, 4)).content());
    EXPECT_NE(content, mesh(checker(4, 2), 0.5f).content());
    EXPECT_NE(mesh(std::make_shared<const ObjectImage>(1, 1, std::vector<std::uint16_t>{0, 0, 0})).content(),
              mesh(std::make_shared<const ObjectImage>(1, 1, std::vector<std::uint16_t>{0, 1, 0})).content());
    EXPECT_GE(mesh(checker(64, 64)).bytes(), 64u * 64u * 6u * 4u / 3u);
}

// ---- Poses

double heading_deg(const ObjectPose& pose) {
    return std::atan2(pose.turn[0].y, pose.turn[0].x) / kDegree;
}

void expect_near(glm::dvec3 value, glm::dvec3 wanted, double within = 1e-12) {
    EXPECT_LE(glm::length(value - wanted), within) << value.x << ' ' << value.y << ' ' << value.z;
}

TEST(ObjectPose, StandsWhereItIsPut) {
    const SceneObject object{.east_m = 3.0, .north_m = -4.0, .up_m = 1.5, .heading_deg = 90.0, .scale = 2.0};
    for (const double frame : {-7.0, 1.0, 3.25}) {
        const ObjectPose pose = object_pose(Scene{}, object, frame);
        EXPECT_EQ(pose.place_m, glm::dvec3(3.0, -4.0, 1.5));
        EXPECT_EQ(pose.scale, 2.0);
        expect_near(pose.turn[0], {0.0, 1.0, 0.0});
        expect_near(pose.turn[1], {-1.0, 0.0, 0.0});
        expect_near(pose.turn[2], {0.0, 0.0, 1.0});
    }
}

TEST(ObjectPose, PitchesItsBowUpAndRollsToStarboard) {
    const ObjectPose pitched = object_pose(Scene{}, {.pitch_deg = 30.0}, 1.0);
    expect_near(pitched.turn[0], {std::cos(30.0 * kDegree), 0.0, 0.5});
    expect_near(pitched.turn[1], {0.0, 1.0, 0.0});
    const ObjectPose rolled = object_pose(Scene{}, {.roll_deg = 30.0}, 1.0);
    expect_near(rolled.turn[0], {1.0, 0.0, 0.0});
    expect_near(rolled.turn[1], {0.0, std::cos(30.0 * kDegree), 0.5});  // port up
    const glm::dmat3 turn =
        object_pose(Scene{}, {.heading_deg = 200.0, .pitch_deg = -35.0, .roll_deg = 70.0}, 1.0).turn;
    EXPECT_NEAR(glm::determinant(turn), 1.0, 1e-12);
    const glm::dmat3 square = glm::transpose(turn) * turn;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) EXPECT_NEAR(square[i][j], i == j ? 1.0 : 0.0, 1e-12);
    // Rolling leaves its own x alone; pitching first, then heading.
    expect_near(turn[0], {std::cos(200.0 * kDegree) * std::cos(35.0 * kDegree),
                          std::sin(200.0 * kDegree) * std::cos(35.0 * kDegree), -std::sin(35.0 * kDegree)});
}

TEST(ObjectPose, GoesWhereAVesselOfThatPathGoes) {
    Scene scene;
    scene.shot.fps = 25.0;
    scene.shot.time_scale = 0.5;
    scene.shot.time_offset_s = 100.0;
    for (const CameraInterpolation interpolation :
         {CameraInterpolation::Smooth, CameraInterpolation::Linear}) {
        scene.waves.vessels = {{}, {.path = "1 0 0, 20 40 10, 50 60 50", .interpolation = interpolation}};
        const SceneObject moored{.vessel = 2, .east_m = -5.0, .north_m = 1.0};
        const SceneObject free{.path = scene.waves.vessels[1].path,
                               .interpolation = interpolation,
                               .east_m = -5.0,
                               .north_m = 1.0};
        for (double frame = -4.0; frame < 60.0; frame += 0.75) {
            const ObjectPose a = object_pose(scene, moored, frame), b = object_pose(scene, free, frame);
            expect_near(a.place_m, b.place_m, 1e-9);
            for (int i = 0; i < 3; ++i) expect_near(a.turn[i], b.turn[i], 1e-9);
        }
    }
    // Keys are met, and before and after it goes on.
    const SceneObject straight{.path = "1 0 0, 11 20 0"};
    expect_near(object_pose(scene, straight, 11.0).place_m, {20.0, 0.0, 0.0});
    expect_near(object_pose(scene, straight, 16.0).place_m, {30.0, 0.0, 0.0});
    expect_near(object_pose(scene, straight, -4.0).place_m, {-10.0, 0.0, 0.0});
    // The camera's clock goes on where the sea's stands.
    scene.shot.time_scale = 0.0;
    expect_near(object_pose(scene, straight, 6.0).place_m, {10.0, 0.0, 0.0});
}

TEST(ObjectPose, OffsetsAreAlongItsCourseAndToPort) {
    const SceneObject object{
        .path = "1 0 0, 11 0 20", .east_m = 3.0, .north_m = 2.0, .up_m = 0.5, .heading_deg = 180.0};
    const ObjectPose pose = object_pose(Scene{}, object, 6.0);
    expect_near(pose.place_m, {-2.0, 13.0, 0.5});
    expect_near(pose.turn[0], {0.0, -1.0, 0.0});  // it goes astern
}

TEST(ObjectPose, OfOnePlaceStandsThere) {
    for (const char* path : {"12 5 6", "1 5 6, 10 5 6, 30 5 6"}) {
        const SceneObject object{.path = path, .east_m = 1.0, .heading_deg = 90.0};
        for (const double frame : {-3.0, 1.0, 12.0, 25.5, 90.0}) {
            const ObjectPose pose = object_pose(Scene{}, object, frame);
            expect_near(pose.place_m, {6.0, 6.0, 0.0});
            expect_near(pose.turn[0], {0.0, 1.0, 0.0});
        }
    }
}

// Its place has a continuous velocity, and its bow is where that goes.
TEST(ObjectPose, TurnsSmoothlyWithItsVelocity) {
    const SceneObject object{.path = "1 0 0, 20 40 10, 40 50 40, 70 20 70, 90 -10 60"};
    constexpr double kStep = 1e-4;
    const auto place = [&](double frame) { return object_pose(Scene{}, object, frame).place_m; };
    const auto velocity = [&](double frame) {
        return (place(frame + kStep) - place(frame - kStep)) / (2.0 * kStep);
    };
    double before_deg = heading_deg(object_pose(Scene{}, object, -5.0));
    glm::dvec3 velocity_before = velocity(-5.0);
    for (double frame = -4.95; frame < 100.0; frame += 0.05) {
        const ObjectPose pose = object_pose(Scene{}, object, frame);
        const glm::dvec3 now = velocity(frame);
        EXPECT_LE(glm::length(now - velocity_before), 0.05 * 0.4)
            << frame;  // the largest acceleration times the step
        EXPECT_GE(glm::dot(glm::normalize(now), pose.turn[0]), 1.0 - 1e-9) << frame;
        const double turned_deg = std::remainder(heading_deg(pose) - before_deg, 360.0);
        EXPECT_LE(std::abs(turned_deg), 1.0) << frame;
        before_deg = heading_deg(pose), velocity_before = now;
    }
}

// It comes, stands and leaves another way: no step forth and back, and it turns while it stands.
TEST(ObjectPose, StandsStillWithoutWobbling) {
    for (const CameraInterpolation interpolation :
         {CameraInterpolation::Smooth, CameraInterpolation::Linear}) {
        const SceneObject object{.path = "1 0 0, 20 40 0, 40 40 0, 45 40 0, 60 40 30, 61 40 30",
                                 .interpolation = interpolation};
        double before_deg = 0.0;
        for (double frame = -3.0; frame <= 80.0; frame += 0.01) {
            const ObjectPose pose = object_pose(Scene{}, object, frame);
            if (frame > 20.0 && frame < 45.0) expect_near(pose.place_m, {40.0, 0.0, 0.0});
            if (frame > 61.0) expect_near(pose.place_m, {40.0, 30.0, 0.0});
            EXPECT_LE(pose.place_m.x, 40.0 + 1e-12);
            EXPECT_LE(pose.place_m.y, 30.0 + 1e-12);
            const double now_deg = heading_deg(pose);
            EXPECT_LE(std::abs(now_deg - before_deg), 0.1)
                << frame;  // 90° over 25 frames, at most 1.5 times as fast
            before_deg = now_deg;
        }
        EXPECT_NEAR(heading_deg(object_pose(Scene{}, object, 19.999)), 0.0, 1e-6);
        EXPECT_NEAR(heading_deg(object_pose(Scene{}, object, 32.5)), 45.0, 1e-9);
        EXPECT_NEAR(heading_deg(object_pose(Scene{}, object, 80.0)), 90.0, 1e-9);
    }
    // The shorter way round, and to where it will go first.
    const SceneObject back{.path = "1 0 0, 5 0 0, 20 -40 -1, 40 -40 -1, 60 -80 0"};
    EXPECT_NEAR(heading_deg(object_pose(Scene{}, back, 2.0)), heading_deg(object_pose(Scene{}, back, 5.01)),
                0.1);
    EXPECT_LT(std::abs(heading_deg(object_pose(Scene{}, back, 30.0))), 180.0 + 1e-9);
    EXPECT_GT(std::abs(heading_deg(object_pose(Scene{}, back, 30.0))), 175.0);
}

}  // namespace
}  // namespace pelagic
