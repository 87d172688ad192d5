// Trochoid wave trains. See trains.h.
#include "core/waves/trains.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numeric>

#include "core/base/constants.h"
#include "core/base/number.h"
#include "core/base/random.h"
#include "core/plan/breaking.h"
#include "core/spectrum/energy_shares.h"
#include "core/waves/loop.h"

namespace pelagic {
namespace {

#include "core/waves/trains.inl"

// The last word of the random counter. Cascades use 0; trains use "TRAN".
constexpr std::uint32_t kTrainStream = 0x5452414Eu;

// Uniform in [0, 1), from two words of random bits or from one.
double uniform(std::uint32_t high, std::uint32_t low) {
    return static_cast<double>(((std::uint64_t{high} << 32) | low) >> 11) * 0x1p-53;
}
double uniform(std::uint32_t word) {
    return static_cast<double>(word) * 0x1p-32;
}

// Where train i's direction stands in its bin's distribution, 0 … 1: steps of the golden ratio from a start of the
// seed's own, so that neighbours in wavelength, which are what a picture shows, spread over all directions evenly.
// Drawn one by one, some ten trains crowd in a few.
double direction_share(int i, std::uint64_t seed) {
    constexpr double kGolden = 0.6180339887498949;  // (√5 − 1)/2
    const auto bits = philox({0, 1, 0, kTrainStream}, seed);
    const double share = uniform(bits[0], bits[1]) + i * kGolden;
    return share - std::floor(share);
}

// The part of a train's resolved displacement gradient that a footprint of this weight resolves.
template <class T>
double gradient_weight(const Trains<T>& trains, std::size_t i, double weight) {
    const double most = static_cast<double>(trains.breaking[i]);
    return most > weight ? weight / most : 1.0;
}

// A train's moments times `part`, those of its displacement gradient times `gradient_part`.
template <class T>
SpectralMoments part_of(const Trains<T>& trains, std::size_t i, double part, double gradient_part) {
    SpectralMoments moments = trains.alone[i], gradients = moments;
    moments *= part;
    moments.take_gradients(gradients.scale_gradients(gradient_part));
    return moments;
}

// The moments of a bin's waves beyond those of one train of wavenumber k with their energy: slopes and displacement
// gradients, in the bin's own directions. The mean of k² is no less than the square of the mean. A train that doesn't
// break has no moments of displacement gradients.
SpectralMoments beyond_train(const SpectralMoments& bin, double k, double horizontal_ratio, bool breaks) {
    SpectralMoments rest;
    const auto lacking = [](double of, double train) { return of > train ? 1.0 - train / of : 0.0; };
    const double slopes = lacking(bin.xx + bin.yy, k * k * bin.m0);
    rest.xx = slopes * bin.xx;
    rest.xy = slopes * bin.xy;
    rest.yy = slopes * bin.yy;
    const double gradients = breaks ? lacking(bin.xxxx + 2.0 * bin.xxyy + bin.yyyy,
                                              horizontal_ratio * horizontal_ratio * k * k * bin.m0)
                                    : 1.0;
    rest.xxxx = gradients * bin.xxxx;
    rest.xxxy = gradients * bin.xxxy;
    rest.xxyy = gradients * bin.xxyy;
    rest.xyyy = gradients * bin.xyyy;
    rest.yyyy = gradients * bin.yyyy;
    return rest;
}

// Trains [0, full) have weight 1, trains [full, any) a weight between 0 and 1, the rest 0.
struct Passing {
    std::size_t full, any;
};
template <class T>
Passing passing(const Trains<T>& trains, const FootprintFilter& filter, double footprint_m) {
    const auto first_shorter = [&](double wavelength_m) {
        return static_cast<std::size_t>(
            std::partition_point(trains.wavelength_m.begin(), trains.wavelength_m.end(),
                                 [&](double own_m) { return own_m > wavelength_m; }) -
            trains.wavelength_m.begin());
    };
    if (!(footprint_m > 0.0)) return {trains.count(), trains.count()};
    return {first_shorter(filter.n_max * footprint_m), first_shorter(filter.n_min * footprint_m)};
}

// Where a train goes, and when.
template <class T>
void add_way(Trains<T>& trains, double wavelength_m, glm::dvec2 direction, double cycles_per_s,
             double start_cycles) {
    trains.wavelength_m.push_back(wavelength_m);
    trains.wavelength.push_back(static_cast<T>(wavelength_m));
    trains.kx_cycles_per_m.push_back(direction.x / wavelength_m);
    trains.ky_cycles_per_m.push_back(direction.y / wavelength_m);
    trains.cycles_per_s.push_back(cycles_per_s);
    trains.start_cycles.push_back(start_cycles);
}

template <class T>
T weight_in_breaking(double wavelength_m, const FootprintFilter& filter, const Breaking& breaking) {
    return wavelength_m > breaking.from_m
               ? static_cast<T>(filter.weight(kTwoPi / wavelength_m, breaking.footprint_m))
               : T(0);
}

// How far a train moves water to the side: no further than where its surface would fold over.
double limited_m(double choppiness, double ratio, double height_m, double k) {
    return std::min(choppiness * ratio * height_m, 1.0 / k);
}

// A train's numbers that go with its amplitudes: each field's factor, and its moments without those of what is hidden at best.
struct Raised {
    double k, x, y;                             // x, y: the way it goes
    double height_m, horizontal_m, breaking_m;  // breaking_m: as horizontal_m, of the waves that break
    double omega_of_fields, omega, energy;      // energy: h²/2, but for rounding
};
template <class T>
SpectralMoments add_raised(Trains<T>& trains, const Raised& of) {
    const auto factor = [&](Field field, double value) {
        trains.amplitude[index(field)].push_back(static_cast<T>(value));
    };
    const double x = of.x, y = of.y, k = of.k;
    factor(Field::Height, of.height_m);
    factor(Field::Dx, x * of.horizontal_m);
    factor(Field::Dy, y * of.horizontal_m);
    factor(Field::SlopeX, k * x * of.height_m);
    factor(Field::SlopeY, k * y * of.height_m);
    factor(Field::Dxx, -k * of.breaking_m * x * x);
    factor(Field::Dyy, -k * of.breaking_m * y * y);
    factor(Field::Dxy, -k * of.breaking_m * x * y);
    factor(Field::VelocityX, of.omega_of_fields * x * of.horizontal_m);
    factor(Field::VelocityY, of.omega_of_fields * y * of.horizontal_m);
    factor(Field::VelocityZ, -of.omega_of_fields * of.height_m);
    trains.height_m.push_back(of.height_m);
    trains.horizontal_m.push_back(of.horizontal_m);
    return moments_of({.k = {k * x, k * y},
                       .energy = of.energy,
                       .omega = of.omega,
                       .chop = of.height_m > 0.0 ? of.breaking_m / (k * of.height_m) : 0.0});
}

// The sums over all trains before and from each.
template <class T>
void add_up(Trains<T>& trains) {
    trains.before.assign(trains.count() + 1, {});
    for (std::size_t i = 0; i < trains.count(); ++i)
        (trains.before[i + 1] = trains.before[i]) += trains.alone[i];
    trains.from.resize(trains.count() + 1);
    trains.from.back() = trains.outside;
    for (std::size_t i = trains.count(); i-- > 0;) (trains.from[i] = trains.from[i + 1]) += trains.alone[i];
    trains.unresolved_from.clear();
    for (const SpectralMoments& moments : trains.from)
        trains.unresolved_from.push_back(unresolved_moments<T>(moments));
}

}  // namespace

template <class T>
Trains<T> make_trains(const PreparedScene& prepared, const TrainsPlan& plan, const FootprintFilter& filter,
                      const std::optional<Breaking>& planned) {
    const Scene& scene = prepared.scene;
    const DirectionalSpectrum& spectrum = prepared.spectrum;
    const double choppiness = Choppiness::asked(scene).built().largest(), loop_s = scene.shot.sea_loop_s();
    const Breaking breaking = planned.value_or(breaking_of(scene, filter));
    Breaking unscaled = breaking;
    unscaled.choppiness = 1.0;
    const Dispersion& dispersion = spectrum.dispersion();
    Trains<T> trains;
    for (int i = 0; i < plan.count; ++i) {
        const double k_lo = kTwoPi / plan.edge_m(i), k_hi = kTwoPi / plan.edge_m(i + 1);
        const EnergyShares bin(spectrum, k_lo, k_hi);
        const double wavelength_m = plan.wavelengths_m[i], k = kTwoPi / wavelength_m;
        const auto bits = philox({static_cast<std::uint32_t>(i), 0, 0, kTrainStream}, scene.shot.seed);
        const auto towards = [&](const DirectionalSpectrum& of, const EnergyShares& its) {
            return its.energy() > 0.0 ? direction_of_share(of, its.wavenumber(uniform(bits[2])),
                                                           direction_share(i, scene.shot.seed))
                                      : 0.0;
        };
        const double theta = plan.shot
                                 ? towards(plan.shot->spectrum, EnergyShares(plan.shot->spectrum, k_lo, k_hi))
                                 : towards(spectrum, bin);
        const double height_m = std::sqrt(2.0 * bin.energy());
        const double ratio = dispersion.horizontal_ratio(k), omega = dispersion.omega(k);
        const double x = std::cos(theta), y = std::sin(theta);
        const double cycles_per_s = looped_cycles_per_s(omega, loop_s);

        add_way(trains, wavelength_m, {x, y}, cycles_per_s, uniform(bits[3]));
        SpectralMoments alone =
            add_raised(trains, {.k = k,
                                .x = x,
                                .y = y,
                                .height_m = height_m,
                                .horizontal_m = limited_m(choppiness, ratio, height_m, k),
                                .breaking_m = limited_m(breaking.choppiness.largest(), ratio, height_m, k),
                                .omega_of_fields = kTwoPi * cycles_per_s,
                                .omega = omega,
                                .energy = bin.energy()});
        // Of the displacement gradient, the part that is resolved at best; the rest counts with the waves outside.
        const bool breaks = wavelength_m > breaking.from_m;
        trains.breaking.push_back(weight_in_breaking<T>(wavelength_m, filter, breaking));
        const double most = static_cast<double>(trains.breaking.back());
        SpectralMoments unseen, seen = alone;
        unseen.take_gradients(alone);
        trains.outside += unseen.scale_gradients(breaks ? unresolved_part(most) : 0.0);
        alone.take_gradients(seen.scale_gradients(most * most));
        trains.alone.push_back(alone);
        trains.unresolved_alone.push_back(unresolved_moments<T>(alone));
        SpectralMoments beyond =
            beyond_train(moments_with_breaking(spectrum, k_lo, k_hi, unscaled), k, ratio, breaks);
        trains.outside +=
            beyond.scale_gradients(breaking.choppiness.largest() * breaking.choppiness.largest());
    }

    trains.outside += moments_with_breaking(spectrum, 0.0, kTwoPi / plan.longest_m, breaking);
    trains.outside += moments_with_breaking(spectrum, kTwoPi / plan.shortest_m,
                                            std::numeric_limits<double>::infinity(), breaking);
    add_up(trains);
    return trains;
}

template <class T>
void add_heroes(Trains<T>& trains, std::span<const HeroTrain> heroes, const FootprintFilter& filter,
                const Breaking& breaking, const Dispersion& dispersion) {
    for (const HeroTrain& hero : heroes) {
        const HeroMode& mode = hero.mode;
        const double k = kTwoPi / mode.wavelength_m;
        add_way(trains, mode.wavelength_m, mode.direction, mode.cycles_per_s, hero.start_cycles);
        add_raised(trains,
                   {.k = k,
                    .x = mode.direction.x,
                    .y = mode.direction.y,
                    .height_m = hero.height_m,
                    .horizontal_m = mode.horizontal_ratio * hero.height_m,
                    .breaking_m = breaking.choppiness.at(k) * dispersion.horizontal_ratio(k) * hero.height_m,
                    .omega_of_fields = kTwoPi * mode.cycles_per_s,
                    .omega = dispersion.omega(k),
                    .energy = 0.5 * hero.height_m * hero.height_m});
        trains.breaking.push_back(weight_in_breaking<T>(mode.wavelength_m, filter, breaking));
        trains.alone.emplace_back();
        trains.unresolved_alone.push_back(unresolved_moments<T>({}));
    }
    std::vector<std::size_t> order(trains.count());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, std::greater<>(), [&](std::size_t i) { return trains.wavelength_m[i]; });
    const auto sort = [&](auto&... all) {
        const auto sort_one = [&](auto& values) {
            const auto from = values;
            for (std::size_t i = 0; i < order.size(); ++i) values[i] = from[order[i]];
        };
        (sort_one(all), ...);
    };
    sort(trains.kx_cycles_per_m, trains.ky_cycles_per_m, trains.cycles_per_s, trains.start_cycles,
         trains.height_m, trains.horizontal_m, trains.wavelength_m, trains.alone, trains.breaking,
         trains.unresolved_alone, trains.wavelength);
    for (std::vector<T>& amplitude : trains.amplitude) sort(amplitude);
    add_up(trains);
}

