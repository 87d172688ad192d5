// Seas whose numbers have keys: amplitudes by variance, one set of phases, and each time by itself.
#include "core/plan/weather.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <initializer_list>
#include <limits>
#include <numbers>

#include "core/evaluate/bounds.h"
#include "core/plan/extent.h"
#include "core/scene/keys.h"
#include "core/scene/number_keys.h"
#include "core/scene/text.h"
#include "core/spectrum/possible.h"
#include "core/waves/folding.h"
#include "core/waves/sea_over_time.h"
#include "core/waves/whitecaps.h"
#include "tests/core/waves/samples.h"
#include "tests/core/waves/worst.h"

namespace pelagic {
namespace {

using namespace test;

constexpr auto kLinear = CameraInterpolation::Linear, kSmooth = CameraInterpolation::Smooth;

void give_keys(Scene& scene, const char* path, std::vector<NumberKeys::Key> keys,
               CameraInterpolation interpolation = kSmooth) {
    ASSERT_FALSE(set_value(scene, key_of(path), NumberKeys{std::move(keys), interpolation}));
}

// From a breeze to a gale in 240 frames, ten seconds.
Scene rising(WaveModel model = WaveModel::Fft, bool has_cascades = true) {
    Scene scene;
    scene.shot.first_frame = 1;
    scene.shot.last_frame = 240;
    scene.waves.model = model;
    if (has_cascades) scene.waves.cascades = {{400.0, 96}, {90.0, 64}};
    if (model == WaveModel::Trochoid) scene.waves.trains = 40;
    scene.effects.foam_decay_s = 0.0;
    give_keys(scene, "sea.wind_speed_mps", {{1, 8.0}, {240, 22.0}});
    return scene;
}

struct Kind {
    const char* name;
    WaveModel model;
    bool has_cascades;
};
constexpr Kind kKinds[]{{"fft", WaveModel::Fft, true},
                        {"trains", WaveModel::Trochoid, false},
                        {"trains over cascades", WaveModel::Trochoid, true}};

Query everything() {
    return filtered(
        products(Displacement, Normal, Velocity, SlopeVariance, Product::JacobianMoments, Product::Breaking),
        2.0);
}

template <class T>
Frame<T> frame_over_time(const Scene& scene, const std::vector<Query>& queries) {
    for (const Problem& problem : validate(scene)) throw std::invalid_argument(text_of(problem));
    return Frame<T>(std::make_shared<const SeaOverTime<T>>(make_plan(scene, queries)));
}

template <class T>
bool same_samples(const ProductArrays<T>& a, const ProductArrays<T>& b) {
    const auto same = [](const auto& x, const auto& y) {
        return x.size() == y.size() &&
               (x.empty() || std::memcmp(x.data(), y.data(), x.size() * sizeof(x[0])) == 0);
    };
    return std::ranges::all_of(kProductTable, [&](const ProductRow& row) {
        if (row.components == 1)
            return same(a.numbers(NumberProduct::checked(row.product)),
                        b.numbers(NumberProduct::checked(row.product)));
        return same(a.vectors(VectorProduct::checked(row.product)),
                    b.vectors(VectorProduct::checked(row.product)));
    });
}

TEST(Weather, GoesFromKeyToKeyByTheSeasTime) {
    Scene scene = rising();
    scene.shot.time_scale = 0.5;
    scene.shot.time_offset_s = 7.0;
    for (const auto interpolation : {kLinear, kSmooth}) {
        give_keys(scene, "sea.wind_speed_mps", {{-3, 8.0}, {21, 14.0}, {45, 14.0}, {69, 5.0}}, interpolation);
        const Weather weather = *prepare(scene)->weather;
        ASSERT_EQ(weather.keys.size(), 4u);
        const auto at = [&](double frame) { return weather.at(scene.shot.time_s(frame)); };
        for (const auto& [frame, key] : std::vector<std::pair<double, std::size_t>>{
                 {-100.0, 0}, {-3.0, 0}, {21.0, 1}, {30.0, 1}, {45.0, 2}, {69.0, 3}, {1e6, 3}}) {
            EXPECT_EQ(at(frame).first, key) << frame;
            EXPECT_EQ(at(frame).second, key) << frame;
            EXPECT_EQ(at(frame).rate_per_s, 0.0) << frame;
        }
        EXPECT_EQ(weather.keys[1].sea, weather.keys[2].sea);
        const Weather::Blend quarter = at(3.0);
        EXPECT_EQ(quarter.first, 0u);
        EXPECT_EQ(quarter.second, 1u);
        EXPECT_NEAR(quarter.share, interpolation == kLinear ? 0.25 : 10.0 / 64.0, 1e-12);
        constexpr double h = 1e-4;
        const double t = scene.shot.time_s(60.0);
        EXPECT_NEAR(weather.at(t).rate_per_s, (weather.at(t + h).share - weather.at(t - h).share) / (2.0 * h),
                    1e-6);
        EXPECT_GT(weather.at(t).rate_per_s, 0.5);  // 24 frames are half a second of this sea
    }
}

// The frame of a run, alone, and on any number of threads; a key's own sea is that of its plain numbers.
TEST(Weather, AFrameAloneIsThatOfARun) {
    for (const Kind& kind : kKinds) {
        SCOPED_TRACE(kind.name);
        Scene scene = rising(kind.model, kind.has_cascades);
        scene.sea.gust_strength = 0.5;
        const auto points = random_points<float>(300.0, 500);
        auto run = frame_over_time<float>(scene, {everything()});
        std::vector<ProductArrays<float>> of_run;
        const std::vector<double> times{0.0, 1.0, 5.0, 5.02, 9.0, scene.shot.time_s(240), 30.0};
        for (const double t : times) {
            run.set(t);
            of_run.push_back(sample(run, 0, points));
        }
        EXPECT_FALSE(same_samples(of_run[2], of_run[3]));
        for (const std::size_t threads : {1, 2}) {
            const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism,
                                                    threads);
            for (const std::size_t i : {4, 2, 0, 6, 5}) {
                auto alone = frame_over_time<float>(scene, {everything()});
                alone.set(times[i]);
                EXPECT_TRUE(same_samples(sample(alone, 0, points), of_run[i])) << times[i];
            }
        }
    }
}

// By prepare(): the same scene, so the same plan and bits.
TEST(Weather, OfEqualKeysIsThePlainNumber) {
    Scene plain = rising(), equal = plain;
    set_value(plain, key_of("sea.wind_speed_mps"), 12.5);
    give_keys(equal, "sea.wind_speed_mps", {{1, 12.5}, {100, 12.5}});
    const auto points = random_points<float>(300.0, 200);
    auto a = frame_over_time<float>(plain, {everything()}), b = frame_over_time<float>(equal, {everything()});
    for (const double t : {0.0, 2.0, 8.0}) {
        a.set(t);
        b.set(t);
        EXPECT_TRUE(same_samples(sample(a, 0, points), sample(b, 0, points)));
    }
}

// A swell that comes up while the wind sea stays, and a band that fades: at each key the plain sea, between them by energy.
TEST(Weather, HasSwellsAndBandGainsThatChange) {
    for (const Kind& kind : kKinds) {
        SCOPED_TRACE(kind.name);
        Scene plain = first_order(rising(kind.model, kind.has_cascades));
        plain.keyed.clear();
        plain.sea.wind_speed_mps = 8.0;
        plain.sea.swell = {{1.0, 8.0, 200.0}, {2.0, 12.0, 30.0}};
        plain.waves.band_gains = {{20.0, 60.0, 1.0}};
        if (kind.has_cascades) plain.waves.cascades = {{800.0, 192}, {90.0, 64}};
        Scene keyed = plain;
        keyed.keyed = {{"sea.swell[1].height_m", {{{1, 0.0}, {121, 3.0}}, kLinear}},
                       {"waves.band_gains[0].gain", {{{1, 1.0}, {121, 0.25}}, kLinear}}};
        const auto points = random_points<float>(300.0, 200);
        auto frame = frame_over_time<float>(keyed, {everything()});
        std::vector<double> m0;
        for (const double f : {1.0, 61.0, 121.0}) {
            const double t = keyed.shot.time_s(f);
            frame.set(t);
            m0.push_back(frame.sea().total().m0);
            const auto at_key = sample(frame, 0, points);
            EXPECT_NEAR(frame.sea().total().m0 / moments(prepared_at(prepare(keyed), t)->spectrum, 0.0,
                                                         std::numeric_limits<double>::infinity())
                                                     .m0,
                        1.0, 1e-5);
            auto alone = frame_over_time<float>(keyed, {everything()});
            alone.set(t);
            EXPECT_TRUE(same_samples(sample(alone, 0, points), at_key)) << f;
            if (f == 61.0) continue;
            const PreparedScene still = *prepare(scene_at(keyed, f));
            EXPECT_NEAR(frame.sea().total().m0 / still.spectrum.m0(), 1.0, 1e-4) << f;
        }
        EXPECT_GT(m0[2], m0[0] + 0.9 * (3.0 * 3.0 / 16.0) - 0.1);
        EXPECT_NEAR(m0[1], 0.5 * (m0[0] + m0[2]), 1e-6 * m0[1]);
    }
}

// Between two keys that are alike, of a sea that changes elsewhere, and at a key: its own sea, with the cascades given.
TEST(Weather, AtAKeyIsThatKeysSea) {
    Scene scene = first_order(rising()), plain = scene;
    give_keys(scene, "sea.wind_speed_mps", {{1, 8.0}, {25, 12.0}, {49, 12.0}, {97, 22.0}});
    set_value(plain, key_of("sea.wind_speed_mps"), 12.0);
    const auto points = random_points<float>(300.0, 200);
    auto changing = frame_over_time<float>(scene, {everything()}),
         still = frame_over_time<float>(plain, {everything()});
    for (const double frame : {25.0, 30.0, 49.0}) {
        changing.set(scene.shot.time_s(frame));
        still.set(scene.shot.time_s(frame));
        EXPECT_TRUE(same_samples(sample(changing, 0, points), sample(still, 0, points))) << frame;
    }
}

// By differences in time, of each frame's own waves. Returns the largest error.
double expect_velocities_are_rates(const Scene& scene, std::initializer_list<double> times_s,
                                   double most = 1e-5) {
    auto frame = frame_over_time<double>(scene, {filtered(products(Displacement, Velocity), 3.0)});
    const auto points = random_points<double>(400.0, 300);
    constexpr double h = 1e-4;
    double worst = 0.0;
    const auto at = [&](double t) {
        frame.set(t);
        return sample(frame, 0, points);
    };
    for (const double t : times_s) {
        const auto before = at(t - h), after = at(t + h), now = at(t);
        double wrong = 0.0, all = 0.0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const glm::dvec3 rate =
                (after.vectors(Displacement)[i] - before.vectors(Displacement)[i]) / (2.0 * h);
            const glm::dvec3 off = now.vectors(Velocity)[i] - rate;
            wrong += glm::dot(off, off);
            all += glm::dot(rate, rate);
        }
        EXPECT_LT(std::sqrt(wrong / all), most) << t;
        worst = worse(worst, std::sqrt(wrong / all));
    }
    return worst;
}

