// The surface above a point: no sheet of it is missed, whatever the sea, and its height is that of the surface.
#include "core/evaluate/surface_above.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/core/waves/samples.h"

namespace pelagic {
namespace {

using namespace test;

constexpr double kCell_m = 0.5;
constexpr double kFar_m = 1000.0;  // below every wave

Scene sea_of(WaveModel model, double choppiness) {
    Scene scene;
    scene.sea.wind_speed_mps = 15.0;
    scene.waves.model = model;
    scene.waves.choppiness = choppiness;
    if (model == WaveModel::Fft)
        scene.waves.cascades = {{.size_m = 250.0, .resolution = 256}, {.size_m = 31.0, .resolution = 128}};
    return scene;
}

template <class T>
Frame<T> frame_of_model(WaveModel model, double choppiness) {
    return frame_of<T>(sea_of(model, choppiness), {filtered(products(Position), kCell_m)}, 2.5);
}

// Where points at rest go.
template <class T>
std::vector<glm::dvec3> displaced(const Frame<T>& frame, const std::vector<glm::vec<2, T>>& rest,
                                  glm::dvec2 origin_m = {}) {
    std::vector<glm::vec<3, T>> positions(rest.size());
    Results<T> results;
    results.set(Product::Position, {positions.data()});
    evaluate(frame, 0, Points<T>{.origin_m = origin_m, .count = rest.size(), .rest_m = {rest.data()}},
             results);
    std::vector<glm::dvec3> world;
    for (const auto& p : positions) world.push_back(glm::dvec3(p) + glm::dvec3(origin_m, 0.0));
    return world;
}

class EachModel : public testing::TestWithParam<WaveModel> {};

TEST_P(EachModel, APointOfTheSurfaceIsUnderItByLessThanACentimetreAndOverItByAsMuch) {
    const auto frame = frame_of_model<double>(GetParam(), 0.5);  // nothing folds
    for (const glm::dvec2 origin_m : {glm::dvec2(0.0), glm::dvec2(1e6, -3e6)})
        for (const glm::dvec3 p : displaced(frame, random_points<double>(300.0, 10), origin_m)) {
            const auto above = surface_above(frame, 0, p - glm::dvec3(0.0, 0.0, 0.01), kCell_m);
            ASSERT_TRUE(above);
            EXPECT_NEAR(*above, p.z, 1e-4);
            EXPECT_FALSE(surface_above(frame, 0, p + glm::dvec3(0.0, 0.0, 0.01), kCell_m));
            const auto from_below = surface_above(frame, 0, p - glm::dvec3(0.0, 0.0, kFar_m), kCell_m);
            ASSERT_TRUE(from_below);
            EXPECT_NEAR(*from_below, p.z, 1e-4);
        }
}

TEST_P(EachModel, NoSheetOfAFoldedSeaIsMissed) {
    const auto frame = frame_of_model<float>(GetParam(), 10.0);
    const auto rest = random_points<float>(300.0, 40);
    int folded = 0;
    for (const glm::dvec3 p : displaced(frame, rest)) {
        const auto highest = surface_above(frame, 0, p - glm::dvec3(0.0, 0.0, kFar_m), kCell_m);
        ASSERT_TRUE(highest);
        EXPECT_GE(*highest, p.z - 1e-3);
        folded += *highest > p.z + 1e-2;
        // What lies over the highest sheet is in the air, and what is under it isn't.
        EXPECT_FALSE(surface_above(frame, 0, glm::dvec3(p.x, p.y, *highest + 1e-3), kCell_m));
        const auto again = surface_above(frame, 0, glm::dvec3(p.x, p.y, *highest - 1e-2), kCell_m);
        ASSERT_TRUE(again);
        EXPECT_NEAR(*again, *highest, 1e-3);
    }
    EXPECT_GT(folded, 3);  // otherwise this has shown nothing
}

INSTANTIATE_TEST_SUITE_P(SurfaceAbove, EachModel, testing::Values(WaveModel::Fft, WaveModel::Trochoid),
                         [](const auto& model) { return model.param == WaveModel::Fft ? "fft" : "trains"; });

TEST(SurfaceAbove, ACalmSeaLiesAtZero) {
    Scene scene;
    scene.sea.wind_speed_mps = 0.0;
    const auto frame = frame_of<float>(scene, {filtered(products(Position), kCell_m)}, 0.0);
    EXPECT_EQ(surface_above(frame, 0, {5.0, 7.0, -0.01}, kCell_m), 0.0);
    EXPECT_FALSE(surface_above(frame, 0, {5.0, 7.0, 0.0}, kCell_m));
    EXPECT_FALSE(surface_above(frame, 0, {5.0, 7.0, 0.01}, kCell_m));
}

TEST(SurfaceAbove, AQueryWithoutPositionsIsRefused) {
    const auto frame = frame_of<float>(Scene(), {filtered(products(Product::Normal), kCell_m)}, 0.0);
    EXPECT_THROW(surface_above(frame, 0, {0.0, 0.0, 0.0}, kCell_m), std::invalid_argument);
}

}  // namespace
}  // namespace pelagic
