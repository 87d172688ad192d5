// The energies of a cascade's modes against the reference: every cell by itself, and what bands hold.
#include "core/spectrum/cell_energies.h"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <array>
#include <cmath>
#include <vector>

#include "core/spectrum/spectral_moments.h"
#include "tests/core/spectrum/cell_energy.h"
#include "tests/core/spectrum/oracles.h"

namespace pelagic {
namespace {

using oracle::kInfinity;

struct Column {
    explicit Column(const CellEnergies& cells, int mx, int height)
        : rows(4, std::vector<double>(height + 1 + kDensitySlack, -1.0)) {
        cells.column(mx, height, {rows[0].data(), rows[1].data(), rows[2].data(), rows[3].data()});
    }
    std::vector<std::vector<double>> rows;  // (mx, my), (−mx, −my), (mx, −my), (−mx, my)
};
constexpr int kSignX[] = {1, -1, 1, -1}, kSignY[] = {1, -1, -1, 1};

struct Band {
    double size_m, k_lower, k_upper;
    int radius;
};

// Every moment of the band's cells within 1e-4 of the reference's: of the trace for those that may cancel.
// And no single cell off by 1e-4 of the band.
void expect_reference(const SeaState& state, const Band& band) {
    const DirectionalSpectrum sea(state);
    const SpectrumTable table(sea);
    const CellEnergies cells(table, band.size_m, band.k_lower, band.k_upper);
    const double step = 2.0 * oracle::kPi / band.size_m;
    struct Sums {
        SpectralMoments ours, reference;
        double worst = 0.0;
    };
    std::vector<Sums> columns(band.radius);
    tbb::parallel_for(0, band.radius, [&](int mx) {
        const int height = band.radius - 1;
        const Column column(cells, mx, height);
        for (int my = 0; my <= height; ++my)
            for (int way = 0; way < 4; ++way) {
                if (mx == 0 && my == 0) continue;
                const double x = kSignX[way] * mx * step, y = kSignY[way] * my * step;
                const double expected =
                    oracle::cell_energy(sea, {x - 0.5 * step, x + 0.5 * step, y - 0.5 * step, y + 0.5 * step,
                                              band.k_lower, band.k_upper});
                const double energy = column.rows[way][my];
                columns[mx].worst = std::max(columns[mx].worst, std::abs(energy - expected));
                if (way > 1 && (mx == 0 || my == 0)) continue;  // once each
                const double k = std::hypot(x, y);
                const Wave wave{.k = {x, y},
                                .energy = 1.0,
                                .omega = sea.dispersion().omega(k),
                                .chop = sea.dispersion().horizontal_ratio(k) / k};
                SpectralMoments part = moments_of(wave), same = part;
                columns[mx].ours += part *= energy;
                columns[mx].reference += same *= expected;
            }
    });
    Sums all;
    for (const Sums& column : columns) {
        all.ours += column.ours;
        all.reference += column.reference;
        all.worst = std::max(all.worst, column.worst);
    }
    const SpectralMoments& r = all.reference;
    EXPECT_LE(all.worst, 1e-4 * r.m0);
    const double gradient = r.xxxx + 2.0 * r.xxyy + r.yyyy;
    for (double SpectralMoments::*m : kSpectralMoments) {
        const bool is_slope =
            m == &SpectralMoments::xx || m == &SpectralMoments::xy || m == &SpectralMoments::yy;
        const bool is_height =
            m == &SpectralMoments::m0 || m == &SpectralMoments::east || m == &SpectralMoments::north;
        const double scale = is_slope                          ? r.mss()
                             : is_height                       ? r.m0
                             : m == &SpectralMoments::m_minus1 ? r.m_minus1
                                                               : gradient;
        EXPECT_NEAR(all.ours.*m, r.*m, 1e-4 * scale) << "moment " << (m == &SpectralMoments::m0 ? "m0" : "");
    }
}

// Bands as cascades have them: the one that holds the peak, and shorter waves between two edges.
std::vector<Band> bands_about(double peak_wavenumber) {
    const double size_m = 2.0 * oracle::kPi / peak_wavenumber * 10.0, step = 2.0 * oracle::kPi / size_m;
    const double short_step = 4.2 * step;
    return {{size_m, 0.0, 20.3 * step, 22},
            {size_m / 4.2, 5.0 * short_step, 16.7 * short_step, 18},
            {size_m / 7.0, 0.0, kInfinity, 12}};  // the peak at 1.4 modes
}

TEST(CellEnergies, AreTheReferencesForEverySpectrumAndSpreading) {
    for (SpectrumKind kind : oracle::kAnalytic)
        for (SpreadingKind spreading : oracle::kSpreadings) {
            SeaState state;
            state.spectrum = kind;
            state.spreading = spreading;
            state.wind_direction_deg = 23.0;
            if (kind == SpectrumKind::Tma) state.depth_m = 8.0;
            SCOPED_TRACE(testing::Message() << "spectrum " << static_cast<int>(kind) << ", spreading "
                                            << static_cast<int>(spreading));
            for (const Band& band : bands_about(DirectionalSpectrum(state).peak_wavenumber()))
                expect_reference(state, band);
        }
}

TEST(CellEnergies, AreTheReferencesInHardCases) {
    int cases = 0;
    for (double wind : {0.1, 80.0})
        for (double fetch : {1.0, 1e7})
            for (double depth : {0.01, kInfinity}) {
                SeaState state;
                // Each spectrum and spreading has its turn.
                state.spectrum = oracle::kAnalytic[cases % oracle::kAnalytic.size()];
                state.spreading = oracle::kSpreadings[cases % oracle::kSpreadings.size()];
                ++cases;
                state.wind_speed_mps = wind;
                state.fetch_m = fetch;
                state.depth_m = depth;
                state.wind_direction_deg = -70.0;
                SCOPED_TRACE(testing::Message()
                             << "wind " << wind << ", fetch " << fetch << ", depth " << depth);
                for (const Band& band : bands_about(DirectionalSpectrum(state).peak_wavenumber()))
                    expect_reference(state, band);
            }
}

TEST(CellEnergies, AreTheReferencesForSwellsOnFewModes) {
    for (double period : {6.0, 11.0, 16.0})
        for (double direction : {0.0, 45.0, 80.0}) {
            SeaState state;
            state.wind_speed_mps = 0.0;
            state.swell = {{1.5, period, direction}};
            SCOPED_TRACE(testing::Message() << "period " << period << ", direction " << direction);
            expect_reference(state, {400.0, 0.0, kInfinity, 20});  // 11 s: mode 2
        }
}

TEST(CellEnergies, AreTheReferencesForMeasuredSeas) {
    SeaState state;
    state.spectrum = SpectrumKind::File;
    state.measured = oracle::made_up_buoy();
    expect_reference(state, {1800.0, 0.0, kInfinity, 40});
    expect_reference(state, {400.0, 0.13, 0.6, 40});
}

// Far out, where a cell has four nodes and then one: what a power law and a swell lose there.
TEST(CellEnergies, AreTheReferencesFarOut) {
    SeaState state;
    state.swell = {{1.0, 9.0, 60.0}};
    const DirectionalSpectrum sea(state);
    const SpectrumTable table(sea);
    const double size_m = 12000.0,
                 step = 2.0 * oracle::kPi / size_m;  // the swell at mode 95, the wind's peak at 137
    const CellEnergies cells(table, size_m, 0.0, kInfinity);
    double sum = 0.0, reference = 0.0, off = 0.0;
    for (int mx = 1; mx < 400; mx += 9) {
        const Column column(cells, mx, 400);
        for (int my = 1; my <= 400; my += 7)
            for (int way = 0; way < 4; ++way) {
                const double x = kSignX[way] * mx * step, y = kSignY[way] * my * step;
                const double expected = oracle::cell_energy(
                    sea, {x - 0.5 * step, x + 0.5 * step, y - 0.5 * step, y + 0.5 * step});
                sum += column.rows[way][my];
                reference += expected;
                off += std::abs(column.rows[way][my] - expected);
            }
    }
    EXPECT_NEAR(sum / reference, 1.0, 3e-5);
    EXPECT_LT(off, 5e-5 * reference);
}

// Bits: whatever the height that is asked for, and for both names of a mode on an axis.
TEST(CellEnergies, DependOnTheModeAlone) {
    SeaState state;
    state.swell = {{1.0, 9.0, 60.0}};
    const DirectionalSpectrum sea(state);
    const SpectrumTable table(sea);
    const CellEnergies cells(table, 900.0, 0.02, 3.1);
    for (int mx : {0, 1, 7, 50, 211, 430}) {
        const Column tall(cells, mx, 461);
        for (int height : {0, 1, 6, 100, 333}) {
            const Column low(cells, mx, height);
            for (int way = 0; way < 4; ++way)
                for (int my = 0; my <= height; ++my)
                    ASSERT_EQ(low.rows[way][my], tall.rows[way][my]) << mx << ' ' << my;
        }
        if (mx == 0)
            for (int my = 0; my <= 461; ++my) {
                ASSERT_EQ(tall.rows[0][my], tall.rows[3][my]) << my;
                ASSERT_EQ(tall.rows[1][my], tall.rows[2][my]) << my;
            }
    }
    EXPECT_EQ(Column(cells, 0, 0).rows[0][0], 0.0);
}

TEST(CellEnergies, OfACalmAreNothing) {
    SeaState state;
    state.wind_speed_mps = 0.0;
    const DirectionalSpectrum sea(state);
    const SpectrumTable table(sea);
    const CellEnergies cells(table, 100.0, 0.0, kInfinity);
    const Column column(cells, 3, 20);
    for (int way = 0; way < 4; ++way)
        for (int my = 0; my <= 20; ++my) EXPECT_EQ(column.rows[way][my], 0.0);
}

}  // namespace
}  // namespace pelagic
