// The C interface: what it answers is what the core answers, and whatever comes in, a status comes out.
#include "pelagic/procedural.h"

#include <gtest/gtest.h>

#ifdef __SSE2__
#include <xmmintrin.h>
#endif

#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <random>
#include <string>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

#include "core/effects/sea_at_time.h"
#include "core/evaluate/evaluate.h"
#include "core/plan/plan.h"
#include "core/surface/view.h"
#include "plugin/format/shot/shot.h"
#include "plugin/light/light.h"
#include "tests/plugin/host/procedural/opened.h"

namespace pelagic {
namespace {

using namespace test;

// Foam with a short past.
const std::string kShot = "[camera]\nresolution = [160, 90]\n[effects]\nfoam_decay_s = 0.5\n";

struct Answers {
    std::vector<glm::vec3> position, normal, velocity, slope_variance;
    std::vector<float> coverage;

    explicit Answers(std::size_t count)
        : position(count), normal(count), velocity(count), slope_variance(count), coverage(count) {}
    pelagic_values values() {
        pelagic_values out = PELAGIC_INIT(pelagic_values);
        out.position_m = &position[0].x;
        out.normal = &normal[0].x;
        out.velocity_mps = &velocity[0].x;
        out.slope_variance = &slope_variance[0].x;
        out.coverage = coverage.data();
        return out;
    }
    bool operator==(const Answers&) const = default;
};

std::vector<glm::vec2> random_rests(std::size_t count, float half_m) {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> at(-half_m, half_m);
    std::vector<glm::vec2> rests(count);
    for (glm::vec2& rest : rests) rest = {at(random), at(random)};
    return rests;
}

Answers ask(const FrameHandle& frame, const std::vector<glm::vec2>& rests,
            glm::dvec2 origin_m = glm::dvec2(0.0), const std::vector<float>& footprints_m = {},
            const std::vector<float>& times_s = {}) {
    pelagic_points points = PELAGIC_INIT(pelagic_points);
    points.origin_m[0] = origin_m.x;
    points.origin_m[1] = origin_m.y;
    points.count = rests.size();
    points.rest_m = &rests[0].x;
    points.cell_m = points.pixel_m = footprints_m.empty() ? nullptr : footprints_m.data();
    points.time_s = times_s.empty() ? nullptr : times_s.data();
    Answers answers(rests.size());
    const pelagic_values values = answers.values();
    pelagic_error error;
    EXPECT_EQ(pelagic_evaluate(frame.get(), &points, &values, &error), PELAGIC_OK) << error.message;
    return answers;
}

// Who says nothing gets a frame that a host can afford, however fine the shot's camera sees the sea; who asks for more gets it.
TEST(Procedural, AFrameThatNobodyAskedToBeFineIsBounded) {
    pelagic_info info = PELAGIC_INIT(pelagic_info);
    for (const std::string& shot : std::vector<std::string>{"", "[sea]\nwind_speed_mps = 25\n",
                                                            "[waves]\nmodel = \"trochoid\"\n", kShot}) {
        const SeaHandle sea = open_text(shot);
        ASSERT_EQ(pelagic_get_info(sea.get(), &info, nullptr), PELAGIC_OK);
        EXPECT_LE(info.frame_bytes, std::size_t{256} << 20) << shot;
    }
    pelagic_open_options options = PELAGIC_INIT(pelagic_open_options);
    options.finest_cell_m = 0.004;
    const SeaHandle fine = open_text("", &options);
    ASSERT_EQ(pelagic_get_info(fine.get(), &info, nullptr), PELAGIC_OK);
    EXPECT_LE(info.finest_cell_m, 0.004);
    EXPECT_GT(info.frame_bytes, std::size_t{256} << 20);
}

TEST(Procedural, PointsAreTheQuerys) {
    const SeaHandle sea = open_text(kShot);
    const FrameHandle frame = frame_of(sea, 2.0, 2.5);
    pelagic_info info = PELAGIC_INIT(pelagic_info);
    ASSERT_EQ(pelagic_get_info(sea.get(), &info, nullptr), PELAGIC_OK);

    const Scene scene = parse_shot(kShot, "shot.toml", check_scene);
    auto prepared = prepare(scene);
    const ProductSet all = products(Product::Position, Product::Normal, Product::Velocity,
                                    Product::SlopeVariance, Product::Coverage);
    const Query query = view_query(
        *prepared,
        {.products = all, .finest_cell_m = info.finest_cell_m, .finest_pixel_m = info.finest_pixel_m});
    SeaAtTime<float> own(std::make_shared<const Sea<float>>(make_plan(std::move(prepared), {query})));
    own.set(2.25);

    const std::vector<glm::vec2> rests = random_rests(1000, 300.0f);
    std::vector<float> footprints_m(rests.size());
    for (std::size_t i = 0; i < rests.size(); ++i)
        footprints_m[i] = 0.3f * std::exp2(static_cast<float>(i % 100) / 10.0f);
    for (const glm::dvec2 origin_m : {glm::dvec2(0.0), glm::dvec2(1.5e6, -3.0e5)}) {
        const Answers answers = ask(frame, rests, origin_m, footprints_m);
        Answers expected(rests.size());
        Results<float> results;
        results.set(Product::Position, {expected.position.data()});
        results.set(Product::Normal, {expected.normal.data()});
        results.set(Product::Velocity, {expected.velocity.data()});
        results.set(Product::SlopeVariance, {expected.slope_variance.data()});
        results.set(Product::Coverage, {expected.coverage.data()});
        own.evaluate(0,
                     {.origin_m = origin_m,
                      .count = rests.size(),
                      .rest_m = {rests.data()},
                      .cell_m = {footprints_m.data()},
                      .pixel_m = {footprints_m.data()}},
                     results);
        EXPECT_TRUE(answers == expected);
    }
}

// During the shutter points move as the sea does: linear motion is off by ½ a t², a of the water's.
TEST(Procedural, PointsMoveWithTheSea) {
    const SeaHandle sea = open_text("[sea]\nwind_speed_mps = 20.0\n" + kShot);
    constexpr double kOpen_s = 3.0, kClose_s = 3.0 + 1.0 / 48.0;
    const FrameHandle frame = frame_of(sea, kOpen_s, kClose_s);
    const std::vector<glm::vec2> rests = random_rests(2000, 200.0f);
    const std::vector<float> footprints_m(rests.size(), 0.1f);
    for (const double time_s : {kOpen_s, kOpen_s + 0.3 * (kClose_s - kOpen_s), kClose_s}) {
        const Answers moved = ask(frame, rests, glm::dvec2(0.0), footprints_m,
                                  std::vector<float>(rests.size(), static_cast<float>(time_s - kOpen_s)));
        const Answers there = ask(frame_of(sea, time_s, time_s), rests, glm::dvec2(0.0), footprints_m);
        double squares = 0.0, moves = 0.0;
        const Answers middle = ask(frame, rests, glm::dvec2(0.0), footprints_m);
        for (std::size_t i = 0; i < rests.size(); ++i) {
            squares += std::pow(glm::length(moved.position[i] - there.position[i]), 2.0);
            moves += std::pow(glm::length(middle.position[i] - there.position[i]), 2.0);
        }
        const double off_m = std::sqrt(squares / 2000.0);
        EXPECT_LT(off_m, 0.5e-3) << time_s;
        if (std::abs(time_s - 0.5 * (kOpen_s + kClose_s)) > 0.005) {
            EXPECT_LT(off_m, 0.05 * std::sqrt(moves / 2000.0));
        }
    }
}

TEST(Procedural, AMeshForACameraIsThePointsOfItsRests) {
    for (const int on_earth : {0, 1}) {
        const SeaHandle sea = open_text(kShot);
        const FrameHandle frame = frame_of(sea, 1.0, 1.0);
        pelagic_camera camera = PELAGIC_INIT(pelagic_camera);
        ASSERT_EQ(pelagic_shot_camera(sea.get(), 1.0, &camera, nullptr), PELAGIC_OK);
        for (const int triangles : {0, 1}) {
            pelagic_expand_options options = PELAGIC_INIT(pelagic_expand_options);
            options.cell_px = 4.0;
            options.triangles = triangles;
            options.on_earth = on_earth;
            pelagic_mesh_size size = PELAGIC_INIT(pelagic_mesh_size);
            pelagic_error error;
            ASSERT_EQ(pelagic_expand_size(frame.get(), &camera, &options, &size, &error), PELAGIC_OK)
                << error.message;
            ASSERT_GT(size.points, 0u);
            EXPECT_EQ(size.corners, size.faces * (triangles ? 3u : 4u));
            Answers answers(size.points);
            const pelagic_values values = answers.values();
            std::vector<std::uint32_t> corner(size.corners + 1, 0xdeadbeefu);
            std::vector<glm::vec2> rests(size.points);
            pelagic_mesh_buffers buffers = PELAGIC_INIT(pelagic_mesh_buffers);
            buffers.points = size.points;
            buffers.corners = size.corners;
            buffers.corner = corner.data();
            buffers.rest_m = &rests[0].x;
            buffers.values = &values;
            // Too small by one: nothing is written.
            for (std::size_t pelagic_mesh_buffers::*const room :
                 {&pelagic_mesh_buffers::points, &pelagic_mesh_buffers::corners}) {
                pelagic_mesh_buffers small = buffers;
                --(small.*room);
                EXPECT_EQ(pelagic_expand(frame.get(), &camera, &options, &small, &error), PELAGIC_TOO_SMALL);
                EXPECT_NE(std::string(error.message).find(std::to_string(size.points)), std::string::npos);
                EXPECT_EQ(corner[0], 0xdeadbeefu);
            }
            pelagic_values no_size{};
            pelagic_mesh_buffers refused = buffers;
            refused.values = &no_size;
            EXPECT_EQ(pelagic_expand(frame.get(), &camera, &options, &refused, &error),
                      PELAGIC_INVALID_ARGUMENT);
            EXPECT_EQ(corner[0], 0xdeadbeefu);
            ASSERT_EQ(pelagic_expand(frame.get(), &camera, &options, &buffers, &error), PELAGIC_OK)
                << error.message;
            EXPECT_EQ(corner.back(), 0xdeadbeefu);
            corner.pop_back();
            EXPECT_EQ(buffers.points, size.points);
            EXPECT_EQ(buffers.corners, size.corners);
            // Counter-clockwise at rest; cells where a row begins elsewhere than the one before may be crossed.
            const std::size_t corners = triangles ? 3 : 4;
            double all = 0.0, turned = 0.0;
            for (std::size_t f = 0; f < corner.size(); f += corners) {
                double twice_area = 0.0;
                for (std::size_t c = 0; c < corners; ++c) {
                    ASSERT_LT(corner[f + c], size.points);
                    const glm::dvec2 a(rests[corner[f + c]]), b(rests[corner[f + (c + 1) % corners]]);
                    twice_area += a.x * b.y - a.y * b.x;
                }
                (twice_area < 0.0 ? turned : all) += std::abs(twice_area);
            }
            EXPECT_LT(turned, 0.01 * all);
            double deepest_m = 0.0;
            for (const glm::vec3& position : answers.position) {
                ASSERT_TRUE(std::isfinite(position.z));
                deepest_m = std::min(deepest_m, static_cast<double>(position.z));
            }
            if (on_earth) {
                EXPECT_LT(deepest_m, -20.0);
                continue;
            }
            EXPECT_GT(deepest_m, -5.0);
            // The footprints of the grid are ellipses, of a point here round: heights agree to what both hide.
            const Answers direct = ask(frame, rests, {buffers.origin_m[0], buffers.origin_m[1]});
            double squares = 0.0, heights = 0.0;
            std::size_t near = 0;
            for (std::size_t i = 0; i < rests.size(); ++i) {
                if (glm::length(rests[i]) > 30.0f) continue;
                ++near;
                squares += std::pow(answers.position[i].z - direct.position[i].z, 2.0f);
                heights += std::pow(direct.position[i].z, 2.0f);
            }
            ASSERT_GT(near, 100u);
            EXPECT_LT(squares, 0.01 * heights);
            for (const glm::vec3& normal : answers.normal) ASSERT_NEAR(glm::length(normal), 1.0f, 1e-5f);
        }
    }
}

TEST(Procedural, AnyNumberOfThreadsGetsTheSame) {
    const SeaHandle sea = open_text(kShot);
    const FrameHandle frame = frame_of(sea, 0.0, 0.02);
    const std::vector<glm::vec2> rests = random_rests(3000, 100.0f);
    const Answers expected = ask(frame, rests);
    pelagic_region region = PELAGIC_INIT(pelagic_region);
    region.max_m[0] = region.max_m[1] = 40.0;
    pelagic_box box = PELAGIC_INIT(pelagic_box);
    ASSERT_EQ(pelagic_bounds(frame_of(sea, 0.0, 0.02).get(), &region, &box, nullptr), PELAGIC_OK);
    std::array<bool, 6> same{};
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < same.size(); ++t)
        threads.emplace_back([&, t] {
            pelagic_box here = PELAGIC_INIT(pelagic_box);
            same[t] = pelagic_bounds(frame.get(), &region, &here, nullptr) == PELAGIC_OK &&
                      std::memcmp(&here, &box, sizeof box) == 0 && ask(frame, rests) == expected &&
                      ask(frame_of(sea, 0.0, 0.02), rests) == expected;
        });
    for (std::thread& thread : threads) thread.join();
    for (const bool is_same : same) EXPECT_TRUE(is_same);
    // As many threads as one may use.
    pelagic_open_options one = PELAGIC_INIT(pelagic_open_options);
    one.threads = 1;
    EXPECT_TRUE(ask(frame_of(open_text(kShot, &one), 0.0, 0.02), rests) == expected);
}

#ifdef __SSE2__
// Renderers trap exceptions in their debug builds, and flush subnormal numbers.
TEST(Procedural, AHostsFloatingPointChangesNothing) {
    const std::vector<glm::vec2> rests = random_rests(3000, 100.0f);
    const auto answers = [&] { return ask(frame_of(open_text(kShot), 0.0, 0.02), rests); };
    const Answers expected = answers();
    constexpr unsigned int kDefault = 0x1f80, kUntrapped = 0x1000, kFlushed = 0x8040, kUpwards = 0x4000;
    for (const unsigned int host : {kUntrapped, kDefault | kFlushed, kDefault | kUpwards}) {
        _mm_setcsr(host);
        const Answers found = answers();
        const unsigned int after = _mm_getcsr();
        _mm_setcsr(kDefault);
        EXPECT_EQ(after, host);
        EXPECT_TRUE(found == expected) << std::hex << host;
    }
}
#endif

TEST(Procedural, AFrameOutlivesItsSeasHandle) {
    SeaHandle sea = open_text(kShot);
    const FrameHandle frame = frame_of(sea, 0.0, 0.0);
    sea.reset();
    const std::vector<glm::vec2> rests = random_rests(10, 10.0f);
    EXPECT_TRUE(std::isfinite(ask(frame, rests).position[0].z));
    ASSERT_EQ(pelagic_frame_set(frame.get(), 5.0, 5.1, nullptr), PELAGIC_OK);
    EXPECT_TRUE(std::isfinite(ask(frame, rests).position[0].z));
}

// Along its path, as bodies of it lie there; and the water under its hull has its wake.
TEST(Procedural, AVesselIsWhereItsPathSays) {
    const std::string text = kShot +
                             "[shot]\ntime_scale = 0.5\ntime_offset_s = 3.0\n"
                             "[[waves.vessels]]\npath = \"1 10 -20, 49 10 -14, 97 2 -8\"\nlength_m = 12.0\n"
                             "[[waves.vessels]]\npath = \"1 0 0, 49 3 4\"\ninterpolation = \"linear\"\n"
                             "length_m = 9.0\nbeam_m = 3.0\ndraught_m = 1.0\n";
    const SeaHandle sea = open_text(text);
    pelagic_info info = PELAGIC_INIT(pelagic_info);
    ASSERT_EQ(pelagic_get_info(sea.get(), &info, nullptr), PELAGIC_OK);
    ASSERT_EQ(info.vessels, 2u);
    pelagic_error error;
    const auto at = [&](std::size_t vessel, double frame) {
        pelagic_vessel found = PELAGIC_INIT(pelagic_vessel);
        EXPECT_EQ(pelagic_vessel_at(sea.get(), vessel, frame, &found, &error), PELAGIC_OK) << error.message;
        return found;
    };
    // 5 m in a second of the sea, two on the screen.
    const pelagic_vessel straight = at(1, 25.0);
    const double place[3] = {1.5, 2.0, 0.0}, ahead[3] = {0.6, 0.8, 0.0}, port[3] = {-0.8, 0.6, 0.0};
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(straight.position_m[axis], place[axis], 1e-12);
        EXPECT_NEAR(straight.ahead[axis], ahead[axis], 1e-12);
        EXPECT_NEAR(straight.port[axis], port[axis], 1e-12);
        EXPECT_EQ(straight.up[axis], axis == 2 ? 1.0 : 0.0);
        EXPECT_NEAR(straight.velocity_mps[axis], 5.0 * ahead[axis], 1e-12);
    }
    EXPECT_EQ(straight.length_m, 9.0);
    EXPECT_EQ(straight.beam_m, 3.0);
    EXPECT_EQ(straight.draught_m, 1.0);
    // In a turn: ahead is where it goes, and its velocity is how its place changes.
    for (const double frame : {-20.0, 30.25, 71.5, 200.0}) {
        constexpr double kStep = 1e-3;
        const pelagic_vessel here = at(0, frame), before = at(0, frame - kStep), after = at(0, frame + kStep);
        const double step_s = 0.5 * kStep / 24.0,
                     speed_mps = std::hypot(here.velocity_mps[0], here.velocity_mps[1]);
        for (int axis = 0; axis < 2; ++axis) {
            EXPECT_NEAR((after.position_m[axis] - before.position_m[axis]) / (2.0 * step_s),
                        here.velocity_mps[axis], 1e-5);
            EXPECT_NEAR(here.ahead[axis] * speed_mps, here.velocity_mps[axis], 1e-9);
        }
    }
    // The hull is in its own waves.
    double open_s = 0.0;
    ASSERT_EQ(pelagic_time_of_frame(sea.get(), 49.0, &open_s, nullptr), PELAGIC_OK);
    const FrameHandle frame = frame_of(sea, open_s, open_s);
    const SeaHandle empty_sea = open_text(kShot + "[shot]\ntime_scale = 0.5\ntime_offset_s = 3.0\n");
    const FrameHandle empty = frame_of(empty_sea, open_s, open_s);
    const pelagic_vessel hull = at(0, 49.0);
    double wake_m = 0.0;
    for (const double x_m : {-5.0, 0.0, 5.0}) {
        const double point_m[2] = {hull.position_m[0] + x_m * hull.ahead[0],
                                   hull.position_m[1] + x_m * hull.ahead[1]};
        pelagic_water with = PELAGIC_INIT(pelagic_water), without = with;
        ASSERT_EQ(pelagic_water_at(frame.get(), point_m, 1, hull.beam_m / 6.0, &with, &error), PELAGIC_OK);
        ASSERT_EQ(pelagic_water_at(empty.get(), point_m, 1, hull.beam_m / 6.0, &without, &error), PELAGIC_OK);
        wake_m = std::max(wake_m, static_cast<double>(std::abs(with.height_m - without.height_m)));
    }
    EXPECT_GT(wake_m, 0.01);
}

