// See traced_ways.h.
#include "tests/bench/traced_ways.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/bench/traced_ways.cpp"
#include <hwy/foreach_target.h>
// foreach_target first: it includes this file once for each instruction set.
#include "core/evaluate/sphere_tracing-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pelagic::HWY_NAMESPACE {
namespace {

using bench::Bounds;
using bench::Picture;
using bench::Sphere;
using bench::Spheres;
using bench::Ways;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kEnough = 2.0;       // as in the core
constexpr double kGraze = 1.0 / 8.0;  // as in the core
constexpr std::size_t kGroup = TracedTrains::kGroup;

// What a group was last evaluated to be.
struct Evaluated {
    double s_m = -kInfinity, height_m = 0.0, slope = 0.0;
};
struct Look {
    Sphere sphere;
    double step_m = 0.0;
    bool is_whole = false;
    double highest = 0.0, steepest = 0.0;  // where whole: bounds of F and F' from the other side
};

class Waves : public TrainsAlongRay<true> {
    using Base = TrainsAlongRay<true>;
    using typename Base::D;
    using typename Base::Wide;

  public:
    explicit Waves(const TracedTrains& trains)
        : Base(trains),
          all_(trains),
          everywhere_(trains.groups + 1),
          last_(trains.groups),
          values_(trains.groups * kGroup) {
        for (std::size_t i = 0; i < trains.groups * kGroup; ++i) {
            Everywhere& to = everywhere_[i / kGroup + 1];
            if (i % kGroup == 0) to = everywhere_[i / kGroup];
            const double height_m = static_cast<double>(trains.amplitude_m[i]);
            to.steepness +=
                height_m * kTwoPi * std::hypot(trains.kx_cycles_per_m[i], trains.ky_cycles_per_m[i]);
            to.fastest += height_m * static_cast<double>(trains.omega[i]);
        }
    }
    void begin(glm::dvec3 from_m, glm::dvec3 unit, bool all_groups) {
        Base::begin(from_m, unit);
        z_m_ = from_m.z;
        rise_ = unit.z;
        for (Evaluated& last : last_) last.s_m = -kInfinity;
        if (all_groups) need(all_.groups);
    }
    double steepest_anywhere() const { return everywhere_.back().steepness; }
    double height_over(double s_m) const { return z_m_ + s_m * rise_; }

    // All trains at once: for the ways without groups.
    double whole(double s_m) {
        const D d;
        const auto s = hn::Set(Wide(), s_m);
        auto height = hn::Zero(d);
        for (std::size_t i = 0; i < all_.groups * kGroup; i += hn::Lanes(d)) {
            hn::Vec<D> sine, cosine;
            SinCosCycles(d, phases(d, i, s), sine, cosine);
            const auto own = hn::Mul(hn::Load(d, &all_.amplitude_m[i]), cosine);
            hn::Store(own, d, &values_[i]);
            height = hn::Add(height, own);
        }
        evaluated_ += all_.count;
        return height_over(s_m) - static_cast<double>(hn::GetLane(hn::SumOfLanes(d, height)));
    }

    // Algorithm 1 with its sort at each step.
    Look sorted(double s_m) {
        Look seen;
        seen.is_whole = true;
        seen.sphere.f = whole(s_m);
        order_.resize(all_.count);
        for (std::size_t i = 0; i < all_.count; ++i) {
            const double height_m = static_cast<double>(all_.amplitude_m[i]),
                         slope = static_cast<double>(std::abs(steepness_[i]));
            const double above = height_m - static_cast<double>(values_[i]);  // n − m
            order_[i] = {above / std::max(slope, 1e-30), above, slope};
        }
        std::sort(order_.begin(), order_.end(), [](const auto& a, const auto& b) { return a[0] > b[0]; });
        double numerator = height_over(s_m) - all_.rest_m.front(), denominator = -rise_;
        seen.step_m = numerator / denominator;
        for (const auto& [ratio, above, slope] : order_) {
            numerator += above;
            denominator += slope;
            if (seen.step_m > numerator / denominator) break;
            seen.step_m = numerator / denominator;
        }
        seen.step_m = std::max(seen.step_m, 0.0);
        return seen;
    }

