// Foam with a past in a sea that changes: each past time has its own waves, threshold, and foam that a breaking leaves.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstring>

#include "core/effects/sea_at_time.h"
#include "core/scene/editions.h"
#include "core/scene/keys.h"
#include "core/waves/whitecaps.h"
#include "tests/core/waves/samples.h"

namespace pelagic {
namespace {

using namespace test;

// The wind rises within ten seconds.
Scene rising_foam() {
    Scene scene = scene_of_edition(1);
    scene.waves.cascades = {{250.0, 144}, {30.0, 64}};
    scene.effects.foam_decay_s = 1.0;
    EXPECT_FALSE(
        set_value(scene, key_of("sea.wind_speed_mps"), NumberKeys{{{721, 9.0}, {961, 22.0}}}));  // 30 … 40 s
    return scene;
}

// Of crests that sharpen and get rounder meanwhile.
Scene sharpening_foam(Scene scene) {
    EXPECT_FALSE(
        set_value(scene, key_of("waves.choppiness"), NumberKeys{{{750, 0.3}, {870, 1.3}, {900, 0.6}}}));
    return scene;
}

// The same in a steady wind.
Scene sharpening_foam_alone() {
    Scene scene = rising_foam();
    scene.keyed.clear();
    scene.sea.wind_speed_mps = 15.0;
    return sharpening_foam(scene);
}

// With all that changes: over a floor that rises as well.
Scene changing_foam() {
    Scene scene = sharpening_foam(rising_foam());
    EXPECT_FALSE(set_value(scene, key_of("sea.depth_m"), NumberKeys{{{750, 60.0}, {900, 14.0}}}));
    return scene;
}

template <class T>
std::shared_ptr<const SeaOverTime<T>> sea_over_time(const Scene& scene) {
    for (const Problem& problem : validate(scene)) throw std::invalid_argument(text_of(problem));
    const Query query = filtered(foam_products() | products(Product::JacobianMoments), 0.4);
    return std::make_shared<const SeaOverTime<T>>(
        make_plan(scene, {query}, {.double_precision = sizeof(T) == sizeof(double)}));
}

template <class T>
ProductArrays<T> foam_at(SeaAtTime<T>& sea, double t_s, const std::vector<glm::vec<2, T>>& rest_m,
                         glm::dvec2 origin_m = glm::dvec2(0.0)) {
    sea.set(t_s);
    ProductArrays<T> values;
    values.resize(foam_products(), rest_m.size());
    sea.evaluate(0, {.origin_m = origin_m, .count = rest_m.size(), .rest_m = {rest_m.data()}},
                 values.results());
    return values;
}

template <class T>
bool same_foam(const ProductArrays<T>& a, const ProductArrays<T>& b) {
    for (const NumberProduct product : {NumberProduct(Coverage), NumberProduct(Product::FoamAge)})
        if (std::memcmp(a.numbers(product).data(), b.numbers(product).data(),
                        a.numbers(product).size() * sizeof(T)) != 0)
            return false;
    return true;
}

// As the definition has it: (left per second of breaking) ∫ Φ(y) e^{−a/τ} da, with y, the waves and what breaking leaves of t − a.
void expect_the_sum_of_what_broke_before(const Scene& scene) {
    const auto sea = sea_over_time<double>(scene);
    const FoamPlan& foam = *sea->plan().foam;
    constexpr double kTime_s = 36.0;
    constexpr int kSide = 24;
    std::vector<glm::dvec2> points;
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x) points.push_back(foam.cell_m * glm::dvec2(x, y));
    const glm::dvec2 first = foam.cell_m * glm::floor(foam.drift_mps * kTime_s / foam.cell_m);
    const glm::dvec2 origin = foam.drift_mps * kTime_s - first;
    SeaAtTime<double> state(sea);
    const auto seen = foam_at(state, kTime_s, points, origin);

