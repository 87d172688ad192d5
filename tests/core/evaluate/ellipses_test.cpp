// Footprints that are ellipses: what they show is the closed form of core/plan/taps.h, what they hide is the rest.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>

#include "core/plan/taps.h"
#include "core/spectrum/gauss.h"
#include "core/surface/rest_surface.h"
#include "tests/core/waves/samples.h"

namespace pelagic {
namespace {

using namespace test;

template <class T>
struct Ellipse {
    T width_m;
    glm::vec<2, T> axis_m;
};

// Points with these footprints, of cells and pixels alike.
template <class T>
ProductArrays<T> ask(const Frame<T>& frame, const std::vector<glm::vec<2, T>>& rest,
                     const std::vector<Ellipse<T>>& of) {
    std::vector<T> width_m;
    std::vector<glm::vec<2, T>> axis_m;
    for (const Ellipse<T>& one : of) {
        width_m.push_back(one.width_m);
        axis_m.push_back(one.axis_m);
    }
    ProductArrays<T> answers;
    answers.resize(frame.sea().plan().queries[0].query.products, rest.size());
    evaluate(frame, 0,
             Points<T>{.count = rest.size(),
                       .rest_m = {rest.data()},
                       .cell_m = {width_m.data()},
                       .pixel_m = {width_m.data()},
                       .cell_axis_m = {axis_m.data()},
                       .pixel_axis_m = {axis_m.data()}},
             answers.results());
    return answers;
}

Query levels(ProductSet wanted) {
    Query query = unfiltered(wanted);
    query.cell_m = query.pixel_m = {0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0};
    return query;
}

Scene two_tiles() {
    Scene scene;
    scene.waves.cascades = {{200.0, 128}, {47.0, 128}};
    return scene;
}

// The scenes of the table: each model of waves, narrow swells and deep and shallow water among them.
std::vector<std::pair<const char*, Scene>> seas() {
    Scene plain = two_tiles(), swell = two_tiles(), unified = two_tiles(), shallow = two_tiles(),
          turned = two_tiles();
    swell.sea.swell = {{.height_m = 2.0, .period_s = 9.0, .direction_deg = 130.0}};
    swell.sea.wind_speed_mps = 6.0;
    unified.sea.spectrum = SpectrumKind::Elfouhaily;
    shallow.sea.depth_m = 8.0;
    turned.sea.wind_direction_deg = 77.0;
    turned.sea.wind_speed_mps = 20.0;
    return {
        {"plain", plain}, {"swell", swell}, {"unified", unified}, {"shallow", shallow}, {"turned", turned}};
}

// Axes that are none, and a width that is more: today's bits.
TEST(Ellipses, RoundOnesAreRoundToTheBit) {
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    for (const WaveModel model : {WaveModel::Fft, WaveModel::Trochoid}) {
        Scene scene = two_tiles();
        scene.waves.model = model;
        const auto frame = frame_of<float>(scene, {levels(~lasting_products())}, 3.0);
        const auto rest = random_points<float>(300.0, 700);
        Where<float> round;
        std::vector<Ellipse<float>> none, some;
        for (std::size_t i = 0; i < rest.size(); ++i) {
            const float width_m = 0.2f * std::pow(1.012f, static_cast<float>(i));
            round.cell_m.push_back(width_m);
            none.push_back(
                {width_m, std::array<glm::vec2, 4>{glm::vec2(0.0f), glm::vec2(0.5f * width_m, 0.0f),
                                                   glm::vec2(nan, 1.0f), glm::vec2(inf, 0.0f)}[i % 4]});
            some.push_back(i % 2 ? none.back() : Ellipse<float>{width_m, glm::vec2(7.0f, 3.0f) * width_m});
        }
        round.pixel_m = round.cell_m;
        const auto expected = sample(frame, 0, rest, round), same = ask(frame, rest, none),
                   mixed = ask(frame, rest, some);
        for (const ProductRow& row : kProductTable)
            for (std::size_t i = 0; !lasting_products()[index(row.product)] && i < rest.size(); ++i) {
                const auto value = [&](const ProductArrays<float>& of) {
                    return row.components == 1 ? glm::vec3(of.numbers(NumberProduct::checked(row.product))[i])
                                               : of.vectors(VectorProduct::checked(row.product))[i];
                };
                ASSERT_EQ(value(same), value(expected)) << row.name << " " << i;
                if (i % 2) {
                    ASSERT_EQ(value(mixed), value(expected)) << row.name << " beside ellipses " << i;
                }
            }
    }
}

// Every mode counts with its weight in the levels times R, at any length and direction.
TEST(Ellipses, ShowTheClosedFormOfTheirTaps) {
    Scene scene = first_order();
    scene.waves.cascades = {{100.0, 96}};
    scene.waves.tiling = Tiling::Periodic;  // one sum of modes
    const auto frame = frame_of<double>(scene, {levels(products(Product::Displacement))}, 2.0);
    const Plan& plan = frame.sea().plan();
    const auto modes = modes_of(frame.sea(), 0, 2.0);
    const double hs_m = 4.0 * std::sqrt(frame.sea().total().m0);
    const FootprintFilter filter;
    const glm::dvec2 x(13.7, -41.3);
    for (const double width_m : {1.0, 2.8, 6.0})
        for (const double ratio : {1.2, 2.0, 5.0, 8.0, 40.0})
            for (const double direction : {0.0, 0.6, 1.9}) {
                const glm::dvec2 unit(std::cos(direction), std::sin(direction));
                const double length_m = std::min(ratio * width_m, 128.0);
                const double own_m = std::max(width_m, length_m / kLongestEllipse);
                const double lower_m = std::exp2(std::floor(std::log2(own_m))), t = own_m / lower_m - 1.0;
                const Taps<double> taps =
                    taps_of(std::max(own_m, whole_footprint_m(plan.cascades[0], filter)), length_m);
                double expected = 0.0;
                for (const Mode& mode : modes) {
                    const glm::dvec2 k = kTwoPi / 100.0 * glm::dvec2(mode.mx, mode.my);
                    const double weight =
                        (1.0 - t) * filter.weight(mode.k, lower_m) + t * filter.weight(mode.k, 2.0 * lower_m);
                    const double phase = k.x * x.x + k.y * x.y;
                    expected += 2.0 * weight * tap_response(taps, k.x * unit.x + k.y * unit.y) *
                                (mode.height.real() * std::cos(phase) - mode.height.imag() * std::sin(phase));
                }
                const auto answer = ask<double>(frame, {x}, {{width_m, ratio * width_m * unit}});
                EXPECT_NEAR(answer.vectors(Displacement)[0].z / hs_m, expected / hs_m, 1e-4)
                    << width_m << " m, " << ratio << ", " << direction;
            }
}

// A train counts with the filter's weight for the ellipse's length along its way.
TEST(Ellipses, FilterTrainsByTheirLengthAlongTheWay) {
    Scene scene;
    scene.waves.model = WaveModel::Trochoid;
    const auto frame =
        frame_of<double>(scene, {levels(products(Product::Displacement, Product::SlopeVarianceAtRest))}, 0.0);
    const Trains<double>& trains = frame.sea().trains();
    const SpectralMoments whole = total(trains);
    for (const double ratio : {1.5, 10.0, 1000.0})
        for (const double direction : {0.3, 2.0}) {
            const double width_m = 1.3;
            const glm::dvec2 unit(std::cos(direction), std::sin(direction));
            double height_m = 0.0, unresolved = trains.outside.mss();
            for (std::size_t i = 0; i < trains.count(); ++i) {
                const double lambda_m = trains.wavelength_m[i];
                const double along = unit.x * trains.kx_cycles_per_m[i] * lambda_m +
                                     unit.y * trains.ky_cycles_per_m[i] * lambda_m;
                const double footprint_m = width_m * std::hypot(1.0, std::sqrt(ratio * ratio - 1.0) * along);
                const double w = FootprintFilter{}.weight(kTwoPi / lambda_m, footprint_m);
                height_m += w * trains.height_m[i] * std::cos(kTwoPi * trains.start_cycles[i]);
                unresolved += trains.alone[i].mss() * (1.0 - w * w);
            }
            const auto answer = ask<double>(frame, {glm::dvec2(0.0)}, {{width_m, ratio * width_m * unit}});
            const glm::dvec3 variance = answer.vectors(SlopeVarianceAtRest)[0];
            EXPECT_NEAR(answer.vectors(Displacement)[0].z, height_m, 1e-9);
            EXPECT_NEAR(variance.x + variance.y, unresolved, 1e-9 * whole.mss());
        }
}

// What is unresolved is the spectrum's whole less what the taps let through, as a tensor: for all of the seas, at widths on
// levels and between them, all lengths and directions. The bands of the cascades as lattices differ from the spectrum's by
// less than the tolerance, and so does the table between its nodes.
TEST(Ellipses, ShownAndUnresolvedAreTheSpectrumAsATensor) {
    const FootprintFilter filter;
    for (const auto& [name, scene] : seas()) {
        const auto frame = frame_of<float>(scene, {levels(products(Product::SlopeVarianceAtRest))}, 0.0);
        const Plan& plan = frame.sea().plan();
        const DirectionalSpectrum& spectrum = plan.from->spectrum;
        const SpectralMoments& whole = frame.sea().total();
        constexpr int kDirections = 90;
        struct Part {
            int cascade;
            double k;
            std::array<double, kDirections> slopes;
        };
        std::vector<Part> parts;
        for (int c = 0; c < static_cast<int>(plan.cascades.size()); ++c) {
            const CascadePlan& cascade = plan.cascades[c];
            const double end = std::min(cascade.k_upper, kPi * cascade.resolution / cascade.size_m);
            for (std::size_t p = 0; p + 1 < spectrum.panels().size(); ++p) {
                const double from = std::max(spectrum.panels()[p], cascade.k_lower),
                             to = std::min(spectrum.panels()[p + 1], end);
                if (!(from < to)) continue;
                for (std::size_t i = 0; i < 4; ++i) {
                    const auto& rule = GaussLegendre<4>::rule();
                    Part& part =
                        parts.emplace_back(Part{c, 0.5 * (from + to) + 0.5 * (to - from) * rule.node[i], {}});
                    for (int d = 0; d < kDirections; ++d) {
                        const double first = (d - 0.5) * kPi / kDirections,
                                     last = (d + 0.5) * kPi / kDirections;
                        part.slopes[d] = 0.5 * (to - from) * rule.weight[i] * part.k * part.k *
                                         (spectrum.arc(part.k, first, last) +
                                          spectrum.arc(part.k, first + kPi, last + kPi));
                    }
                }
            }
        }
        double worst = 0.0;
        for (const double width_m : {0.25, 0.6, 1.0, 3.3})
            for (const double ratio : {1.0, 1.4, 2.0, 3.5, 8.0})
                for (const double direction : {0.1, 1.2, 2.5}) {
                    const double length_m = ratio * width_m,
                                 lower_m = std::exp2(std::floor(std::log2(width_m)));
                    const double t = width_m / lower_m - 1.0;
                    double xx = whole.xx, xy = whole.xy, yy = whole.yy;
                    for (const Part& part : parts) {
                        const Taps<double> taps =
                            taps_of(std::max(width_m, whole_footprint_m(plan.cascades[part.cascade], filter)),
                                    length_m);
                        const double shown = (1.0 - t) * filter.weight(part.k, lower_m) +
                                             t * filter.weight(part.k, 2.0 * lower_m);
                        if (!(shown > 0.0)) continue;
                        for (int d = 0; d < kDirections; ++d) {
                            const double theta = d * kPi / kDirections, x = std::cos(theta),
                                         y = std::sin(theta);
                            const double response =
                                shown * tap_response(taps, part.k * std::cos(theta - direction));
                            const double shows = part.slopes[d] * response * response;
                            xx -= x * x * shows;
                            xy -= x * y * shows;
                            yy -= y * y * shows;
                        }
                    }
                    const auto f = static_cast<float>(width_m);
                    const glm::vec2 axis_m =
                        static_cast<float>(length_m) * glm::vec2(std::cos(direction), std::sin(direction));
                    const glm::vec3 unresolved =
                        ask<float>(frame, {glm::vec2(0.0f)}, {{f, axis_m}}).vectors(SlopeVarianceAtRest)[0];
                    for (const double error : {unresolved.x - xx, unresolved.y - yy, unresolved.z - xy})
                        worst = std::max(worst, std::abs(error) / whole.mss());
                }
        std::printf("    %-8s worst %.2f %% of the mean square slope\n", name, 100.0 * worst);
        EXPECT_LT(worst, 0.015) << name;
    }
}

// The same of a realisation: the variance of the slopes shown and what is said to be unresolved add up to the whole.
TEST(Ellipses, SlopesShownVaryByWhatIsNotUnresolved) {
    Scene scene = two_tiles();
    scene.waves.choppiness = 0.0;
    scene.effects.whitecaps = false;
    const auto frame =
        frame_of<float>(scene, {levels(products(Product::Normal, Product::SlopeVarianceAtRest))}, 1.0);
    const SpectralMoments& whole = frame.sea().total();
    const auto rest = random_points<float>(4000.0, 20000);
    for (const double ratio : {2.0, 8.0})
        for (const double direction : {0.0, 1.57, 2.3}) {
            const glm::vec2 unit(std::cos(direction), std::sin(direction));
            const std::vector<Ellipse<float>> of(rest.size(), {0.5f, static_cast<float>(0.5 * ratio) * unit});
            const auto answers = ask(frame, rest, of);
            const glm::dvec3 unresolved(answers.vectors(SlopeVarianceAtRest)[0]);
            const auto shown = [&](int a, int b) {
                return mean_of(answers.vectors(Normal),
                               [&](const glm::vec3& n) { return n[a] * n[b] / (n.z * n.z); });
            };
            EXPECT_NEAR((shown(0, 0) + unresolved.x) / whole.mss(), whole.xx / whole.mss(), 0.03);
            EXPECT_NEAR((shown(1, 1) + unresolved.y) / whole.mss(), whole.yy / whole.mss(), 0.03);
            EXPECT_NEAR((shown(0, 1) + unresolved.z) / whole.mss(), whole.xy / whole.mss(), 0.03);
        }
}

// Wind, swell and ellipse turned together: what is unresolved turns with them.
TEST(Ellipses, TurnWithTheWind) {
    const auto unresolved = [&](double turn_deg) {
        Scene scene = two_tiles();
        scene.sea.wind_direction_deg = 20.0 + turn_deg;
        const auto frame = frame_of<float>(scene, {levels(products(Product::SlopeVarianceAtRest))}, 0.0);
        const double direction = (50.0 + turn_deg) * kPi / 180.0;
        const glm::vec2 axis_m = 4.0f * glm::vec2(std::cos(direction), std::sin(direction));
        const glm::dvec3 v(
            ask<float>(frame, {glm::vec2(0.0f)}, {{0.7f, axis_m}}).vectors(SlopeVarianceAtRest)[0]);
        const double c = std::cos(turn_deg * kPi / 180.0), s = std::sin(turn_deg * kPi / 180.0);
        return glm::dvec3(c * c * v.x + 2.0 * c * s * v.z + s * s * v.y,
                          s * s * v.x - 2.0 * c * s * v.z + c * c * v.y,
                          c * s * (v.y - v.x) + (c * c - s * s) * v.z);
    };
    const glm::dvec3 first = unresolved(0.0);
    for (const double turn_deg : {33.0, 90.0, 171.0})
        for (int i = 0; i < 3; ++i)
            EXPECT_NEAR(unresolved(turn_deg)[i], first[i], 0.01 * (first.x + first.y)) << turn_deg;
}

TEST(Ellipses, HardOnesAreFinite) {
    for (const WaveModel model : {WaveModel::Fft, WaveModel::Trochoid}) {
        Scene scene = two_tiles();
        scene.waves.model = model;
        const auto frame = frame_of<float>(scene, {levels(~lasting_products())}, 3.0);
        std::vector<glm::vec2> rest;
        std::vector<Ellipse<float>> of;
        for (const float width_m : {0.0f, 1e-30f, 0.3f, 1e6f, std::numeric_limits<float>::quiet_NaN()})
            for (const float length_m : {0.0f, 0.3f, 0.300001f, 3.0f, 3e5f, 1e30f})
                for (const glm::vec2 unit : {glm::vec2(1.0f, 0.0f), glm::vec2(-0.6f, -0.8f)}) {
                    rest.emplace_back(1e5f, -3e4f);
                    of.push_back({width_m, length_m * unit});
                }
        const auto answers = ask(frame, rest, of);
        for (std::size_t i = 0; i < rest.size(); ++i) {
            EXPECT_TRUE(std::isfinite(answers.vectors(Position)[i].z) &&
                        std::isfinite(answers.vectors(Normal)[i].z) &&
                        std::isfinite(answers.numbers(Product::Breaking)[i]))
                << i;
            for (const glm::vec3 v :
                 {answers.vectors(SlopeVariance)[i], answers.vectors(SlopeVarianceAtRest)[i]}) {
                EXPECT_GE(v.x, 0.0f);
                EXPECT_GE(v.x * v.y - v.z * v.z, -1e-9f);
            }
        }
    }
}

// Cascades asked one by one hide, each of its own waves, what they hide together.
TEST(Ellipses, HideOfOneCascadeItsShare) {
    Scene scene = two_tiles();
    scene.waves.choppiness = 0.0;
    Query whole = levels(products(Product::SlopeVarianceAtRest));
    std::vector<Query> queries{whole, whole, whole};
    for (int c : {0, 1}) {
        queries[c + 1].name = "cascade " + std::to_string(c);
        queries[c + 1].only_cascade = c;
    }
    const auto frame = frame_of<float>(scene, queries);
    const std::vector<glm::vec2> rest(1), round(1), axis_m{{5.0f, 3.0f}};
    const std::vector<float> width_m{1.0f};
    const auto unresolved = [&](int query, const std::vector<glm::vec2>& axes_m) {
        std::vector<glm::vec3> variance(1);
        Results<float> results;
        results.set(Product::SlopeVarianceAtRest, {variance.data()});
        evaluate(frame, query,
                 {.count = 1,
                  .rest_m = {rest.data()},
                  .pixel_m = {width_m.data()},
                  .pixel_axis_m = {axes_m.data()}},
                 results);
        return variance[0];
    };
    const auto more = [&](int query) { return unresolved(query, axis_m) - unresolved(query, round); };
    const glm::vec3 sum = more(1) + more(2), together = more(0);
    EXPECT_GT(more(1).x, 0.0f);
    EXPECT_GT(more(2).x, 0.0f);
    // A band's modes and its spectrum's integral differ by some per mille, and nothing hides less than nothing.
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(sum[i], together[i], 0.02f * together.x) << i;
}

TEST(Ellipses, NeedAWidthAndPointsAnywhere) {
    const std::vector<glm::vec2> rest(1), axis_m(1);
    const std::vector<float> width_m(1);
    std::vector<glm::vec3> normal(1);
    Results<float> results;
    results.set(Product::Normal, {normal.data()});
    const auto frame = frame_of<float>(
        two_tiles(), {levels(products(Product::Normal)), tile(products(Product::Normal), 0, 200.0, 64)});
    EXPECT_THROW(
        evaluate(frame, 0, {.count = 1, .rest_m = {rest.data()}, .pixel_axis_m = {axis_m.data()}}, results),
        std::invalid_argument);
    EXPECT_THROW(evaluate(frame, 1,
                          {.count = 1,
                           .rest_m = {rest.data()},
                           .pixel_m = {width_m.data()},
                           .pixel_axis_m = {axis_m.data()}},
                          results),
                 std::invalid_argument);
}

// A bake's mesh through the camera has cells that are longer away from it than across.
TEST(Ellipses, BakedGridsHaveThem) {
    Scene scene = two_tiles();
    scene.surface.kind = SurfaceKind::ProjectedGrid;
    scene.camera.position_m = {0.0, -60.0, 4.0};
    const auto surface = make_surface(scene, {.height_m = 2.0, .reach_m = 2.0, .significant_height_m = 1.0});
    RestPoints<float> points;
    surface->points_at(1, points);
    ASSERT_EQ(points.cell_axis_m.size(), points.rest_m.size());
    ASSERT_EQ(points.pixel_axis_m.size(), points.rest_m.size());
    std::size_t longer = 0;
    for (std::size_t i = 0; i < points.rest_m.size(); ++i)
        longer += glm::length(points.cell_axis_m[i]) > 2.0f * points.cell_m[i];
    EXPECT_GT(longer, points.rest_m.size() / 2);
}

}  // namespace
}  // namespace pelagic
