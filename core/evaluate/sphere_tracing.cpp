// Sphere tracing of wave trains, for each instruction set. See sphere_tracing.h.
#include "core/evaluate/sphere_tracing.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <stdexcept>
#include <utility>

#include "core/base/constants.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/evaluate/sphere_tracing.cpp"
#include <hwy/foreach_target.h>
// foreach_target first: it includes this file once for each instruction set.
#include "core/evaluate/sphere_tracing-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pelagic {
namespace HWY_NAMESPACE {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Trains are evaluated until those left are this many times smaller, in sum, than the height over the others: more would
// hardly lengthen the step. 1 … 4 differ by 5 %.
constexpr double kEnough = 2.0;
constexpr double kGraze = 1.0 / 8.0;  // of the tolerance

// A ray's way through the layer of heights that waves reach, or a part of it.
struct Way {
    glm::dvec3 from_m, unit;
    double before_m = 0.0, length_m = 0.0;  // of the ray's beginning; of the way
    bool is_entered = false;                // from outside the layer
};
// How near a hit must be.
struct Tolerance {
    double least_m, at_beginning_m, per_m;

    HWY_INLINE double at(const Way& way, double s_m) const {
        return std::max(least_m, at_beginning_m + (way.before_m + s_m) * per_m);
    }
};
// What is known of the ray at some place: a safe step; and, from the trains that were evaluated for it, the height
// over the surface (positive on the ray's side), less the amplitudes of the others, with its slope along the ray and
// in time.
struct Look {
    double step_m = 0.0;
    bool is_whole = false;
    std::size_t groups = 0;
    double clearance_m = 0.0, slope = 0.0, rate_mps = 0.0;
};

// One ray after the other. kSeen: with SeenSpheres.
template <bool kSeen>
class Tracer {
    using Sphere = SeenSpheres::Sphere;
    using Waves = TrainsAlongRay<kSeen>;

  public:
    explicit Tracer(const TracedTrains& trains) : trains_(trains), waves_(trains) {}

    void begin(const Way& way) {
        way_ = way;
        waves_.begin(way.from_m, way.unit);
        side_ = side();
    }
    // `enough_m`: a longer step is of no use.
    HWY_INLINE Look look(double s_m, double enough_m) {
        Look seen;
        typename Waves::Sum sea;
        const double z_m = way_.from_m.z + s_m * way_.unit.z;
        for (std::size_t group = 0;; ++group) {
            const double clearance_m = side_ * (z_m - sea.height_m) - trains_.rest_m[group];
            const double slope = side_ * (way_.unit.z - sea.slope);
            const double surely_m = clearance_m - trains_.height_error_m;
            const bool is_whole = group == trains_.groups;
            if (surely_m > 0.0 || is_whole) {
                const double step_m =
                    ahead(group, std::max(surely_m, 0.0), slope - trains_.slope_error).zero();
                if (step_m > seen.step_m || is_whole)
                    seen = {std::max(step_m, seen.step_m), is_whole, group, clearance_m, slope,
                            -side_ * sea.rate_mps};
            }
            if (is_whole || seen.step_m >= enough_m || surely_m > kEnough * trains_.rest_m[group])
                return seen;
            waves_.add(group, s_m, sea);
        }
    }
    // The hit's distance from the way's beginning [m]; infinite: none. With kSeen `ray` comes from another time, and
    // leaves with this one's.
    double hit_m(const Tolerance& tolerance, int most_steps, SeenSpheres* seen, SeenSpheres::Ray* ray) {
        if constexpr (kSeen) {
            const bool is_same = ray->from_m == way_.from_m && ray->unit == way_.unit && ray->side == side_;
            const auto first = seen->spheres.begin() + static_cast<std::ptrdiff_t>(ray->first);
            old_.assign(first, first + static_cast<std::ptrdiff_t>(is_same ? ray->count : 0));
            found_.clear();
            const double hit = search_m(tolerance, most_steps);
            *ray = {way_.from_m, way_.unit, side_, seen->next.size(), found_.size()};
            seen->next.insert(seen->next.end(), found_.begin(), found_.end());
            return hit;
        }
        return search_m(tolerance, most_steps);
    }
    std::size_t evaluated() const { return waves_.evaluated(); }

