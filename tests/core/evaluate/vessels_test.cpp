// The waves of vessels (waves.vessels) against Kelvin's far field, an integral over their directions, and against themselves:
// velocities, slopes and J are those of the positions, a frame alone is that frame of a run, hard paths stay finite.
#include "core/plan/vessels.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <initializer_list>
#include <limits>
#include <random>
#include <tuple>

#include "core/effects/sea_at_time.h"
#include "core/evaluate/bounds.h"
#include "core/scene/limits.h"
#include "core/scene/text.h"
#include "core/waves/folding.h"
#include "tests/core/waves/samples.h"
#include "tests/core/waves/worst.h"

namespace pelagic {
namespace {

using namespace test;

// On still water, at 24 frames a second.
Scene still_water(Vessel vessel) {
    Scene scene;
    scene.sea.wind_speed_mps = 0.0;
    scene.waves.cascades = {{64.0, 16}};
    scene.waves.vessels = {std::move(vessel)};
    return scene;
}
// Straight along +x, at the world's middle at frame 1.
Vessel straight(double speed_mps, double length_m = 25.0) {
    Vessel vessel{.path = "1 0 0, 2401 " + std::to_string(100.0 * speed_mps) + " 0"};
    vessel.beam_m *= length_m / vessel.length_m;
    vessel.draught_m *= length_m / vessel.length_m;
    vessel.length_m = length_m;
    return vessel;
}

// Wigley's hull, spread across, in one direction of waves [m³].
double hull(const Vessel& vessel, double kx, double ky) {
    const auto parabola = [](double u) {
        return std::abs(u) < 1e-2 ? 1.0 - u * u / 10.0 : 3.0 * (std::sin(u) - u * std::cos(u)) / (u * u * u);
    };
    double below = 0.0;
    constexpr int kSteps = 200;
    for (int i = 0; i < kSteps; ++i) {
        const double z = (i + 0.5) / kSteps;
        below +=
            vessel.draught_m / kSteps * (1.0 - z * z) * std::exp(-std::hypot(kx, ky) * vessel.draught_m * z);
    }
    return 2.0 / 3.0 * vessel.length_m * vessel.beam_m * below * parabola(0.5 * vessel.length_m * kx) *
           parabola(0.5 * vessel.beam_m * ky);
}

// Kelvin's far field with its quadrature: the poles of Ŝ (k·U)²/((k·U)² − gk), at k = g/(U cos θ)².
class FarField {
  public:
    FarField(const Vessel& vessel, double speed_mps, double shortest_m) {
        constexpr int kSteps = 8000;
        const double k0 = kGravity / (speed_mps * speed_mps),
                     last = std::acos(std::sqrt(k0 * shortest_m / kTwoPi));
        for (int i = 0; i < kSteps; ++i) {
            const double angle = last * (2.0 * (i + 0.5) / kSteps - 1.0),
                         k = k0 / std::pow(std::cos(angle), 2);
            kx_.push_back(k * std::cos(angle));
            ky_.push_back(k * std::sin(angle));
            weight_.push_back(2.0 * last / kSteps / kPi * k * k * hull(vessel, kx_.back(), ky_.back()));
        }
    }
    // Its imaginary part is the height, its size the envelope.
    std::complex<double> at(double x, double y) const {
        std::complex<double> sum;
        for (std::size_t i = 0; i < kx_.size(); ++i) sum += std::polar(weight_[i], kx_[i] * x + ky_[i] * y);
        return sum;
    }

    // Of the height.
    glm::dvec2 slope(double x, double y) const {
        glm::dvec2 sum(0.0);
        for (std::size_t i = 0; i < kx_.size(); ++i)
            sum += weight_[i] * std::cos(kx_[i] * x + ky_[i] * y) * glm::dvec2(kx_[i], ky_[i]);
        return sum;
    }

