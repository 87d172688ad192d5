// The passes of pictures with a shutter or a lens: which pixel takes which, and where.
#include "plugin/render/passes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <set>
#include <utility>
#include <vector>

namespace pelagic {
namespace {

constexpr int kFrame = 12;

RenderOptions options_of(int samples, double shutter_frames) {
    RenderOptions options;
    options.samples = samples;
    options.shutter_frames = shutter_frames;
    return options;
}

PicturePasses passes(int samples) {
    Camera camera;
    camera.f_stop = 2.8;
    return passes_of(camera, kFrame, options_of(samples, 0.5));
}

// Each pixel has as many samples as asked for, of moments spread over all of the shutter's time, and one in each part of itself.
TEST(Passes, APixelTakesOneOfEachStratumAndHasOneInEachOfItsParts) {
    for (const int n : {2, 3, 5}) {
        const auto [all, parts] = passes(n);
        ASSERT_EQ(all.size(), 1u + static_cast<std::size_t>(n * n * parts));
        for (const glm::ivec2 pixel : {glm::ivec2(0), {17, 3}, {1279, 719}, {65535, 1}}) {
            std::set<int> strata;
            std::set<std::pair<int, int>> cells;
            for (std::size_t i = 1; i < all.size(); ++i) {
                const PixelPlace place = place_of(all[i], parts, n, kFrame, pixel);
                if (!place.is_taken()) continue;
                EXPECT_TRUE(strata.insert(all[i].stratum).second);
                EXPECT_TRUE(place.x >= -128 && place.x <= 127 && place.y >= -128 && place.y <= 127);
                cells.emplace((place.x + 128) * n / 256, (place.y + 128) * n / 256);
                const double begins = kFrame + 0.5 * (all[i].stratum / static_cast<double>(n * n) - 0.5);
                EXPECT_TRUE(all[i].frame > begins && all[i].frame < begins + 0.5 / (n * n));
            }
            EXPECT_EQ(strata.size(), static_cast<std::size_t>(n * n));
            EXPECT_EQ(cells.size(), static_cast<std::size_t>(n * n));
        }
    }
}

// Each sample of a pixel has a height and a column of its own, as blurred ones do.
TEST(Passes, SamplesShareNoRowAndNoColumn) {
    for (const int n : {1, 2, 3, 4, 16}) {
        std::set<long> rows, columns;
        for (int i = 0; i < n * n; ++i) {
            const glm::ivec2 cell(i % n, i / n);
            const glm::dvec2 place = glm::dvec2(cell) + 0.5 + place_in_cell(n, cell);
            EXPECT_EQ(glm::ivec2(place), cell);
            columns.insert(std::lround(n * place.x - 0.5));
            rows.insert(std::lround(n * place.y - 0.5));
        }
        EXPECT_EQ(rows.size(), static_cast<std::size_t>(n * n));
        EXPECT_EQ(columns.size(), static_cast<std::size_t>(n * n));
        if (n > 4) continue;
        const auto [all, parts] = passes(n > 1 ? n : 2);
        std::set<int> heights;
        for (std::size_t i = 1; i < all.size(); ++i)
            if (const PixelPlace place = place_of(all[i], parts, n > 1 ? n : 2, kFrame, {17, 3});
                place.is_taken())
                heights.insert(place.y);
        EXPECT_EQ(heights.size(), static_cast<std::size_t>(n > 1 ? n * n : 4));
    }
}

// Whether a pixel takes a pass says nothing about its neighbours, nor about the next frame: no ghosts.
TEST(Passes, NeighboursAndFramesAreIndependent) {
    const auto [all, parts] = passes(4);
    ASSERT_EQ(parts, 2);
    constexpr int kSide = 64;
    const auto takes = [&, parts = parts](const PicturePass& pass, int frame, int x, int y) {
        return place_of(pass, parts, 4, frame, {x, y}).is_taken();
    };
    int right = 0, below = 0, next = 0;
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x) {
            const bool here = takes(all[5], kFrame, x, y);
            right += here == takes(all[5], kFrame, x + 1, y);
            below += here == takes(all[5], kFrame, x, y + 1);
            next += here == takes(all[5], kFrame + 1, x, y);
        }
    // Four standard deviations of 4096 throws of a coin.
    for (const int same : {right, below, next}) EXPECT_NEAR(same, kSide * kSide / 2, 128);
}

// The lens' places have the disc's first and second moments: the mean is its middle, that of their squared distance ½.
TEST(Passes, TheApertureIsCoveredEvenly) {
    for (const int n : {2, 4, 8}) {
        const std::vector<PicturePass> all = passes(n).all;
        glm::dvec2 sum(0.0);
        double squares = 0.0;
        for (std::size_t i = 1; i < all.size(); ++i) {
            EXPECT_LE(glm::length(all[i].lens), 1.0 + 1e-12);
            sum += all[i].lens;
            squares += glm::dot(all[i].lens, all[i].lens);
        }
        const auto count = static_cast<double>(all.size() - 1);
        EXPECT_LT(glm::length(sum) / count, 0.25 / n) << n;
        EXPECT_NEAR(squares / count, 0.5, 0.25 / n) << n;
    }
}

TEST(Passes, WhatIsSharpHasOne) {
    Camera camera;
    EXPECT_EQ(passes_of(camera, 7, options_of(4, 0.0)).all.size(), 1u);
    EXPECT_EQ(passes_of(camera, 7, options_of(4, 0.0)).all.front().frame, 7.0);
    EXPECT_EQ(passes_of(camera, 7, options_of(1, 0.5)).all.size(), 1u);
    camera.f_stop = 2.8;
    EXPECT_GT(passes_of(camera, 7, options_of(4, 0.0)).all.size(), 16u);
    for (const PicturePass& pass : passes_of(camera, 7, options_of(4, 0.0)).all) EXPECT_EQ(pass.frame, 7.0);
}

}  // namespace
}  // namespace pelagic