    // The largest step over prefixes of groups, and what is known beyond it. `reuse_m`: by how much the bound of F may be off for the sake
    // of groups evaluated earlier; negative: not at all.
    template <Bounds kBounds>
    Look look(double s_m, double enough_m, double reuse_m) {
        constexpr bool kCurved = kBounds == Bounds::Curved;
        Look seen;
        double low = height_over(s_m), high = low, low_slope = rise_, high_slope = rise_;
        for (std::size_t group = 0;; ++group) {
            const double f = low - all_.rest_m[group] - all_.height_error_m;
            const double curvature = kCurved ? this->curvature(group) : 0.0;
            const double steepest = rise_ - steepness(group),
                         forward = kCurved ? low_slope - all_.slope_error : steepest;
            if (f > 0.0 || group == all_.groups) {
                const double step_m = Bound{std::max(f, 0.0), forward, curvature, steepest}.zero();
                const double steepness = everywhere_[group].steepness;
                if (step_m > seen.step_m || group == all_.groups) {
                    seen.step_m = std::max(seen.step_m, step_m);
                    const double radius_m = f / std::sqrt(1.0 + steepness * steepness);
                    seen.sphere = {.s_m = s_m,
                                   .f = f,
                                   .groups = group,
                                   .radius_m = std::max(seen.sphere.radius_m, radius_m)};
                }
            }
            if (group == all_.groups) {
                seen.is_whole = true;
                seen.highest = high + all_.height_error_m;
                seen.steepest = high_slope + all_.slope_error;
                return seen;
            }
            if (seen.step_m >= enough_m || f > kEnough * all_.rest_m[group]) return seen;
            need(group + 1);
            Evaluated& last = last_[group];
            const double own_curvature = this->curvature(group + 1) - this->curvature(group),
                         own_steepness = steepness(group + 1) - steepness(group);
            double moved_m = s_m - last.s_m;
            double off_m = kCurved ? 0.5 * own_curvature * moved_m * moved_m : own_steepness * moved_m;
            if (!(off_m <= reuse_m)) {
                Sum sum;
                add(group, s_m, sum);
                last = {s_m, sum.height_m, sum.slope};
                moved_m = off_m = 0.0;
            }
            const double height_m = last.height_m + (kCurved ? moved_m * last.slope : 0.0);
            low -= height_m + off_m;
            high -= height_m - off_m;
            low_slope -= last.slope + own_curvature * moved_m;
            high_slope -= last.slope - own_curvature * moved_m;
        }
    }

    // F at a later time, at least.
    double later(const Sphere& sphere, double dt) const {
        return sphere.f - everywhere_[sphere.groups].fastest * dt;
    }

  private:
    // Of the first groups, in all directions: Σ A k, Σ A ω.
    struct Everywhere {
        double steepness = 0.0, fastest = 0.0;
    };

    const TracedTrains& all_;
    std::vector<Everywhere> everywhere_;
    std::vector<Evaluated> last_;
    Buffer<float> values_;  // of whole()
    std::vector<std::array<double, 3>> order_;
    double z_m_ = 0.0, rise_ = 0.0;
};

// Where a look says that the hit is, to within_m; infinite: it doesn't.
template <Bounds kBounds>
HWY_INLINE double converged_m(const Look& seen, double curvature, double within_m) {
    if (!seen.is_whole) return kInfinity;
    const Sphere& at = seen.sphere;
    if (kBounds != Bounds::Curved)
        return seen.step_m <= within_m || seen.highest <= 0.25 * within_m ? at.s_m : kInfinity;
    if (at.f < 0.0) return at.s_m;  // by what rounding may do
    const double latest_m = latest_zero(seen.highest, seen.steepest, curvature);
    if (latest_m - seen.step_m <= 2.0 * within_m) return at.s_m + 0.5 * (seen.step_m + latest_m);
    if (at.f <= kGraze * within_m && seen.step_m <= within_m) return at.s_m;
    return kInfinity;
}

struct Ray {
    glm::dvec3 from_m, unit;  // where it enters the layer of waves
    double before_m, length_m, tolerance_m, tolerance_per_m;

