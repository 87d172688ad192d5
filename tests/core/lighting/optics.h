// The shared shading source, callable by function under any sky, and the same physics in double precision,
// written independently from the formulas.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/glm.hpp>
#include <random>
#include <span>

#include "core/lighting/foam_structure.h"

namespace pelagic::optics {

using namespace glm;

using Lookup = std::function<vec3(vec2, float)>;

inline vec3 uniform_sky(vec2, float) {
    return vec3(1.0f);
}

struct Optics {
    Lookup lookup = uniform_sky;
    int kSkyLookups = 9;
    bool kExactFresnel = true, kSecondReflection = true, kMeshMasking = true;
    float kSkyMapSize = 256.0f;
    bool kSun = true, kSky = true, kWater = true, kWhitecaps = true;

    const FoamImage* foam_image = nullptr;
    std::span<const float> floor_values{};

    float floor_value(int i) const { return floor_values[static_cast<std::size_t>(i)]; }

    vec3 sky_lookup(vec2 u, float level) const { return lookup(u, level); }
    float foam_image_texel(int x, int y) const {
        return foam_image->texels[static_cast<std::size_t>(y * foam_image->side + x)];
    }

// clang-format off
#include "core/lighting/special.glsl"
#include "core/lighting/fresnel.glsl"
#include "core/lighting/slopes.glsl"
#include "core/lighting/sun.glsl"
#include "core/lighting/sky.glsl"
#include "core/lighting/floor.glsl"
#include "core/base/bubbles.inl"
#include "core/lighting/water.glsl"
#include "core/lighting/foam.glsl"
#include "core/lighting/foam_structure.glsl"
#include "core/lighting/sea.glsl"
#include "core/lighting/below.glsl"
    // clang-format on
};

inline Optics::FoamPattern glsl(const FoamPattern& p) {
    return {p.cell, p.rest, p.axes, p.look, p.white, p.image};
}

// Water without a body.
inline Optics::WaterLook plain_water(vec3 reflectance) {
    return {reflectance, false, {}, {}, {}, {}, 1e9f, vec3(0.0f), 0.0f, 0.0f, 0.0f, 0.0f};
}

// A sea that reflects everything: the white furnace.
struct Furnace {
    Lookup lookup = uniform_sky;
    int kSkyLookups = 0;
    bool kExactFresnel = true, kSecondReflection = true, kMeshMasking = true;
    float kSkyMapSize = 256.0f;

    vec3 sky_lookup(vec2 u, float level) const { return lookup(u, level); }
    float fresnel_exact(float, float) { return 1.0f; }
    float fresnel_schlick(float) { return 1.0f; }
    float fresnel_effective_exact(float, float, float) { return 1.0f; }
    float fresnel_effective_paper(float, float) { return 1.0f; }

// clang-format off
#include "core/lighting/special.glsl"
#include "core/lighting/slopes.glsl"
#include "core/lighting/sky.glsl"
    // clang-format on
};

namespace oracle {

constexpr double kPi = 3.14159265358979323846;
constexpr double kIndex = 1.34;

// From Snell's law and the amplitude ratios, not from Hu's g.
inline double fresnel(double cosine, double index = kIndex) {
    const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine)) / index;
    if (sine >= 1.0) return 1.0;
    const double inside = std::sqrt(1.0 - sine * sine);
    const double across = (cosine - index * inside) / (cosine + index * inside);
    const double along = (index * cosine - inside) / (index * cosine + inside);
    return 0.5 * (across * across + along * along);
}

inline double schlick(double cosine) {
    return 0.02 + 0.98 * std::pow(1.0 - cosine, 5.0);
}

// The Cholesky factor of a slope covariance: ζ = (a x, b x + c y) for independent normal x, y.
struct Factor {
    double a, b, c;
    explicit Factor(dvec3 s) : a(std::sqrt(s.x)), b(s.z / a), c(std::sqrt(std::max(s.y - b * b, 0.0))) {}
    double distance(dvec2 slope) const {
        const double x = slope.x / a, y = (slope.y - b * x) / c;
        return x * x + y * y;
    }
    double root_of_determinant() const { return a * c; }
};

inline double towards(dvec3 d, dvec3 s) {
    return s.x * d.x * d.x + s.y * d.y * d.y + 2.0 * s.z * d.x * d.y;
}

inline double lambda(dvec3 d, dvec3 s) {
    if (d.z <= 0.0) return 1e300;
    const double a = d.z / std::sqrt(2.0 * towards(d, s));
    if (a > 25.0) return 0.0;
    const double root = std::sqrt(kPi);
    return (std::exp(-a * a) - a * root * std::erfc(a)) / (2.0 * a * root);
}

constexpr double kNested = 0.75;

