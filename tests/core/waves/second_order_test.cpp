// What pairs of waves add: against sums over all pairs, and as a person at a place would count it.
#include "core/waves/second_order.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <string>

#include "tests/core/waves/samples.h"

namespace pelagic {
namespace {

using namespace test;
using Complex = std::complex<double>;

Scene small_sea(double depth_m = std::numeric_limits<double>::infinity()) {
    Scene scene;
    scene.sea.wind_speed_mps = 14.0;
    scene.sea.depth_m = depth_m;
    scene.waves.tiling = Tiling::Periodic;
    const double peak_m = kTwoPi / prepare(scene)->spectrum.peak_wavenumber();
    scene.waves.cascades = {{4.0 * peak_m, 64}};
    return scene;
}

template <class T>
SecondOrderWaves<T> pairs_at(const std::shared_ptr<const Sea<T>>& sea, double t_s) {
    SecondOrderWaves<T> pairs(sea, 0,
                              LineTransform<T>(sea->plan().cascades.front().second_order->resolution));
    pairs.set(t_s);
    return pairs;
}

template <class T>
Complex height(const SecondOrderWaves<T>& pairs, int mx, int my) {
    const PairModes<T> column = pairs.column(mx);
    return {column.height_re[my + column.half_height], column.height_im[my + column.half_height]};
}
template <class T>
Complex rate(const SecondOrderWaves<T>& pairs, int mx, int my) {
    const PairModes<T> column = pairs.column(mx);
    return {column.rate_re[my + column.half_height], column.rate_im[my + column.half_height]};
}

// A wave of the lattice that travels along its k: its amplitude a e^{iψ} at the origin.
struct Travelling {
    int mx, my;
    double k, theta;
    Complex a;
};

std::vector<Travelling> travelling(const Sea<double>& sea, int radius) {
    std::vector<Travelling> waves;
    const Cascade<double>& cascade = sea.cascades().front();
    const double step = kTwoPi / cascade.size_m;
    for (int mx = 0; mx < radius; ++mx)
        for (int my = -half_height(radius, mx); my <= half_height(radius, mx); ++my) {
            if (mx == 0 && my == 0) continue;
            const std::size_t at = cascade.middle(mx) + my;
            const double k = step * std::hypot(mx, my), theta = std::atan2(my, mx);
            waves.push_back(
                {mx, my, k, theta, 2.0 * Complex(cascade.forward_re[at], cascade.forward_im[at])});
            if (mx > 0)
                waves.push_back({-mx, -my, k, theta + kPi,
                                 2.0 * Complex(cascade.backward_re[at], -cascade.backward_im[at])});
        }
    return waves;
}

struct Compared {
    double error = 0.0, largest = 0.0;           // of the transforms, against the same products summed
    double both = 0.0, ours = 0.0, exact = 0.0;  // against the exact kernels: sums of products of amplitudes
    double correlation() const { return both / std::sqrt(ours * exact); }
};

Compared compare(double depth_m) {
    const Scene scene = small_sea(depth_m);
    const auto sea =
        std::make_shared<const Sea<double>>(make_plan(scene, {unfiltered(products(Displacement, Velocity))}));
    const SecondOrderPlan& plan = *sea->plan().cascades.front().second_order;
    const auto pairs = pairs_at(sea, 0.0);
    const std::vector<Travelling> waves = travelling(*sea, plan.radius);
    const int reach = plan.reach, n = 2 * reach - 1;
    // h(k) of ½ [A e^{ikx} + conj]: sums over pairs by k, of our kernels and of the exact ones.
    std::vector<Complex> product(n * n), exact(n * n);
    const auto add = [&](std::vector<Complex>& to, int mx, int my, Complex value) {
        if (std::abs(mx) >= reach || std::abs(my) >= reach) return;
        to[(my + reach - 1) * n + mx + reach - 1] += value;
        to[(reach - 1 - my) * n + reach - 1 - mx] += std::conj(value);
    };
    for (const Travelling& i : waves)
        for (const Travelling& j : waves) {
            const double cosine = std::cos(i.theta - j.theta), root = std::sqrt(i.k * j.k);
            const double slow =
                plan.shallow > 0.0
                    ? std::sqrt(shallow_wavenumber(i.k, depth_m) * shallow_wavenumber(j.k, depth_m))
                    : 0.0;
            const PairKernels kernels = pair_kernels(i.k, i.theta, j.k, j.theta, depth_m);
            const Complex minus = 0.5 * i.a * std::conj(j.a), plus = 0.5 * i.a * j.a;
            add(product, i.mx - j.mx, i.my - j.my, plan.difference * root * (1.0 + cosine) * minus);
            add(product, i.mx + j.mx, i.my + j.my,
                (plan.sum * root * (1.0 - cosine) + plan.shallow * slow) * plus);
            add(exact, i.mx - j.mx, i.my - j.my, 0.25 * kernels.difference * minus);
            add(exact, i.mx + j.mx, i.my + j.my, 0.25 * kernels.sum * plus);
        }
    Compared compared;
    for (int mx = 0; mx < reach; ++mx)
        for (int my = -half_height(reach, mx); my <= half_height(reach, mx); ++my) {
            if (mx == 0 && my == 0) continue;
            const int at = (my + reach - 1) * n + mx + reach - 1;
            const Complex ours = height(pairs, mx, my);
            compared.error = std::max(compared.error, std::abs(ours - product[at]));
            compared.largest = std::max(compared.largest, std::abs(ours));
            compared.both += (ours * std::conj(exact[at])).real();
            compared.ours += std::norm(ours);
            compared.exact += std::norm(exact[at]);
        }
    return compared;
}

TEST(Pairs, AreTheSumsOfTheirProducts) {
    for (double depth_m : {std::numeric_limits<double>::infinity(), 25.0}) {
        const Compared compared = compare(depth_m);
        EXPECT_GT(compared.largest, 0.01);
        EXPECT_LT(compared.error, 1e-9 * compared.largest) << depth_m;
    }
}

TEST(Pairs, AreNearlyThoseOfTheExactKernels) {
    const Compared compared = compare(std::numeric_limits<double>::infinity());
    EXPECT_GT(compared.correlation(), 0.93);
    // Ours stand for the pairs with the waves of the three last bins as well.
    EXPECT_NEAR(std::sqrt(compared.ours / compared.exact), (16.0 / 13.0) * (16.0 / 13.0), 0.1);
}

TEST(Pairs, HaveTheirHeightsRate) {
    const auto sea = std::make_shared<const Sea<double>>(
        make_plan(small_sea(25.0), {unfiltered(products(Displacement, Velocity))}));
    const double step_s = 1e-3;
    const auto before = pairs_at(sea, 7.0 - step_s), at = pairs_at(sea, 7.0),
               after = pairs_at(sea, 7.0 + step_s);
    double largest = 0.0, error = 0.0;
    ASSERT_GT(at.reach(), at.radius());
    for (int mx = 0; mx < at.reach(); ++mx)
        for (int my = -half_height(at.reach(), mx); my <= half_height(at.reach(), mx); ++my) {
            const Complex difference = (height(after, mx, my) - height(before, mx, my)) / (2.0 * step_s);
            error = std::max(error, std::abs(difference - rate(at, mx, my)));
            largest = std::max(largest, std::abs(difference));
        }
    EXPECT_GT(largest, 1e-3);
    EXPECT_LT(error, 1e-5 * largest);
}

// What pairs add depends on the spectrum and the sizes of the tiles, not on who looks.
TEST(Pairs, AreTheSameAtEveryResolution) {
    Scene scene;
    scene.sea.wind_speed_mps = 20.0;
    const auto of = [&](double footprint_m) {
        return std::make_shared<const Sea<float>>(
            make_plan(scene, {filtered(products(Displacement), footprint_m)}));
    };
    const auto fine = of(0.5), coarse = of(20.0);
    const auto a = pairs_at(fine, 3.0), b = pairs_at(coarse, 3.0);
    ASSERT_EQ(a.reach(), b.reach());
    for (int mx = 0; mx < a.reach(); ++mx)
        for (int my = -half_height(a.reach(), mx); my <= half_height(a.reach(), mx); ++my)
            ASSERT_EQ(height(a, mx, my), height(b, mx, my));
}

// Lines of transforms beside those of the grids, as many as the plan says.
TEST(Pairs, CostWhatThePlanSays) {
    Scene scene;
    const std::vector<Query> asked{unfiltered(products(Displacement, Velocity))};
    const Plan plan = make_plan(scene, asked), alone = make_plan(first_order(scene), asked);
    const SecondOrderPlan& pairs = *plan.cascades.front().second_order;
    EXPECT_EQ(pairs.transforms(), 8);  // three sums, what comes of them, and all their rates
    EXPECT_EQ(plan.lines_per_frame() - alone.lines_per_frame(),
              6 * (2 * pairs.radius - 1 + pairs.resolution) + 2 * (pairs.reach + pairs.resolution));
    auto frame = frame_of<float>(scene, plan);
    frame.set(1.0);
    EXPECT_EQ(frame.executed_lines(), 2 * plan.lines_per_frame());
    EXPECT_GE(pairs.resolution, 2 * pairs.radius + pairs.reach - 2);
}

TEST(Pairs, AreAskedForByHeightsAlone) {
    Scene scene;
    const auto has = [](const Plan& plan) {
        for (const CascadePlan& cascade : plan.cascades)
            if (cascade.second_order) return true;
        return false;
    };
    EXPECT_TRUE(has(make_plan(scene, {unfiltered(products(Displacement))})));
    EXPECT_TRUE(has(make_plan(scene, {unfiltered(products(Normal))})));
    EXPECT_FALSE(has(make_plan(scene, {unfiltered(products(Product::JacobianMoments))})));
    scene.waves.choppiness = 0.0;
    EXPECT_FALSE(has(make_plan(scene, {unfiltered(products(Displacement))})));
    scene = {};
    scene.waves.second_order = 0.0;
    EXPECT_FALSE(has(make_plan(scene, {unfiltered(products(Displacement))})));
    scene = {};
    scene.sea.wind_speed_mps = 0.0;
    EXPECT_FALSE(has(make_plan(scene, {unfiltered(products(Displacement))})));
}

// The elevation over places of the world: points at rest, weighted by the area that they come to cover.
struct Moments {
    double mean = 0.0, variance = 0.0, skewness = 0.0;
};
Moments over_places(const std::vector<glm::vec3>& moved, int n, double spacing_m) {
    double area = 0.0, sums[3]{};
    const auto at = [&](int x, int y) { return moved[((y + n) % n) * n + (x + n) % n]; };
    for (int pass = 0; pass < 2; ++pass) {
        const double mean = pass ? sums[0] / area : 0.0;
        area = sums[0] = sums[1] = sums[2] = 0.0;
        for (int y = 0; y < n; ++y)
            for (int x = 0; x < n; ++x) {
                const glm::dvec3 dx = glm::dvec3(at(x + 1, y) - at(x - 1, y)) / (2.0 * spacing_m),
                                 dy = glm::dvec3(at(x, y + 1) - at(x, y - 1)) / (2.0 * spacing_m);
                const double j = (1.0 + dx.x) * (1.0 + dy.y) - dx.y * dy.x, z = at(x, y).z - mean;
                area += j;
                sums[0] += j * z;
                sums[1] += j * z * z;
                sums[2] += j * z * z * z;
            }
    }
    return {sums[0] / area, sums[1] / area, sums[2] / area};
}

struct Skewness {
    Estimate found;
    double law, first_order;
};
Skewness skewness_over_places(double wind_mps, Tiling tiling,
                              double depth_m = std::numeric_limits<double>::infinity()) {
    Scene scene;
    scene.sea.wind_speed_mps = wind_mps;
    scene.sea.depth_m = depth_m;
    if (std::isfinite(depth_m)) scene.sea.spectrum = SpectrumKind::Tma;
    scene.waves.tiling = tiling;
    const double peak_m = kTwoPi / prepare(scene)->spectrum.peak_wavenumber();
    const double size_m = (tiling == Tiling::Random ? 64.0 : 16.0) * peak_m;
    const int n = tiling == Tiling::Random ? 512 : 160;
    scene.waves.cascades = {{16.0 * peak_m, 128}};
    const auto points = tile_points<float>(size_m, n);
    std::vector<double> with, without;
    Skewness result{};
    for (double gain : {1.0, 0.0}) {
        scene.waves.second_order = gain;
        std::vector<double>& to = gain > 0.0 ? with : without;
        for (int seed = 1; seed <= (tiling == Tiling::Random ? 2 : 8); ++seed) {
            scene.shot.seed = seed;
            const Plan plan = make_plan(scene, {unfiltered(products(Displacement))});
            if (gain > 0.0) result.law = plan.from->second_order.skewness();
            auto frame = frame_of<float>(scene, plan);
            for (int i = 0; i < 4; ++i) {
                frame.set(97.0 * i);
                const Moments of = over_places(sample(frame, 0, points).vectors(Displacement), n, size_m / n);
                to.push_back(of.skewness / std::pow(of.variance, 1.5));
            }
        }
    }
    result.found = estimate(with);
    result.first_order = estimate(without).mean;
    return result;
}

// The same waves without their pairs have the same chances in them: what pairs add is known better than either.
TEST(Pairs, MakeHeightsOverAPlaceAsSkewAsTheSecondOrderSays) {
    for (double wind_mps : {10.0, 25.0}) {
        const Skewness skewness = skewness_over_places(wind_mps, Tiling::Periodic);
        RecordProperty("wind_" + std::to_string(static_cast<int>(wind_mps)),
                       std::to_string(skewness.found.mean - skewness.first_order) + " of " +
                           std::to_string(skewness.law));
        EXPECT_GT(skewness.law, 0.12);
        EXPECT_LT(skewness.law, 0.3);
        EXPECT_NEAR(skewness.found.mean - skewness.first_order, skewness.law, 0.2 * skewness.law)
            << wind_mps << " m/s: " << skewness.found.mean << " ± " << skewness.found.standard_error
            << " and " << skewness.first_order;
    }
}

// Of the highest waves over 3 m the pairs' waves are half as long: a sixth of their skewness is lost where they end with those that
// are paired.
TEST(Pairs, MakeHeightsOverShallowWaterAsSkewAsTheSecondOrderSays) {
    const Skewness skewness = skewness_over_places(10.0, Tiling::Periodic, 3.0);
    RecordProperty("found", std::to_string(skewness.found.mean - skewness.first_order) + " of " +
                                std::to_string(skewness.law));
    EXPECT_GT(skewness.law, 0.4);
    // Found: 1.09 of the law, and 0.82 where pairs' waves end with those that are paired.
    EXPECT_NEAR(skewness.found.mean - skewness.first_order, skewness.law, 0.15 * skewness.law)
        << skewness.found.mean << " ± " << skewness.found.standard_error << " and " << skewness.first_order;
}

// Where copies of a tile are blended heights are a little less skew, as sums of independent ones are.
TEST(Pairs, KeepMostOfTheirSkewnessWhereTilesBlend) {
    const Skewness skewness = skewness_over_places(20.0, Tiling::Random);
    EXPECT_NEAR(skewness.found.mean - skewness.first_order, 0.95 * skewness.law, 0.2 * skewness.law)
        << skewness.found.mean << " and " << skewness.first_order << ", law " << skewness.law;
}

}  // namespace
}  // namespace pelagic
