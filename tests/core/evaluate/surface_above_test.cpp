// The surface above a point: no sheet of it is missed, whatever the sea, and its height is that of the surface.
#include "core/evaluate/surface_above.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

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

// ---- find_highest_rest()

struct Highest {
    std::vector<glm::vec2> rest_m;
    std::vector<float> residual_m, height_m;
};
Highest highest(const Frame<float>& frame, const std::vector<glm::vec2>& places, glm::dvec2 origin_m = {},
                bool alone = false) {
    const std::size_t n = places.size();
    Highest found{std::vector<glm::vec2>(n), std::vector<float>(n), std::vector<float>(n)};
    const BoundsByLevel<float> bounds(frame, 0);
    const PreparedQuery<float> query(frame, 0, products(Displacement), origin_m);
    Points<float> points{.origin_m = origin_m, .count = n, .rest_m = {places.data()}};
    find_highest_rest(bounds, query, points, {}, {found.rest_m.data()}, {found.residual_m.data()}, alone);
    points.rest_m = {found.rest_m.data()};
    std::vector<glm::vec3> displacement_m(n);
    Results<float> results;
    results.set(Displacement, {displacement_m.data()});
    query.evaluate(points, results);
    for (std::size_t i = 0; i < n; ++i) found.height_m[i] = displacement_m[i].z;
    return found;
}
Frame<float> frame_for_places(WaveModel model, double choppiness) {
    return frame_of<float>(sea_of(model, choppiness), {filtered(products(Displacement), kCell_m)}, 2.5);
}

// The greatest height over each place of a mesh that is finer than every wave, and how many of its sheets lie there.
struct MeshHeights {
    std::vector<double> highest_m;
    std::vector<int> sheets;
};
MeshHeights of_fine_mesh(const Frame<float>& frame, const std::vector<glm::vec2>& places, double half_m) {
    constexpr double kSpacing_m = 0.1;
    const auto side = static_cast<std::size_t>(2.0 * half_m / kSpacing_m) + 1;
    std::vector<glm::vec2> rest;
    for (std::size_t j = 0; j < side; ++j)
        for (std::size_t i = 0; i < side; ++i) rest.emplace_back(kSpacing_m * glm::dvec2(i, j) - half_m);
    std::vector<glm::vec3> moved(rest.size());
    Results<float> results;
    results.set(Displacement, {moved.data()});
    evaluate(frame, 0, Points<float>{.count = rest.size(), .rest_m = {rest.data()}}, results);
    MeshHeights mesh{std::vector<double>(places.size(), -kFar_m), std::vector<int>(places.size())};
    const auto at = [&](std::size_t k) { return glm::dvec3(moved[k]) + glm::dvec3(rest[k], 0.0); };
    const auto add = [&](std::size_t ka, std::size_t kb, std::size_t kc) {
        const glm::dvec3 a = at(ka), b = at(kb), c = at(kc);
        const glm::dvec3 low = glm::min(a, glm::min(b, c)), high = glm::max(a, glm::max(b, c));
        for (std::size_t i = 0; i < places.size(); ++i) {
            const glm::dvec2 p(places[i]);
            if (p.x < low.x || p.y < low.y || p.x > high.x || p.y > high.y) continue;
            const auto cross = [](glm::dvec3 u, glm::dvec3 v, glm::dvec2 w) {
                return (v.x - u.x) * (w.y - u.y) - (v.y - u.y) * (w.x - u.x);
            };
            const double of_a = cross(b, c, p), of_b = cross(c, a, p), of_c = cross(a, b, p),
                         all = of_a + of_b + of_c;
            if (all == 0.0 || of_a / all < 0.0 || of_b / all < 0.0 || of_c / all < 0.0) continue;
            mesh.highest_m[i] = std::max(mesh.highest_m[i], (of_a * a.z + of_b * b.z + of_c * c.z) / all);
            ++mesh.sheets[i];
        }
    };
    for (std::size_t k = 0; k + side < rest.size(); ++k) {
        if (k % side + 1 == side) continue;
        add(k, k + 1, k + side);
        add(k + 1, k + side + 1, k + side);
    }
    return mesh;
}

