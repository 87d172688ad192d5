// You pay for what the shot calls for: transforms, lines, bytes and buffers of two dozen shots, counted by
// hand, are what the plan promises, and what Sea and Frame hold and run. The time of each is printed beside
// it.
//
// The hand's arithmetic. A mode (mx, my) of a tile of L metres passes where its footprint s lets it: the
// filter ends at two samples a wave, L/(2s) modes from the middle, and the disc's radius R is the next whole
// number from there on: modes nearer than R pass. It is at most N/2 of the cascade's N, and where the next
// cascade's band begins, one more than the last mode whose cell reaches there with its corner, √½ away. A
// grid is read at its nodes where the points lie on them and there are at least 2R − 1; otherwise by a spline
// from 2 (2R − 1) nodes, rounded up to a size without a prime factor above 7.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/effects/sea_at_time.h"
#include "core/evaluate/values.h"
#include "core/plan/plan.h"
#include "core/plan/taps.h"
#include "core/scene/validate.h"
#include "core/surface/patch.h"

namespace pelagic {
namespace {

constexpr std::size_t kMesh = 65 * 65, kMap = 64 * 64;  // points

// By hand: the half disc 0 ≤ mx, its first column whole.
std::size_t modes(int radius) {
    std::size_t count = 0;
    for (int mx = 0; mx < radius; ++mx)
        for (int my = -radius; my <= radius; ++my) count += mx * mx + my * my < radius * radius;
    return count;
}
// A column of the disc for each mx, then two rows at a time.
long lines(int n, int radius) {
    return radius + n / 2;
}
// N rows (all sizes here are even) of N values and 16 that repeat the first, up to a whole cache line of 64
// bytes; none here is half a page, 2048 bytes, long, which would take a line more.
std::size_t plane_bytes(int n, std::size_t scalar) {
    const std::size_t row = (static_cast<std::size_t>(n + 16) * scalar + 63) / 64 * 64;
    EXPECT_NE(row % 2048, 0u);
    return static_cast<std::size_t>(n) * row;
}

struct GridByHand {
    int n, radius;
    FieldSet fields;
};

struct Case {
    std::string name;
    std::function<void(Scene&)> set;  // on top of scene()
    std::vector<std::vector<GridByHand>> cascades;
    std::size_t output_bytes;
    std::vector<Query> queries{};  // none: the bake's
    std::size_t scalar = 4;        // bytes of a number
    bool choppy = true;
    int trains = 0;
};

std::ostream& operator<<(std::ostream& out, const Case& c) {
    return out << c.name;
}

// 64² quads over 200 m, the nodes of one cascade: cell 3.125 m, 32 modes to the filter's end.
// Positions only.
Scene scene() {
    Scene scene;
    scene.waves.second_order = 0.0;  // whose transforms are counted in tests/core/waves/second_order_test.cpp
    scene.waves.cascades = {{200.0, 64}};
    scene.waves.tiling = Tiling::Periodic;  // grids are counted by hand, without what copies need
    scene.effects.foam_decay_s = 0.0;       // and bytes without those of breaking and age
    scene.surface.resolution = 64;
    scene.output.attributes = {};
    scene.output.map_resolution = 64;
    return scene;
}

const FieldSet kPosition = fields(Field::Height, Field::Dx, Field::Dy);
const FieldSet kExactSlopes = fields(Field::SlopeX, Field::SlopeY);
const FieldSet kExactGradient = fields(Field::Dxx, Field::Dyy, Field::Dxy);
const FieldSet kMotion = fields(Field::VelocityX, Field::VelocityY, Field::VelocityZ);

using Attributes = std::vector<MeshAttribute>;
using Maps = std::vector<MapKind>;

std::function<void(Scene&)> mesh(Attributes attributes) {
    return [=](Scene& s) { s.output.attributes = attributes; };
}
std::function<void(Scene&)> maps(Maps wanted) {
    return [=](Scene& s) {
        s.output.mesh = MeshFormat::None;
        s.output.maps = wanted;
    };
}
const Attributes kAll{MeshAttribute::Normal, MeshAttribute::Velocity, MeshAttribute::SlopeVariance,
                      MeshAttribute::Whitecaps};

// 64² points, at the cascade's nodes or nowhere in particular.
Query query(ProductSet wanted, double cell_m, double pixel_m, bool on_nodes) {
    Query query;
    query.name = "points";
    query.products = wanted;
    query.cell_m = {cell_m};
    query.pixel_m = {pixel_m};
    query.points = kMap;
    if (on_nodes) query.lattice = Lattice{-100.0, 3.125};
    return query;
}

// Bytes of output: 8 a point at rest; 12 a position, displacement, normal, velocity, slope variance or
// moments of J; 4 a coverage.
std::vector<Case> cases() {
    using enum MeshAttribute;
    const auto nothing = [](Scene&) {};
    const auto one = [](FieldSet fields) { return std::vector<std::vector<GridByHand>>{{{64, 32, fields}}}; };
    return {
        {"MeshPositions", mesh({}), one(kPosition), kMesh * (8 + 12)},
        {"MeshNormals", mesh({Normal}), one(kPosition | kExactSlopes | kExactGradient), kMesh * (8 + 24)},
        {"MeshVelocities", mesh({Velocity}), one(kPosition | kMotion), kMesh * (8 + 24)},
        {"MeshSlopeVariance", mesh({SlopeVariance}), one(kPosition | kExactGradient), kMesh * (8 + 24)},
        {"MeshWhitecaps", mesh({Whitecaps}), one(kPosition | kExactGradient), kMesh * (8 + 16)},
        {"MeshEverything", mesh(kAll), one(kPosition | kExactSlopes | kExactGradient | kMotion),
         kMesh * (8 + 52)},
        {"WhitecapsOff",
         [](Scene& s) {
             s.output.attributes = {Whitecaps, SlopeVariance};
             s.effects.whitecaps = false;
         },
         one(kPosition | kExactGradient), kMesh * (8 + 24)},
        // Heights, their slopes and their velocity; the gradient that foam is told from.
        {"ChoppinessZero",
         [](Scene& s) {
             s.output.attributes = kAll;
             s.waves.choppiness = 0.0;
         },
         one(fields(Field::Height, Field::SlopeX, Field::SlopeY, Field::VelocityZ) | kExactGradient),
         kMesh * (8 + 52)},
        {"DisplacementMap", maps({MapKind::Displacement}), one(kPosition), kMap * (8 + 12)},
        {"NormalMap", maps({MapKind::Normal}), one(kExactSlopes | kExactGradient), kMap * (8 + 12)},
        // What carries them, at each mip level.
        {"SlopeVarianceMap",
         maps({MapKind::SlopeVariance}),
         {{{64, 32, kExactGradient},
           {64, 16, kExactGradient},
           {30, 8, kExactGradient},
           {14, 4, kExactGradient},
           {6, 2, kExactGradient}}},
         kMap * (8 + 12)},
        {"WhitecapsMap", maps({MapKind::Whitecaps}), one(kExactGradient), kMap * (8 + 16)},
        {"WhitecapsMapChoppinessZero",
         [](Scene& s) {
             maps({MapKind::Whitecaps})(s);
             s.waves.choppiness = 0.0;
         },
         one(kExactGradient), kMap * (8 + 16)},
        // The same cells at the same nodes: the mesh's own grid, and the maps share their points.
        {"MapsAsFineAsTheMesh",
         [](Scene& s) {
             s.output.attributes = {Velocity};
             s.output.maps = {MapKind::Displacement, MapKind::Whitecaps};
         },
         one(kPosition | kMotion | kExactGradient), kMesh * (8 + 24) + kMap * (8 + 12 + 16)},
        // 6.25 m texels: 16 modes, every second node.
        {"MapCoarserThanTheMesh",
         [](Scene& s) {
             s.output.maps = {MapKind::Normal};
             s.output.map_resolution = 32;
         },
         {{{64, 32, kPosition}, {32, 16, kExactSlopes | kExactGradient}}},
         kMesh * (8 + 12) + 32 * 32 * (8 + 12)},
        // 1.5625 m texels: 64 modes, of which the cascade has 32, at every node of 128.
        {"MapFinerThanTheMesh",
         [](Scene& s) {
             s.output.maps = {MapKind::Displacement};
             s.output.map_resolution = 128;
         },
         {{{64, 32, kPosition}, {128, 32, kPosition}}},
         kMesh * (8 + 12) + 128 * 128 * (8 + 12)},
        // The tile is unfiltered: a grid of its own. Its points are the map's.
        {"MapAndTile",
         [](Scene& s) {
             maps({MapKind::Displacement})(s);
             s.output.cascade_tiles = true;
         },
         {{{64, 32, kPosition}, {64, 32, kPosition}}},
         kMap * (8 + 12 + 12)},
        // Bands meet at 8 waves across the 50 m: 32 modes of the 200 m and a corner, R = 34. Cells of 1.5625
        // m end at 16 modes of the 50 m, of which the mesh has every node of 32.
        {"TwoCascades",
         [](Scene& s) {
             s.waves.cascades = {{200.0, 128}, {50.0, 64}};
             s.surface.resolution = 128;
         },
         {{{128, 34, kPosition}}, {{32, 16, kPosition}}},
         129 * 129 * (8 + 12)},
        // The second cascade's waves are all too short for the mesh, which lies on every second node of the
        // first.
        {"TwoCascadesOneTooFine",
         [](Scene& s) {
             s.waves.cascades = {{200.0, 128}, {50.0, 64}};
         },
         {{{64, 32, kPosition}}, {}},
         kMesh * (8 + 12)},
        {"NoWind", [](Scene& s) { s.sea.wind_speed_mps = 0.0; }, {{}}, kMesh * (8 + 12)},
        {"TwoQueriesShareAGrid",
         nothing,
         one(kPosition | kMotion),
         kMap * (8 + 12 + 24),
         {query(products(Product::Position), 3.125, 3.125, true),
          query(products(Product::Displacement, Product::Velocity), 3.125, 3.125, true)}},
        // Off the nodes a spline needs 2 · 63 of them: its own grid, though the cells are as large.
        {"TwoQueriesOneOffTheNodes",
         nothing,
         {{{64, 32, kPosition}, {126, 32, kMotion}}},
         kMap * (8 + 12) + kMap * (8 + 12),
         {query(products(Product::Position), 3.125, 3.125, true),
          query(products(Product::Velocity), 3.125, 3.125, false)}},
        // Positions by their cell, normals by their pixel, each grid with its own fields only.
        {"PixelsCoarserThanCells",
         nothing,
         {{{126, 32, kPosition}, {64, 16, kExactSlopes | kExactGradient}}},
         kMap * (8 + 24),
         {query(products(Product::Position, Product::Normal), 3.125, 6.25, false)}},
        {"VariancesAtRestOnly",
         nothing,
         {{}},
         kMap * (8 + 12),
         {query(products(Product::SlopeVarianceAtRest), 3.125, 3.125, true)}},
        // All in double, and once more as files hold it.
        {"Reference",
         [](Scene& s) { s.quality.level = QualityLevel::Reference; },
         one(kPosition),
         kMesh * (16 + 24 + 12),
         {},
         8},
        {"Trochoid",
         [](Scene& s) {
             s.waves.model = WaveModel::Trochoid;
             s.waves.cascades = {};
             s.output.attributes = kAll;
         },
         {},
         kMesh * (8 + 52),
         {},
         4,
         true,
         250},
        // The cascade begins where the trains end, at 8 waves across; its cells end at its 32nd mode.
        {"TrochoidWithACascade",
         [](Scene& s) {
             s.waves.model = WaveModel::Trochoid;
             s.waves.trains = 30;
             s.waves.cascades = {{20.0, 64}};
             s.surface.size_m = 20.0;
         },
         one(kPosition),
         kMesh * (8 + 12),
         {},
         4,
         true,
         30},
    };
}

std::size_t modes_bytes(const Case& c) {
    std::size_t bytes = 0;
    for (const auto& grids : c.cascades) {
        int radius = 0;
        for (const GridByHand& grid : grids) radius = std::max(radius, grid.radius);
        // Two complex amplitudes, the horizontal one's factor where there is one, a frequency in double.
        if (radius > 0) bytes += modes(radius) * ((c.choppy ? 5 : 4) * c.scalar + 8);
    }
    return bytes;
}

template <class T>
std::size_t held_by(const Trains<T>& trains) {
    const auto of = [](const auto&... list) { return ((list.size() * sizeof(list[0])) + ...); };
    std::size_t bytes =
        of(trains.kx_cycles_per_m, trains.ky_cycles_per_m, trains.cycles_per_s, trains.start_cycles,
           trains.height_m, trains.horizontal_m, trains.wavelength_m, trains.alone, trains.before,
           trains.from, trains.unresolved_alone, trains.unresolved_from, trains.wavelength, trains.breaking);
    for (const auto& amplitude : trains.amplitude) bytes += of(amplitude);
    return bytes;
}

// Of each train 7 doubles, 11 fields' factors, wavelength and weight in breaking in single precision; moments alone
// and in two running sums of one entry more, 8 unresolved ones alone and in one running sum.
std::size_t trains_bytes(int trains) {
    if (trains == 0) return 0;
    const auto n = static_cast<std::size_t>(trains);
    return n * (7 * 8 + 13 * 4) + (n + 2 * (n + 1)) * sizeof(SpectralMoments) + (n + (n + 1)) * 8 * 4;
}

template <class T>
double median_ms(SeaAtTime<T>& state) {
    const Plan& plan = state.sea().plan();
    std::vector<std::vector<glm::vec<2, T>>> rest;
    std::vector<ProductArrays<T>> answers;
    for (const PlannedQuery& planned : plan.queries) {
        const auto side = static_cast<int>(std::lround(std::sqrt(static_cast<double>(planned.query.points))));
        const Lattice at = planned.query.lattice.value_or(Lattice{-100.0, 3.126});
        rest.push_back(rest_points<T>({.per_side = side, .spacing_m = at.spacing_m, .first_m = at.first_m}));
        EXPECT_EQ(rest.back().size(), planned.query.points);
        answers.emplace_back().resize(planned.query.products, planned.query.points);
    }
    std::vector<double> ms;
    for (int i = 0; i < 9; ++i) {
        const auto start = std::chrono::steady_clock::now();
        state.set(0.25 * i);
        for (std::size_t q = 0; q < rest.size(); ++q)
            state.evaluate(static_cast<int>(q), {.count = rest[q].size(), .rest_m = {rest[q].data()}},
                           answers[q].results());
        ms.push_back(
            std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
    }
    std::nth_element(ms.begin(), ms.begin() + 4, ms.end());
    return ms[4];
}

template <class T>
void check(const Case& c, const Plan& plan) {
    int transforms = 0;
    long all_lines = 0;
    std::size_t frame_bytes = 0;
    for (const auto& grids : c.cascades)
        for (const GridByHand& grid : grids) {
            const auto count = static_cast<int>(grid.fields.count());
            transforms += count;
            all_lines += count * lines(grid.n, grid.radius);
            frame_bytes += grid.fields.count() * plane_bytes(grid.n, c.scalar);
        }
    EXPECT_EQ(plan.transforms_per_frame(), transforms);
    EXPECT_EQ(plan.lines_per_frame(), all_lines);
    EXPECT_EQ(plan.frame_bytes(), frame_bytes);
    std::size_t ellipses_bytes = 0;  // what ellipses hide, for queries on several levels
    for (const PlannedQuery& planned : plan.queries)
        if (has_ellipse_table(plan, planned.query))
            ellipses_bytes += (2 * planned.query.pixel_m.size() - 1) * 10 * 24 * 8 * sizeof(float);
    EXPECT_EQ(plan.sea_bytes(), modes_bytes(c) + trains_bytes(c.trains) + ellipses_bytes);
    EXPECT_EQ(plan.output_bytes(), c.output_bytes);

    const auto sea = std::make_shared<const Sea<T>>(plan);
    std::size_t in_modes = 0;
    for (const Cascade<T>& cascade : sea->cascades()) in_modes += cascade.held_bytes();
    EXPECT_EQ(in_modes, modes_bytes(c));
    EXPECT_EQ(held_by(sea->trains()), trains_bytes(c.trains));

    SeaAtTime<T> state(sea);
    const Frame<T>& frame = state.frame();
    EXPECT_EQ(frame.held_bytes(), frame_bytes);
    ASSERT_EQ(plan.cascades.size(), c.cascades.size());
    for (int k = 0; k < static_cast<int>(c.cascades.size()); ++k) {
        const std::vector<GridByHand>& by_hand = c.cascades[k];
        ASSERT_EQ(plan.cascades[k].grids.size(), by_hand.size()) << "cascade " << k;
        for (int g = 0; g < static_cast<int>(by_hand.size()); ++g) {
            EXPECT_EQ(plan.cascades[k].grids[g].resolution, by_hand[g].n) << "cascade " << k;
            EXPECT_EQ(plan.cascades[k].grids[g].radius, by_hand[g].radius) << "cascade " << k;
            for (std::size_t f = 0; f < kFieldCount; ++f)
                EXPECT_EQ(frame.samples(k, g, static_cast<Field>(f)) != nullptr, by_hand[g].fields[f])
                    << "cascade " << k << " grid " << g << " field " << f;
        }
    }
    EXPECT_EQ(frame.executed_transforms(), 0);
    for (int i = 1; i <= 3; ++i) {
        state.set(0.5 * i);
        EXPECT_EQ(frame.executed_transforms(), i * transforms);
        EXPECT_EQ(frame.executed_lines(), i * all_lines);
    }
    std::printf("%-26s %3d transforms %6ld lines %8zu + %7zu + %7zu bytes %7.3f ms\n", c.name.c_str(),
                transforms, all_lines, plan.sea_bytes(), frame_bytes, c.output_bytes, median_ms(state));
}

class Exact : public testing::TestWithParam<Case> {};

TEST_P(Exact, IsTheMinimumAndIsWhatIsHeldAndRun) {
    const Case& c = GetParam();
    Scene shot = scene();
    c.set(shot);
    for (const Problem& problem : validate(shot)) FAIL() << text_of(problem);
    const Plan plan = c.queries.empty() ? plan_bake(shot) : make_plan(shot, c.queries);
    EXPECT_EQ(plan.trains ? plan.trains->count : 0, c.trains);
    if (c.scalar == 8)
        check<double>(c, plan);
    else
        check<float>(c, plan);
}

INSTANTIATE_TEST_SUITE_P(Shots, Exact, testing::ValuesIn(cases()),
                         [](const auto& instance) { return instance.param.name; });

}  // namespace
}  // namespace pelagic