TEST(Weather, VelocitiesHoldTheAmplitudesOwnChange) {
    double worst = 0.0;
    for (const auto interpolation : {kLinear, kSmooth})
        for (const Kind& kind : kKinds) {
            SCOPED_TRACE(kind.name);
            Scene scene = rising(kind.model, kind.has_cascades);
            give_keys(scene, "sea.wind_speed_mps", {{1, 8.0}, {49, 22.0}, {97, 10.0}}, interpolation);
            worst = worse(worst, expect_velocities_are_rates(scene, {0.3, 1.1, 1.9, 2.7, 3.8}));
        }
    RecordProperty("velocity_off", number_text(worst));
}

// From 8 to 22 m/s over 240 frames, in expectation over seeds: the realised height against that of the frame's spectrum, which lies
// between the keys' by variance.
TEST(Weather, HasTheHeightOfItsSpectrumAtEachFrame) {
    double worst = 0.0;
    for (const Kind& kind : {kKinds[0], kKinds[1]}) {
        SCOPED_TRACE(kind.name);
        Scene scene = rising(kind.model, kind.has_cascades);
        if (kind.has_cascades) scene.waves.cascades = {{6000.0, 360}, {300.0, 128}};
        const auto prepared = prepare(scene);
        const double first = prepared->weather->keys[0].sea->spectrum.m0(),
                     last = prepared->weather->keys[1].sea->spectrum.m0();
        EXPECT_GT(last, 20.0 * first);
        std::vector<double> m0(240, 0.0);
        constexpr int kSeeds = 16;
        for (int seed = 1; seed <= kSeeds; ++seed) {
            scene.shot.seed = static_cast<std::uint64_t>(seed);
            auto frame = frame_over_time<float>(scene, {unfiltered(products(Displacement))});
            for (int f = 1; f <= 240; f += kind.has_cascades ? 47 : 1) {
                frame.set(scene.shot.time_s(f));
                m0[static_cast<std::size_t>(f - 1)] += frame.realisation(0).m0 / kSeeds;
            }
        }
        for (int f = 1; f <= 240; ++f) {
            const double found = m0[static_cast<std::size_t>(f - 1)];
            if (!(found > 0.0)) continue;
            const double t = (f - 1) / 239.0, w = t * t * (3.0 - 2.0 * t);
            const double spectrum = prepared_at(prepared, scene.shot.time_s(f))->spectrum.m0();
            EXPECT_NEAR(spectrum / ((1.0 - w) * first + w * last), 1.0, 1e-9);
            EXPECT_NEAR(std::sqrt(found / spectrum), 1.0, 0.02) << f;
            worst = worse(worst, std::abs(std::sqrt(found / spectrum) - 1.0));
        }
    }
    RecordProperty("height_off", number_text(worst));
}

