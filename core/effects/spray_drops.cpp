#include "core/effects/spray_drops.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/base/constants.h"
#include "core/base/random.h"
#include "core/effects/spray.h"
#include "core/evaluate/prepared_query.h"
#include "core/plan/hulls.h"
#include "core/plan/spray.h"
#include "core/plan/weather.h"
#include "core/plan/wind_profile.h"
#include "core/waves/loop.h"
#include "core/waves/whitecaps.h"

namespace pelagic {
namespace {

// Chosen by eye: flat water must not flash, and a parcel that begins or ends must not be seen to.
constexpr double kShortestLife_s = 0.3;
constexpr double kComes = 0.15, kGoes = 0.3;  // shares of its life
constexpr double kFull = 1.0 - 0.5 * (kComes + kGoes);
constexpr double kNarrowest_m = 0.04, kWider_m = 0.26, kWider_per_s = 0.8;  // of cells of a metre
constexpr double kOfWind = 0.2;  // of the wind's speed that a drop is torn off with, beside the water's
// Turbulence over the sea, in friction velocities (Panofsky and Dutton 1984: 2.4, 1.9 and 1.25): a parcel lasts for as long as part of it.
constexpr double kGusts = 1.2, kLifts = 0.6;
constexpr double kFlight_m = 2.0;  // the height whose wind counts

double smooth(double x) {
    x = std::clamp(x, 0.0, 1.0);
    return x * x * (3.0 - 2.0 * x);
}

// Of its life, over its mean.
double presence(double part) {
    return smooth(part / kComes) * smooth((1.0 - part) / kGoes) / kFull;
}

std::uint32_t word(std::int64_t value) {
    return static_cast<std::uint32_t>(value);
}
double unit(std::uint32_t bits) {
    return (bits + 0.5) * 0x1p-32;
}
constexpr std::uint32_t kStream = 0x64726f70u;  // of the shot's random numbers

}  // namespace

double SprayDrop::opacity() const {
    return -std::expm1(-section_m2 / (0.25 * kPi * width_m * width_m));
}

template <class T>
struct SprayDrops<T>::Parcel {
    glm::dvec3 from_m, start_mps, drift_mps;  // drift: that it comes to have
    double since_s;                           // of its interval
    double life_s, lag_s;                     // lag: in which it takes the drift up to 1/e
    double section_m2;                        // its mean
    double width_m;
    std::int64_t id;

    double taken_up(double age_s) const { return -std::expm1(-age_s / lag_s); }
    glm::dvec3 position(double age_s) const {
        return from_m + drift_mps * age_s + (start_mps - drift_mps) * (lag_s * taken_up(age_s));
    }
    glm::dvec3 velocity(double age_s) const { return start_mps + (drift_mps - start_mps) * taken_up(age_s); }

