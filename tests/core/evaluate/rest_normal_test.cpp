// Normals of the sea on a surface that isn't flat, against differences of the displaced surface itself.
#include <gtest/gtest.h>

#include <array>
#include <glm/geometric.hpp>
#include <memory>
#include <vector>

#include "core/evaluate/evaluate.h"

namespace pelagic {
namespace {

// A surface given by two parameters [m], steep and even vertical: where it stands upright, u runs upwards.
glm::dvec3 surface_at(glm::dvec2 uv) {
    return {uv.x + 0.3 * std::sin(uv.y), uv.y + 1.5 * std::sin(0.7 * uv.x),
            2.0 * std::sin(0.9 * uv.x) + 0.5 * uv.y * uv.y};
}
glm::dvec3 wall_at(glm::dvec2 uv) {
    return {7.0, uv.y, uv.x};
}

std::shared_ptr<const Sea<double>> rough_sea() {
    Scene scene;
    scene.sea.wind_speed_mps = 9.0;
    scene.waves.cascades = {{.size_m = 60.0, .resolution = 128}};
    Query query;
    query.products = products(Product::Position, Product::Normal);
    query.cell_m = query.pixel_m = {1.0};
    return std::make_shared<const Sea<double>>(make_plan(scene, {query}, {.double_precision = true}));
}

class OnSurface {
  public:
    OnSurface() : frame_(rough_sea()) { frame_.set(3.7); }

    // The displaced places over these rests, and the normals there.
    std::vector<glm::dvec3> evaluate(const std::vector<glm::dvec3>& rest_m,
                                     const std::vector<glm::dvec3>& rest_normals,
                                     std::vector<glm::dvec3>& normals) const {
        std::vector<glm::dvec2> rest;
        for (const glm::dvec3& each : rest_m) rest.emplace_back(each);
        std::vector<glm::dvec3> places(rest.size());
        normals.resize(rest.size());
        Results<double> results;
        results.set(Product::Position, {places.data()});
        results.set(Product::Normal, {normals.data()});
        Points<double> points{.count = rest.size(), .rest_m = {rest.data()}};
        if (!rest_normals.empty()) points.rest_normal = {rest_normals.data()};
        pelagic::evaluate(frame_, 0, points, results);
        for (std::size_t i = 0; i < places.size(); ++i) places[i].z += rest_m[i].z;
        return places;
    }

  private:
    Frame<double> frame_;
};

TEST(RestNormal, IsThatOfTheDisplacedSurface) {
    const OnSurface sea;
    constexpr double kStep = 1e-5;  // leaves half of a double's digits to the differences
    for (const auto& surface : {&surface_at, &wall_at})
        for (int i = 0; i < 300; ++i) {  // more than a chunk, and not a multiple of a vector's length
            const glm::dvec2 uv(0.37 * i, 0.011 * i - 1.0);
            std::vector<glm::dvec3> rest;
            for (const glm::dvec2 step : {glm::dvec2(0, 0), {1, 0}, {-1, 0}, {0, 1}, {0, -1}})
                rest.push_back(surface(uv + kStep * step));
            const glm::dvec3 normal = glm::cross(rest[1] - rest[2], rest[3] - rest[4]) / (kStep * kStep);
            std::vector<glm::dvec3> normals;
            const std::vector<glm::dvec3> places =
                sea.evaluate(rest, std::vector<glm::dvec3>(5, normal), normals);
            const glm::dvec3 expected =
                glm::normalize(glm::cross(places[1] - places[2], places[3] - places[4]));
            // Heights and slopes are splines of their own: they differ by what a spline of six nodes errs.
            ASSERT_LT(glm::distance(normals[0], expected), 1e-4) << i;
        }
}

TEST(RestNormal, UpIsAFlatSeasAndNoneIsItself) {
    const OnSurface sea;
    std::vector<glm::dvec3> rest, flat, up, none;
    for (int i = 0; i < 301; ++i) rest.emplace_back(0.31 * i, 17.0 - 0.2 * i, 0.0);
    sea.evaluate(rest, {}, flat);
    sea.evaluate(rest, std::vector<glm::dvec3>(rest.size(), glm::dvec3(0.0, 0.0, 2.5)), up);
    sea.evaluate(rest, std::vector<glm::dvec3>(rest.size(), glm::dvec3(0.0)), none);
    for (std::size_t i = 0; i < rest.size(); ++i) {
        EXPECT_LT(glm::distance(flat[i], up[i]), 1e-14) << "rounding";
        EXPECT_EQ(none[i], glm::dvec3(0.0));
    }
}

}  // namespace
}  // namespace pelagic
