// Every derivative field against finite differences of the displacement, in double precision.
//
// Central differences of eighth order have, for a wave of phase step φ = kh (or ωΔt), the relative error
// φ⁸/630 to leading order. So the root mean square of (difference − field) is at most (k_max h)⁸/630 times
// the field's.
#include <gtest/gtest.h>

#include <array>

#include "tests/core/waves/samples.h"

namespace pelagic {
namespace {

using namespace test;

constexpr double kSize = 100.0;
constexpr int kNodes = 512, kModes = 20;  // 20 modes need a resolution of 42
constexpr std::array<double, 4> kWeights{4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0};

double truncation(double phase_step) {
    return std::pow(phase_step, 8) / 630.0;
}

double rms(const std::vector<double>& values) {
    return std::sqrt(mean_of(values, [](double v) { return v * v; }));
}

std::vector<double> difference_in_space(const std::vector<double>& values, int dx, int dy) {
    constexpr double h = kSize / kNodes;
    std::vector<double> result(values.size());
    const auto at = [&](int x, int y) {
        return values[static_cast<std::size_t>((y + kNodes) % kNodes) * kNodes + (x + kNodes) % kNodes];
    };
    for (int y = 0; y < kNodes; ++y)
        for (int x = 0; x < kNodes; ++x) {
            double sum = 0.0;
            for (int i = 1; i <= 4; ++i)
                sum += kWeights[i - 1] * (at(x + i * dx, y + i * dy) - at(x - i * dx, y - i * dy));
            result[static_cast<std::size_t>(y) * kNodes + x] = sum / h;
        }
    return result;
}

void expect_same(const std::vector<double>& field, const std::vector<double>& difference, double relative,
                 const char* what) {
    std::vector<double> error(field.size());
    for (std::size_t i = 0; i < field.size(); ++i) error[i] = field[i] - difference[i];
    ASSERT_GT(rms(field), 1e-3) << what;
    EXPECT_LT(rms(error), (relative + 1e-12) * rms(field)) << what;
}

class Derivatives : public testing::TestWithParam<double> {
  protected:
    Derivatives() : frame_(frame_of<double>(scene(), {query()}, 2.0)) {}
    static Scene scene() {
        Scene scene;
        scene.sea.wind_speed_mps = 7.0;
        scene.sea.wind_direction_deg = 25.0;
        scene.sea.depth_m = GetParam();
        scene.waves.choppiness = 0.7;
        scene.waves.cascades = {{kSize, 2 * kModes + 2}};
        return scene;
    }
    static Query query() {
        return tile(
            products(Product::Displacement, Product::Normal, Product::Velocity, Product::JacobianMoments), 0,
            kSize, kNodes);
    }
    std::vector<double> field(Field f) const { return field_at_nodes(frame_, 0, f); }
    Frame<double> frame_;
};

TEST_P(Derivatives, InSpaceAreThoseOfTheDisplacement) {
    const double bound = truncation(2.0 * kPi * kModes / kNodes);  // 2e-8
    const auto height = field(Field::Height), dx = field(Field::Dx), dy = field(Field::Dy);
    expect_same(field(Field::SlopeX), difference_in_space(height, 1, 0), bound, "∂η/∂x");
    expect_same(field(Field::SlopeY), difference_in_space(height, 0, 1), bound, "∂η/∂y");
    expect_same(field(Field::Dxx), difference_in_space(dx, 1, 0), bound, "∂Dx/∂x");
    expect_same(field(Field::Dyy), difference_in_space(dy, 0, 1), bound, "∂Dy/∂y");
    expect_same(field(Field::Dxy), difference_in_space(dx, 0, 1), bound, "∂Dx/∂y");
    expect_same(field(Field::Dxy), difference_in_space(dy, 1, 0), bound, "∂Dy/∂x");
}

TEST_P(Derivatives, InTimeAreTheVelocity) {
    constexpr double kStep_s = 0.05;
    const double k = 2.0 * kPi * kModes / kSize, omega_max = std::sqrt(9.81 * k + 7.3e-5 * k * k * k);
    const double t = frame_.time_s();
    const std::pair<Field, Field> pairs[] = {
        {Field::VelocityX, Field::Dx}, {Field::VelocityY, Field::Dy}, {Field::VelocityZ, Field::Height}};
    std::vector<std::vector<double>> velocity, difference(3, std::vector<double>(kNodes * kNodes));
    for (const auto& [rate, of] : pairs) velocity.push_back(field(rate));
    for (int i = -4; i <= 4; ++i) {
        if (i == 0) continue;
        frame_.set(t + i * kStep_s);
        for (int p = 0; p < 3; ++p) {
            const auto values = field(pairs[p].second);
            const double weight = (i > 0 ? 1.0 : -1.0) * kWeights[std::abs(i) - 1] / kStep_s;
            for (std::size_t n = 0; n < values.size(); ++n) difference[p][n] += weight * values[n];
        }
    }
    for (int p = 0; p < 3; ++p)
        expect_same(velocity[p], difference[p], truncation(omega_max * kStep_s), "velocity");
}

// Normals and J are nonlinear in the fields: compared with the cross product of the differenced tangents.
// Errors of the derivatives, which are all below 1, enter with factors of order 1: ten times the bound.
TEST_P(Derivatives, GiveNormalsAndJacobianOfTheDisplacedSurface) {
    const double tolerance = 10.0 * truncation(2.0 * kPi * kModes / kNodes);
    const auto samples = sample(frame_, 0, tile_points<double>(kSize, kNodes));
    const auto component = [&](int axis) {
        std::vector<double> values;
        for (const auto& d : samples.vectors(Displacement)) values.push_back(d[axis]);
        return values;
    };
    std::vector<double> by_x[3], by_y[3];
    for (int axis = 0; axis < 3; ++axis) {
        by_x[axis] = difference_in_space(component(axis), 1, 0);
        by_y[axis] = difference_in_space(component(axis), 0, 1);
    }
    double least_j = 1.0;
    for (std::size_t i = 0; i < samples.vectors(Normal).size(); ++i) {
        const glm::dvec3 tx(1.0 + by_x[0][i], by_x[1][i], by_x[2][i]),
            ty(by_y[0][i], 1.0 + by_y[1][i], by_y[2][i]);
        const glm::dvec3 n(tx.y * ty.z - tx.z * ty.y, tx.z * ty.x - tx.x * ty.z, tx.x * ty.y - tx.y * ty.x);
        const double length = std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
        for (int axis = 0; axis < 3; ++axis)
            ASSERT_NEAR(samples.vectors(Normal)[i][axis], n[axis] / length, tolerance);
        ASSERT_NEAR(samples.vectors(Product::JacobianMoments)[i].x, n.z, tolerance);
        least_j = std::min(least_j, n.z);
    }
    EXPECT_LT(least_j, 0.8);  // the cross terms are large enough to matter
}

INSTANTIATE_TEST_SUITE_P(DeepAndShallow, Derivatives,
                         testing::Values(std::numeric_limits<double>::infinity(), 3.0));

}  // namespace
}  // namespace pelagic
