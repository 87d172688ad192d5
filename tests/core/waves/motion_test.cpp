// The motion of waves: speed and direction, loops, late and negative times, far from the origin.
#include <gtest/gtest.h>

#include <cstring>

#include "core/spectrum/directional_spectrum.h"
#include "core/spectrum/spectral_moments.h"
#include "tests/core/waves/samples.h"

namespace pelagic {
namespace {

using namespace test;

constexpr double kDeep = std::numeric_limits<double>::infinity();

// The dispersion relation, independent of the code's: g = 9.81 m/s², γ/ρ = 7.3e-5 m³/s².
double omega_of(double k, double depth_m) {
    return std::sqrt((9.81 * k + 7.3e-5 * k * k * k) * std::tanh(std::min(k * depth_m, 50.0)));
}

Scene swell_alone(double length_m, double depth_m, double direction_deg) {
    Scene scene = first_order();
    scene.sea.wind_speed_mps = 0.0;
    scene.sea.depth_m = depth_m;
    scene.sea.swell = {{.height_m = 2.0,
                        .period_s = 2.0 * kPi / omega_of(2.0 * kPi / length_m, depth_m),
                        .direction_deg = direction_deg}};
    return scene;
}

// A swell as long as its tile, with everything shorter unresolved by the footprint: one crest (see
// displacement_test.cpp).
TEST(Crest, MovesAtThePhaseSpeed) {
    for (double depth_m : {kDeep, 5.0})
        for (double direction_deg : {0.0, 180.0}) {
            constexpr double kLength = 80.0;
            Scene scene = swell_alone(kLength, depth_m, direction_deg);
            scene.waves.cascades = {{kLength, 16}};
            Query query = tile(products(Product::Displacement), 0, kLength, 256);
            query.cell_m = query.pixel_m = {0.36 * kLength};
            auto frame = frame_of<double>(scene, {query});
            const double k = 2.0 * kPi / kLength, speed = omega_of(k, depth_m) / k;
            auto points = tile_points<double>(kLength, 256);
            points.resize(256);
            const auto crest = [&](double t) {
                frame.set(t);
                const auto row = sample(frame, 0, points).vectors(Displacement);
                std::size_t top = 0;
                for (std::size_t i = 0; i < row.size(); ++i)
                    if (row[i].z > row[top].z) top = i;
                // The vertex of the parabola through the highest node and its neighbours.
                const double a = row[(top + 255) % 256].z, b = row[top].z, c = row[(top + 1) % 256].z;
                return points[top].x + 0.5 * (a - c) / (a - 2.0 * b + c) * kLength / 256.0;
            };
            // In two seconds a crest at 11 m/s moves by less than half a wavelength, so it can't be confused.
            double way = crest(4.0) - crest(2.0);
            way -= kLength * std::round(way / kLength);
            // The parabola's error is at most (kh)²/24 of h, some 1e-5 m. The waves that travel against it
            // are below 1e-4 of it.
            EXPECT_NEAR(way, (direction_deg == 0.0 ? 2.0 : -2.0) * speed, 0.01 * speed)
                << depth_m << ' ' << direction_deg;
        }
}

// The Fourier coefficient of η at mode (mx, my), from a tile's map of n × n nodes.
std::complex<double> coefficient(const std::vector<double>& map, int n, int mx, int my) {
    std::complex<double> sum = 0.0;
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x)
            sum += map[static_cast<std::size_t>(y) * n + x] *
                   std::polar(1.0, -2.0 * kPi * (mx * x + my * y) / n);
    return sum / (1.0 * n * n);
}

// Each large mode of a swell changes its phase by −ω(k)Δt and so travels along +k; together they travel where
// the swell was sent.
TEST(Swell, TravelsWhereItWasSentAtTheDispersionRelationsSpeed) {
    for (double depth_m : {kDeep, 5.0})
        for (double direction_deg : {0.0, 80.0, 200.0}) {
            constexpr double kLength = 40.0, kPatch_m = 8.0 * kLength, kStep_s = 0.25;
            constexpr int kPatchNodes = 64;
            Scene scene = swell_alone(kLength, depth_m, direction_deg);
            scene.waves.cascades = {{kPatch_m, 32}};
            auto frame =
                frame_of<double>(scene, {tile(products(Product::Displacement), 0, kPatch_m, kPatchNodes)});
            const auto before = field_at_nodes(frame, 0, Field::Height);
            frame.set(kStep_s);
            const auto after = field_at_nodes(frame, 0, Field::Height);
            const glm::dvec2 sent(std::cos(direction_deg * kPi / 180.0),
                                  std::sin(direction_deg * kPi / 180.0));
            glm::dvec2 flux(0.0);
            double energy = 0.0;
            for (int my = -14; my <= 14; ++my)
                for (int mx = -14; mx <= 14; ++mx) {
                    const double length = std::hypot(mx, my);
                    // Modes within 60° of the swell's direction and its band; −k has the conjugate.
                    if (length < 4.0 || length > 13.0 || mx * sent.x + my * sent.y < 0.5 * length) continue;
                    const auto h0 = coefficient(before, kPatchNodes, mx, my),
                               h1 = coefficient(after, kPatchNodes, mx, my);
                    if (std::norm(h0) < 1e-5) continue;
                    const double omega = omega_of(2.0 * kPi * length / kPatch_m, depth_m);
                    // Up to the energy that spreading sends backwards, cos¹⁵⁰ of 60° and more.
                    EXPECT_NEAR(std::abs(h1 / h0 - std::polar(1.0, -omega * kStep_s)), 0.0, 1e-6)
                        << mx << ' ' << my;
                    flux += std::norm(h0) / length * glm::dvec2(mx, my);
                    energy += std::norm(h0);
                }
            ASSERT_GT(energy, 0.01);
            // Spreading of 9° over some ten large modes.
            const double turn =
                std::atan2(sent.x * flux.y - sent.y * flux.x, sent.x * flux.x + sent.y * flux.y);
            EXPECT_NEAR(turn * 180.0 / kPi, 0.0, 6.0) << depth_m << ' ' << direction_deg;
        }
}

TEST(WindSea, TravelsDownwind) {
    for (double direction_deg : {0.0, 80.0, 200.0}) {
        glm::dvec2 flux(0.0);
        for (int seed = 1; seed <= 4; ++seed) {
            Scene scene;
            scene.shot.seed = seed;
            scene.sea.wind_direction_deg = direction_deg;
            scene.waves.cascades = {{800.0, 64}};
            const auto realisation =
                frame_of<float>(scene, {unfiltered(products(Product::Displacement))}).realisation(0);
            flux += glm::dvec2(realisation.east, realisation.north);
        }
        const double turn =
            std::remainder(std::atan2(flux.y, flux.x) - direction_deg * kPi / 180.0, 2.0 * kPi);
        // Some hundred waves within ±30°: a sampling error of 3°.
        EXPECT_NEAR(turn * 180.0 / kPi, 0.0, 9.0);
    }
}

template <class V>
bool same_bits(const std::vector<V>& a, const std::vector<V>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(V)) == 0;
}

