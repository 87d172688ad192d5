// The spectrum as polynomials and closed forms: the same Ψ as the formulas', everywhere.
#include "core/spectrum/spectrum_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "core/spectrum/density_kernels.h"
#include "tests/core/spectrum/oracles.h"

namespace pelagic {
namespace {

// S_k D at random wavevectors against DirectionalSpectrum's, to this part of it.
void expect_same_density(const SeaState& state, double tolerance = 3e-6) {
    const DirectionalSpectrum sea(state);
    const SpectrumTable table(sea);
    const DensityKernels kernels = density_kernels();
    std::mt19937 generator(7);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    double largest = 0.0;
    for (const TablePanel& panel : table.panels())
        largest = std::max(largest, sea.omnidirectional(0.5 * (panel.k_lo + panel.k_hi)) * panel.k_lo);
    for (const TablePanel& panel : table.panels()) {
        constexpr std::size_t kCount = 21;  // not whole vectors
        std::vector<double> k(kCount + kDensitySlack, 1.0), x(k), y(k);
        std::vector<std::vector<double>> sums(4, std::vector<double>(kCount + kDensitySlack));
        for (std::size_t i = 0; i < kCount; ++i) {
            k[i] = panel.k_lo + unit(generator) * (panel.k_hi - panel.k_lo);
            const double theta = 2.0 * oracle::kPi * unit(generator);
            x[i] = std::cos(theta);
            y[i] = std::sin(theta);
        }
        for (const TableTerm& term : table.terms(panel))
            kernels.add_density(panel, term, 1.0, kCount, k.data(), x.data(), y.data(),
                                {sums[0].data(), sums[1].data(), sums[2].data(), sums[3].data()});
        for (std::size_t i = 0; i < kCount; ++i) {
            const double all = sea.omnidirectional(k[i]);
            // Where the sea holds less than a millionth of its largest content it doesn't matter.
            const double content = all * k[i] / largest;
            if (content < 1e-6) continue;
            const double theta = std::atan2(y[i], x[i]);
            const double ways[] = {theta, theta + oracle::kPi, -theta, oracle::kPi - theta};
            for (int way = 0; way < 4; ++way) {
                const double expected = sea.polar(k[i], ways[way]);
                ASSERT_NEAR(sums[way][i] * k[i], expected, 1e-3 * expected + 1e-6 * all)
                    << "k " << k[i] << ", theta " << ways[way] << ", content " << content;
                ASSERT_NEAR(sums[way][i] * k[i], expected, tolerance * expected + 1e-6 * largest / k[i])
                    << "k " << k[i] << ", theta " << ways[way] << ", content " << content;
            }
        }
    }
}

TEST(SpectrumTable, IsEverySpectrumInEverySpreading) {
    for (SpectrumKind kind : oracle::kAnalytic)
        for (SpreadingKind spreading : oracle::kSpreadings)
            for (double wind : {0.1, 10.0, 80.0})
                for (double fetch : {1.0, 3e5})
                    for (double depth : {0.01, 8.0, oracle::kInfinity}) {
                        SCOPED_TRACE(testing::Message()
                                     << "spectrum " << static_cast<int>(kind) << ", spreading "
                                     << static_cast<int>(spreading) << ", wind " << wind << ", fetch "
                                     << fetch << ", depth " << depth);
                        SeaState state;
                        state.spectrum = kind;
                        state.spreading = spreading;
                        state.wind_speed_mps = wind;
                        state.wind_direction_deg = 37.0;
                        state.fetch_m = fetch;
                        state.depth_m = depth;
                        // On a metre of fetch a gale's spreading widens from needle to circle within 5 % of
                        // k.
                        expect_same_density(state, wind == 80.0 && fetch == 1.0 ? 1e-3 : 3e-6);
                        if (testing::Test::HasFatalFailure()) return;
                    }
}

TEST(SpectrumTable, IsSwellsAndMeasuredSeas) {
    SeaState state;
    state.wind_direction_deg = -120.0;
    state.swell = {{1.5, 11.0, 80.0}, {0.4, 17.0, 200.0}};
    expect_same_density(state);
    state.depth_m = 0.5;
    expect_same_density(state);
    state.depth_m = oracle::kInfinity;
    state.spectrum = SpectrumKind::File;
    state.measured = oracle::made_up_buoy();
    expect_same_density(state);
    for (auto& bin : state.measured->bins) {  // the narrowest needles that there are
        bin.c1_re = 0.0, bin.c1_im = 1.0;
        bin.c2_re = -1.0, bin.c2_im = 0.0;
    }
    expect_same_density(state);
}

TEST(SpectrumTable, IsNarrowerAndWiderSeas) {
    for (const double directionality : {0.3, 2.0, 5.0}) {
        for (const SpreadingKind spreading : oracle::kSpreadings) {
            SeaState state;
            state.spreading = spreading;
            state.wind_direction_deg = 37.0;
            state.directionality = directionality;
            SCOPED_TRACE(testing::Message() << static_cast<int>(spreading) << ", " << directionality);
            expect_same_density(state);
        }
        SeaState measured;
        measured.spectrum = SpectrumKind::File;
        measured.measured = oracle::made_up_buoy();
        measured.swell = {{1.5, 11.0, 80.0}};
        measured.directionality = directionality;
        expect_same_density(measured);
    }
}

TEST(SpectrumTable, OfACalmIsEmpty) {
    SeaState state;
    state.wind_speed_mps = 0.0;
    const DirectionalSpectrum sea(state);
    const SpectrumTable table(sea);
    EXPECT_TRUE(table.panels().empty());
}

}  // namespace
}  // namespace pelagic
