// Building a Sea: the vectors' way against the plain one; what each part of it depends on; progress.
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstring>
#include <limits>
#include <thread>

#include "core/base/random.h"
#include "core/waves/loop.h"
#include "core/waves/mode_kernels.h"
#include "tests/core/waves/reference_sea.h"
#include "tests/core/waves/samples.h"

namespace pelagic {
namespace {

using namespace test;

template <class T>
std::vector<std::complex<double>> complex_of(const Buffer<T>& re, const Buffer<T>& im) {
    std::vector<std::complex<double>> out(re.size());
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = {double(re[i]), double(im[i])};
    return out;
}

void expect_moments(const SpectralMoments& ours, const SpectralMoments& reference) {
    const double gradient = reference.xxxx + 2.0 * reference.xxyy + reference.yyyy;
    const auto near = [&](double SpectralMoments::*m, double scale) {
        EXPECT_NEAR(ours.*m, reference.*m, 1e-4 * scale);
    };
    for (auto m : {&SpectralMoments::m0, &SpectralMoments::east, &SpectralMoments::north})
        near(m, reference.m0);
    near(&SpectralMoments::m_minus1, reference.m_minus1);
    for (auto m : {&SpectralMoments::xx, &SpectralMoments::xy, &SpectralMoments::yy})
        near(m, reference.mss());
    for (auto m : {&SpectralMoments::xxxx, &SpectralMoments::xxxy, &SpectralMoments::xxyy,
                   &SpectralMoments::xyyy, &SpectralMoments::yyyy})
        near(m, gradient);
}

void expect_reference(const Plan& plan) {
    const Sea<double> sea(plan);
    const oracle::ReferenceSea reference = oracle::reference_sea(plan);
    for (std::size_t c = 0; c < plan.cascades.size(); ++c) {
        const auto& expected = reference.cascades[c];
        EXPECT_NEAR(sea.expected_m0(static_cast<int>(c)), expected.expected_m0, 1e-4 * expected.expected_m0);
        const Cascade<double>& built = sea.cascades()[c];
        const auto forward = complex_of(built.forward_re, built.forward_im);
        const auto backward = complex_of(built.backward_re, built.backward_im);
        ASSERT_EQ(forward.size(), expected.forward.size());
        // The surface's own difference, Σ|Δh|². Against the wind cos²ˢ(θ/2) has a cusp where s < ½: the few
        // cells that it crosses are off by up to 2 % of their little energy.
        double off = 0.0, all = 0.0;
        for (std::size_t i = 0; i < forward.size(); ++i) {
            off +=
                std::norm(forward[i] - expected.forward[i]) + std::norm(backward[i] - expected.backward[i]);
            all += std::norm(expected.forward[i]) + std::norm(expected.backward[i]);
        }
        EXPECT_LE(std::sqrt(off), 5e-4 * std::sqrt(all)) << "cascade " << c;
    }
    for (std::size_t q = 0; q < plan.queries.size(); ++q) {
        const QueryStatistics& statistics = sea.statistics(static_cast<int>(q));
        for (std::size_t i = 0; i < statistics.resolved.size(); ++i)
            expect_moments(statistics.resolved[i], reference.resolved[q][i]);
        for (std::size_t i = 0; i < statistics.resolved_next.size(); ++i)
            expect_moments(statistics.resolved_next[i], reference.resolved_next[q][i]);
    }
}

Scene windy() {
    Scene scene;
    scene.sea.wind_speed_mps = 12.0;
    scene.sea.wind_direction_deg = 33.0;
    scene.sea.swell = {{.height_m = 1.0, .period_s = 11.0, .direction_deg = 80.0}};
    return scene;
}
// Levels of footprints through all cascades.
Query levels() {
    Query query = unfiltered(products(Product::Normal, Product::SlopeVariance));
    query.pixel_m = {0.3, 0.5};
    while (query.pixel_m.back() < 500.0) query.pixel_m.push_back(2.0 * query.pixel_m.back());
    query.cell_m = {0.5};
    return query;
}

TEST(Construction, GivesTheReferencesSea) {
    expect_reference(make_plan(windy(), {levels(), unfiltered(products(Product::Position))}));
}

TEST(Construction, GivesTheReferencesSeaInShallowWaterAndALoop) {
    Scene scene = windy();
    scene.sea.depth_m = 3.0;
    scene.sea.spectrum = SpectrumKind::Tma;
    scene.sea.spreading = SpreadingKind::DonelanBanner;
    scene.waves.cascades = {{300.0, 96}, {40.0, 64}};
    scene.waves.choppiness = 0.8;
    expect_reference(make_plan(scene, {filtered(products(Product::Normal, Product::SlopeVariance), 0.9),
                                       tile(products(Product::SlopeVariance), 1, 40.0, 64)}));
}

// Drawn in vectors: the numbers that normal_pair() gives, to rounding, in every lane and for negative modes.
TEST(ModeKernels, DrawTheNumbersOfNormalPair) {
    constexpr int kCount = 37;
    const std::vector<double> energy(kCount + 16, 4.0);
    std::vector<double> re(kCount, 0.0), im(re), back_re(re), back_im(re);
    for (const std::uint64_t seed : {std::uint64_t{1}, std::uint64_t{1} << 40, (std::uint64_t{1} << 63) - 1})
        for (int mx : {0, 5, 4095}) {
            mode_kernels<double>().amplitudes({.energy = energy.data(),
                                               .opposite = energy.data(),
                                               .mx = mx,
                                               .first_my = -18,
                                               .count = kCount,
                                               .cascade = 3,
                                               .seed = seed,
                                               .forward_re = re.data(),
                                               .forward_im = im.data(),
                                               .backward_re = back_re.data(),
                                               .backward_im = back_im.data()});
            for (int i = 0; i < kCount; ++i) {
                const int my = i - 18;
                const auto pair = [&](int x, int y) {
                    return normal_pair({3u, static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), 0u},
                                       seed);
                };
                const auto with = pair(mx, my), against = pair(-mx, -my);
                ASSERT_NEAR(re[i], with[0], 1e-14);
                ASSERT_NEAR(im[i], with[1], 1e-14);
                ASSERT_NEAR(back_re[i], against[0], 1e-14);
                ASSERT_NEAR(back_im[i], -against[1], 1e-14);
            }
        }
}

TEST(ModeKernels, HaveTheDispersionOfEveryDepth) {
    constexpr int kCount = 21;
    for (double depth : {0.01, 2.0, 40.0, std::numeric_limits<double>::infinity()})
        for (double loop_s : {0.0, 10.0}) {
            std::vector<double> cycles(kCount), chop(kCount);
            const Dispersion dispersion{depth};
            const double step = 0.02;
            for (int mx : {0, 1, 300}) {
                mode_kernels<double>().frequencies({.mx = mx,
                                                    .first_my = -10,
                                                    .count = kCount,
                                                    .step = step,
                                                    .dispersion = dispersion,
                                                    .loop_s = loop_s,
                                                    .choppiness = 0.7,
                                                    .cycles_per_s = cycles.data(),
                                                    .chop = chop.data()});
                for (int i = 0; i < kCount; ++i) {
                    const double k = step * std::hypot(mx, i - 10);
                    if (k == 0.0) {
                        EXPECT_EQ(cycles[i], 0.0);
                        EXPECT_EQ(chop[i], 0.0);
                        continue;
                    }
                    EXPECT_NEAR(cycles[i] / looped_cycles_per_s(dispersion.omega(k), loop_s), 1.0, 2e-15);
                    EXPECT_NEAR(chop[i] / (0.7 * dispersion.horizontal_ratio(k) / k), 1.0, 4e-15);
                }
            }
        }
}

bool same_bits(const SpectralMoments& a, const SpectralMoments& b) {
    return std::memcmp(&a, &b, sizeof a) == 0;
}

// A frame's bits depend on its own query: neither amplitudes nor sums change with what else is asked for.
TEST(Construction, OfOneQueryDependsOnNoOther) {
    Scene scene = windy();
    scene.waves.cascades = {{300.0, 160}, {60.0, 160}};
    const Query query = levels();
    Query other = levels();
    for (double& footprint_m : other.pixel_m) footprint_m *= 0.77;
    const Sea<float> alone(make_plan(scene, {query}));
    const Sea<float> together(
        make_plan(scene, {query, other, filtered(products(Product::Normal, Product::SlopeVariance), 0.05),
                          tile(products(Product::SlopeVariance), 0, 300.0, 320)}));
    const QueryStatistics &a = alone.statistics(0), &b = together.statistics(0);
    for (std::size_t i = 0; i < a.resolved.size(); ++i)
        EXPECT_TRUE(same_bits(a.resolved[i], b.resolved[i])) << i;
    for (std::size_t i = 0; i < a.resolved_next.size(); ++i)
        EXPECT_TRUE(same_bits(a.resolved_next[i], b.resolved_next[i])) << i;
    for (int c = 0; c < 2; ++c) {
        const Cascade<float>&few = alone.cascades()[c], &many = together.cascades()[c];
        for (int mx = 0; mx < few.radius; ++mx)
            for (int my = -half_height(few.radius, mx); my <= half_height(few.radius, mx); ++my) {
                ASSERT_EQ(few.forward_re[few.middle(mx) + my], many.forward_re[many.middle(mx) + my]);
                ASSERT_EQ(few.backward_im[few.middle(mx) + my], many.backward_im[many.middle(mx) + my]);
            }
    }
}

TEST(Construction, OnAnyNumberOfThreadsGivesTheSameBits) {
    const Plan plan = make_plan(windy(), {levels()});
    const auto built = [&](std::size_t threads) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        return Sea<float>(plan);
    };
    const Sea<float> one = built(1);
    for (std::size_t threads : {2, 5}) {
        const Sea<float> many = built(threads);
        for (std::size_t i = 0; i < one.statistics(0).resolved.size(); ++i)
            EXPECT_TRUE(same_bits(one.statistics(0).resolved[i], many.statistics(0).resolved[i])) << i;
        for (std::size_t c = 0; c < one.cascades().size(); ++c) {
            const Cascade<float>&a = one.cascades()[c], &b = many.cascades()[c];
            ASSERT_EQ(a.modes(), b.modes());
            if (a.modes() == 0) continue;
            for (const auto part :
                 {&Cascade<float>::forward_re, &Cascade<float>::forward_im, &Cascade<float>::backward_re,
                  &Cascade<float>::backward_im, &Cascade<float>::chop})
                EXPECT_EQ(std::memcmp((a.*part).data(), (b.*part).data(), a.modes() * sizeof(float)), 0);
            EXPECT_EQ(one.expected_m0(static_cast<int>(c)), many.expected_m0(static_cast<int>(c)));
        }
    }
}

