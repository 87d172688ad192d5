#include "core/plan/wake_strip.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include "core/spectrum/dispersion.h"

namespace pelagic {
namespace {

constexpr double kPointsALength = 2.0;  // of the path
constexpr int kMostPoints = 160;
constexpr std::size_t kBoxSteps = 8;
constexpr double kOldest_s = 300.0;
constexpr double kWhite_s = 4.0,
                 kWhite = 0.75;  // what breaks at bow and stern: its e-folding time, and its coverage
constexpr double kBeaten_s = 90.0, kBeaten = 0.6;  // what the propeller beats in
constexpr double kDamped = 0.7;                    // of short waves' amplitude, by new turbulence

double rise(double x) {
    const double t = std::clamp(x, 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

}  // namespace

WakeStrip::WakeStrip(const VesselPlan& plan, double time_s)
    : length_m_(plan.length_m), beam_m_(plan.beam_m), foam_(plan.foam) {
    const VesselPath& path = plan.path;
    // A vessel that stands makes none.
    const double least_mps = 0.15 * std::sqrt(kGravity * plan.length_m);
    const auto strength = [&](double t_s) {
        return rise(glm::length(path.velocity_mps(t_s)) / least_mps - 0.5);
    };
    const double step_m = plan.length_m / kPointsALength, step_s = step_m / plan.speed_mps;
    const glm::dvec2 now_m = path.at(time_s), velocity = path.velocity_mps(time_s);
    const glm::dvec2 along = glm::length(velocity) > 0.0 ? glm::normalize(velocity) : glm::dvec2(1.0, 0.0);
    points_.push_back({now_m + 0.5 * plan.length_m * along, 0.0, 0.0, strength(time_s)});
    // On a lattice of its own of times, so that the line doesn't change as the vessel goes on.
    points_.push_back({now_m, 0.5 * plan.length_m, 0.0, strength(time_s)});
    for (double of = std::ceil(time_s / step_s) - 1.0; static_cast<int>(points_.size()) < kMostPoints;
         of -= 1.0) {
        const double t_s = of * step_s;
        if (time_s - t_s > kOldest_s) break;
        const glm::dvec2 place_m = path.at(t_s);
        points_.push_back({place_m, points_.back().way_m + glm::distance(place_m, points_.back().place_m),
                           time_s - t_s, strength(t_s)});
    }
    oldest_s_ = std::max(points_.back().age_s, step_s);
    const double reach_m = 2.0 * half_width_m(points_.back().way_m) + plan.beam_m;
    for (std::size_t i = 0; i + 1 < points_.size(); ++i) {
        const glm::dvec2 a = points_[i].place_m, b = points_[i + 1].place_m;
        const glm::dvec2 low_m = glm::min(a, b) - reach_m, high_m = glm::max(a, b) + reach_m;
        if (i % kBoxSteps == 0) boxes_.push_back({low_m, high_m});
        Box& box = boxes_.back();
        box = {glm::min(box.low_m, low_m), glm::max(box.high_m, high_m)};
        low_m_ = i == 0 ? box.low_m : glm::min(low_m_, box.low_m);
        high_m_ = i == 0 ? box.high_m : glm::max(high_m_, box.high_m);
    }
}

bool WakeStrip::Box::holds(glm::dvec2 place_m) const {
    return place_m.x >= low_m.x && place_m.y >= low_m.y && place_m.x <= high_m.x && place_m.y <= high_m.y;
}

double WakeStrip::half_width_m(double behind_m) const {
    return 0.5 * beam_m_ * std::pow(1.0 + std::max(behind_m, 0.0) / (0.5 * length_m_), 0.2);
}

bool WakeStrip::reaches(glm::dvec2 low_m, glm::dvec2 high_m) const {
    return !glm::any(glm::greaterThan(low_m, high_m_)) && !glm::any(glm::lessThan(high_m, low_m_));
}

WakeStrip::Water WakeStrip::at(glm::dvec2 place_m, double footprint_m) const {
    Water water;
    if (!reaches(place_m, place_m)) return water;
    double nearest = INFINITY, share = 0.0;
    std::size_t of = 0;
    for (std::size_t i = 0; i + 1 < points_.size(); ++i) {
        if (i % kBoxSteps == 0 && !boxes_[i / kBoxSteps].holds(place_m)) {
            i += kBoxSteps - 1;
            continue;
        }
        const glm::dvec2 from = points_[i].place_m, along = points_[i + 1].place_m - from,
                         to = place_m - from;
        const double length2 = glm::dot(along, along);
        const double t = length2 > 0.0 ? std::clamp(glm::dot(to, along) / length2, 0.0, 1.0) : 0.0;
        const glm::dvec2 off = to - t * along;
        if (const double square = glm::dot(off, off); square < nearest) {
            nearest = square;
            share = t;
            of = i;
        }
    }
    if (!std::isfinite(nearest)) return water;
    const Point &a = points_[of], &b = points_[of + 1];
    const double off_m = std::sqrt(nearest), way_m = std::lerp(a.way_m, b.way_m, share),
                 age_s = std::lerp(a.age_s, b.age_s, share),
                 strength = std::lerp(a.strength, b.strength, share);
    const double end = rise(4.0 * (1.0 - age_s / oldest_s_));
    // A band round `middle_m` to either side, of soft edges; a pixel's width makes it wider and thinner.
    const auto band = [&](double middle_m, double half_m) {
        const double wide_m = std::max(half_m, 0.5 * footprint_m);
        return half_m / wide_m * rise(1.5 * (1.0 - std::abs(off_m - middle_m) / (1.3 * wide_m)));
    };
    const double behind_m = way_m - length_m_, half_m = half_width_m(behind_m);
    const double stern = rise(behind_m / beam_m_ + 0.5) * band(0.0, half_m) * strength * end;
    const double white = std::exp(-age_s / kWhite_s), beaten = std::exp(-age_s / kBeaten_s);
    // The bow's: from its two sides outwards, broken as it leaves the hull.
    const double ahead = std::max(1.0 - 2.0 * way_m / length_m_, 0.0);
    const double opened_m = 0.5 * beam_m_ * (1.0 - ahead * ahead) + 0.1 * way_m;
    const double bow_age_s = age_s + std::max(0.5 * length_m_ - way_m, 0.0) / length_m_;
    const double bow = kWhite * std::exp(-bow_age_s / kWhite_s) * strength *
                       rise(way_m / (0.15 * length_m_)) * band(opened_m, 0.08 * beam_m_ + 0.04 * way_m);
    const double left = stern * (kWhite * white + kBeaten * beaten);
    water.foam = foam_ * std::min(1.0 - (1.0 - std::min(left, 1.0)) * (1.0 - bow), 1.0);
    water.age_s = age_s;
    water.calm = kDamped * rise(behind_m / beam_m_ + 0.5) * band(0.0, 1.3 * half_m) * strength * end;
    return water;
}

}  // namespace pelagic