    // It rises at first, maybe, and then falls: there is one such age.
    void end_at(double height_m) {
        double before_s = 0.0, behind_s = SprayDropsPlan::kLongestLife_s;
        if (position(behind_s).z < height_m)
            for (int i = 0; i < 24; ++i) {
                const double middle_s = 0.5 * (before_s + behind_s);
                (position(middle_s).z < height_m ? behind_s : before_s) = middle_s;
            }
        life_s = std::max(behind_s, kShortestLife_s);
    }
};

template <class T>
SprayDrops<T>::SprayDrops(const Sea<T>& sea, double size_m, const BuildWatch& watch)
    : plan_(plan_spray_drops(*sea.plan().from, size_m)), size_m_(size_m) {
    const PreparedScene& from = *sea.plan().from;
    const SprayLaw law = spray_law(from.scene, from.extent.significant_height_m);
    if (!(law.drops.optical_thickness > 0.0)) return;
    frame_ = std::make_unique<Frame<T>>(std::make_shared<const Sea<T>>(
        plan_of_spray_drops(sea.plan(), plan_), watch, sea.spectrum_table(), sea.coast()));
    // Its own: where foam lives, what counts as breaking depends on whether anybody asks for that.
    mean_breaking_ = mean_breaking(frame_->sea());
    if (knows_hulls(frame_->sea().plan())) hulls_ = std::make_unique<Hulls>(frame_->sea().plan().from->scene);
    if (!(mean_breaking_ > 0.0)) return;
    per_m2_ = law.drops.optical_thickness / plan_.parcels_per_s;
    seed_ = from.scene.shot.seed;
    const double towards = from.scene.sea.wind_direction_deg * kPi / 180.0;
    downwind_ = {std::cos(towards), std::sin(towards)};
    const WindProfile wind(from.scene.sea.wind_speed_mps);
    wind_mps_ = wind.at(kFlight_m);
    friction_mps_ = wind.friction_mps();
    for (const double radius_um : law.drops.radii_um) settling_mps_.push_back(settling_mps(radius_um));
}

template <class T>
SprayDrops<T>::~SprayDrops() = default;

// Whole blocks of cells, so that a camera that moves a little sees the same ones.
template <class T>
typename SprayDrops<T>::Cells SprayDrops<T>::cells_round(glm::dvec2 middle_m) const {
    constexpr double kBlock = 16.0;
    const glm::dvec2 half_m(0.5 * size_m_ + plan_.around_m), back_m = plan_.downwind_m * downwind_;
    const glm::dvec2 low_m = middle_m - half_m - glm::max(back_m, 0.0),
                     high_m = middle_m + half_m - glm::min(back_m, 0.0);
    const double block_m = kBlock * plan_.cell_m;
    const glm::dvec2 first = glm::floor(low_m / block_m), last = glm::ceil(high_m / block_m);
    const auto whole = [&](double blocks) { return static_cast<std::int64_t>(kBlock * blocks); };
    return {whole(first.x), whole(first.y), whole(last.x - first.x), whole(last.y - first.y)};
}

template <class T>
std::int64_t SprayDrops<T>::within_loop(std::int64_t interval) const {
    if (plan_.intervals_a_loop == 0) return interval;
    const std::int64_t rest = interval % plan_.intervals_a_loop;
    return rest < 0 ? rest + plan_.intervals_a_loop : rest;
}

// Its place at rest is in from_m, in cells from the corner; what the sea says there is still to be added.
template <class T>
typename SprayDrops<T>::Parcel SprayDrops<T>::started(std::int64_t interval, glm::i64vec2 cell, int number,
                                                      double weight) const {
    const auto bits_of = [&](std::uint32_t which) {
        return std::array<std::uint32_t, 4>{word(cell.x), word(cell.y), word(interval),
                                            kStream + 8 * static_cast<std::uint32_t>(number) + which};
    };
    const auto place = philox(bits_of(1), seed_), kind = philox(bits_of(2), seed_);
    const auto gust = normal_pair(bits_of(3), seed_), lift = normal_pair(bits_of(4), seed_);
    const auto deviates = [](double normal) { return std::clamp(normal, -2.5, 2.5); };
    const glm::dvec2 across(-downwind_.y, downwind_.x);
    const double falls_mps =
        settling_mps_[static_cast<std::size_t>(unit(kind[0]) * static_cast<double>(settling_mps_.size()))];
    const double gust_mps = kGusts * friction_mps_;
    const glm::dvec2 carried =
        (wind_mps_ + gust_mps * deviates(gust[0])) * downwind_ + 0.5 * gust_mps * deviates(gust[1]) * across;
    const double up_mps = friction_mps_ * std::min(-std::log(unit(kind[1])), 4.0);
    // Few are wide. A wide one has the more drops, so that all are about as dense: width² over its mean, where u³ says how wide.
    const double chance = unit(kind[2]), width_m = kNarrowest_m + kWider_m * chance * chance * chance;
    constexpr double kMeanSquare_m2 =
        kNarrowest_m * kNarrowest_m + kNarrowest_m * kWider_m / 2.0 + kWider_m * kWider_m / 7.0;
    Parcel parcel{};
    parcel.from_m = {unit(place[0]), unit(place[1]), 0.0};
    parcel.drift_mps = {carried, kLifts * friction_mps_ * deviates(lift[0]) - falls_mps};
    parcel.start_mps = {kOfWind * carried, up_mps};
    parcel.since_s = unit(place[2]) * plan_.interval_s;
    parcel.lag_s = falls_mps / kGravity;
    parcel.section_m2 = weight * per_m2_ * plan_.cell_m * plan_.cell_m * width_m * width_m / kMeanSquare_m2;
    parcel.width_m = plan_.cell_m * width_m;
    parcel.id = static_cast<std::int64_t>((std::uint64_t{kind[3]} << 21) ^ (place[3] & 0x1fffffu));
    return parcel;
}

template <class T>
std::vector<typename SprayDrops<T>::Parcel> SprayDrops<T>::made(std::int64_t interval, const Cells& cells,
                                                                const std::atomic<bool>* cancel) {
    using Vec = glm::vec<2, T>;
    const double time_s = std::max(static_cast<double>(interval) * plan_.interval_s, -Frame<T>::kLatest_s);
    frame_->set(time_s, cancel);
    const glm::i64vec2 middle(cells.x + cells.columns / 2, cells.y + cells.rows / 2);
    const glm::dvec2 origin_m = glm::dvec2(middle) * plan_.cell_m;
    const PreparedQuery<T> query(*frame_, 0, frame_->sea().plan().queries[0].query.products, origin_m);
    const bool third = frame_->sea().plan().knobs.third_moment;
    std::vector<Parcel> made;
    // Some rows at a time.
    const std::int64_t rows_at_once = std::max<std::int64_t>((std::int64_t{1} << 16) / cells.columns, 1);
    std::vector<Vec> rest_m;
    std::vector<glm::vec<3, T>> moments, displaced_m, moves_mps;
    std::vector<T> breaks;
    std::vector<std::vector<Parcel>> of_row;
    for (std::int64_t first = 0; first < cells.rows; first += rows_at_once) {
        stop_if(cancel);
        const std::int64_t rows = std::min(rows_at_once, cells.rows - first);
        rest_m.clear();
        for (std::int64_t y = first; y < first + rows; ++y)
            for (std::int64_t x = 0; x < cells.columns; ++x)
                rest_m.emplace_back(glm::dvec2(static_cast<double>(cells.x + x - middle.x) + 0.5,
                                               static_cast<double>(cells.y + y - middle.y) + 0.5) *
                                    plan_.cell_m);
        moments.resize(rest_m.size());
        breaks.resize(rest_m.size());
        Results<T> results;
        results.set(Product::JacobianMoments, {moments.data()});
        results.set(Product::Breaking, {breaks.data()});
        query.evaluate({.origin_m = origin_m, .count = rest_m.size(), .rest_m = {rest_m.data()}}, results);

        of_row.assign(static_cast<std::size_t>(rows), {});
        tbb::parallel_for(std::int64_t{0}, rows, [&](std::int64_t row) {
            for (std::int64_t x = 0; x < cells.columns; ++x) {
                const auto i = static_cast<std::size_t>(row * cells.columns + x);
                if (!(breaks[i] > T(0))) continue;
                // Of the world's area, as the mean: water that breaks is compressed.
                const auto& j = moments[i];
                const double share =
                    static_cast<double>(breaks[i]) *
                    sea_area(JacobianMoments<double>{static_cast<double>(j.x), static_cast<double>(j.y),
                                                     static_cast<double>(j.z)},
                             third) /
                    mean_breaking_;
                if (!(share > 0.0)) continue;
                const double expected = plan_.parcels_per_s * plan_.interval_s * share;
                const glm::i64vec2 cell(cells.x + x, cells.y + first + row);
                const double chance =
                    unit(philox({word(cell.x), word(cell.y), word(interval), kStream}, seed_)[0]);
                const double most = SprayDropsPlan::kMostParcels;
                const double weight = std::max(expected / most, 1.0);
                const auto count = static_cast<int>(std::floor(std::min(expected, most) + chance));
                for (int number = 0; number < std::min(count, SprayDropsPlan::kMostParcels); ++number) {
                    Parcel parcel = started(interval, cell, number, weight);
                    parcel.from_m.x =
                        (parcel.from_m.x + static_cast<double>(cell.x - middle.x)) * plan_.cell_m;
                    parcel.from_m.y =
                        (parcel.from_m.y + static_cast<double>(cell.y - middle.y)) * plan_.cell_m;
                    of_row[static_cast<std::size_t>(row)].push_back(parcel);
                }
            }
        });

        const std::size_t begin = made.size();
        for (const std::vector<Parcel>& row : of_row) made.insert(made.end(), row.begin(), row.end());
        const std::size_t count = made.size() - begin;
        if (count == 0) continue;
        rest_m.clear();
        for (std::size_t i = begin; i < made.size(); ++i) rest_m.emplace_back(glm::dvec2(made[i].from_m));
        displaced_m.resize(count);
        moves_mps.resize(count);
        Results<T> starts;
        starts.set(Product::Displacement, {displaced_m.data()});
        starts.set(Product::Velocity, {moves_mps.data()});
        query.evaluate({.origin_m = origin_m, .count = count, .rest_m = {rest_m.data()}}, starts);
        tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
            Parcel& parcel = made[begin + i];
            const glm::dvec3 water_mps(moves_mps[i]);
            parcel.from_m +=
                glm::dvec3(origin_m, 0.0) + glm::dvec3(displaced_m[i]) + water_mps * parcel.since_s;
            parcel.start_mps += water_mps;
            constexpr double kFalls_m = 0.2;  // at least: a trough's drops fall back into it
            parcel.end_at(std::min(parcel.from_m.z - kFalls_m, 0.0));
            parcel.section_m2 /= parcel.life_s;
        });
    }
    if (hulls_) leave_out_of_hulls(made, time_s);
    return made;
}