  private:
    // A hit, and the distance from which the way to it is known to be clear.
    struct Ending {
        double hit_m = kInfinity, clear_from_m = kInfinity;
    };

    HWY_INLINE double side() {
        if (way_.is_entered) return way_.unit.z < 0.0 ? 1.0 : -1.0;
        typename Waves::Sum sea;
        for (std::size_t group = 0; group < trains_.groups; ++group) waves_.add(group, 0.0, sea);
        const double clearance_m = way_.from_m.z - sea.height_m;
        if (std::abs(clearance_m) > trains_.height_error_m) return clearance_m > 0.0 ? 1.0 : -1.0;
        return way_.unit.z >= sea.slope ? 1.0 : -1.0;
    }
    HWY_INLINE Bound ahead(std::size_t groups, double f, double slope) const {
        return {f, slope, waves_.curvature(groups), side_ * way_.unit.z - waves_.steepness(groups)};
    }
    HWY_INLINE Bound behind(std::size_t groups, double f, double slope) const {
        return {f, -slope, waves_.curvature(groups), -side_ * way_.unit.z - waves_.steepness(groups)};
    }

    double search_m(const Tolerance& tolerance, int most_steps) {
        Ending guessed;
        if constexpr (kSeen)
            if (!old_.empty()) guessed = guess(tolerance);
        double s_m = 0.0;
        std::size_t next = 0;
        for (int step = 0; step < most_steps; ++step) {
            if constexpr (kSeen) {
                s_m = pass(next, s_m, tolerance);
                if (guessed.hit_m < kInfinity && guessed.clear_from_m <= s_m) {
                    // pass() may have taken the look at the hit.
                    if (found_.empty() || found_.back().s_m != old_.back().s_m) found_.push_back(old_.back());
                    return guessed.hit_m <= way_.length_m ? guessed.hit_m : kInfinity;
                }
            }
            if (!(s_m < way_.length_m)) return kInfinity;
            const Look seen = look(s_m, way_.length_m - s_m);
            if (kSeen) found_.push_back(sphere_of(seen, s_m));
            if (seen.is_whole) {
                if (seen.clearance_m < -trains_.height_error_m) return s_m;
                const double hit = end_m(seen, s_m, tolerance.at(way_, s_m));
                if (hit < kInfinity) return hit <= way_.length_m ? hit : kInfinity;
            }
            s_m += seen.step_m;
        }
        return s_m < way_.length_m ? s_m : kInfinity;
    }
    // The hit, where a look from its own side shows it to be so near.
    HWY_INLINE double end_m(const Look& seen, double s_m, double within_m) const {
        const double latest_m = latest_zero(seen.clearance_m + trains_.height_error_m,
                                            seen.slope + trains_.slope_error, waves_.curvature(seen.groups));
        if (latest_m - seen.step_m <= 2.0 * within_m) return s_m + 0.5 * (seen.step_m + latest_m);
        return seen.clearance_m <= kGraze * within_m && seen.step_m <= within_m ? s_m : kInfinity;
    }

