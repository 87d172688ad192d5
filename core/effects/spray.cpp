#include "core/effects/spray.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "core/base/constants.h"
#include "core/base/random.h"
#include "core/plan/spray.h"
#include "core/waves/whitecaps.h"

namespace pelagic {
namespace {

// Ages of the spray at a height, and their weights, whose sum is 1: chosen by eye, as far apart as patches that break are long.
struct Age {
    int height;
    double age_s, weight;
};
constexpr std::array kAges{Age{0, 0.0, 0.35}, Age{0, 0.5, 0.3},  Age{0, 1.1, 0.2}, Age{0, 1.8, 0.15},
                           Age{1, 0.8, 0.3},  Age{1, 1.6, 0.4},  Age{1, 2.6, 0.3}, Age{2, 2.0, 0.3},
                           Age{2, 3.2, 0.3},  Age{2, 4.5, 0.25}, Age{2, 6.0, 0.15}};
// How fast wind and crest come apart: crests that break run at half the wind's speed, more or less.
constexpr double kApart = 0.5;
// How fast it falls: drops of some 60 µm (settling_mps()).
constexpr double kFalls_mps = 0.35;

struct Tear {
    double across_m, along_m, lasts_s, strength, of_wind;
    double strays_m;  // at most, about; a third of it across the wind
};
constexpr std::array kTears{Tear{3.0, 14.0, 1.0, 1.8, 0.6, 4.0}, Tear{4.0, 24.0, 1.5, 2.0, 0.75, 8.0},
                            Tear{6.0, 40.0, 2.5, 2.2, 0.9, 14.0}};
constexpr int kOctaves = 3;
constexpr double kFiner = 0.5, kWeaker = 0.75;  // from octave to octave

}  // namespace

template <class T>
double mean_breaking(const Sea<T>& sea) {
    if (!std::isfinite(sea.whitecap_threshold())) return 0.0;
    const SpectralMoments& whole = sea.total();
    const auto j = jacobian_moments<double>(0.0, 0.0, 0.0, 0.0,
                                            {whole.xxxx, whole.xxxy, whole.xxyy, whole.xyyy, whole.yyyy});
    const double mean = coverage(j, sea.whitecap_threshold(), sea.plan().knobs.third_moment);
    constexpr double kNone =
        1e-9;  // a square millimetre in a thousand square metres, as calibrated_threshold() has it
    return mean < kNone ? 0.0 : mean;
}

template <class T>
SprayVeil::SprayVeil(const Frame<T>& frame) {
    const PreparedScene& from = *frame.sea().plan().from;
    law_ = spray_law(from.scene, from.extent.significant_height_m);
    const double mean = mean_breaking(frame.sea());
    if (!(mean > 0.0) || !(law_.extinction_per_m() > 0.0)) return;
    mean_breaking_ = mean;
    wind_mps_ = from.scene.sea.wind_speed_mps;
    const double towards = from.scene.sea.wind_direction_deg * kPi / 180.0;
    downwind_ = glm::dvec2(std::cos(towards), std::sin(towards));
    time_s_ = frame.time_within_loop_s();
    if (from.wind) wind_way_m_ = wind_way_m(from, time_s_);
    loop_s_ = from.scene.shot.sea_loop_s();
    seed_ = from.scene.shot.seed;
}

// e^{strength Σ w u} over its mean, Π sinh(strength w)/(strength w), u of −1 … 1 at the corners of the cell of place and time, Σ w² = 1.
SprayVeil::Torn SprayVeil::drawn(int height, int octave, glm::dvec2 place_m, double time_s,
                                 double strength) const {
    const Tear& tear = kTears[static_cast<std::size_t>(height)];
    const double finer = std::pow(kFiner, octave);
    const double moved_m = wind_way_m_ ? tear.of_wind * *wind_way_m_ : tear.of_wind * wind_mps_ * time_s;
    const std::array at{(glm::dot(place_m, downwind_) - moved_m) / (finer * tear.along_m),
                        (place_m.y * downwind_.x - place_m.x * downwind_.y) / (finer * tear.across_m),
                        time_s / (finer * tear.lasts_s)};
    std::array<std::int64_t, 3> cell{};
    std::array<double, 3> part{};
    for (std::size_t d = 0; d < 3; ++d) {
        const double low = std::floor(at[d]), x = at[d] - low;
        cell[d] = static_cast<std::int64_t>(low);
        part[d] = x * x * (3.0 - 2.0 * x);
    }
    std::array<double, 8> weights{};
    double square = 0.0;
    for (std::size_t i = 0; i < 8; ++i) {
        weights[i] = (i & 1 ? part[0] : 1.0 - part[0]) * (i & 2 ? part[1] : 1.0 - part[1]) *
                     (i & 4 ? part[2] : 1.0 - part[2]);
        square += weights[i] * weights[i];
    }
    const auto word = [](std::int64_t value, std::size_t more) {
        return static_cast<std::uint32_t>(value + static_cast<std::int64_t>(more));
    };
    const auto unit = [](std::uint32_t bits) { return (bits + 0.5) * 0x1p-31 - 1.0; };
    constexpr std::uint32_t kStream = 0x73707279u;  // of the shot's random numbers
    double sum = 0.0, mean = 1.0;
    glm::dvec2 strayed(0.0);
    for (std::size_t i = 0; i < 8; ++i) {
        const double s = strength * weights[i] / std::sqrt(square);
        if (!(s > 1e-9)) continue;
        const auto bits = philox({word(cell[0], i & 1), word(cell[1], i >> 1 & 1), word(cell[2], i >> 2),
                                  kStream + static_cast<std::uint32_t>(kOctaves * height + octave)},
                                 seed_);
        sum += s * unit(bits[0]);
        mean *= std::sinh(s) / s;
        strayed += weights[i] * glm::dvec2(unit(bits[1]), unit(bits[2]) / 3.0);
    }
    const glm::dvec2 across(-downwind_.y, downwind_.x);
    return {std::exp(sum) / mean, tear.strays_m * (strayed.x * downwind_ + strayed.y * across)};
}

SprayVeil::Torn SprayVeil::torn(int height, glm::dvec2 place_m, double cell_m) const {
    Torn torn;
    if (!is_torn()) return torn;
    const Tear& of = kTears[static_cast<std::size_t>(height)];
    for (int i = 0; i < kOctaves; ++i) {
        const double in_cell = cell_m / (of.across_m * std::pow(kFiner, i));
        const double strength = of.strength * std::pow(kWeaker, i) / (1.0 + in_cell * in_cell);
        if (strength < 0.05) continue;
        const auto add = [&](double time_s, double part) {
            const Torn more = drawn(height, i, place_m, time_s, strength * part);
            torn.factor *= more.factor;
            torn.strayed_m += part * (strength / of.strength) * more.strayed_m;
        };
        // In a loop the end fades into what was before the beginning.
        const double over = loop_s_ > 0.0 ? time_s_ / loop_s_ : 0.0;
        add(time_s_, std::sqrt(1.0 - over));
        if (over > 0.0) add(time_s_ - loop_s_, std::sqrt(over));
    }
    return torn;
}

std::array<SprayVeil::Generation, 2> SprayVeil::generations() const {
    constexpr double kHalfALife_s = 1.6;  // chosen by eye: as long as ribbons are old
    const double in_loop = loop_s_ > 0.0 ? std::max(std::round(loop_s_ / kHalfALife_s), 2.0) : 0.0;
    const double half_s = in_loop > 0.0 ? loop_s_ / in_loop : kHalfALife_s;
    const double halves = std::floor(time_s_ / half_s), part = time_s_ / half_s - halves;
    const auto name = [&](double birth) {
        if (in_loop > 0.0) birth -= in_loop * std::floor(birth / in_loop);
        constexpr std::uint32_t kStream = 0x73707468u;  // of the shot's random numbers
        return philox({static_cast<std::uint32_t>(static_cast<std::int64_t>(birth)), 0, 0, kStream},
                      seed_)[0] &
               0xffffffu;
    };
    return {Generation{part * half_s, std::sin(0.5 * kPi * part), name(halves)},
            Generation{(1.0 + part) * half_s, std::cos(0.5 * kPi * part), name(halves - 1.0)}};
}

template <class T>
void SprayVeil::shares(const PreparedQuery<T>& query, const Points<T>& places, std::span<const T> breaking,
                       std::span<const glm::vec<3, T>> displacement_m, std::span<const double> mean_cell_m,
                       std::span<glm::dvec3> shares, std::span<double> lifts_m) const {
    std::fill(shares.begin(), shares.end(), glm::dvec3(0.0));
    std::fill(lifts_m.begin(), lifts_m.end(), 0.0);
    if (empty()) return;
    if (!is_torn()) {
        for (std::size_t i = 0; i < breaking.size(); ++i)
            shares[i].x = static_cast<double>(breaking[i]) / mean_breaking_;
        return;
    }
    const std::size_t count = breaking.size();
    std::vector<Torn> torn(3 * count);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
        const glm::dvec2 place_m = places.origin_m + glm::dvec2(places.rest_m[i]);
        for (int height = 0; height < 3; ++height)
            torn[3 * i + static_cast<std::size_t>(height)] = this->torn(height, place_m, mean_cell_m[i]);
    });
    using Vec = glm::vec<2, T>;
    std::vector<std::size_t> moved;
    std::vector<Vec> places_m, cell_axes, pixel_axes;
    std::vector<T> cells, pixels, there;
    std::vector<glm::vec<3, T>> came_from;
    std::vector<double> thickness(count, 0.0);
    const glm::dvec3 counts = law_.ribbons.extinction_per_m * glm::dvec3(0.5, 1.25, 2.0);
    const auto gather = [&]<class V>(const Strided<const V>& from, std::vector<V>& to,
                                     Strided<const V>& view) {
        if (!from) return;
        to.clear();
        for (const std::size_t i : moved) to.push_back(from[i]);
        view = {to.data()};
    };
    for (const Age& each : kAges) {
        const double away_m = kApart * wind_mps_ * each.age_s;
        const auto height = static_cast<std::size_t>(each.height);
        // A cell that is longer than that has as much upwind.
        moved.clear();
        places_m.clear();
        if (away_m > 0.0)
            for (std::size_t i = 0; i < count; ++i)
                if (mean_cell_m[i] < away_m) {
                    moved.push_back(i);
                    places_m.push_back(places.rest_m[i] -
                                       static_cast<Vec>(away_m * downwind_ + torn[3 * i + height].strayed_m));
                }
        there.resize(moved.size());
        Points<T> upwind{.origin_m = places.origin_m, .count = moved.size(), .rest_m = {places_m.data()}};
        gather(places.cell_m, cells, upwind.cell_m);
        gather(places.pixel_m, pixels, upwind.pixel_m);
        gather(places.cell_axis_m, cell_axes, upwind.cell_axis_m);
        gather(places.pixel_axis_m, pixel_axes, upwind.pixel_axis_m);
        Results<T> results;
        results.set(Product::Breaking, {there.data()});
        came_from.resize(moved.size());
        results.set(Product::Displacement, {came_from.data()});
        constexpr PlaceSearch kSearch{.tolerance_m = 0.2, .most_steps = 16};
        if (!moved.empty()) evaluate_at(query, upwind, kSearch, results);
        std::size_t next = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const bool is_moved = next < moved.size() && moved[next] == i;
            const double share = each.weight * torn[3 * i + height].factor *
                                 static_cast<double>(is_moved ? there[next] : breaking[i]) / mean_breaking_;
            shares[i][each.height] += share;
            const double up_m = is_moved ? static_cast<double>(came_from[next].z - displacement_m[i].z) -
                                               kFalls_mps * each.age_s
                                         : 0.0;
            thickness[i] += share * counts[each.height];
            lifts_m[i] += share * counts[each.height] * std::max(up_m, 0.0);
            next += is_moved ? 1 : 0;
        }
    }
    for (std::size_t i = 0; i < count; ++i)
        lifts_m[i] = thickness[i] > 0.0
                         ? std::min(lifts_m[i] / thickness[i], SprayRibbons::kMostLift * law_.ribbons.step_m)
                         : 0.0;
}

template double mean_breaking(const Sea<float>&);
template double mean_breaking(const Sea<double>&);
template SprayVeil::SprayVeil(const Frame<float>&);
template SprayVeil::SprayVeil(const Frame<double>&);
template void SprayVeil::shares(const PreparedQuery<float>&, const Points<float>&, std::span<const float>,
                                std::span<const glm::vec3>, std::span<const double>, std::span<glm::dvec3>,
                                std::span<double>) const;
template void SprayVeil::shares(const PreparedQuery<double>&, const Points<double>&, std::span<const double>,
                                std::span<const glm::dvec3>, std::span<const double>, std::span<glm::dvec3>,
                                std::span<double>) const;

}  // namespace pelagic
