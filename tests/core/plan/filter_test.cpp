// What a footprint lets through, and the half plane of modes.
#include "core/plan/filter.h"

#include <gtest/gtest.h>

#include <set>

#include "core/plan/mode_lattice.h"

namespace pelagic {
namespace {

constexpr double kPi = std::numbers::pi;

// Bruneton et al. 2010, §3.2: 3x̄² − 2x̄³ in samples per wavelength; nothing at Nyquist and beyond, everything
// at four.
TEST(FootprintFilter, IsThePapersSmoothStepFromNyquistUp) {
    const FootprintFilter filter;
    const auto at = [&](double samples) { return filter.weight(2.0 * kPi / (samples * 0.5), 0.5); };
    EXPECT_EQ(at(2.0 * (1.0 - 1e-12)), 0.0);
    EXPECT_EQ(at(0.1), 0.0);
    EXPECT_NEAR(at(2.5), 3.0 / 16.0 - 2.0 / 64.0, 1e-14);
    EXPECT_NEAR(at(3.0), 0.5, 1e-14);
    EXPECT_EQ(at(4.0 * (1.0 + 1e-12)), 1.0);
    double before = -1.0;
    for (double samples = 1.5; samples < 5.0; samples += 0.01) {
        EXPECT_GE(at(samples), before);
        before = at(samples);
    }
}

TEST(FootprintFilter, CutsOffWhereTheWeightEnds) {
    const FootprintFilter filter;
    const double k = filter.cutoff(0.5);
    EXPECT_EQ(filter.weight(k * (1.0 + 1e-9), 0.5), 0.0);
    EXPECT_GT(filter.weight(k * (1.0 - 1e-3), 0.5), 0.0);
    EXPECT_NEAR(k, kPi / 0.5, 1e-12);  // Nyquist
    EXPECT_EQ(filter.weight(1e6, 0.0), 1.0);
    EXPECT_TRUE(std::isinf(filter.cutoff(0.0)));
}

// With its mirror image the half is the whole disc without its centre, each wave once; column 0 stands whole.
TEST(ModeLattice, HoldsEachWaveOfTheDiscOnce) {
    for (int radius : {1, 2, 5, 13, 50}) {
        std::set<std::pair<int, int>> seen;
        std::size_t count = 0;
        for (int mx = 0; mx < radius; ++mx) {
            const int height = half_height(radius, mx);
            EXPECT_EQ(column_length(radius, mx), 2u * height + 1u);
            for (int my = -height; my <= height; ++my, ++count) {
                if (!counts_as_wave(mx, my)) continue;
                EXPECT_TRUE(seen.insert({mx, my}).second);
                EXPECT_TRUE(seen.insert({-mx, -my}).second);
            }
        }
        EXPECT_EQ(count, lattice_modes(radius));
        std::size_t disc = 0;
        for (int y = -radius; y <= radius; ++y)
            for (int x = -radius; x <= radius; ++x)
                if (x * x + y * y > 0 && x * x + y * y < radius * radius) {
                    ++disc;
                    EXPECT_TRUE(seen.contains({x, y})) << radius << ' ' << x << ' ' << y;
                }
        EXPECT_EQ(seen.size(), disc);
        EXPECT_EQ(count, disc / 2 + radius);  // column 0's lower half and (0, 0)
    }
    EXPECT_EQ(lattice_modes(0), 0u);
}

}  // namespace
}  // namespace pelagic