// A wind that turns leaves the old waves, which calm as the new ones grow: the short way round.
TEST(Weather, OfAWindThatTurnsHasTheWavesOfBoth) {
    Scene scene = rising();
    give_keys(scene, "sea.wind_speed_mps", {{1, 12.0}});
    give_keys(scene, "sea.wind_direction_deg", {{1, 315.0}, {240, 45.0}});
    EXPECT_EQ(scene.sea.wind_direction_deg, 315.0);  // foam and gusts drift that way
    auto frame = frame_over_time<double>(scene, {everything()});
    const auto moments_at = [&](double f) {
        frame.set(scene.shot.time_s(f));
        const Realisation there = frame.realisation(0);
        EXPECT_NEAR(there.m0 / frame.sea().total().m0, 1.0, 0.3) << f;
        const double towards = (f - 120.5) / 239.0 * 0.5 * std::numbers::pi;
        EXPECT_NEAR(std::atan2(there.north, there.east), towards, 0.2) << f;
        return frame.sea().total();
    };
    const SpectralMoments first = moments_at(1.0), middle = moments_at(120.5), last = moments_at(240.0);
    constexpr double kPi = std::numbers::pi;
    EXPECT_NEAR(std::remainder(first.mean_direction() + 0.25 * kPi, 2.0 * kPi), 0.0, 0.05);
    EXPECT_NEAR(std::remainder(last.mean_direction() - 0.25 * kPi, 2.0 * kPi), 0.0, 0.05);
    EXPECT_NEAR(std::remainder(middle.mean_direction(), 2.0 * kPi), 0.0, 0.05);
    EXPECT_NEAR(middle.m0 / first.m0, 1.0, 1e-3);
    EXPECT_NEAR(middle.xx, 0.5 * (first.xx + last.xx), 1e-6 * middle.xx);
    EXPECT_EQ(std::remainder(scene_at(scene, 120.5).sea.wind_direction_deg, 360.0), 0.0);
}

// What footprints hide is of the frame's spectrum, and as much foam breaks as the law has at its wind.
TEST(Weather, HiddenVarianceAndFoamAreThoseOfTheTime) {
    for (const Kind& kind : kKinds) {
        SCOPED_TRACE(kind.name);
        const Scene scene = rising(kind.model, kind.has_cascades);
        auto frame = frame_over_time<double>(scene, {everything()});
        double before = 0.0;
        for (const double f : {1.0, 60.0, 120.5, 200.0, 240.0}) {
            const double t = scene.shot.time_s(f);
            frame.set(t);
            const Sea<double>& sea = frame.sea();
            const auto now = prepared_at(prepare(scene), t);
            const SpectralMoments whole =
                moments(now->spectrum, 0.0, std::numeric_limits<double>::infinity());
            EXPECT_NEAR(sea.total().mss() / whole.mss(), 1.0, 1e-5);
            EXPECT_NEAR(sea.total().m0 / whole.m0, 1.0, 1e-5);
            const SpectralMoments& all = sea.total();
            const auto j = jacobian_moments<double>(0.0, 0.0, 0.0, 0.0,
                                                    {all.xxxx, all.xxxy, all.xxyy, all.xyyy, all.yyyy});
            const double law = law_coverage(scene_at(scene, f));
            EXPECT_NEAR(coverage(j, sea.whitecap_threshold(), true), law, 1e-3 * law) << f;
            EXPECT_GT(law, before);
            before = law;
            // A footprint of 2 m shows a part of it, and not a small one.
            const double shown = sea.resolved_moments(0).mss();
            EXPECT_LT(shown, all.mss());
            EXPECT_GT(shown, 0.1 * all.mss());
        }
    }
}

// A shower: rings come and go by their variance, short waves go and come back, and nobody calls it too fast.
TEST(Weather, HasShowers) {
    Scene scene = rising();
    scene.keyed.clear();
    scene.sea.wind_speed_mps = 6.0;
    give_keys(scene, "sea.rain_mm_h", {{1, 0.0}, {48, 40.0}, {96, 0.0}}, kLinear);
    for (const std::string& warning : sea_warnings(*prepare(scene)))
        EXPECT_EQ(warning.find("faster than waves"), std::string::npos) << warning;
    const auto points = random_points<double>(300.0, 200);
    const auto slopes = [&](double rain_mm_h) {
        Scene still = scene;
        still.keyed.clear();
        still.sea.rain_mm_h = rain_mm_h;
        return moments(prepare(still)->spectrum, 0.0, std::numeric_limits<double>::infinity());
    };
    auto frame = frame_over_time<double>(scene, {everything()});
    frame.set(scene.shot.time_s(30.0));
    const ProductArrays<double> of_run = sample(frame, 0, points);
    frame.set(scene.shot.time_s(48.0));
    EXPECT_NEAR(frame.sea().total().mss() / slopes(40.0).mss(), 1.0, 1e-5);
    frame.set(scene.shot.time_s(96.0));
    EXPECT_NEAR(frame.sea().total().mss() / slopes(0.0).mss(), 1.0, 1e-5);
    frame.set(scene.shot.time_s(24.5));
    EXPECT_NEAR(frame.sea().total().mss() / (0.5 * (slopes(0.0).mss() + slopes(40.0).mss())), 1.0, 1e-5);
    auto alone = frame_over_time<double>(scene, {everything()});
    alone.set(scene.shot.time_s(30.0));
    EXPECT_TRUE(same_samples(sample(alone, 0, points), of_run));
}

// Gusts keep their patches: of a strength that changes each moment has what a sea of that strength has, and the waves stay.
TEST(Weather, GustsHaveTheStrengthOfTheTime) {
    Scene scene = rising();
    scene.keyed.clear();
    scene.sea.wind_speed_mps = 14.0;
    scene.sea.gust_size_m = 60.0;
    give_keys(scene, "sea.gust_strength", {{1, 0.0}, {97, 0.8}}, kLinear);
    for (const std::string& warning : sea_warnings(*prepare(scene)))  // as fast as one likes: no waves grow
        EXPECT_EQ(warning.find("faster than waves"), std::string::npos) << warning;
    const auto points = random_points<double>(300.0, 400);
    auto changing = frame_over_time<double>(scene, {everything()});
    const auto slopes = [](const ProductArrays<double>& of) {
        std::vector<double> sums;
        for (const auto& variance : of.vectors(SlopeVariance)) sums.push_back(variance.x + variance.y);
        return sums;
    };
    for (const double f : {1.0, 49.0, 97.0, 120.0}) {
        const double t = scene.shot.time_s(f);
        changing.set(t);
        Frame<double> still(
            std::make_shared<const Sea<double>>(make_plan(scene_at(scene, f), {everything()})));
        still.set(t);
        const auto found = sample(changing, 0, points), said = sample(still, 0, points);
        const std::vector<double> hidden = slopes(found), as_said = slopes(said);
        for (std::size_t i = 0; i < points.size(); ++i) {
            EXPECT_NEAR(hidden[i], as_said[i], 1e-9 * as_said[i]) << f;
            EXPECT_NEAR(found.numbers(Product::Breaking)[i], said.numbers(Product::Breaking)[i], 1e-6) << f;
            EXPECT_LT(glm::length(found.vectors(Velocity)[i] - said.vectors(Velocity)[i]), 1e-9) << f;
        }
    }
}

