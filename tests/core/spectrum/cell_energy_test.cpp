// Energy integrated over the cells of wavevector grids: nothing lost, nothing counted twice. The grids are
// the product's, single cells the reference's.
#include "core/spectrum/cell_energies.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/spectrum/spectral_moments.h"
#include "tests/core/spectrum/cell_energy.h"
#include "tests/core/spectrum/oracles.h"

namespace pelagic {
namespace {

// Σ over all cells of a grid for a tile of this size, n modes to each side, within a band. The cell of the
// origin is no wave: the reference adds it.
double grid_energy(const DirectionalSpectrum& sea, double size_m, int n, double k_lo, double k_hi) {
    const SpectrumTable table(sea);
    const CellEnergies cells(table, size_m, k_lo, k_hi);
    std::vector<std::vector<double>> rows(4, std::vector<double>(n + 1 + kDensitySlack));
    const double half = oracle::kPi / size_m;
    double sum = oracle::cell_energy(sea, {-half, half, -half, half, k_lo, k_hi});
    for (int mx = 0; mx <= n; ++mx) {
        cells.column(mx, n, {rows[0].data(), rows[1].data(), rows[2].data(), rows[3].data()});
        for (int my = 0; my <= n; ++my) {
            sum += rows[0][my] + rows[1][my];
            if (mx > 0 && my > 0) sum += rows[2][my] + rows[3][my];
        }
    }
    return sum;
}

// The band's energy by Simpson's rule between the kinks.
double band_energy(const DirectionalSpectrum& sea, double k_lo, double k_hi) {
    std::vector<double> edges = {std::max(k_lo, 1e-4)};
    for (double kink : sea.kinks()) {
        if (kink > edges[0] && kink < k_hi) edges.push_back(kink);
    }
    edges.push_back(k_hi);
    double sum = 0.0;
    for (std::size_t i = 1; i < edges.size(); ++i) {
        // Just inside, on the right side of jumps.
        sum += oracle::log_simpson(edges[i - 1] * (1 + 1e-12), edges[i] * (1 - 1e-12), 2000,
                                   [&](double k) { return sea.omnidirectional(k); });
    }
    return sum;
}

TEST(CellEnergy, CellsOfAGridAddUpToTheBandForEverySpectrum) {
    for (SpectrumKind kind : oracle::kAnalytic) {
        for (SpreadingKind spreading : oracle::kSpreadings) {
            SeaState state;
            state.spectrum = kind;
            state.spreading = spreading;
            state.wind_direction_deg = 23.0;
            state.depth_m = kind == SpectrumKind::Tma ? 8.0 : oracle::kInfinity;
            const DirectionalSpectrum sea(state);
            for (double lo : {0.0, 0.04}) {
                const double hi = 45 * 2 * oracle::kPi / 300.0;  // inside the grid's 47.5
                // The contract is 1e-3; the rules here promise 1e-4 and reach 1e-5.
                EXPECT_NEAR(grid_energy(sea, 300.0, 47, lo, hi) / band_energy(sea, lo, hi), 1.0, 2e-5)
                    << "spectrum " << static_cast<int>(kind) << ", spreading " << static_cast<int>(spreading)
                    << ", lo " << lo;
            }
        }
    }
}

TEST(CellEnergy, SwellsOnTilesOfEverySizeAreWhole) {
    for (double period : {5.0, 8.0, 11.0, 20.0}) {
        for (double size : {100.0, 400.0, 2000.0}) {
            for (double direction : {0.0, 45.0, 80.0}) {
                SeaState state;
                state.wind_speed_mps = 0.0;
                state.swell = {{1.5, period, direction}};
                const DirectionalSpectrum sea(state);
                const double hi = std::max(2.5 * sea.peak_wavenumber(), 2 * oracle::kPi / size * 4);
                const int n = static_cast<int>(std::ceil(hi * size / (2 * oracle::kPi))) + 1;
                // All of the swell is below 2.5 kp: ω = 1.58 ωp is 8 σ away.
                EXPECT_NEAR(grid_energy(sea, size, n, 0.0, hi) / sea.m0(), 1.0, 2e-5)
                    << period << " s on " << size << " m towards " << direction;
            }
        }
    }
}

TEST(CellEnergy, MeasuredSeasAreWhole) {
    SeaState state;
    state.spectrum = SpectrumKind::File;
    state.measured = oracle::made_up_buoy();
    const DirectionalSpectrum sea(state);
    for (double size : {150.0, 600.0}) {
        const double hi = 60 * 2 * oracle::kPi / size;
        EXPECT_NEAR(grid_energy(sea, size, 63, 0.0, hi) / band_energy(sea, 0.0, hi), 1.0, 1e-4) << size;
    }
}

TEST(CellEnergy, NeighbouringBandsShareNothing) {
    SeaState state;
    state.swell = {{1.0, 9.0, 60.0}};
    const DirectionalSpectrum sea(state);
    const oracle::Cell cell{0.02, 0.06, 0.0, 0.05};
    for (double edge : {0.03, 0.04, 0.0499, 0.07}) {
        oracle::Cell below = cell, above = cell;
        below.k_hi = above.k_lo = edge;
        EXPECT_NEAR((oracle::cell_energy(sea, below) + oracle::cell_energy(sea, above)) /
                        oracle::cell_energy(sea, cell),
                    1.0, 1e-5)
            << edge;
    }
}

TEST(CellEnergy, PartsOfACellAddUpToIt) {
    SeaState state;
    state.swell = {{1.0, 9.0, 60.0}};
    const DirectionalSpectrum sea(state);
    // Over the origin; on a side of it; across an axis; far out, where the product rule works.
    for (const oracle::Cell& whole :
         {oracle::Cell{-0.1, 0.15, -0.2, 0.1}, oracle::Cell{0.0, 0.1, -0.05, 0.05},
          oracle::Cell{0.1, 0.2, -0.02, 0.06}, oracle::Cell{2.0, 2.05, 1.0, 1.05}}) {
        double sum = 0.0;
        for (int y = 0; y < 5; ++y) {
            for (int x = 0; x < 5; ++x) {
                const double w = (whole.kx1 - whole.kx0) / 5, h = (whole.ky1 - whole.ky0) / 5;
                sum += oracle::cell_energy(sea, {whole.kx0 + x * w, whole.kx0 + (x + 1) * w,
                                                 whole.ky0 + y * h, whole.ky0 + (y + 1) * h});
            }
        }
        EXPECT_NEAR(sum / oracle::cell_energy(sea, whole), 1.0, 1e-5) << whole.kx0;
    }
}

TEST(CellEnergy, AJumpFarOutIsNotSmoothedOver) {
    // ω⁻² begins at kc: a band that begins there too takes nothing away.
    SeaState state;
    state.spectrum = SpectrumKind::Omega2;
    const DirectionalSpectrum sea(state);
    const double kc = sea.peak_wavenumber(), side = kc / 60;
    const oracle::Cell cell{kc - 0.3 * side, kc + 0.7 * side, -0.5 * side, 0.5 * side};
    oracle::Cell above = cell;
    above.k_lo = kc;
    EXPECT_NEAR(oracle::cell_energy(sea, cell) / oracle::cell_energy(sea, above), 1.0, 1e-6);
}

TEST(CellEnergy, AQuarterPlaneHoldsItsQuarter) {
    // Isotropic only for the eye: wind along the diagonal makes the first and the opposite quarters mirror
    // images.
    SeaState state;
    state.wind_direction_deg = 45.0;
    const DirectionalSpectrum sea(state);
    const double all = oracle::cell_energy(sea, {-9, 9, -9, 9});
    const double left = oracle::cell_energy(sea, {-9, 0, 0, 9}),
                 right = oracle::cell_energy(sea, {0, 9, -9, 0});
    EXPECT_NEAR(left, right, 1e-6 * all);
    EXPECT_NEAR(
        oracle::cell_energy(sea, {0, 9, 0, 9}) + oracle::cell_energy(sea, {-9, 0, -9, 0}) + left + right, all,
        1e-6 * all);
    EXPECT_EQ(oracle::cell_energy(sea, {0.1, 0.2, 0.1, 0.2, 0.3, 0.4}), 0.0);  // the band misses the cell
}

}  // namespace
}  // namespace pelagic
