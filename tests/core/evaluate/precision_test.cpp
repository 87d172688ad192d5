// Single precision against double: what "float" costs, everything else alike.
#include <gtest/gtest.h>

#include "tests/core/waves/samples.h"

namespace pelagic {
namespace {

using namespace test;

// Rounding of 6e-8 in amplitudes, transforms and weights, over some 1e4 modes. Largest differences of 4000
// points, measured: positions 1.9e-7 of Hs, velocities 1.8e-7 of Hs/s, normals 1.5e-7, J 2.5e-7,
// coverage 4.1e-6 (with ripples that break, whose variance makes its edges soft: 7.7e-7). Five times that.
TEST(SinglePrecision, IsWithinARoundingOfDouble) {
    Scene scene;
    scene.sea.wind_speed_mps = 14.0;
    scene.sea.swell = {{.height_m = 2.0, .period_s = 11.0, .direction_deg = 80.0}};
    const ProductSet all = ~lasting_products();
    for (double t : {0.0, 1234.5}) {
        const Plan plan = make_plan(scene, {filtered(all, 0.5)});
        const auto single = frame_of<float>(scene, plan, t);
        const auto reference = frame_of<double>(scene, plan, t);
        const auto points = random_points<float>(200.0, 4000);
        std::vector<glm::dvec2> same;  // exactly the single-precision positions
        for (const auto& point : points) same.emplace_back(point);
        const auto a = sample(single, 0, points);
        const auto b = sample(reference, 0, same);
        const double hs = 4.0 * std::sqrt(reference.realisation(0).m0);
        double displacement = 0.0, normal = 0.0, velocity = 0.0, jacobian = 0.0, coverage = 0.0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            for (int axis = 0; axis < 3; ++axis) {
                const auto larger = [&](double& worst, double x, double y) {
                    worst = std::max(worst, std::abs(x - y));
                };
                larger(displacement, a.vectors(Displacement)[i][axis], b.vectors(Displacement)[i][axis]);
                larger(normal, a.vectors(Normal)[i][axis], b.vectors(Normal)[i][axis]);
                larger(velocity, a.vectors(Velocity)[i][axis], b.vectors(Velocity)[i][axis]);
                larger(jacobian, a.vectors(Product::JacobianMoments)[i][axis],
                       b.vectors(Product::JacobianMoments)[i][axis]);
            }
            coverage = std::max(coverage, std::abs(double(a.numbers(Product::Breaking)[i]) -
                                                   b.numbers(Product::Breaking)[i]));
        }
        RecordProperty("displacement_over_hs", std::to_string(displacement / hs * 1e6) + "e-6");
        EXPECT_LT(displacement, 1e-6 * hs);
        EXPECT_LT(velocity, 1e-6 * hs);
        EXPECT_LT(normal, 1e-6);
        EXPECT_LT(jacobian, 1.5e-6);
        EXPECT_LT(coverage, 2e-5);
        EXPECT_GT(displacement, 0.0);
    }
}

}  // namespace
}  // namespace pelagic
