// Trains and cascades behind one query: alone and together, every instruction set alike.
#include <gtest/gtest.h>
#include "core/surface/patch.h"

#include <algorithm>

#include "core/base/instruction_set.h"
#include "core/spectrum/directional_spectrum.h"
#include "core/surface/patch.h"
#include "core/waves/loop.h"
#include "tests/core/waves/samples.h"

namespace pelagic {
namespace {

using namespace test;

const ProductSet kEverything = ~lasting_products();

Scene trains_alone() {
    Scene scene;
    scene.effects.foam_decay_s = 0.0;  // all foam breaks now
    scene.sea.wind_direction_deg = 35.0;
    scene.waves.model = WaveModel::Trochoid;
    return scene;
}
Scene trains_and_cascades() {
    Scene scene = trains_alone();
    scene.waves.shortest_m = 2.0;
    scene.waves.cascades = {{.size_m = 60.0, .resolution = 128}, {.size_m = 15.0, .resolution = 128}};
    return scene;
}

// η, D and the velocity of the trains as Eq. 2 says, one after the other; weights of a footprint of 0.
struct Sum {
    glm::dvec3 displacement{0.0}, velocity{0.0};
};
Sum by_hand(const Trains<double>& trains, glm::dvec2 x, double t_s) {
    Sum sum;
    for (std::size_t i = 0; i < trains.count(); ++i) {
        const double theta = kTwoPi * (trains.start_cycles[i] + trains.cycles_per_s[i] * t_s -
                                       trains.kx_cycles_per_m[i] * x.x - trains.ky_cycles_per_m[i] * x.y);
        const glm::dvec2 along = glm::dvec2(trains.kx_cycles_per_m[i], trains.ky_cycles_per_m[i]) *
                                 trains.wavelength_m[i] * trains.horizontal_m[i];
        const double omega = kTwoPi * trains.cycles_per_s[i], h = trains.height_m[i];
        sum.displacement += glm::dvec3(along * std::sin(theta), h * std::cos(theta));
        sum.velocity += omega * glm::dvec3(along * std::cos(theta), -h * std::sin(theta));
    }
    return sum;
}

TEST(TwoModels, TrainsAloneAreTheirSumAndTakeNoTransform) {
    const auto frame = frame_of<double>(trains_alone(), {unfiltered(kEverything)}, 3.7);
    EXPECT_EQ(frame.sea().plan().transforms_per_frame(), 0);
    EXPECT_EQ(frame.held_bytes(), 0u);
    const auto rest = random_points<double>(300.0, 600);
    const auto samples = sample(frame, 0, rest, {.origin_m = {1000.0, -500.0}, .cell_m = {}, .pixel_m = {}});
    for (std::size_t i = 0; i < rest.size(); ++i) {
        const Sum sum = by_hand(frame.sea().trains(), rest[i] + glm::dvec2(1000.0, -500.0), 3.7);
        for (int a = 0; a < 3; ++a) {  // phases of up to 1e5 cycles in double: 1e-10 of a metre's waves
            ASSERT_NEAR(samples.vectors(Displacement)[i][a], sum.displacement[a], 1e-9);
            ASSERT_NEAR(samples.vectors(Velocity)[i][a], sum.velocity[a], 1e-9);
        }
    }
}

// The same frame's cascades alone, by way of their tiles, and the trains by hand: nothing else is in the sum.
// The spline's images are 1e-5 of the shortest waves' 3 cm.
TEST(TwoModels, TogetherAreTheSumOfBoth) {
    Scene scene = trains_and_cascades();
    scene.waves.tiling = Tiling::Periodic;
    Query both = unfiltered(kEverything);
    std::vector<Query> queries{both};
    for (int c = 0; c < 2; ++c) {
        Query alone = unfiltered(kEverything);
        alone.only_cascade = c;
        queries.push_back(alone);
    }
    const auto frame = frame_of<double>(scene, queries, 2.0);
    const auto rest = random_points<double>(100.0, 300);
    const auto all = sample(frame, 0, rest), large = sample(frame, 1, rest), small = sample(frame, 2, rest);
    for (std::size_t i = 0; i < rest.size(); ++i) {
        const Sum sum = by_hand(frame.sea().trains(), rest[i], 2.0);
        const glm::dvec3 expected =
            sum.displacement + large.vectors(Displacement)[i] + small.vectors(Displacement)[i];
        for (int a = 0; a < 3; ++a) ASSERT_NEAR(all.vectors(Displacement)[i][a], expected[a], 1e-9) << i;
    }
    // The tiles' waves begin where the trains end.
    EXPECT_DOUBLE_EQ(frame.sea().plan().cascades[0].k_lower, kTwoPi / 2.0);
    EXPECT_GT(frame.sea().expected_m0(0), 0.0);
}

// Whatever a footprint lets through of the trains and of the cascades, the slopes that it hides are the rest
// of the whole sea, for footprints alike for all and one by one; the whole is the spectrum's but for the
// trains' choice of directions and the trochoid's second order.
TEST(TwoModels, ShownAndUnresolvedAddUpToTheWholeAtEveryFootprint) {
    for (const Scene& scene : {trains_alone(), trains_and_cascades()}) {
        Query query = unfiltered(products(Product::SlopeVarianceAtRest, Product::Normal));
        query.pixel_m = query.cell_m = {0.02, 0.1, 0.5, 3.0, 20.0};
        std::vector<Query> queries{query};
        for (double footprint_m : query.pixel_m)
            queries.push_back(filtered(products(Product::SlopeVarianceAtRest, Product::Normal), footprint_m));
        const auto frame = frame_of<double>(scene, queries);
        const SpectralMoments whole = frame.sea().total();
        const SpectralMoments spectrum =
            moments(DirectionalSpectrum(scene.sea), 0.0, std::numeric_limits<double>::infinity());
        EXPECT_NEAR(whole.mss() / spectrum.mss(), 1.0, 0.02);
        double before = 0.0;
        for (std::size_t i = 0; i < query.pixel_m.size(); ++i) {
            const double footprint_m = query.pixel_m[i];
            const SpectralMoments trains = resolved(frame.sea().trains(), FootprintFilter{}, footprint_m);
            const SpectralMoments cascades = frame.sea().statistics(0).resolved[i];
            const Where<double> own{.origin_m = {}, .cell_m = {footprint_m}, .pixel_m = {footprint_m}};
            const std::vector<glm::dvec2> point{{1.0, 2.0}};
            for (const auto& unresolved :
                 {sample(frame, 0, point, own).vectors(SlopeVarianceAtRest)[0],
                  sample(frame, static_cast<int>(i) + 1, point).vectors(SlopeVarianceAtRest)[0]}) {
                // Sampled modes against the integral over the cascades' band: 1e-3 of what they hold.
                const double room = 1e-12 + 1e-3 * cascades.mss();
                EXPECT_NEAR(unresolved.x + trains.xx + cascades.xx, whole.xx, room) << footprint_m;
                EXPECT_NEAR(unresolved.y + trains.yy + cascades.yy, whole.yy, room) << footprint_m;
                EXPECT_GE(unresolved.x + unresolved.y, before);
            }
            before = whole.mss() - trains.mss() - cascades.mss() - 1e-12;
        }
    }
}

// The house's rule: instruction sets agree to 1e-5 of the significant height. They don't agree to the bit
// (one fuses multiplication and addition, another doesn't): a set that is never switched to would.
template <class T>
void expect_agreement(const Scene& scene, double tolerance) {
    const Query between = filtered(kEverything, 0.5);
    auto rest = random_points<T>(150.0, 700);
    // Rows of a patch as well, which grids are read at in another way. They cross copies of tiles.
    const auto rows = rest_points<T>({.per_side = 60, .spacing_m = 2.5, .first_m = -75.0});
    rest.insert(rest.end(), rows.begin(), rows.end());
    std::vector<ProductArrays<T>> answers;
    const std::vector<std::string> names = instruction_sets();
    double height_m = 0.0;
    for (const std::string& set : names) {
        use_instruction_set(set);
        const auto frame = frame_of<T>(scene, {between}, 5.0);
        height_m = frame.sea().total().significant_height_m();
        answers.push_back(sample(frame, 0, rest));
    }
    double largest = 0.0;
    for (std::size_t s = 1; s < answers.size(); ++s) {
        double worst = 0.0;
        const auto compare = [&](T a, T b, double most) {
            worst = std::max(worst, std::abs(static_cast<double>(a - b)));
            ASSERT_NEAR(a, b, most) << names[s] << " and " << names[0];
        };
        for (std::size_t i = 0; i < rest.size(); ++i)
            for (int a = 0; a < 3; ++a) {
                compare(answers[s].vectors(Displacement)[i][a], answers[0].vectors(Displacement)[i][a],
                        tolerance * height_m);
                compare(answers[s].vectors(Velocity)[i][a], answers[0].vectors(Velocity)[i][a],
                        2.0 * tolerance * height_m);
                compare(answers[s].vectors(Normal)[i][a], answers[0].vectors(Normal)[i][a], tolerance);
                compare(answers[s].numbers(Product::Breaking)[i], answers[0].numbers(Product::Breaking)[i],
                        tolerance);
            }
        largest = std::max(largest, worst);
    }
    // AVX2 and AVX-512 may give the same bits; sets with and without fused products don't.
    EXPECT_GT(largest, 0.0) << names.front() << " and " << names.back() << " ran the same code";
    EXPECT_NE(names.front(), names.back())
        << "only one instruction set on this machine: nothing was compared";
}

// Both lengths of splines, in both precisions: vectors hold other numbers of their taps.
TEST(TwoModels, AgreeOnEveryInstructionSet) {
    for (Scene scene : {Scene{}, trains_alone(), trains_and_cascades()})
        for (const QualityLevel level : {QualityLevel::Draft, QualityLevel::Final}) {
            scene.quality.level = level;
            expect_agreement<float>(scene, 1e-5);
            expect_agreement<double>(scene, 1e-9);
        }
}

}  // namespace
}  // namespace pelagic
