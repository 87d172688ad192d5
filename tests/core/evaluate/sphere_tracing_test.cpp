// Sphere tracing of wave trains against a march in small steps, over rays of every kind.
#include "core/evaluate/sphere_tracing.h"

#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdio>
#include <glm/geometric.hpp>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "core/base/constants.h"
#include "tests/core/waves/samples.h"

namespace pelagic {
namespace {

using namespace test;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kTracedCell_m = 0.6;

Scene sea(int trains) {
    Scene scene;
    scene.waves.model = WaveModel::Trochoid;
    scene.waves.choppiness = 0.0;
    scene.waves.trains = trains;
    scene.waves.longest_m = 180.0;
    scene.waves.shortest_m = 1.0;
    return scene;
}
Frame<float> frame_of_trains(const Scene& scene, double t_s = 3.7) {
    return frame_of<float>(scene, {unfiltered(products(Position))}, t_s);
}

// The height field again, train by train in double, from Trains alone.
class Plain {
  public:
    Plain(const Frame<float>& frame, double cell_m) {
        const Trains<float>& trains = frame.sea().trains();
        for (std::size_t i = 0; i < trains.count(); ++i) {
            const double height_m = trains.height_m[i] *
                                    frame.sea().plan().filter.weight(kTwoPi / trains.wavelength_m[i], cell_m);
            waves_.push_back({trains.kx_cycles_per_m[i], trains.ky_cycles_per_m[i],
                              trains.start_cycles[i] + trains.cycles_per_s[i] * frame.time_s(), height_m});
            highest_m += height_m;
            steepest += height_m * kTwoPi / trains.wavelength_m[i];
        }
    }
    double height_m(double x, double y) const {
        double sum = 0.0;
        for (const Wave& w : waves_) sum += w.height_m * std::cos(kTwoPi * (w.cycles - w.kx * x - w.ky * y));
        return sum;
    }
    double over_m(glm::dvec3 p) const { return p.z - height_m(p.x, p.y); }

    // Where a ray of unit direction first changes sides between `from` and `to` [m], to 1e-6; infinite where it doesn't. Steps of a
    // fortieth of the shortest wave; each train's phasor turns by the same angle at each.
    double first_crossing_m(glm::dvec3 p, glm::dvec3 d, double from_m, double to_m) const {
        constexpr double kStep_m = 1.0 / 40.0;
        constexpr int kRun = 512;
        const double first = over_m(p + from_m * d);
        std::vector<std::complex<double>> turn, at(waves_.size());
        for (const Wave& w : waves_)
            turn.push_back(std::polar(1.0, -kTwoPi * kStep_m * (w.kx * d.x + w.ky * d.y)));
        for (double s = from_m; s < to_m;) {
            for (std::size_t i = 0; i < waves_.size(); ++i) {
                const glm::dvec3 q = p + s * d;
                at[i] = std::polar(waves_[i].height_m,
                                   kTwoPi * (waves_[i].cycles - waves_[i].kx * q.x - waves_[i].ky * q.y));
            }
            for (int step = 0; step < kRun && s < to_m; ++step) {
                const double last = s;
                s = std::min(s + kStep_m, to_m);
                double sum = 0.0;
                for (std::size_t i = 0; i < waves_.size(); ++i) {
                    // The operator's own product looks for NaN.
                    at[i] = {at[i].real() * turn[i].real() - at[i].imag() * turn[i].imag(),
                             at[i].real() * turn[i].imag() + at[i].imag() * turn[i].real()};
                    sum += at[i].real();
                }
                if (s == to_m) sum = height_m(p.x + s * d.x, p.y + s * d.y);
                if ((p.z + s * d.z - sum > 0.0) == (first > 0.0)) continue;
                double low = last, high = s;
                while (high - low > 1e-6) {
                    const double middle = 0.5 * (low + high);
                    ((over_m(p + middle * d) > 0.0) == (first > 0.0) ? low : high) = middle;
                }
                return high;
            }
        }
        return kInfinity;
    }

    double highest_m = 0.0, steepest = 0.0;

