// Cascades whose waves have a choppiness of their own, against sums over modes, points of our own and integrals.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/evaluate/bounds.h"
#include "core/plan/mesh_error_model.h"
#include "core/plan/unresolved_slopes.h"
#include "core/scene/cascade_bands.h"
#include "core/waves/breaking_rate.h"
#include "core/waves/folding.h"
#include "core/waves/whitecaps.h"
#include "tests/core/waves/samples.h"

namespace pelagic {
namespace {

using namespace test;

constexpr double kInfinite = std::numeric_limits<double>::infinity();

// Two tiles, of waves of 9 m and more and of shorter ones, that both matter to heights and gradients.
Scene choppy_scene(std::optional<double> large, std::optional<double> small, double shots = 1.0) {
    Scene scene = first_order();
    scene.effects.foam_decay_s = 0.0;  // all foam breaks now
    scene.sea.wind_speed_mps = 9.0;
    scene.sea.fetch_m = 20e3;
    scene.sea.depth_m = 6.0;
    scene.waves.choppiness = shots;
    scene.waves.tiling = Tiling::Periodic;
    scene.waves.cascades = {{200.0, 96, large}, {71.0, 96, small}};
    return scene;
}
// λ of each of its cascades.
double choppiness_of(const Scene& scene, std::size_t cascade) {
    return scene.waves.cascades[cascade].choppiness.value_or(scene.waves.choppiness);
}

const ProductSet kAll =
    products(Position, Normal, Velocity, SlopeVariance, Product::JacobianMoments, Product::Breaking);

TEST(ChoppinessOfCascades, OfEqualOnesIsTheShotsToTheBit) {
    const auto points = random_points<float>(500.0, 300);
    for (const Tiling tiling : {Tiling::Periodic, Tiling::Random})
        for (const double choppiness : {0.0, 1e-5, 0.7, 10.0}) {
            SCOPED_TRACE(choppiness);
            Scene whole = choppy_scene({}, {}, choppiness), part = choppy_scene({}, choppiness, choppiness),
                  each = choppy_scene(choppiness, choppiness, 1.3);
            std::vector<ProductArrays<float>> answers;
            std::vector<std::shared_ptr<const PreparedScene>> prepared;
            std::vector<double> thresholds, errors;
            for (Scene* scene : {&whole, &part, &each}) {
                scene->waves.tiling = tiling;
                Query levels = filtered(kAll, 0.0);
                levels.cell_m = levels.pixel_m = {0.5, 1.0, 2.0};
                const auto frame = frame_of<float>(*scene, {levels}, 2.0);
                Where<float> where;
                where.pixel_m.assign(points.size(), 0.8f);
                answers.push_back(sample(frame, 0, points, where));
                prepared.push_back(prepare(*scene));
                EXPECT_EQ(prepared.back()->extent.reach_m,
                          expected_extent(prepared.back()->spectrum, choppiness).reach_m);
                thresholds.push_back(frame.sea().whitecap_threshold());
                errors.push_back(MeshErrorModel(*prepared.back()).error(2.0, 0.0, Drawn::Triangles));
            }
            for (std::size_t other : {1, 2}) {
                EXPECT_EQ(prepared[0]->extent.reach_m, prepared[other]->extent.reach_m);
                EXPECT_EQ(thresholds[0], thresholds[other]);
                EXPECT_EQ(errors[0], errors[other]);
                EXPECT_EQ(answers[0].vectors(Position), answers[other].vectors(Position));
                EXPECT_EQ(answers[0].vectors(Normal), answers[other].vectors(Normal));
                EXPECT_EQ(answers[0].vectors(Velocity), answers[other].vectors(Velocity));
                EXPECT_EQ(answers[0].vectors(SlopeVariance), answers[other].vectors(SlopeVariance));
                EXPECT_EQ(answers[0].vectors(Product::JacobianMoments),
                          answers[other].vectors(Product::JacobianMoments));
                EXPECT_EQ(answers[0].numbers(Product::Breaking), answers[other].numbers(Product::Breaking));
            }
        }
}

// Of one point at rest, by the sum over all modes of both tiles (Tessendorf 2001, Eqs. 19 and 29, displaced towards crests).
struct Summed {
    glm::dvec3 displacement{0.0};
    double xx = 0.0, yy = 0.0, xy = 0.0;  // gradients
    double jacobian() const { return (1.0 + xx) * (1.0 + yy) - xy * xy; }
};
class Sum {
  public:
    Sum(const Sea<double>& sea, const Scene& scene, double t_s) {
        for (std::size_t c = 0; c < scene.waves.cascades.size(); ++c) {
            const CascadeSize& cascade = scene.waves.cascades[c];
            Tile& tile = tiles_.emplace_back();
            tile.step = kTwoPi / cascade.size_m;
            tile.rows = cascade.resolution / 2 + 1;
            for (const Mode& mode : modes_of(sea, static_cast<int>(c), t_s))
                tile.waves.push_back(
                    {mode, choppiness_of(scene, c) / std::tanh(mode.k * scene.sea.depth_m) / mode.k});
        }
    }
    Summed at(glm::dvec2 x) const {
        Summed sum;
        for (const Tile& tile : tiles_) {
            // e^{ik·x} is the product of its column's and its row's.
            std::array<std::vector<std::complex<double>>, 2> turns;
            for (int axis = 0; axis < 2; ++axis)
                for (int m = 0; m < tile.rows; ++m)
                    turns[axis].push_back(std::polar(1.0, m * tile.step * x[axis]));
            for (const auto& [mode, chop] : tile.waves) {
                const glm::dvec2 k = tile.step * glm::dvec2(mode.mx, mode.my);
                const std::complex<double> row = turns[1][std::abs(mode.my)];
                const std::complex<double> wave =
                    2.0 * mode.height * turns[0][mode.mx] * (mode.my < 0 ? std::conj(row) : row);
                const double crest = wave.real(), turned = wave.imag();
                sum.displacement += glm::dvec3(-chop * turned * k, crest);
                sum.xx -= chop * k.x * k.x * crest;
                sum.yy -= chop * k.y * k.y * crest;
                sum.xy -= chop * k.x * k.y * crest;
            }
        }
        return sum;
    }

