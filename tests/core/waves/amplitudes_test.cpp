// Energy: amplitudes contain the energy of the spectrum, and a height map that of the amplitudes.
#include <gtest/gtest.h>

#include "core/scene/cascade_bands.h"
#include "core/spectrum/directional_spectrum.h"
#include "core/spectrum/spectral_moments.h"
#include "tests/core/waves/samples.h"

namespace pelagic {
namespace {

using namespace test;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// An invented hour of a buoy: a wind sea from 4 to 12 s, towards 30°.
MeasuredSpectrum made_up_hour() {
    MeasuredSpectrum hour{.bins = {}, .station = "test", .time = "2020-01-01T00:00:00Z"};
    for (int i = 0; i < 20; ++i) {
        const double f = 0.06 + 0.02 * i, x = f / 0.1;
        const double density = 5.0 * std::pow(x, -5.0) * std::exp(-1.25 * std::pow(x, -4.0));
        const auto c1 = std::polar(0.8, kPi / 6.0), c2 = std::polar(0.5, kPi / 3.0);
        hour.bins.push_back({f, density, c1.real(), c1.imag(), c2.real(), c2.imag(), true});
    }
    return hour;
}

struct Case {
    const char* name;
    SpectrumKind spectrum;
    SpreadingKind spreading;
    bool swell;
    double depth_m;
};

Scene scene_of(const Case& c) {
    Scene scene;
    scene.sea.spectrum = c.spectrum;
    scene.sea.spreading = c.spreading;
    scene.sea.wind_direction_deg = 35.0;
    scene.sea.depth_m = c.depth_m;
    if (c.swell) scene.sea.swell = {{.height_m = 1.5, .period_s = 11.0, .direction_deg = 80.0}};
    if (c.spectrum == SpectrumKind::File) scene.sea.measured = made_up_hour();
    // Resolutions just reach the next band, where an edge could lose cells.
    const std::vector<double> sizes_m{500.0, 90.0, 16.0};
    const auto edges = lower_edges(sizes_m);
    scene.waves.cascades = {{sizes_m[0], sufficient_resolution(sizes_m[0], edges[1])},
                            {sizes_m[1], sufficient_resolution(sizes_m[1], edges[2])},
                            {sizes_m[2], 96}};
    return scene;
}

// ∬ Ψ over the wavevectors from k_from to k_to whose nearest mode in a tile of this size satisfies `held`: a
// plain midpoint rule in polar coordinates, independent of the cells' quadrature.
template <class Held>
double energy_near_modes(const DirectionalSpectrum& spectrum, double size_m, double k_from, double k_to,
                         Held&& held) {
    constexpr int kRadii = 300, kAngles = 1440;
    const double step = 2.0 * kPi / size_m, dk = (k_to - k_from) / kRadii, dtheta = 2.0 * kPi / kAngles;
    double sum = 0.0;
    for (int i = 0; i < kRadii; ++i)
        for (int j = 0; j < kAngles; ++j) {
            const double k = k_from + (i + 0.5) * dk, theta = (j + 0.5) * dtheta;
            const long mx = std::lround(k * std::cos(theta) / step),
                       my = std::lround(k * std::sin(theta) / step);
            if (held(mx, my)) sum += spectrum.polar(k, theta);
        }
    return sum * dk * dtheta;
}

class Amplitudes : public testing::TestWithParam<Case> {};

// ΣE|h|² of a cascade is its band's m0 to 1e-3. Sampling a cell instead of integrating it, missing a rim of
// cells or cutting an edge wrongly would fail.
TEST_P(Amplitudes, HoldTheirBandOfTheSpectrum) {
    const Scene scene = scene_of(GetParam());
    const auto frame = frame_of<float>(scene, {unfiltered(products(Product::Displacement))});
    const DirectionalSpectrum spectrum(scene.sea);
    const Plan& plan = frame.sea().plan();

    double sum = 0.0, lost = 0.0;
    for (int c = 0; c < 3; ++c) {
        const CascadePlan& cascade = plan.cascades[c];
        const double step = 2.0 * kPi / cascade.size_m;
        double upper = cascade.k_upper, expected = 0.0;
        if (c == 2) {
            // The tile's modes end before the band: whole cells, whose rim is a staircase within half a
            // diagonal of the radius.
            const double inner = (cascade.mode_radius - 0.7072) * step,
                         outer = (cascade.mode_radius + 0.7072) * step;
            upper = inner;
            expected = energy_near_modes(spectrum, cascade.size_m, inner, outer, [&](long mx, long my) {
                return mx * mx + my * my < static_cast<long>(cascade.mode_radius) * cascade.mode_radius;
            });
            lost += moments(spectrum, inner, kInfinity).m0 - expected;
        }
        expected += moments(spectrum, cascade.k_lower, upper).m0;
        if (c == 0) {
            const double zero = energy_near_modes(spectrum, cascade.size_m, 0.0, 0.7072 * step,
                                                  [](long mx, long my) { return mx == 0 && my == 0; });
            expected -= zero;
            lost += zero;
        }
        EXPECT_NEAR(frame.sea().expected_m0(c) / expected, 1.0, 1e-3) << "cascade " << c;
        sum += frame.sea().expected_m0(c);
    }
    EXPECT_NEAR((sum + lost) / spectrum.m0(), 1.0, 1e-3);
    EXPECT_LT(lost, 0.05 * spectrum.m0());
}

INSTANTIATE_TEST_SUITE_P(
    EverySpectrum, Amplitudes,
    testing::Values(
        Case{"PiersonMoskowitz", SpectrumKind::PiersonMoskowitz, SpreadingKind::Hasselmann, false, kInfinity},
        Case{"JonswapWithSwell", SpectrumKind::Jonswap, SpreadingKind::DonelanBanner, true, kInfinity},
        Case{"TmaShallow", SpectrumKind::Tma, SpreadingKind::Cosine, false, 12.0},
        Case{"Elfouhaily", SpectrumKind::Elfouhaily, SpreadingKind::Elfouhaily, false, kInfinity},
        Case{"Omega2", SpectrumKind::Omega2, SpreadingKind::Hasselmann, true, kInfinity},
        Case{"Phillips", SpectrumKind::Phillips, SpreadingKind::Cosine, false, kInfinity},
        Case{"File", SpectrumKind::File, SpreadingKind::Hasselmann, false, kInfinity}),
    [](const auto& instance) { return std::string(instance.param.name); });

// "auto" cascades: sizes that nobody chose, resolutions that are just large enough.
TEST(AutomaticCascades, LoseNoEnergyBetweenBands) {
    for (double wind : {5.0, 10.0, 20.0}) {
        Scene scene;
        scene.sea.wind_speed_mps = wind;
        const auto frame = frame_of<float>(scene, {unfiltered(products(Product::Displacement))});
        const DirectionalSpectrum spectrum(scene.sea);
        for (int c = 0; c < 3; ++c) {
            const CascadePlan& cascade = frame.sea().plan().cascades[c];
            const double band = moments(spectrum, cascade.k_lower, cascade.k_upper).m0;
            // At ten peak waves per tile the cell around k = 0 is empty: JONSWAP's exp(−1.25·400).
            EXPECT_NEAR(frame.sea().expected_m0(c) / band, 1.0, 1e-3) << "wind " << wind << " cascade " << c;
        }
    }
}

// A height map over one tile has the variance of its realisation, Σ|h|² (Parseval), to 1e-5. Single precision
// rounds each term by 1e-7.
TEST(HeightMap, HasTheVarianceOfItsRealisation) {
    Scene scene = first_order();
    scene.sea.swell = {{.height_m = 1.0, .period_s = 9.0, .direction_deg = 130.0}};
    scene.waves.cascades = {{300.0, 128}, {60.0, 96}};
    for (double t : {0.0, 3.7}) {
        const auto frame = frame_of<float>(scene,
                                           {tile(products(Product::Displacement), 0, 300.0, 128),
                                            tile(products(Product::Displacement), 1, 60.0, 96)},
                                           t);
        for (int c = 0; c < 2; ++c) {
            const double size_m = c == 0 ? 300.0 : 60.0;
            const auto map =
                sample(frame, c, tile_points<float>(size_m, c == 0 ? 128 : 96)).vectors(Displacement);
            const double mean = mean_of(map, [](auto d) { return d.z; });
            const double variance = mean_of(map, [](auto d) { return double(d.z) * d.z; });
            EXPECT_NEAR(variance / frame.realisation(c).m0, 1.0, 1e-5) << "cascade " << c << " at " << t;
            EXPECT_NEAR(mean, 0.0, 1e-6 * std::sqrt(variance));  // there is no mode 0
            // Σ|h|² from the modes.
            double sum = 0.0;
            for (const Mode& mode : modes_of(frame.sea(), c, t)) sum += 2.0 * std::norm(mode.height);
            EXPECT_NEAR(frame.realisation(c).m0 / sum, 1.0, 1e-5);
        }
    }
}

// Over 16 seeds the mean variance gives Hs to 5 %. m0 in a tile of nine peak waves deviates by 7 % from seed
// to seed, so the mean by 1.8 % and Hs by 0.9 %; the tolerance is five times that. A spurious √2 would be 41
// %.
TEST(HeightMap, HasTheSignificantHeightOfTheSpectrum) {
    Scene scene;
    scene.sea.spectrum = SpectrumKind::PiersonMoskowitz;  // peak wavelength 88 m at 10 m/s
    scene.waves.cascades = {{800.0, 160}};
    const DirectionalSpectrum spectrum(scene.sea);
    ASSERT_GE(800.0 * spectrum.peak_wavenumber() / (2.0 * kPi), 8.0);
    std::vector<double> variances;
    for (int seed = 1; seed <= 16; ++seed) {
        scene.shot.seed = seed;
        const auto frame = frame_of<float>(scene, {tile(products(Product::Displacement), 0, 800.0, 160)});
        variances.push_back(mean_of(sample(frame, 0, tile_points<float>(800.0, 160)).vectors(Displacement),
                                    [](auto d) { return double(d.z) * d.z; }));
    }
    // The band ends at k = 0.62 rad/m. Beyond it lies 1 % of m0.
    const double hs = 4.0 * std::sqrt(estimate(variances).mean);
    EXPECT_NEAR(hs / moments(spectrum, 0.0, kInfinity).significant_height_m(), 1.0, 0.05);
    // Seeds differ: by 7 %, within a factor of 2.
    EXPECT_GT(estimate(variances).standard_error * 4.0 / estimate(variances).mean, 0.035);
    EXPECT_LT(estimate(variances).standard_error * 4.0 / estimate(variances).mean, 0.14);
}

}  // namespace
}  // namespace pelagic
