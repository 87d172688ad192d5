// Wave trains: the energy of their range, what a footprint hides, directions and phases.
#include "core/waves/trains.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <cstdint>
#include <limits>

#include "core/base/constants.h"
#include "core/waves/loop.h"

namespace pelagic {
namespace {

constexpr double kForever = std::numeric_limits<double>::infinity();

Scene trochoid() {
    Scene scene;
    scene.waves.model = WaveModel::Trochoid;
    return scene;
}

Trains<double> trains_of(const Scene& scene, double footprint_m = 0.0) {
    return make_trains<double>(*prepare(scene), *resolve_trains(*prepare(scene), footprint_m));
}

// One train of given steepness kh, 10 m long, from a swell whose whole spectrum is within the range.
Scene one_train(double kh, double choppiness) {
    Scene scene = trochoid();
    scene.sea.wind_speed_mps = 0.0;
    const double wavelength_m = 10.0, omega = Dispersion{}.omega(kTwoPi / wavelength_m);
    const double h = kh * wavelength_m / kTwoPi;
    scene.sea.swell = {
        {.height_m = 4.0 * h / std::sqrt(2.0), .period_s = kTwoPi / omega, .direction_deg = 30.0}};
    scene.waves.trains = 1;
    scene.waves.longest_m = 1e3;
    scene.waves.shortest_m = 0.1;
    scene.waves.choppiness = choppiness;
    return scene;
}

std::vector<Scene> many_seas() {
    std::vector<Scene> scenes;
    for (const SpectrumKind kind : {SpectrumKind::PiersonMoskowitz, SpectrumKind::Jonswap, SpectrumKind::Tma,
                                    SpectrumKind::Elfouhaily, SpectrumKind::Omega2, SpectrumKind::Phillips})
        for (const double wind_mps : {1.0, 10.0, 40.0})
            for (const double depth_m : {3.0, kForever}) {
                Scene scene = trochoid();
                scene.sea.spectrum = kind;
                scene.sea.wind_speed_mps = wind_mps;
                scene.sea.depth_m = depth_m;
                scenes.push_back(scene);
            }
    scenes.push_back(trochoid());
    scenes.back().sea.swell = {{.height_m = 1.5, .period_s = 11.0, .direction_deg = 80.0}};
    scenes.push_back(trochoid());
    scenes.back().sea.fetch_m = 1.0;
    return scenes;
}

TEST(TrainsPlan, DefaultRangeHoldsTheSea) {
    for (const Scene& scene : many_seas()) {
        const TrainsPlan plan = *resolve_trains(*prepare(scene), 0.0);
        EXPECT_EQ(plan.count, 250);
        EXPECT_LE(plan.shortest_m, 0.02);
        const DirectionalSpectrum spectrum(scene.sea);
        // 0.1 % lies above the range by design; below 2 cm a sea of one metre of fetch has the most.
        EXPECT_GE(moments(spectrum, kTwoPi / plan.longest_m, kTwoPi / plan.shortest_m).m0,
                  0.985 * spectrum.m0());
    }
}

TEST(TrainsPlan, TenTrainsAreBelowThePixel) {
    Scene scene = trochoid();
    scene.sea.short_waves = ShortWaves::None;  // Elfouhaily's end at some millimetres
    for (const double footprint_m : {0.005, 0.02, 0.1, 1.0, 30.0, 1000.0}) {
        const TrainsPlan plan = *resolve_trains(*prepare(scene), footprint_m);
        EXPECT_GE(plan.below_pixel, 10) << footprint_m;
        EXPECT_LE(plan.shortest_m, 0.02);
        int below = 0;
        for (const double wavelength_m : trains_of(scene, footprint_m).wavelength_m)
            below += wavelength_m < 2.0 * footprint_m;
        EXPECT_EQ(below, plan.below_pixel);
    }
    EXPECT_LT(resolve_trains(*prepare(scene), 0.005)->shortest_m,
              0.01);  // or all trains would be visible
    Scene few = scene;
    few.waves.trains = 8;
    EXPECT_GE(resolve_trains(*prepare(few), 0.5)->below_pixel, 4);
}

TEST(TrainsPlan, AGivenRangeIsKept) {
    Scene scene = trochoid();
    scene.waves.longest_m = 30.0;
    scene.waves.shortest_m = 0.02;
    TrainsPlan plan = *resolve_trains(*prepare(scene), 1e-3);
    EXPECT_EQ(plan.longest_m, 30.0);
    EXPECT_EQ(plan.shortest_m, 0.02);
    EXPECT_EQ(plan.below_pixel, 0);
    scene.waves.longest_m.reset();
    scene.waves.shortest_m = 5000.0;  // longer than any wave of this sea
    plan = *resolve_trains(*prepare(scene), 1.0);
    EXPECT_EQ(plan.shortest_m, 5000.0);
    EXPECT_EQ(plan.longest_m, 50000.0);
    scene.waves.longest_m = 0.005;
    scene.waves.shortest_m.reset();
    EXPECT_EQ(resolve_trains(*prepare(scene), 1.0)->shortest_m, 0.0005);
}

TEST(TrainsPlan, CascadesTakeOverWhereTheirLargestTileCan) {
    Scene scene = trochoid();
    scene.waves.cascades = {{80.0, 256}, {20.0, 256}};
    EXPECT_EQ(resolve_trains(*prepare(scene), 0.1)->shortest_m, 10.0);  // eight of them fit into the tile
}

// Bins of equal ratio, a train in each, at the mean wavenumber of the bin's energy.
TEST(Trains, AreTheMeansOfAGeometricProgression) {
    Scene scene = trochoid();
    scene.waves.trains = 60;
    const TrainsPlan plan = *resolve_trains(*prepare(scene), 0.5);
    const auto trains = trains_of(scene, 0.5);
    ASSERT_EQ(trains.count(), 60u);
    const double ratio = std::pow(plan.longest_m / plan.shortest_m, 1.0 / 60.0);
    const DirectionalSpectrum spectrum(scene.sea);
    for (int i = 0; i < 60; ++i) {
        EXPECT_NEAR(plan.edge_m(i) / plan.edge_m(i + 1), ratio, 1e-12);
        const double from = kTwoPi / plan.edge_m(i), to = kTwoPi / plan.edge_m(i + 1);
        double energy = 0.0, mean = 0.0;
        for (int n = 0; n < 4000; ++n) {
            const double k = from + (to - from) * (n + 0.5) / 4000;
            energy += spectrum.omnidirectional(k);
            mean += k * spectrum.omnidirectional(k);
        }
        EXPECT_NEAR(trains.wavelength_m[static_cast<std::size_t>(i)] * mean / energy / kTwoPi, 1.0, 1e-5)
            << i;
    }
}

// The integrals of the bins and of the band split at different places; each is exact to 1e-7.
TEST(Trains, HoldTheEnergyOfTheirRange) {
    for (const Scene& scene : many_seas())
        for (const int count : {1, 7, 60, 1000}) {
            Scene with = scene;
            with.waves.trains = count;
            const TrainsPlan plan = *resolve_trains(*prepare(with), 0.0);
            const double m0 =
                moments(DirectionalSpectrum(with.sea), kTwoPi / plan.longest_m, kTwoPi / plan.shortest_m).m0;
            double sum = 0.0;
            for (const double h : trains_of(with).height_m) sum += 0.5 * h * h;
            EXPECT_NEAR(sum, m0, 1e-6 * m0) << count;
        }
}

template <class T>
std::size_t bytes(const Trains<T>& trains) {
    const auto of = [](const auto&... list) { return ((list.size() * sizeof(list[0])) + ...); };
    std::size_t sum =
        of(trains.kx_cycles_per_m, trains.ky_cycles_per_m, trains.cycles_per_s, trains.start_cycles,
           trains.height_m, trains.horizontal_m, trains.wavelength_m, trains.alone, trains.before,
           trains.from, trains.unresolved_alone, trains.unresolved_from, trains.wavelength, trains.breaking);
    for (const auto& amplitude : trains.amplitude) sum += of(amplitude);
    return sum;
}

TEST(Trains, TakeThePlansBytes) {
    Scene scene = trochoid();
    scene.waves.trains = 7;
    const auto prepared = prepare(scene);
    const TrainsPlan plan = *resolve_trains(*prepared, 0.0);
    EXPECT_EQ(bytes(make_trains<float>(*prepared, plan)), plan.sea_bytes(false));
    EXPECT_EQ(bytes(make_trains<double>(*prepared, plan)), plan.sea_bytes(true));
}

TEST(Trains, OfACalmSeaAreFlat) {
    Scene scene = trochoid();
    scene.sea.wind_speed_mps = 0.0;
    const auto trains = trains_of(scene, 1.0);
    ASSERT_EQ(trains.count(), 250u);
    for (std::size_t i = 0; i < trains.count(); ++i) {
        EXPECT_EQ(trains.height_m[i], 0.0);
        EXPECT_EQ(trains.horizontal_m[i], 0.0);
        EXPECT_TRUE(std::isfinite(trains.cycles_per_s[i]));
    }
    for (const auto m : kSpectralMoments) EXPECT_EQ(total(trains).*m, 0.0);
}

// (kh)²/2 along the train's direction by position at rest, as of a cascade's modes, whatever it is shown with.
TEST(TrainVariance, OfOneTrochoidIsThatOfASine) {
    for (const double kh : {0.9, 0.3, 1e-7})
        for (const double choppiness : {0.0, 1.0})
            for (const double footprint_m : {0.0, 3.0}) {
                const auto trains = trains_of(one_train(kh, choppiness));
                const FootprintFilter filter;
                const double k = kTwoPi / trains.wavelength_m[0];
                const double q = filter.weight(k, footprint_m) * k * trains.height_m[0], closed = 0.5 * q * q;
                const SpectralMoments shown = resolved(trains, filter, footprint_m);
                const double x = trains.kx_cycles_per_m[0] * trains.wavelength_m[0];
                const double y = trains.ky_cycles_per_m[0] * trains.wavelength_m[0];
                EXPECT_NEAR(shown.xx, closed * x * x, 1e-12 * kh * kh);
                EXPECT_NEAR(shown.xy, closed * x * y, 1e-12 * kh * kh);
                EXPECT_NEAR(shown.yy, closed * y * y, 1e-12 * kh * kh);
            }
}

TEST(Trains, ThatWouldLoopAreLimited) {
    for (const double choppiness : {1.0, 10.0}) {
        const auto trains = trains_of(one_train(5.0, choppiness));
        const double k = kTwoPi / trains.wavelength_m[0];
        EXPECT_NEAR(k * trains.height_m[0], 5.0, 0.03);  // the energy is unchanged
        EXPECT_LE(k * trains.horizontal_m[0], 1.0 + 1e-15);
        EXPECT_NEAR(trains.alone[0].mss(), 12.5, 0.15);  // (kh)²/2
        for (const double footprint_m : {0.0, 2.7, 3.0, 4.0, 1e3})
            for (const auto m : kSpectralMoments) {
                EXPECT_TRUE(std::isfinite(resolved(trains, {}, footprint_m).*m));
                EXPECT_TRUE(std::isfinite(unresolved(trains, {}, footprint_m).*m));
            }
    }
}

// Shown and unresolved variances add up to the total for every footprint.
TEST(TrainVariance, ResolvedAndUnresolvedAreTheWhole) {
    for (const Scene& scene : many_seas()) {
        const auto trains = trains_of(scene);
        const SpectralMoments all = total(trains);
        const FootprintFilter filter;
        for (double footprint_m = 1e-3; footprint_m < 1e4; footprint_m *= 1.3) {
            SpectralMoments both = resolved(trains, filter, footprint_m);
            const SpectralMoments rest = unresolved(trains, filter, footprint_m);
            both += rest;
            // Sums of at most 70 terms of either sign.
            for (const auto m : kSpectralMoments)
                EXPECT_NEAR(both.*m, all.*m,
                            1e-14 * (all.xx + all.yy + all.xxxx + all.yyyy + all.m0 + all.m_minus1));
            for (const auto m : {&SpectralMoments::m0, &SpectralMoments::m_minus1, &SpectralMoments::xx,
                                 &SpectralMoments::yy, &SpectralMoments::xxxx, &SpectralMoments::xxyy,
                                 &SpectralMoments::yyyy})
                EXPECT_GE(rest.*m, 0.0);
            EXPECT_LE(rest.xy * rest.xy, rest.xx * rest.yy * (1.0 + 1e-12));
        }
        for (const auto m : kSpectralMoments) {
            EXPECT_EQ(unresolved(trains, filter, 0.0).*m, trains.outside.*m);
            EXPECT_EQ(resolved(trains, filter, 1e9).*m, 0.0);
            EXPECT_EQ(unresolved(trains, filter, 1e9).*m, all.*m);
        }
    }
}

// The moments outside the range are the spectrum's, on both sides.
TEST(TrainVariance, OutsideTheRangeIsTheRestOfTheSpectrum) {
    Scene scene = trochoid();
    scene.effects.breaking_from_m = 0.0;
    scene.waves.choppiness = 0.5;
    scene.waves.longest_m = 30.0;  // the paper's range: most of this sea is longer
    scene.waves.shortest_m = 0.02;
    const auto trains = trains_of(scene);
    const DirectionalSpectrum spectrum(scene.sea);
    SpectralMoments rest = moments(spectrum, 0.0, kTwoPi / 30.0);
    EXPECT_GT(rest.m0, 0.5 * spectrum.m0());
    rest += moments(spectrum, kTwoPi / 0.02, kForever);
    rest.scale_gradients(0.25);
    // And what the bins have and their trains lack: slopes and gradients, never energy.
    for (const auto m : {&SpectralMoments::m0, &SpectralMoments::m_minus1, &SpectralMoments::east})
        EXPECT_EQ(trains.outside.*m, rest.*m);
    for (const auto m : {&SpectralMoments::xx, &SpectralMoments::yy, &SpectralMoments::xxxx}) {
        EXPECT_GT(trains.outside.*m, rest.*m);
        EXPECT_LT(trains.outside.*m, rest.*m + 0.005 * moments(spectrum, 0.0, kForever).*m);
    }
    EXPECT_NEAR(total(trains).m0, spectrum.m0(), 1e-6 * spectrum.m0());
}

// The trains' moments agree with the spectrum's up to two effects. A trochoid of steepness q has a slope
// variance larger by 2/(1 + √(1 − q²)) ≤ 1 + q²/2, here below 1 %. And a bin's slope differs from that at its
// middle by its width squared, (ln 1.17)²/24, times a factor of up to 4.
TEST(TrainVariance, OfAllTrainsIsTheSpectrums) {
    for (const double choppiness : {0.1, 0.8}) {
        Scene scene = trochoid();
        scene.waves.choppiness = choppiness;
        scene.effects.breaking_from_m = 0.0;
        const SpectralMoments all = total(trains_of(scene));
        SpectralMoments wanted = moments(DirectionalSpectrum(scene.sea), 0.0, kForever);
        wanted.scale_gradients(choppiness * choppiness);
        EXPECT_NEAR(all.m0, wanted.m0, 1e-6 * wanted.m0);
        EXPECT_NEAR(all.mss(), wanted.mss(), 0.01 * wanted.mss());
        EXPECT_NEAR(all.xxxx + 2.0 * all.xxyy + all.yyyy, wanted.xxxx + 2.0 * wanted.xxyy + wanted.yyyy,
                    0.01 * wanted.mss());
    }
}

// Over seeds, the energy-weighted means of k̂ and of its square are the spectrum's. The standard error over
// 400 seeds is √(Σh⁴)/(Σh² √400), some 0.02 (a dozen trains hold the energy); the tolerance is three times
// that.
// Down to one train for everything: no steeper than the spectrum, and what it lacks is unresolved.
TEST(TrainVariance, OfFewTrainsIsTheSpectrumsToo) {
    for (Scene scene : many_seas())
        for (const int count : {1, 2, 5, 20}) {
            scene.waves.trains = count;
            const Trains<double> trains = trains_of(scene);
            const SpectralMoments spectrum =
                moments(DirectionalSpectrum(scene.sea), 0.0, std::numeric_limits<double>::infinity());
            double shown = 0.0, energy = 0.0;
            for (const SpectralMoments& alone : trains.alone) {
                shown += alone.mss();
                energy += alone.m0;
            }
            EXPECT_GE(energy, 0.98 * spectrum.m0) << count;
            // A trochoid of steepness q has up to 2 times the slopes of its sinusoid; these are at most 7 % above it.
            EXPECT_LE(shown, 1.07 * spectrum.mss()) << count;
            EXPECT_NEAR(total(trains).mss() / spectrum.mss(), 1.0, 0.07) << count;
        }
}

TEST(Trains, DirectionsFollowTheSpectrum) {
    Scene scene = trochoid();
    scene.sea.wind_direction_deg = 130.0;
    const SpectralMoments wanted = moments(DirectionalSpectrum(scene.sea), 0.0, kForever);
    SpectralMoments mean;
    constexpr int kSeeds = 400;
    for (int seed = 1; seed <= kSeeds; ++seed) {
        scene.shot.seed = static_cast<std::uint64_t>(seed);
        mean += total(trains_of(scene));
    }
    mean *= 1.0 / kSeeds;
    EXPECT_NEAR(mean.east, wanted.east, 0.06 * wanted.m0);
    EXPECT_NEAR(mean.north, wanted.north, 0.06 * wanted.m0);
    EXPECT_NEAR(mean.mean_direction(), 130.0 * kPi / 180.0, 0.06);
    EXPECT_NEAR(mean.xx / mean.mss(), wanted.xx / wanted.mss(), 0.06);
    EXPECT_NEAR(mean.xy / mean.mss(), wanted.xy / wanted.mss(), 0.06);
}

// Where the energy travels varies less from seed to seed than if each train drew its direction alone: the variance of the
// sum of what trains carry is then the sum of their variances.
TEST(Trains, DirectionsAreSpreadEvenly) {
    constexpr int kSeeds = 100;
    Scene scene = trochoid();
    double sum = 0.0, sum2 = 0.0;
    std::vector<double> each(scene.waves.trains, 0.0), each2 = each;
    for (int seed = 1; seed <= kSeeds; ++seed) {
        scene.shot.seed = static_cast<std::uint64_t>(seed);
        const Trains<double> trains = trains_of(scene);
        double all = 0.0;
        for (std::size_t i = 0; i < each.size(); ++i) {
            const double north = trains.alone[i].north;
            each[i] += north / kSeeds;
            each2[i] += north * north / kSeeds;
            all += north;
        }
        sum += all / kSeeds;
        sum2 += all * all / kSeeds;
    }
    double alone = 0.0;
    for (std::size_t i = 0; i < each.size(); ++i) alone += each2[i] - each[i] * each[i];
    EXPECT_LT((sum2 - sum * sum) / alone, 0.3);
}

TEST(Trains, AreTheSeedsOwn) {
    Scene scene = trochoid();
    const auto first = trains_of(scene), again = trains_of(scene);
    EXPECT_EQ(first.start_cycles, again.start_cycles);
    EXPECT_EQ(first.kx_cycles_per_m, again.kx_cycles_per_m);
    scene.shot.seed = 2;
    const auto other = trains_of(scene);
    for (std::size_t i = 0; i < first.count(); ++i) {
        EXPECT_NE(first.start_cycles[i], other.start_cycles[i]);
        EXPECT_EQ(first.height_m[i], other.height_m[i]);
    }
}

// Uniform phases: the mean of e^{iφ} over n has a standard error of √(1/2n) in each part; three times that.
TEST(Trains, PhasesAreUniform) {
    Scene scene = trochoid();
    scene.waves.trains = 1000;
    std::complex<double> mean = 0.0;
    constexpr int kSeeds = 100;
    for (int seed = 1; seed <= kSeeds; ++seed) {
        scene.shot.seed = static_cast<std::uint64_t>(seed);
        const TrainsPlan plan = *resolve_trains(*prepare(scene), 0.0);
        Scene calm = scene;  // no energy, so directions needn't be computed
        calm.sea.wind_speed_mps = 0.0;
        for (const double cycles : make_trains<double>(*prepare(calm), plan).start_cycles)
            mean += std::polar(1.0 / (1000.0 * kSeeds), kTwoPi * cycles);
    }
    EXPECT_LT(std::abs(mean.real()), 3.0 * std::sqrt(0.5 / (1000.0 * kSeeds)));
    EXPECT_LT(std::abs(mean.imag()), 3.0 * std::sqrt(0.5 / (1000.0 * kSeeds)));
}

TEST(Trains, LoopExactly) {
    Scene scene = trochoid();
    scene.shot.loop_s = 5.0;
    const auto trains = trains_of(scene);
    for (const double cycles_per_s : trains.cycles_per_s) {
        EXPECT_NEAR(cycles_per_s * 5.0, std::round(cycles_per_s * 5.0), 1e-12);
        EXPECT_GE(cycles_per_s * 5.0, 1.0 - 1e-12);
    }
    const auto at = [&](double t_s) { return phases_at(trains, {3.0, -4.0}, time_within_loop_s(t_s, 5.0)); };
    EXPECT_EQ(at(0.0), at(5.0));
    EXPECT_EQ(at(0.5), at(5.5));
    // Thousands of loops later, at a time that isn't a double: 40 Hz times the time's own rounding.
    const auto soon = at(1.0 / 24.0), late = at(1.0 / 24.0 + 5.0 * 4096);
    for (std::size_t i = 0; i < soon.size(); ++i) EXPECT_NEAR(soon[i], late[i], 40.0 * 4e-12);
    EXPECT_EQ(time_within_loop_s(5.0 - 1e-16, 5.0), 0.0);
    EXPECT_EQ(time_within_loop_s(7.25, 0.0), 7.25);
}

TEST(TrainRealisation, IsThatOfTheTrains) {
    const auto trains = trains_of(trochoid());
    const Realisation all = realisation(trains, {}, {});
    double m0 = 0.0, mss = 0.0;
    for (std::size_t i = 0; i < trains.count(); ++i) {
        m0 += trains.alone[i].m0;
        mss += std::pow(kTwoPi / trains.wavelength_m[i], 2) * trains.alone[i].m0;
    }
    EXPECT_NEAR(all.m0, m0, 1e-12 * m0);
    EXPECT_NEAR(all.mss, mss, 1e-12 * mss);
    EXPECT_NEAR(std::atan2(all.north, all.east), 0.0, 0.5);  // downwind, for one seed
    const Realisation coarse = realisation(trains, {}, {.cell_m = 10.0, .pixel_m = 1.0});
    EXPECT_NEAR(coarse.m0, resolved(trains, {}, 10.0).m0, 1e-12 * m0);
    EXPECT_NEAR(coarse.m_minus1, resolved(trains, {}, 10.0).m_minus1, 1e-12 * all.m_minus1);
    EXPECT_LT(coarse.mss, 0.5 * mss);
    EXPECT_EQ(realisation(trains, {}, {.cell_m = 1e6, .pixel_m = 1e6}).m0, 0.0);
}

}  // namespace
}  // namespace pelagic
