// The height of wave trains along a ray, in Highway's vectors of trains.
//
// Included once per instruction set by files that use Highway's foreach_target (its own pattern of guards).
#if defined(PELAGIC_CORE_EVALUATE_SPHERE_TRACING_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef PELAGIC_CORE_EVALUATE_SPHERE_TRACING_INL_H_
#undef PELAGIC_CORE_EVALUATE_SPHERE_TRACING_INL_H_
#else
#define PELAGIC_CORE_EVALUATE_SPHERE_TRACING_INL_H_
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <glm/vec3.hpp>
#include <limits>

#include "core/base/buffer.h"
#include "core/base/constants.h"
#include "core/base/sincos-inl.h"
#include "core/evaluate/sphere_tracing.h"

HWY_BEFORE_NAMESPACE();
namespace pelagic {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// A bound from below of what follows along the ray: f + g r − ½ M r², until its slope has fallen to `steepest`, and straight from
// there.
struct Bound {
    double f, g, curvature, steepest;

    // The first r > 0 where it is 0, for f ≥ 0; infinite where there is none.
    HWY_INLINE double zero() const {
        if (steepest >= 0.0) return std::numeric_limits<double>::infinity();
        const double root = std::sqrt(g * g + 2.0 * curvature * f);
        if (root <= -steepest) {  // −root is the slope there
            if (g < 0.0) return 2.0 * f / (root - g);
            return curvature > 0.0 ? (root + g) / curvature : std::numeric_limits<double>::infinity();
        }
        const double bent = curvature > 0.0 ? std::max(0.0, (g - steepest) / curvature) : 0.0;
        return bent + (f + 0.5 * bent * (g + steepest)) / -steepest;
    }
};
// The first r with f + g r + ½ M r² = 0: where a surface that curves away from the ray at most so much is met at the latest.
HWY_INLINE double latest_zero(double f, double g, double curvature) {
    const double square = g * g - 2.0 * curvature * f;
    return g < 0.0 && square >= 0.0 ? 2.0 * f / (std::sqrt(square) - g)
                                    : std::numeric_limits<double>::infinity();
}

// The trains along one ray after the other, prepared group by group when a step first needs them. Phases are formed in double,
// so that a ray may be long and far away. kRates: with what time changes.
template <bool kRates>
class TrainsAlongRay {
  protected:
    static constexpr std::size_t kGroup = TracedTrains::kGroup;
    using D = hn::CappedTag<float, kGroup>;
    using Half = hn::Half<D>;
    using Wide = hn::Rebind<double, Half>;

  public:
    // Height of the sea [m], its slope along the ray, and its change in time [m/s].
    struct Sum {
        double height_m = 0.0, slope = 0.0, rate_mps = 0.0;
    };

    explicit TrainsAlongRay(const TracedTrains& trains)
        : trains_(trains),
          cycles_(trains.groups * kGroup),
          along_(trains.groups * kGroup),
          steepness_(trains.groups * kGroup),
          curvature_(trains.groups + 1),
          steepest_(trains.groups + 1),
          mixed_(trains.groups + 1) {}

    HWY_INLINE void begin(glm::dvec3 from_m, glm::dvec3 unit) {
        from_m_ = from_m;
        unit_ = unit;
        ready_ = 0;
    }
    // Adds the trains of a group, at s [m] from where the ray begins. Groups come one after the other.
    HWY_INLINE void add(std::size_t group, double s_m, Sum& sum) {
        need(group + 1);
        const D d;
        const auto s = hn::Set(Wide(), s_m);
        auto height = hn::Zero(d), slope = hn::Zero(d), rate = hn::Zero(d);
        for (std::size_t i = group * kGroup; i < (group + 1) * kGroup; i += hn::Lanes(d)) {
            hn::Vec<D> sine, cosine;
            SinCosCycles(d, phases(d, i, s), sine, cosine);
            const auto amplitude = hn::Load(d, &trains_.amplitude_m[i]);
            height = hn::MulAdd(amplitude, cosine, height);
            slope = hn::NegMulAdd(hn::Load(d, &steepness_[i]), sine, slope);
            if (kRates) rate = hn::NegMulAdd(hn::Mul(amplitude, hn::Load(d, &trains_.omega[i])), sine, rate);
        }
        sum.height_m += static_cast<double>(hn::GetLane(hn::SumOfLanes(d, height)));
        sum.slope += static_cast<double>(hn::GetLane(hn::SumOfLanes(d, slope)));
        if (kRates) sum.rate_mps += static_cast<double>(hn::GetLane(hn::SumOfLanes(d, rate)));
        evaluated_ += std::min(kGroup, trains_.count - group * kGroup);
    }
    // Makes the sums below known for that many groups.
    HWY_INLINE void need(std::size_t groups) {
        while (ready_ < groups) prepare(ready_++);
    }
    // Σ A (k·d)² [1/m], Σ A |k·d| and Σ A |k·d| ω [1/s] of the first groups.
    HWY_INLINE double curvature(std::size_t groups) const { return curvature_[groups]; }
    HWY_INLINE double steepness(std::size_t groups) const { return steepest_[groups]; }
    HWY_INLINE double mixed(std::size_t groups) const { return mixed_[groups]; }
    std::size_t evaluated() const { return evaluated_; }