template <class T>
Trains<T> blended(const Trains<T>& first, const Trains<T>& second, const TrainsBetween& between,
                  const Dispersion& dispersion, const Breaking& breaking) {
    const double share = between.share, of_breaking = between.breaking * breaking.choppiness.largest();
    Trains<T> trains;
    trains.kx_cycles_per_m = first.kx_cycles_per_m;
    trains.ky_cycles_per_m = first.ky_cycles_per_m;
    trains.cycles_per_s = first.cycles_per_s;
    trains.start_cycles = first.start_cycles;
    trains.wavelength_m = first.wavelength_m;
    trains.wavelength = first.wavelength;
    trains.breaking = first.breaking;
    for (std::size_t i = 0; i < first.count(); ++i) {
        const double k = kTwoPi / trains.wavelength_m[i], ratio = dispersion.horizontal_ratio(k);
        if (between.over) {
            // Turned so that at this time it is where it has come to.
            trains.cycles_per_s[i] = dispersion.omega(k) / kTwoPi;
            const double start = trains.start_cycles[i] + between.over->turns.trains[i] -
                                 fraction_of_product(trains.cycles_per_s[i], between.over->time_s);
            trains.start_cycles[i] = start - std::floor(start);
        }
        const auto energy = [i](const Trains<T>& of) { return 0.5 * of.height_m[i] * of.height_m[i]; };
        const double own = (1.0 - share) * energy(first) + share * energy(second),
                     height_m = std::sqrt(2.0 * own);
        const double horizontal_m = limited_m(between.choppiness, ratio, height_m, k),
                     x = trains.kx_cycles_per_m[i] * trains.wavelength_m[i],
                     y = trains.ky_cycles_per_m[i] * trains.wavelength_m[i];
        SpectralMoments alone = add_raised(trains, {.k = k,
                                                    .x = x,
                                                    .y = y,
                                                    .height_m = height_m,
                                                    .horizontal_m = horizontal_m,
                                                    .breaking_m = limited_m(of_breaking, ratio, height_m, k),
                                                    .omega_of_fields = kTwoPi * trains.cycles_per_s[i],
                                                    .omega = dispersion.omega(k),
                                                    .energy = own});
        const double most = static_cast<double>(trains.breaking[i]);
        trains.alone.push_back(alone.scale_gradients(most * most));
        trains.unresolved_alone.push_back(unresolved_moments<T>(alone));
        // ḣ = ∂/∂t √(2E); a train that is as sharp as can be stays so.
        const double grows = height_m > 0.0 ? between.rate_per_s * (energy(second) - energy(first)) / height_m
                                            : 0.0,
                     slopes = between.over ? between.over->ratio_per_s(k) : 0.0,
                     widens = k * horizontal_m < 1.0 ? between.choppiness * ratio * grows +
                                                           between.choppiness_per_s * ratio * height_m +
                                                           between.choppiness * slopes * height_m
                                                     : 0.0;
        trains.growth[0].push_back(static_cast<T>(x * widens));
        trains.growth[1].push_back(static_cast<T>(y * widens));
        trains.growth[2].push_back(static_cast<T>(grows));
    }
    SpectralMoments before = first.outside, after = second.outside;
    (trains.outside = before *= 1.0 - share) += after *= share;
    trains.outside.scale_gradients(between.breaking * between.breaking);
    add_up(trains);
    return trains;
}