// Whatever the clock: in slow motion the sea goes through less of its own time in a loop.
TEST(Loop, RepeatsToTheBitOnAClockThatIsScaledAndOffset) {
    for (const double scale : {0.5, 0.3, 2.5, 0.0}) {
        Scene scene;
        scene.shot.loop_s = 5.0;
        scene.shot.time_scale = scale;
        scene.shot.time_offset_s = 3.7;
        scene.waves.cascades = {{1000.0, 168}, {100.0, 64}};
        auto frame = frame_of<float>(scene, {unfiltered(products(Product::Displacement))});
        const auto points = random_points<float>(500.0, 200);
        for (const int f : {1, 2, 7, 100}) {
            frame.set(scene.shot.time_s(f));
            const auto first = sample(frame, 0, points);
            frame.set(scene.shot.time_s(f + 120));
            EXPECT_TRUE(
                same_bits(first.vectors(Displacement), sample(frame, 0, points).vectors(Displacement)))
                << "scale " << scale << " frame " << f;
            frame.set(scene.shot.time_s(f + 60));
            EXPECT_EQ(same_bits(first.vectors(Displacement), sample(frame, 0, points).vectors(Displacement)),
                      scale == 0.0)
                << "scale " << scale << " frame " << f;
        }
    }
}

// However late: rounds are counted in whole frames, not in seconds, which a double no longer holds exactly.
TEST(Loop, RepeatsToTheBitAtTheLastFrames) {
    for (const double fps : {24.0, 24000.0 / 1001.0, 59.94, 1000.0})
        for (const double scale : {1.0, 0.3, 2.5})
            for (const double offset_s : {0.0, 3.7, -1e7}) {
                Shot shot;
                shot.fps = fps;
                shot.time_scale = scale;
                shot.time_offset_s = offset_s;
                for (const long round : {1L, 7L, 120L, 4801L}) {
                    shot.loop_s = static_cast<double>(round) / fps;
                    for (const long frame :
                         {-100'000'000L, -50'000'003L, -1L, 1L, 9'999'991L, 50'000'017L, 99'990'000L}) {
                        const double t_s = shot.time_s(static_cast<double>(frame));
                        for (const long turns : {1L, -1L, 2L, 1000L})
                            ASSERT_EQ(t_s, shot.time_s(static_cast<double>(frame + turns * round)))
                                << frame << " and " << turns << " rounds of " << round << " at " << fps;
                        const long within = ((frame - 1) % round + round) % round;
                        ASSERT_EQ(t_s, offset_s + scale * (static_cast<double>(within) / fps));
                        // Between frames as well.
                        ASSERT_NEAR(shot.time_s(static_cast<double>(frame) + 0.25) - t_s, 0.25 * scale / fps,
                                    1e-6 * scale / fps + 4e-16 * std::abs(t_s));
                    }
                }
            }
    Scene scene;
    scene.shot.loop_s = 5.0;
    scene.shot.time_scale = 0.3;
    scene.shot.time_offset_s = 3.7;
    scene.waves.cascades = {{1000.0, 168}, {100.0, 64}};
    auto frame = frame_of<float>(scene, {unfiltered(products(Product::Displacement))});
    const auto points = random_points<float>(500.0, 200);
    frame.set(scene.shot.time_s(99'999'880));
    const auto first = sample(frame, 0, points);
    frame.set(scene.shot.time_s(100'000'000));
    EXPECT_TRUE(same_bits(first.vectors(Displacement), sample(frame, 0, points).vectors(Displacement)));
}