  private:
    std::vector<double> kx_, ky_, weight_;
};

double wavelength(double speed_mps) {
    return kTwoPi * speed_mps * speed_mps / kGravity;
}

// Where waves are loudest at this distance behind [degrees], by the means over half a wave to either side of f²(x, y).
template <class Square>
double loudest_angle(double distance_m, double wave_m, double from_deg, double to_deg, Square square) {
    constexpr int kAngles = 60, kAlong = 48;
    double best = -1.0, at = 0.0, before = 0.0, after = 0.0, last = 0.0;
    bool is_next = false;
    const double step = (to_deg - from_deg) / kAngles;
    for (int a = 0; a <= kAngles; ++a) {
        const double angle = (from_deg + a * step) * kPi / 180.0;
        double sum = 0.0;
        for (int i = 0; i < kAlong; ++i) {
            const double r = distance_m + wave_m * ((i + 0.5) / kAlong - 0.5);
            sum += square(-r * std::cos(angle), r * std::sin(angle));
        }
        if (is_next) after = sum;
        is_next = false;
        if (sum > best) {
            best = sum;
            before = last;
            at = from_deg + a * step;
            is_next = true;
        }
        last = sum;
    }
    return at + 0.5 * step * (before - after) / (before - 2.0 * best + after);  // of a parabola
}

TEST(Vessels, MakeKelvinsWaves) {
    const double speed_mps = 5.0, wave_m = wavelength(speed_mps);
    const Vessel vessel = straight(speed_mps);
    const auto frame = frame_of<double>(still_water(vessel), {unfiltered(products(Position))}, 0.0);
    const VesselPlan& plan = *frame.sea().plan().cascades.back().vessel;
    const FarField far(vessel, speed_mps, plan.size_m / plan.radius);
    for (const double waves : {5.0, 10.0, 20.0}) {
        std::vector<glm::dvec2> rest;
        for (int i = -60; i <= 60; ++i)
            rest.push_back(waves * wave_m * glm::dvec2(-std::cos(0.007 * i), std::sin(0.007 * i)));
        const auto values = sample(frame, 0, rest).vectors(Position);
        double error = 0.0, all = 0.0;
        for (std::size_t i = 0; i < rest.size(); ++i) {
            const double said = far.at(rest[i].x, rest[i].y).imag();
            error += std::pow(values[i].z - said, 2);
            all += said * said;
        }
        EXPECT_LT(std::sqrt(error / all), 0.008) << waves;
        RecordProperty("error_at_" + std::to_string(static_cast<int>(waves)),
                       number_text(std::sqrt(error / all)));
    }
    for (const double waves : {10.0, 20.0, 28.0}) {  // 32 waves behind the tile ends
        const double said = loudest_angle(waves * wave_m, wave_m, 15.0, 21.0, [&](double x, double y) {
            return std::pow(far.at(x, y).imag(), 2);
        });
        std::vector<glm::dvec2> rest;
        loudest_angle(waves * wave_m, wave_m, 15.0, 21.0,
                      [&](double x, double y) { return rest.emplace_back(x, y), 0.0; });
        const auto values = sample(frame, 0, rest).vectors(Position);
        std::size_t next = 0;
        const double found = loudest_angle(waves * wave_m, wave_m, 15.0, 21.0,
                                           [&](double, double) { return std::pow(values[next++].z, 2); });
        EXPECT_NEAR(found, said, 0.3) << waves;
        RecordProperty("off_deg_at_" + std::to_string(static_cast<int>(waves)),
                       number_text(std::abs(found - said)));
    }
}

// Along the path behind: from one fall through 0 to another.
TEST(Vessels, DragWavesOfTheirOwnSpeed) {
    double worst = 0.0;
    for (const double speed_mps : {3.5, 6.0}) {
        const double wave_m = wavelength(speed_mps);
        const auto frame =
            frame_of<float>(still_water(straight(speed_mps)), {unfiltered(products(Position))}, 7.3);
        constexpr int kPoints = 4000;
        std::vector<glm::vec2> rest;
        for (int i = 0; i < kPoints; ++i)
            rest.emplace_back(7.3 * speed_mps - wave_m * (6.0 + 14.0 * i / kPoints), 0.0);
        const auto values = sample(frame, 0, rest).vectors(Position);
        std::vector<double> falls;
        for (std::size_t i = 1; i < values.size(); ++i)
            if (values[i - 1].z > 0.0f && values[i].z <= 0.0f) falls.push_back(values[i].x);
        ASSERT_GT(falls.size(), 10u);
        const double found = (falls.front() - falls.back()) / static_cast<double>(falls.size() - 1);
        EXPECT_NEAR(found / wave_m, 1.0, 0.01) << speed_mps;
        worst = worse(worst, std::abs(found / wave_m - 1.0));
    }
    RecordProperty("length_off", number_text(worst));
}

// Fast ones leave a narrow wake (Darmon, Benzaquen & Raphaël 2014), the integral's.
TEST(Vessels, LeaveANarrowWakeWhenFast) {
    constexpr double kLengths = 32.0, kWave = 16.0, kLength_m = 6.0;
    double before = 19.47, worst = 0.0;
    std::vector<double> by_froude;
    for (const double froude : {0.8, 1.2, 1.7, 2.2}) {
        const double speed_mps = froude * std::sqrt(kGravity * kLength_m), about = 13.0 / froude;
        const Vessel vessel = straight(speed_mps, kLength_m);
        const auto frame = frame_of<float>(still_water(vessel), {unfiltered(products(Position))}, 0.0);
        const VesselPlan& plan = *frame.sea().plan().cascades.back().vessel;
        const FarField far(vessel, speed_mps, plan.size_m / plan.radius);
        const auto angle = [&](const auto& square) {
            return loudest_angle(kLengths * kLength_m, kWave * kLength_m, 0.4 * about, 1.6 * about, square);
        };
        std::vector<glm::vec2> rest;
        angle([&](double x, double y) { return rest.emplace_back(x, y), 0.0; });
        const auto values = sample(frame, 0, rest).vectors(Position);
        std::size_t next = 0;
        const double found = angle([&](double, double) { return std::pow(values[next++].z, 2); });
        const double said = angle([&](double x, double y) { return std::pow(far.at(x, y).imag(), 2); });
        EXPECT_NEAR(found / said, 1.0, 0.03) << froude;
        EXPECT_LT(found, 0.9 * before);
        before = found;
        worst = worse(worst, std::abs(found / said - 1.0));
        by_froude.push_back(found * froude);
    }
    RecordProperty("integral_off", number_text(worst));
    // Of an angle that is in proportion to 1/Fr, from 0.8 on and from 1.2.
    for (const std::size_t first : {0u, 1u}) {
        const auto [least, most] = std::minmax_element(by_froude.begin() + first, by_froude.end());
        RecordProperty(first ? "froude_off_from_1.2" : "froude_off_from_0.8",
                       number_text((*most - *least) / (*most + *least)));
    }
}

// A small hull that is fast makes waves that are short against its tile, a large one next to none.
TEST(Vessels, HaveAsManyModesAsTheirSlopesNeed) {
    for (const auto& [speed_mps, length_m, fewest, most] :
         {std::tuple{5.0, 25.0, 160, 224}, std::tuple{3.0, 25.0, 128, 160}, std::tuple{8.0, 6.0, 256, 256}}) {
        const Vessel vessel = straight(speed_mps, length_m);
        const VesselPlan plan = plan_vessels(still_water(vessel)).front();
        EXPECT_GE(plan.radius, fewest) << speed_mps;
        EXPECT_LE(plan.radius, most) << speed_mps;
        const FarField whole(vessel, speed_mps, plan.size_m / VesselPlan::kRadius),
            shown(vessel, speed_mps, plan.size_m / plan.radius);
        double lost = 0.0, all = 0.0;
        for (double y = -0.3; y < 0.3; y += 0.003) {
            const double x_m = -0.4 * plan.size_m, y_m = y * plan.size_m;
            const glm::dvec2 slope = whole.slope(x_m, y_m), missing = slope - shown.slope(x_m, y_m);
            lost += glm::dot(missing, missing);
            all += glm::dot(slope, slope);
        }
        EXPECT_LE(lost / all, 1.5e-3) << speed_mps;  // of one line across, from which the mean differs
        RecordProperty("lost_at_" + std::to_string(static_cast<int>(speed_mps)), number_text(lost / all));
    }
}

// A path that is slow for a while has shorter waves as well, whatever comes after; and the fewest speeds that a hull may have aren't those
// at which it makes the shortest.
TEST(Vessels, HaveTheModesOfEachSpeedOfTheirPaths) {
    Vessel vessel = straight(4.7);
    vessel.path = "1 0 0, 241 47 0, 481 67 0, 1681 67 0";
    vessel.interpolation = CameraInterpolation::Linear;
    const VesselPlan plan = plan_vessels(still_water(vessel)).front();
    const auto square_slopes = [&](double speed_mps, double shortest_m, double less_m) {
        const FarField waves(vessel, speed_mps, shortest_m), less(vessel, speed_mps, less_m);
        double sum = 0.0;
        for (double y = -0.3; y < 0.3; y += 0.01) {
            const double x_m = -0.4 * plan.size_m, y_m = y * plan.size_m;
            const glm::dvec2 slope = waves.slope(x_m, y_m) - less.slope(x_m, y_m);
            sum += glm::dot(slope, slope);
        }
        return sum;
    };
    const double finest_m = plan.size_m / VesselPlan::kRadius, shown_m = plan.size_m / plan.radius,
                 none_m = 0.999 * kTwoPi * 4.7 * 4.7 / kGravity, all = square_slopes(4.7, finest_m, none_m);
    for (const double speed_mps : {4.7, 4.2, 3.6, 3.0, 2.5, 2.0})
        EXPECT_LE(square_slopes(speed_mps, finest_m, shown_m) / all, 2e-3) << speed_mps;
}

// Rounding puts the only wave at the end of the tile's, or beyond.
TEST(Vessels, ArePlannedAtTheLeastSpeedThatMakesWaves) {
    double end_m = least_wake_mps(Vessel{}) * 10.0;
    for (int i = 0; i < 600; ++i, end_m = std::nextafter(end_m, 1e9)) {
        Vessel vessel;
        vessel.path = "1 0 0, 241 " + number_text(end_m) + " 0";
        vessel.interpolation = CameraInterpolation::Linear;
        for (const VesselPlan& plan : plan_vessels(still_water(vessel))) {
            EXPECT_GE(plan.radius, VesselPlan::kRadius / 2) << i;
            EXPECT_LE(plan.radius, VesselPlan::kRadius) << i;
        }
    }
}

// A turn under way, with starts and stops.
Vessel turning() {
    return {.path = "-400 -90 -30, 1 -20 0, 180 15 10, 360 20 45, 540 -10 60",
            .length_m = 10.0,
            .beam_m = 3.0,
            .draught_m = 1.2};
}

TEST(Vessels, HaveTheNormalsTheJacobianAndTheVelocityOfTheirPositions) {
    constexpr double kStep = 2e-3, kLater_s = 0.01;
    const ProductSet wanted = products(Position, Normal, Velocity, Product::JacobianMoments);
    Scene scene = still_water(turning());
    scene.quality.level = QualityLevel::Reference;
    scene.waves.masks = {{.waves = 0.0}};  // of the sea's own waves
    const auto rest = random_points<double>(120.0, 3000);
    // At the beginning of a step of the sum over past times, and late in it.
    for (const auto& [footprint_m, now_s] : {std::pair(0.0, 7.42), std::pair(1.5, 7.05)}) {
        auto frame = frame_of<double>(scene, {filtered(wanted, footprint_m)}, now_s);
        const auto moved = [&](glm::dvec2 by) {
            std::vector<glm::dvec2> there = rest;
            for (glm::dvec2& x : there) x += by;
            return sample(frame, 0, there).vectors(Position);
        };
        const auto east = moved({kStep, 0.0}), west = moved({-kStep, 0.0}), north = moved({0.0, kStep}),
                   south = moved({0.0, -kStep});
        const auto answers = sample(frame, 0, rest);
        frame.set(now_s + kLater_s);
        const auto after = moved({});
        frame.set(now_s - kLater_s);
        const auto before = moved({});
        double slopes = 0.0, speeds = 0.0, speed_error = 0.0;
        for (std::size_t i = 0; i < rest.size(); ++i) {
            const glm::dvec3 across =
                glm::cross((east[i] - west[i]) / (2.0 * kStep), (north[i] - south[i]) / (2.0 * kStep));
            ASSERT_NEAR(glm::length(answers.vectors(Normal)[i] - glm::normalize(across)), 0.0, 1e-3) << i;
            ASSERT_NEAR(answers.vectors(Product::JacobianMoments)[i].x, across.z, 1e-3) << i;
            const glm::dvec3 velocity = (after[i] - before[i]) / (2.0 * kLater_s);
            speed_error += std::pow(glm::length(answers.vectors(Velocity)[i] - velocity), 2);
            speeds += std::pow(glm::length(velocity), 2);
            slopes = std::max(slopes, 1.0 - answers.vectors(Normal)[i].z);
        }
        EXPECT_GT(slopes, 0.005);
        EXPECT_LT(std::sqrt(speed_error / speeds), 1e-3) << footprint_m;
    }
}

TEST(Vessels, AreTheSameAloneInARunAndOnOneThread) {
    Scene scene = still_water(turning());
    scene.sea.wind_speed_mps = 6.0;
    const ProductSet wanted = products(Position, Normal, Velocity);
    const std::vector<Query> queries{unfiltered(wanted)};
    const auto rest = random_points<float>(300.0, 4000);
    auto run = frame_of<float>(scene, queries, -3.0);
    for (const double t_s : {-1.0, 2.0, 90.0, 7.25}) run.set(t_s);
    const auto of_run = sample(run, 0, rest);
    const auto is_it = [&](const Frame<float>& frame) {
        const auto there = sample(frame, 0, rest);
        for (const Product product : {Position, Normal, Velocity})
            if (there.vectors(VectorProduct::checked(product)) !=
                of_run.vectors(VectorProduct::checked(product)))
                return false;
        return true;
    };
    EXPECT_TRUE(is_it(frame_of<float>(scene, queries, 7.25)));
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    auto alone = frame_of<float>(scene, queries, 7.25);
    EXPECT_TRUE(is_it(alone));
    scene.waves.vessels.clear();
    auto plain = frame_of<float>(scene, queries, 7.25);
    EXPECT_FALSE(is_it(plain));
    // Beyond the tile the sea is as it is without, to the bit.
    const Where<float> far{.origin_m = {3000.0, 0.0}, .cell_m = {}, .pixel_m = {}};
    EXPECT_EQ(sample(alone, 0, rest, far).vectors(Position), sample(plain, 0, rest, far).vectors(Position));
}

// And so are the strip's foam with its age and the slopes that pixels hide.
TEST(Vessels, LeaveTheSameStripAloneInARunAndOnOneThread) {
    Scene scene = still_water(turning());
    scene.sea.wind_speed_mps = 6.0;
    scene.effects.foam_decay_s = 0.0;  // the strip's alone
    scene.quality.level = QualityLevel::Draft;
    const Query query = filtered(products(Coverage, Product::FoamAge, SlopeVariance), 0.5);
    const auto rest = random_points<float>(300.0, 10000);
    const auto set_to = [&](std::initializer_list<double> times_s) {
        SeaAtTime<float> sea(std::make_shared<const Sea<float>>(make_plan(scene, {query})));
        ProductArrays<float> values;
        values.resize(query.products, rest.size());
        for (const double t_s : times_s) {
            sea.set(t_s);
            sea.evaluate(0, {.origin_m = {}, .count = rest.size(), .rest_m = {rest.data()}},
                         values.results());
        }
        return values;
    };
    const auto of_run = set_to({5.0, 6.0, 7.25});
    const auto is_it = [&](const ProductArrays<float>& there) {
        return there.numbers(Coverage) == of_run.numbers(Coverage) &&
               there.numbers(Product::FoamAge) == of_run.numbers(Product::FoamAge) &&
               there.vectors(SlopeVariance) == of_run.vectors(SlopeVariance);
    };
    EXPECT_TRUE(is_it(set_to({7.25})));
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    EXPECT_TRUE(is_it(set_to({7.25})));
    EXPECT_FALSE(is_it(set_to({7.3})));
    scene.waves.vessels.clear();
    EXPECT_FALSE(is_it(set_to({7.25})));
}

TEST(Vessels, LieWithinTheirBoundsAndFadeToTheTilesBorder) {
    Scene scene = still_water(turning());
    scene.waves.masks = {{.waves = 0.0}};
    const auto frame = frame_of<float>(scene, {unfiltered(products(Position))}, 6.0);
    const VesselPlan& plan = *frame.sea().plan().cascades.back().vessel;
    const glm::dvec2 middle_m = plan.middle_m(6.0);
    const FrameBounds<float> bounds(frame, 0);
    const auto rest = random_points<float>(1.1 * plan.size_m, 30000);
    const auto values =
        sample(frame, 0, rest, {.origin_m = middle_m, .cell_m = {}, .pixel_m = {}}).vectors(Position);
    const DisplacementBounds all = bounds.everywhere();
    double most = 0.0;
    for (std::size_t i = 0; i < rest.size(); ++i) {
        const double z = values[i].z, from = std::max(std::abs(rest[i].x), std::abs(rest[i].y)) / plan.size_m;
        most = std::max(most, std::abs(z));
        ASSERT_TRUE(all.z.lo <= z && z <= all.z.hi) << all.z.lo << ' ' << z << ' ' << all.z.hi;
        ASSERT_TRUE(from <= 0.5 || z == 0.0);
        ASSERT_TRUE(from <= 0.499 || std::abs(z) < 1e-4 * plan.highest_m(scene.sea.depth_m));
    }
    EXPECT_GT(most, 0.1);
    EXPECT_LT(most, plan.highest_m(scene.sea.depth_m));
    for (int i = 0; i < 40; ++i) {
        const glm::dvec2 low = middle_m + glm::dvec2(rest[static_cast<std::size_t>(i)]), high = low + 7.0;
        const DisplacementBounds part = bounds.region({low, high}, 64);
        std::vector<glm::vec2> inside;
        for (int j = 0; j < 64; ++j) inside.emplace_back(j % 8, j / 8);
        for (const glm::vec3& at :
             sample(frame, 0, inside, {.origin_m = low, .cell_m = {}, .pixel_m = {}}).vectors(Position))
            ASSERT_TRUE(part.z.lo <= at.z && at.z <= part.z.hi) << i;
    }
}

std::string problems_of(const Scene& scene) {
    std::string all;
    for (const Problem& problem : validate(scene)) all += text_of(problem) + '\n';
    return all;
}

// From deep water to as shallow as is allowed, slow and fast, slender and broad: what is allowed is finite and within its bounds, and
// what isn't is refused.
TEST(Vessels, AreBoundedOverAllDepthsAndSpeedsOrRefused) {
    int allowed = 0, refused = 0;
    double nearest = 0.0;  // to its bound
    for (const double length_m : {2.0, 25.0})
        for (const double beams : {0.1, 1.0})
            for (const double depth_m : {4000.0, 2.0 * length_m, 0.3 * length_m, 0.08 * length_m})
                for (const double froude : {0.12, 1.0, 2.0})
                    for (const double of_limit : {0.0, 0.97, 1.03}) {
                        const double limit_mps = limits::kVesselDepthFroude * std::sqrt(kGravity * depth_m);
                        const double speed_mps =
                            of_limit > 0.0 ? of_limit * limit_mps : froude * std::sqrt(kGravity * length_m);
                        // Each depth's limit once, where a hull could have such a speed.
                        if (of_limit > 0.0 && (froude != 0.12 || depth_m > 2.0 * length_m)) continue;
                        Vessel vessel = straight(speed_mps, length_m);
                        vessel.beam_m = beams * length_m;
                        vessel.draught_m = std::min(0.12 * length_m, 0.7 * depth_m);
                        Scene scene = still_water(vessel);
                        scene.sea.depth_m = depth_m;
                        const std::string problems = problems_of(scene);
                        const std::string what = std::to_string(length_m) + " m, " + std::to_string(beams) +
                                                 ", over " + std::to_string(depth_m) + " m, " +
                                                 std::to_string(speed_mps) + " m/s";
                        if (speed_mps > limit_mps) {
                            ++refused;
                            ASSERT_NE(problems.find("key 2, 2401"), std::string::npos) << problems;
                            ASSERT_NE(problems.find("near √(g d) waves pile up"), std::string::npos)
                                << problems;
                            continue;
                        }
                        ++allowed;
                        ASSERT_EQ(problems, "") << what;
                        const auto frame =
                            frame_of<float>(scene, {unfiltered(products(Position, Normal, Velocity))}, 0.0);
                        const VesselPlan& plan = *frame.sea().plan().cascades.back().vessel;
                        const auto rest = random_points<float>(plan.size_m, 4000);
                        const auto there = sample(
                            frame, 0, rest, {.origin_m = plan.middle_m(0.0), .cell_m = {}, .pixel_m = {}});
                        const DisplacementBounds bounds = FrameBounds<float>(frame, 0).everywhere();
                        const Extent extent = frame.sea().plan().from->extent;
                        double most_m = 0.0;
                        for (std::size_t i = 0; i < rest.size(); ++i) {
                            const glm::dvec3 at(there.vectors(Position)[i]);
                            const glm::vec3 n = there.vectors(Normal)[i], v = there.vectors(Velocity)[i];
                            ASSERT_TRUE(std::isfinite(at.x + at.y + at.z) && std::isfinite(n.x + n.y + n.z) &&
                                        std::isfinite(v.x + v.y + v.z))
                                << what;
                            ASSERT_TRUE(bounds.z.lo <= at.z && at.z <= bounds.z.hi) << what;
                            ASSERT_LE(glm::length(glm::dvec2(at) - glm::dvec2(rest[i])), extent.reach_m)
                                << what;
                            most_m = std::max(most_m, std::abs(at.z));
                        }
                        ASSERT_GT(most_m, 0.0) << what;
                        ASSERT_LE(most_m, plan.highest_m(depth_m)) << what;
                        ASSERT_LE(most_m, extent.height_m) << what;
                        nearest = std::max(nearest, most_m / plan.highest_m(depth_m));
                    }
    EXPECT_GT(allowed, 20);
    EXPECT_GT(refused, 8);
    EXPECT_GT(nearest, 0.3);  // the bound isn't an idle one
    RecordProperty("nearest", number_text(nearest));
}

// A bow's bands open as long as they are seen: where the strip ends, to the side and at its oldest, nearly nothing is left. A wide pixel has
// as much of it as a narrow one.
TEST(Vessels, StripsEndSoftlyAndKeepTheirFoam) {
    for (const auto& [length_m, beam_m, speed_mps] :
         {std::tuple{6.0, 2.0, 10.0}, std::tuple{2.0, 0.7, 15.0}, std::tuple{26.0, 7.0, 6.0}}) {
        Vessel vessel = straight(speed_mps, length_m);
        vessel.beam_m = beam_m;
        const VesselPlan plan = plan_vessels(still_water(vessel)).front();
        const WakeStrip strip(plan, 0.0);
        const auto& points = strip.points();
        double edge = 0.0;
        for (std::size_t i = 1; i + 1 < points.size(); ++i) {
            const glm::dvec2 along = glm::normalize(points[i].place_m - points[i + 1].place_m),
                             across(-along.y, along.x);
            const glm::dvec2 middle_m = 0.5 * (points[i].place_m + points[i + 1].place_m);
            edge = std::max(edge, strip.at(middle_m + 0.999 * strip.reach_m() * across, 0.05).foam);
            if (i % 20 != 0) continue;
            std::array<double, 2> sums{};
            for (std::size_t wide = 0; wide < 2; ++wide)
                for (double off = -1.0; off < 1.0; off += 1e-3)
                    sums[wide] +=
                        strip.at(middle_m + off * strip.reach_m() * across, wide ? 10.0 * beam_m : 0.05).foam;
            if (sums[0] > 1.0) {
                EXPECT_NEAR(sums[1] / sums[0], 1.0, 0.1) << length_m << " m, point " << i;
            }
        }
        EXPECT_LT(edge, 0.02) << length_m;
        double oldest = 0.0;
        for (double off = -1.0; off < 1.0; off += 1e-3) {
            const glm::dvec2 along = glm::normalize(points.front().place_m - points.back().place_m),
                             across(-along.y, along.x);
            oldest =
                std::max(oldest, strip.at(points.back().place_m + off * strip.reach_m() * across, 0.05).foam);
        }
        EXPECT_LT(oldest, 0.01) << length_m;
    }
}

// Neighbours share the search: each has what the nearest of all pieces gives it, on a path that crosses itself.
// However far apart they are, and whatever is no place at all lies among them.
TEST(Vessels, StripsAnswerNeighboursAsEachByItself) {
    Vessel vessel = turning();
    vessel.path = "-700 -60 -60, -400 40 40, -200 60 -20, 0 -40 -10, 180 -60 50";
    const VesselPlan plan = plan_vessels(still_water(vessel)).front();
    const WakeStrip strip(plan, 7.3);
    const auto& points = strip.points();
    const auto expected = [&](glm::dvec2 place_m, double footprint_m) {
        double nearest_m = strip.reach_m(), share = 0.0;
        std::size_t of = points.size();
        for (std::size_t i = 0; i + 1 < points.size(); ++i) {
            const glm::dvec2 along = points[i + 1].place_m - points[i].place_m;
            const double t = glm::clamp(
                glm::dot(place_m - points[i].place_m, along) / std::max(glm::dot(along, along), 1e-30), 0.0,
                1.0);
            const double off_m = glm::distance(place_m, points[i].place_m + t * along);
            if (off_m < nearest_m) nearest_m = off_m, share = t, of = i;
        }
        if (of == points.size()) return WakeWater<double>{0.0, 0.0, 0.0};
        const WakeStrip::Point &a = points[of], &b = points[of + 1];
        return wake_water(
            strip.hull(),
            WakePlace<double>{nearest_m, std::lerp(a.way_m, b.way_m, share),
                              std::lerp(a.age_s, b.age_s, share), std::lerp(a.strength, b.strength, share)},
            footprint_m);
    };
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN(),
                     kFar = std::numeric_limits<double>::infinity();
    const std::array<glm::dvec2, 5> nowhere{
        {{kNone, 0.0}, {0.0, kFar}, {-kFar, 0.0}, {kFar, kNone}, {1e300, -1e300}}};
    // Neighbours that a piece tells apart, that it doesn't, and that aren't any.
    for (const auto& [apart_m, is_scattered] :
         {std::pair(0.7, false), std::pair(9.0, false), std::pair(0.7, true)})
        for (const double footprint_m : {0.05, 6.0}) {
            std::vector<glm::dvec2> places;
            for (double y = -110.0; y < 110.0; y += 5.0)
                for (double x = -110.0; x < 110.0; x += apart_m) {
                    places.emplace_back(x, y);
                    if (places.size() % 23 == 0) places.push_back(nowhere[places.size() % nowhere.size()]);
                }
            if (is_scattered) std::shuffle(places.begin(), places.end(), std::mt19937(1));
            std::vector<WakeWater<double>> foam(places.size(), {0.0, 0.0, 0.0}), calm = foam;
            for (const auto& [wanted, to] :
                 {std::pair(WakeStrip::Wanted::Foam, &foam), std::pair(WakeStrip::Wanted::Calm, &calm)})
                strip.for_each(
                    wanted, places.size(), [&](std::size_t i) { return places[i]; },
                    [&](std::size_t) { return footprint_m; },
                    [&, to = to](std::size_t i, const WakeWater<double>& water) { (*to)[i] = water; });
            int wet = 0;
            for (std::size_t i = 0; i < places.size(); ++i) {
                const WakeWater<double> at = expected(places[i], footprint_m),
                                        alone = strip.at(places[i], footprint_m);
                ASSERT_EQ(foam[i].foam, alone.foam) << i;
                ASSERT_EQ(foam[i].age_s, alone.age_s) << i;
                ASSERT_NEAR(foam[i].foam, at.foam, 1e-9) << i;
                if (at.foam > 1e-6) {
                    ASSERT_NEAR(foam[i].age_s, at.age_s, 1e-6) << i;
                }
                ASSERT_NEAR(calm[i].calm, at.calm, 1e-9) << i;
                wet += at.foam > 0.01;
            }
            EXPECT_GT(wet, 100);
        }
}

TEST(Vessels, StayFiniteOnHardPaths) {
    const auto rest = random_points<float>(200.0, 2000);
    for (const char* path : {"1 0 0, 100 0 0", "1 5 5, 10 5 5, 20 9 5, 30 9 5", "1 0 0, 1000 8 0",
                             "1 0 0, 5 2 0, 9 0 0, 13 2 0, 17 0 0", "1 1e6 -1e6, 24 1e6 -999990",
                             "1 0 0, 2 4 0, 3 0 1, 4 -4 0, 5 0 -1"})
        for (const CameraInterpolation by : {CameraInterpolation::Linear, CameraInterpolation::Smooth})
            for (const double t_s : {-1e6, -0.1, 0.0, 1e-9, 3.0, 1e5}) {
                Scene scene = still_water({.path = path, .interpolation = by});
                if (t_s != 3.0 && t_s != 0.0 && by == CameraInterpolation::Linear) continue;
                const auto frame =
                    frame_of<float>(scene, {unfiltered(products(Position, Normal, Velocity))}, t_s);
                const auto there = sample(frame, 0, rest);
                for (const Product product : {Position, Normal, Velocity})
                    for (const glm::vec3& value : there.vectors(VectorProduct::checked(product)))
                        ASSERT_TRUE(std::isfinite(value.x + value.y + value.z)) << path << ' ' << t_s;
            }
    Scene rising = still_water({});
    rising.keyed = {{"sea.wind_speed_mps", {.keys = {{1, 5.0}, {100, 12.0}}}}};
    Frame<float> frame(std::make_shared<const SeaOverTime<float>>(
        make_plan(rising, {unfiltered(products(Position, Velocity))})));
    frame.set(2.0);
    for (const glm::vec3& value : sample(frame, 0, rest).vectors(Velocity))
        ASSERT_TRUE(std::isfinite(value.x + value.y + value.z));
    EXPECT_EQ(
        make_plan(still_water({.path = "1 0 0, 100 0 0"}), {unfiltered(products(Position))}).vessel_bytes(),
        0u);
}

// The tile's grid is coarser than a sea's: its spline shows the slopes all the same.
TEST(Vessels, HaveTheNormalsOfAFinerGrid) {
    for (const auto& [speed_mps, length_m] :
         {std::pair(5.0, 25.0), std::pair(3.0, 25.0), std::pair(8.0, 6.0)}) {
        Scene scene = still_water(straight(speed_mps, length_m));
        const auto rest = random_points<float>(10.0 * length_m, 4000);
        const auto normals = [&](QualityLevel level) {
            scene.quality.level = level;
            const auto frame = frame_of<float>(scene, {unfiltered(products(Position, Normal))}, 0.0);
            return sample(frame, 0, rest, {.origin_m = {-4.0 * length_m, 0.0}, .cell_m = {}, .pixel_m = {}})
                .vectors(Normal);
        };
        const auto final = normals(QualityLevel::Final), fine = normals(QualityLevel::Reference);
        double error = 0.0, all = 0.0;
        for (std::size_t i = 0; i < rest.size(); ++i) {
            error += std::pow(glm::length(final[i] - fine[i]), 2);
            all += std::pow(fine[i].x, 2) + std::pow(fine[i].y, 2);
        }
        EXPECT_LT(std::sqrt(error / all), 0.01) << speed_mps;
        std::printf("    %.0f m/s, %.0f m: %.2e of the slopes, rms\n", speed_mps, length_m,
                    std::sqrt(error / all));
    }
}

// A lattice's points read few rows of the tile, and no other ones are transformed: what they show is the same, to the bit.
TEST(Vessels, TransformTheRowsThatALatticeReads) {
    const ProductSet wanted = products(Position, Normal, Velocity);
    const Scene scene = still_water(straight(5.0));
    Query query = unfiltered(wanted);
    const auto whole = frame_of<float>(scene, {query}, 0.0);
    const CascadePlan& all = whole.sea().plan().cascades.back();
    for (const glm::dvec2 ends_m : {glm::dvec2(-40.0, 43.0), glm::dvec2(0.0, 60.0),
                                    glm::dvec2(-1234.5, -1234.0), glm::dvec2(10.0, 10.0 + all.size_m)}) {
        query.lattice = Lattice{.first_m = ends_m.x, .spacing_m = 0.777, .last_m = ends_m.y};
        auto part = frame_of<float>(scene, {query}, 0.0);
        const Plan& plan = part.sea().plan();
        const Grid& grid = plan.cascades.back().grids.front();
        ASSERT_EQ(grid.resolution, all.grids.front().resolution);
        // Slopes and gradients along x are made of others' columns.
        EXPECT_EQ(grid.along_x, fields(Field::SlopeX, Field::Dxx, Field::Dxy));
        EXPECT_EQ(grid.lines(), 8 * grid.radius + 11 * ((grid.rows + 1) / 2));
        const double size_m = ends_m.y - ends_m.x;
        if (size_m < all.size_m)
            EXPECT_LT(grid.rows, grid.resolution * size_m / all.size_m + 32.0);
        else
            EXPECT_EQ(grid.rows, grid.resolution);
        EXPECT_EQ(part.executed_lines(), plan.lines_per_frame());
        EXPECT_EQ(part.executed_transforms(), plan.transforms_per_frame());
        std::vector<glm::vec2> rest;
        for (const glm::dvec2& at : random_points<double>(size_m, 2000))
            rest.emplace_back(at + 0.5 * (ends_m.x + ends_m.y));
        rest.emplace_back(glm::dvec2(ends_m.x));
        rest.emplace_back(glm::dvec2(ends_m.y));
        const auto expected = sample(whole, 0, rest), found = sample(part, 0, rest);
        for (const Product product : {Position, Normal, Velocity})
            EXPECT_EQ(expected.vectors(VectorProduct::checked(product)),
                      found.vectors(VectorProduct::checked(product)))
                << ends_m.x;
    }
}

// Of the squares of the slopes what is shown and what is hidden: over the tile the same sum at each footprint.
TEST(Vessels, ShowAndHideTheirSlopes) {
    Query query = unfiltered(products(Normal, SlopeVarianceAtRest));
    query.cell_m = query.pixel_m = {0.0, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0};
    Scene scene = still_water(straight(5.0));
    scene.waves.choppiness = 0.0;
    scene.effects.whitecaps = false;
    const auto frame = frame_of<float>(scene, {query}, 0.0);
    const VesselPlan& plan = *frame.sea().plan().cascades.back().vessel;
    std::vector<glm::vec2> rest;
    constexpr int kSide = 320;
    for (int i = 0; i < kSide * kSide; ++i)
        rest.push_back(static_cast<float>(plan.size_m) *
                       (glm::vec2(i % kSide, i / kSide) / static_cast<float>(kSide) - 0.5f));
    const auto all = [&](float footprint_m) {
        Where<float> where{.origin_m = plan.middle_m(0.0), .cell_m = {}, .pixel_m = {}};
        where.cell_m = where.pixel_m = std::vector<float>(rest.size(), footprint_m);
        const auto values = sample(frame, 0, rest, where);
        double shown = 0.0, hidden = 0.0;
        for (std::size_t i = 0; i < rest.size(); ++i) {
            const glm::vec3 n = values.vectors(Normal)[i], of = values.vectors(SlopeVarianceAtRest)[i];
            shown += (n.x * n.x + n.y * n.y) / (n.z * n.z);
            hidden += of.x + of.y;
        }
        return std::pair(shown, hidden);
    };
    const auto [whole, none] = all(0.0f);
    EXPECT_LT(none, 1e-3 * whole);
    for (const float footprint_m : {0.5f, 1.0f, 2.0f, 4.0f, 8.0f, 16.0f}) {
        const auto [shown, hidden] = all(footprint_m);
        EXPECT_NEAR((shown + hidden) / whole, 1.0, 0.03) << footprint_m << ' ' << shown / whole;
    }
    // Between levels a wave that the coarser one half shows is taken for one that it doesn't.
    const auto [shown, hidden] = all(2.8f);
    EXPECT_NEAR((shown + hidden) / whole, 1.0, 0.08) << shown / whole;
}

// White behind the stern and less of it farther on, wider there; ripples are damped; beside it all is as it was.
TEST(Vessels, LeaveAStripOfFoamAndCalm) {
    Scene scene = still_water(straight(5.0));
    scene.sea.wind_speed_mps = 5.0;
    scene.sea.fetch_m = 3e3;
    scene.quality.level = QualityLevel::Draft;
    const Query query = filtered(foam_products() | products(SlopeVarianceAtRest), 0.5);
    const auto there = [&](const std::vector<glm::vec2>& rest) {
        SeaAtTime<float> sea(std::make_shared<const Sea<float>>(make_plan(scene, {query})));
        sea.set(0.0);
        ProductArrays<float> values;
        values.resize(query.products, rest.size());
        sea.evaluate(0, {.origin_m = {}, .count = rest.size(), .rest_m = {rest.data()}}, values.results());
        return values;
    };
    const std::vector<glm::vec2> rest{{-16.0f, 0.0f},  {-60.0f, 0.0f},  {-300.0f, 0.0f}, {-16.0f, 12.0f},
                                      {-300.0f, 5.5f}, {-60.0f, 40.0f}, {60.0f, 0.0f},   {10.0f, 1.6f}};
    const auto with = there(rest);
    scene.waves.vessels.clear();
    const auto without = there(rest);
    const auto foam = [&](std::size_t i) { return with.numbers(Coverage)[i] - without.numbers(Coverage)[i]; };
    EXPECT_GT(foam(0), 0.6f);
    EXPECT_NEAR(foam(1), 0.55f, 0.06f);
    EXPECT_LT(foam(2), 0.6f * foam(1));
    EXPECT_LT(foam(3), 0.02f);
    EXPECT_GT(foam(4), 0.02f);
    EXPECT_GT(foam(7), 0.2f);  // the bow's
    for (const std::size_t i : {5, 6}) EXPECT_NEAR(foam(i), 0.0f, 1e-5f);
    EXPECT_NEAR(with.numbers(Product::FoamAge)[1], 12.0f, 0.5f);
    const auto hidden = [&](const ProductArrays<float>& of, std::size_t i) {
        return of.vectors(SlopeVarianceAtRest)[i].x;
    };
    EXPECT_LT(hidden(with, 1), 0.8f * hidden(without, 1));
    EXPECT_EQ(hidden(with, 5), hidden(without, 5));
}

TEST(Vessels, AreRefusedWhereTheyCannotBe) {
    const auto first = [](Scene scene) {
        const auto problems = validate(scene);
        return problems.empty() ? std::string() : text_of(problems.front());
    };
    const auto of_path = [&](const char* path) { return first(still_water({.path = path})); };
    EXPECT_EQ(first(still_water({})), "");
    EXPECT_NE(of_path("").find("is no list of keys"), std::string::npos);
    EXPECT_NE(of_path("1 0 0").find("too few keys"), std::string::npos);
    EXPECT_NE(of_path("1 0 0, 2 nan 0").find("is no list of keys"), std::string::npos);
    EXPECT_NE(of_path("1 0 0, 2 1").find("is no list of keys"), std::string::npos);
    EXPECT_NE(of_path("1 0 0, 1 5 0").find("does not come after"), std::string::npos);
    EXPECT_NE(of_path("1 0 0, 2 50 0").find("too short"), std::string::npos);
    // Which key it is.
    EXPECT_NE(of_path("1 0 0, 9 2 0, 10 nan 0").find("key 3 isn't three numbers"), std::string::npos);
    EXPECT_NE(of_path("1 0 0, 9 2 0, 5 4 0").find("key 3, 5 4 0"), std::string::npos);
    // In shallow water a smooth path is judged between its keys as well.
    Scene shallow = still_water({.path = "1 0 0, 25 0.5 0, 49 4.5 0, 73 5 0", .draught_m = 0.5});
    shallow.sea.depth_m = 2.6;
    EXPECT_NE(first(shallow).find("interpolation = \"smooth\": goes up to"), std::string::npos)
        << first(shallow);
    shallow.waves.vessels[0].interpolation = CameraInterpolation::Linear;
    EXPECT_EQ(first(shallow), "");
    // Too slow: no wake, and a note says so.
    Scene slow = still_water({.path = "1 0 0, 241 3 0"});
    EXPECT_EQ(first(slow), "");
    const auto notes = sea_warnings(*prepare(slow));
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_NE(notes[0].find("waves.vessels[0].path goes at up to 0.3 m/s, too slow for a wake: a hull of"),
              std::string::npos)
        << notes[0];
    EXPECT_TRUE(sea_warnings(*prepare(still_water({}))).empty());
    // Once, however many keys the wind has.
    slow.sea.wind_speed_mps = 5.0;
    slow.keyed = {{"sea.wind_speed_mps", {.keys = {{1, 5.0}, {100, 6.0}, {240, 7.0}}}}};
    int told = 0;
    for (const std::string& note : sea_warnings(*prepare(slow)))
        told += note.find("too slow for a wake") != std::string::npos;
    EXPECT_EQ(told, 1);
    EXPECT_NE(of_path("1 0 0, 2 2e9 0").find("no place on the sea"), std::string::npos);
    Scene scene = still_water({});
    scene.shot.time_scale = 0.0;
    EXPECT_NE(first(scene).find("waves.vessels"), std::string::npos);
    scene = still_water({});
    scene.shot.loop_s = 2.0;
    EXPECT_NE(first(scene).find("is a loop"), std::string::npos);
    scene = still_water({});
    scene.waves.model = WaveModel::Trochoid;
    EXPECT_NE(first(scene).find("waves.model"), std::string::npos);
    scene = still_water({});
    scene.output.cascade_tiles = true;
    EXPECT_NE(first(scene).find("cascade_tiles"), std::string::npos);
}

}  // namespace
}  // namespace pelagic
