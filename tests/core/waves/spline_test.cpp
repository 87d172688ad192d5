// The spline sampler: its weights, and its error between the nodes against a direct sum over the modes.
#include "core/waves/spline.h"

#include <gtest/gtest.h>

#include "tests/core/waves/samples.h"

namespace pelagic {
namespace {

using namespace test;

template <int P>
void expect_partition_of_unity() {
    for (double f = 0.0; f <= 1.0; f += 0.0625) {
        double w[P];
        bspline_weights<P>(f, w);
        double sum = 0.0, first = 0.0;
        for (int i = 0; i < P; ++i) {
            EXPECT_GE(w[i], 0.0);
            sum += w[i];
            first += w[i] * (i - P / 2 + 1);
        }
        EXPECT_NEAR(sum, 1.0, 1e-15);
        EXPECT_NEAR(first, f, 1e-15);  // the first moment: straight lines are reproduced
    }
}

TEST(BSpline, WeightsAreAPartitionOfUnity) {
    expect_partition_of_unity<4>();
    expect_partition_of_unity<6>();
    double cubic[4];
    bspline_weights<4>(0.0, cubic);  // 1/6, 4/6, 1/6 at a node
    EXPECT_NEAR(cubic[0], 1.0 / 6.0, 1e-15);
    EXPECT_NEAR(cubic[1], 4.0 / 6.0, 1e-15);
    EXPECT_NEAR(cubic[2], 1.0 / 6.0, 1e-15);
    EXPECT_NEAR(cubic[3], 0.0, 1e-15);
}

// The energy of all images of a wave of f cycles per node, relative to its own: Σ (f/(f + l))^2P over l ≠ 0.
double images(double f, int taps) {
    double sum = 0.0;
    for (int l = 1; l <= 4; ++l) sum += std::pow(f / (f + l), 2 * taps) + std::pow(f / (f - l), 2 * taps);
    return sum;
}

// Measured (JONSWAP, 10 m/s, modes down to 6.5 m, random points), root mean square error over root mean
// square height:
//   draft 2.8e-3 (4 taps, 1.25 nodes per Nyquist sample), preview 2.2e-4 (4, 2), final 1.5e-5 (6, 2),
//   reference 1.1e-7 (6, 4).
TEST(SplineSampling, HasTheErrorOfItsImages) {
    struct {
        QualityLevel level;
        double largest;  // rms error over rms height
    } cases[] = {{QualityLevel::Draft, 5e-3},
                 {QualityLevel::Preview, 5e-4},
                 {QualityLevel::Final, 5e-5},
                 {QualityLevel::Reference, 5e-7}};
    for (const auto& c : cases) {
        Scene scene = first_order();
        scene.quality.level = c.level;
        scene.waves.cascades = {{150.0, 48}};
        scene.waves.tiling = Tiling::Periodic;
        const auto frame = frame_of<double>(scene, {unfiltered(products(Product::Displacement))}, 1.0);
        const Plan& plan = frame.sea().plan();
        const Grid& grid = plan.cascades[0].grids[0];
        ASSERT_EQ(grid.sampling, Sampling::Spline);
        const auto modes = modes_of(frame.sea(), 0, 1.0);
        double energy = 0.0, image_energy = 0.0;
        for (const Mode& mode : modes) {
            const double n = grid.resolution;
            const double e = 2.0 * std::norm(mode.height);
            energy += e;
            image_energy += e * ((1.0 + images(mode.mx / n, plan.knobs.spline_taps)) *
                                     (1.0 + images(mode.my / n, plan.knobs.spline_taps)) -
                                 1.0);
        }
        constexpr int kPoints = 2000;
        const auto points = random_points<double>(1000.0, kPoints);
        const auto heights = sample(frame, 0, points).vectors(Displacement);
        double error = 0.0;
        for (int i = 0; i < kPoints; ++i) {
            const double difference = heights[i].z - direct_height(modes, 150.0, points[i]);
            error += difference * difference / kPoints;
        }
        // A mean of 2000 squares. Their relative deviation is below √2, so the mean's is below 3.2 %.
        // Images of one realisation are correlated: twice that; the tolerance is five times.
        EXPECT_NEAR(error / image_energy, 1.0, 0.32) << "quality " << static_cast<int>(c.level);
        EXPECT_LT(std::sqrt(error / energy), c.largest) << "quality " << static_cast<int>(c.level);
        RecordProperty("rms_error_of_level_" + std::to_string(static_cast<int>(c.level)),
                       std::to_string(std::sqrt(error / energy)));
    }
}

// A height map between the nodes has the variance of the realisation, too, up to the images' energy. A
// shifted lattice that resolves every mode gives the variance of a trigonometric polynomial exactly.
TEST(SplineSampling, KeepsTheVarianceOfTheRealisation) {
    Scene scene = first_order();
    scene.waves.cascades = {{150.0, 48}};
    scene.waves.tiling = Tiling::Periodic;
    const auto frame = frame_of<float>(scene, {unfiltered(products(Product::Displacement))});
    auto points = tile_points<float>(150.0, 64);
    for (auto& point : points) point += glm::vec2(0.71f, 1.13f);
    const double variance =
        mean_of(sample(frame, 0, points).vectors(Displacement), [](auto d) { return double(d.z) * d.z; });
    // The rms error is 1.5e-5 of the rms height (above); its cross term with the height is at most twice
    // that.
    EXPECT_NEAR(variance / frame.realisation(0).m0, 1.0, 5e-5);
}

// The sum is periodic at the grid's nodes and between them, without a seam.
TEST(SplineSampling, IsPeriodicAndContinuousAcrossTheSeam) {
    Scene scene;
    scene.waves.cascades = {{150.0, 48}};
    scene.waves.tiling = Tiling::Periodic;
    const auto frame = frame_of<float>(scene, {unfiltered(products(Product::Displacement))});
    const std::vector<glm::vec2> points{
        {-1e-4f, 20.0f}, {0.0f, 20.0f}, {1e-4f, 20.0f}, {150.0f, 20.0f}, {-300.0f, 170.0f}};
    const auto d = sample(frame, 0, points).vectors(Displacement);
    for (std::size_t i = 1; i < points.size(); ++i)
        for (int axis = 0; axis < 3; ++axis)
            EXPECT_NEAR(d[i][axis], d[0][axis], 2e-4) << i;  // slope < 1, 2e-4 m
}

}  // namespace
}  // namespace pelagic