TEST_P(EachModel, TheHeightAtAPlaceIsThatOfTheHighestSheetOfAFineMesh) {
    for (const double choppiness : {1.0, 10.0}) {
        const auto frame = frame_for_places(GetParam(), choppiness);
        const auto places = random_points<float>(20.0, 200);
        const Highest found = highest(frame, places);
        const MeshHeights mesh = of_fine_mesh(frame, places, 40.0);
        const auto several =
            std::count_if(mesh.sheets.begin(), mesh.sheets.end(), [](int n) { return n > 1; });
        if (choppiness > 1.0)
            EXPECT_GT(several, 10);
        else
            EXPECT_LT(several, 5);  // rounding at an edge
        for (std::size_t i = 0; i < places.size(); ++i) {
            // Beside an edge of a fold the mesh, or the millimetre, ends on the other side of it.
            EXPECT_LE(found.residual_m[i], 1e-3f) << i;
            EXPECT_NEAR(static_cast<double>(found.height_m[i]), mesh.highest_m[i],
                        choppiness > 1.0 ? 0.1 : 0.02)
                << "choppiness " << choppiness << ", place " << i;
        }
    }
}

TEST_P(EachModel, TheHighestOfAFoldedSeaIsThatOfTheWholeSearch) {
    const auto frame =
        frame_of<float>(sea_of(GetParam(), 10.0), {filtered(products(Displacement, Position), kCell_m)}, 2.5);
    const auto places = random_points<float>(300.0, 60, 5);
    const Highest found = highest(frame, places);
    for (std::size_t i = 0; i < places.size(); ++i) {
        const auto whole = surface_above(frame, 0, glm::dvec3(glm::dvec2(places[i]), -kFar_m), kCell_m);
        ASSERT_TRUE(whole);
        EXPECT_NEAR(static_cast<double>(found.height_m[i]), *whole, 0.03) << i;
    }
}

TEST_P(EachModel, APlaceHasTheSameHighestAloneAndInCompany) {
    const auto frame = frame_for_places(GetParam(), 6.0);
    const auto places = random_points<float>(300.0, 200);
    const Highest together = highest(frame, places), by_one_thread = highest(frame, places, {}, true);
    EXPECT_EQ(together.rest_m, by_one_thread.rest_m);
    for (const std::size_t i : {0, 17, 150, 199})
        EXPECT_EQ(highest(frame, {places[i]}).rest_m[0], together.rest_m[i]);
    EXPECT_TRUE(highest(frame, {}).rest_m.empty());
    const Highest far = highest(frame, places, {2e6, -3e6});
    EXPECT_LE(*std::max_element(far.residual_m.begin(), far.residual_m.end()), 1e-3f);
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

// Long waves of a finger's depth of water go aside by a hundred times their height, and nobody's hero is 50 m high there:
// its trains go aside by half a kilometre within a metre. The bounds exclude nothing, and the search ends all the same.
TEST(SurfaceAbove, ASeaThatGoesAsideByHundredsOfItsWavelengthsIsSearchedToAnEnd) {
    Scene scene;
    scene.sea.depth_m = 0.01;
    scene.waves.cascades = {{.size_m = 3.0, .resolution = 36}};
    scene.waves.heroes = {{.height_m = -50.0}};
    const auto frame = frame_of<float>(scene, {filtered(products(Position, Displacement), kCell_m)}, 0.0);
    EXPECT_GT(glm::length(FrameBounds<float>(frame, 0).everywhere().reach_m()), 500.0);
    const auto above = surface_above(frame, 0, {5.0, 7.0, -1e9}, kCell_m);
    ASSERT_TRUE(above);
    EXPECT_FALSE(surface_above(frame, 0, {5.0, 7.0, 1e9}, kCell_m));
    const Highest found = highest(frame, {{5.0f, 7.0f}, {-30.0f, 2.0f}});
    for (const float height_m : found.height_m) EXPECT_TRUE(std::isfinite(height_m));
}

TEST(SurfaceAbove, AQueryWithoutPositionsIsRefused) {
    const auto frame = frame_of<float>(Scene(), {filtered(products(Product::Normal), kCell_m)}, 0.0);
    EXPECT_THROW(surface_above(frame, 0, {0.0, 0.0, 0.0}, kCell_m), std::invalid_argument);
}

}  // namespace
}  // namespace pelagic
