#include "core/lighting/columns.h"

#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>

namespace pelagic {
namespace {

// Scale heights of the exponential densities. Ozone has a triangular profile.
constexpr double kAirScale_km = 8.0;
constexpr double kOzoneMiddle_km = 25.0, kOzoneHalfWidth_km = 15.0;

constexpr std::size_t kHeights = 64, kDistances = 128;
constexpr int kSteps = 48;

// Ångström's exponent of the haze over a sea with some land around (purely marine: 0.5; continental: 1.3).
constexpr double kHazeReference_um = 0.55, kHazeExponent = 1.0;

// Optical thickness of the whole air column at 1013 hPa: Hansen & Travis 1974.
double air_thickness(double um) {
    const double per = 1.0 / (um * um);
    return 0.008569 * per * per * (1.0 + 0.0113 * per + 0.00013 * per * per);
}

constexpr double kOzoneColumn_per_m2 = 300.0 * 2.687e20;  // 300 Dobson units

// Optical thickness of the ozone: its Chappuis band as a Gaussian, with a peak of 5.0e-25 m² at 0.595 μm.
double ozone_thickness(double um) {
    const double x = (um - 0.595) / 0.054;
    return kOzoneColumn_per_m2 * 5.0e-25 * std::exp(-0.5 * x * x);
}

}  // namespace

Thickness vertical_thickness(double turbidity) {
    const double haze = (turbidity - 1.0) * air_thickness(kHazeReference_um);
    Thickness thickness;
    for (std::size_t b = 0; b < kBands; ++b) {
        const double um = band_um(static_cast<int>(b));
        thickness.air[b] = air_thickness(um);
        thickness.haze[b] = haze * std::pow(um / kHazeReference_um, -kHazeExponent);
        thickness.ozone[b] = ozone_thickness(um);
    }
    return thickness;
}

void exp_of_minus(std::span<double> values) {
    namespace hn = hwy::HWY_NAMESPACE;  // of the instructions that all processors have
    const hn::ScalableTag<double> d;
    std::size_t i = 0;
    for (; i + hn::Lanes(d) <= values.size(); i += hn::Lanes(d))
        hn::StoreU(hn::Exp(d, hn::Neg(hn::LoadU(d, &values[i]))), d, &values[i]);
    for (; i < values.size(); ++i) values[i] = hn::GetLane(hn::Exp(d, hn::Set(d, -values[i])));
}

Matter density(double height_km) {
    std::array<double, 2> thinned{height_km / kAirScale_km, height_km / kHazeScale_km};
    exp_of_minus(thinned);
    const double off = std::abs(height_km - kOzoneMiddle_km) / kOzoneHalfWidth_km;
    return {thinned[0] / kAirScale_km, thinned[1] / kHazeScale_km,
            std::max(0.0, 1.0 - off) / kOzoneHalfWidth_km};
}

double to_top(double radius, double cosine) {
    constexpr double top = kEarth_km + kTop_km;
    return -radius * cosine + std::sqrt(std::max(0.0, top * top - radius * radius * (1.0 - cosine * cosine)));
}

double horizon_distance(double radius) {
    return std::sqrt(std::max(0.0, radius * radius - kEarth_km * kEarth_km));
}

std::array<double, 4> cubic_weights(double t) {
    return {t * (t * (1.0 - 0.5 * t) - 0.5), t * t * (1.5 * t - 2.5) + 1.0, t * (t * (2.0 - 1.5 * t) + 0.5),
            t * t * (0.5 * t - 0.5)};
}

Cubic::Cubic(double x, std::size_t size) {
    const std::size_t i = std::min(static_cast<std::size_t>(x), size - 2);
    const double t = x - static_cast<double>(i);
    nodes = {i > 0 ? i - 1 : 0, i, i + 1, std::min(i + 2, size - 1)};
    weights = cubic_weights(t);
}

Columns::Columns() : table_(kHeights * kDistances) {
    const double longest = horizon_distance(kEarth_km + kTop_km);  // from the ground to the top
    for (std::size_t i = 0; i < kHeights; ++i) {
        const double horizon = longest * static_cast<double>(i) / (kHeights - 1);
        const double radius = std::hypot(horizon, kEarth_km);
        for (std::size_t j = 0; j < kDistances; ++j) {
            const double least = kEarth_km + kTop_km - radius, most = horizon + longest;
            const double d = least + (most - least) * static_cast<double>(j) / (kDistances - 1);
            table_[i * kDistances + j] = integrated(radius, d);
        }
    }
}

Matter Columns::operator()(double radius, double cosine) const {
    const double longest = horizon_distance(kEarth_km + kTop_km);  // from the ground to the top
    const double horizon = horizon_distance(radius);
    const double least = kEarth_km + kTop_km - radius, most = horizon + longest;
    const double skimming = -horizon / radius;
    const double d = to_top(radius, std::max(cosine, skimming));
    const double x = std::clamp(horizon / longest, 0.0, 1.0) * (kHeights - 1);
    const double y =
        most > least ? std::clamp((d - least) / (most - least), 0.0, 1.0) * (kDistances - 1) : 0.0;
    const Cubic up(x, kHeights), along(y, kDistances);
    Matter column;
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < 4; ++j) {
            const double weight = up.weights[i] * along.weights[j];
            const Matter& at = table_[up.nodes[i] * kDistances + along.nodes[j]];
            column.air += weight * at.air;
            column.haze += weight * at.haze;
            column.ozone += weight * at.ozone;
        }
    return column;
}

Matter Columns::integrated(double radius, double d) {
    constexpr double top = kEarth_km + kTop_km;
    const double cosine =
        d > 0.0 ? std::clamp((top * top - radius * radius - d * d) / (2.0 * radius * d), -1.0, 1.0) : 1.0;
    // Steps are shortest near the lowest point, where the density changes most.
    const double lowest = std::clamp(-radius * cosine, 0.0, d);
    Matter column;
    for (const double length : {-lowest, d - lowest}) {
        if (length == 0.0) continue;  // a ray that rises has one side of its lowest point
        for (int i = 0; i < kSteps; ++i) {
            const double a = static_cast<double>(i) / kSteps, b = (i + 1.0) / kSteps;
            const double t = lowest + length * 0.5 * (a * a + b * b);
            const double dt = std::abs(length) * (b * b - a * a);
            const double height = std::sqrt(radius * radius + t * t + 2.0 * radius * t * cosine) - kEarth_km;
            const Matter at = density(std::max(height, 0.0));
            column.air += at.air * dt;
            column.haze += at.haze * dt;
            column.ozone += at.ozone * dt;
        }
    }
    return column;
}

}  // namespace pelagic
