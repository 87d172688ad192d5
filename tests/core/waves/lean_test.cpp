// Waves that lean: their fronts are steeper than their backs, and break.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/core/waves/samples.h"

namespace pelagic {
namespace {

using namespace test;

// Of one cascade, over its whole tile; waves travel along +x for the most part.
struct Fronts {
    double slope_skewness =
        0.0;  // E[η_x³]/E[η_x²]^{3/2} over places: below 0 where fronts are the steeper side
    double on_front = 0.0;  // of the places with the smallest J, the share whose water falls towards +x
    double jacobian_deviation = 0.0;
};

Fronts fronts_of(double lean_deg) {
    Scene scene;
    scene.sea.wind_speed_mps = 15.0;
    scene.waves.tiling = Tiling::Periodic;
    scene.waves.lean_deg = lean_deg;
    const double peak_m = kTwoPi / prepare(scene)->spectrum.peak_wavenumber();
    const double size_m = 16.0 * peak_m;
    scene.waves.cascades = {{size_m, 128}};
    constexpr int kSide = 192;
    const auto points = tile_points<float>(size_m, kSide);
    struct Place {
        double j, slope;
    };
    std::vector<Place> places;
    for (int seed = 1; seed <= 3; ++seed) {
        scene.shot.seed = seed;
        const auto frame =
            frame_of<float>(scene, {unfiltered(products(Normal, Product::JacobianMoments))}, 5.0);
        const auto at = sample(frame, 0, points);
        for (std::size_t i = 0; i < points.size(); ++i) {
            const glm::dvec3 normal(at.vectors(Normal)[i]);
            places.push_back({at.vectors(Product::JacobianMoments)[i].x, -normal.x / normal.z});
        }
    }
    Fronts fronts;
    double area = 0.0, second = 0.0, third = 0.0;
    for (const Place& place : places) {
        area += place.j;
        second += place.j * place.slope * place.slope;
        third += place.j * std::pow(place.slope, 3);
        fronts.jacobian_deviation += (place.j - 1.0) * (place.j - 1.0);
    }
    fronts.slope_skewness = third / area / std::pow(second / area, 1.5);
    fronts.jacobian_deviation = std::sqrt(fronts.jacobian_deviation / static_cast<double>(places.size()));
    const std::size_t steepest = places.size() / 100;
    std::nth_element(places.begin(), places.begin() + steepest, places.end(),
                     [](const Place& a, const Place& b) { return a.j < b.j; });
    for (std::size_t i = 0; i < steepest; ++i)
        fronts.on_front += (places[i].slope < 0.0) / static_cast<double>(steepest);
    return fronts;
}

TEST(Lean, MakesFrontsSteeperAndBreaksOnThem) {
    const Fronts upright = fronts_of(0.0), leaning = fronts_of(15.0), more = fronts_of(30.0);
    RecordProperty("slope skewness at 15 degrees", std::to_string(leaning.slope_skewness));
    RecordProperty("on fronts at 15 degrees", std::to_string(leaning.on_front));
    EXPECT_NEAR(upright.slope_skewness, 0.0, 0.05);
    EXPECT_NEAR(upright.on_front, 0.5, 0.05);
    EXPECT_LT(leaning.slope_skewness, upright.slope_skewness - 0.05);
    EXPECT_LT(more.slope_skewness, leaning.slope_skewness - 0.05);
    EXPECT_GT(leaning.on_front, 0.6);
    EXPECT_GT(more.on_front, leaning.on_front + 0.05);
    // Turned in phase, the displacement is as large as it was, and so is what breaks.
    EXPECT_NEAR(leaning.jacobian_deviation, upright.jacobian_deviation, 0.03 * upright.jacobian_deviation);
}

// Of waves that travel either way, and of their pairs.
TEST(Lean, VelocitiesAreThePositionsRates) {
    Scene scene;
    scene.sea.directionality = 0.1;
    scene.waves.lean_deg = 40.0;
    scene.sea.swell = {{.height_m = 2.0, .period_s = 9.0, .direction_deg = 180.0}};
    const auto points = random_points<double>(300.0, 50);
    auto frame = frame_of<double>(scene, {filtered(products(Displacement, Velocity), 2.0)});
    const double step_s = 1e-4;
    const auto at = [&](double t_s) {
        frame.set(t_s);
        return sample(frame, 0, points);
    };
    const auto before = at(3.0 - step_s), now = at(3.0), after = at(3.0 + step_s);
    for (std::size_t i = 0; i < points.size(); ++i)
        for (int axis = 0; axis < 3; ++axis)
            EXPECT_NEAR((after.vectors(Displacement)[i][axis] - before.vectors(Displacement)[i][axis]) /
                            (2.0 * step_s),
                        now.vectors(Velocity)[i][axis], 1e-5);
}

}  // namespace
}  // namespace pelagic