// Of every function: nothing, or nonsense, in place of each argument.
TEST(Procedural, NonsenseIsRefusedWithASentence) {
    const SeaHandle sea = open_text(kShot);
    const FrameHandle frame = frame_of(sea, 0.0, 0.0);
    pelagic_sea* no_sea = nullptr;
    pelagic_frame* no_frame = nullptr;
    pelagic_error error;
    const double nan = std::numeric_limits<double>::quiet_NaN(),
                 inf = std::numeric_limits<double>::infinity();
    pelagic_source source = PELAGIC_INIT(pelagic_source), no_size{}, nothing = PELAGIC_INIT(pelagic_source);
    source.text = "";
    pelagic_camera camera = PELAGIC_INIT(pelagic_camera);
    ASSERT_EQ(pelagic_shot_camera(sea.get(), 1.0, &camera, &error), PELAGIC_OK);
    pelagic_camera bent = camera, blind = camera, lost = camera, empty = camera;
    bent.up[0] += 0.5;
    blind.tan_half_width = nan;
    lost.position_m[2] = inf;
    empty.width = 0;
    pelagic_expand_options thin = PELAGIC_INIT(pelagic_expand_options);
    thin.cell_px = -1.0;
    pelagic_open_options negative = PELAGIC_INIT(pelagic_open_options), odd = negative;
    negative.threads = -1;
    odd.finest_cell_m = nan;
    pelagic_mesh_size size = PELAGIC_INIT(pelagic_mesh_size);
    pelagic_mesh_buffers buffers = PELAGIC_INIT(pelagic_mesh_buffers);
    pelagic_region region = PELAGIC_INIT(pelagic_region), inside_out = region, everywhere = region,
                   backward = region;
    inside_out.min_m[0] = 1.0;
    everywhere.max_m[1] = inf;
    backward.finest_cell_m = 2.0;
    backward.coarsest_cell_m = 1.0;
    pelagic_box box = PELAGIC_INIT(pelagic_box);
    pelagic_points points = PELAGIC_INIT(pelagic_points);
    points.count = 1;
    pelagic_points nowhere = points, far_out = points;
    const float origin[2] = {0.0f, 0.0f};
    nowhere.rest_m = far_out.rest_m = origin;
    nowhere.origin_m[0] = nan;
    far_out.origin_m[1] = 1e12;
    pelagic_values values = PELAGIC_INIT(pelagic_values);
    pelagic_info info = PELAGIC_INIT(pelagic_info), small_info{};
    pelagic_vessel vessel = PELAGIC_INIT(pelagic_vessel);
    const SeaHandle of_one = open_text(kShot + "[waves]\nvessels = [ { path = \"1 0 0, 48 10 0\" } ]\n");
    double time_s = 0.0;
    struct Case {
        const char* name;
        std::function<pelagic_status()> call;
    };
    const std::vector<Case> cases{
        {"no source", [&] { return pelagic_open(nullptr, nullptr, &no_sea, &error); }},
        {"a source of no size", [&] { return pelagic_open(&no_size, nullptr, &no_sea, &error); }},
        {"neither path nor text", [&] { return pelagic_open(&nothing, nullptr, &no_sea, &error); }},
        {"nowhere to put a sea", [&] { return pelagic_open(&source, nullptr, nullptr, &error); }},
        {"fewer than no threads", [&] { return pelagic_open(&source, &negative, &no_sea, &error); }},
        {"a cell that is no number", [&] { return pelagic_open(&source, &odd, &no_sea, &error); }},
        {"info of no sea", [&] { return pelagic_get_info(nullptr, &info, &error); }},
        {"info nowhere", [&] { return pelagic_get_info(sea.get(), nullptr, &error); }},
        {"info of no size", [&] { return pelagic_get_info(sea.get(), &small_info, &error); }},
        {"time of no sea", [&] { return pelagic_time_of_frame(nullptr, 1.0, &time_s, &error); }},
        {"time of no frame", [&] { return pelagic_time_of_frame(sea.get(), nan, &time_s, &error); }},
        {"time nowhere", [&] { return pelagic_time_of_frame(sea.get(), 1.0, nullptr, &error); }},
        {"camera of no sea", [&] { return pelagic_shot_camera(nullptr, 1.0, &camera, &error); }},
        {"camera of no frame", [&] { return pelagic_shot_camera(sea.get(), inf, &camera, &error); }},
        {"camera nowhere", [&] { return pelagic_shot_camera(sea.get(), 1.0, nullptr, &error); }},
        {"vessel of no sea", [&] { return pelagic_vessel_at(nullptr, 0, 1.0, &vessel, &error); }},
        {"a vessel too many", [&] { return pelagic_vessel_at(of_one.get(), 1, 1.0, &vessel, &error); }},
        {"a vessel of none", [&] { return pelagic_vessel_at(sea.get(), SIZE_MAX, 1.0, &vessel, &error); }},
        {"vessel at no frame", [&] { return pelagic_vessel_at(of_one.get(), 0, nan, &vessel, &error); }},
        {"vessel nowhere", [&] { return pelagic_vessel_at(of_one.get(), 0, 1.0, nullptr, &error); }},
        {"frame of no sea", [&] { return pelagic_frame_create(nullptr, 0.0, 0.0, &no_frame, &error); }},
        {"frame nowhere", [&] { return pelagic_frame_create(sea.get(), 0.0, 0.0, nullptr, &error); }},
        {"a shutter that closes first",
         [&] { return pelagic_frame_create(sea.get(), 1.0, 0.0, &no_frame, &error); }},
        {"a time that is none", [&] { return pelagic_frame_create(sea.get(), nan, nan, &no_frame, &error); }},
        {"a time too late", [&] { return pelagic_frame_set(frame.get(), 0.0, 1e300, &error); }},
        {"set of no frame", [&] { return pelagic_frame_set(nullptr, 0.0, 0.0, &error); }},
        {"bounds of no frame", [&] { return pelagic_bounds(nullptr, &region, &box, &error); }},
        {"bounds of no region", [&] { return pelagic_bounds(frame.get(), nullptr, &box, &error); }},
        {"bounds nowhere", [&] { return pelagic_bounds(frame.get(), &region, nullptr, &error); }},
        {"a region inside out", [&] { return pelagic_bounds(frame.get(), &inside_out, &box, &error); }},
        {"a region without an end", [&] { return pelagic_bounds(frame.get(), &everywhere, &box, &error); }},
        {"footprints that fall", [&] { return pelagic_bounds(frame.get(), &backward, &box, &error); }},
        {"points of no frame", [&] { return pelagic_evaluate(nullptr, &points, &values, &error); }},
        {"no points", [&] { return pelagic_evaluate(frame.get(), nullptr, &values, &error); }},
        {"points without places", [&] { return pelagic_evaluate(frame.get(), &points, &values, &error); }},
        {"points round nothing", [&] { return pelagic_evaluate(frame.get(), &nowhere, &values, &error); }},
        {"points beyond the earth", [&] { return pelagic_evaluate(frame.get(), &far_out, &values, &error); }},
        {"points for nothing", [&] { return pelagic_evaluate(frame.get(), &points, nullptr, &error); }},
        {"a mesh of no frame", [&] { return pelagic_expand_size(nullptr, &camera, nullptr, &size, &error); }},
        {"a mesh for no camera",
         [&] { return pelagic_expand_size(frame.get(), nullptr, nullptr, &size, &error); }},
        {"a size nowhere",
         [&] { return pelagic_expand_size(frame.get(), &camera, nullptr, nullptr, &error); }},
        {"a bent camera", [&] { return pelagic_expand_size(frame.get(), &bent, nullptr, &size, &error); }},
        {"a blind camera", [&] { return pelagic_expand_size(frame.get(), &blind, nullptr, &size, &error); }},
        {"a lost camera", [&] { return pelagic_expand_size(frame.get(), &lost, nullptr, &size, &error); }},
        {"an empty picture",
         [&] { return pelagic_expand_size(frame.get(), &empty, nullptr, &size, &error); }},
        {"cells of less than nothing",
         [&] { return pelagic_expand_size(frame.get(), &camera, &thin, &size, &error); }},
        {"a mesh nowhere", [&] { return pelagic_expand(frame.get(), &camera, nullptr, nullptr, &error); }},
        {"a mesh of nothing", [&] { return pelagic_expand(nullptr, &camera, nullptr, &buffers, &error); }},
    };
    for (const Case& nonsense : cases) {
        error.message[0] = '\0';
        EXPECT_EQ(nonsense.call(), PELAGIC_INVALID_ARGUMENT) << nonsense.name;
        EXPECT_GT(std::strlen(error.message), 5u) << nonsense.name;
    }
    EXPECT_EQ(pelagic_vessel_at(sea.get(), 0, 1.0, &vessel, &error), PELAGIC_INVALID_ARGUMENT);
    EXPECT_STREQ(error.message, "the shot has no waves.vessels");
    EXPECT_EQ(no_sea, nullptr);
    EXPECT_EQ(no_frame, nullptr);
    // Nothing to close is no mistake, and neither are no points.
    pelagic_close(nullptr);
    pelagic_frame_release(nullptr);
    points.count = 0;
    EXPECT_EQ(pelagic_evaluate(frame.get(), &points, &values, nullptr), PELAGIC_OK);
}

