// Bounds of a frame's regions against what evaluate() answers there, at many points.
#include "core/evaluate/bounds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <stdexcept>
#include <string>

#include "core/evaluate/prepared_query.h"
#include "core/evaluate/values.h"
#include "tests/core/waves/samples.h"

namespace pelagic {
namespace {

using Interval = DisplacementBounds::Interval;

using namespace test;

struct Case {
    std::string name;
    Scene scene;
    std::vector<double> cell_m;  // the query's levels
    std::optional<Lattice> lattice = {};
};

Scene storm() {
    Scene scene;
    scene.sea.wind_speed_mps = 20.0;
    scene.sea.depth_m = 15.0;
    return scene;
}
Scene trains(int count) {
    Scene scene;
    scene.waves.model = WaveModel::Trochoid;
    scene.waves.trains = count;
    return scene;
}
Scene trains_and_cascade() {
    Scene scene = trains(60);
    scene.waves.shortest_m = 5.0;
    scene.waves.cascades = {{.size_m = 60.0, .resolution = 128}};
    return scene;
}
Scene hero() {
    Scene scene;
    scene.waves.heroes = {{.frame = 20.0, .height_m = 2.5}};
    return scene;
}
Scene masked() {
    Scene scene;
    scene.sea.gust_fronts = {{}};  // which move nothing
    scene.waves.masks = {{.length_m = 90.0, .width_m = 60.0, .edge_m = 40.0, .waves = 1.8},
                         {.east_m = 60.0, .width_m = 30.0, .edge_m = 50.0, .waves = 0.3, .ripples = 0.2},
                         {.north_m = 30.0,
                          .length_m = 70.0,
                          .width_m = 70.0,
                          .edge_m = 9.0,
                          .waves = 1.4,
                          .picture = "chequers"}};
    std::vector<float> chequers;
    for (int i = 0; i < 8 * 8; ++i) chequers.push_back(static_cast<float>((i + i / 8) % 2));
    scene.waves.mask_pictures["chequers"] = std::make_shared<const MaskPicture>(8, 8, std::move(chequers));
    return scene;
}
Scene without_choppiness() {
    Scene scene;
    scene.waves.choppiness = 0.0;
    return scene;
}

std::vector<Case> cases() {
    return {{"default sea", Scene(), {0.5}},
            {"default sea on several levels", Scene(), {0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0}},
            {"shallow storm", storm(), {1.0}},
            {"no choppiness", without_choppiness(), {1.0}},
            {"a hero", hero(), {0.5, 1.0, 2.0}},
            {"calm and rough places", masked(), {0.0625, 0.125, 0.25, 0.5, 1.0}},
            {"60 trains", trains(60), {0.5}},
            {"400 trains", trains(400), {0.5}},
            {"trains and a cascade on several levels", trains_and_cascade(), {0.25, 0.5, 1.0, 2.0}}};
}

Query query_of(const Case& c) {
    Query query = unfiltered(products(Product::Displacement));
    query.cell_m = query.pixel_m = c.cell_m;
    query.lattice = c.lattice;
    return query;
}

// What evaluate() gives at random points of a region, whose footprints lie within the range.
template <class T>
struct Seen {
    std::vector<glm::vec<3, T>> displacement;
    DisplacementBounds bounds;
};
template <class T>
Seen<T> seen(const Frame<T>& frame, const RestRegion& region, FootprintRange cells, std::size_t count) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    const glm::dvec2 origin_m = region.min_m, size_m = region.max_m - region.min_m;
    std::vector<glm::vec<2, T>> rest;
    std::vector<T> cell_m;
    for (std::size_t i = 0; i < count; ++i) {
        glm::vec<2, T> point;
        for (int axis = 0; axis < 2; ++axis) {
            point[axis] = static_cast<T>(size_m[axis] * unit(random));
            // Rounded, it may lie beyond the edge.
            while (static_cast<double>(point[axis]) > size_m[axis])
                point[axis] = std::nextafter(point[axis], T(0));
        }
        rest.push_back(point);
        cell_m.push_back(static_cast<T>(cells.finest_m + (cells.coarsest_m - cells.finest_m) * unit(random)));
        if (cells.coarsest_m == cells.finest_m) cell_m.back() = static_cast<T>(cells.finest_m);
    }
    Seen<T> result;
    result.displacement = sample(frame, 0, rest, {origin_m, cell_m, cell_m}).vectors(Displacement);
    for (const glm::vec<3, T>& d : result.displacement) {
        const auto take = [](Interval& interval, T value) {
            interval.lo = std::min(interval.lo, static_cast<double>(value));
            interval.hi = std::max(interval.hi, static_cast<double>(value));
        };
        take(result.bounds.dx, d.x);
        take(result.bounds.dy, d.y);
        take(result.bounds.z, d.z);
    }
    return result;
}

bool holds(const DisplacementBounds& bounds, const DisplacementBounds& seen) {
    const auto inside = [](const Interval& all, const Interval& one) {
        return all.lo <= one.lo && one.hi <= all.hi;
    };
    return inside(bounds.z, seen.z) && inside(bounds.dx, seen.dx) && inside(bounds.dy, seen.dy);
}

template <class T>
void expect_nothing_exceeds(const Case& c) {
    Frame<T> frame = frame_of<T>(c.scene, {query_of(c)}, 4.5);
    std::mt19937 random(2);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::vector<FootprintRange> ranges{{c.cell_m.front(), c.cell_m.front()}};
    if (c.cell_m.size() > 1)
        for (const FootprintRange range :
             {FootprintRange{c.cell_m[1], c.cell_m[1]}, FootprintRange{1.1 * c.cell_m[1], 0.9 * c.cell_m[2]},
              FootprintRange{0.0, 2.0 * c.cell_m.back()}})
            ranges.push_back(range);
    for (const FootprintRange range : ranges) {
        const FrameBounds<T> bounds(frame, 0, range);
        const DisplacementBounds everywhere = bounds.everywhere();
        for (int i = 0; i < 24; ++i) {
            const double side_m = 0.01 * std::pow(1e5, unit(random)),
                         ratio = std::pow(10.0, unit(random) - 0.5);
            const glm::dvec2 corner_m = (i % 3 == 0   ? 1e6
                                         : i % 3 == 1 ? 1e3
                                                      : 1.0) *
                                        (glm::dvec2(unit(random), unit(random)) - 0.5);
            const RestRegion region{corner_m, corner_m + side_m * glm::dvec2(ratio, 1.0 / ratio)};
            const Seen<T> here = seen(frame, region, range, 1500);
            for (const int blocks : {1, 64, 1024}) {
                const DisplacementBounds bound = bounds.region(region, blocks);
                ASSERT_TRUE(holds(bound, here.bounds)) << c.name << ", " << side_m << " m, " << blocks;
                ASSERT_TRUE(holds(everywhere, here.bounds)) << c.name << ", " << side_m << " m";
            }
        }
    }
}

TEST(FrameBounds, AreNeverExceeded) {
    for (const Case& c : cases()) expect_nothing_exceeds<float>(c);
    expect_nothing_exceeds<double>(cases()[0]);
    expect_nothing_exceeds<double>(cases().back());
}

// Grids that are read at their nodes: a mesh whose vertices are them.
TEST(FrameBounds, HoldEveryVertexOfALattice) {
    Scene scene;
    scene.waves.cascades = {{.size_m = 400.0, .resolution = 128}};
    scene.waves.tiling = Tiling::Periodic;  // copies are read by spline
    const Lattice lattice{-200.0, 400.0 / 128};
    const Case c{"lattice", scene, {400.0 / 128}, lattice};
    const auto frame = frame_of<float>(scene, {query_of(c)}, 1.0);
    ASSERT_EQ(frame.sea().plan().cascades[0].grids[0].sampling, Sampling::Nodes);
    const FrameBounds<float> bounds(frame, 0, {c.cell_m[0], c.cell_m[0]});
    const auto vertices = rest_points<float>({.per_side = 128, .spacing_m = 400.0 / 128, .first_m = -200.0});
    const auto moved = sample(frame, 0, vertices).vectors(Displacement);
    for (int first = 0; first < 128 - 9; first += 7) {
        const double low_m = -200.0 + first * 3.125, high_m = low_m + 9 * 3.125;
        const DisplacementBounds bound = bounds.region({glm::dvec2(low_m), glm::dvec2(high_m)});
        double highest = -1e9, reached = bound.z.hi;
        for (int y = first; y <= first + 9; ++y)
            for (int x = first; x <= first + 9; ++x) {
                const double z = moved[static_cast<std::size_t>(y) * 128 + x].z;
                EXPECT_LE(z, bound.z.hi);
                EXPECT_GE(z, bound.z.lo);
                highest = std::max(highest, z);
            }
        EXPECT_LT(reached - highest, 1.0);  // some Hs
    }
}

TEST(FrameBounds, AreZeroOfACalmSea) {
    for (const WaveModel model : {WaveModel::Fft, WaveModel::Trochoid}) {
        Scene scene;
        scene.waves.model = model;
        scene.sea.wind_speed_mps = 0.0;
        const auto frame = frame_of<float>(scene, {unfiltered(products(Product::Position))}, 1.0);
        const FrameBounds<float> bounds(frame, 0);
        for (const DisplacementBounds& bound :
             {bounds.everywhere(), bounds.region({{-50.0, 1e6}, {70.0, 1e6 + 3.0}})}) {
            for (const Interval& axis : {bound.z, bound.dx, bound.dy}) {
                EXPECT_EQ(axis.lo, 0.0);
                EXPECT_EQ(axis.hi, 0.0);
            }
            EXPECT_EQ(bound.reach_m(), glm::dvec2(0.0));
        }
    }
}

// A region of two peak wavelengths and more: how much more than what it reaches. 40 000 points see its
// highest wave to a per cent or so.
TEST(FrameBounds, AreNotMuchWiderThanWhatIsReached) {
    std::printf("%-34s %8s %8s %8s %22s\n", "", "side m", "height", "reach", "of 5 deviations, height");
    for (const Case& c : cases()) {
        const auto frame = frame_of<float>(c.scene, {query_of(c)}, 4.5);
        const FootprintRange range{c.cell_m.front(), c.cell_m.front()};
        const FrameBounds<float> bounds(frame, 0, range);
        const double peak_m = kTwoPi / frame.sea().plan().from->spectrum.longest_peak_wavenumber();
        for (const double waves : {2.0, 4.0, 8.0}) {
            double height = 0.0, reach = 0.0, of_expected = 0.0;
            constexpr int kPlaces = 3;
            for (int place = 0; place < kPlaces; ++place) {
                const glm::dvec2 corner_m(1000.0 * place, -700.0 * place);
                const RestRegion region{corner_m, corner_m + waves * peak_m};
                const DisplacementBounds here = seen(frame, region, range, 40000).bounds;
                const DisplacementBounds bound = bounds.region(region);
                height += (bound.z.hi - bound.z.lo) / (here.z.hi - here.z.lo) / kPlaces;
                if (c.scene.waves.choppiness > 0.0)
                    reach += (bound.reach_m().x + bound.reach_m().y) / (here.reach_m().x + here.reach_m().y) /
                             kPlaces;
                of_expected += (bound.z.hi - bound.z.lo) / (2.0 * frame.sea().extent().height_m) / kPlaces;
            }
            std::printf("%-34s %8.0f %8.2f %8.2f %22.2f\n", c.name.c_str(), waves * peak_m, height, reach,
                        of_expected);
            // Many trains over many waves need more blocks than are given here. Directions that are spread evenly meet in
            // fewer places than the bounds must allow for.
            EXPECT_LT(height, c.scene.waves.model == WaveModel::Fft && c.scene.waves.heroes.empty() &&
                                      c.scene.waves.masks.empty()
                                  ? 1.5
                                  : 4.0)
                << c.name;
        }
    }
}

TEST(FrameBounds, CostAFrameNothingAndAreRefusedWhenOutOfDate) {
    const Case c = cases()[0];
    Frame<float> frame = frame_of<float>(c.scene, {query_of(c)}, 0.0);
    const std::size_t bytes = frame.held_bytes();
    FrameBounds<float> bounds(frame, 0);
    const RestRegion region{{0.0, 0.0}, {10.0, 10.0}};
    const DisplacementBounds before = bounds.region(region);
    EXPECT_EQ(frame.held_bytes(), bytes);
    frame.set(5.0);
    EXPECT_THROW(bounds.region(region), std::logic_error);
    EXPECT_THROW(bounds.everywhere(), std::logic_error);
    bounds.refresh();
    EXPECT_NE(bounds.region(region).z.hi, before.z.hi);
    EXPECT_THROW(bounds.region({{1.0, 0.0}, {0.0, 1.0}}), std::invalid_argument);
    EXPECT_THROW(bounds.region(region, 0), std::invalid_argument);
    EXPECT_THROW(FrameBounds<float>(frame, 0, {2.0, 1.0}), std::invalid_argument);
    const auto normals = frame_of<float>(c.scene, {unfiltered(products(Product::Normal))});
    EXPECT_THROW(FrameBounds<float>(normals, 0), std::invalid_argument);
}

}  // namespace
}  // namespace pelagic
