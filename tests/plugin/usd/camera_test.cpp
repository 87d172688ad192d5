// The camera that USD is told of.
#include "plugin/usd/camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace pelagic::usd {
namespace {

// A few roundings of unit vectors, each 2^-53.
constexpr double kTolerance = 1e-15;

TEST(UsdCamera, IsARightHandedRotationThatLooksAtItsTarget) {
    const CameraKey key{.frame = 1, .position_m = {3.0, -60.0, 4.0}, .look_at_m = {-10.0, 20.0, -1.0}};
    const auto [right, up, back, position] = camera_matrix(key).rows;
    EXPECT_EQ(position, key.position_m);
    for (const glm::dvec3& axis : {right, up, back}) EXPECT_NEAR(glm::length(axis), 1.0, kTolerance);
    EXPECT_NEAR(glm::length(glm::cross(right, up) - back), 0.0, kTolerance);
    // The target lies on −z, at its distance.
    const glm::dvec3 target = position - glm::distance(key.position_m, key.look_at_m) * back;
    EXPECT_NEAR(glm::distance(target, key.look_at_m), 0.0, 100.0 * kTolerance);  // about 80 m away
    // The horizon is level, and z is up in the picture.
    EXPECT_EQ(right.z, 0.0);
    EXPECT_GT(up.z, 0.0);
}

TEST(UsdCamera, LooksAlongYWithoutATurnAboutTheViewAxis) {
    const auto [right, up, back, position] = camera_matrix({1, {0, -5, 2}, {0, 5, 2}}).rows;
    EXPECT_EQ(right, glm::dvec3(1, 0, 0));
    EXPECT_EQ(up, glm::dvec3(0, 0, 1));
    EXPECT_EQ(back, glm::dvec3(0, -1, 0));
}

TEST(UsdCamera, LookingAlongZHasYUp) {
    EXPECT_EQ(camera_matrix({1, {1, 2, 90}, {1, 2, 0}}).rows[1], glm::dvec3(0, 1, 0));
    EXPECT_EQ(camera_matrix({1, {1, 2, 0}, {1, 2, 90}}).rows[1], glm::dvec3(0, 1, 0));
}

TEST(UsdCamera, OnItsOwnTargetIsRefused) {
    EXPECT_THROW(camera_matrix({1, {1, 2, 3}, {1, 2, 3}}), std::invalid_argument);
}

TEST(UsdCamera, KeysAreLinearBetweenAndConstantOutside) {
    const std::vector<CameraKey> keys{{10, {0, 0, 0}, {0, 8, 0}}, {14, {4, 8, 12}, {0, 16, 0}}};
    EXPECT_EQ(key_at(keys, 11).position_m, glm::dvec3(1, 2, 3));
    EXPECT_EQ(key_at(keys, 11).look_at_m, glm::dvec3(0, 10, 0));
    EXPECT_EQ(key_at(keys, 10).position_m, keys[0].position_m);
    EXPECT_EQ(key_at(keys, 14).position_m, keys[1].position_m);
    EXPECT_EQ(key_at(keys, -100).look_at_m, keys[0].look_at_m);
    EXPECT_EQ(key_at(keys, 100).look_at_m, keys[1].look_at_m);
    // The whole range of an int apart.
    const std::vector<CameraKey> far{{std::numeric_limits<int>::min(), {0, 0, 0}, {0, 1, 0}},
                                     {std::numeric_limits<int>::max(), {1, 0, 0}, {0, 1, 0}}};
    EXPECT_NEAR(key_at(far, 0).position_m.x, 0.5, 1e-9);  // 2^-32 beside the middle
}

TEST(UsdCamera, KeysThatDontRiseOrArentFiniteAreRefused) {
    EXPECT_THROW(check(std::vector<CameraKey>{}), std::invalid_argument);
    EXPECT_THROW(check(std::vector<CameraKey>{{2, {}, {}}, {2, {}, {}}}), std::invalid_argument);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(check(std::vector<CameraKey>{{1, {0, nan, 0}, {}}}), std::invalid_argument);
    EXPECT_NO_THROW(check(std::vector<CameraKey>{{1, {}, {}}, {2, {}, {}}}));
}

TEST(UsdCamera, FilmSeesTheFieldOfViewAndHasThePicturesShape) {
    for (const double fov_deg : {1.0, 50.0, 90.0, 179.0}) {
        const FilmBack film = film_back({.fov_deg = fov_deg, .resolution = {1920, 800}});
        const double seen_rad = 2.0 * std::atan(0.5 * film.horizontal_aperture / film.focal_length);
        EXPECT_NEAR(seen_rad, fov_deg * std::numbers::pi / 180.0, 1e-14);  // roundings of angles below π
        EXPECT_DOUBLE_EQ(film.vertical_aperture / film.horizontal_aperture, 800.0 / 1920.0);
    }
    EXPECT_THROW(film_back({.fov_deg = 180.0}), std::invalid_argument);
    EXPECT_THROW(film_back({.fov_deg = std::numeric_limits<double>::quiet_NaN()}), std::invalid_argument);
    EXPECT_THROW(film_back({.resolution = {0, 1}}), std::invalid_argument);
}

}  // namespace
}  // namespace pelagic::usd