// Rays would take minutes within a longer one.
TEST(Procedural, AShutterIsOpenForASecondAtMost) {
    const SeaHandle sea = open_text(kShot);
    const FrameHandle frame = frame_of(sea, 3.0, 4.0);
    pelagic_frame* no_frame = nullptr;
    pelagic_error error;
    for (const double close_s : {std::nextafter(4.0, 5.0), 13.0, 1e11}) {
        EXPECT_EQ(pelagic_frame_create(sea.get(), 3.0, close_s, &no_frame, &error), PELAGIC_INVALID_ARGUMENT);
        EXPECT_NE(std::string(error.message).find("open for 1 s of the sea at most"), std::string::npos)
            << error.message;
        EXPECT_EQ(no_frame, nullptr);
        EXPECT_EQ(pelagic_frame_set(frame.get(), 3.0, close_s, &error), PELAGIC_INVALID_ARGUMENT);
    }
}

TEST(Procedural, AShotThatIsRefusedSaysWhere) {
    pelagic_source source = PELAGIC_INIT(pelagic_source);
    const std::string text = "[sea]\nwind_speed_mps = -3.0\n";
    source.path = "folder/storm.toml";
    source.text = text.data();
    source.text_length = text.size();
    pelagic_sea* sea = nullptr;
    pelagic_error error;
    EXPECT_EQ(pelagic_open(&source, nullptr, &sea, &error), PELAGIC_SHOT_REFUSED);
    EXPECT_NE(std::string(error.message).find("storm.toml:2:"), std::string::npos) << error.message;
    source.text = nullptr;
    source.path = "/no/such/shot.toml";
    EXPECT_EQ(pelagic_open(&source, nullptr, &sea, &error), PELAGIC_SHOT_REFUSED);
    EXPECT_NE(std::string(error.message).find("/no/such/shot.toml"), std::string::npos) << error.message;
    EXPECT_EQ(sea, nullptr);
}