// A smooth key's slope comes from the keys round it: foam of an interval remembers what went on between two keys, not only at them.
// Their keys leave the waves alone: one sea's are held, whose memory is counted once.
TEST(Weather, OfGustsAloneSharesItsWaves) {
    Scene plain;
    plain.waves.cascades = {{400.0, 96}, {90.0, 64}};
    plain.sea.gust_strength = 0.2;
    Scene keyed = plain;
    give_keys(keyed, "sea.gust_strength", {{1, 0.0}, {20, 0.6}, {40, 0.1}, {60, 0.2}});
    const Plan of_keyed = make_plan(prepare_weather(keyed), {everything()}),
               of_plain = make_plan(prepare(plain), {everything()});
    EXPECT_EQ(of_keyed.sea_bytes(), of_plain.sea_bytes());
    const SeaOverTime<float> sea(of_keyed, {});
    const auto* waves = sea.at(0.0)->cascades().data();
    for (const double t_s : {-3.0, 0.4, 0.8, 1.3, 2.2, 9.0}) {
        EXPECT_EQ(sea.at(t_s)->cascades().data(), waves) << t_s;
        EXPECT_NE(sea.at(t_s)->whitecaps().gusts.has_value(), false) << t_s;
    }
}

TEST(Weather, TextOfFoamKnowsTheCubicBetweenItsKeys) {
    const auto text_of = [](double first, double frame, double past_s) {
        Scene scene = rising();
        scene.keyed.clear();
        give_keys(scene, "sea.wind_speed_mps", {{1, first}, {400, 9.0}, {800, 15.0}, {1200, 19.0}});
        return weather_text(*prepare(scene), scene.shot.time_s(frame), past_s, past_s > 0.0 ? 0.5 : 0.0);
    };
    // The frame is between the last two, and a part of its past before them.
    EXPECT_NE(text_of(6.0, 820.0, 1.5), text_of(8.8, 820.0, 1.5));
    EXPECT_EQ(text_of(6.0, 1100.0, 1.5), text_of(8.8, 1100.0, 1.5));
    EXPECT_EQ(text_of(6.0, 800.0, 0.0), text_of(8.8, 800.0, 0.0));
}

TEST(Weather, BoundsHoldAtEachTime) {
    for (const Kind& kind : kKinds) {
        SCOPED_TRACE(kind.name);
        const Scene scene = rising(kind.model, kind.has_cascades);
        auto frame = frame_over_time<float>(scene, {unfiltered(products(Displacement))});
        frame.set(scene.shot.time_s(1.0));
        FrameBounds<float> bounds(frame, 0);
        const auto points = random_points<float>(200.0, 2000);
        for (const double f : {1.0, 80.0, 160.0, 240.0}) {
            frame.set(scene.shot.time_s(f));
            bounds.refresh();
            const DisplacementBounds in = bounds.region({glm::dvec2(-100.0), glm::dvec2(100.0)}, 4096);
            float highest = -1e9f, lowest = 1e9f;
            for (const auto& at : sample(frame, 0, points).vectors(Displacement)) {
                highest = std::max(highest, at.z);
                lowest = std::min(lowest, at.z);
            }
            EXPECT_LE(highest, in.z.hi) << f;
            EXPECT_GE(lowest, in.z.lo) << f;
            EXPECT_LT(in.z.hi, 3.0 * static_cast<double>(highest)) << f;  // of this time, not of the gale
        }
    }
}

// A steady sea whose displacement changes: from round crests to sharp ones, and back to less.
Scene pressed(WaveModel model = WaveModel::Fft, bool has_cascades = true) {
    Scene scene = rising(model, has_cascades);
    scene.keyed.clear();
    scene.sea.wind_speed_mps = 13.0;
    give_keys(scene, "waves.choppiness", {{1, 0.2}, {49, 1.2}, {97, 0.6}}, kLinear);
    if (model == WaveModel::Fft) {
        give_keys(scene, "waves.lean_deg", {{1, 0.0}, {97, 40.0}});
        give_keys(scene, "waves.second_order", {{20, 1.5}, {60, 0.0}}, kLinear);
    }
    return scene;
}

// Of each time that of a sea with the frame's numbers, with what footprints hide and what breaks; velocities as well, where nothing changes.
TEST(Weather, DisplacementIsThatOfThePlainNumbers) {
    for (const Kind& kind : kKinds) {
        SCOPED_TRACE(kind.name);
        const Scene scene = pressed(kind.model, kind.has_cascades);
        const auto points = random_points<double>(300.0, 300);
        auto changing = frame_over_time<double>(scene, {everything()});
        for (const double f : {-9.0, 1.0, 13.0, 49.0, 80.0, 97.0, 130.0}) {
            const double t = scene.shot.time_s(f);
            changing.set(t);
            Frame<double> still(
                std::make_shared<const Sea<double>>(make_plan(scene_at(scene, f), {everything()})));
            still.set(t);
            const auto found = sample(changing, 0, points), said = sample(still, 0, points);
            EXPECT_NEAR(changing.sea().whitecap_threshold(), still.sea().whitecap_threshold(), 1e-5) << f;
            double breaking = 0.0, as_said = 0.0;
            for (std::size_t i = 0; i < points.size(); ++i) {
                for (const VectorProduct product :
                     {VectorProduct(Displacement), VectorProduct(Normal), VectorProduct(SlopeVariance),
                      VectorProduct(Product::JacobianMoments)})
                    EXPECT_LT(glm::length(found.vectors(product)[i] - said.vectors(product)[i]), 1e-5) << f;
                if (f < 0.0 || f > 97.0) {
                    EXPECT_LT(glm::length(found.vectors(Velocity)[i] - said.vectors(Velocity)[i]), 1e-5) << f;
                }
                breaking += found.numbers(Product::Breaking)[i];
                as_said += said.numbers(Product::Breaking)[i];
            }
            EXPECT_NEAR(breaking, as_said, 1e-3 * as_said) << f;
            EXPECT_GT(as_said, 0.0);
        }
    }
}

TEST(Weather, VelocitiesHoldTheDisplacementsOwnChange) {
    for (const auto interpolation : {kLinear, kSmooth})
        for (const Kind& kind : kKinds) {
            SCOPED_TRACE(kind.name);
            Scene scene = pressed(kind.model, kind.has_cascades);
            give_keys(scene, "waves.choppiness", {{1, 1.2}, {49, 0.0}, {97, 0.6}}, interpolation);
            give_keys(scene, "sea.wind_speed_mps", {{1, 8.0}, {97, 16.0}}, interpolation);
            expect_velocities_are_rates(scene, {0.3, 1.1, 1.98, 2.1, 3.8});
        }
}

