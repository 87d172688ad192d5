// Trains that feel the floor, against Snell's law, the flux of energy, and Thornton and Guza's breaking.
#include "core/waves/coast.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>

#include "core/base/constants.h"
#include "core/scene/text.h"
#include "core/spectrum/dispersion.h"
#include "tests/core/waves/worst.h"

namespace pelagic {
namespace {

constexpr double kPeriod_s = 10.0, kOmega = kTwoPi / kPeriod_s;

CoastDepths depths_of(glm::ivec2 count, double cell_m, const std::function<double(glm::dvec2)>& depth_m) {
    CoastDepths depths{.count = count, .from_m = {}, .cell_m = glm::dvec2(cell_m), .depth_m = {}};
    for (int y = 0; y < count.y; ++y)
        for (int x = 0; x < count.x; ++x)
            depths.depth_m.push_back(depth_m(cell_m * (glm::dvec2(x, y) + 0.5)));
    return depths;
}

glm::dvec2 towards(double degrees) {
    return {std::cos(degrees * kPi / 180.0), std::sin(degrees * kPi / 180.0)};
}

// A plane beach, 1:50, from 20 m on.
constexpr double kSlope = 1.0 / 50.0, kEdge_m = 20.0;
double beach_m(double x) {
    return kEdge_m - kSlope * x;
}

TEST(CoastTest, APlaneBeachIsSnells) {
    const CoastDepths depths = depths_of({256, 64}, 4.0, [](glm::dvec2 at) { return beach_m(at.x); });
    const Dispersion far{40.0};
    const double k0 = far.wavenumber(kOmega);
    double worst_height = 0.0, worst_flux = 0.0, worst_deg = 0.0;
    for (const double degrees : {0.0, 20.0, -40.0, 50.0, -65.0}) {
        const glm::dvec2 direction = towards(degrees);
        const CoastWave wave = march_coast(depths, far.depth_m, kOmega, direction);
        const double flux0 = far.domega_dk(k0) * direction.x;
        int compared = 0;
        for (int x = 1; x < 255; ++x)
            for (const int y : {6, 32, 57}) {
                const std::size_t cell = depths.at(x, y);
                const double depth_m = depths.depth_m[cell];
                if (depth_m < 0.5) continue;
                const Dispersion here{depth_m};
                const double k = here.wavenumber(kOmega), sine = k0 * direction.y / k,
                             cosine = std::sqrt(1.0 - sine * sine);
                const double expected = std::sqrt(flux0 / (here.domega_dk(k) * cosine));
                if (!(expected * expected < kMostCoastEnergy)) continue;  // from 0.9 m on
                EXPECT_NEAR(std::sqrt(wave.energy[cell]) / expected, 1.0, 0.02) << degrees << ' ' << depth_m;
                EXPECT_NEAR(wave.flux[cell].x / flux0, 1.0, 0.02) << degrees << ' ' << depth_m;
                const auto slope = [&](std::size_t before, std::size_t after) {
                    return (wave.phase[after] - wave.phase[before]) / (2.0 * 4.0);
                };
                const glm::dvec2 gradient =
                    k0 * direction + glm::dvec2(slope(depths.at(x - 1, y), depths.at(x + 1, y)),
                                                slope(depths.at(x, y - 1), depths.at(x, y + 1)));
                const double angle = std::atan2(gradient.y, gradient.x) * 180.0 / kPi;
                EXPECT_NEAR(angle, std::asin(sine) * 180.0 / kPi, 1.0) << degrees << ' ' << depth_m;
                EXPECT_NEAR(glm::length(gradient) / k, 1.0, 0.02) << degrees << ' ' << depth_m;
                ++compared;
                const auto widen = [](double& worst, double off) {
                    worst = test::worse(worst, std::abs(off));
                };
                widen(worst_height, std::sqrt(wave.energy[cell]) / expected - 1.0);
                widen(worst_flux, wave.flux[cell].x / flux0 - 1.0);
                widen(worst_deg, angle - std::asin(sine) * 180.0 / kPi);
            }
        EXPECT_GT(compared, 600);
    }
    RecordProperty("height_off", number_text(worst_height));
    RecordProperty("flux_off", number_text(worst_flux));
    RecordProperty("off_deg", number_text(worst_deg));
}

TEST(CoastTest, ThePhaseIsTheIntegralOfTheWavenumber) {
    const CoastDepths depths = depths_of({240, 8}, 4.0, [](glm::dvec2 at) { return beach_m(at.x); });
    const CoastWave wave = march_coast(depths, kEdge_m, kOmega, {1.0, 0.0});
    const double k0 = Dispersion{kEdge_m}.wavenumber(kOmega);
    double phase = 0.0;
    constexpr double kStep_m = 0.05;
    const double end_m = 4.0 * (230 + 0.5);
    for (double x = 0.5 * kStep_m; x < end_m; x += kStep_m)
        phase += kStep_m * (Dispersion{beach_m(x)}.wavenumber(kOmega) - k0);
    EXPECT_NEAR(wave.phase[depths.at(230, 4)], phase, 0.02);  // 1 km away
}

TEST(CoastTest, AllWaysAreAlike) {
    const CoastDepths east =
        depths_of({64, 48}, 4.0, [](glm::dvec2 at) { return 8.0 - at.x / 40.0 + at.y / 200.0; });
    const CoastWave wave = march_coast(east, kEdge_m, kOmega, towards(30.0));
    // The same beach to the west, the north and the south.
    const CoastDepths west =
        depths_of({64, 48}, 4.0, [](glm::dvec2 at) { return 8.0 - (256.0 - at.x) / 40.0 + at.y / 200.0; });
    const CoastWave mirrored = march_coast(west, kEdge_m, kOmega, towards(150.0));
    const CoastDepths north =
        depths_of({48, 64}, 4.0, [](glm::dvec2 at) { return 8.0 - at.y / 40.0 + at.x / 200.0; });
    const CoastWave turned = march_coast(north, kEdge_m, kOmega, towards(60.0));
    const CoastDepths south =
        depths_of({48, 64}, 4.0, [](glm::dvec2 at) { return 8.0 - (256.0 - at.y) / 40.0 + at.x / 200.0; });
    const CoastWave below = march_coast(south, kEdge_m, kOmega, towards(-60.0));
    for (const auto& [x, y] : {std::pair(10, 20), std::pair(50, 30), std::pair(63, 0)}) {
        for (const auto& [other, cell] :
             {std::pair(&mirrored, west.at(63 - x, y)), std::pair(&turned, north.at(y, x)),
              std::pair(&below, south.at(y, 63 - x))}) {
            EXPECT_NEAR(other->phase[cell], wave.phase[east.at(x, y)], 1e-9);
            EXPECT_NEAR(other->energy[cell], wave.energy[east.at(x, y)], 1e-9);
        }
    }
    EXPECT_NEAR(turned.flux[north.at(20, 10)].y, wave.flux[east.at(10, 20)].x, 1e-9);
    EXPECT_NEAR(mirrored.flux[west.at(53, 20)].x, -wave.flux[east.at(10, 20)].x, 1e-9);
}

TEST(CoastTest, OverALevelFloorNothingChanges) {
    const CoastDepths depths = depths_of({100, 100}, 5.0, [](glm::dvec2) { return 6.0; });
    for (const double degrees : {0.0, 44.0, 100.0, -170.0}) {
        const CoastWave wave = march_coast(depths, 6.0, kOmega, towards(degrees));
        for (std::size_t cell = 0; cell < wave.phase.size(); ++cell) {
            EXPECT_NEAR(wave.phase[cell], 0.0, 2e-3);
            EXPECT_NEAR(wave.energy[cell], 1.0, 1e-3);
        }
    }
}

// Against the sheet's figures: a sea of 1.5 m (rms) and 10 s on 1:50.
TEST(CoastTest, ASeaBreaksByThorntonAndGuza) {
    const CoastDepths depths = depths_of({500, 4}, 2.0, [](glm::dvec2 at) { return beach_m(at.x); });
    const CoastWave wave = march_coast(depths, std::numeric_limits<double>::infinity(), kOmega, {1.0, 0.0});
    std::vector<double> m0;
    std::vector<glm::dvec2> flux;
    constexpr double kHeight_m = 1.5, kM0 = kHeight_m * kHeight_m / 8.0;
    for (std::size_t cell = 0; cell < wave.energy.size(); ++cell) {
        m0.push_back(kM0 * wave.energy[cell]);
        flux.push_back(kM0 * wave.flux[cell]);
    }
    const CoastBreaking breaking = break_on_coast(depths, m0, flux, {1.0, 0.0}, 1.0 / kPeriod_s);
    double worst = 0.0;
    for (const auto& [depth_m, expected] :
         {std::pair(5.0, 0.32), std::pair(3.0, 0.38), std::pair(1.0, 0.44)}) {
        const int x = static_cast<int>((kEdge_m - depth_m) / kSlope / 2.0);
        const std::size_t cell = depths.at(x, 2);
        const double height_m = std::sqrt(8.0 * m0[cell] * breaking.left[cell]);
        EXPECT_NEAR(height_m / depths.depth_m[cell] / expected, 1.0, 0.1) << depth_m;
        worst = test::worse(worst, std::abs(height_m / depths.depth_m[cell] / expected - 1.0));
        EXPECT_NEAR(breaking.broken[cell],
                    std::min(1.0, std::pow(height_m / (0.42 * depths.depth_m[cell]), 4.0)), 1e-9);
    }
    RecordProperty("height_off", number_text(worst));
    // None offshore, and no energy from nowhere.
    EXPECT_LT(breaking.broken[depths.at(5, 2)], 0.01);
    for (int x = 1; x < 500; ++x)
        EXPECT_LE(breaking.left[depths.at(x, 2)], breaking.left[depths.at(x - 1, 2)]);
}

TEST(CoastTest, BehindAnIslandItIsCalm) {
    const CoastDepths depths = depths_of({128, 128}, 5.0, [](glm::dvec2 at) {
        return std::min(12.0, 0.15 * (glm::distance(at, glm::dvec2(200.0, 320.0)) - 60.0));
    });
    const CoastWave wave = march_coast(depths, 12.0, kOmega, {1.0, 0.0});
    for (std::size_t cell = 0; cell < wave.phase.size(); ++cell) {
        ASSERT_TRUE(
            std::isfinite(wave.phase[cell] + wave.energy[cell] + wave.flux[cell].x + wave.flux[cell].y));
        if (depths.depth_m[cell] <= kCoastShore_m) {
            EXPECT_EQ(wave.energy[cell], 0.0);
        }
    }
    EXPECT_LT(wave.energy[depths.at(56, 64)], 0.1);          // in its lee, 20 m behind
    EXPECT_NEAR(wave.energy[depths.at(100, 5)], 1.0, 0.05);  // far beside it
    EXPECT_NEAR(wave.energy[depths.at(10, 64)], 1.0, 0.05);  // before it
}

double island_m(glm::dvec2 at) {
    return std::min(12.0, 0.2 * (glm::distance(at, glm::dvec2(200.0)) - 50.0));
}
double cliffs_m(glm::dvec2 at) {
    return glm::distance(at, glm::dvec2(200.0)) > 50.0 ? 12.0 : -5.0;
}

// Without a limit to |S_v|, the phase behind the island lags by the shore's wavelengths: up to 70 k at its edges.
TEST(CoastTest, BehindAnIslandTheWavesAreAsLongAsElsewhere) {
    for (const auto& floor : {island_m, cliffs_m})
        for (const double degrees : {0.0, 25.0}) {
            const CoastDepths depths = depths_of({200, 200}, 2.0, floor);
            const CoastWave wave = march_coast(depths, 12.0, kTwoPi / 9.0, towards(degrees));
            const glm::dvec2 k0 = Dispersion{12.0}.wavenumber(kTwoPi / 9.0) * towards(degrees);
            int compared = 0;
            for (int y = 1; y < 199; ++y)
                for (int x = 1; x < 199; ++x) {
                    const std::size_t cell = depths.at(x, y);
                    if (!(wave.energy[cell] > 0.01)) continue;
                    const auto rate = [&](std::size_t before, std::size_t after) {
                        return (wave.phase[after] - wave.phase[before]) / 4.0;
                    };
                    const glm::dvec2 gradient =
                        k0 + glm::dvec2(rate(depths.at(x - 1, y), depths.at(x + 1, y)),
                                        rate(depths.at(x, y - 1), depths.at(x, y + 1)));
                    // Of the shallowest of the cells that these differences are over.
                    double depth_m = depths.depth_m[cell];
                    for (const std::size_t next :
                         {depths.at(x - 1, y), depths.at(x + 1, y), depths.at(x, y - 1), depths.at(x, y + 1)})
                        if (depths.depth_m[next] > kCoastShore_m)
                            depth_m = std::min(depth_m, depths.depth_m[next]);
                    const double k = Dispersion{depth_m}.wavenumber(kTwoPi / 9.0);
                    EXPECT_LE(glm::length(gradient), 1.3 * k) << degrees << ' ' << x << ' ' << y;
                    ++compared;
                }
            EXPECT_GT(compared, 30000);
        }
}

// As wide as half of Fresnel's integral is on the mean, and none is lost or made.
TEST(CoastTest, ALeeFillsWithDistance) {
    const CoastDepths depths = depths_of({400, 200}, 2.0, cliffs_m);
    const CoastWave wave = march_coast(depths, 12.0, kTwoPi / 9.0, {1.0, 0.0});
    const auto sum = [&](int x) {
        double flux = 0.0;
        for (int y = 0; y < 200; ++y) flux += wave.flux[depths.at(x, y)].x;
        return flux;
    };
    EXPECT_LT(sum(130), 0.9 * sum(10));
    for (const int x : {150, 250, 399}) EXPECT_NEAR(sum(x) / sum(130), 1.0, 0.005) << x;
    double before = 0.0;
    for (const int x : {130, 170, 250, 399}) {
        const double energy = wave.energy[depths.at(x, 100)];
        EXPECT_GT(energy, before) << x;
        before = energy;
    }
    EXPECT_LT(wave.energy[depths.at(130, 100)], 0.15);
    // Half as much straight behind its flank, whatever the distance.
    for (const int x : {170, 250}) EXPECT_NEAR(wave.energy[depths.at(x, 124)], 0.5, 0.15) << x;
}

TEST(CoastTest, AShoalGathersNoMoreThanItsLimit) {
    const CoastDepths depths = depths_of({160, 160}, 5.0, [](glm::dvec2 at) {
        const glm::dvec2 from = (at - glm::dvec2(250.0, 400.0)) / 100.0;
        return 10.0 - 8.0 * std::exp(-glm::dot(from, from));
    });
    const CoastWave wave = march_coast(depths, 10.0, kOmega, {1.0, 0.0});
    double most = 0.0;
    for (const double energy : wave.energy) {
        ASSERT_TRUE(std::isfinite(energy) && energy >= 0.0 && energy <= kMostCoastEnergy);
        most = std::max(most, energy);
    }
    EXPECT_EQ(most, kMostCoastEnergy);  // at its caustic
    // No energy is lost or made across the map, but for what the limit takes.
    double before = 0.0, after = 0.0;
    for (int y = 0; y < 160; ++y) {
        before += wave.flux[depths.at(1, y)].x;
        after += wave.flux[depths.at(45, y)].x;
    }
    EXPECT_NEAR(after / before, 1.0, 0.02);
}

TEST(CoastTest, WhatTurnsBackEnds) {
    // From 1 m down to 40 m, away from a beach, so steeply that k falls below S_v.
    const CoastDepths depths =
        depths_of({128, 32}, 5.0, [](glm::dvec2 at) { return 1.0 + 39.0 * std::min(at.x / 400.0, 1.0); });
    const CoastWave wave = march_coast(depths, 1.0, kOmega, towards(44.0));
    for (std::size_t cell = 0; cell < wave.phase.size(); ++cell)
        ASSERT_TRUE(std::isfinite(wave.phase[cell] + wave.energy[cell]));
    EXPECT_GT(wave.energy[depths.at(1, 16)], 0.9);
    EXPECT_EQ(wave.energy[depths.at(120, 16)], 0.0);
}

TEST(CoastTest, DepthsAreMeansOfTexels) {
    const DepthMap map({2, 2}, {1.0f, 3.0f, 5.0f, -7.0f}, {10.0, 20.0}, {4.0, 4.0});
    EXPECT_NEAR(map.mean_m({10.0, 20.0}, {14.0, 24.0}), 0.5, 1e-9);
    EXPECT_NEAR(map.mean_m({11.0, 21.0}, {11.0, 21.0}), 1.0, 1e-9);    // a texel's middle
    EXPECT_NEAR(map.mean_m({12.0, 21.0}, {12.0, 21.0}), 2.0, 1e-9);    // halfway to the next
    EXPECT_NEAR(map.mean_m({-90.0, 21.0}, {-90.0, 21.0}), 1.0, 1e-9);  // as at the edge
    EXPECT_NEAR(map.mean_m({90.0, 90.0}, {95.0, 95.0}), -7.0, 1e-9);
    const CoastDepths cells = coast_depths(map, {4, 4});
    EXPECT_NEAR(cells.depth_m[cells.at(3, 3)], -7.0, 1e-9);
    EXPECT_NE(map.content(), DepthMap({2, 2}, {1.0f, 3.0f, 5.0f, -6.0f}, {10.0, 20.0}, {4.0, 4.0}).content());
    EXPECT_THROW(DepthMap({2, 2}, {1.0f}, {}, {4.0, 4.0}), std::invalid_argument);
    EXPECT_THROW(DepthMap({1, 1}, {std::nanf("")}, {}, {4.0, 4.0}), std::invalid_argument);
    EXPECT_THROW(DepthMap({1, 1}, {1.0f}, {}, {0.0, 4.0}), std::invalid_argument);
}

}  // namespace
}  // namespace pelagic