// At any of its reports, the last one too, and where a sea has little to build.
TEST(Procedural, BuildingASeaCanBeCancelled) {
    for (const std::string& text : {kShot, kShot + "[waves]\nmodel = \"trochoid\"\n"})
        for (const double at : {0.0, 1.0}) {
            pelagic_open_options options = PELAGIC_INIT(pelagic_open_options);
            double wanted = at;
            options.user = &wanted;
            options.progress = [](double done, void* user) {
                return done >= *static_cast<const double*>(user) ? 1 : 0;
            };
            pelagic_source source = PELAGIC_INIT(pelagic_source);
            source.text = text.c_str();
            pelagic_sea* sea = nullptr;
            EXPECT_EQ(pelagic_open(&source, &options, &sea, nullptr), PELAGIC_CANCELLED) << at;
            EXPECT_EQ(sea, nullptr);
        }
}

// Each call of a frame that can be long; afterwards all is as before.
TEST(Procedural, CallsOfACancelledSeaEnd) {
    const SeaHandle sea = open_text(kShot);
    const FrameHandle frame = frame_of(sea, 3.0, 3.02);
    std::vector<float> rest_m{1.0f, 2.0f, -3.0f, 4.0f}, position(6), coverage(2), distance(2);
    std::vector<unsigned char> occluded(2);
    std::vector<float> down{0.0f, 0.0f, -1.0f, 0.1f, 0.0f, -1.0f};
    pelagic_points points = PELAGIC_INIT(pelagic_points);
    points.count = 2;
    points.rest_m = rest_m.data();
    pelagic_values values = PELAGIC_INIT(pelagic_values);
    values.position_m = position.data();
    values.coverage = coverage.data();
    pelagic_rays rays = PELAGIC_INIT(pelagic_rays);
    rays.origin_m[2] = 50.0;
    rays.count = 2;
    rays.direction = down.data();
    pelagic_hits hits = PELAGIC_INIT(pelagic_hits);
    hits.distance = distance.data();
    pelagic_camera camera = PELAGIC_INIT(pelagic_camera);
    ASSERT_EQ(pelagic_shot_camera(sea.get(), 1.0, &camera, nullptr), PELAGIC_OK);
    pelagic_mesh_size mesh_size = PELAGIC_INIT(pelagic_mesh_size);
    ASSERT_EQ(pelagic_expand_size(frame.get(), &camera, nullptr, &mesh_size, nullptr), PELAGIC_OK);
    std::vector<float> mesh_position(3 * mesh_size.points);
    pelagic_values mesh_values = PELAGIC_INIT(pelagic_values);
    mesh_values.position_m = mesh_position.data();
    pelagic_mesh_buffers mesh = PELAGIC_INIT(pelagic_mesh_buffers);
    mesh.points = mesh_size.points;
    mesh.values = &mesh_values;
    const std::vector<std::pair<const char*, std::function<pelagic_status()>>> calls{
        {"prepare", [&] { return pelagic_prepare(frame.get(), &points, nullptr); }},
        {"evaluate", [&] { return pelagic_evaluate(frame.get(), &points, &values, nullptr); }},
        {"intersect", [&] { return pelagic_intersect(frame.get(), &rays, &hits, nullptr); }},
        {"occluded", [&] { return pelagic_occluded(frame.get(), &rays, occluded.data(), nullptr); }},
        {"expand", [&] { return pelagic_expand(frame.get(), &camera, nullptr, &mesh, nullptr); }},
        {"set", [&] { return pelagic_frame_set(frame.get(), 3.0, 3.02, nullptr); }},
        {"create", [&] {
             pelagic_frame* made = nullptr;
             const pelagic_status status = pelagic_frame_create(sea.get(), 3.0, 3.02, &made, nullptr);
             pelagic_frame_release(made);
             return status;
         }}};
    const auto results = [&] {
        for (const auto& [name, call] : calls) EXPECT_EQ(call(), PELAGIC_OK) << name;
        return std::tuple(position, coverage, distance, occluded, mesh_position);
    };
    const auto before = results();
    EXPECT_EQ(pelagic_cancel(nullptr, 1, nullptr), PELAGIC_INVALID_ARGUMENT);
    ASSERT_EQ(pelagic_cancel(sea.get(), 1, nullptr), PELAGIC_OK);
    for (const auto& [name, call] : calls) EXPECT_EQ(call(), PELAGIC_CANCELLED) << name;
    ASSERT_EQ(pelagic_cancel(sea.get(), 0, nullptr), PELAGIC_OK);
    // Setting the frame was cancelled: it has no time.
    pelagic_error error;
    for (const auto& [name, call] : calls) {
        if (std::string(name) == "set") break;
        EXPECT_EQ(call(), PELAGIC_INVALID_ARGUMENT) << name;
    }
    EXPECT_EQ(pelagic_evaluate(frame.get(), &points, &values, &error), PELAGIC_INVALID_ARGUMENT);
    EXPECT_NE(std::string(error.message).find("pelagic_frame_set() again"), std::string::npos)
        << error.message;
    ASSERT_EQ(pelagic_frame_set(frame.get(), 3.0, 3.02, nullptr), PELAGIC_OK);
    EXPECT_TRUE(results() == before);
}