// Through a choppiness of 0, where there is next to no displacement: its velocity is the rate of the choppiness times that of 1.
TEST(Weather, VelocityIsFiniteWithoutDisplacement) {
    Scene scene = first_order(pressed());
    scene.keyed.clear();
    Scene plain = scene;
    give_keys(scene, "waves.choppiness", {{1, 0.0}, {25, 1.0}}, kLinear);  // from 0 to 1 s
    set_value(plain, key_of("waves.choppiness"), 1.0);
    const auto points = random_points<double>(400.0, 300);
    auto keyed = frame_over_time<double>(scene, {everything()}),
         still = frame_over_time<double>(plain, {everything()});
    constexpr double kSoon_s = 1e-6;  // after the key, of whose two sides this is one
    keyed.set(kSoon_s);
    still.set(kSoon_s);
    const auto found = sample(keyed, 0, points), of_one = sample(still, 0, points);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const glm::dvec3 velocity = found.vectors(Velocity)[i],
                         displacement = of_one.vectors(Displacement)[i];
        EXPECT_LT(glm::length(glm::dvec2(velocity - displacement)),
                  1e-3 * glm::length(of_one.vectors(Velocity)[i]));
        EXPECT_LT(glm::length(glm::dvec2(found.vectors(Displacement)[i])),
                  1.1e-4 * glm::length(glm::dvec2(displacement)));
    }
}

TEST(Weather, DisplacementOfAFrameAloneIsThatOfARun) {
    for (const Kind& kind : kKinds) {
        SCOPED_TRACE(kind.name);
        Scene scene = pressed(kind.model, kind.has_cascades);
        const auto points = random_points<float>(300.0, 300);
        auto run = frame_over_time<float>(scene, {everything()});
        std::vector<ProductArrays<float>> of_run;
        const std::vector<double> times{0.0, 1.0, 2.0, 3.0, 9.0};
        for (const double t : times) {
            run.set(t);
            of_run.push_back(sample(run, 0, points));
        }
        EXPECT_FALSE(same_samples(of_run[1], of_run[2]));
        for (const std::size_t i : {3, 1, 4}) {
            auto alone = frame_over_time<float>(scene, {everything()});
            alone.set(times[i]);
            EXPECT_TRUE(same_samples(sample(alone, 0, points), of_run[i])) << times[i];
        }
        // Keys that are all the same are the plain number.
        Scene plain = scene;
        plain.keyed.clear();
        plain.waves.choppiness = 0.7;
        scene = plain;
        give_keys(scene, "waves.choppiness", {{1, 0.7}, {100, 0.7}});
        auto a = frame_over_time<float>(plain, {everything()}),
             b = frame_over_time<float>(scene, {everything()});
        a.set(2.0);
        b.set(2.0);
        EXPECT_TRUE(same_samples(sample(a, 0, points), sample(b, 0, points)));
    }
}

// Whatever is planned for the shot holds at each time: no reach beyond the extent, no amplitudes held more than once.
TEST(Weather, DisplacementIsPlannedForTheLargestOfItsKeys) {
    Scene scene = pressed();
    scene.waves.choppiness = 0.1;  // as who fills Scene::keyed by hand leaves it
    give_keys(scene, "sea.wind_speed_mps", {{1, 16.0}, {97, 8.0}});
    const auto shot = prepare(scene);
    for (const double f : {1.0, 25.0, 49.0, 80.0, 97.0}) {
        const double t = scene.shot.time_s(f);
        const PreparedScene now = *prepared_at(shot, t);
        const Extent needed = extent_of(now.scene, now.spectrum, SecondOrder(), now.masks);
        EXPECT_GE(now.extent.reach_m, needed.reach_m) << f;
        EXPECT_GE(shot->extent.reach_m, now.extent.reach_m) << f;
        EXPECT_GE(shot->extent.height_m, now.extent.height_m) << f;
    }
    const Scene steady = pressed();
    Scene plain = steady;
    plain.keyed.clear();
    const Plan plan = make_plan(prepare(steady), {everything()});
    EXPECT_EQ(plan.sea_bytes(), make_plan(prepare(plain), {everything()}).sea_bytes());
    EXPECT_EQ(plan.choppiness.largest(), 1.2);
    const SeaOverTime<float> sea(plan);
    EXPECT_EQ(sea.at(0.7)->cascades().data(), sea.at(2.9)->cascades().data());
    auto frame = frame_over_time<float>(steady, {unfiltered(products(Displacement))});
    frame.set(0.0);
    FrameBounds<float> bounds(frame, 0);
    const auto points = random_points<float>(200.0, 2000);
    for (const double t : {0.0, 1.0, 2.0, 3.5}) {
        frame.set(t);
        bounds.refresh();
        const glm::dvec2 most_m = bounds.region({glm::dvec2(-100.0), glm::dvec2(100.0)}, 4096).reach_m();
        glm::vec2 reach_m(0.0f);
        for (const auto& at : sample(frame, 0, points).vectors(Displacement))
            reach_m = glm::max(reach_m, glm::abs(glm::vec2(at)));
        EXPECT_LE(static_cast<double>(reach_m.x), most_m.x) << t;
        EXPECT_LE(static_cast<double>(reach_m.y), most_m.y) << t;
        EXPECT_LT(most_m.x, 4.0 * static_cast<double>(reach_m.x)) << t;  // of this time
    }
}

TEST(Weather, DisplacementThatIsOneOrTooFastSaysSo) {
    Scene scene = pressed();
    EXPECT_TRUE(problems_of(scene).empty());
    scene.waves.cascades[1].choppiness = 0.5;
    const std::vector<Problem> problems = problems_of(scene);
    ASSERT_EQ(problems.size(), 1u);
    EXPECT_NE(text_of(problems[0]).find("waves.choppiness = { keys = [[1, 0.2], [49, 1.2], [97, 0.6]]"),
              std::string::npos);
    EXPECT_NE(text_of(problems[0]).find("is one for the whole shot"), std::string::npos);
    const auto pushes = [](std::vector<NumberKeys::Key> keys) {
        Scene fast = pressed();
        fast.keyed.clear();
        give_keys(fast, "waves.choppiness", std::move(keys), kLinear);
        const std::vector<std::string> warnings = sea_warnings(*prepare(fast));
        EXPECT_TRUE(std::ranges::none_of(warnings, [](const std::string& warning) {
            return warning.find("look like weather") != std::string::npos;
        }));
        return std::ranges::any_of(warnings, [](const std::string& warning) {
            return warning.find("waves.choppiness changes within") != std::string::npos;
        });
    };
    EXPECT_TRUE(pushes({{1, 0.2}, {49, 1.0}}));
    EXPECT_FALSE(pushes({{1, 0.2}, {480, 1.0}}));
    EXPECT_FALSE(pushes({{1, 0.9}, {49, 1.0}}));
}