// The chance that a facet with w = d·f/f_z is open to d: a Brownian bridge from w to d_z that doesn't cross 0.
inline double bridge(double w, dvec3 d, dvec3 s) {
    return d.z > 0.0 && w > 0.0 ? -std::expm1(-2.0 * w * d.z / towards(d, s)) : 0.0;
}

// The visible part of a facet with w = v·f/f_z, per its projected area and that of the plane; and what of it the
// light reaches, with l·f/f_z = lit.
inline double visible(double w, dvec3 v, dvec3 s) {
    return ((1.0 - kNested) / (1.0 + lambda(v, s)) + kNested * bridge(w, v, s)) / v.z;
}
inline double lit(double w, double lit, dvec3 v, dvec3 l, dvec3 s) {
    if (l.z <= 0.0) return 0.0;
    return ((1.0 - kNested) / (1.0 + lambda(v, s) + lambda(l, s)) +
            kNested * bridge(w, v, s) * bridge(lit, l, s)) /
           v.z;
}

// ∬ of the density of visible slopes times f(slope, facet), by a fine midpoint rule over ±6 σ.
template <class Function>
auto over_visible(dvec3 v, dvec3 s, int steps, Function&& f) {
    using Value = decltype(f(dvec2(), dvec3()));
    const Factor factor(s);
    const dvec3 eye(v.x, v.y, std::max(v.z, 1e-9));
    const double smith = (1.0 - kNested) / (1.0 + lambda(eye, s));
    Value sum(0.0);
    double total = 0.0;
    for (int i = 0; i < steps; ++i)
        for (int j = 0; j < steps; ++j) {
            const double x = -6.0 + 12.0 * (i + 0.5) / steps, y = -6.0 + 12.0 * (j + 0.5) / steps;
            const dvec2 slope(factor.a * x, factor.b * x + factor.c * y);
            const double cosine = v.z - v.x * slope.x - v.y * slope.y;
            if (cosine <= 0.0) continue;
            const double weight = std::exp(-0.5 * (x * x + y * y)) * cosine *
                                  (smith + kNested * bridge(cosine, eye, s)) / eye.z;
            sum += weight * f(slope, normalize(dvec3(-slope.x, -slope.y, 1.0)));
            total += weight;
        }
    return sum / total;
}

// Eq. 20 with the exact Fresnel term. What facets mirror onto the sea shows the same integral of the sea seen
// along its plane, there without any that is mirrored a third time.
template <class Radiance>
double sky(dvec3 v, dvec3 s, int steps, Radiance&& radiance) {
    const dvec3 level = normalize(dvec3(v.x, v.y, 0.0) + dvec3(v.z > 0.999999 ? 1.0 : 0.0, 0.0, 0.0));
    const double again = over_visible(level, s, steps, [&](dvec2, dvec3 f) {
        const double cosine = dot(level, f);
        const dvec3 r = 2.0 * cosine * f - level;
        return fresnel(cosine) * radiance(dvec3(r.x, r.y, std::abs(r.z)));
    });
    return over_visible(v, s, steps, [&](dvec2, dvec3 f) {
        const double cosine = dot(v, f), w = cosine / f.z;
        const dvec3 r = 2.0 * cosine * f - v;
        const double open = std::min(lit(w, w, v, r, s) / visible(w, v, s), 1.0);
        return fresnel(cosine) * (open > 0.0 ? open * radiance(r) + (1.0 - open) * again : again);
    });
}

}  // namespace oracle

// Seeded random inputs: every other direction is grazing; slopes range from a mirror's to a storm's.
class Inputs {
  public:
    explicit Inputs(unsigned seed) : random_(seed) {}

    double uniform(double low, double high) {
        return low + (high - low) * std::uniform_real_distribution<double>(0.0, 1.0)(random_);
    }
    double logarithmic(double low, double high) { return std::exp(uniform(std::log(low), std::log(high))); }
    // In the upper hemisphere, with z ≥ `lowest`.
    vec3 direction(double lowest) {
        const double z = uniform(0.0, 1.0) < 0.5 ? logarithmic(lowest, 1.0) : uniform(lowest, 1.0);
        const double azimuth = uniform(0.0, 2.0 * oracle::kPi), sine = std::sqrt(1.0 - z * z);
        return vec3(dvec3(sine * std::cos(azimuth), sine * std::sin(azimuth), z));
    }
    // σ in `least` … `most` on either axis, |correlation| up to `correlation`.
    vec3 variance(double least, double most, double correlation) {
        const double x = logarithmic(least, most), y = logarithmic(least, most);
        return vec3(dvec3(x * x, y * y, uniform(-correlation, correlation) * x * y));
    }

  private:
    std::mt19937_64 random_;
};

}  // namespace pelagic::optics