// Of tiles and of wave trains, for points, water and rays alike.
TEST(Procedural, WhatIsFinerThanTheFinestCountsAsThat) {
    for (const std::string& text : {std::string(), std::string("[waves]\nmodel = \"trochoid\"\n")}) {
        pelagic_open_options options = PELAGIC_INIT(pelagic_open_options);
        options.finest_cell_m = 2.0;
        const SeaHandle sea = open_text(text, &options);
        const FrameHandle frame = frame_of(sea, 3.0, 3.0);
        pelagic_info info = PELAGIC_INIT(pelagic_info);
        ASSERT_EQ(pelagic_get_info(sea.get(), &info, nullptr), PELAGIC_OK);
        EXPECT_GT(info.finest_cell_m, 1.0) << text;
        EXPECT_LE(info.finest_cell_m, 2.0) << text;
        EXPECT_GT(info.finest_pixel_m, 1.0) << text;
        const std::vector<glm::vec2> rests = random_rests(200, 100.0f);
        const auto with = [&](float footprint_m) {
            return ask(frame, rests, glm::dvec2(0.0), std::vector<float>(rests.size(), footprint_m));
        };
        const Answers finest = with(static_cast<float>(info.finest_cell_m));
        // Tiles are summed in another order where points have footprints of their own.
        const auto apart_m = [&](const Answers& other) {
            float most_m = 0.0f;
            for (std::size_t i = 0; i < rests.size(); ++i)
                most_m = std::max({most_m, glm::length(other.position[i] - finest.position[i]),
                                   glm::length(other.normal[i] - finest.normal[i])});
            return most_m;
        };
        EXPECT_LT(apart_m(with(0.01f)), 1e-4f) << text;
        EXPECT_LT(apart_m(ask(frame, rests)), 1e-4f) << text;
        EXPECT_GT(apart_m(with(8.0f)), 1e-2f) << text;
        const auto water = [&](double footprint_m) {
            pelagic_water there = PELAGIC_INIT(pelagic_water);
            const double place_m[2] = {12.0, -7.0};
            EXPECT_EQ(pelagic_water_at(frame.get(), place_m, 1, footprint_m, &there, nullptr), PELAGIC_OK);
            return there.height_m;
        };
        EXPECT_EQ(water(0.01), water(info.finest_cell_m)) << text;
        EXPECT_EQ(water(0.0), water(info.finest_cell_m)) << text;
        // A ray that is thinner has the values of a point that is.
        std::vector<float> down{0.0f, 0.0f, -1.0f}, rest_m(2), normal(3);
        pelagic_rays rays = PELAGIC_INIT(pelagic_rays);
        rays.origin_m[2] = 50.0;
        rays.count = 1;
        rays.direction = down.data();
        pelagic_values values = PELAGIC_INIT(pelagic_values);
        values.normal = normal.data();
        pelagic_hits hits = PELAGIC_INIT(pelagic_hits);
        hits.rest_m = rest_m.data();
        hits.values = &values;
        ASSERT_EQ(pelagic_intersect(frame.get(), &rays, &hits, nullptr), PELAGIC_OK);
        const Answers there = ask(frame, {glm::vec2(rest_m[0], rest_m[1])});
        EXPECT_EQ(there.normal[0], glm::vec3(normal[0], normal[1], normal[2])) << text;
    }
}