// From water that the longest waves feel a little to water that most of them feel.
Scene over_depth(WaveModel model = WaveModel::Fft, bool has_cascades = true,
                 CameraInterpolation interpolation = kSmooth) {
    Scene scene = first_order(rising(model, has_cascades));
    scene.keyed.clear();
    scene.waves.choppiness = 1.0;
    scene.sea.wind_speed_mps = 9.0;
    scene.sea.fetch_m = 2e4;
    give_keys(scene, "sea.depth_m", {{25, 40.0}, {73, 4.0}, {121, 12.0}}, interpolation);
    return scene;
}

// ∫ω/2π from 0, less whole turns, by many small steps.
double turned_by(const Scene& scene, double k, double until_s) {
    constexpr int kSteps = 40000;
    double sum = 0.0;
    for (int i = 0; i < kSteps; ++i) {
        const double frame = 1.0 + (i + 0.5) * until_s / kSteps * scene.shot.fps,
                     depth_m = value_at(scene.keyed[0].keys, false, frame);
        sum +=
            std::sqrt(9.81 * k * (1.0 + 7.3e-5 / 9.81 * k * k) * std::tanh(k * depth_m)) * until_s / kSteps;
    }
    return std::remainder(sum / (2.0 * std::numbers::pi), 1.0);
}

TEST(Weather, OverADepthThatChangesPhasesAreIntegrals) {
    for (const auto interpolation : {kLinear, kSmooth}) {
        const Scene tiles = over_depth(WaveModel::Fft, true, interpolation),
                    sums = over_depth(WaveModel::Trochoid, false, interpolation);
        const SeaOverTime<double> cascades(make_plan(prepare(tiles), {everything()})),
            trains(make_plan(prepare(sums), {everything()}));
        for (const double t : {0.5, 1.7, 2.9, 3.6, 4.4, 5.0, 9.0}) {
            const auto now = trains.at(t);
            const auto phases = phases_at(now->trains(), glm::dvec2(0.0), t);
            for (const std::size_t i : {0, 7, 20}) {
                const double k = 2.0 * std::numbers::pi / now->trains().wavelength_m[i],
                             wanted = trains.first()->trains().start_cycles[i] + turned_by(sums, k, t);
                EXPECT_NEAR(std::remainder(phases[i] - wanted, 1.0), 0.0, 1e-4) << t << ' ' << i;
            }
            const auto sea = cascades.at(t);
            const Cascade<double>&is = sea->cascades()[0], &was = cascades.first()->cascades()[0];
            for (const int mx : {5, 9, 14})
                for (const int my : {-4, 0, 3}) {
                    const std::size_t mode = is.middle(mx) + my;
                    const double k = 2.0 * std::numbers::pi / is.size_m * std::hypot(mx, my);
                    ASSERT_NE(was.forward_re[mode] * is.forward_re[mode], 0.0);  // which has no phase
                    const auto cycles = [&](const Cascade<double>& of) {
                        return std::atan2(of.forward_im[mode], of.forward_re[mode]) /
                               (2.0 * std::numbers::pi);
                    };
                    const double turned = cycles(was) - cycles(is) + is.cycles_per_s[mode] * t;
                    EXPECT_NEAR(std::remainder(turned - turned_by(tiles, k, t), 1.0), 0.0, 1e-4)
                        << t << ' ' << mx;
                }
        }
        // As exact after ten weeks: the last key's frequency goes on.
        constexpr double kLate_s = 6e6, kLater_s = kLate_s + 0.25;
        const auto late = trains.at(kLate_s), later = trains.at(kLater_s);
        const auto before = phases_at(late->trains(), glm::dvec2(0.0), kLate_s),
                   after = phases_at(later->trains(), glm::dvec2(0.0), kLater_s);
        for (const std::size_t i : {0, 7, 20})
            EXPECT_NEAR(std::remainder(after[i] - before[i] - 0.25 * late->trains().cycles_per_s[i], 1.0),
                        0.0, 1e-9);
    }
}

TEST(Weather, OverADepthThatChangesVelocitiesAreRates) {
    for (const auto interpolation : {kLinear, kSmooth})
        for (const Kind& kind : kKinds) {
            SCOPED_TRACE(kind.name);
            Scene scene = over_depth(kind.model, kind.has_cascades, interpolation);
            give_keys(scene, "waves.choppiness", {{30, 0.3}, {80, 1.1}}, interpolation);
            if (kind.model == WaveModel::Fft) scene.waves.lean_deg = 20.0;
            // Phases' rates are frequencies that are right to 1e-4.
            expect_velocities_are_rates(scene, {0.5, 1.4, 2.2, 2.9, 3.9, 5.6}, 1e-4);
        }
}

// The sea ebbs to a film: waves go as the depth does, to nothing, and come back.
TEST(Weather, OverADepthThatEbbsToACentimetreStaysFinite) {
    const auto points = random_points<float>(60.0, 300);
    for (const auto interpolation : {kLinear, kSmooth})
        for (const Kind& kind : kKinds) {
            SCOPED_TRACE(kind.name);
            Scene scene = over_depth(kind.model, kind.has_cascades, interpolation);
            give_keys(scene, "sea.depth_m",
                      {{25, 10.0}, {49, 0.64}, {73, 0.04}, {80, 0.01}, {121, 0.16}, {145, 2.5}},
                      interpolation);
            auto frame = frame_over_time<float>(scene, {everything()});
            for (const double f : {24.0, 60.0, 79.9, 80.0, 80.1, 97.0, 150.0}) {
                frame.set(scene.shot.time_s(f));
                const auto of = sample(frame, 0, points);
                double highest_m = 0.0;
                for (const auto& at : of.vectors(Displacement)) {
                    ASSERT_TRUE(std::isfinite(at.x + at.y + at.z)) << f;
                    highest_m = std::max(highest_m, std::abs(static_cast<double>(at.z)));
                }
                for (const auto& values :
                     {of.vectors(Normal), of.vectors(Velocity), of.vectors(SlopeVariance)})
                    for (const auto& at : values) ASSERT_TRUE(std::isfinite(at.x + at.y + at.z)) << f;
                for (const float breaking : of.numbers(NumberProduct::checked(Product::Breaking)))
                    ASSERT_TRUE(breaking >= 0.0f && breaking <= 1.0f) << f;
                if (f == 80.0) {
                    EXPECT_LT(highest_m, 0.01);
                } else if (f == 24.0 || f == 150.0) {
                    EXPECT_GT(highest_m, 0.1);
                }
            }
        }
}

