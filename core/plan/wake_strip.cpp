#include "core/plan/wake_strip.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <utility>

#include "core/spectrum/dispersion.h"

namespace pelagic {
namespace {

constexpr double kPointsALength = 2.0;  // of the path
constexpr double kOldest_s = 300.0;

}  // namespace

WakeStrip::WakeStrip(const VesselPlan& plan, double time_s)
    : hull_{plan.length_m, plan.beam_m, plan.foam, 0.0} {
    const VesselPath& path = plan.path;
    // A vessel that stands makes none.
    const double least_mps = 0.15 * std::sqrt(kGravity * plan.length_m);
    const auto strength = [&](double t_s) {
        return wake_rise(glm::length(path.velocity_mps(t_s)) / least_mps - 0.5);
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
    for (Point& point : points_)
        point.half_m = wake_half_width(point.way_m - plan.length_m, plan.length_m, plan.beam_m);
    hull_.oldest_s = std::max(points_.back().age_s, step_s);
    reach_m_ = 2.0 * wake_half_width(points_.back().way_m, plan.length_m, plan.beam_m) + plan.beam_m;
    // The bow's bands open on and on: as far as they are seen, until 2 % of what broke is left.
    constexpr double kSeen_s = 4.0 * kWakeWhite_s;
    const double seen_m = std::min(points_.back().way_m, plan.length_m + kSeen_s * plan.speed_mps);
    reach_m_ = std::max(reach_m_, wake_bow_reach(seen_m, plan.beam_m));
    for (std::size_t i = 0; i + 1 < points_.size(); ++i) {
        const glm::dvec2 a = points_[i].place_m, b = points_[i + 1].place_m;
        const glm::dvec2 low_m = glm::min(a, b) - reach_m_, high_m = glm::max(a, b) + reach_m_;
        if (i % kBoxSteps == 0) boxes_.push_back({low_m, high_m});
        Box& box = boxes_.back();
        box = {glm::min(box.low_m, low_m), glm::max(box.high_m, high_m)};
        if (i == 0) whole_ = box;
        whole_ = {glm::min(whole_.low_m, box.low_m), glm::max(whole_.high_m, box.high_m)};
    }
}

WakeStrip::Off WakeStrip::off(std::size_t piece, glm::dvec2 place_m) const {
    const glm::dvec2 from = points_[piece].place_m, along = points_[piece + 1].place_m - from,
                     to = place_m - from;
    const double length2 = glm::dot(along, along);
    const double share = length2 > 0.0 ? std::clamp(glm::dot(to, along) / length2, 0.0, 1.0) : 0.0;
    const glm::dvec2 off = to - share * along;
    return {glm::dot(off, off), share};
}

WakeStrip::Pieces WakeStrip::near(glm::dvec2 low_m, glm::dvec2 high_m) const {
    Pieces pieces;
    if (!whole_.meets(low_m, high_m)) return pieces;
    // A place is within `half_m` of the middle: its nearest piece is at most twice that farther from the middle than the middle's.
    const glm::dvec2 middle_m = 0.5 * (low_m + high_m);
    const double half_m = 0.5 * glm::distance(low_m, high_m);
    std::array<double, kMostPoints> off_m;
    double nearest_m = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i + 1 < points_.size(); ++i) {
        if (i % kBoxSteps == 0 && !boxes_[i / kBoxSteps].meets(low_m, high_m)) {
            i += kBoxSteps - 1;
            continue;
        }
        off_m[pieces.count] = std::sqrt(off(i, middle_m).square_m2);
        nearest_m = std::min(nearest_m, off_m[pieces.count]);
        pieces.of[pieces.count++] = static_cast<std::uint8_t>(i);
    }
    constexpr double kRounding_m = 1e-3;
    const double most_m = std::min(nearest_m + half_m, reach_m_) + half_m + kRounding_m;
    const std::size_t known = std::exchange(pieces.count, 0);
    for (std::size_t p = 0; p < known; ++p)
        if (!(off_m[p] > most_m)) pieces.of[pieces.count++] = pieces.of[p];
    return pieces;
}

WakeWater<double> WakeStrip::at(glm::dvec2 place_m, double footprint_m, const Pieces& pieces,
                                Wanted wanted) const {
    const WakeWater<double> none{0.0, 0.0, 0.0};
    double nearest = reach_m_ * reach_m_, share = 0.0;
    std::size_t of = points_.size();
    for (std::size_t p = 0; p < pieces.count; ++p)
        if (const Off here = off(pieces.of[p], place_m); here.square_m2 < nearest) {
            nearest = here.square_m2;
            share = here.share;
            of = pieces.of[p];
        }
    if (of == points_.size()) return none;
    const Point &a = points_[of], &b = points_[of + 1];
    const WakePlace<double> at{std::sqrt(nearest), std::lerp(a.way_m, b.way_m, share),
                               std::lerp(a.age_s, b.age_s, share), std::lerp(a.strength, b.strength, share)};
    const double footprint = std::min(footprint_m, kWakeWidest * reach_m_), half_pixel_m = 0.5 * footprint;
    // Beyond its bands, where its formula gives nothing.
    if (at.off_m > kBandReach * std::max(kWakeCalms * b.half_m, half_pixel_m) &&
        (wanted == Wanted::Calm ||
         at.off_m > wake_bow_reach(b.way_m, hull_.beam_m) + kBandReach * half_pixel_m))
        return none;
    return wake_water(hull_, at, footprint);
}

}  // namespace pelagic