TEST(Procedural, FlagsOfLaterVersionsAreRefused) {
    const SeaHandle sea = open_text(kShot);
    const FrameHandle frame = frame_of(sea, 3.0, 3.0);
    pelagic_error error;
    const auto is_said = [&](const char* name) {
        EXPECT_NE(std::string(error.message).find(name), std::string::npos) << error.message;
        EXPECT_NE(std::string(error.message).find("accepted: 0, 1"), std::string::npos) << error.message;
    };
    const std::vector<float> down{0.0f, 0.0f, -1.0f};
    std::vector<float> distance(1);
    std::vector<unsigned char> occluded(1);
    pelagic_rays rays = PELAGIC_INIT(pelagic_rays);
    rays.origin_m[2] = 50.0;
    rays.count = 1;
    rays.direction = down.data();
    rays.on_earth = 2;
    pelagic_hits hits = PELAGIC_INIT(pelagic_hits);
    hits.distance = distance.data();
    EXPECT_EQ(pelagic_intersect(frame.get(), &rays, &hits, &error), PELAGIC_INVALID_ARGUMENT);
    is_said("rays.on_earth is 2");
    EXPECT_EQ(pelagic_occluded(frame.get(), &rays, occluded.data(), &error), PELAGIC_INVALID_ARGUMENT);
    is_said("rays.on_earth is 2");
    pelagic_camera camera = PELAGIC_INIT(pelagic_camera);
    ASSERT_EQ(pelagic_shot_camera(sea.get(), 1.0, &camera, nullptr), PELAGIC_OK);
    pelagic_mesh_size size = PELAGIC_INIT(pelagic_mesh_size);
    pelagic_expand_options options = PELAGIC_INIT(pelagic_expand_options);
    options.triangles = 2;
    EXPECT_EQ(pelagic_expand_size(frame.get(), &camera, &options, &size, &error), PELAGIC_INVALID_ARGUMENT);
    is_said("options.triangles is 2");
    options.triangles = 1;
    options.on_earth = -1;
    EXPECT_EQ(pelagic_expand_size(frame.get(), &camera, &options, &size, &error), PELAGIC_INVALID_ARGUMENT);
    is_said("options.on_earth is -1");
    options.on_earth = 1;
    EXPECT_EQ(pelagic_expand_size(frame.get(), &camera, &options, &size, &error), PELAGIC_OK);
    camera.width = 0;
    EXPECT_EQ(pelagic_expand_size(frame.get(), &camera, &options, &size, &error), PELAGIC_INVALID_ARGUMENT);
    EXPECT_NE(std::string(error.message).find("camera.width, height: "), std::string::npos) << error.message;
}

// A coarser sea takes less, whichever of the two its host says.
TEST(Procedural, OneFootprintStandsForBoth) {
    const auto bytes_of = [](double cell_m, double pixel_m) {
        pelagic_open_options options = PELAGIC_INIT(pelagic_open_options);
        options.finest_cell_m = cell_m;
        options.finest_pixel_m = pixel_m;
        pelagic_info info = PELAGIC_INIT(pelagic_info);
        const SeaHandle sea = open_text(kShot, &options);
        EXPECT_EQ(pelagic_get_info(sea.get(), &info, nullptr), PELAGIC_OK);
        return info.frame_bytes;
    };
    const std::size_t both = bytes_of(0.3, 0.3);
    EXPECT_EQ(bytes_of(0.3, 0.0), both);
    EXPECT_EQ(bytes_of(0.0, 0.3), both);
    EXPECT_LT(bytes_of(1.0, 0.0), both);
    EXPECT_LT(both, bytes_of(0.0, 0.0));
}

// By another thread, in the middle of rays that would take a minute.
TEST(Procedural, ACallThatRunsIsCancelled) {
    const SeaHandle sea = open_text(kShot);
    const FrameHandle frame = frame_of(sea, 3.0, 3.0);
    constexpr std::size_t kRays = 10'000'000;
    const std::vector<float> direction = [] {
        std::vector<float> all(3 * kRays, -0.02f);
        for (std::size_t i = 0; i < kRays; ++i) all[3 * i] = 1.0f;
        return all;
    }();
    std::vector<unsigned char> occluded(kRays, 2);
    pelagic_rays rays = PELAGIC_INIT(pelagic_rays);
    rays.origin_m[2] = 5.0;
    rays.count = kRays;
    rays.direction = direction.data();
    std::thread host([&] {
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        pelagic_cancel(sea.get(), 1, nullptr);
    });
    const pelagic_status status = pelagic_occluded(frame.get(), &rays, occluded.data(), nullptr);
    host.join();
    EXPECT_EQ(status, PELAGIC_CANCELLED);
    EXPECT_EQ(occluded.back(), 2) << "it went on to the end";
}