TEST(Loop, RepeatsToTheBitAndFreezesNothing) {
    Scene scene;
    scene.shot.loop_s = 10.0;
    scene.sea.swell = {
        {.height_m = 1.0, .period_s = 30.0, .direction_deg = 0.0}};  // a period longer than half the loop
    scene.waves.cascades = {{3000.0, 56}, {1000.0, 168}, {100.0, 64}};
    auto frame = frame_of<float>(scene, {unfiltered(products(Product::Displacement, Product::Velocity))});
    const auto points = random_points<float>(500.0, 500);
    for (int f : {1, 2, 7, 100, 239, 240, -3}) {
        const double t = (f - 1) / 24.0;
        frame.set(t);
        const auto first = sample(frame, 0, points);
        for (int turns : {1, 2, -1}) {
            frame.set((f - 1 + turns * 240) / 24.0);
            const auto again = sample(frame, 0, points);
            EXPECT_TRUE(same_bits(first.vectors(Displacement), again.vectors(Displacement)))
                << "frame " << f << " turns " << turns;
            EXPECT_TRUE(same_bits(first.vectors(Velocity), again.vectors(Velocity)))
                << "frame " << f << " turns " << turns;
        }
    }
    for (const Cascade<float>& cascade : frame.sea().cascades())
        for (std::size_t i = 0; i < cascade.modes(); ++i) {
            if (i == cascade.middle(0)) continue;  // (0, 0) is no wave
            const double cycles = cascade.cycles_per_s[i];
            EXPECT_NEAR(cycles * 10.0, std::round(cycles * 10.0), 1e-9);
            EXPECT_GE(cycles * 10.0, 1.0 - 1e-9);
        }
    // Nothing stands still: a quarter of a loop apart, heights of a wave with one cycle per loop are
    // uncorrelated.
    frame.set(0.0);
    const auto early = sample(frame, 0, points).vectors(Displacement);
    frame.set(2.5);
    const auto late = sample(frame, 0, points).vectors(Displacement);
    double change = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) change += std::pow(late[i].z - early[i].z, 2);
    EXPECT_GT(change / static_cast<double>(points.size()), frame.realisation(0).m0);  // 2 m0 in expectation
}

TEST(Frames, RefuseATimeThatIsNone) {
    auto frame = frame_of<float>(Scene(), {unfiltered(products(Product::Displacement))});
    EXPECT_THROW(frame.set(std::numeric_limits<double>::quiet_NaN()), std::invalid_argument);
    EXPECT_THROW(frame.set(std::numeric_limits<double>::infinity()), std::invalid_argument);
}

}  // namespace
}  // namespace pelagic