template <class T>
SpectralMoments total(const Trains<T>& trains) {
    return trains.from.front();
}

template <class T>
SpectralMoments resolved(const Trains<T>& trains, const FootprintFilter& filter, double footprint_m) {
    const Passing pass = passing(trains, filter, footprint_m);
    SpectralMoments sum = trains.before[pass.full];
    for (std::size_t i = pass.full; i < pass.any; ++i) {
        const double w = filter.weight(kTwoPi / trains.wavelength_m[i], footprint_m);
        const double gradient = gradient_weight(trains, i, w);
        sum += part_of(trains, i, w * w, gradient * gradient);
    }
    return sum;
}

template <class T>
SpectralMoments unresolved(const Trains<T>& trains, const FootprintFilter& filter, double footprint_m) {
    const Passing pass = passing(trains, filter, footprint_m);
    SpectralMoments sum = trains.from[pass.any];
    for (std::size_t i = pass.full; i < pass.any; ++i) {
        const double w = filter.weight(kTwoPi / trains.wavelength_m[i], footprint_m);
        sum += part_of(trains, i, unresolved_part(w), unresolved_part(gradient_weight(trains, i, w)));
    }
    return sum;
}

template <class T>
Realisation realisation(const Trains<T>& trains, const FootprintFilter& filter,
                        const Footprints& footprints) {
    Realisation sum;
    for (std::size_t i = 0; i < trains.count(); ++i) {
        if (trains.alone[i].m0 == 0.0) continue;  // a hero's is no part of the random sea
        const double k = kTwoPi / trains.wavelength_m[i];
        const double cell = filter.weight(k, footprints.cell_m), pixel = filter.weight(k, footprints.pixel_m);
        if (cell == 0.0 && pixel == 0.0) break;
        // A train is the pair of modes ±k with |h| = h/2 each; |h0|² = h²/4 travels along k.
        const double height2 = 0.5 * trains.height_m[i] * trains.height_m[i];
        sum.m0 += cell * cell * height2;
        sum.m_minus1 += cell * cell * height2 / (kTwoPi * trains.cycles_per_s[i]);
        sum.mss += pixel * pixel * k * k * height2;
        sum.east += 0.5 * cell * cell * height2 * trains.kx_cycles_per_m[i] * trains.wavelength_m[i];
        sum.north += 0.5 * cell * cell * height2 * trains.ky_cycles_per_m[i] * trains.wavelength_m[i];
    }
    return sum;
}