// Places that would take ten seconds or more.
TEST(Procedural, WaterThatIsAskedForIsCancelled) {
    const SeaHandle sea = open_text(kShot);
    const FrameHandle frame = frame_of(sea, 3.0, 3.0);
    constexpr std::size_t kPlaces = 1'000'000;
    std::vector<double> places_m(2 * kPlaces);
    for (std::size_t i = 0; i < places_m.size(); ++i) places_m[i] = static_cast<double>(i * 7919 % 1000);
    std::vector<pelagic_water> water(kPlaces, PELAGIC_INIT(pelagic_water));
    std::thread host([&] {
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        pelagic_cancel(sea.get(), 1, nullptr);
    });
    const pelagic_status status =
        pelagic_water_at(frame.get(), places_m.data(), kPlaces, 0.0, water.data(), nullptr);
    host.join();
    EXPECT_EQ(status, PELAGIC_CANCELLED);
}

TEST(Procedural, ASeaOverTheHostsMemoryIsRefused) {
    pelagic_open_options options = PELAGIC_INIT(pelagic_open_options);
    options.max_memory_bytes = 1 << 16;
    pelagic_source source = PELAGIC_INIT(pelagic_source);
    source.text = kShot.c_str();
    pelagic_sea* sea = nullptr;
    pelagic_error error;
    EXPECT_EQ(pelagic_open(&source, &options, &sea, &error), PELAGIC_OUT_OF_MEMORY);
    EXPECT_EQ(sea, nullptr);
    EXPECT_NE(std::string(error.message).find("a frame of this sea"), std::string::npos) << error.message;
    options.max_memory_bytes = std::size_t{4} << 30;
    EXPECT_EQ(pelagic_open(&source, &options, &sea, &error), PELAGIC_OK) << error.message;
    pelagic_close(sea);
}

// What a program would print of a shot, a host is told.
TEST(Procedural, NotesOnAShotAreTold) {
    std::vector<std::string> notes;
    pelagic_open_options options = PELAGIC_INIT(pelagic_open_options);
    options.user = &notes;
    options.note = [](const char* sentence, void* user) {
        static_cast<std::vector<std::string>*>(user)->emplace_back(sentence);
    };
    open_text(kShot, &options);
    EXPECT_TRUE(notes.empty()) << notes.front();
    open_text(kShot + "[waves]\nchoppiness = 3.5\n", &options);
    ASSERT_FALSE(notes.empty());
    EXPECT_EQ(notes.front().rfind("shot.toml: ", 0), 0u) << notes.front();
}

// Also across a loop's seam, and in slow motion.
TEST(Procedural, AShuttersTimesAreInOrder) {
    const SeaHandle sea = open_text("[shot]\nloop_s = 2.0\nframes = [1, 48]\ntime_scale = 0.5\n" + kShot);
    for (const double frame : {1.0, 24.0, 48.0, 49.0, -3.0}) {
        double open_s = 0.0, close_s = 0.0;
        ASSERT_EQ(pelagic_time_of_frame(sea.get(), frame - 0.25, &open_s, nullptr), PELAGIC_OK);
        ASSERT_EQ(pelagic_time_of_frame(sea.get(), frame + 0.25, &close_s, nullptr), PELAGIC_OK);
        EXPECT_NEAR(close_s - open_s, 0.25 / 24.0, 1e-12);
        EXPECT_NE(frame_of(sea, open_s, close_s), nullptr);
    }
    pelagic_info info = PELAGIC_INIT(pelagic_info);
    ASSERT_EQ(pelagic_get_info(sea.get(), &info, nullptr), PELAGIC_OK);
    EXPECT_EQ(info.time_scale, 0.5);
    EXPECT_EQ(info.loop_s, 1.0);
    const std::vector<glm::vec2> rests = random_rests(20, 50.0f);
    EXPECT_TRUE(ask(frame_of(sea, 0.25, 0.25), rests) == ask(frame_of(sea, 1.25, 1.25), rests));
}

// Anything further is a mistake: a time of the shot, say, where one of the shutter is meant.
TEST(Procedural, TimesOutsideTheShutterAreRefused) {
    const SeaHandle sea = open_text(kShot);
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    struct Shutter {
        double open_s, close_s;
    };
    // The last so late that its ends are a tenth of a microsecond apart at least.
    for (const Shutter shutter :
         {Shutter{1.0, 1.5}, {3.0, 3.0 + 1.0 / 48.0}, {0.0, 1.0}, {-2.0, -1.7}, {1e9, 1e9 + 1.0 / 48.0}}) {
        const FrameHandle frame = frame_of(sea, shutter.open_s, shutter.close_s);
        const std::vector<glm::vec2> rests = random_rests(10, 50.0f);
        const auto at = [&](float time_s) {
            return ask(frame, rests, glm::dvec2(0.0), {}, std::vector<float>(rests.size(), time_s));
        };
        // As hosts may reckon the end: by the ends, by the length, or as a share of it from its middle on.
        const auto open_for_s = static_cast<float>(shutter.close_s - shutter.open_s),
                   half_s = 0.5f * open_for_s;
        const Answers closed = at(open_for_s);
        EXPECT_TRUE(at(0.0f) == at(-0.0f));
        EXPECT_FALSE(at(0.0f) == closed);
        for (const float end_s :
             {std::nextafter(open_for_s, 1e9f), (0.1f + 0.9f) * open_for_s, half_s + 1.0000001f * half_s}) {
            const Answers answers = at(end_s);
            for (std::size_t i = 0; i < rests.size(); ++i)
                EXPECT_LT(glm::length(answers.position[i] - closed.position[i]), 1e-5f);
        }
        for (const float outside_s :
             {1.001f * open_for_s, -0.001f * open_for_s, -3.0f, 1e9f, inf, -inf, nan}) {
            std::vector<float> times_s(rests.size(), half_s);
            times_s[7] = outside_s;
            pelagic_points points = PELAGIC_INIT(pelagic_points);
            points.count = rests.size();
            points.rest_m = &rests[0].x;
            points.time_s = times_s.data();
            Answers answers(rests.size());
            const pelagic_values values = answers.values();
            pelagic_error error;
            EXPECT_EQ(pelagic_evaluate(frame.get(), &points, &values, &error), PELAGIC_INVALID_ARGUMENT)
                << outside_s;
            EXPECT_NE(std::string(error.message).find("points.time_s[7] is "), std::string::npos)
                << error.message;
            EXPECT_TRUE(answers == Answers(rests.size()));
        }
    }
    const FrameHandle moment = frame_of(sea, 1.0, 1.0);
    const std::vector<glm::vec2> rest = random_rests(1, 50.0f);
    EXPECT_TRUE(ask(moment, rest, glm::dvec2(0.0), {}, {0.0f}) == ask(moment, rest));
}