template <class T>
void SprayDrops<T>::leave_out_of_hulls(std::vector<Parcel>& parcels, double time_s) {
    const Plan& plan = frame_->sea().plan();
    const Shot& shot = plan.from->scene.shot;
    // No frame shows a time of a sea that stands still: drops then start beside hulls as they are in the first, though one with a
    // path of its own goes on.
    const double frame =
        shot.time_scale > 0.0 ? frame_at(shot, time_s) : static_cast<double>(shot.first_frame);
    hulls_->place(*frame_, hulls_query(plan), frame);
    std::erase_if(parcels, [&](const Parcel& parcel) { return hulls_->distance_m(parcel.from_m) < 0.0; });
}

template <class T>
void SprayDrops<T>::at(double time_s, glm::dvec2 middle_m, std::vector<SprayDrop>& drops,
                       const std::atomic<bool>* cancel) {
    drops.clear();
    if (empty()) return;
    const double now_s = time_within_loop_s(time_s, frame_->sea().loop_s());
    const auto last = static_cast<std::int64_t>(std::floor(now_s / plan_.interval_s));
    const std::int64_t first = last + 1 - plan_.intervals();
    if (const Cells cells = cells_round(middle_m); !(cells == cells_)) {
        known_.clear();
        cells_ = cells;
    }
    std::erase_if(known_, [&](const auto& of) {
        const std::int64_t before =
            plan_.intervals_a_loop > 0 ? within_loop(of.first - first) : of.first - first;
        return before < 0 || before > last - first;
    });
    const glm::dvec2 low_m = middle_m - 0.5 * size_m_, high_m = middle_m + 0.5 * size_m_;
    for (std::int64_t interval = first; interval <= last; ++interval) {
        const std::int64_t same = within_loop(interval);
        auto known = known_.find(same);
        if (known == known_.end()) known = known_.emplace(same, made(same, cells_, cancel)).first;
        const double since_s = now_s - static_cast<double>(interval) * plan_.interval_s;
        for (const Parcel& parcel : known->second) {
            const double age_s = since_s - parcel.since_s;
            if (!(age_s > 0.0 && age_s < parcel.life_s)) continue;
            const glm::dvec3 at_m = parcel.position(age_s);
            if (!(at_m.x >= low_m.x && at_m.y >= low_m.y && at_m.x < high_m.x && at_m.y < high_m.y)) continue;
            const double section_m2 = parcel.section_m2 * presence(age_s / parcel.life_s);
            if (!(section_m2 > 0.0)) continue;
            drops.push_back({.position_m = at_m,
                             .velocity_mps = parcel.velocity(age_s),
                             .width_m = parcel.width_m * (1.0 + kWider_per_s * age_s),
                             .section_m2 = section_m2,
                             .id = parcel.id});
        }
    }
}

template class SprayDrops<float>;
template class SprayDrops<double>;

}  // namespace pelagic
