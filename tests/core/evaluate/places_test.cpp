// The search for the point at rest below a place: it ends there, in any company, and where the sea folds it
// stays finite.
#include "core/evaluate/places.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/core/waves/samples.h"

namespace pelagic {
namespace {

using namespace test;

template <class T>
Frame<T> sea_of(double choppiness, double footprint_m) {
    Scene scene;
    scene.sea.wind_speed_mps = 15.0;
    scene.waves.choppiness = choppiness;
    scene.waves.cascades = {{.size_m = 250.0, .resolution = 256}, {.size_m = 31.0, .resolution = 128}};
    return frame_of<T>(scene, {filtered(products(Displacement), footprint_m)}, 2.5);
}

template <class T>
struct Found {
    std::vector<glm::vec<2, T>> rest_m;
    std::vector<T> residual_m;
};
template <class T>
Found<T> find(const Frame<T>& frame, const std::vector<glm::vec<2, T>>& places, glm::dvec2 origin_m = {},
              const PlaceSearch& search = {}) {
    Found<T> found{std::vector<glm::vec<2, T>>(places.size()), std::vector<T>(places.size())};
    const PreparedQuery<T> query(frame, 0, products(Displacement), origin_m);
    find_rest(query, Points<T>{.origin_m = origin_m, .count = places.size(), .rest_m = {places.data()}},
              search, {found.rest_m.data()}, {found.residual_m.data()});
    return found;
}

// By evaluating where the search ended.
template <class T>
double farthest_off_m(const Frame<T>& frame, const std::vector<glm::vec<2, T>>& places,
                      const Found<T>& found) {
    Values values;
    QueryRunner<T>().run(frame, 0, Points<T>{.count = places.size(), .rest_m = {found.rest_m.data()}},
                         values);
    const auto displacement = std::move(values).vectors(Displacement);
    double farthest_m = 0.0;
    for (std::size_t i = 0; i < places.size(); ++i)
        farthest_m = std::max(farthest_m, glm::length(glm::dvec2(found.rest_m[i]) +
                                                      glm::dvec2(displacement[i]) - glm::dvec2(places[i])));
    return farthest_m;
}

TEST(Places, ThePointAtRestIsDisplacedToThePlace) {
    const auto frame = sea_of<double>(1.0, 1.0);
    const auto places = random_points<double>(400.0, 3000);
    const auto found = find(frame, places, {}, {.tolerance_m = 1e-6});
    // The sum of displacements is evaluated in double and narrowed to float by QueryRunner: 1e-7 of metres.
    EXPECT_LT(farthest_off_m(frame, places, found), 3e-6);
    EXPECT_LE(*std::max_element(found.residual_m.begin(), found.residual_m.end()), 1e-6);
    // It had something to do: the sea moves its points by more than that.
    double moved_m = 0.0;
    for (std::size_t i = 0; i < places.size(); ++i)
        moved_m = std::max(moved_m, glm::length(found.rest_m[i] - places[i]));
    EXPECT_GT(moved_m, 0.5);
}

TEST(Places, SinglePrecisionReachesAMillimetre) {
    const auto frame = sea_of<float>(1.0, 1.0);
    const auto places = random_points<float>(400.0, 3000);
    EXPECT_LT(farthest_off_m(frame, places, find(frame, places)), 1.1e-3);
}

TEST(Places, APlaceIsTheSameAloneAndInCompany) {
    const auto frame = sea_of<float>(1.3, 0.5);
    const auto places = random_points<float>(300.0, 777);
    const auto together = find(frame, places);
    for (const std::size_t i : {0, 1, 127, 128, 500, 776}) {
        const auto alone = find(frame, std::vector{places[i]});
        EXPECT_EQ(alone.rest_m[0], together.rest_m[i]);
        EXPECT_EQ(alone.residual_m[0], together.residual_m[i]);
    }
}

// With four times the choppiness of a steep sea, much of the surface has folded over.
TEST(Places, WhereTheSurfaceFoldsTheAnswerIsFiniteAndNear) {
    const auto frame = sea_of<float>(4.0, 0.25);
    const auto places = random_points<float>(400.0, 3000);
    const auto found = find(frame, places);
    std::size_t reached = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
        EXPECT_TRUE(std::isfinite(found.rest_m[i].x) && std::isfinite(found.rest_m[i].y));
        EXPECT_TRUE(std::isfinite(found.residual_m[i]));
        reached += found.residual_m[i] <= 1e-3f ? 1 : 0;
    }
    EXPECT_GT(reached, places.size() * 8 / 10);
}

TEST(Places, ACalmSeaIsItsOwnRest) {
    Scene scene;
    scene.sea.wind_speed_mps = 0.0;
    const auto frame = frame_of<float>(scene, {filtered(products(Displacement), 1.0)});
    const auto places = random_points<float>(100.0, 50);
    EXPECT_EQ(find(frame, places).rest_m, places);
    EXPECT_TRUE(find(frame, std::vector<glm::vec2>()).rest_m.empty());
}

// Far away, places are relative to an origin in double.
TEST(Places, AnOriginStandsForFarPlaces) {
    const auto frame = sea_of<float>(1.0, 1.0);
    const auto places = random_points<float>(100.0, 200);
    const auto found = find(frame, places, {2e6, -3e6});
    EXPECT_LE(*std::max_element(found.residual_m.begin(), found.residual_m.end()), 1e-3f);
}

}  // namespace
}  // namespace pelagic
