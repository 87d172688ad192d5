// Sphere tracing of wave trains, for each instruction set. See sphere_tracing.h.
#include "core/evaluate/sphere_tracing.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <stdexcept>

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
// What is known of the ray at some place: the step that is safe, and where all trains were evaluated the height over the
// surface (of the ray's side), its slope along the ray and the bound of that slope's change.
struct Look {
    double step_m = 0.0;
    bool is_whole = false;
    double clearance_m = 0.0, slope = 0.0, curvature = 0.0;
};

// A bound from below of what follows along the ray: f + g r − ½ M r², until its slope has fallen to `steepest`, and straight from
// there.
struct Bound {
    double f, g, curvature, steepest;

    // The first r > 0 where it is 0, for f ≥ 0; infinite where there is none.
    HWY_INLINE double zero() const {
        if (steepest >= 0.0) return kInfinity;
        const double root = std::sqrt(g * g + 2.0 * curvature * f);
        if (root <= -steepest) {  // −root is the slope there
            if (g < 0.0) return 2.0 * f / (root - g);
            return curvature > 0.0 ? (root + g) / curvature : kInfinity;
        }
        const double bent = curvature > 0.0 ? std::max(0.0, (g - steepest) / curvature) : 0.0;
        return bent + (f + 0.5 * bent * (g + steepest)) / -steepest;
    }
};
// The first r with f + g r + ½ M r² = 0: where a surface that curves away from the ray at most so much is met at the latest.
HWY_INLINE double latest_zero(double f, double g, double curvature) {
    const double square = g * g - 2.0 * curvature * f;
    return g < 0.0 && square >= 0.0 ? 2.0 * f / (std::sqrt(square) - g) : kInfinity;
}

// `enough`: nobody wants a longer step [m]. side: 1 above the sea, −1 below.
HWY_INLINE Look look(TrainsAlongRay& waves, const TracedTrains& trains, const Way& way, double s_m,
                     double side, double enough_m) {
    Look seen;
    TrainsAlongRay::Sum sea;
    const double z_m = way.from_m.z + s_m * way.unit.z;
    for (std::size_t group = 0;; ++group) {
        const double clearance_m = side * (z_m - sea.height_m) - trains.rest_m[group];
        const double slope = side * (way.unit.z - sea.slope);
        const double curvature = group > 0 ? waves.curvature(group) : 0.0;
        const double surely_m = clearance_m - trains.height_error_m;
        if (surely_m > 0.0 || group == trains.groups) {
            const double steepest = side * way.unit.z - (group > 0 ? waves.steepness(group) : 0.0);
            const Bound bound{std::max(surely_m, 0.0), slope - trains.slope_error, curvature, steepest};
            seen.step_m = std::max(seen.step_m, bound.zero());
        }
        if (group == trains.groups) {
            seen.is_whole = true;
            seen.clearance_m = clearance_m;
            seen.slope = slope;
            seen.curvature = curvature;
            return seen;
        }
        if (seen.step_m >= enough_m || surely_m > kEnough * trains.rest_m[group]) return seen;
        waves.add(group, s_m, sea);
    }
}

HWY_INLINE double side_of(TrainsAlongRay& waves, const TracedTrains& trains, const Way& way) {
    if (way.is_entered) return way.unit.z < 0.0 ? 1.0 : -1.0;
    TrainsAlongRay::Sum sea;
    for (std::size_t group = 0; group < trains.groups; ++group) waves.add(group, 0.0, sea);
    const double clearance_m = way.from_m.z - sea.height_m;
    if (std::abs(clearance_m) > trains.height_error_m) return clearance_m > 0.0 ? 1.0 : -1.0;
    return way.unit.z >= sea.slope ? 1.0 : -1.0;
}

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