TEST(Construction, TellsHowFarItIsAndStops) {
    const Plan plan = make_plan(windy(), {levels()});
    std::vector<double> told;
    const BuildWatch watch{.progress = [&](double done) { told.push_back(done); }, .cancel = nullptr};
    const Sea<float> sea(plan, watch);
    ASSERT_GT(told.size(), 3u);
    EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
    EXPECT_GT(told.front(), 0.0);
    EXPECT_EQ(told.back(), 1.0);

    std::atomic<bool> cancel = false;
    int calls = 0;
    const BuildWatch stopping{.progress = [&](double) { cancel = ++calls == 2; }, .cancel = &cancel};
    EXPECT_THROW(Sea<float>(plan, stopping), BuildCancelled);
}

// While it waits for tasks of its own, its thread takes up none of the sea's: it would wait for itself.
TEST(Construction, WhoIsToldMayWorkOnAllThreads) {
    int calls = 0;
    const BuildWatch watch{.progress =
                               [&](double) {
                                   ++calls;
                                   tbb::parallel_for(0, 32, [](int) {
                                       std::this_thread::sleep_for(std::chrono::milliseconds(1));
                                   });
                               },
                           .cancel = nullptr};
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, 4);
    for (int i = 0; i < 20; ++i)
        tbb::task_arena(4).execute([&] { Sea<float>(make_plan(windy(), {levels()}), watch); });
    EXPECT_GT(calls, 60);
}

}  // namespace
}  // namespace pelagic
