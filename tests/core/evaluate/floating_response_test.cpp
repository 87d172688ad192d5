// What floats by its mass: against the surface for what is small, and, for a barge, against its equations of motion, integrated in time
// with the pressure summed over its hull.
#include "core/evaluate/floating_response.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <glm/geometric.hpp>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "core/evaluate/object_place.h"
#include "core/scene/text.h"
#include "tests/core/waves/samples.h"
#include "tests/core/waves/worst.h"

namespace pelagic {
namespace {

using namespace test;

// Closed, from z = −below to above, its section at z = −below narrowed to `keel` of the beam.
std::shared_ptr<const ObjectMesh> prism(double length, double beam, double below, double above,
                                        double keel = 1.0, bool is_inside_out = false) {
    ObjectMeshData mesh;
    for (const double z : {-below, above})
        for (const double y : {-0.5, 0.5})
            for (const double x : {-0.5, 0.5}) {
                const double narrow = z < 0.0 ? keel : 1.0;
                mesh.points_m.emplace_back(x * length, y * beam * narrow, z);
            }
    const std::array<std::array<std::uint32_t, 4>, 6> faces{
        {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
    for (std::array<std::uint32_t, 4> f : faces) {
        if (is_inside_out) std::reverse(f.begin(), f.end());
        for (const std::uint32_t corner : {f[0], f[1], f[2], f[0], f[2], f[3]})
            mesh.triangles.push_back(corner);
    }
    mesh.normals.assign(mesh.triangles.size(), {0.0f, 0.0f, 1.0f});
    mesh.material.assign(mesh.triangles.size() / 3, 0);
    mesh.materials = {{.name = "steel"}};
    return std::make_shared<const ObjectMesh>(std::move(mesh));
}

SceneObject body(std::shared_ptr<const ObjectMesh> mesh) {
    SceneObject object;
    object.file = "barge.obj";
    object.mesh = std::move(mesh);
    object.floats = true;
    object.buoyancy = Buoyancy::Response;
    return object;
}

TEST(FloatingBox, IsTheWaterplaneAndWhatABodyDisplaces) {
    SceneObject object = body(prism(20.0, 6.0, 2.0, 3.0));
    object.heading_deg = 37.0;
    FloatingBox box = floating_box(object);
    EXPECT_NEAR(box.length_m, 20.0, 1e-5);
    EXPECT_NEAR(box.beam_m, 6.0, 1e-5);
    EXPECT_NEAR(box.draught_m, 2.0, 1e-5);
    // Lower in the water, and twice as large.
    object.up_m = -1.0;
    object.scale = 2.0;
    EXPECT_NEAR(floating_box(object).draught_m, 5.0, 1e-5);
    EXPECT_NEAR(floating_box(object).length_m, 40.0, 1e-5);
    // A wedge displaces half of its box; its deck at the water is left open by the cut.
    box = floating_box(body(prism(20.0, 6.0, 2.0, 1e-6, 0.0)));
    EXPECT_NEAR(box.draught_m, 1.0, 1e-4);
    EXPECT_NEAR(box.length_m * box.beam_m, 120.0, 1e-3);
    // What has no volume, or a negative one, is as large as its box.
    EXPECT_NEAR(floating_box(body(prism(20.0, 6.0, 2.0, 3.0, 1.0, true))).draught_m, 2.0, 1e-5);
    // Over the water, and under it.
    for (const double up_m : {2.5, -3.5, -30.0}) {
        object = body(prism(20.0, 6.0, 2.0, 3.0));
        object.up_m = up_m;
        EXPECT_EQ(floating_box(object).draught_m, 0.0) << up_m;
        EXPECT_FALSE(answers_by_mass(object));
    }
}

Scene sea(std::function<void(Scene&)> edit = {}) {
    Scene scene = first_order();
    scene.sea.wind_speed_mps = 0.0;
    scene.sea.swell = {{.height_m = 1.5, .period_s = 5.0, .direction_deg = 20.0}};
    scene.waves.choppiness = 0.0;
    scene.waves.cascades = {{120.0, 128}, {41.0, 64}};
    scene.quality.level = QualityLevel::Reference;
    if (edit) edit(scene);
    return scene;
}

// In the limit of no size it lies on the surface, wherever that comes from.
TEST(FloatingResponse, OfSomethingSmallIsTheSurface) {
    const std::vector<std::function<void(Scene&)>> edits{
        [](Scene&) {}, [](Scene& s) { s.waves.tiling = Tiling::Periodic; },
        [](Scene& s) { s.shot.loop_s = 7.0; },
        [](Scene& s) {
            s.waves.cascades.clear();
            s.waves.model = WaveModel::Trochoid;
            s.waves.trains = 50;
            s.waves.shortest_m = 6.0;
        },
        [](Scene& s) {
            s.waves.masks = {
                {.east_m = 10.0, .length_m = 60.0, .width_m = 80.0, .edge_m = 40.0, .waves = 0.3}};
        }};
    constexpr double kSide_m = 1e-3, kStep_m = 0.01;
    const FloatingModel raft =
        floating_model({.length_m = kSide_m, .beam_m = kSide_m, .draught_m = 1e-5, .middle_m = {}});
    for (std::size_t e = 0; e < edits.size(); ++e) {
        const Scene scene = sea(edits[e]);
        const auto frame = frame_of<double>(scene, {unfiltered(products(Position))}, 3.7);
        double worst_m = 0.0, worst = 0.0, square_m2 = 0.0, square = 0.0;
        for (const glm::dvec2 place : random_points<double>(500.0, 200)) {
            const glm::dvec2 ahead(0.6, 0.8), port(-0.8, 0.6);
            const auto height = [&](glm::dvec2 at) {
                return sample(frame, 0, std::vector<glm::dvec2>{at}).vectors(Position)[0].z;
            };
            const auto slope = [&](glm::dvec2 along) {
                return (height(place + kStep_m * along) - height(place - kStep_m * along)) / (2.0 * kStep_m);
            };
            const FloatingMotion motion = floating_motion(
                frame, raft,
                {.middle_m = place, .ahead = ahead, .velocity_mps = {}, .cell_m = 0.0, .late_s = 0.0});
            const double there_m = height(place);
            worst_m = worse(worst_m, std::abs(motion.heave_m - there_m));
            square_m2 += there_m * there_m / 200.0;
            if (!scene.waves.masks.empty()) continue;  // it leans as the waves do, not as their mask
            const glm::dvec2 slopes(slope(ahead), slope(port));
            // Where tiles blend, their weights have slopes, 2 kBlendSlopes Var η/L² in all: a tenth of such waves' squares.
            worst += glm::dot(motion.slope - slopes, motion.slope - slopes);
            square += glm::dot(slopes, slopes);
        }
        EXPECT_GT(square_m2, 1e-3) << e;
        EXPECT_LT(worst_m, 0.01 * std::sqrt(square_m2)) << e;
        EXPECT_LE(worst, (e == 0 || e == 2 ? 0.11 : 1e-3) * square) << e;
    }
}

PlacedObject placed(const Frame<double>& frame, Scene& scene, const SceneObject& object, double at = 1.0) {
    scene.objects = {object};
    return place_object(frame, scene, scene.objects[0], {.query = 0, .frame = at});
}

// However it was drawn: turned in its mesh it moves as turned in the sea.
TEST(FloatingResponse, OfABodyIsThatOfItTurnedInItsMesh) {
    Scene scene = sea([](Scene& s) { s.sea.wind_speed_mps = 9.0; });
    const auto frame = frame_of<double>(scene, {unfiltered(products(Position))}, 2.0);
    const SceneObject along = body(prism(26.0, 7.5, 3.0, 2.0));
    for (const double turn : {kPi / 2.0, 0.6}) {
        ObjectMeshData data = along.mesh->data();
        for (glm::vec3& p : data.points_m)
            p = glm::vec3(std::cos(turn) * p.x - std::sin(turn) * p.y,
                          std::sin(turn) * p.x + std::cos(turn) * p.y, p.z);
        SceneObject turned = body(std::make_shared<const ObjectMesh>(std::move(data)));
        turned.heading_deg = -turn * 180.0 / kPi;
        for (const glm::dvec2 place : random_points<double>(200.0, 5)) {
            SceneObject first = along;
            first.east_m = turned.east_m = place.x;
            first.north_m = turned.north_m = place.y;
            const PlacedObject a = placed(frame, scene, first), b = placed(frame, scene, turned);
            EXPECT_NEAR(a.pose.place_m.z, b.pose.place_m.z, 1e-3);
            EXPECT_NEAR(glm::length(a.pose.turn[2] - b.pose.turn[2]), 0.0, 1e-3);
            EXPECT_GT(glm::length(glm::dvec2(a.pose.turn[2])), 1e-4);
        }
    }
}

// A spar and a pole stand, as their ballast has it, and lean no more than a few times as much as the waves.
TEST(FloatingResponse, OfWhatIsDeepStands) {
    Scene scene = sea([](Scene& s) { s.sea.wind_speed_mps = 10.0; });
    const auto frame = frame_of<double>(scene, {unfiltered(products(Position))}, 2.0);
    for (const glm::dvec2 of : {glm::dvec2(1.0, 10.0), glm::dvec2(0.3, 1.0), glm::dvec2(2.0, 3.0)}) {
        SceneObject spar = body(prism(of.x, of.x, of.y, 1.0));
        double mine = 0.0, plane = 0.0;
        for (const glm::dvec2 place : random_points<double>(400.0, 60)) {
            spar.east_m = place.x, spar.north_m = place.y;
            spar.buoyancy = Buoyancy::Response;
            const glm::dvec2 lean(placed(frame, scene, spar).pose.turn[2]);
            spar.buoyancy = Buoyancy::Plane;
            const glm::dvec2 slope(placed(frame, scene, spar).pose.turn[2]);
            mine += glm::dot(lean, lean);
            plane += glm::dot(slope, slope);
        }
        std::printf("spar %g x %g m: leans %.2f as much as the water\n", of.x, of.y, std::sqrt(mine / plane));
        EXPECT_LT(std::sqrt(mine / plane), 2.0) << of.x << ' ' << of.y;
    }
}

// A path's speed counts, without a jump where it bends; and waves shorter than its footprint don't.
TEST(FloatingResponse, GoesByItsWayAndItsFootprint) {
    Scene scene = sea([](Scene& s) { s.sea.wind_speed_mps = 9.0; });
    scene.shot.last_frame = 241;
    auto frame = frame_of<double>(scene, {unfiltered(products(Position))});
    SceneObject ship = body(prism(20.0, 6.0, 2.0, 3.0));
    ship.path = "1 0 0, 121 25 0, 241 25 40";
    ship.interpolation = CameraInterpolation::Linear;
    const FloatingModel model = floating_model(floating_box(ship), ship.roll_damping);
    FloatingCourse course{.middle_m = {12.5, 0.0},
                          .ahead = {1.0, 0.0},
                          .velocity_mps = {5.0, 0.0},
                          .cell_m = floating_cell_m(ship),
                          .late_s = 0.0};
    frame.set(scene.shot.time_s(61.0));
    const double by_way = floating_motion(frame, model, course).heave_m;
    EXPECT_NEAR(placed(frame, scene, ship, 61.0).pose.place_m.z, by_way, 1e-6);
    course.velocity_mps = {};
    EXPECT_GT(std::abs(floating_motion(frame, model, course).heave_m - by_way), 1e-3);
    // Later is what a later frame is.
    course.late_s = 0.25;
    const double late_m = floating_motion(frame, model, course).heave_m;
    course.late_s = 0.0;
    frame.set(scene.shot.time_s(61.0) + 0.25);
    EXPECT_NEAR(floating_motion(frame, model, course).heave_m, late_m, 1e-9);
    course.cell_m = 1e4;
    EXPECT_EQ(floating_motion(frame, model, course).heave_m, 0.0);
    double before_m = 0.0, most_m = 0.0;
    for (double at = 115.0; at < 127.0; at += 0.05) {
        frame.set(scene.shot.time_s(at));
        // Its course turns at once there; its height must not.
        const double height_m = placed(frame, scene, ship, at).pose.place_m.z;
        if (at > 115.0 && (at < 120.9 || at > 121.1))
            most_m = std::max(most_m, std::abs(height_m - before_m));
        before_m = height_m;
    }
    EXPECT_LT(most_m, 0.01);
}

// A long wave lifts and leans a barge as it is itself.
TEST(FloatingResponse, FollowsLongWaves) {
    Scene scene = sea([](Scene& s) {
        s.sea.wind_speed_mps = 0.0;
        s.sea.swell = {{.height_m = 2.0, .period_s = 16.0, .direction_deg = 30.0}};
        s.waves.cascades = {{3200.0, 64}};
        s.waves.tiling = Tiling::Periodic;
    });
    scene.objects = {body(prism(20.0, 6.0, 2.0, 3.0))};
    SceneObject& object = scene.objects[0];
    object.heading_deg = 70.0;
    std::vector<Query> queries{unfiltered(products(Position))};
    const auto frame = frame_of<double>(scene, queries, 5.0);
    double worst_m = 0.0, most_m = 0.0, worst = 0.0, most = 0.0;
    for (const glm::dvec2 place : random_points<double>(1500.0, 40)) {
        object.east_m = place.x, object.north_m = place.y;
        object.buoyancy = Buoyancy::Response;
        const PlacedObject mine = place_object(frame, scene, object, {.query = 0, .frame = 1.0});
        object.buoyancy = Buoyancy::Plane;
        const PlacedObject plane = place_object(frame, scene, object, {.query = 0, .frame = 1.0});
        worst_m = worse(worst_m, std::abs(mine.pose.place_m.z - plane.pose.place_m.z));
        most_m = std::max(most_m, std::abs(plane.pose.place_m.z));
        worst = worse(worst, glm::length(mine.pose.turn[2] - plane.pose.turn[2]));
        most = std::max(most, glm::length(glm::dvec2(plane.pose.turn[2])));
    }
    // Its heave, of four seconds, is 7 % higher in waves of sixteen, and late by 0.1 rad; its roll, of eight, is a third more.
    EXPECT_LT(worst_m, 0.15 * most_m);
    EXPECT_LT(worst, 0.5 * most);
    EXPECT_GT(most, 0.005);
}

using Complex = std::complex<double>;

// The pull of a wave on a box over ρ g L B, per metre of amplitude: the pressure summed over panels.
std::array<Complex, 3> pull_of(const FloatingModel& model, glm::dvec2 k, double depth_m) {
    const FloatingBox& box = model.box;
    const double length = glm::length(k);
    const auto pressure = [&](glm::dvec3 at) {
        const double deep = std::isinf(depth_m)
                                ? std::exp(length * at.z)
                                : std::cosh(length * (at.z + depth_m)) / std::cosh(length * depth_m);
        return std::polar(deep, k.x * at.x + k.y * at.y);
    };
    std::array<Complex, 3> pull{};
    constexpr int kPanels = 60;
    // A side from `corner` along two edges, which presses along `in`.
    const auto side = [&](glm::dvec3 corner, glm::dvec3 u, glm::dvec3 v, glm::dvec3 in) {
        const double area = glm::length(u) * glm::length(v) / (kPanels * kPanels * box.length_m * box.beam_m);
        for (int i = 0; i < kPanels; ++i)
            for (int j = 0; j < kPanels; ++j) {
                const glm::dvec3 at = corner + (i + 0.5) / kPanels * u + (j + 0.5) / kPanels * v;
                const Complex p = area * pressure(at);
                const glm::dvec3 arm = at - glm::dvec3(0.0, 0.0, model.gravity_m);
                pull[0] += p * in.z;
                pull[1] -= p * (arm.z * in.x - arm.x * in.z);  // the bow up
                pull[2] += p * (arm.y * in.z - arm.z * in.y);  // port up
            }
    };
    const glm::dvec3 x(box.length_m, 0, 0), y(0, box.beam_m, 0), z(0, 0, box.draught_m);
    const glm::dvec3 low = -0.5 * x - 0.5 * y - z;
    side(low, x, y, {0, 0, 1});
    side(low, x, z, {0, 1, 0});
    side(low + y, x, z, {0, -1, 0});
    side(low, y, z, {1, 0, 0});
    side(low + x, y, z, {-1, 0, 0});
    return pull;
}

// In three seas, and on a way: head seas, a beam sea in 14 m of water, and a following swell with wind waves.
TEST(FloatingResponse, OfABargeIsThatOfItsEquationsInTime) {
    struct Case {
        double wind_mps, depth_m, heading_deg, speed_mps;
        std::vector<Swell> swell;
    };
    const std::vector<Case> cases{{11.0, std::numeric_limits<double>::infinity(), 180.0, 4.0, {}},
                                  {9.0, 14.0, 90.0, 0.0, {}},
                                  {6.0,
                                   std::numeric_limits<double>::infinity(),
                                   20.0,
                                   6.0,
                                   {{.height_m = 2.0, .period_s = 11.0, .direction_deg = 40.0}}}};
    const FloatingModel model =
        floating_model({.length_m = 36.0, .beam_m = 11.0, .draught_m = 2.4, .middle_m = {}});
    double worst = 0.0;
    for (std::size_t c = 0; c < cases.size(); ++c) {
        const Case& of = cases[c];
        const Scene scene = sea([&](Scene& s) {
            s.sea.wind_speed_mps = of.wind_mps;
            s.sea.wind_direction_deg = 0.0;
            s.sea.depth_m = of.depth_m;
            s.sea.swell = of.swell;
            s.waves.cascades.clear();
            s.waves.model = WaveModel::Trochoid;
            s.waves.trains = 40;
            s.waves.shortest_m = 12.0;
        });
        auto frame = frame_of<double>(scene, {unfiltered(products(Position))});
        const Trains<double>& trains = frame.sea().trains();
        const double turn = of.heading_deg * kPi / 180.0;
        const glm::dvec2 ahead(std::cos(turn), std::sin(turn)), velocity = of.speed_mps * ahead;

        std::vector<std::array<Complex, 3>> pulls;
        for (std::size_t i = 0; i < trains.count(); ++i) {
            const glm::dvec2 k = kTwoPi * glm::dvec2(trains.kx_cycles_per_m[i], trains.ky_cycles_per_m[i]);
            pulls.push_back(pull_of(model, {glm::dot(k, ahead), k.y * ahead.x - k.x * ahead.y}, of.depth_m));
        }
        const auto pull_at = [&](double t) {
            std::array<double, 3> sum{};
            const glm::dvec2 place = t * velocity;
            for (std::size_t i = 0; i < trains.count(); ++i) {
                const Complex wave = std::polar(
                    kGravity * trains.height_m[i],
                    kTwoPi * (trains.kx_cycles_per_m[i] * place.x + trains.ky_cycles_per_m[i] * place.y -
                              trains.start_cycles[i] - trains.cycles_per_s[i] * t));
                for (std::size_t m = 0; m < 3; ++m) sum[m] += (wave * pulls[i][m]).real();
            }
            return sum;
        };
        const std::array<Oscillator, 3> motions{model.heave, model.trim, model.heel};
        // From rest, by Runge and Kutta's rule of the fourth order, until the start is forgotten.
        constexpr double kStep_s = 0.05, kStart_s = -250.0, kEnd_s = 150.0;
        std::array<double, 3> at{}, rate{}, error{}, square{};
        int compared = 0;
        for (int n = 0; n < std::lround((kEnd_s - kStart_s) / kStep_s); ++n) {
            const double t = kStart_s + n * kStep_s;
            if (t >= 0.0 && n % 50 == 0) {
                frame.set(t);
                const FloatingMotion motion = floating_motion(frame, model,
                                                              {.middle_m = t * velocity,
                                                               .ahead = ahead,
                                                               .velocity_mps = velocity,
                                                               .cell_m = 0.0,
                                                               .late_s = 0.0});
                const std::array<double, 3> mine{motion.heave_m, motion.slope.x, motion.slope.y};
                for (std::size_t m = 0; m < 3; ++m) {
                    error[m] += (mine[m] - at[m]) * (mine[m] - at[m]);
                    square[m] += at[m] * at[m];
                }
                ++compared;
            }
            const auto here = pull_at(t), middle = pull_at(t + 0.5 * kStep_s), next = pull_at(t + kStep_s);
            for (std::size_t m = 0; m < 3; ++m) {
                const Oscillator& of_m = motions[m];
                const auto bend = [&](double x, double v, double pull) {
                    return (pull - of_m.damping * v - of_m.stiffness * x) / of_m.mass;
                };
                const double x = at[m], v = rate[m], h = kStep_s;
                const double a1 = bend(x, v, here[m]);
                const double v2 = v + 0.5 * h * a1, a2 = bend(x + 0.5 * h * v, v2, middle[m]);
                const double v3 = v + 0.5 * h * a2, a3 = bend(x + 0.5 * h * v2, v3, middle[m]);
                const double v4 = v + h * a3, a4 = bend(x + h * v3, v4, next[m]);
                at[m] += h / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4);
                rate[m] += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
            }
        }
        ASSERT_GT(compared, 50);
        for (std::size_t m = 0; m < 3; ++m) {
            const double off = std::sqrt(error[m] / square[m]);
            std::printf("sea %zu, motion %zu: rms %.4f, differs by %.5f of it\n", c, m,
                        std::sqrt(square[m] / compared), off);
            EXPECT_GT(square[m], 0.0);
            EXPECT_LT(off, 0.003) << c << ' ' << m;
            worst = worse(worst, off);
        }
    }
    RecordProperty("rms_off", number_text(worst));
}

// However small, large, flat, deep or strange: finite. What it leans is limited where it is placed.
TEST(FloatingResponse, StaysFiniteForAnyBody) {
    const Scene scene = sea([](Scene& s) { s.sea.depth_m = 3.0; });
    const auto frame = frame_of<float>(scene, {unfiltered(products(Position))}, 1.0);
    for (const double length : {1e-3, 1.0, 50.0, 400.0})
        for (const double beam : {1e-3, 2.0, 300.0})
            for (const double draught : {1e-6, 0.5, 3.0, 100.0})
                for (const double speed : {0.0, 30.0, 1e5}) {
                    const FloatingMotion motion = floating_motion(
                        frame,
                        floating_model(
                            {.length_m = length, .beam_m = beam, .draught_m = draught, .middle_m = {}}),
                        {.middle_m = {1e9, -3e5},
                         .ahead = {1.0, 0.0},
                         .velocity_mps = {speed, 0.0},
                         .cell_m = 0.0,
                         .late_s = 0.01});
                    ASSERT_LT(std::abs(motion.heave_m), 20.0) << length << ' ' << beam << ' ' << draught;
                    ASSERT_TRUE(std::isfinite(motion.slope.x) && std::isfinite(motion.slope.y))
                        << length << ' ' << beam << ' ' << draught;
                }
}

}  // namespace
}  // namespace pelagic
