// Rays through the C interface: what they answer, whatever comes in.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstring>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include "core/surface/earth.h"
#include "tests/plugin/host/procedural/opened.h"

namespace pelagic {
namespace {

using namespace test;

constexpr float kForever = std::numeric_limits<float>::infinity();
// Foam with a short past.
const std::string kRaysShot = "[camera]\nresolution = [160, 90]\n[effects]\nfoam_decay_s = 0.5\n";

struct Hits {
    std::vector<float> distance, footprint_m, coverage;
    std::vector<glm::vec2> rest_m;
    std::vector<glm::vec3> position, normal, velocity, slope_variance;

    explicit Hits(std::size_t count)
        : distance(count),
          footprint_m(count),
          coverage(count),
          rest_m(count),
          position(count),
          normal(count),
          velocity(count),
          slope_variance(count) {}
    bool operator==(const Hits&) const = default;
};

// Rays from one place, widening by a thousandth.
struct Fan {
    glm::dvec3 origin_m{0.0, 0.0, 8.0};
    std::vector<glm::vec3> direction;
    std::vector<float> spread, time_s;
    bool on_earth = false;

    pelagic_rays rays() const {
        pelagic_rays asks = PELAGIC_INIT(pelagic_rays);
        for (int axis = 0; axis < 3; ++axis) asks.origin_m[axis] = origin_m[axis];
        asks.count = direction.size();
        asks.direction = direction.empty() ? nullptr : &direction[0].x;
        asks.spread = spread.empty() ? nullptr : spread.data();
        asks.time_s = time_s.empty() ? nullptr : time_s.data();
        asks.on_earth = on_earth ? 1 : 0;
        return asks;
    }
};

// Every which way, and a ring that looks at the horizon.
Fan fan_of(std::size_t count) {
    Fan fan;
    for (std::size_t i = 0; i < count; ++i) {
        const double turn = 2.399963 * static_cast<double>(i);
        const double z = i % 4 == 0 ? 0.002 * (static_cast<double>(i % 11) - 5.0)
                                    : 1.0 - 2.0 * (static_cast<double>(i) + 0.5) / static_cast<double>(count);
        const double across = std::sqrt(1.0 - z * z);
        fan.direction.emplace_back(across * std::cos(turn), across * std::sin(turn), z);
        fan.spread.push_back(1e-3f);
    }
    return fan;
}

Hits hits_of(const FrameHandle& frame, const pelagic_rays& rays) {
    Hits hits(rays.count);
    pelagic_values values = PELAGIC_INIT(pelagic_values);
    values.position_m = &hits.position[0].x;
    values.normal = &hits.normal[0].x;
    values.velocity_mps = &hits.velocity[0].x;
    values.slope_variance = &hits.slope_variance[0].x;
    values.coverage = hits.coverage.data();
    pelagic_hits found = PELAGIC_INIT(pelagic_hits);
    found.distance = hits.distance.data();
    found.rest_m = &hits.rest_m[0].x;
    found.footprint_m = hits.footprint_m.data();
    found.values = &values;
    pelagic_error error;
    EXPECT_EQ(pelagic_intersect(frame.get(), &rays, &found, &error), PELAGIC_OK) << error.message;
    return hits;
}

TEST(ProceduralRays, HitsHaveTheQuerysValues) {
    const FrameHandle frame = frame_of(open_text(kRaysShot), 3.0, 3.0);
    for (const glm::dvec2 place : {glm::dvec2(0.0), glm::dvec2(2e6, -7e5)}) {
        Fan fan = fan_of(600);
        fan.origin_m = glm::dvec3(place, 8.0);
        const Hits hits = hits_of(frame, fan.rays());
        pelagic_points points = PELAGIC_INIT(pelagic_points);
        points.origin_m[0] = place.x;
        points.origin_m[1] = place.y;
        points.count = 1;
        std::size_t count = 0;
        for (std::size_t i = 0; i < fan.direction.size(); ++i) {
            if (hits.distance[i] == kForever) {
                EXPECT_EQ(hits.normal[i], glm::vec3(0.0f));
                EXPECT_EQ(hits.coverage[i], 0.0f);
                EXPECT_EQ(hits.footprint_m[i], 0.0f);
                EXPECT_GT(fan.direction[i].z, -0.02f);
                continue;
            }
            ++count;
            points.rest_m = &hits.rest_m[i].x;
            points.cell_m = points.pixel_m = &hits.footprint_m[i];
            glm::vec3 position, normal, velocity, variance;
            float coverage = 0.0f;
            pelagic_values values = PELAGIC_INIT(pelagic_values);
            values.position_m = &position.x;
            values.normal = &normal.x;
            values.velocity_mps = &velocity.x;
            values.slope_variance = &variance.x;
            values.coverage = &coverage;
            ASSERT_EQ(pelagic_evaluate(frame.get(), &points, &values, nullptr), PELAGIC_OK);
            EXPECT_EQ(hits.normal[i], normal);
            EXPECT_EQ(hits.velocity[i], velocity);
            EXPECT_EQ(hits.slope_variance[i], variance);
            EXPECT_EQ(hits.coverage[i], coverage);
            const glm::vec3 on_ray = glm::vec3(0.0f, 0.0f, 8.0f) + hits.distance[i] * fan.direction[i];
            EXPECT_LT(glm::length(hits.position[i] - on_ray), 1e-5f * (1.0f + hits.distance[i]));
            EXPECT_LT(glm::length(hits.position[i] - position), hits.footprint_m[i]);
        }
        EXPECT_GT(count, 280u);
    }
}

TEST(ProceduralRays, DontDependOnWhatIsKeptNorOnOthers) {
    pelagic_open_options little = PELAGIC_INIT(pelagic_open_options);
    little.ray_cache_bytes = 1;
    const FrameHandle kept = frame_of(open_text(kRaysShot), 3.0, 3.02),
                      forgotten = frame_of(open_text(kRaysShot, &little), 3.0, 3.02);
    Fan fan = fan_of(400);
    for (std::size_t i = 0; i < fan.direction.size(); ++i)
        fan.time_s.push_back(0.0001f * static_cast<float>(i % 200));
    const Hits all = hits_of(kept, fan.rays());
    EXPECT_TRUE(all == hits_of(kept, fan.rays()));
    EXPECT_TRUE(all == hits_of(forgotten, fan.rays()));
    std::vector<std::thread> threads;
    const FrameHandle shared = frame_of(open_text(kRaysShot), 3.0, 3.02);
    for (int thread = 0; thread < 4; ++thread)
        threads.emplace_back([&] { EXPECT_TRUE(all == hits_of(shared, fan.rays())); });
    for (std::thread& thread : threads) thread.join();
    // One by one, backwards.
    for (std::size_t i = fan.direction.size(); i-- > 0;) {
        pelagic_rays one = fan.rays();
        one.count = 1;
        one.direction = &fan.direction[i].x;
        one.time_s = &fan.time_s[i];
        float distance = 0.0f;
        pelagic_hits found = PELAGIC_INIT(pelagic_hits);
        found.distance = &distance;
        ASSERT_EQ(pelagic_intersect(kept.get(), &one, &found, nullptr), PELAGIC_OK);
        ASSERT_EQ(distance, all.distance[i]);
    }
}

TEST(ProceduralRays, FollowTheFrame) {
    const SeaHandle sea = open_text(kRaysShot);
    const FrameHandle frame = frame_of(sea, 3.0, 3.0), later = frame_of(sea, 4.0, 4.0);
    const Fan fan = fan_of(300);
    const Hits before = hits_of(frame, fan.rays());
    ASSERT_EQ(pelagic_frame_set(frame.get(), 4.0, 4.0, nullptr), PELAGIC_OK);
    const Hits after = hits_of(frame, fan.rays());
    EXPECT_FALSE(before == after);
    EXPECT_TRUE(after == hits_of(later, fan.rays()));
}

TEST(ProceduralRays, OnTheEarthPlacesAreTheBentSeas) {
    const FrameHandle frame = frame_of(open_text(kRaysShot), 3.0, 3.0);
    Fan fan = fan_of(2000);
    fan.on_earth = true;
    fan.origin_m.z = 30.0;
    const Hits hits = hits_of(frame, fan.rays());
    std::size_t far = 0;
    for (std::size_t i = 0; i < hits.distance.size(); ++i) {
        if (hits.distance[i] == kForever) continue;
        pelagic_points points = PELAGIC_INIT(pelagic_points);
        points.count = 1;
        points.rest_m = &hits.rest_m[i].x;
        glm::vec3 flat;
        pelagic_values values = PELAGIC_INIT(pelagic_values);
        values.position_m = &flat.x;
        ASSERT_EQ(pelagic_evaluate(frame.get(), &points, &values, nullptr), PELAGIC_OK);
        const glm::dvec3 bent = on_earth(glm::dvec3(flat), kEarthCurvature_per_m);
        const glm::dvec3 from(0.0, 0.0, 30.0), direction = glm::normalize(glm::dvec3(fan.direction[i]));
        const double along_m = glm::dot(bent - from, direction);
        // The tolerance is half a footprint; straight pieces of the bent ray take a tenth of it more.
        EXPECT_LT(glm::length(bent - from - along_m * direction), 0.6 * hits.footprint_m[i]) << along_m;
        EXPECT_NEAR(glm::length(hits.normal[i]), 1.0f, 1e-5f);
        if (along_m > 8000.0) ++far;
    }
    EXPECT_GT(far, 5u);  // where the flat sea lies five metres above the bent one
    // Higher than the dip of the horizon and the waves on it, nothing is hit; on the flat sea this ray meets it 60 km away.
    Fan over;
    over.direction = {glm::vec3(0.0f, 1.0f, -0.0005f)};
    over.origin_m.z = 30.0;
    EXPECT_LT(hits_of(frame, over.rays()).distance[0], 61e3f);
    over.on_earth = true;
    EXPECT_EQ(hits_of(frame, over.rays()).distance[0], kForever);
}

TEST(ProceduralRays, OnTheEarthEndWhereTheyAreUnderAllWaves) {
    const FrameHandle frame = frame_of(open_text(kRaysShot), 3.0, 3.0);
    const auto distance = [&](double z, glm::vec3 direction) {
        Fan fan;
        fan.on_earth = true;
        fan.origin_m.z = z;
        fan.direction = {direction};
        return hits_of(frame, fan.rays()).distance[0];
    };
    // Refracted rays don't come up at the other side of the world.
    EXPECT_EQ(distance(-15.0, {0.1f, 0.0f, -1.0f}), kForever);
    EXPECT_EQ(distance(-15.0, {1.0f, 0.0f, -0.5f}), kForever);
    // From far below and from orbit they meet the waves over the place, not the sea at rest.
    // To a tenth of a metre: distances are in single precision, footprints of centimetres.
    const float over = 30.0f - distance(30.0, {0.0f, 0.0f, -1.0f});
    EXPECT_GT(std::abs(over), 0.01f);
    EXPECT_NEAR(distance(-2e5, {0.0f, 0.0f, 1.0f}), 2e5 + over, 0.1);
    EXPECT_NEAR(distance(4e5, {0.0f, 0.0f, -1.0f}), 4e5 - over, 0.1);
}

TEST(ProceduralRays, ALongWayBetweenTheWavesEndsOnTheSeaAtRest) {
    const FrameHandle frame = frame_of(open_text("[sea]\nwind_speed_mps = 0.5\n"), 3.0, 3.0);
    Fan fan;
    fan.origin_m.z = 0.012;
    fan.direction = {glm::vec3(1.0f, 0.0f, -1e-8f)};
    const float distance = hits_of(frame, fan.rays()).distance[0];
    EXPECT_GT(distance, 3e4f);
    EXPECT_LT(distance, 2e6f);
}

TEST(ProceduralRays, OfTrainsTakeAnyFinestCell) {
    for (const double finest_m : {1e-300, 1e-12, 1e6}) {
        pelagic_open_options options = PELAGIC_INIT(pelagic_open_options);
        options.finest_cell_m = options.finest_pixel_m = finest_m;
        const FrameHandle frame = frame_of(open_text("[waves]\nmodel = \"trochoid\"\n", &options), 3.0, 3.0);
        Fan fan = fan_of(60);
        fan.spread.clear();
        for (const bool on_earth : {false, true}) {
            fan.on_earth = on_earth;
            const Hits hits = hits_of(frame, fan.rays());
            for (std::size_t i = 0; i < fan.direction.size(); ++i) {
                if (fan.direction[i].z < -0.1f) {
                    EXPECT_LT(hits.distance[i], 100.0f) << finest_m;
                }
            }
        }
    }
}

TEST(ProceduralRays, ShareALittleRoom) {
    pelagic_open_options little = PELAGIC_INIT(pelagic_open_options);
    little.ray_cache_bytes = 200000;
    const FrameHandle frame = frame_of(open_text(kRaysShot, &little), 3.0, 3.0);
    const Fan fan = fan_of(1000);
    const Hits alone = hits_of(frame_of(open_text(kRaysShot), 3.0, 3.0), fan.rays());
    std::vector<std::thread> threads;
    for (int thread = 0; thread < 4; ++thread)
        threads.emplace_back([&] { EXPECT_TRUE(alone == hits_of(frame, fan.rays())); });
    for (std::thread& thread : threads) thread.join();
}

TEST(ProceduralRays, OfProgramsThatKnowLess) {
    pelagic_open_options options = PELAGIC_INIT(pelagic_open_options);
    options.size = offsetof(pelagic_open_options, ray_cache_bytes);
    options.ray_cache_bytes = ~std::size_t{0};  // isn't theirs
    const SeaHandle sea = open_text(kRaysShot, &options);
    const FrameHandle frame = frame_of(sea, 1.0, 1.0);
    pelagic_camera camera = PELAGIC_INIT(pelagic_camera);
    ASSERT_EQ(pelagic_shot_camera(sea.get(), 1.0, &camera, nullptr), PELAGIC_OK);
    pelagic_expand_options expand = PELAGIC_INIT(pelagic_expand_options);
    expand.size = offsetof(pelagic_expand_options, error_px);
    expand.error_px = -1.0;
    pelagic_mesh_size size = PELAGIC_INIT(pelagic_mesh_size);
    EXPECT_EQ(pelagic_expand_size(frame.get(), &camera, &expand, &size, nullptr), PELAGIC_OK);
}

TEST(ProceduralRays, OfACalmSeaMeetThePlane) {
    for (const char* text : {"[sea]\nwind_speed_mps = 0.1\n", "[sea]\nwind_speed_mps = 0.0\n"}) {
        const FrameHandle frame = frame_of(open_text(text), 1.0, 1.0);
        const Fan fan = fan_of(200);
        const Hits hits = hits_of(frame, fan.rays());
        for (std::size_t i = 0; i < fan.direction.size(); ++i) {
            if (fan.direction[i].z > -0.01f) continue;
            EXPECT_NEAR(hits.distance[i] * fan.direction[i].z, -8.0f, 0.05f + hits.footprint_m[i]) << text;
        }
    }
}

TEST(ProceduralRays, DirectionsHaveLengths) {
    const FrameHandle frame = frame_of(open_text(kRaysShot), 3.0, 3.0);
    float first = 0.0f;
    for (const float length : {1.0f, 0.125f, 64.0f, 1e-20f, 1e20f}) {
        Fan fan;
        fan.direction = {length * glm::vec3(0.0f, 0.5f, -0.5f)};
        const float metres = hits_of(frame, fan.rays()).distance[0] * length;
        if (first == 0.0f) first = metres;
        EXPECT_NEAR(metres, first, 1e-5f * first) << length;
        // Between near and far alone.
        pelagic_rays rays = fan.rays();
        const float beyond = 1.01f * metres / length, before = 0.99f * metres / length;
        rays.near = &beyond;
        EXPECT_GT(hits_of(frame, rays).distance[0], beyond);
        rays.near = nullptr;
        rays.far = &before;
        EXPECT_EQ(hits_of(frame, rays).distance[0], kForever);
    }
}

TEST(ProceduralRays, WhateverComesInIsFiniteOrNothing) {
    const FrameHandle frame = frame_of(open_text(kRaysShot), 3.0, 3.02);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float odd[] = {nan, kForever, -kForever, 0.0f, -1.0f, 3e38f, 1e30f, -1e30f, 1e-38f, 1.0f};
    Fan fan;
    std::vector<glm::vec3> offset_m;
    std::vector<float> near, far, footprint_m;
    for (const float a : odd)
        for (const float b : odd)
            for (int where = 0; where < 9; ++where) {
                const auto at = [&](int place, float usual) {
                    return where == place ? a : where + 1 == place ? b : usual;
                };
                offset_m.emplace_back(at(0, 0.0f), at(1, 3.0f), at(2, -2.0f));
                fan.direction.emplace_back(at(2, 0.3f), at(3, 0.2f), at(4, -0.5f));
                near.push_back(at(5, 0.0f));
                far.push_back(at(6, 100.0f));
                footprint_m.push_back(at(7, 0.0f));
                fan.spread.push_back(at(8, 0.0f));
                fan.time_s.push_back(0.001f * static_cast<float>(where));
            }
    for (const bool on_earth : {false, true}) {
        fan.on_earth = on_earth;
        pelagic_rays rays = fan.rays();
        rays.offset_m = &offset_m[0].x;
        rays.near = near.data();
        rays.far = far.data();
        rays.footprint_m = footprint_m.data();
        const Hits hits = hits_of(frame, rays);
        for (std::size_t i = 0; i < rays.count; ++i) {
            ASSERT_FALSE(std::isnan(hits.distance[i])) << i;
            for (const float value : {hits.rest_m[i].x, hits.rest_m[i].y, hits.footprint_m[i],
                                      hits.position[i].x, hits.position[i].z, hits.normal[i].z,
                                      hits.velocity[i].x, hits.slope_variance[i].x, hits.coverage[i]})
                ASSERT_TRUE(std::isfinite(value)) << i;
        }
    }
}

TEST(ProceduralRays, RefuseWhatTheyCantTake) {
    const FrameHandle frame = frame_of(open_text(kRaysShot), 3.0, 3.0);
    const Fan fan = fan_of(4);
    float distance[4] = {1.0f, 2.0f, 3.0f, 4.0f};
    unsigned char occluded[4] = {7, 7, 7, 7};
    const auto refuses = [&](const std::function<void(pelagic_rays&)>& change) {
        pelagic_rays rays = fan.rays();
        change(rays);
        pelagic_hits found = PELAGIC_INIT(pelagic_hits);
        found.distance = distance;
        pelagic_error error;
        EXPECT_EQ(pelagic_intersect(frame.get(), &rays, &found, &error), PELAGIC_INVALID_ARGUMENT);
        EXPECT_GT(std::strlen(error.message), 10u);
        EXPECT_EQ(pelagic_occluded(frame.get(), &rays, occluded, &error), PELAGIC_INVALID_ARGUMENT);
        EXPECT_EQ(distance[0], 1.0f);
        EXPECT_EQ(occluded[0], 7);
    };
    refuses([](pelagic_rays& rays) { rays.direction = nullptr; });
    refuses([](pelagic_rays& rays) { rays.tolerance = 0.01; });
    refuses([](pelagic_rays& rays) { rays.tolerance = std::nan(""); });
    refuses([](pelagic_rays& rays) { rays.origin_m[1] = INFINITY; });
    refuses([](pelagic_rays& rays) { rays.size = 0; });
    for (const float outside_s : {1e-6f, -1e-6f, 3.0f, kForever, std::nanf("")}) {
        const float times_s[4] = {0.0f, 0.0f, 0.0f, outside_s};  // the frame is a moment
        refuses([&](pelagic_rays& rays) { rays.time_s = times_s; });
    }
    pelagic_error error;
    const pelagic_rays rays = fan.rays();
    EXPECT_EQ(pelagic_intersect(frame.get(), &rays, nullptr, &error), PELAGIC_INVALID_ARGUMENT);
    EXPECT_EQ(pelagic_occluded(frame.get(), &rays, nullptr, &error), PELAGIC_INVALID_ARGUMENT);
    EXPECT_EQ(pelagic_occluded(nullptr, &rays, occluded, &error), PELAGIC_INVALID_ARGUMENT);
    pelagic_rays none = PELAGIC_INIT(pelagic_rays);
    EXPECT_EQ(pelagic_occluded(frame.get(), &none, nullptr, &error), PELAGIC_OK);
}

}  // namespace
}  // namespace pelagic