template <class T>
LocalWaves local_waves(const Trains<T>& trains, glm::dvec2 place_m, double reduced_time_s,
                       const HeroEnds& ends) {
    LocalWaves sum;
    const std::vector<double> cycles = phases_at(trains, place_m, reduced_time_s);
    for (std::size_t i = 0; i < trains.count(); ++i) {
        const double k = kTwoPi / trains.wavelength_m[i], sine = std::sin(kTwoPi * cycles[i]);
        if (k > ends.height) break;
        sum.height_m += trains.height_m[i] * std::cos(kTwoPi * cycles[i]);
        if (k > ends.level) continue;
        const glm::dvec2 direction =
            trains.wavelength_m[i] * glm::dvec2(trains.kx_cycles_per_m[i], trains.ky_cycles_per_m[i]);
        sum += {.slope = k * trains.height_m[i] * sine * direction,
                .rate_mps = -kTwoPi * trains.cycles_per_s[i] * trains.height_m[i] * sine,
                .displacement_m = trains.horizontal_m[i] * sine * direction};
    }
    return sum;
}

double phase_at(glm::dvec2 cycles_per_m, double cycles_per_s, double start_cycles, glm::dvec2 place_m,
                double reduced_time_s) {
    const double phase = start_cycles + fraction_of_product(cycles_per_s, reduced_time_s) -
                         fraction_of_product(cycles_per_m.x, place_m.x) -
                         fraction_of_product(cycles_per_m.y, place_m.y);
    return phase - std::round(phase);
}