    double within_m(double s_m) const { return tolerance_m + (before_m + s_m) * tolerance_per_m; }
};

template <Bounds kBounds>
double trace(Waves& waves, const Ray& ray, Ways ways, const std::vector<std::array<double, 4>>& neighbours,
             Spheres* seen_before) {
    double s_m = 0.0, clearance_m = 0.0;
    std::size_t next = 0;
    while (s_m < ray.length_m) {
        // A ball that the ray before has found: to where this one leaves it. They lie one after the other.
        for (; ways.image && next < neighbours.size(); ++next) {
            const auto& [x, y, z, radius_m] = neighbours[next];
            const glm::dvec3 to = glm::dvec3(x, y, z) - (ray.from_m + s_m * ray.unit);
            const double along_m = glm::dot(to, ray.unit),
                         square = radius_m * radius_m - (glm::dot(to, to) - along_m * along_m);
            if (square <= 0.0) continue;
            const double half_m = std::sqrt(square);
            if (along_m - half_m > 0.0) break;
            s_m += std::max(0.0, along_m + half_m);
        }
        const double within_m = ray.within_m(s_m);
        const double reuse_m = ways.spatial ? std::max(0.02 * clearance_m, 0.02 * within_m) : -1.0;
        const Look seen = waves.look<kBounds>(s_m, ray.length_m - s_m, reuse_m);
        if (seen_before) seen_before->push_back(seen.sphere);
        const double hit_m = converged_m<kBounds>(seen, waves.curvature(seen.sphere.groups), within_m);
        if (hit_m < kInfinity) return hit_m;
        clearance_m = std::max(seen.sphere.f, 0.0);
        s_m += seen.step_m;
    }
    return kInfinity;
}

// The paper's temporal coherence (§3.3) with its own bounds: the last frame's spheres, shrunk by what the sea may have moved. (The
// core's has bounds of second order in time as well.)
double trace_again(Waves& waves, const Ray& ray, double time_s, Spheres& kept) {
    static thread_local Spheres found;
    found.clear();
    double s_m = 0.0;
    std::size_t next = 0;
    while (s_m < ray.length_m) {
        for (; next < kept.size(); ++next) {
            const Sphere& old = kept[next];
            const double f = waves.later(old, time_s - old.time_s);
            if (!(f > 0.0)) continue;
            waves.need(old.groups);
            const double steepness = waves.steepness(old.groups);
            if (old.s_m - f / std::max(ray.unit.z + steepness, 1e-9) > s_m) break;
            const double to_m = old.s_m + f / (steepness - ray.unit.z);
            if (to_m <= s_m + 1e-3) continue;
            s_m = to_m;
            found.push_back(old);
        }
        Look seen = waves.look<Bounds::Efficient>(s_m, ray.length_m - s_m, -1.0);
        seen.sphere.time_s = time_s;
        found.push_back(seen.sphere);
        if (converged_m<Bounds::Efficient>(seen, 0.0, ray.within_m(s_m)) < kInfinity) {
            kept.swap(found);
            return s_m;
        }
        s_m += seen.step_m;
    }
    kept.swap(found);
    return kInfinity;
}

template <Bounds kBounds>
double trace_whole(Waves& waves, const Ray& ray, double brute_step_m) {
    const double steepness = waves.steepest_anywhere(),
                 longest = 1.0 / std::sqrt(1.0 + steepness * steepness);
    for (double s_m = 0.0; s_m < ray.length_m;) {
        if (kBounds == Bounds::Brute) {
            if (waves.whole(s_m) <= 0.0) return s_m;
            s_m += brute_step_m;
            continue;
        }
        double f, step_m;
        if (kBounds == Bounds::Sorted) {
            const Look seen = waves.sorted(s_m);
            f = seen.sphere.f;
            step_m = seen.step_m;
        } else {
            f = waves.whole(s_m);
            step_m = f * longest;
        }
        if (step_m <= ray.within_m(s_m) || f <= 0.25 * ray.within_m(s_m)) return s_m;
        s_m += step_m;
    }
    return kInfinity;
}

template <Bounds kBounds>
double find(Waves& waves, const Ray& ray, Ways ways, double time_s,
            std::vector<std::array<double, 4>>& neighbours, Spheres& kept) {
    if (ways.temporal) return trace_again(waves, ray, time_s, kept);
    if (!ways.image) return trace<kBounds>(waves, ray, ways, neighbours, nullptr);
    static thread_local Spheres seen;
    seen.clear();
    const double hit_m = trace<kBounds>(waves, ray, ways, neighbours, &seen);
    static thread_local std::vector<std::array<double, 4>> balls;
    balls.clear();
    for (const auto& ball :
         neighbours) {  // those that helped stay; the nearest to the surface are found anew
        const glm::dvec3 to = glm::dvec3(ball[0], ball[1], ball[2]) - ray.from_m;
        const double along_m = glm::dot(to, ray.unit);
        if (glm::dot(to, to) - along_m * along_m < 0.5 * ball[3] * ball[3]) balls.push_back(ball);
    }
    for (const Sphere& sphere : seen)
        if (sphere.radius_m > 0.0) {
            const glm::dvec3 p = ray.from_m + sphere.s_m * ray.unit;
            balls.push_back({p.x, p.y, p.z, sphere.radius_m});
        }
    std::sort(balls.begin(), balls.end(), [&](const auto& a, const auto& b) {
        return glm::dot(glm::dvec3(a[0], a[1], a[2]) - ray.from_m, ray.unit) <
               glm::dot(glm::dvec3(b[0], b[1], b[2]) - ray.from_m, ray.unit);
    });
    neighbours.swap(balls);
    return hit_m;
}

}  // namespace

