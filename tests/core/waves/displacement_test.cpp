// Horizontal displacement: its sign and size, and its effect on a single wave.
#include <gtest/gtest.h>

#include "core/spectrum/dispersion.h"
#include "tests/core/waves/samples.h"

namespace pelagic {
namespace {

using namespace test;

// ⟨ηJ⟩ = −λ Σ k E|h|². J = 1 + ∇·D + DxxDyy − Dxy², and over one tile ⟨η ∇·D⟩ is −λ Σk|h|² by Parseval. The
// quadratic part adds ⟨η (DxxDyy − Dxy²)⟩, an odd moment of Gaussian fields: its mean is 0, its sampling
// error of order λ².
TEST(HeightTimesJacobian, IsMinusChoppinessTimesSumOfWavenumberTimesEnergy) {
    for (double choppiness : {1.0, 0.02}) {
        std::vector<double> relative;
        for (int seed = 1; seed <= 8; ++seed) {
            Scene scene = first_order();
            scene.shot.seed = seed;
            scene.waves.choppiness = choppiness;
            scene.waves.cascades = {{600.0, 96}};
            const auto frame = frame_of<float>(
                scene, {tile(products(Product::Displacement, Product::JacobianMoments), 0, 600.0, 96)});
            const auto map = sample(frame, 0, tile_points<float>(600.0, 96));
            double sum = 0.0, expected = 0.0;
            for (std::size_t i = 0; i < map.vectors(Displacement).size(); ++i)
                sum += double(map.vectors(Displacement)[i].z) *
                       (double(map.vectors(Product::JacobianMoments)[i].x) - 1.0);
            for (const Mode& mode : modes_of(frame.sea(), 0, 0.0))
                expected -= choppiness * 2.0 * mode.k * std::norm(mode.height);
            relative.push_back(sum / static_cast<double>(map.vectors(Displacement).size()) / expected);
            EXPECT_GT(relative.back(), 0.0);
        }
        const Estimate mean = estimate(relative);
        EXPECT_NEAR(mean.mean, 1.0, 4.0 * mean.standard_error + 1e-5) << "choppiness " << choppiness;
        // The error is proportional to the choppiness: some 10 % per seed at 1, so 0.2 % at 0.02.
        EXPECT_LT(mean.standard_error, 0.1 * choppiness);
    }
}

// A single wave through the public interface: a swell as long as its tile, with a footprint that hides
// everything shorter than 0.72 of the tile. This leaves the modes (±1, 0), which carry the swell, and (0,
// ±1), which don't depend on x and have no Dx. Along x there is one wave.
struct OneWave {
    double k;
    Frame<double> frame;
};
OneWave one_wave(double length_m, double depth_m, double choppiness) {
    const double k = 2.0 * kPi / length_m;
    Scene scene = first_order();
    scene.sea.wind_speed_mps = 0.0;
    scene.sea.depth_m = depth_m;
    scene.sea.swell = {
        {.height_m = 8.0, .period_s = 2.0 * kPi / Dispersion{depth_m}.omega(k), .direction_deg = 0.0}};
    scene.waves.choppiness = choppiness;
    scene.waves.cascades = {{length_m, 16}};
    Query query = tile(products(Product::Displacement), 0, length_m, 512);
    query.cell_m = query.pixel_m = {0.36 * length_m};
    return {k, frame_of<double>(scene, {query})};
}

TEST(OneWaveAlone, IsTheTrochoid) {
    struct {
        double depth_m, choppiness;
    } cases[] = {{std::numeric_limits<double>::infinity(), 1.0}, {5.0, 1.0}, {5.0, 0.3}};
    constexpr double kLength = 60.0;
    for (const auto& c : cases) {
        const OneWave wave = one_wave(kLength, c.depth_m, c.choppiness);
        auto points = tile_points<double>(kLength, 512);
        points.resize(512);  // the row y = 0
        const auto row = sample(wave.frame, 0, points).vectors(Displacement);
        const double level = mean_of(row, [](auto d) { return d.z; });
        std::complex<double> harmonic = 0.0;
        for (std::size_t i = 0; i < row.size(); ++i)
            harmonic += (row[i].z - level) * std::polar(2.0 / 512.0, -wave.k * points[i].x);
        const double amplitude = std::abs(harmonic), phase = std::arg(harmonic);
        ASSERT_GT(amplitude, 0.1);

        // η = a cos(kx + φ), Dx = −λ coth(kd) a sin(kx + φ): Lamb's orbits. The factor is computed in double.
        const double a_x = c.choppiness * amplitude / std::tanh(std::min(wave.k * c.depth_m, 50.0));
        double above = 0.0;
        for (std::size_t i = 0; i < row.size(); ++i) {
            EXPECT_NEAR(row[i].z, level + amplitude * std::cos(wave.k * points[i].x + phase),
                        1e-9 * amplitude);
            EXPECT_NEAR(row[i].x, -a_x * std::sin(wave.k * points[i].x + phase), 1e-9 * a_x);
            const auto& next = row[(i + 1) % row.size()];
            if (row[i].z > level) above += kLength / 512.0 + next.x - row[i].x;
        }
        // Sharp crests, broad troughs: the part above mean level is 2a shorter than half the length, the part
        // below 2a longer, up to the spacing of two nodes.
        EXPECT_NEAR(above, 0.5 * kLength - 2.0 * a_x, 2.0 * kLength / 512.0);
        EXPECT_LT(above, 0.5 * kLength - a_x);
    }
}

}  // namespace
}  // namespace pelagic
