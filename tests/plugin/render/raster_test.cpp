// The rasteriser against geometry that is known: planes, partitions of the picture, rays.
#include "plugin/render/raster.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>
#include <random>
#include <stdexcept>
#include <vector>

#include "core/surface/view.h"

namespace pelagic {
namespace {

constexpr double kNear = 0.05;

struct Drawn {
    glm::ivec2 resolution;
    std::vector<std::uint32_t> triangles;  // by pixel, rows from the top
    std::uint32_t at(int x, int y) const { return triangles[static_cast<std::size_t>(y) * resolution.x + x]; }
};

Drawn drawn(const Rasteriser& raster, glm::ivec2 resolution) {
    Drawn result{resolution, {}};
    result.triangles.resize(static_cast<std::size_t>(resolution.x) * resolution.y, 7);
    const std::size_t band = static_cast<std::size_t>(resolution.x) * Rasteriser::kBandRows;
    for (int b = 0; b < raster.band_count(); ++b)
        raster.draw(b, std::span(result.triangles)
                           .subspan(b * band, std::min(band, result.triangles.size() - b * band)));
    return result;
}

// A picture point in pixels, at a depth w, as clip coordinates.
glm::dvec4 clip_of(glm::dvec2 pixel, double w, glm::ivec2 resolution) {
    return {(2.0 * pixel.x / resolution.x - 1.0) * w, (1.0 - 2.0 * pixel.y / resolution.y) * w,
            w - 2.0 * kNear, w};
}

// A lattice of squares over more than the picture, two triangles each, inner vertices shaken.
struct Net {
    std::vector<glm::dvec4> clip;
    std::vector<std::uint32_t> indices;
};
Net net(glm::ivec2 resolution, std::uint64_t seed, double snap_px) {
    constexpr int kCells = 12;
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> shake(-0.3, 0.3), depth(0.5, 50.0);
    Net result;
    for (int j = 0; j <= kCells; ++j)
        for (int i = 0; i <= kCells; ++i) {
            const bool rim = i == 0 || j == 0 || i == kCells || j == kCells;
            glm::dvec2 place((i + (rim ? 0.0 : shake(random))) / kCells,
                             (j + (rim ? 0.0 : shake(random))) / kCells);
            place = (place * 1.5 - 0.25) * glm::dvec2(resolution);
            if (snap_px > 0.0) place = glm::round(place / snap_px) * snap_px;
            result.clip.push_back(clip_of(place, depth(random), resolution));
        }
    for (std::uint32_t j = 0; j < kCells; ++j)
        for (std::uint32_t i = 0; i < kCells; ++i) {
            const std::uint32_t a = j * (kCells + 1) + i, b = a + 1, c = a + kCells + 1, d = c + 1;
            const bool falling = (i + j) % 2 == 0;
            for (const std::uint32_t k :
                 falling ? std::array{a, b, c, b, d, c} : std::array{a, b, d, a, d, c})
                result.indices.push_back(k);
        }
    return result;
}

// Of triangles that share edges and corners each pixel belongs to exactly one: counted by drawing each alone.
// With corners on pixels' centres, too, where only the rule decides.
TEST(Raster, CoversSharedEdgesExactlyOnce) {
    const glm::ivec2 resolution(61, 47);
    for (const double snap_px : {0.0, 0.5}) {
        for (std::uint64_t seed = 1; seed <= 5; ++seed) {
            const Net whole = net(resolution, seed, snap_px);
            std::vector<int> count(static_cast<std::size_t>(resolution.x) * resolution.y, 0);
            for (std::size_t t = 0; t < whole.indices.size(); t += 3) {
                Rasteriser raster;
                raster.set(whole.clip, std::span(whole.indices).subspan(t, 3), resolution);
                const Drawn alone = drawn(raster, resolution);
                for (std::size_t i = 0; i < count.size(); ++i)
                    count[i] += alone.triangles[i] != Rasteriser::kNone;
            }
            EXPECT_EQ(std::ranges::count(count, 1), std::ssize(count)) << "seed " << seed;
        }
    }
}

// A square whose corners are pixels' centres holds those on its top and left edges, and none on the others.
TEST(Raster, GivesEdgesToTheTrianglesBelowAndToTheirRight) {
    const glm::ivec2 resolution(16, 16);
    const std::vector<glm::dvec4> clip{
        clip_of({4.5, 4.5}, 1.0, resolution), clip_of({8.5, 4.5}, 1.0, resolution),
        clip_of({4.5, 8.5}, 1.0, resolution), clip_of({8.5, 8.5}, 1.0, resolution)};
    for (const std::vector<std::uint32_t>& indices :
         {std::vector<std::uint32_t>{0, 1, 2, 1, 3, 2}, std::vector<std::uint32_t>{2, 1, 0, 2, 3, 1}}) {
        Rasteriser raster;
        raster.set(clip, indices, resolution);
        const Drawn square = drawn(raster, resolution);
        for (int y = 0; y < 16; ++y)
            for (int x = 0; x < 16; ++x)
                EXPECT_EQ(square.at(x, y) != Rasteriser::kNone, x >= 4 && x < 8 && y >= 4 && y < 8)
                    << x << ", " << y;
    }
}

View level_view(double height_m, double pitch, glm::ivec2 resolution) {
    View view;
    view.position_m = {0.0, 0.0, height_m};
    view.forward = {0.0, std::cos(pitch), std::sin(pitch)};
    view.right = {1.0, 0.0, 0.0};
    view.up = {0.0, -std::sin(pitch), std::cos(pitch)};
    view.resolution = resolution;
    return view;
}

// A plane that reaches far: everything below the line where its last row lies, and nothing above, straight
// across the picture. The line's place: the far edge at a distance d lies −h/d below the level direction.
TEST(Raster, PutsThePlanesHorizonWhereGeometryHasIt) {
    const glm::ivec2 resolution(96, 64);
    constexpr double kFar = 1e5, kHalf = 1e6, kHeight = 7.0;
    for (const double pitch : {-0.2, -0.03, 0.0, 0.11}) {
        const View view = level_view(kHeight, pitch, resolution);
        const glm::dmat4 clip_from = view.clip_from(glm::dvec3(0.0), kNear);
        std::vector<glm::dvec4> clip;
        // Its near edge lies behind the camera: the near plane cuts it.
        for (const glm::dvec2 p : {glm::dvec2(-kHalf, -kFar), glm::dvec2(kHalf, -kFar),
                                   glm::dvec2(-kHalf, kFar), glm::dvec2(kHalf, kFar)})
            clip.push_back(clip_from * glm::dvec4(p, 0.0, 1.0));
        const std::vector<std::uint32_t> indices{0, 1, 2, 1, 3, 2};
        Rasteriser raster;
        raster.set(clip, indices, resolution);
        const Drawn plane = drawn(raster, resolution);
        const double tangent = std::tan(-kHeight / kFar - pitch);  // above the axis, to 1e-9 of the angle
        const double line = 0.5 * resolution.y - tangent / view.pixel_tangent();
        for (int y = 0; y < resolution.y; ++y) {
            // Corners are rounded to 1/256 of a pixel: no centre of these lies that near to the line.
            ASSERT_GT(std::abs(y + 0.5 - line), 1.0 / 256.0);
            for (int x = 0; x < resolution.x; ++x)
                EXPECT_EQ(plane.at(x, y) != Rasteriser::kNone, y + 0.5 > line) << x << ", " << y;
        }
    }
}

// What a pixel shows of a plane is where its ray meets it: the weights of a triangle's corners give that
// point, perspective-correct, near the camera, far away and with a corner behind it. 1e-9 of the distance:
// doubles, some digits lost to the cross products.
TEST(Raster, InterpolatesWhereTheRayMeetsThePlane) {
    const glm::ivec2 resolution(48, 32);
    const View view = level_view(3.0, -0.25, resolution);
    const glm::dmat4 clip_from = view.clip_from(glm::dvec3(0.0), kNear);
    const std::vector<glm::dvec2> corner{{-2e3, -40.0}, {3e3, -25.0}, {-1.5e3, 2e4}, {2.5e3, 3e4}};
    std::vector<glm::dvec4> clip;
    for (const glm::dvec2 p : corner) clip.push_back(clip_from * glm::dvec4(p, 0.0, 1.0));
    for (const std::vector<std::uint32_t>& indices :
         {std::vector<std::uint32_t>{0, 1, 2, 1, 3, 2}, std::vector<std::uint32_t>{0, 2, 1, 1, 2, 3}}) {
        Rasteriser raster;
        raster.set(clip, indices, resolution);
        const Drawn plane = drawn(raster, resolution);
        int covered = 0;
        for (int y = 0; y < resolution.y; ++y)
            for (int x = 0; x < resolution.x; ++x) {
                const std::uint32_t triangle = plane.at(x, y);
                if (triangle == Rasteriser::kNone) continue;
                ++covered;
                const glm::dvec2 pixel(x + 0.5, y + 0.5);
                const glm::dvec3 ray = view.direction(pixel);
                const glm::dvec3 met = view.position_m - ray * (view.position_m.z / ray.z);
                const glm::dvec3 weights = raster.weights(triangle, pixel);
                glm::dvec2 place(0.0);
                for (int i = 0; i < 3; ++i) place += weights[i] * corner[indices[3 * triangle + i]];
                const double off = glm::length(place - glm::dvec2(met));
                // On an edge between the two triangles the rounded corners may put a centre on its other
                // side, by 1/256 of a pixel, where the weights stay at the edge.
                if (std::min({weights.x, weights.y, weights.z}) > 0.0) {
                    EXPECT_LE(off, 1e-9 * glm::length(met)) << x << ", " << y;
                }
                EXPECT_NEAR(weights.x + weights.y + weights.z, 1.0, 1e-14);
            }
        EXPECT_GT(covered, resolution.x * resolution.y / 2);
    }
}

// Two planes through each other: each pixel shows the nearer one, whichever is drawn first.
TEST(Raster, ShowsTheNearest) {
    const glm::ivec2 resolution(64, 48);
    const auto plane_clip = [&](double left_w, double right_w) {
        std::vector<glm::dvec4> corners;
        for (const double y : {-8.0, 60.0})
            for (const auto& [x, w] : {std::pair(-16.0, left_w), std::pair(80.0, right_w)})
                corners.push_back(clip_of({x, y}, w, resolution));
        return corners;
    };
    for (const bool swapped : {false, true}) {
        std::vector<glm::dvec4> clip;
        for (const bool rising : {!swapped, swapped})
            for (const glm::dvec4& corner : rising ? plane_clip(1.0, 9.0) : plane_clip(9.0, 1.0))
                clip.push_back(corner);
        const std::vector<std::uint32_t> indices{0, 1, 2, 1, 3, 2, 4, 5, 6, 5, 7, 6};
        Rasteriser raster;
        raster.set(clip, indices, resolution);
        const Drawn both = drawn(raster, resolution);
        for (int y = 0; y < resolution.y; ++y)
            for (int x = 0; x < resolution.x; ++x) {
                if (x == 31 || x == 32) continue;  // as near as each other to rounding, in the middle
                const bool second = both.at(x, y) >= 2;
                EXPECT_EQ(second, (x >= 32) != swapped) << x << ", " << y;
            }
    }
    // Of equally near ones the first.
    const std::vector<glm::dvec4> one = plane_clip(2.0, 2.0);
    const std::vector<std::uint32_t> twice{0, 1, 2, 1, 3, 2, 0, 1, 2, 1, 3, 2};
    Rasteriser raster;
    raster.set(one, twice, resolution);
    for (const std::uint32_t triangle : drawn(raster, resolution).triangles) EXPECT_LT(triangle, 2u);
}

// Corners anywhere, behind the eye, in its plane, far out, all on one line: nothing is written but triangles
// that there are, and weights stay weights.
TEST(Raster, StaysFiniteForAnyTriangle) {
    const glm::ivec2 resolution(33, 17);
    std::mt19937_64 random(11);
    std::normal_distribution<double> normal;
    std::uniform_int_distribution<int> power(-12, 12);
    std::vector<glm::dvec4> clip;
    for (int i = 0; i < 600; ++i) {
        const double scale = std::pow(10.0, power(random));
        const double w = i % 7 == 0 ? 0.0 : normal(random) * scale;
        clip.push_back({normal(random) * scale, normal(random), w - 2.0 * kNear, w});
    }
    std::vector<std::uint32_t> indices;
    for (std::uint32_t i = 0; i + 3 < 600; ++i)
        for (const std::uint32_t k : {i, i + 1, i % 11 == 0 ? i : i + 2}) indices.push_back(k);
    Rasteriser raster;
    raster.set(clip, indices, resolution);
    const Drawn all = drawn(raster, resolution);
    int covered = 0;
    for (int y = 0; y < resolution.y; ++y)
        for (int x = 0; x < resolution.x; ++x) {
            const std::uint32_t triangle = all.at(x, y);
            if (triangle == Rasteriser::kNone) continue;
            ++covered;
            ASSERT_LT(triangle, indices.size() / 3);
            const glm::dvec3 weights = raster.weights(triangle, {x + 0.5, y + 0.5});
            for (int i = 0; i < 3; ++i) EXPECT_TRUE(weights[i] >= 0.0 && weights[i] <= 1.0);
            EXPECT_NEAR(weights.x + weights.y + weights.z, 1.0, 1e-12);
        }
    EXPECT_GT(covered, 0);
}

TEST(Raster, RefusesPicturesThatItsIntegersCannotHold) {
    Rasteriser raster;
    EXPECT_THROW(raster.set({}, {}, {0, 4}), std::invalid_argument);
    EXPECT_THROW(raster.set({}, {}, {4, Rasteriser::kLargestSide + 1}), std::invalid_argument);
    raster.set({}, {}, {5, 18});
    EXPECT_EQ(raster.band_count(), 2);
    for (const std::uint32_t triangle : drawn(raster, {5, 18}).triangles)
        EXPECT_EQ(triangle, Rasteriser::kNone);
}

}  // namespace
}  // namespace pelagic