  private:
    struct Wave {
        double kx, ky, cycles, height_m;
    };
    std::vector<Wave> waves_;
};

struct Kind {
    std::string name;
    int rays;
    glm::dvec3 origin_m;         // of the batch
    double beside_m;             // rays begin within this of it
    double lowest_m, highest_m;  // z, or over the surface:
    bool is_from_surface;
    double least_rise, most_rise;  // d_z
    double far_m;
};
struct Batch {
    std::vector<glm::vec3> offset_m, direction;
    std::vector<float> far;
    TracedRays rays(const Kind& kind, const std::vector<float>& tolerance_m) const {
        return {.count = offset_m.size(),
                .origin_m = kind.origin_m,
                .offset_m = {offset_m.data()},
                .direction = {direction.data()},
                .far = {far.data()},
                .tolerance_m = {tolerance_m.data()}};
    }
};

Batch batch_of(const Kind& kind, const Plain& plain, std::mt19937& random) {
    const auto uniform = [&](double a, double b) { return std::uniform_real_distribution(a, b)(random); };
    Batch batch;
    for (int i = 0; i < kind.rays; ++i) {
        glm::vec3 offset(uniform(-kind.beside_m, kind.beside_m), uniform(-kind.beside_m, kind.beside_m),
                         uniform(kind.lowest_m, kind.highest_m));
        if (kind.is_from_surface)
            offset.z += static_cast<float>(plain.height_m(kind.origin_m.x + static_cast<double>(offset.x),
                                                          kind.origin_m.y + static_cast<double>(offset.y)));
        const double rise = uniform(kind.least_rise, kind.most_rise), turn = uniform(0.0, kTwoPi);
        const double level = std::sqrt(1.0 - rise * rise), length = uniform(0.3, 3.0);
        batch.offset_m.push_back(offset);
        batch.direction.push_back(
            glm::vec3(length * glm::dvec3(level * std::cos(turn), level * std::sin(turn), rise)));
        batch.far.push_back(static_cast<float>(kind.far_m / length));
    }
    return batch;
}

const std::vector<Kind>& kinds() {
    constexpr double kMegametre = 1e6;
    static const std::vector<Kind> all{
        {"from a deck", 9000, {120.0, -40.0, 0.0}, 50.0, 4.0, 12.0, false, -0.9, -0.03, 1e4},
        {"grazing", 900, {0.0, 0.0, 0.0}, 50.0, 0.5, 3.0, false, -0.01, 0.002, 400.0},
        {"from below", 4500, {0.0, 70.0, 0.0}, 50.0, -30.0, -4.0, false, 0.05, 1.0, 1e4},
        {"from below, down", 1500, {0.0, 70.0, 0.0}, 50.0, -9.0, -1.5, false, -1.0, 0.05, 200.0},
        {"from just above", 6000, {0.0, 0.0, 0.0}, 50.0, 0.01, 0.05, true, -0.5, 0.5, 150.0},
        {"from just below", 6000, {0.0, 0.0, 0.0}, 50.0, -0.05, -0.01, true, -0.5, 0.5, 150.0},
        {"upward", 3000, {0.0, 0.0, 0.0}, 50.0, 0.5, 8.0, false, 0.01, 1.0, 1e4},
        {"from a megametre up", 6000, {300.0, 0.0, kMegametre}, 50.0, 0.0, 1.0, false, -1.0, -0.3, 1e7},
        {"far away", 6000, {kMegametre, -kMegametre, 0.0}, 50.0, 3.0, 9.0, false, -0.6, -0.03, 1e4},
        {"far ends first", 3000, {0.0, 0.0, 0.0}, 50.0, 1.0, 5.0, false, -0.9, -0.05, 9.0}};
    return all;
}

// Rays that run along the crest of the highest train, a little above it and below.
Batch along_crests(const Frame<float>& frame, const Plain& plain, std::mt19937& random, Kind& kind) {
    const Trains<float>& trains = frame.sea().trains();
    const auto highest = static_cast<std::size_t>(
        std::max_element(trains.height_m.begin(), trains.height_m.end()) - trains.height_m.begin());
    const double angle =
        std::atan2(trains.ky_cycles_per_m[highest], trains.kx_cycles_per_m[highest]) + 0.5 * kPi;
    kind = {"along crests", 900, {0.0, 0.0, 0.0}, 100.0, -0.3, 0.6, true, 0.0, 0.0, 300.0};
    Batch batch = batch_of(kind, plain, random);
    for (glm::vec3& d : batch.direction) {
        d = glm::vec3(std::cos(angle), std::sin(angle), -0.001);
        batch.far[static_cast<std::size_t>(&d - batch.direction.data())] = 300.0f;
    }
    return batch;
}

struct Count {
    int crossings = 0, grazes = 0;
    std::size_t evaluated = 0;
};

// Each ray against the march. A hit that isn't at the first crossing must be where the ray grazes the surface.
Count compare(const Kind& kind, const Batch& batch, const SphereTracing& tracing, const Plain& plain,
              SeenSpheres* seen = nullptr) {
    const float tolerance_m = 0.002f;
    std::vector<double> distance(batch.offset_m.size(), -1.0);
    const std::vector<float> tolerances(batch.offset_m.size(), tolerance_m);
    Count count;
    count.evaluated = tracing.trace(batch.rays(kind, tolerances), {distance.data()}, seen);
    for (std::size_t i = 0; i < distance.size(); ++i) {
        const glm::dvec3 p = kind.origin_m + glm::dvec3(batch.offset_m[i]), direction(batch.direction[i]);
        const double length = glm::length(direction), far_m = length * static_cast<double>(batch.far[i]);
        const glm::dvec3 d = direction / length;
        // Beyond the layer of heights no surface is crossed.
        const double layer_m = plain.highest_m + 0.01;
        double from_m = 0.0, to_m = far_m;
        if (std::abs(d.z) > 0.0) {
            const double one_m = (layer_m - p.z) / d.z, other_m = (-layer_m - p.z) / d.z;
            from_m = std::max(0.0, std::min(one_m, other_m));
            to_m = std::min(far_m, std::max(one_m, other_m));
        }
        const double crossing_m = plain.first_crossing_m(p, d, from_m, to_m), hit_m = length * distance[i];
        EXPECT_FALSE(std::isnan(hit_m)) << kind.name << " " << i;
        EXPECT_GE(hit_m, 0.0) << kind.name << " " << i;
        const double tolerance = static_cast<double>(tolerance_m);
        count.crossings += std::isfinite(crossing_m);
        if (crossing_m == hit_m) continue;  // both infinite
        // A crossing just before the ray's end may count as beyond it.
        if (std::isfinite(crossing_m) && crossing_m < far_m - tolerance) {
            EXPECT_LE(hit_m, crossing_m + tolerance) << kind.name << " " << i;
        }
        if (hit_m >= crossing_m - tolerance) continue;
        EXPECT_LE(std::abs(plain.over_m(p + hit_m * d)), 0.125 * tolerance + 1e-5) << kind.name << " " << i;
        ++count.grazes;
    }
    return count;
}

TEST(SphereTracing, FindsWhatAMarchFinds) {
    const Frame<float> frame = frame_of_trains(sea(40));
    for (const double cell_m : {0.0, kTracedCell_m}) {
        const SphereTracing tracing(frame, cell_m);
        const Plain plain(frame, cell_m);
        std::mt19937 random(7);
        int rays = 0, grazes = 0;
        for (const Kind& kind : kinds()) {
            const Count count = compare(kind, batch_of(kind, plain, random), tracing, plain);
            EXPECT_GT(count.crossings, 0) << kind.name;
            rays += kind.rays;
            grazes += count.grazes;
        }
        Kind along;
        const Batch crests = along_crests(frame, plain, random, along);
        const Count count = compare(along, crests, tracing, plain);
        EXPECT_GT(count.crossings, 0);
        grazes += count.grazes;
        EXPECT_LT(grazes, rays / 1000);  // else nothing is compared
    }
}

TEST(SphereTracing, AStepIsNeverLongerThanTheWayToTheSurface) {
    const Frame<float> frame = frame_of_trains(sea(40));
    const SphereTracing tracing(frame, 0.0);
    const Plain plain(frame, 0.0);
    std::mt19937 random(3);
    double nearest = kInfinity;
    for (const Kind& kind : kinds()) {
        if (kind.origin_m.z > 1e3) continue;
        const Batch batch = batch_of(kind, plain, random);
        for (std::size_t i = 0; i < 100; ++i) {
            const glm::dvec3 p = kind.origin_m + glm::dvec3(batch.offset_m[i]),
                             d = glm::normalize(glm::dvec3(batch.direction[i]));
            const double step_m = tracing.safe_step_m(p, d);
            EXPECT_GT(step_m, 0.0);
            const double way_m = plain.first_crossing_m(p, d, 0.0, std::min(step_m * 1.01 + 0.1, 200.0));
            EXPECT_LE(std::min(step_m, 200.0), way_m) << kind.name << " " << i;
            nearest = std::min(nearest, way_m / step_m);
        }
    }
    EXPECT_LT(nearest, 1.05);  // and not shorter than it must be
}

// The sea moves on, goes back and jumps; rays change places; another sea comes.
TEST(SphereTracing, WhatRaysHaveSeenBeforeHelpsAndMisleadsNone) {
    Frame<float> frame = frame_of_trains(sea(40));
    Scene other = sea(40);
    other.shot.seed = 2;
    Frame<float> another = frame_of_trains(other);
    std::mt19937 random(11);
    const Plain at_first(frame, 0.0);
    std::size_t with = 0, without = 0;
    int grazes = 0, traced = 0;
    for (Kind kind : kinds()) {
        kind.rays /= 12;
        Batch batch = batch_of(kind, at_first, random);
        SeenSpheres seen;
        for (const double frames : {0.0, 1.0, 2.0, 3.0, 2.5, 40.0, 41.0, -1e4}) {
            Frame<float>& now = frames == 41.0 ? another : frame;
            now.set(3.7 + frames / 24.0);
            if (frames == 2.5) std::swap(batch.offset_m.front(), batch.offset_m.back());
            const SphereTracing tracing(now);
            const Plain plain(now, 0.0);
            const Count count = compare(kind, batch, tracing, plain, &seen);
            grazes += count.grazes;
            traced += kind.rays;
            if (!(frames > 0.0 && frames < 3.5)) continue;
            with += count.evaluated;
            without += compare(kind, batch, tracing, plain).evaluated;
        }
    }
    EXPECT_LT(grazes, traced / 500);
    EXPECT_LT(static_cast<double>(with), 0.7 * static_cast<double>(without));
    std::printf("evaluations of a train: %zu, of rays that have seen the frame before %zu\n", without, with);
}

// 2e-4 m is a thousandth of the shortest wave where a slope is 0.2.
TEST(SphereTracing, IsTheSurfaceOfTheQueryAlsoFarAwayAndLate) {
    const glm::vec3 down(0.0f, 0.0f, -2.0f);
    const float tolerance_m = 1e-4f;
    for (const double time_s : {12.25, 1e7 + 1.0 / 24.0})
        for (const glm::dvec3 origin_m : {glm::dvec3(0.0), glm::dvec3(1e6 + 0.3, -1e6 + 0.07, 0.0)}) {
            const Frame<float> frame =
                frame_of<float>(sea(60), {filtered(products(Position), kTracedCell_m)}, time_s);
            const SphereTracing tracing(frame, kTracedCell_m);
            for (int i = 0; i < 100; ++i) {
                const glm::dvec3 from_m = origin_m + glm::dvec3(13.0 * i, -7.0 * i, 20.0);
                double distance = 0.0;
                tracing.trace(
                    {.count = 1, .origin_m = from_m, .direction = {&down}, .tolerance_m = {&tolerance_m}},
                    {&distance});
                const glm::vec2 rest_m(0.0f);
                glm::vec3 position_m;
                Results<float> results;
                results.set(Position, {&position_m});
                evaluate<float>(frame, 0, {.origin_m = {from_m.x, from_m.y}, .count = 1, .rest_m = {&rest_m}},
                                results);
                EXPECT_NEAR(20.0 - 2.0 * distance, static_cast<double>(position_m.z), 2e-4)
                    << time_s << " s, " << origin_m.x << " m";
            }
        }
}

TEST(SphereTracing, AFlatSea) {
    Scene scene = sea(10);
    scene.sea.wind_speed_mps = 0.0;
    const Frame<float> frame = frame_of_trains(scene);
    const SphereTracing tracing(frame);
    const std::vector<glm::vec3> direction{{3.0f, 0.0f, -4.0f}, {1.0f, 0.0f, 0.0f}, {0.0f, 0.0f, 1.0f}};
    std::vector<double> distance(3);
    tracing.trace({.count = 3, .origin_m = {0.0, 0.0, 8.0}, .direction = {direction.data()}},
                  {distance.data()});
    EXPECT_NEAR(distance[0], 2.0, 1e-6);
    EXPECT_EQ(distance[1], kInfinity);
    EXPECT_EQ(distance[2], kInfinity);
}

TEST(SphereTracing, NeverAnswersWhatIsNoNumber) {
    const Frame<float> frame = frame_of_trains(sea(20));
    const SphereTracing tracing(frame);
    const auto nan = std::numeric_limits<float>::quiet_NaN(),
               infinite = std::numeric_limits<float>::infinity();
    for (const float bad : {nan, infinite, -infinite, 0.0f, 3e38f, 1e-44f})
        for (int what = 0; what < 6; ++what) {
            glm::vec3 offset(0.0f), direction(0.0f, 0.6f, -0.8f);
            float near = 0.0f, far = 100.0f, tolerance_m = 1e-3f;
            if (what == 0) offset.x = bad;
            if (what == 1) offset.z = bad;
            if (what == 2) direction = {bad, bad, bad};
            if (what == 3) near = bad;
            if (what == 4) far = bad;
            if (what == 5) tolerance_m = bad;
            double distance = -1.0;
            tracing.trace({.count = 1,
                           .origin_m = {0.0, 0.0, 10.0},
                           .offset_m = {&offset},
                           .direction = {&direction},
                           .near = {&near},
                           .far = {&far},
                           .tolerance_m = {&tolerance_m}},
                          {&distance});
            EXPECT_GE(distance, 0.0) << what << " " << bad;
        }
}

TEST(SphereTracing, ARayOutOfStepsHasNotPassedTheSurface) {
    const Frame<float> frame = frame_of_trains(sea(40));
    const SphereTracing tracing(frame);
    const Plain plain(frame, 0.0);
    std::mt19937 random(5);
    const Kind& kind = kinds().front();
    const Batch batch = batch_of(kind, plain, random);
    const std::vector<float> tolerances(batch.offset_m.size(), 0.002f);
    TracedRays rays = batch.rays(kind, tolerances);
    std::vector<double> few(rays.count), many(rays.count);
    tracing.trace(rays, {many.data()});
    rays.most_steps = 3;
    tracing.trace(rays, {few.data()});
    int earlier = 0;
    for (std::size_t i = 0; i < rays.count; ++i) {
        EXPECT_LE(few[i], many[i]);
        earlier += few[i] < many[i];
    }
    EXPECT_GT(earlier, 0);
}

TEST(SphereTracing, ARayDoesNotDependOnOthersNorOnInstructions) {
    const Frame<float> frame = frame_of_trains(sea(40));
    const SphereTracing tracing(frame);
    const Plain plain(frame, 0.0);
    std::mt19937 random(5);
    const Kind& kind = kinds().front();
    const Batch batch = batch_of(kind, plain, random);
    const std::vector<float> tolerances(batch.offset_m.size(), 0.002f);
    const TracedRays rays = batch.rays(kind, tolerances);
    std::vector<double> together(rays.count), alone(rays.count);
    tracing.trace(rays, {together.data()});
    for (std::size_t i = 0; i < rays.count; ++i) {
        TracedRays one = rays;
        one.count = 1;
        one.offset_m.data += i;
        one.direction.data += i;
        one.far.data += i;
        tracing.trace(one, {&alone[i]});
    }
    EXPECT_EQ(together, alone);
    int sets = 0;
    for (int64_t left = hwy::SupportedTargets(); left != 0; left &= left - 1, ++sets) {
        hwy::SetSupportedTargetsForTest(left & -left);
        tracing.trace(rays, {alone.data()});
        int others = 0;
        for (std::size_t i = 0; i < rays.count; ++i)
            others +=
                !(std::abs(together[i] - alone[i]) * static_cast<double>(glm::length(batch.direction[i])) <=
                  0.004);
        EXPECT_LE(others, 2) << hwy::TargetName(left & -left);  // one that grazes may go either way
    }
    hwy::SetSupportedTargetsForTest(0);
    EXPECT_GT(sets, 1);
}

TEST(SphereTracing, RefusesWhatIsNoHeightField) {
    Scene choppy = sea(20);
    choppy.waves.choppiness = 0.5;
    EXPECT_THROW(SphereTracing(frame_of_trains(choppy)), std::invalid_argument);
    Scene both = sea(20);
    both.waves.longest_m.reset();
    both.waves.shortest_m = 5.0;
    both.waves.cascades = {{.size_m = 60.0, .resolution = 128}};
    EXPECT_THROW(SphereTracing(frame_of_trains(both)), std::invalid_argument);
    const Frame<float> frame = frame_of_trains(sea(20));
    EXPECT_THROW(SphereTracing(frame, -1.0), std::invalid_argument);
    EXPECT_THROW(SphereTracing(frame, std::nan("")), std::invalid_argument);
    EXPECT_THROW(SphereTracing(Frame<float>(std::make_shared<const Sea<float>>(
                     make_plan(sea(20), {unfiltered(products(Position))})))),
                 std::invalid_argument);
}

}  // namespace
}  // namespace pelagic