    Query query = filtered(products(Product::JacobianMoments), foam.cell_m);
    Frame<double> frame(
        std::make_shared<const SeaOverTime<double>>(make_plan(scene, {query}, {.double_precision = true})));
    std::vector<double> sum(points.size());
    ProductArrays<double> at;
    at.resize(products(Product::JacobianMoments), points.size());
    const double step_s = foam.step_s / 8.0;
    for (int i = 0; i * step_s < foam.window_s; ++i) {
        const double age_s = (i + 0.5) * step_s;
        frame.set(kTime_s - age_s);
        evaluate(frame, 0,
                 Points<double>{.origin_m = origin - foam.drift_mps * age_s,
                                .count = points.size(),
                                .rest_m = {points.data()}},
                 at.results());
        const Whitecaps then = sea->whitecaps(kTime_s - age_s);
        for (std::size_t p = 0; p < points.size(); ++p) {
            const glm::dvec3 j = at.vectors(Product::JacobianMoments)[p];
            const double y = breaking_deviate({j.x, j.y, j.z}, then.threshold, true);
            sum[p] += then.left_per_s * foam.weight(i * step_s, (i + 1) * step_s).foam_s * 0.5 *
                      std::erfc(-y / std::sqrt(2.0));
        }
    }
    double got = 0.0, wanted = 0.0, squares_got = 0.0, squares_wanted = 0.0, products_of_both = 0.0;
    const auto count = static_cast<double>(points.size());
    for (std::size_t p = 0; p < points.size(); ++p) {
        const double active = seen.numbers(Product::Breaking)[p];
        const double is = (seen.numbers(Coverage)[p] - active) / (1.0 - active),
                     should = residual_foam(sum[p], active) / (1.0 - active);
        got += is / count;
        wanted += should / count;
        squares_got += is * is / count;
        squares_wanted += should * should / count;
        products_of_both += is * should / count;
    }
    const double correlation = (products_of_both - got * wanted) /
                               std::sqrt((squares_got - got * got) * (squares_wanted - wanted * wanted));
    EXPECT_GT(correlation, 0.98);
    EXPECT_NEAR(got / wanted, 1.0, 0.06);
}

TEST(WeatherFoam, IsTheSumOfWhatBrokeBefore) {
    expect_the_sum_of_what_broke_before(rising_foam());
    expect_the_sum_of_what_broke_before(sharpening_foam_alone());
}

// Beyond all tiles: by the law at the wind of the frame, which has gone on from the first.
TEST(WeatherFoam, OfAFrontIsThatOfTheMomentsWind) {
    Scene scene = rising_foam();
    scene.effects.whitecap_law = WhitecapLaw::Callaghan2008;
    const auto far = rest_points<float>({.per_side = 8, .spacing_m = 2000.0, .first_m = 0.0});
    const auto left = [&](const Scene& of) {
        const Query query = filtered(foam_products(), 3000.0);
        SeaAtTime<float> sea(std::make_shared<const SeaOverTime<float>>(make_plan(of, {query})));
        const auto values = foam_at(sea, 60.0, far);
        double sum = 0.0;
        for (std::size_t i = 0; i < far.size(); ++i) {
            const auto active = static_cast<double>(values.numbers(Product::Breaking)[i]);
            sum += (static_cast<double>(values.numbers(Coverage)[i]) - active) / (1.0 - active);
        }
        return sum;
    };
    const double plain = left(scene);
    scene.sea.gust_fronts = {{.speed_mps = 0.0, .length_m = 1e5, .width_m = 1e5, .wind = 0.5}};
    Scene last = scene;
    last.keyed.clear();
    last.sea.wind_speed_mps = 22.0;
    const double law = law_coverage(last, 0.5) / law_coverage(last);
    EXPECT_NEAR(left(scene) / plain, law, 0.05 * law);
}

TEST(WeatherFoam, IsTheSameAloneAndInARunOnAnyNumberOfThreads) {
    for (const Scene& scene : {rising_foam(), changing_foam()}) {
        const auto sea = sea_over_time<float>(scene);
        const auto points = random_points<float>(60.0, 400);
        SeaAtTime<float> run(sea);
        for (const double t : {34.0, 34.2, 34.4}) foam_at(run, t, points);
        const auto of_run = foam_at(run, 35.0, points);
        for (const std::size_t threads : {1, 2}) {
            const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
            SeaAtTime<float> alone(sea_over_time<float>(scene));
            EXPECT_TRUE(same_foam(foam_at(alone, 35.0, points), of_run));
        }
        EXPECT_FALSE(same_foam(foam_at(run, 36.0, points), of_run));
    }
}

// While neither the sea nor its past has changed yet: that of the plain number, which drifts with its own wind.
TEST(WeatherFoam, BeforeAnythingChangesIsThatOfThePlainNumber) {
    Scene scene = rising_foam(), plain = scene;
    scene.effects.foam_drift = plain.effects.foam_drift = 0.0;
    set_value(plain, key_of("sea.wind_speed_mps"), 9.0);
    const auto points = random_points<float>(60.0, 400);
    SeaAtTime<float> changing(sea_over_time<float>(scene)), still(sea_over_time<float>(plain));
    EXPECT_TRUE(same_foam(foam_at(changing, 20.0, points), foam_at(still, 20.0, points)));
    EXPECT_FALSE(same_foam(foam_at(changing, 33.0, points), foam_at(still, 33.0, points)));
}

// A wind that rises from none within a second leaves no more foam than the law has at its end, as soon as it has had its time.
TEST(WeatherFoam, SetsInWithTheLaw) {
    Scene scene = rising_foam();
    ASSERT_FALSE(set_value(scene, key_of("sea.wind_speed_mps"), NumberKeys{{{1, 0.0}, {25, 12.0}}}));
    SeaAtTime<float> sea(sea_over_time<float>(scene));
    scene.sea.wind_speed_mps = 12.0;
    const double law = law_coverage(scene);
    const auto points = random_points<float>(250.0, 20000);
    double before = 0.0;
    for (const double t : {-1.0, 0.4, 0.8, 6.0}) {
        const double mean = mean_of(foam_at(sea, t, points).numbers(Coverage), [](float v) { return v; });
        EXPECT_GE(mean, before);
        EXPECT_LT(mean, 1.3 * law) << t;
        before = mean;
    }
    EXPECT_GT(before, 0.7 * law);
}

// What breaks and what breaking leaves are together as much as the law has at the wind of the time, with the waves of the time.
TEST(WeatherFoam, IsCalibratedForTheSeaOfEachTime) {
    Scene scene = rising_foam();
    scene.sea.wind_speed_mps = 22.0;
    ASSERT_FALSE(
        set_value(scene, key_of("sea.wind_speed_mps"), NumberKeys{{{1, 14.0}, {24001, 22.0}}}));  // 1000 s
    const auto sea = sea_over_time<double>(scene);
    for (const double t : {250.0, 700.0}) {
        const Whitecaps now = sea->whitecaps(t);
        const double wind = 14.0 + 8.0 * t / 1000.0;
        Scene plain = scene;
        set_value(plain, key_of("sea.wind_speed_mps"), wind);
        const SpectralMoments all = sea->at(t)->total();  // of a sea that nobody else keeps
        const auto j =
            jacobian_moments<double>(0.0, 0.0, 0.0, 0.0, {all.xxxx, all.xxxy, all.xxyy, all.xyyy, all.yyyy});
        const double law = law_coverage(plain);
        const double lasting_s = sea->plan().foam->weight(0.0, sea->plan().foam->window_s).foam_s;
        EXPECT_NEAR(whole_coverage(j, now.threshold, true, now.left_per_s * lasting_s), law, 1e-4 * law);
    }
}

}  // namespace
}  // namespace pelagic
