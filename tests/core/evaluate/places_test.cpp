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
std::vector<double> distances_off_m(const Frame<T>& frame, const std::vector<glm::vec<2, T>>& places,
                                    const Found<T>& found) {
    Values values;
    QueryRunner<T>().run(frame, 0, Points<T>{.count = places.size(), .rest_m = {found.rest_m.data()}},
                         values);
    const auto& displacement = values.vectors(Displacement);
    std::vector<double> off_m;
    for (std::size_t i = 0; i < places.size(); ++i)
        off_m.push_back(
            glm::length(glm::dvec2(found.rest_m[i]) + glm::dvec2(displacement[i]) - glm::dvec2(places[i])));
    return off_m;
}
template <class T>
double farthest_off_m(const Frame<T>& frame, const std::vector<glm::vec<2, T>>& places,
                      const Found<T>& found) {
    const auto off_m = distances_off_m(frame, places, found);
    return *std::max_element(off_m.begin(), off_m.end());
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

// With four times the choppiness of a steep sea, much of the surface has folded over. Plain iteration (r = p − D(r))
// loses a quarter of these places.
TEST(Places, WhereTheSurfaceFoldsTheAnswerIsFiniteAndNear) {
    const auto frame = sea_of<float>(4.0, 0.25);
    const auto places = random_points<float>(400.0, 3000);
    const auto found = find(frame, places);
    std::size_t reached = 0;
    for (const float residual_m : found.residual_m) reached += residual_m <= 1e-3f ? 1 : 0;
    EXPECT_GT(reached, places.size() * 98 / 100);
    // What is said of the others is true: a place's residual is how far off its answer is.
    const auto off_m = distances_off_m(frame, places, found);
    for (std::size_t i = 0; i < places.size(); ++i)
        EXPECT_NEAR(off_m[i], static_cast<double>(found.residual_m[i]), 2e-4) << i;
    EXPECT_LT(*std::max_element(found.residual_m.begin(), found.residual_m.end()), 3.0f);
}

// Each place is looked for with its own footprint, whichever others have been found before.
TEST(Places, EachPlaceHasItsFootprint) {
    Scene scene;
    scene.waves.cascades = {{.size_m = 60.0, .resolution = 128}};
    Query query = unfiltered(products(Displacement));
    query.cell_m = query.pixel_m = {0.5, 1.0, 2.0, 4.0, 8.0};
    const auto frame = frame_of<float>(scene, {query}, 1.0);
    const auto places = random_points<float>(50.0, 300);
    std::vector<float> cell_m;
    for (std::size_t i = 0; i < places.size(); ++i) cell_m.push_back(0.5f + 0.03f * static_cast<float>(i));
    std::vector<glm::vec2> together(places.size()), alone(places.size());
    const PreparedQuery<float> prepared(frame, 0, products(Displacement));
    const auto search = [&](std::size_t first, std::size_t count, glm::vec2* rest_m) {
        find_rest(prepared,
                  Points<float>{.count = count, .rest_m = {&places[first]}, .cell_m = {&cell_m[first]}}, {},
                  {rest_m}, Strided<float>{});
    };
    search(0, places.size(), together.data());
    for (std::size_t i = 0; i < places.size(); ++i) search(i, 1, &alone[i]);
    EXPECT_EQ(together, alone);
    EXPECT_NE(together, find(frame, places).rest_m);  // whose footprint is the finest
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