template <class T>
std::vector<double> phases_at(const Trains<T>& trains, glm::dvec2 origin_m, double reduced_time_s) {
    std::vector<double> cycles(trains.count());
    for (std::size_t i = 0; i < trains.count(); ++i)
        cycles[i] = phase_at({trains.kx_cycles_per_m[i], trains.ky_cycles_per_m[i]}, trains.cycles_per_s[i],
                             trains.start_cycles[i], origin_m, reduced_time_s);
    return cycles;
}

template Trains<float> make_trains(const PreparedScene&, const TrainsPlan&, const FootprintFilter&,
                                   const std::optional<Breaking>&);
template Trains<double> make_trains(const PreparedScene&, const TrainsPlan&, const FootprintFilter&,
                                    const std::optional<Breaking>&);
template void add_heroes(Trains<float>&, std::span<const HeroTrain>, const FootprintFilter&, const Breaking&,
                         const Dispersion&);
template void add_heroes(Trains<double>&, std::span<const HeroTrain>, const FootprintFilter&, const Breaking&,
                         const Dispersion&);
template Trains<float> blended(const Trains<float>&, const Trains<float>&, const TrainsBetween&,
                               const Dispersion&, const Breaking&);
template Trains<double> blended(const Trains<double>&, const Trains<double>&, const TrainsBetween&,
                                const Dispersion&, const Breaking&);
template SpectralMoments total(const Trains<float>&);
template SpectralMoments total(const Trains<double>&);
template SpectralMoments resolved(const Trains<float>&, const FootprintFilter&, double);
template SpectralMoments resolved(const Trains<double>&, const FootprintFilter&, double);
template SpectralMoments unresolved(const Trains<float>&, const FootprintFilter&, double);
template SpectralMoments unresolved(const Trains<double>&, const FootprintFilter&, double);
template Realisation realisation(const Trains<float>&, const FootprintFilter&, const Footprints&);
template Realisation realisation(const Trains<double>&, const FootprintFilter&, const Footprints&);
template LocalWaves local_waves(const Trains<float>&, glm::dvec2, double, const HeroEnds&);
template LocalWaves local_waves(const Trains<double>&, glm::dvec2, double, const HeroEnds&);
template std::vector<double> phases_at(const Trains<float>&, glm::dvec2, double);
template std::vector<double> phases_at(const Trains<double>&, glm::dvec2, double);

}  // namespace pelagic