    // Predicts where the last hit has moved, from the sea's slope and rate there. The look at that place becomes the
    // last of the old ones.
    Ending guess(const Tolerance& tolerance) {
        const Sphere last = old_.back();
        const double slope = static_cast<double>(last.slope);
        if (last.groups != trains_.groups || !(slope < 0.0)) return {};
        const double dt = trains_.time_s - last.time_s;
        const double at_m =
            last.s_m + (static_cast<double>(last.f_m) + dt * static_cast<double>(last.rate_mps)) / -slope;
        if (!(at_m > 0.0 && at_m < way_.length_m)) return {};
        const Look seen = look(at_m, kInfinity);
        if (!seen.is_whole) return {};
        old_.push_back(sphere_of(seen, at_m));
        const double within_m = tolerance.at(way_, at_m);
        const double error_m = trains_.height_error_m, slope_error = trains_.slope_error;
        if (seen.clearance_m >= error_m) {
            const double hit = end_m(seen, at_m, within_m);
            if (hit == kInfinity) return {};
            return {hit,
                    at_m - behind(seen.groups, seen.clearance_m - error_m, seen.slope + slope_error).zero()};
        }
        // A look from behind the surface. Backwards from there F may be 0 from `first` on, has been 0 by `latest`,
        // and then stays positive for a while.
        const double curvature = waves_.curvature(seen.groups), rise = -seen.slope - slope_error;
        const double square = rise * rise + 2.0 * curvature * (seen.clearance_m - error_m);
        if (!(seen.clearance_m < -error_m && rise > 0.0 && square > 0.0 && curvature > 0.0)) return {};
        const double root = std::sqrt(square), latest_m = 2.0 * (error_m - seen.clearance_m) / (rise + root);
        const double first_m =
            Bound{-seen.clearance_m - error_m, seen.slope - slope_error, curvature, -kInfinity}.zero();
        if (latest_m - first_m > 2.0 * within_m) return {};
        return {at_m - 0.5 * (first_m + latest_m), at_m - (rise + root) / curvature};
    }
    // How far old looks, from `next` on, still show the way to be clear [m].
    HWY_INLINE double pass(std::size_t& next, double s_m, const Tolerance& tolerance) {
        for (; next < old_.size(); ++next) {
            const Sphere& sphere = old_[next];
            const double dt = trains_.time_s - sphere.time_s, either = std::abs(dt),
                         rate = static_cast<double>(sphere.rate_mps),
                         slope = static_cast<double>(sphere.slope);
            const double f = static_cast<double>(sphere.f_m) + dt * rate - either * trains_.rate_error -
                             0.5 * trains_.bend[sphere.groups] * dt * dt;
            if (!(f > 0.0)) continue;
            waves_.need(sphere.groups);
            const double less = waves_.mixed(sphere.groups) * either;
            if (sphere.s_m - behind(sphere.groups, f, slope + 4.0 * trains_.slope_error + less).zero() > s_m)
                return s_m;
            const double to_m = sphere.s_m + ahead(sphere.groups, f, slope - less).zero();
            if (to_m <= s_m + tolerance.at(way_, s_m)) continue;
            found_.push_back(sphere);
            s_m = to_m;
        }
        return s_m;
    }
    // In single precision, rounded to the safe side by another of the errors that rounding may make.
    Sphere sphere_of(const Look& seen, double s_m) const {
        return {.s_m = s_m,
                .time_s = trains_.time_s,
                .f_m = static_cast<float>(seen.clearance_m - 2.0 * trains_.height_error_m),
                .slope = static_cast<float>(seen.slope - 2.0 * trains_.slope_error),
                .rate_mps = static_cast<float>(seen.rate_mps),
                .groups = static_cast<std::uint32_t>(seen.groups)};
    }
    const TracedTrains& trains_;
    Waves waves_;
    Way way_{};
    double side_ = 1.0;
    std::vector<Sphere> old_, found_;
};

// The part of a ray between two distances [m] that lies in the layer; of no length where there is none.
Way way_of(const TracedTrains& trains, glm::dvec3 from_m, glm::dvec3 unit, double near_m, double far_m) {
    const double crest_m = trains.rest_m.front() + 2.0 * trains.height_error_m;
    double enters_m = -kInfinity, leaves_m = kInfinity;
    if (unit.z != 0.0) {
        const double one_m = (crest_m - from_m.z) / unit.z, other_m = (-crest_m - from_m.z) / unit.z;
        enters_m = std::min(one_m, other_m);
        leaves_m = std::max(one_m, other_m);
    } else if (std::abs(from_m.z) > crest_m) {
        return {from_m, unit};
    }
    const double begin_m = std::max(near_m, enters_m);
    return {.from_m = from_m + begin_m * unit,
            .unit = unit,
            .before_m = begin_m,
            .length_m = std::min(far_m, leaves_m) - begin_m,
            .is_entered = enters_m > near_m};
}

bool is_finite(glm::dvec3 v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

template <bool kSeen>
std::size_t trace_rays(const TracedTrains& trains, const TracedRays& rays, Strided<double> distance,
                       SeenSpheres* seen) {
    Tracer<kSeen> tracer(trains);
    // Until all is done `seen` holds nothing, so that a call that fails leaves nothing half written.
    std::vector<SeenSpheres::Ray> each;
    if constexpr (kSeen) {
        each.swap(seen->rays);
        if (seen->sea != trains.sea) each.clear();
        each.resize(rays.count);
        seen->sea = trains.sea;
        seen->next.clear();
    }
    for (std::size_t i = 0; i < rays.count; ++i) {
        distance[i] = kInfinity;
        SeenSpheres::Ray before;
        if constexpr (kSeen) std::swap(before, each[i]);  // of none until it is traced
        const glm::dvec3 direction(rays.direction[i]);
        const glm::dvec3 from_m =
            rays.origin_m + (rays.offset_m ? glm::dvec3(rays.offset_m[i]) : glm::dvec3(0.0));
        const double length = glm::length(direction);
        const double near_m = rays.near ? length * static_cast<double>(rays.near[i]) : 0.0,
                     far_m = rays.far ? length * static_cast<double>(rays.far[i]) : kInfinity;
        if (!is_finite(from_m) || !std::isfinite(length) || length == 0.0 || !std::isfinite(near_m)) continue;
        const Way way = way_of(trains, from_m, direction / length, near_m, far_m);
        if (!(way.length_m > 0.0)) continue;
        tracer.begin(way);
        const Tolerance tolerance{2.0 / kGraze * trains.height_error_m,
                                  rays.tolerance_m ? static_cast<double>(rays.tolerance_m[i]) : 1e-3,
                                  rays.tolerance_per_m ? static_cast<double>(rays.tolerance_per_m[i]) : 0.0};
        const double hit_m = tracer.hit_m(tolerance, rays.most_steps, seen, &before);
        if constexpr (kSeen) each[i] = before;
        distance[i] = (way.before_m + hit_m) / length;
    }
    if constexpr (kSeen) {
        seen->spheres.swap(seen->next);
        seen->rays.swap(each);
    }
    return tracer.evaluated();
}

}  // namespace

std::size_t TraceRays(const TracedTrains& trains, const TracedRays& rays, Strided<double> distance,
                      SeenSpheres* seen) {
    return seen ? trace_rays<true>(trains, rays, distance, seen)
                : trace_rays<false>(trains, rays, distance, nullptr);
}

double SafeStep(const TracedTrains& trains, glm::dvec3 from_m, glm::dvec3 unit) {
    Tracer<false> tracer(trains);
    tracer.begin({.from_m = from_m, .unit = unit});
    return tracer.look(0.0, kInfinity).step_m;
}

}  // namespace HWY_NAMESPACE
}  // namespace pelagic
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelagic {
HWY_EXPORT(TraceRays);
HWY_EXPORT(SafeStep);

namespace {

// The hash with a number added: FNV-1a over its bits, in one step.
std::uint64_t mixed(std::uint64_t hash, double number) {
    hash = (hash ^ std::bit_cast<std::uint64_t>(number)) * 0x100000001b3u;
    return hash ^ (hash >> 32);
}

TracedTrains traced_trains(const Frame<float>& frame, double cell_m) {
    if (!frame.is_set()) throw std::invalid_argument("sphere tracing: the frame has no time yet");
    if (!(cell_m >= 0.0)) throw std::invalid_argument("sphere tracing: a cell's footprint must be 0 or more");
    const Sea<float>& sea = frame.sea();
    const Trains<float>& all = sea.trains();
    if (!sea.cascades().empty())
        throw std::invalid_argument("sphere tracing: the sea must be of wave trains alone, without cascades");
    for (const double horizontal_m : all.horizontal_m)
        if (horizontal_m > 0.0)
            throw std::invalid_argument(
                "sphere tracing: the sea must be a height field: waves.choppiness = 0");

    const std::vector<double> cycles = phases_at(all, {0.0, 0.0}, frame.time_within_loop_s());
    TracedTrains trains;
    const std::size_t most = (all.count() + TracedTrains::kGroup - 1) / TracedTrains::kGroup;
    for (Buffer<double>* const of : {&trains.kx_cycles_per_m, &trains.ky_cycles_per_m, &trains.start_cycles})
        *of = Buffer<double>(most * TracedTrains::kGroup);
    for (Buffer<float>* const of : {&trains.amplitude_m, &trains.omega})
        *of = Buffer<float>(most * TracedTrains::kGroup);
    double heights_m = 0.0, slopes = 0.0, rates_mps = 0.0, bend = 0.0;
    trains.bend.push_back(0.0);
    for (std::size_t i = 0; i < all.count(); ++i) {
        const double k = kTwoPi / all.wavelength_m[i];
        const double height_m = all.height_m[i] * sea.plan().filter.weight(k, cell_m);
        if (!(height_m > 0.0)) continue;
        const std::size_t at = trains.count++;
        trains.kx_cycles_per_m[at] = all.kx_cycles_per_m[i];
        trains.ky_cycles_per_m[at] = all.ky_cycles_per_m[i];
        trains.start_cycles[at] = cycles[i];
        trains.amplitude_m[at] = static_cast<float>(height_m);
        const double omega = kTwoPi * all.cycles_per_s[i];
        trains.omega[at] = static_cast<float>(omega);
        heights_m += height_m;
        slopes += k * height_m;
        rates_mps += omega * height_m;
        trains.bend.resize(at / TracedTrains::kGroup + 2);
        trains.bend.back() = bend += omega * omega * height_m;
        for (const double own : {all.kx_cycles_per_m[i], all.ky_cycles_per_m[i], all.cycles_per_s[i],
                                 all.start_cycles[i], height_m})
            trains.sea = mixed(trains.sea, own);
    }
    trains.time_s = frame.time_within_loop_s();
    trains.groups = (trains.count + TracedTrains::kGroup - 1) / TracedTrains::kGroup;
    trains.rest_m.assign(trains.groups + 1, 0.0);
    for (std::size_t group = trains.groups; group-- > 0;) {
        trains.rest_m[group] = trains.rest_m[group + 1];
        for (std::size_t i = 0; i < TracedTrains::kGroup; ++i)
            trains.rest_m[group] += static_cast<double>(trains.amplitude_m[group * TracedTrains::kGroup + i]);
    }
    // In units of 2⁻²⁴ of an amplitude: 1 of the amplitude, π of its phase's rounding, 2 of the sine, 1 of each sum on the way, of
    // which 16 lanes and their own sum have five. The last is for seas of no height.
    constexpr double kErrors = 16.0 / (1 << 24);
    trains.height_error_m = kErrors * heights_m + 1e-7;
    trains.slope_error = kErrors * slopes;
    trains.rate_error = kErrors * rates_mps;
    return trains;
}

}  // namespace

SphereTracing::SphereTracing(const Frame<float>& frame, double cell_m)
    : trains_(traced_trains(frame, cell_m)) {}

std::size_t SphereTracing::trace(const TracedRays& rays, Strided<double> distance, SeenSpheres* seen) const {
    return HWY_DYNAMIC_DISPATCH(TraceRays)(trains_, rays, distance, seen);
}

double SphereTracing::safe_step_m(glm::dvec3 from_m, glm::dvec3 direction) const {
    return HWY_DYNAMIC_DISPATCH(SafeStep)(trains_, from_m, glm::normalize(direction));
}

}  // namespace pelagic
#endif
