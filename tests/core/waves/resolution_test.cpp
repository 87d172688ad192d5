// Doubling every resolution adds detail and changes nothing else.
#include <gtest/gtest.h>

#include <map>

#include "tests/core/waves/samples.h"

namespace pelagic {
namespace {

using namespace test;

Scene scene_with(int factor) {
    Scene scene;
    scene.sea.swell = {{.height_m = 1.0, .period_s = 9.0, .direction_deg = 60.0}};
    scene.waves.cascades = {{300.0, 70 * factor}, {80.0, 70 * factor}, {20.0, 70 * factor}};
    return scene;
}

TEST(DoubledResolution, KeepsEveryAmplitudeToTheBit) {
    const auto query = unfiltered(products(Product::Displacement));
    const auto coarse = frame_of<float>(scene_with(1), {query}),
               fine = frame_of<float>(scene_with(2), {query});
    for (int c = 0; c < 3; ++c) {
        const auto &few = coarse.sea().cascades()[c], &many = fine.sea().cascades()[c];
        ASSERT_GT(few.radius, 0);
        for (int mx = 0; mx < few.radius; ++mx)
            for (int my = -half_height(few.radius, mx); my <= half_height(few.radius, mx); ++my) {
                const std::size_t i = few.middle(mx) + my, j = many.middle(mx) + my;
                ASSERT_EQ(few.forward_re[i], many.forward_re[j]) << c << ' ' << mx << ' ' << my;
                ASSERT_EQ(few.forward_im[i], many.forward_im[j]);
                ASSERT_EQ(few.backward_re[i], many.backward_re[j]);
                ASSERT_EQ(few.backward_im[i], many.backward_im[j]);
                ASSERT_EQ(few.cycles_per_s[i], many.cycles_per_s[j]);
            }
    }
    EXPECT_GT(fine.sea().cascades()[2].radius, coarse.sea().cascades()[2].radius);  // detail was added
}

// The difference of one tile's surfaces, projected onto the modes of the coarser one.
TEST(DoubledResolution, ChangesNothingBelowTheOldBandLimit) {
    constexpr int kSideNodes = 144;
    for (int c = 0; c < 3; ++c) {
        const double size_m = scene_with(1).waves.cascades[c].size_m;
        const auto query = tile(products(Product::Displacement), c, size_m, kSideNodes);
        const auto coarse = frame_of<float>(scene_with(1), {query}, 1.5),
                   fine = frame_of<float>(scene_with(2), {query}, 1.5);
        const auto a = field_at_nodes(coarse, c, Field::Height), b = field_at_nodes(fine, c, Field::Height);
        const int radius = coarse.sea().cascades()[c].radius - 1;
        // The coefficient (mx, my) of b − a, by rows, then by columns.
        std::vector<std::complex<double>> rows(static_cast<std::size_t>(kSideNodes) * (2 * radius + 1));
        for (int y = 0; y < kSideNodes; ++y)
            for (int mx = -radius; mx <= radius; ++mx)
                for (int x = 0; x < kSideNodes; ++x) {
                    const std::size_t i = static_cast<std::size_t>(y) * kSideNodes + x;
                    rows[static_cast<std::size_t>(y) * (2 * radius + 1) + mx + radius] +=
                        (b[i] - a[i]) * std::polar(1.0, -2.0 * kPi * mx * x / kSideNodes);
                }
        double projected = 0.0, whole = 0.0;
        for (std::size_t i = 0; i < a.size(); ++i)
            whole += (b[i] - a[i]) * (b[i] - a[i]) / (1.0 * kSideNodes * kSideNodes);
        for (int my = -radius; my <= radius; ++my)
            for (int mx = -radius; mx <= radius; ++mx) {
                if (mx * mx + my * my >= (radius + 1) * (radius + 1)) continue;
                std::complex<double> sum = 0.0;
                for (int y = 0; y < kSideNodes; ++y)
                    sum += rows[static_cast<std::size_t>(y) * (2 * radius + 1) + mx + radius] *
                           std::polar(1.0, -2.0 * kPi * my * y / kSideNodes);
                projected += std::norm(sum / (1.0 * kSideNodes * kSideNodes));
            }
        const double hs = 4.0 * std::sqrt(coarse.realisation(0).m0);
        EXPECT_LT(std::sqrt(projected), 1e-6 * hs) << "cascade " << c;  // rounding; the requirement is 1e-4
        if (c == 2) {
            EXPECT_GT(whole, 100.0 * projected);
        }
    }
}

// The whole query through a footprint that both resolutions can show: all cascades, all products, also
// between nodes.
TEST(DoubledResolution, ChangesNothingThatAFootprintOfTheOldLimitShows) {
    // The finest tile of 20 m has 34 modes: wavelengths down to 0.588 m, two samples of 0.294 m each.
    const auto query = filtered(products(Product::Displacement, Product::Normal), 0.3);
    const auto coarse = frame_of<float>(scene_with(1), {query}, 1.5),
               fine = frame_of<float>(scene_with(2), {query}, 1.5);
    const auto points = random_points<float>(200.0, 2000);
    const auto a = sample(coarse, 0, points), b = sample(fine, 0, points);
    const double hs = 4.0 * std::sqrt(coarse.realisation(0).m0);
    for (std::size_t i = 0; i < points.size(); ++i)
        for (int axis = 0; axis < 3; ++axis) {
            ASSERT_NEAR(a.vectors(Displacement)[i][axis], b.vectors(Displacement)[i][axis], 1e-4 * hs);
            ASSERT_NEAR(a.vectors(Normal)[i][axis], b.vectors(Normal)[i][axis], 1e-3);
        }
}

}  // namespace
}  // namespace pelagic
