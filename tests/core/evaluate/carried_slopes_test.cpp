// Unresolved slopes ride on the waves that are shown: Σ′ = M⁻ᵀ Σ M⁻¹.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include "core/base/number.h"
#include "core/plan/unresolved_slopes.h"
#include "core/spectrum/directional_spectrum.h"
#include "core/spectrum/spectral_moments.h"
#include "tests/core/waves/samples.h"

namespace pelagic {
namespace {

#include "core/evaluate/surface.inl"

using namespace test;

Scene sea(WaveModel model) {
    Scene scene;
    scene.sea.wind_speed_mps = 12.0;
    scene.sea.wind_direction_deg = 25.0;
    scene.waves.model = model;
    return scene;
}

// What a footprint hides, as plane waves of random directions and phases: heights only.
class UnresolvedHeights {
  public:
    UnresolvedHeights(const DirectionalSpectrum& spectrum, double footprint_m, int seed) {
        constexpr int kBands = 160;
        const FootprintFilter filter;
        std::mt19937 numbers(static_cast<unsigned>(seed));
        std::uniform_real_distribution<double> uniform(0.0, 1.0);
        const double first = kPi / footprint_m / 4.0, last = spectrum.panels().back();
        const double ratio = std::pow(last / first, 1.0 / kBands);
        for (int i = 0; i < kBands; ++i) {
            const double from = first * std::pow(ratio, i), k = from * std::sqrt(ratio);
            const double w = filter.weight(k, footprint_m);
            const double energy = spectrum.omnidirectional(k) * from * (ratio - 1.0) * (1.0 - w * w);
            const double wanted = uniform(numbers) * spectrum.arc(k, -kPi, kPi);
            double low = -kPi, high = kPi;
            for (int step = 0; step < 40; ++step) {
                const double middle = 0.5 * (low + high);
                (spectrum.arc(k, -kPi, middle) < wanted ? low : high) = middle;
            }
            waves_.push_back(
                {k * std::cos(low), k * std::sin(low), std::sqrt(2.0 * energy), kTwoPi * uniform(numbers)});
        }
    }
    double at(glm::dvec2 x) const {
        double sum = 0.0;
        for (const Plane& wave : waves_)
            sum += wave.height_m * std::cos(wave.kx * x.x + wave.ky * x.y + wave.phase);
        return sum;
    }

