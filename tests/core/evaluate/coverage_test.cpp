// Whitecaps over a square kilometre of sea: as much foam on a coarse mesh as on a fine one, and as much as is observed.
// Shares are of the sea's area, so that each point counts with its own.
#include <gtest/gtest.h>

#include "core/waves/whitecaps.h"
#include "tests/core/waves/samples.h"

namespace pelagic {
namespace {

using namespace test;

double over_area(const Frame<float>& frame, const std::vector<glm::vec2>& points) {
    const auto values = sample(frame, 0, points);
    double foam = 0.0, sea = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const glm::vec3 j = values.vectors(Product::JacobianMoments)[i];
        const double area = sea_area(pelagic::JacobianMoments<double>{j.x, j.y, j.z}, true);
        foam += area * static_cast<double>(values.numbers(Product::Breaking)[i]);
        sea += area;
    }
    return foam / sea;
}

double mean_coverage(double wind_mps, int quads, QualityLevel level = QualityLevel::Final,
                     SpectrumKind spectrum = SpectrumKind::Jonswap) {
    Scene scene;
    scene.effects.foam_decay_s = 0.0;  // all foam breaks now
    scene.quality.level = level;
    scene.sea.wind_speed_mps = wind_mps;
    scene.sea.spectrum = spectrum;
    const auto points =
        rest_points<float>({.per_side = quads, .spacing_m = 1000.0 / quads, .first_m = -500.0});
    const auto wanted = products(Product::Breaking, Product::JacobianMoments);
    return over_area(frame_of<float>(scene, {filtered(wanted, 1000.0 / quads)}, 3.0), points);
}

TEST(WhitecapCoverage, DoesNotDependOnTheGrid) {
    for (double wind : {6.0, 8.0, 10.0, 14.0, 20.0}) {
        const double coarse = mean_coverage(wind, 64);
        for (int quads : {256, 1024}) {
            const double fine = mean_coverage(wind, quads);
            EXPECT_NEAR(fine / coarse, 1.0, 0.1) << "wind " << wind << ", " << quads << " quads";
        }
    }
}

TEST(WhitecapCoverage, IsTheSameAtEveryQualityInSinglePrecision) {
    const double at_final = mean_coverage(8.0, 256);
    for (QualityLevel level : {QualityLevel::Draft, QualityLevel::Preview})
        EXPECT_NEAR(mean_coverage(8.0, 256, level) / at_final, 1.0, 0.01);  // only the sampling differs
}

// The law's, within a factor of 2.
TEST(WhitecapCoverage, IsTheObservedOne) {
    for (double wind : {6.0, 8.0, 10.0, 12.0, 14.0, 17.0, 20.0}) {
        Scene scene;
        scene.sea.wind_speed_mps = wind;
        const double observed = law_coverage(scene), baked = mean_coverage(wind, 256);
        EXPECT_GT(baked, 0.5 * observed) << wind;
        EXPECT_LT(baked, 2.0 * observed) << wind;
    }
}

TEST(WhitecapCoverage, OfOtherSpectraIsTheObservedOneToo) {
    for (SpectrumKind kind :
         {SpectrumKind::PiersonMoskowitz, SpectrumKind::Elfouhaily, SpectrumKind::Omega2}) {
        Scene scene;
        scene.effects.foam_decay_s = 0.0;  // all foam breaks now
        scene.sea.spectrum = kind;
        scene.sea.wind_speed_mps = 12.0;
        const auto frame = frame_of<float>(scene, {filtered(products(Product::Breaking), 2.0)});
        const double baked =
            mean_of(sample(frame, 0, tile_points<float>(1000.0, 300)).numbers(Product::Breaking),
                    [](float w) { return w; });
        const double observed = 2.95e-6 * std::pow(12.0, 3.52);
        EXPECT_GT(baked, 0.5 * observed);
        EXPECT_LT(baked, 2.0 * observed);
    }
}

// Foam lies where the surface is pressed together.
TEST(WhitecapCoverage, FallsWithTheJacobian) {
    Scene scene;
    scene.effects.foam_decay_s = 0.0;  // all foam breaks now
    scene.sea.wind_speed_mps = 15.0;
    const auto frame =
        frame_of<float>(scene, {filtered(products(Product::Breaking, Product::JacobianMoments), 0.5)});
    const auto samples = sample(frame, 0, random_points<float>(500.0, 20000));
    double weighted = 0.0, coverage = 0.0;
    for (std::size_t i = 0; i < samples.numbers(Product::Breaking).size(); ++i) {
        weighted +=
            double(samples.numbers(Product::Breaking)[i]) * samples.vectors(Product::JacobianMoments)[i].x;
        coverage += samples.numbers(Product::Breaking)[i];
    }
    ASSERT_GT(coverage, 0.0);
    EXPECT_LT(weighted / coverage,
              mean_of(samples.vectors(Product::JacobianMoments), [](auto j) { return j.x; }) - 0.1);
}

}  // namespace
}  // namespace pelagic
