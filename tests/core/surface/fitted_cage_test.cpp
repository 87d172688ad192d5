// The cage whose limit surface goes through a grid of points. The limit surface is written out here as the tensor product of
// the cubic B-spline, a polynomial in each face; tests/plugin/bake/fitted_cage_test.cpp asks OpenSubdiv for it.
#include "core/surface/fitted_cage.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "core/base/constants.h"
#include "core/surface/rest_surface.h"

namespace pelagic {
namespace {

// Values at (u, v) in cells from the patch's first corner.
glm::dvec3 limit(const FittedCage& cage, const std::vector<glm::vec3>& vertices, double u, double v) {
    const auto weights = [](double t) {
        const double s = 1.0 - t;
        return std::array{s * s * s / 6.0, (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0,
                          (3.0 * s * s * s - 6.0 * s * s + 4.0) / 6.0, t * t * t / 6.0};
    };
    const int x = std::min(static_cast<int>(u), cage.quads - 1),
              y = std::min(static_cast<int>(v), cage.quads - 1);
    const auto wx = weights(u - x), wy = weights(v - y);
    glm::dvec3 sum(0.0);
    for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 4; ++i)
            sum += wx[static_cast<std::size_t>(i)] * wy[static_cast<std::size_t>(j)] *
                   glm::dvec3(vertices[static_cast<std::size_t>((y + j) * cage.vertices_per_side() + x + i)]);
    return sum;
}

// Points at (x, y, f(x, y)), in cells.
template <class Height>
std::vector<glm::vec3> points_of(const FittedCage& cage, const Height& height) {
    std::vector<glm::vec3> points;
    for (int y = -FittedCage::kMargin; y <= cage.quads + FittedCage::kMargin; ++y)
        for (int x = -FittedCage::kMargin; x <= cage.quads + FittedCage::kMargin; ++x)
            points.emplace_back(x, y, height(x, y));
    return points;
}

TEST(FittedCage, TheLimitSurfaceMeetsEveryPointOfThePatch) {
    for (const int quads : {1, 2, 7, 64}) {
        const FittedCage cage{quads};
        std::mt19937 random(7);
        std::normal_distribution<float> normal;
        const auto points = points_of(cage, [&](int, int) { return normal(random); });
        ASSERT_EQ(points.size(), static_cast<std::size_t>(cage.points_per_side() * cage.points_per_side()));
        std::vector<glm::vec3> vertices;
        cage.fit(points, vertices);
        ASSERT_EQ(vertices.size(), static_cast<std::size_t>((quads + 3) * (quads + 3)));
        for (int y = 0; y <= quads; ++y)
            for (int x = 0; x <= quads; ++x) {
                const glm::vec3& point = points[static_cast<std::size_t>(
                    (y + FittedCage::kMargin) * cage.points_per_side() + x + FittedCage::kMargin)];
                // Noise is the hardest there is: the sum's end is 5e-7 of it along each axis, floats hold 4e-6 of 64.
                EXPECT_LT(glm::length(limit(cage, vertices, x, y) - glm::dvec3(point)), 2e-5);
            }
    }
}

// A wave of a cell's wavenumber kh, at any angle, everywhere in the patch and on its edges: (kh)⁴/384 of its amplitude at
// most, times 1 + O(kh)².
TEST(FittedCage, AWaveIsRightBetweenThePointsAndOnTheEdges) {
    const FittedCage cage{24};
    for (const double wavenumber : {0.2, 0.5, 1.0, kPi / 2})
        for (const double angle : {0.0, 0.4, kPi / 4}) {
            const double kx = wavenumber * std::cos(angle), ky = wavenumber * std::sin(angle);
            std::vector<glm::vec3> vertices;
            cage.fit(
                points_of(cage, [&](int x, int y) { return static_cast<float>(std::cos(kx * x + ky * y)); }),
                vertices);
            double most = 0.0;
            for (double v = 0.0; v <= cage.quads; v += 0.25)
                for (double u = 0.0; u <= cage.quads; u += 0.25) {
                    const glm::dvec3 at = limit(cage, vertices, u, v);
                    most = std::max(most, std::abs(at.z - std::cos(kx * u + ky * v)));
                    EXPECT_NEAR(at.x, u, 1e-5);
                    EXPECT_NEAR(at.y, v, 1e-5);
                }
            const double expected = std::pow(wavenumber, 4.0) / 384.0;
            EXPECT_LT(most, 1.3 * expected + 1e-5) << wavenumber << " at " << angle;
            if (angle == 0.0 &&
                wavenumber > 0.4) {  // and it isn't better than theory allows: the test can tell
                EXPECT_GT(most, 0.7 * expected);
            }
        }
}

TEST(FittedCage, APatchOfItHasARingOfFacesRoundIt) {
    Scene scene;
    scene.surface.resolution = 8;
    scene.surface.size_m = 40.0;
    scene.output.mesh_scheme = MeshScheme::CatmullClark;
    const auto surface = make_surface(scene, {});
    const std::optional<FittedCage> cage = surface->fitted();
    ASSERT_TRUE(cage);
    const std::array frames{1};
    EXPECT_EQ(surface->needs(frames).points,
              static_cast<std::size_t>(cage->points_per_side() * cage->points_per_side()));
    RestPoints<double> points;
    surface->points_at(1, points);
    std::vector<glm::dvec2> patch;
    cage->crop<glm::dvec2>(points.rest_m, FittedCage::kMargin, patch);
    ASSERT_EQ(patch.size(), 81u);
    EXPECT_EQ(patch.front(), glm::dvec2(-20.0, -20.0));
    EXPECT_EQ(patch.back(), glm::dvec2(20.0, 20.0));
    Faces faces;
    surface->faces_at(1, faces);
    EXPECT_EQ(faces.counts.size(), 100u);
    ASSERT_EQ(faces.st.size(), 121u);
    EXPECT_EQ(faces.st[0], glm::vec2(-0.125f, -0.125f));
    EXPECT_EQ(faces.st[12], glm::vec2(0.0f, 0.0f));
    EXPECT_EQ(faces.st[108], glm::vec2(1.0f, 1.0f));
}

}  // namespace
}  // namespace pelagic