  private:
    struct Plane {
        double kx, ky, height_m, phase;
    };
    std::vector<Plane> waves_;
};

// Facets of a mesh far finer than any wave: the slopes that its heights get from the unresolved waves, and J from its area.
struct Bin {
    double count = 0.0, mesh = 0.0, answered = 0.0, at_rest = 0.0;
};

std::array<Bin, 20> by_compression(WaveModel model) {
    constexpr int kFacets = 20000;
    constexpr double kSide_m = 1e-5;
    const Scene scene = sea(model);
    Query query =
        filtered(products(Product::Displacement, Product::SlopeVariance, Product::SlopeVarianceAtRest), 0.25);
    const auto frame = frame_of<double>(scene, {query}, 3.0);
    const auto rest = random_points<double>(2000.0, kFacets);
    std::vector<glm::dvec2> corners;
    for (const glm::dvec2& x : rest)
        corners.insert(corners.end(), {x, x + glm::dvec2(kSide_m, 0.0), x + glm::dvec2(0.0, kSide_m)});
    const auto samples = sample(frame, 0, corners);
    const UnresolvedHeights unresolved(frame.sea().plan().from->spectrum, query.pixel_m.front(), 7);
    struct Facet {
        double j, mesh, answered, at_rest;
    };
    std::vector<Facet> facets;
    for (std::size_t i = 0; i < rest.size(); ++i) {
        const auto corner = [&](std::size_t c) {
            const glm::dvec3 d = samples.vectors(Displacement)[3 * i + c];
            return glm::dvec3(corners[3 * i + c] - rest[i], unresolved.at(corners[3 * i + c])) +
                   glm::dvec3(d.x, d.y, 0.0);
        };
        const glm::dvec3 a = corner(1) - corner(0), b = corner(2) - corner(0);
        const double area = a.x * b.y - a.y * b.x;
        const double slope_x = (a.z * b.y - b.z * a.y) / area, slope_y = (b.z * a.x - a.z * b.x) / area;
        const glm::dvec3 answer = samples.vectors(SlopeVariance)[3 * i],
                         still = samples.vectors(SlopeVarianceAtRest)[3 * i];
        facets.push_back({area / (kSide_m * kSide_m), slope_x * slope_x + slope_y * slope_y,
                          answer.x + answer.y, still.x + still.y});
    }
    std::erase_if(facets, [](const Facet& f) { return f.j < 0.1; });
    std::sort(facets.begin(), facets.end(), [](const Facet& a, const Facet& b) { return a.j < b.j; });
    std::array<Bin, 20> bins;
    for (std::size_t i = 0; i < facets.size(); ++i) {
        Bin& bin = bins[i * bins.size() / facets.size()];
        bin.count += 1.0;
        bin.mesh += facets[i].mesh;
        bin.answered += facets[i].answered;
        bin.at_rest += facets[i].at_rest;
    }
    return bins;
}

// Target: within 10 % in each twentieth of the facets, by compression. At rest × 0.7 … 1.4.
TEST(CarriedSlopes, AreThoseOfAFineMeshByCompression) {
    for (const WaveModel model : {WaveModel::Fft, WaveModel::Trochoid}) {
        double low = 1e9, high = 0.0, low_rest = 1e9, high_rest = 0.0;
        for (const Bin& bin : by_compression(model)) {
            const double ratio = bin.mesh / bin.answered, rest = bin.mesh / bin.at_rest;
            EXPECT_NEAR(ratio, 1.0, 0.1);
            low = std::min(low, ratio);
            high = std::max(high, ratio);
            low_rest = std::min(low_rest, rest);
            high_rest = std::max(high_rest, rest);
        }
        std::printf(
            "    %s: unresolved mss of a mesh over what is answered, by compression: %.2f … %.2f; at rest %.2f … %.2f\n",
            model == WaveModel::Fft ? "cascades" : "trains", low, high, low_rest, high_rest);
        EXPECT_GT(high_rest, 1.2) << "the test has something to see";
        EXPECT_LT(low_rest, 0.9);
    }
}

// What `explain` prints.
TEST(CarriedSlopes, GainOverAreaAsExpected) {
    for (const WaveModel model : {WaveModel::Fft, WaveModel::Trochoid}) {
        const Scene scene = sea(model);
        const double footprint_m = 0.25;
        const auto frame = frame_of<float>(
            scene,
            {filtered(
                products(Product::JacobianMoments, Product::SlopeVariance, Product::SlopeVarianceAtRest),
                footprint_m)},
            2.0);
        const auto samples = sample(frame, 0, random_points<float>(3000.0, 40000));
        double carried = 0.0, area = 0.0;
        for (std::size_t i = 0; i < 40000; ++i) {
            const double j = samples.vectors(Product::JacobianMoments)[i].x;
            const glm::dvec3 v(samples.vectors(SlopeVariance)[i]);
            carried += j * (v.x + v.y);
            area += j;
        }
        const glm::dvec3 rest(samples.vectors(SlopeVarianceAtRest)[0]);
        const double gain = carried / area / (rest.x + rest.y);
        const double expected =
            unresolved_slope_gain(frame.sea().plan().from->spectrum, FootprintFilter{}, footprint_m, 1.0);
        std::printf("    gain over area of sea %.4f, expected %.4f\n", gain, expected);
        EXPECT_NEAR(gain, expected, 0.005);
        EXPECT_GT(expected, 1.01);
        EXPECT_LT(expected, 1.05);
    }
}

TEST(CarriedSlopes, AreThoseAtRestToTheBitWithoutChoppiness) {
    for (const WaveModel model : {WaveModel::Fft, WaveModel::Trochoid}) {
        Scene scene = sea(model);
        scene.waves.choppiness = 0.0;
        const auto frame = frame_of<float>(
            scene, {filtered(products(Product::SlopeVariance, Product::SlopeVarianceAtRest), 0.5)}, 1.0);
        const auto samples = sample(frame, 0, random_points<float>(100.0, 50));
        for (std::size_t i = 0; i < 50; ++i)
            EXPECT_EQ(samples.vectors(SlopeVariance)[i], samples.vectors(SlopeVarianceAtRest)[i]);
    }
}

// The formula itself, against M⁻ᵀ Σ M⁻¹ multiplied out, also where Dxy and Dyx differ.
TEST(CarriedSlopes, AreTheTensorTransformed) {
    const SlopeVariances<double> rest{0.03, 0.02, 0.01};
    for (const double dxx : {-0.5, 0.0, 0.7})
        for (const double dyy : {-0.4, 0.2})
            for (const double dxy : {-0.2, 0.0, 0.3})
                for (const double dyx : {-0.2, 0.1}) {
                    const double j = (1.0 + dxx) * (1.0 + dyy) - dxy * dyx;
                    ASSERT_GT(j, 0.1);
                    // Columns of M⁻¹, rows of M⁻ᵀ.
                    const glm::dvec2 one(glm::dvec2(1.0 + dyy, -dyx) / j),
                        two(glm::dvec2(-dxy, 1.0 + dxx) / j);
                    const auto product = [&](glm::dvec2 a, glm::dvec2 b) {
                        return a.x * (rest.xx * b.x + rest.xy * b.y) + a.y * (rest.xy * b.x + rest.yy * b.y);
                    };
                    const auto got = carried_slopes(rest, dxx, dyy, dxy, dyx);
                    EXPECT_NEAR(got.xx, product(one, one), 1e-12);
                    EXPECT_NEAR(got.yy, product(two, two), 1e-12);
                    EXPECT_NEAR(got.xy, product(one, two), 1e-12);
                }
}

// Waves of nearly one direction stay that, and one of the variances may be a small difference of large terms: rounding made of them
// what no slopes have.
TEST(CarriedSlopes, ArePossibleHoweverTheyAreRounded) {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> uniform(-1.0f, 1.0f);
    for (int i = 0; i < 200000; ++i) {
        const float xx = std::exp(8.0f * uniform(random)), yy = std::exp(8.0f * uniform(random)),
                    bound = std::sqrt(xx * yy) * (1.0f - std::exp(-8.0f - 8.0f * uniform(random))),
                    xy = i % 2 == 0 ? bound : -bound;
        const auto v = carried_slopes(SlopeVariances<float>{xx, yy, xy}, 2.0f * uniform(random),
                                      2.0f * uniform(random), 2.0f * uniform(random), 2.0f * uniform(random));
        ASSERT_GE(v.xx, 0.0f);
        ASSERT_GE(v.yy, 0.0f);
        ASSERT_LE(std::abs(v.xy), (1.0f + 1e-6f) * std::sqrt(v.xx) * std::sqrt(v.yy));
    }
}

// A crest that folds has J ≤ 0: finite, a possible tensor, and no jump where the floor begins.
TEST(CarriedSlopes, AreFiniteWhereTheSurfaceFolds) {
    const SlopeVariances<float> rest{0.03f, 0.02f, 0.01f};
    for (const float dxx : {-0.95f, -1.0f, -1.05f, -3.0f, -1e3f})
        for (const float dyy : {0.0f, -1.0f, 1e3f})
            for (const float dxy : {0.0f, 1.0f, -1e3f}) {
                const auto v = carried_slopes(rest, dxx, dyy, dxy, dxy);
                ASSERT_TRUE(std::isfinite(v.xx) && std::isfinite(v.yy) && std::isfinite(v.xy))
                    << dxx << dyy << dxy;
                EXPECT_GE(v.xx, 0.0f);
                EXPECT_GE(v.yy, 0.0f);
                EXPECT_LE(std::abs(v.xy), (1.0f + 1e-6f) * std::sqrt(v.xx) * std::sqrt(v.yy));
            }
    const auto above = carried_slopes(rest, -0.8999f, 0.0f, 0.0f, 0.0f),
               below = carried_slopes(rest, -0.9001f, 0.0f, 0.0f, 0.0f);
    EXPECT_NEAR(above.xx / below.xx, 1.0f, 0.01f);
    EXPECT_EQ(carried_slopes(rest, -1.0f, -1.0f, 0.0f, 0.0f).xx, 0.0f);
}

}  // namespace
}  // namespace pelagic