  private:
    struct Tile {
        double step = 0.0;  // [rad/m] from mode to mode
        int rows = 0;
        std::vector<std::pair<Mode, double>> waves;  // with λ coth(kd)/k [m]
    };
    std::vector<Tile> tiles_;
};

TEST(ChoppinessOfCascades, MovesEachOnesOwnWaves) {
    constexpr double kTime_s = 7.3;
    const auto points = random_points<double>(300.0, 60);
    for (Scene scene : {choppy_scene(0.3, {}, 1.2), choppy_scene({}, 0.0, 1.2), choppy_scene(0.0, 10.0),
                        choppy_scene(10.0, 0.0)}) {
        SCOPED_TRACE(choppiness_of(scene, 1));
        scene.effects.breaking_from_m = 0.0;
        scene.quality.level = QualityLevel::Reference;
        const auto frame = frame_of<double>(
            scene, {unfiltered(products(Displacement, Velocity, Product::JacobianMoments))}, kTime_s);
        const auto found = sample(frame, 0, points);
        constexpr double kStep_s = 1e-4;
        const Sum now(frame.sea(), scene, kTime_s), before(frame.sea(), scene, kTime_s - kStep_s),
            after(frame.sea(), scene, kTime_s + kStep_s);
        for (std::size_t i = 0; i < points.size(); ++i) {
            const Summed wanted = now.at(points[i]);
            const glm::dvec3 moved = found.vectors(Displacement)[i], velocity = found.vectors(Velocity)[i];
            const glm::dvec3 rate =
                (after.at(points[i]).displacement - before.at(points[i]).displacement) / (2.0 * kStep_s);
            for (int axis = 0; axis < 3; ++axis) {
                ASSERT_NEAR(moved[axis], wanted.displacement[axis], 1e-4) << i;
                ASSERT_NEAR(velocity[axis], rate[axis], 1e-3) << i;
            }
            ASSERT_NEAR(found.vectors(Product::JacobianMoments)[i].x, wanted.jacobian(),
                        2e-4 * (1.0 + std::abs(wanted.jacobian())))
                << i;
        }
    }
}

// A tile without choppiness takes no transform for what is 0, and without any choppiness there is none at all.
TEST(ChoppinessOfCascades, CostsNothingWhereItIsZero) {
    const auto fields_of_tile = [](const Plan& plan, std::size_t c) {
        FieldSet fields;
        for (const Grid& grid : plan.cascades[c].grids) fields |= grid.fields;
        return fields;
    };
    const std::vector<Query> queries{unfiltered(kAll)};
    const Plan mixed = make_plan(choppy_scene({}, 0.0), queries),
               none = make_plan(choppy_scene(0.0, 0.0), queries);
    EXPECT_EQ(fields_of_tile(mixed, 0) & horizontal_fields(), horizontal_fields());
    EXPECT_EQ(fields_of_tile(mixed, 1),
              fields(Field::Height, Field::SlopeX, Field::SlopeY, Field::VelocityZ));
    EXPECT_EQ(fields_of_tile(none, 1) & horizontal_fields(), displacement_gradient_fields());
    const std::string page = explain(mixed);
    EXPECT_NE(page.find("1  71 m, resolution 96, choppiness 0, waves of"), std::string::npos) << page;
    EXPECT_NE(page.find("0  200 m, resolution 96, waves of"), std::string::npos) << page;
}

// Nor is it read there, wherever points have no, round or long footprints: the answers are those of next to no choppiness.
TEST(ChoppinessOfCascades, IsNotReadWhereItIsZero) {
    const auto points = random_points<float>(400.0, 500);
    for (const Tiling tiling : {Tiling::Periodic, Tiling::Random})
        for (const bool is_large : {false, true}) {
            SCOPED_TRACE(is_large);
            std::vector<ProductArrays<float>> answers;
            for (const double choppiness : {0.0, Choppiness::kLeastShown}) {
                Scene scene = is_large ? choppy_scene(choppiness, 1.0) : choppy_scene(1.0, choppiness);
                scene.waves.tiling = tiling;
                Query query = filtered(kAll, 0.0);
                query.cell_m = query.pixel_m = {0.25, 0.5, 1.0, 2.0, 4.0, 8.0};
                const auto frame = frame_of<float>(scene, {query}, 2.0);
                std::vector<float> width_m;
                std::vector<glm::vec2> axis_m;
                for (std::size_t i = 0; i < points.size(); ++i) {
                    const float turn = static_cast<float>(i), ratio = i % 2 == 0 ? 1.0f : 6.0f;
                    width_m.push_back(0.3f * static_cast<float>(1 + i % 8));
                    axis_m.push_back(ratio * width_m.back() * glm::vec2(std::cos(turn), std::sin(turn)));
                }
                answers.emplace_back().resize(kAll, points.size());
                evaluate(frame, 0,
                         Points<float>{.count = points.size(),
                                       .rest_m = {points.data()},
                                       .cell_m = {width_m.data()},
                                       .pixel_m = {width_m.data()},
                                       .cell_axis_m = {axis_m.data()},
                                       .pixel_axis_m = {axis_m.data()}},
                         answers.back().results());
            }
            const auto expect_near = [&](const auto& none, const auto& least, float tolerance) {
                for (std::size_t i = 0; i < points.size(); ++i)
                    ASSERT_LT(glm::length(none[i] - least[i]), tolerance) << i;
            };
            const auto &none = answers[0], &least = answers[1];
            expect_near(none.vectors(Position), least.vectors(Position), 1e-3f);
            expect_near(none.vectors(Normal), least.vectors(Normal), 1e-3f);
            expect_near(none.vectors(Velocity), least.vectors(Velocity), 1e-3f);
            expect_near(none.vectors(SlopeVariance), least.vectors(SlopeVariance), 1e-3f);
            expect_near(none.vectors(Product::JacobianMoments), least.vectors(Product::JacobianMoments),
                        1e-3f);
            expect_near(none.numbers(Product::Breaking), least.numbers(Product::Breaking), 1e-2f);
        }
}

// J of points of our own, against what a footprint that hides all waves says of it.
TEST(ChoppinessOfCascades, JacobianAndFoamAreThoseOfPoints) {
    const auto points = random_points<double>(4000.0, 10000);
    for (const auto& [large, small] : {std::pair(0.4, 1.3), std::pair(1.6, 0.5), std::pair(1.5, 0.0)}) {
        SCOPED_TRACE(large);
        Scene scene = choppy_scene(large, small);
        scene.sea.wind_speed_mps = 12.0;
        scene.effects.breaking_from_m = 0.0;
        scene.waves.band_gains = {{1e-3, 1.5, 0.0}};  // what no tile shows
        const ProductSet foam = products(Product::JacobianMoments, Product::Breaking);
        const auto frame = frame_of<double>(scene, {filtered(foam, 0.0), filtered(foam, 1e3)});
        const Sum sum(frame.sea(), scene, 0.0);
        const auto fine = sample(frame, 0, {points[0]}), coarse = sample(frame, 1, {points[0]});
        const double threshold = frame.sea().whitecap_threshold();
        double mean = 0.0, square = 0.0, foamy = 0.0, area = 0.0;
        const double each = 1.0 / static_cast<double>(points.size());
        for (const glm::dvec2 point : points) {
            const double j = sum.at(point).jacobian(), own = std::max(j, 0.0);
            mean += each * j;
            square += each * (j - 1.0) * (j - 1.0);
            area += own;
            foamy += j < threshold ? own : 0.0;
        }
        const glm::dvec3 expected = coarse.vectors(Product::JacobianMoments)[0];
        EXPECT_LT(fine.vectors(Product::JacobianMoments)[0].y, 0.01 * expected.y);  // points see all of it
        EXPECT_NEAR(mean, expected.x, 0.005);
        EXPECT_NEAR((square - (mean - 1.0) * (mean - 1.0)) / expected.y, 1.0, 0.08);  // one sea of many
        EXPECT_NEAR(foamy / area / coarse.numbers(Product::Breaking)[0], 1.0, 0.15);
        // And by the integral over each band.
        const DirectionalSpectrum& spectrum = frame.sea().plan().from->spectrum;
        const double edge = lower_edges(std::vector{200.0, 71.0})[1];
        const SpectralMoments of_large = moments(spectrum, 0.0, edge),
                              of_small = moments(spectrum, edge, kInfinite);
        const auto trace = [](const SpectralMoments& of) { return of.xxxx + 2.0 * of.xxyy + of.yyyy; };
        const SpectralMoments total = frame.sea().total();
        EXPECT_NEAR(trace(total) / (large * large * trace(of_large) + small * small * trace(of_small)), 1.0,
                    1e-9);
        EXPECT_NEAR(total.xxxy, large * large * of_large.xxxy + small * small * of_small.xxxy,
                    1e-9 * std::abs(total.xxxy));
        EXPECT_NEAR(total.mss(), of_large.mss() + of_small.mss(), 1e-9 * total.mss());
    }
}

// Where short waves are the more choppy, J changes faster.
TEST(ChoppinessOfCascades, WeighsHowFastTheJacobianChanges) {
    const auto rate_of = [](double large, double small) {
        const auto prepared = prepare(choppy_scene(large, small));
        return breaking_rate(prepared->spectrum, breaking_of(prepared->scene, {}));
    };
    EXPECT_GT(rate_of(0.6, 1.7), 1.02 * rate_of(1.0, 1.0));
    EXPECT_LT(1.02 * rate_of(1.7, 0.6), rate_of(1.0, 1.0));
}

// Squares of what grows with λ add up band by band: (a, b) and (b, a) hold together what (a, a) and (b, b) hold.
TEST(ChoppinessOfCascades, AddsUpBandByBand) {
    const auto expect_sum = [](const char* what, const auto& square_of) {
        SCOPED_TRACE(what);
        const double ab = square_of(0.6, 1.7), ba = square_of(1.7, 0.6), aa = square_of(0.6, 0.6),
                     bb = square_of(1.7, 1.7);
        EXPECT_NEAR((ab + ba) / (aa + bb), 1.0, 1e-6);
        for (const double mixed : {ab, ba}) {
            EXPECT_GT(mixed, 1.02 * aa);
            EXPECT_LT(1.02 * mixed, bb);
        }
    };
    expect_sum("reach", [](double large, double small) {
        return std::pow(prepare(choppy_scene(large, small))->extent.reach_m, 2.0);
    });
    expect_sum("distance of a mesh", [](double large, double small) {
        const MeshErrorModel model(*prepare(choppy_scene(large, small)));
        return std::pow(model.error(8.0, 0.0, Drawn::Triangles), 2.0);
    });
    expect_sum("carried slopes", [](double large, double small) {
        const auto prepared = prepare(choppy_scene(large, small));
        return unresolved_slope_gain(prepared->spectrum, {}, 0.5, Choppiness::asked(prepared->scene)) - 1.0;
    });
    // Of the waves that break.
    expect_sum("mean choppiness", [](double large, double small) {
        const auto prepared = prepare(choppy_scene(large, small));
        return std::pow(mean_choppiness(prepared->spectrum, breaking_of(prepared->scene, {})), 2.0);
    });
    expect_sum("variance of dJ/dt", [](double large, double small) {
        const auto prepared = prepare(choppy_scene(large, small));
        const pelagic::Breaking breaking = breaking_of(prepared->scene, {});
        return std::pow(
            breaking_rate(prepared->spectrum, breaking) * mean_choppiness(prepared->spectrum, breaking), 2.0);
    });
}

TEST(ChoppinessOfCascades, BoundsAndReachHoldIt) {
    const auto points = random_points<double>(2000.0, 2000);
    for (const Scene& scene : {choppy_scene(0.2, 2.0), choppy_scene(2.0, 0.0)}) {
        const auto frame = frame_of<double>(scene, {unfiltered(products(Displacement))}, 3.0);
        const DisplacementBounds bounds = FrameBounds<double>(frame, 0).everywhere();
        const auto found = sample(frame, 0, points);
        double farthest = 0.0, square = 0.0;
        for (const glm::dvec3& moved : found.vectors(Displacement)) {
            ASSERT_TRUE(bounds.dx.lo <= moved.x && moved.x <= bounds.dx.hi);
            ASSERT_TRUE(bounds.dy.lo <= moved.y && moved.y <= bounds.dy.hi);
            farthest = std::max({farthest, std::abs(moved.x), std::abs(moved.y)});
            square += (moved.x * moved.x + moved.y * moved.y) / static_cast<double>(points.size());
        }
        EXPECT_GT(farthest, 0.3 * bounds.reach_m().x);
        EXPECT_NEAR(std::sqrt(square) * kExtentDeviations / frame.sea().extent().reach_m, 1.0, 0.15);
    }
}

TEST(ChoppinessOfCascades, FoldingIsToldOfWithWhatHelps) {
    EXPECT_TRUE(sea_warnings(*prepare(choppy_scene(1.0, 0.5))).empty());
    const Scene steep = choppy_scene(1.0, 6.0);
    std::string told;
    for (const std::string& warning : sea_warnings(*prepare(steep)))
        if (warning.find("folds over") != std::string::npos) told = warning;
    const std::string says = "each cascade's choppiness times ";
    const std::size_t at = told.find(says);
    ASSERT_NE(at, std::string::npos) << told;
    const double factor = std::stod(told.substr(at + says.size()));
    const auto share = [&](double by) {
        const auto less = prepare(choppy_scene(by * 1.0, by * 6.0));
        return folded_share(less->spectrum, Choppiness::asked(less->scene));
    };
    EXPECT_LE(share(factor), 0.05);
    EXPECT_GT(share(factor + 0.02), 0.05);
    // And the share is that of points.
    Scene counted = choppy_scene(10.0, 5.0);
    counted.waves.band_gains = {{1e-3, 1.5, 0.0}};  // what no tile shows
    const auto frame = frame_of<double>(counted, {unfiltered(products(Displacement))});
    const Sum sum(frame.sea(), counted, 0.0);
    const auto points = random_points<double>(4000.0, 3000);
    const double folded =
        mean_of(points, [&](glm::dvec2 x) { return sum.at(x).jacobian() < 0.0 ? 1.0 : 0.0; });
    const double told_share = folded_share(prepare(counted)->spectrum, Choppiness::asked(counted));
    EXPECT_GT(folded, 0.03);
    EXPECT_NEAR(told_share / folded, 1.0, 0.15);
}

}  // namespace
}  // namespace pelagic