std::size_t TraceBy(Ways ways, const TracedTrains& trains, const Picture& picture, std::vector<Spheres>& kept,
                    std::vector<double>& distance_m) {
    Waves waves(trains);
    std::vector<std::array<double, 4>> neighbours;
    const double crest_m = trains.rest_m.front();
    distance_m.resize(picture.direction.size());
    kept.resize(picture.direction.size());
    for (std::size_t i = 0; i < distance_m.size(); ++i) {
        const glm::dvec3 unit = glm::normalize(glm::dvec3(picture.direction[i]));
        const double enters_m = std::max(0.0, (crest_m - picture.origin_m.z) / unit.z);
        const Ray ray{picture.origin_m + enters_m * unit,
                      unit,
                      enters_m,
                      (-crest_m - picture.origin_m.z) / unit.z - enters_m,
                      picture.tolerance_m,
                      picture.tolerance_per_m};
        const bool is_whole = ways.bounds < Bounds::Efficient;
        waves.begin(ray.from_m, ray.unit, is_whole);
        if (i % picture.width == 0) neighbours.clear();
        double hit_m = kInfinity;
        switch (ways.bounds) {
            case Bounds::Brute:
                hit_m = trace_whole<Bounds::Brute>(waves, ray, picture.brute_step_m);
                break;
            case Bounds::Plain:
                hit_m = trace_whole<Bounds::Plain>(waves, ray, 0.0);
                break;
            case Bounds::Sorted:
                hit_m = trace_whole<Bounds::Sorted>(waves, ray, 0.0);
                break;
            case Bounds::Efficient:
                hit_m = find<Bounds::Efficient>(waves, ray, ways, trains.time_s, neighbours, kept[i]);
                break;
            case Bounds::Curved:
                hit_m = find<Bounds::Curved>(waves, ray, ways, trains.time_s, neighbours, kept[i]);
                break;
        }
        distance_m[i] = enters_m + hit_m;
    }
    return waves.evaluated();
}

}  // namespace pelagic::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelagic {
HWY_EXPORT(TraceBy);

namespace bench {
std::size_t trace_by(Ways ways, const TracedTrains& trains, const Picture& picture,
                     std::vector<Spheres>& kept, std::vector<double>& distance_m) {
    return HWY_DYNAMIC_DISPATCH(TraceBy)(ways, trains, picture, kept, distance_m);
}
}  // namespace bench
}  // namespace pelagic
#endif