// The frequency that velocities have is how fast phases go, also where the depth changes as much as it may, and a smooth one steeply at a key.
TEST(Weather, OverADepthThatChangesFrequenciesAreThePhasesRates) {
    for (const auto interpolation : {kLinear, kSmooth})
        for (const bool is_steep : {false, true}) {
            Scene scene = over_depth(WaveModel::Trochoid, false, interpolation);
            std::vector<NumberKeys::Key> keys{{25, 64.0}, {73, 4.0}};
            if (is_steep) keys.push_back({74, 0.5});
            give_keys(scene, "sea.depth_m", keys, interpolation);
            const SeaOverTime<double> sea(make_plan(prepare(scene), {everything()}));
            for (const double frame : {26.0, 40.0, 60.0, 68.0, 70.5, 71.7, 72.5, 72.98}) {
                constexpr double h = 1e-4;
                const double t = scene.shot.time_s(frame);
                const auto phases = [&](double at_s) {
                    return phases_at(sea.at(at_s)->trains(), glm::dvec2(0.0), at_s);
                };
                const auto before = phases(t - h), after = phases(t + h);
                const auto now = sea.at(t);
                for (std::size_t i = 0; i < before.size(); ++i) {
                    const double is = now->trains().cycles_per_s[i];
                    EXPECT_NEAR(std::remainder(after[i] - before[i], 1.0) / (2.0 * h), is, 1e-4 * is)
                        << frame << ' ' << i;
                }
            }
        }
}

// Waves that are one number's at each depth: what breaks is as of a sea of that depth, by the law, of displacement gradients that its modes have.
TEST(Weather, OverADepthThatChangesWhatBreaksIsThatOfTheDepth) {
    Scene scene = over_depth();
    scene.sea.spectrum = SpectrumKind::Elfouhaily;
    scene.sea.spreading = SpreadingKind::Cosine;
    scene.effects.breaking_from_m = 8.0;
    give_keys(scene, "sea.depth_m", {{1, 20.0}, {97, 5.0}}, kLinear);
    const auto points = random_points<float>(2000.0, 20000);
    std::vector<Query> queries{filtered(products(Product::Breaking), 2.0), everything()};
    queries[1].pixel_m = {2.0, 16.0};
    queries[1].cell_m = queries[1].pixel_m;
    const auto sea = std::make_shared<const SeaOverTime<float>>(make_plan(prepare(scene), queries));
    Frame<float> frame(sea);
    for (const double f : {25.0, 49.0, 73.0}) {
        SCOPED_TRACE(f);
        const double t = scene.shot.time_s(f);
        frame.set(t);
        const Sea<float>& is = frame.sea();
        const Sea<float> still(make_plan(scene_at(scene, f), queries));
        EXPECT_NEAR(is.whitecap_threshold(), still.whitecap_threshold(), 1e-4);
        EXPECT_EQ(is.whitecap_threshold(), sea->whitecaps(t).threshold);
        for (const int query : {0, 1}) {
            const QueryStatistics &a = is.statistics(query), &b = still.statistics(query);
            ASSERT_EQ(a.resolved.size(), b.resolved.size());
            for (const auto moment :
                 {&SpectralMoments::xxxx, &SpectralMoments::xxyy, &SpectralMoments::yyyy}) {
                EXPECT_NEAR(a.whole.*moment, b.whole.*moment, 1e-3 * b.whole.*moment);
                for (std::size_t i = 0; i < a.resolved.size(); ++i)
                    EXPECT_NEAR(a.resolved[i].*moment, b.resolved[i].*moment, 1e-2 * b.whole.*moment) << i;
            }
        }
        double breaking = 0.0;
        for (const float at : sample(frame, 0, points).numbers(Product::Breaking))
            breaking += static_cast<double>(at);
        const double law = law_coverage(still.plan().from->scene);
        EXPECT_NEAR(breaking / static_cast<double>(points.size()), law, 0.15 * law);
    }
}

// What is held, to the byte where it is amplitudes.
TEST(Weather, OverADepthThatChangesBytesAreCounted) {
    const Scene scene = over_depth();
    const Plan plan = make_plan(prepare(scene), {everything()});
    const SeaOverTime<float> sea(plan);
    const auto held = [](const Sea<float>& of) {
        std::size_t bytes = 0;
        for (const Cascade<float>& cascade : of.cascades()) bytes += cascade.held_bytes();
        return bytes;
    };
    std::size_t modes = 0;
    for (const Cascade<float>& cascade : sea.first()->cascades()) modes += cascade.modes();
    // With rates of the amplitudes and of the displacement where they change.
    const std::size_t key = modes * (5 * sizeof(float) + sizeof(double)),
                      between = key + modes * 5 * sizeof(float), turns = modes * sizeof(double);
    EXPECT_EQ(held(*sea.first()), key);
    EXPECT_EQ(held(*sea.at(scene.shot.time_s(49))), between);
    EXPECT_EQ(plan.sea_bytes(), 3 * key + 2 * between + (3 + 1) * turns);
}

// At a key a rate is the mean of both sides, whichever way its time is rounded.
TEST(Weather, KnowsItsKeysByTheirTimes) {
    Scene scene;
    scene.waves.model = WaveModel::Fft;
    for (const double fps : {25.0, 24.0, 30000.0 / 1001.0})
        for (const double offset_s : {0.0, 0.3, -1234.5}) {
            scene.shot.fps = fps;
            scene.shot.time_offset_s = offset_s;
            scene.shot.time_scale = 0.7;
            for (int frame = -50; frame <= 500; ++frame)
                ASSERT_EQ(frame_at(scene.shot, scene.shot.time_s(frame)), frame) << fps;
        }
    scene.shot = {};
    scene.shot.fps = 25.0;
    give_keys(scene, "waves.choppiness", {{1, 0.2}, {29, 1.0}, {43, 1.0}}, kLinear);
    const auto at = displacement_at(*prepare(scene), scene.shot.time_s(29));
    ASSERT_TRUE(at);
    EXPECT_NEAR(at->share_per_s, 0.5 * 0.8 / 28.0 * 25.0, 1e-12);
}

// A frame alone is that of a run; beyond the keys it is a sea of their depth; heights are those of the spectrum between.
TEST(Weather, OverADepthThatChangesEachTimeIsItsOwn) {
    for (const Kind& kind : kKinds) {
        SCOPED_TRACE(kind.name);
        const Scene scene = over_depth(kind.model, kind.has_cascades);
        const auto points = random_points<float>(300.0, 300);
        auto run = frame_over_time<float>(scene, {everything()});
        std::vector<ProductArrays<float>> of_run;
        const std::vector<double> times{0.5, 1.0, 2.0, 3.0, 3.5, 9.0};
        std::vector<double> heights;
        for (const double t : times) {
            run.set(t);
            of_run.push_back(sample(run, 0, points));
            heights.push_back(run.realisation(0).m0 / run.sea().total().m0);
        }
        for (const double height : heights) EXPECT_NEAR(std::sqrt(height / heights[0]), 1.0, 0.02);
        for (const std::size_t i : {4, 2, 0, 5}) {
            auto alone = frame_over_time<float>(scene, {everything()});
            alone.set(times[i]);
            EXPECT_TRUE(same_samples(sample(alone, 0, points), of_run[i])) << times[i];
        }
        if (kind.model == WaveModel::Trochoid)
            continue;  // whose directions are those of the mean of the keys
        Frame<float> still(
            std::make_shared<const Sea<float>>(make_plan(scene_at(scene, 1.0), {everything()})));
        still.set(0.5);
        const auto as_said = sample(still, 0, points);
        for (std::size_t i = 0; i < points.size(); ++i) {
            EXPECT_LT(glm::length(of_run[0].vectors(Displacement)[i] - as_said.vectors(Displacement)[i]),
                      1e-4f);
            EXPECT_LT(glm::length(of_run[0].vectors(Velocity)[i] - as_said.vectors(Velocity)[i]), 1e-4f);
        }
    }
}