// From the way's beginning [m]; infinite: none.
double hit_m(TrainsAlongRay& waves, const TracedTrains& trains, const Way& way, double tolerance_m,
             double tolerance_per_m, int most_steps) {
    const double least_m = 2.0 / kGraze * trains.height_error_m;
    waves.begin(way.from_m, way.unit);
    const double side = side_of(waves, trains, way);
    double s_m = 0.0;
    for (int step = 0; step < most_steps; ++step) {
        const Look seen = look(waves, trains, way, s_m, side, way.length_m - s_m);
        if (seen.is_whole) {
            const double within_m = std::max(least_m, tolerance_m + (way.before_m + s_m) * tolerance_per_m);
            if (seen.clearance_m < -trains.height_error_m) return s_m;
            const double latest_m = latest_zero(seen.clearance_m + trains.height_error_m,
                                                seen.slope + trains.slope_error, seen.curvature);
            if (latest_m - seen.step_m <= 2.0 * within_m) {
                const double at_m = s_m + 0.5 * (seen.step_m + latest_m);
                return at_m <= way.length_m ? at_m : kInfinity;
            }
            if (seen.clearance_m <= kGraze * within_m && seen.step_m <= within_m) return s_m;
        }
        s_m += seen.step_m;
        if (!(s_m < way.length_m)) return kInfinity;
    }
    return s_m;
}

bool is_finite(glm::dvec3 v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace

std::size_t TraceRays(const TracedTrains& trains, const TracedRays& rays, Strided<double> distance) {
    TrainsAlongRay waves(trains);
    for (std::size_t i = 0; i < rays.count; ++i) {
        distance[i] = kInfinity;
        const glm::dvec3 direction(rays.direction[i]);
        const glm::dvec3 from_m =
            rays.origin_m + (rays.offset_m ? glm::dvec3(rays.offset_m[i]) : glm::dvec3(0.0));
        const double length = glm::length(direction);
        const double near_m = rays.near ? length * static_cast<double>(rays.near[i]) : 0.0,
                     far_m = rays.far ? length * static_cast<double>(rays.far[i]) : kInfinity;
        if (!is_finite(from_m) || !std::isfinite(length) || length == 0.0 || !std::isfinite(near_m)) continue;
        const Way way = way_of(trains, from_m, direction / length, near_m, far_m);
        if (!(way.length_m > 0.0)) continue;
        const double hit =
            hit_m(waves, trains, way, rays.tolerance_m ? static_cast<double>(rays.tolerance_m[i]) : 1e-3,
                  rays.tolerance_per_m ? static_cast<double>(rays.tolerance_per_m[i]) : 0.0, rays.most_steps);
        distance[i] = (way.before_m + hit) / length;
    }
    return waves.evaluated();
}

double SafeStep(const TracedTrains& trains, glm::dvec3 from_m, glm::dvec3 unit) {
    TrainsAlongRay waves(trains);
    waves.begin(from_m, unit);
    const Way way{.from_m = from_m, .unit = unit};
    return look(waves, trains, way, 0.0, side_of(waves, trains, way), kInfinity).step_m;
}

}  // namespace HWY_NAMESPACE
}  // namespace pelagic
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelagic {
HWY_EXPORT(TraceRays);
HWY_EXPORT(SafeStep);

namespace {

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
    trains.amplitude_m = Buffer<float>(most * TracedTrains::kGroup);
    double heights_m = 0.0, slopes = 0.0;
    for (std::size_t i = 0; i < all.count(); ++i) {
        const double k = kTwoPi / all.wavelength_m[i];
        const double height_m = all.height_m[i] * sea.plan().filter.weight(k, cell_m);
        if (!(height_m > 0.0)) continue;
        const std::size_t at = trains.count++;
        trains.kx_cycles_per_m[at] = all.kx_cycles_per_m[i];
        trains.ky_cycles_per_m[at] = all.ky_cycles_per_m[i];
        trains.start_cycles[at] = cycles[i];
        trains.amplitude_m[at] = static_cast<float>(height_m);
        heights_m += height_m;
        slopes += k * height_m;
    }
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
    return trains;
}

}  // namespace

SphereTracing::SphereTracing(const Frame<float>& frame, double cell_m)
    : trains_(traced_trains(frame, cell_m)) {}

std::size_t SphereTracing::trace(const TracedRays& rays, Strided<double> distance) const {
    return HWY_DYNAMIC_DISPATCH(TraceRays)(trains_, rays, distance);
}

double SphereTracing::safe_step_m(glm::dvec3 from_m, glm::dvec3 direction) const {
    return HWY_DYNAMIC_DISPATCH(SafeStep)(trains_, from_m, glm::normalize(direction));
}

}  // namespace pelagic
#endif