  protected:  // the bench has the paper's other ways
    HWY_INLINE void prepare(std::size_t group) {
        const Wide w;
        const Half h;
        const auto dx = hn::Set(w, unit_.x), dy = hn::Set(w, unit_.y), x = hn::Set(w, from_m_.x),
                   y = hn::Set(w, from_m_.y);
        auto curvature = hn::Zero(h), steepest = hn::Zero(h), mixed = hn::Zero(h);
        for (std::size_t i = group * kGroup; i < (group + 1) * kGroup; i += hn::Lanes(w)) {
            const auto kx = hn::Load(w, &trains_.kx_cycles_per_m[i]),
                       ky = hn::Load(w, &trains_.ky_cycles_per_m[i]);
            const auto cycles =
                hn::NegMulAdd(ky, y, hn::NegMulAdd(kx, x, hn::Load(w, &trains_.start_cycles[i])));
            const auto along = hn::Neg(hn::MulAdd(kx, dx, hn::Mul(ky, dy)));
            hn::Store(hn::Sub(cycles, hn::Round(cycles)), w, &cycles_[i]);
            hn::Store(along, w, &along_[i]);
            const auto k = hn::Mul(hn::DemoteTo(h, along), hn::Set(h, static_cast<float>(kTwoPi)));
            const auto steepness = hn::Mul(hn::Load(h, &trains_.amplitude_m[i]), k);
            hn::Store(steepness, h, &steepness_[i]);
            curvature = hn::MulAdd(steepness, k, curvature);
            steepest = hn::Add(steepest, hn::Abs(steepness));
            if (kRates) mixed = hn::MulAdd(hn::Abs(steepness), hn::Load(h, &trains_.omega[i]), mixed);
        }
        const auto total = [&](hn::Vec<Half> v) {
            constexpr double kRoundedUp = 1.0 + 1e-5;
            return kRoundedUp * static_cast<double>(hn::GetLane(hn::SumOfLanes(h, v)));
        };
        curvature_[group + 1] = curvature_[group] + total(curvature);
        steepest_[group + 1] = steepest_[group] + total(steepest);
        if (kRates) mixed_[group + 1] = mixed_[group] + total(mixed);
    }
    HWY_INLINE hn::Vec<Half> half_phases(std::size_t i, hn::Vec<Wide> s) const {
        const auto cycles = hn::MulAdd(hn::Load(Wide(), &along_[i]), s, hn::Load(Wide(), &cycles_[i]));
        return hn::DemoteTo(Half(), hn::Sub(cycles, hn::Round(cycles)));
    }
    HWY_INLINE hn::Vec<D> phases(D d, std::size_t i, hn::Vec<Wide> s) const {
#if HWY_TARGET == HWY_SCALAR
        (void)d;
        return half_phases(i, s);  // a vector of one train has no upper half
#else
        return hn::Combine(d, half_phases(i + hn::Lanes(Half()), s), half_phases(i, s));
#endif
    }

    const TracedTrains& trains_;
    glm::dvec3 from_m_{}, unit_{};
    std::size_t ready_ = 0, evaluated_ = 0;
    Buffer<double> cycles_, along_;  // at the ray's beginning; by which they rise in a metre
    Buffer<float> steepness_;        // A k·d, with along_'s sign
    Buffer<double> curvature_, steepest_, mixed_;
};

}  // namespace HWY_NAMESPACE
}  // namespace pelagic
HWY_AFTER_NAMESPACE();

#endif