// Single precision against double, where the depth changes eleven days after t = 0, and long after it has.
TEST(Weather, OverADepthThatChangesPhasesAreExactLate) {
    for (const Kind& kind : kKinds) {
        SCOPED_TRACE(kind.name);
        Scene late = over_depth(kind.model, kind.has_cascades), early = late;
        late.shot.time_offset_s = 1e6;
        for (const auto& [scene, time_s] :
             {std::pair(&late, late.shot.time_s(50)), std::pair(&early, 1e6 + 0.3)}) {
            auto single = frame_over_time<float>(*scene, {everything()});
            auto twice = frame_over_time<double>(*scene, {everything()});
            single.set(time_s);
            twice.set(time_s);
            const auto a = sample(single, 0, random_points<float>(300.0, 300));
            const auto b = sample(twice, 0, random_points<double>(300.0, 300));
            const double height_m = twice.sea().total().significant_height_m();
            double off = 0.0;
            for (std::size_t i = 0; i < 300; ++i)
                off = std::max(
                    off, glm::length(glm::dvec3(a.vectors(Displacement)[i]) - b.vectors(Displacement)[i]));
            EXPECT_LT(off, 1e-3 * height_m) << time_s;
        }
    }
}

TEST(Weather, OverADepthThatChangesWhatHasOneDepthIsRefused) {
    const auto problem = [](const std::function<void(Scene&)>& change) {
        Scene scene = over_depth();
        change(scene);
        std::string texts;
        for (const Problem& found : validate(scene)) texts += text_of(found) + '\n';
        return texts;
    };
    const auto says = [&](const std::function<void(Scene&)>& change, const char* what) {
        const std::string found = problem(change);
        EXPECT_NE(found.find(what), std::string::npos) << what << '\n' << found;
    };
    EXPECT_EQ(problem([](Scene&) {}), "");
    says([](Scene& scene) { scene.waves.second_order = 1.0; }, "what pairs of waves add");
    says([](Scene& scene) { scene.waves.vessels = {Vessel{}}; }, "wakes are worked out for one depth");
    says([](Scene& scene) { scene.sea.depth_file = "floor.exr"; }, "the floor of sea.depth_file stays");
    says([](Scene& scene) { scene.waves.heroes = {HeroWave{}}; }, "hero waves stand in one sea");
    says([](Scene& scene) { scene.shot.loop_s = 2.0; }, "a loop has no beginning");
    says(
        [](Scene& scene) {
            give_keys(scene, "sea.depth_m", {{1, 2.0}, {50, 40.0}});
        },
        "changes more than 16 times from frame 1 to 50");
    says(
        [](Scene& scene) {
            give_keys(scene, "sea.depth_m", {{1, 2.0}, {50, std::numeric_limits<double>::infinity()}});
        },
        "no depth is between");
    says(
        [](Scene& scene) {
            scene.objects = {SceneObject{}};
            scene.objects[0].floats = true;
            scene.objects[0].buoyancy = Buoyancy::Response;
        },
        "answers waves of one depth");
}

// Each key's sea must be one that there can be, with what the other numbers are there.
TEST(Weather, OfImpossibleWavesIsRefusedWithItsFrame) {
    Scene scene;
    scene.effects.foam_decay_s = 0.0;
    scene.sea.depth_m = 10.0;
    give_keys(scene, "sea.wind_speed_mps", {{1, 12.0}, {9, 15.0}});
    give_keys(scene, "sea.significant_height_m", {{1, 1.0}, {20, 8.0}});
    const std::vector<Problem> problems = problems_of(scene);
    ASSERT_EQ(problems.size(), 1u);
    EXPECT_EQ(problems[0].key, "sea.significant_height_m");
    EXPECT_EQ(problems[0].value, "8 at frame 20");
}

TEST(Weather, IsRefusedWhereTheSeaIsOne) {
    const Plan plan = make_plan(rising(), {everything()});
    try {
        const Sea<float> sea(plan);
        FAIL();
    } catch (const std::invalid_argument& error) {
        EXPECT_EQ(
            std::string(error.what()),
            "sea.wind_speed_mps has keys, and this shows one moment; accepted: a number, or the scene of a frame (in "
            "Python scene.at(frame), in C++ scene_at())");
    }
    const auto problem = [](const std::function<void(Scene&)>& change) {
        Scene scene = rising();
        change(scene);
        std::string texts;
        for (const Problem& found : validate(scene)) texts += text_of(found) + '\n';
        return texts;
    };
    EXPECT_EQ(problem([](Scene&) {}), "");
    EXPECT_EQ(problem([](Scene& scene) { scene.effects.spray = true; }), "");
    EXPECT_NE(
        problem([](Scene& scene) {
            scene.effects.spray = true;
            give_keys(scene, "sea.wind_direction_deg", {{1, 0.0}, {240, 90.0}});
        })
            .find("sea.wind_direction_deg = { keys = [[1, 0], [240, 90]], interpolation = \"smooth\" }: "
                  "changes, and spray is torn along one wind"),
        std::string::npos);
    EXPECT_NE(problem([](Scene& scene) {
                  scene.effects.spray = scene.effects.spray_drops = true;
              }).find("drops of spray fly in one sea"),
              std::string::npos);
    EXPECT_NE(problem([](Scene& scene) {
                  scene.waves.model = WaveModel::Trochoid;
                  give_keys(scene, "sea.wind_direction_deg", {{1, 0.0}, {240, 90.0}});
              }).find("a train keeps its direction"),
              std::string::npos);
    EXPECT_NE(problem([](Scene& scene) { scene.shot.time_scale = 0.0; }).find("which stands still"),
              std::string::npos);
    EXPECT_NE(problem([](Scene& scene) { scene.shot.loop_s = 2.0; }).find("a loop has no beginning"),
              std::string::npos);
    EXPECT_EQ(problem([](Scene& scene) {
                  scene.effects.spray = true;
                  give_keys(scene, "sea.wind_speed_mps", {{1, 9.0}, {2, 9.0}});
              }),
              "");
}

}  // namespace
}  // namespace pelagic