// A program that will be compiled when structures are longer, and asks for nothing new; or does.
TEST(Procedural, LaterVersionsStructuresAreUnderstood) {
    const SeaHandle sea = open_text(kShot);
    struct {
        pelagic_info info;
        double later;
    } out{};
    out.info.size = sizeof out;
    out.later = 7.0;
    ASSERT_EQ(pelagic_get_info(sea.get(), &out.info, nullptr), PELAGIC_OK);
    EXPECT_EQ(out.later, 7.0);
    EXPECT_EQ(out.info.size, sizeof out);
    EXPECT_GT(out.info.significant_height_m, 0.1);
    struct {
        pelagic_region region;
        double later;
    } in{};
    in.region.size = sizeof in;
    const FrameHandle frame = frame_of(sea, 0.0, 0.0);
    pelagic_box box = PELAGIC_INIT(pelagic_box);
    EXPECT_EQ(pelagic_bounds(frame.get(), &in.region, &box, nullptr), PELAGIC_OK);
    in.later = 1.0;
    pelagic_error error;
    EXPECT_EQ(pelagic_bounds(frame.get(), &in.region, &box, &error), PELAGIC_INVALID_ARGUMENT);
    EXPECT_NE(std::string(error.message).find("later version"), std::string::npos) << error.message;
    // Cut in the middle.
    in.later = 0.0;
    in.region.size = sizeof in.region - 4;
    EXPECT_EQ(pelagic_bounds(frame.get(), &in.region, &box, nullptr), PELAGIC_INVALID_ARGUMENT);
}

// Also one so large that the end of it lies before its beginning, which has nothing behind it to be looked at.
TEST(Procedural, SizesOfNoVersionAreRefused) {
    const SeaHandle sea = open_text(kShot + "[waves]\nvessels = [ { path = \"1 0 0, 48 10 0\" } ]\n");
    const FrameHandle frame = frame_of(sea, 0.0, 0.0);
    pelagic_sea* no_sea = nullptr;
    pelagic_error error;
    pelagic_source source = PELAGIC_INIT(pelagic_source);
    source.text = "";
    pelagic_open_options open = PELAGIC_INIT(pelagic_open_options);
    pelagic_info info = PELAGIC_INIT(pelagic_info);
    pelagic_camera camera = PELAGIC_INIT(pelagic_camera);
    ASSERT_EQ(pelagic_shot_camera(sea.get(), 1.0, &camera, &error), PELAGIC_OK);
    pelagic_vessel vessel = PELAGIC_INIT(pelagic_vessel);
    pelagic_region region = PELAGIC_INIT(pelagic_region);
    pelagic_box box = PELAGIC_INIT(pelagic_box);
    pelagic_points points = PELAGIC_INIT(pelagic_points);
    pelagic_values values = PELAGIC_INIT(pelagic_values);
    pelagic_rays rays = PELAGIC_INIT(pelagic_rays);
    pelagic_hits hits = PELAGIC_INIT(pelagic_hits);
    pelagic_expand_options expand = PELAGIC_INIT(pelagic_expand_options);
    expand.cell_px = 32.0;
    pelagic_mesh_size mesh_size = PELAGIC_INIT(pelagic_mesh_size);
    pelagic_mesh_buffers buffers = PELAGIC_INIT(pelagic_mesh_buffers);
    hits.values = buffers.values = &values;
    unsigned char occluded = 7;
    const auto expand_size = [&] {
        return pelagic_expand_size(frame.get(), &camera, &expand, &mesh_size, &error);
    };
    const auto expanded = [&] { return pelagic_expand(frame.get(), &camera, &expand, &buffers, &error); };
    const auto evaluate = [&] { return pelagic_evaluate(frame.get(), &points, &values, &error); };
    const auto intersect = [&] { return pelagic_intersect(frame.get(), &rays, &hits, &error); };
    const auto shadows = [&] { return pelagic_occluded(frame.get(), &rays, &occluded, &error); };
    const auto bounds = [&] { return pelagic_bounds(frame.get(), &region, &box, &error); };
    const auto opened = [&] { return pelagic_open(&source, &open, &no_sea, &error); };
    struct Case {
        const char* structure;
        std::size_t& size;
        std::function<pelagic_status()> call;
    };
    // Every structure, wherever it goes in or out.
    const std::vector<Case> cases{
        {"source", source.size, opened},
        {"options", open.size, opened},
        {"info", info.size, [&] { return pelagic_get_info(sea.get(), &info, &error); }},
        {"camera", camera.size, [&] { return pelagic_shot_camera(sea.get(), 1.0, &camera, &error); }},
        {"at", vessel.size, [&] { return pelagic_vessel_at(sea.get(), 0, 1.0, &vessel, &error); }},
        {"camera", camera.size, expand_size},
        {"camera", camera.size, expanded},
        {"region", region.size, bounds},
        {"box", box.size, bounds},
        {"points", points.size, evaluate},
        {"values", values.size, evaluate},
        {"rays", rays.size, intersect},
        {"rays", rays.size, shadows},
        {"hits", hits.size, intersect},
        {"hits.values", values.size, intersect},
        {"options", expand.size, expand_size},
        {"options", expand.size, expanded},
        {"mesh_size", mesh_size.size, expand_size},
        {"buffers", buffers.size, expanded},
        {"buffers.values", values.size, expanded}};
    for (const Case& one : cases) {
        const std::size_t before = one.size;
        for (const std::size_t size :
             {SIZE_MAX, SIZE_MAX - 7, SIZE_MAX - 4096, std::size_t{PTRDIFF_MAX}, std::size_t{4097}}) {
            one.size = size;
            EXPECT_EQ(one.call(), PELAGIC_INVALID_ARGUMENT) << one.structure << ' ' << size;
            EXPECT_EQ(std::string(error.message).find(std::string(one.structure) + " has a size of "), 0u)
                << error.message;
        }
        one.size = before;
    }
    EXPECT_EQ(no_sea, nullptr);
}

// Counts whose places would wrap, and texts that no shot is as long as.
TEST(Procedural, CountsThatNoMemoryHoldsAreRefused) {
    const SeaHandle sea = open_text(kShot);
    const FrameHandle frame = frame_of(sea, 0.0, 0.5);
    const float numbers[3] = {0.0f, 0.0f, -1.0f};
    pelagic_points points = PELAGIC_INIT(pelagic_points);
    points.rest_m = points.time_s = numbers;
    pelagic_values values = PELAGIC_INIT(pelagic_values);
    pelagic_rays rays = PELAGIC_INIT(pelagic_rays);
    rays.direction = rays.time_s = numbers;
    pelagic_hits hits = PELAGIC_INIT(pelagic_hits);
    unsigned char occluded = 7;
    pelagic_error error;
    for (const std::size_t count : {SIZE_MAX, SIZE_MAX / 4 + 1, SIZE_MAX / 12}) {
        points.count = rays.count = count;
        EXPECT_EQ(pelagic_evaluate(frame.get(), &points, &values, &error), PELAGIC_INVALID_ARGUMENT);
        EXPECT_NE(std::string(error.message).find("points.count"), std::string::npos) << error.message;
        EXPECT_EQ(pelagic_intersect(frame.get(), &rays, &hits, &error), PELAGIC_INVALID_ARGUMENT);
        EXPECT_NE(std::string(error.message).find("rays.count"), std::string::npos) << error.message;
        EXPECT_EQ(pelagic_occluded(frame.get(), &rays, &occluded, &error), PELAGIC_INVALID_ARGUMENT);
    }
    pelagic_source source = PELAGIC_INIT(pelagic_source);
    source.text = "";
    pelagic_sea* no_sea = nullptr;
    for (const std::size_t length : {SIZE_MAX, (std::size_t{16} << 20) + 1}) {
        source.text_length = length;
        EXPECT_EQ(pelagic_open(&source, nullptr, &no_sea, &error), PELAGIC_INVALID_ARGUMENT);
        EXPECT_NE(std::string(error.message).find("source.text"), std::string::npos) << error.message;
    }
    EXPECT_EQ(no_sea, nullptr);
}

}  // namespace
}  // namespace pelagic
