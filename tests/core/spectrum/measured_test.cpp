// A buoy's hour: energy, periods and directions come back as measured.
#include "core/spectrum/measured.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "core/spectrum/spectral_moments.h"
#include "tests/core/spectrum/oracles.h"

namespace pelagic {
namespace {

// Σ over the bins as NDBC sums them.
struct Binned {
    double m0 = 0.0;
    double m_minus1_hz = 0.0;
    std::complex<double> first{};
    double tm10() const { return m_minus1_hz / m0; }
};

Binned binned(const MeasuredSpectrum& hour) {
    Binned sum;
    const std::vector<double> edges = bin_edges(hour);
    for (std::size_t i = 0; i < hour.bins.size(); ++i) {
        const auto& bin = hour.bins[i];
        const double energy = bin.density_m2_per_hz * (edges[i + 1] - edges[i]);
        sum.m0 += energy;
        sum.m_minus1_hz += energy / bin.frequency_hz;
        if (bin.has_direction) sum.first += energy * std::complex(bin.c1_re, bin.c1_im);
    }
    return sum;
}

DirectionalSpectrum sea_of(const MeasuredSpectrum& hour) {
    SeaState state;
    state.spectrum = SpectrumKind::File;
    state.short_waves = ShortWaves::None;  // the buoy's own waves
    state.measured = hour;
    return DirectionalSpectrum(state);
}

double degrees_apart(double a, double b) {
    return std::abs(std::remainder(a - b, 2 * oracle::kPi)) * 180.0 / oracle::kPi;
}

SpectralMoments buoy_band(const DirectionalSpectrum& sea, const MeasuredSpectrum& hour) {
    const std::vector<double> edges = bin_edges(hour);
    const auto k = [&](double hz) { return sea.dispersion().wavenumber(2 * oracle::kPi * hz); };
    return moments(sea, k(edges.front()), k(edges.back()));
}

TEST(Measured, BandsAreNdbcs) {
    const MeasuredSpectrum hour = oracle::made_up_buoy();
    const std::vector<double> edges = bin_edges(hour);
    for (std::size_t i = 1; i < hour.bins.size(); ++i) {
        const double hz = hour.bins[i].frequency_hz;
        EXPECT_NEAR(edges[i + 1] - edges[i], hz < 0.095 ? 0.005 : hz < 0.355 ? 0.01 : 0.02, 1e-12) << hz;
    }
}

TEST(Measured, BandsOfAnyFrequenciesHoldTheirBins) {
    for (const std::vector<double>& hz :
         {std::vector{0.1, 0.2}, std::vector{0.04, 0.0452, 0.0511, 0.0577, 0.0652},
          std::vector{0.1, 0.11, 0.3, 0.31, 0.9}}) {
        MeasuredSpectrum hour;
        for (double f : hz) hour.bins.push_back({f, 1.0, 0, 0, 0, 0, false});
        const std::vector<double> edges = bin_edges(hour);
        EXPECT_GT(edges[0], 0.0);
        for (std::size_t i = 0; i < hz.size(); ++i) {
            EXPECT_LT(edges[i], hz[i]);
            EXPECT_GT(edges[i + 1], hz[i]);
        }
    }
}

TEST(Measured, EnergyOfEveryReliableBinIsItsOwn) {
    // Within a band the parabola's mean is the density; the scale that makes up for the tail's rounding stays
    // near 1.
    const MeasuredSpectrum hour = oracle::made_up_buoy();
    const MeasuredEnergy law(hour);
    const std::vector<double> edges = bin_edges(hour);
    for (std::size_t i = 0; i < hour.bins.size(); ++i) {
        if (hour.bins[i].density_m2_per_hz < 0.05) continue;
        const double a = 2 * oracle::kPi * edges[i], b = 2 * oracle::kPi * edges[i + 1];
        // Just inside, because a density may jump at an edge; Simpson is exact for parabolas.
        const double in_band =
            oracle::simpson(a + 1e-12, b - 1e-12, 10, [&](double w) { return law.density(w); });
        EXPECT_NEAR(in_band / (hour.bins[i].density_m2_per_hz * (edges[i + 1] - edges[i])), 1.0, 2e-3);
    }
    for (double w = 0.0; w < 100.0; w += 0.01) EXPECT_GE(law.density(w), 0.0);
}

TEST(Measured, HeightPeriodAndDirectionComeBack) {
    const MeasuredSpectrum hour = oracle::made_up_buoy();
    const DirectionalSpectrum sea = sea_of(hour);
    const Binned buoy = binned(hour);
    EXPECT_NEAR(buoy_band(sea, hour).m0 / buoy.m0, 1.0, 1e-6);
    const SpectralMoments all = moments(sea, 0.0, oracle::kInfinity);
    EXPECT_NEAR(all.significant_height_m() / (4.0 * std::sqrt(buoy.m0)), 1.0, 0.01);
    EXPECT_NEAR(all.energy_period_s() / buoy.tm10(), 1.0, 0.02);
    EXPECT_LT(degrees_apart(all.mean_direction(), std::arg(buoy.first)), 1.0);
}

TEST(Measured, ARealBuoysHoursComeBack) {
    const std::string folder = std::string(PELAGIC_SOURCE_DIR) + "/../shared/data/ndbc-41010";
    // [d, i, j, k, w] of one hour; 999 is missing.
    std::vector<std::vector<std::vector<double>>> tables;
    std::vector<double> hz;
    for (char kind : std::string("wdijk")) {
        std::ifstream file(folder + kind + "2019.txt");
        if (!file) GTEST_SKIP() << "no real buoy beside the project: " << folder << kind << "2019.txt";
        std::string line;
        std::getline(file, line);
        std::istringstream head(line);
        std::string word;
        for (int i = 0; i < 5; ++i) head >> word;
        hz.clear();
        for (double f; head >> f;) hz.push_back(f);
        tables.emplace_back();
        while (std::getline(file, line)) {
            std::istringstream row(line);
            tables.back().emplace_back();
            for (double v; row >> v;) tables.back().back().push_back(v);
        }
    }
    ASSERT_GE(tables[0].size(), 90u);
    for (std::size_t h = 0; h < tables[0].size(); ++h) {
        MeasuredSpectrum hour;
        for (std::size_t i = 0; i < hz.size(); ++i) {
            const auto value = [&](std::size_t kind) { return tables[kind][h][i + 5]; };
            const bool known = value(1) < 999 && value(2) < 999 && value(3) < 999 && value(4) < 999;
            const auto c1 = std::polar(value(3) / 100, (270 - value(1)) * oracle::kPi / 180);
            const auto c2 = std::polar(value(4) / 100, 2 * (270 - value(2)) * oracle::kPi / 180);
            hour.bins.push_back({hz[i], value(0), c1.real(), c1.imag(), c2.real(), c2.imag(), known});
        }
        SCOPED_TRACE(testing::Message() << "hour " << h);
        const Binned buoy = binned(hour);
        const DirectionalSpectrum sea = sea_of(hour);
        const SpectralMoments all = moments(sea, 0.0, oracle::kInfinity);
        EXPECT_NEAR(std::sqrt(buoy_band(sea, hour).m0 / buoy.m0), 1.0, 1e-6);
        EXPECT_NEAR(all.significant_height_m() / (4.0 * std::sqrt(buoy.m0)), 1.0, 0.01);
        EXPECT_NEAR(all.energy_period_s() / buoy.tm10(), 1.0, 0.02);
        EXPECT_LT(degrees_apart(all.mean_direction(), std::arg(buoy.first)), 1.0);
    }
}

TEST(Measured, TheTailFallsBetweenTheFourthAndTheFifthPower) {
    const MeasuredEnergy law(oracle::made_up_buoy());
    const double end = law.edge_omegas().back();
    EXPECT_NEAR(law.density(4.0 * end) / law.density(2.0 * end), 1.0 / 32.0, 1e-12);
    EXPECT_GT(law.density(2.0 * end), 0.0);
}

TEST(Measured, MissingDirectionsAreFilledFromNeighbours) {
    MeasuredSpectrum hour;
    for (int i = 0; i < 5; ++i) hour.bins.push_back({0.1 + 0.01 * i, 1.0, 0.0, 0.0, 0.0, 0.0, false});
    const auto at = [&](double hz, double wind) {
        return MeasuredSpreading(hour, wind).at(2 * oracle::kPi * hz).harmonic(1);
    };
    EXPECT_NEAR(std::arg(at(0.12, 0.7)), 0.7, 1e-12);  // no direction at all: the wind's

    hour.bins[1] = {0.11, 1.0, 0.8, 0.0, 0.5, 0.0, true};
    hour.bins[3] = {0.13, 1.0, 0.0, 0.8, -0.5, 0.0, true};
    EXPECT_NEAR(std::abs(at(0.10, 0.7) - 0.8), 0.0, 1e-12);
    EXPECT_NEAR(std::abs(at(0.12, 0.7) - std::complex(0.4, 0.4)), 0.0, 1e-12);
    EXPECT_NEAR(std::abs(at(0.14, 0.7) - std::complex(0.0, 0.8)), 0.0, 1e-12);
    hour.bins[3].c2_re = std::nan("");
    EXPECT_NEAR(std::abs(at(0.13, 0.7) - 0.8), 0.0, 1e-12);
}

TEST(Measured, NonsenseIsRefused) {
    SeaState state;
    state.spectrum = SpectrumKind::File;
    EXPECT_THROW(DirectionalSpectrum{state}, std::invalid_argument);
    const auto refused = [&](std::vector<MeasuredSpectrum::Bin> bins) {
        state.measured = MeasuredSpectrum{};
        state.measured->bins = std::move(bins);
        EXPECT_THROW(DirectionalSpectrum{state}, std::invalid_argument);
    };
    refused({});
    refused({{0.1, 1.0, 0, 0, 0, 0, false}});
    refused({{0.2, 1.0, 0, 0, 0, 0, false}, {0.1, 1.0, 0, 0, 0, 0, false}});
    refused({{0.1, 1.0, 0, 0, 0, 0, false}, {0.2, -1.0, 0, 0, 0, 0, false}});
    refused({{0.1, 1.0, 0, 0, 0, 0, false}, {0.2, std::nan(""), 0, 0, 0, 0, false}});
}

TEST(Measured, AnHourWithoutWavesIsACalm) {
    MeasuredSpectrum hour = oracle::made_up_buoy();
    for (auto& bin : hour.bins) bin.density_m2_per_hz = 0.0;
    EXPECT_TRUE(sea_of(hour).empty());
    hour.bins[20].density_m2_per_hz = 0.01;  // below every threshold, but energy
    const DirectionalSpectrum sea = sea_of(hour);
    EXPECT_NEAR(buoy_band(sea, hour).m0 / binned_m0(hour), 1.0, 1e-6);
}

}  // namespace
}  // namespace pelagic
