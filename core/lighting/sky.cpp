// Daylight: light scattered in the atmosphere (model: atmosphere.h, reasons: atmosphere.cpp), computed for a
// few directions and interpolated into the map.
//
// Scattered light without its phase functions varies slowly with direction, fastest near the horizon. It is
// tabulated over half of the upper hemisphere, which is symmetric about the sun's azimuth. Each sample of the
// map then applies the phase functions, which bring back the aureole.
#include "core/lighting/sky.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/base/constants.h"
#include "core/lighting/air.h"
#include "core/lighting/atmosphere.h"
#include "core/lighting/colour.h"
#include "core/lighting/columns.h"
#include "core/lighting/daylight_disc.h"
#include "core/lighting/sky_bake.h"
#include "core/lighting/sunlight.h"

namespace pelagic {
namespace {

constexpr double kDegree = kPi / 180.0;

void check(const char* name, double value, glm::dvec2 range) {
    if (value >= range.x && value <= range.y) return;
    throw std::invalid_argument(std::string(name) + " is " + std::to_string(value) + ": from " +
                                std::to_string(range.x) + " to " + std::to_string(range.y) + " is accepted");
}

// [rad]
double elevation_of(const Daylight& daylight) {
    return daylight.sun_elevation_deg * kDegree;
}
double azimuth_of(const Daylight& daylight) {
    return std::remainder(daylight.sun_azimuth_deg, 360.0) * kDegree;
}
glm::dvec2 heading_of(const Daylight& daylight) {
    const double azimuth = azimuth_of(daylight);
    return {std::cos(azimuth), std::sin(azimuth)};
}

class ScatteredTable {
  public:
    explicit ScatteredTable(const Atmosphere& air) : entries_((kElevations + 1) * (kAzimuths + 1)) {
        // Light is even in the azimuth and smooth but for the earth's shadow, in which what was scattered before hides single
        // scattering: a sum of cosines, through the middles of equal parts.
        constexpr int kParts = 12;
        std::array<double, kParts> azimuths{};
        for (int k = 0; k < kParts; ++k) azimuths[k] = kPi * (k + 0.5) / kParts;
        std::array<std::array<double, kParts>, kAzimuths + 1> shares{};
        for (int j = 0; j <= kAzimuths; ++j)
            for (int k = 0; k < kParts; ++k) {
                double sum = 1.0;
                for (int m = 1; m < kParts; ++m)
                    sum += 2.0 * std::cos(m * kPi * j / kAzimuths) * std::cos(m * azimuths[k]);
                shares[j][k] = sum / kParts;
            }
        tbb::parallel_for(0, kElevations + 1, [&](int i) {
            const double x = static_cast<double>(i) / kElevations;
            std::vector<Entry> row;
            for (const Atmosphere::Scattered& light : air.scattered(0.5 * kPi * x * x, azimuths))
                row.push_back({colour_of(light.by_air), colour_of(light.by_haze), colour_of(light.more)});
            for (int j = 0; j <= kAzimuths; ++j)
                for (int k = 0; k < kParts; ++k)
                    entries_[static_cast<std::size_t>(i * (kAzimuths + 1) + j)].add(shares[j][k], row[k]);
        });
    }

    // Radiance. Angles as for Atmosphere::scattered(); `cosine` is of the angle with the sun.
    glm::dvec3 radiance(double elevation, double azimuth, double cosine) const {
        const double x = std::sqrt(std::clamp(elevation / (0.5 * kPi), 0.0, 1.0)) * kElevations;
        const double y = std::clamp(std::abs(azimuth) / kPi, 0.0, 1.0) * kAzimuths;
        const int i = std::min(static_cast<int>(x), kElevations - 1),
                  j = std::min(static_cast<int>(y), kAzimuths - 1);
        const std::array<double, 4> up = cubic_weights(x - i), across = cubic_weights(y - j);
        Entry mixed;
        for (std::size_t b = 0; b < 4; ++b)
            for (std::size_t a = 0; a < 4; ++a)
                mixed.add(up[b] * across[a], at(i + static_cast<int>(b) - 1, j + static_cast<int>(a) - 1));
        return into_gamut(mixed.by_air * air_phase(cosine) + mixed.by_haze * haze_phase(cosine) + mixed.more);
    }

  private:
    // Elevations grow with the square of the index: steps of 0.04° at the horizon and 4° at the zenith.
    static constexpr int kElevations = 48, kAzimuths = 24;
    struct Entry {
        glm::dvec3 by_air{0.0}, by_haze{0.0}, more{0.0};
        void add(double weight, const Entry& other) {
            by_air += weight * other.by_air;
            by_haze += weight * other.by_haze;
            more += weight * other.more;
        }
    };

    // Past an end the table is continued: mirrored at the sun's meridian, and at the horizon, where it is smooth in
    // the elevation, the square of the index.
    const Entry& at(int i, int j) const {
        i = std::min(std::abs(i), kElevations);
        j = j > kAzimuths ? 2 * kAzimuths - j : std::abs(j);
        return entries_[static_cast<std::size_t>(i * (kAzimuths + 1) + j)];
    }

    std::vector<Entry> entries_;
};

}  // namespace

Sky daylight_sun(const Daylight& daylight) {
    check("sun_elevation_deg", daylight.sun_elevation_deg, {-90.0, 90.0});
    check("sun_azimuth_deg", daylight.sun_azimuth_deg, {-1e6, 1e6});
    check("turbidity", daylight.turbidity, {1.7, 10.0});
    const double elevation = elevation_of(daylight);
    const glm::dvec2 heading = heading_of(daylight);
    Sky sky;
    const double radius = static_cast<double>(sky.sun_angular_radius);
    const Disc disc = disc_at(daylight.turbidity, elevation, radius);
    sky.sun_direction = glm::dvec3(heading * std::cos(disc.elevation_rad), std::sin(disc.elevation_rad));
    sky.sun_radiance = disc.radiance;
    sky.sun_irradiance =
        disc.radiance * (kPi * radius * radius * std::max(0.0, std::sin(disc.elevation_rad)));
    sky.sun_lower = static_cast<float>(disc.elevation_rad - elevation);
    const auto over_mean = [&](glm::dvec3 at) {
        glm::vec3 ratio(1.0f);
        for (int c = 0; c < 3; ++c)
            if (disc.radiance[c] > 0.0) ratio[c] = static_cast<float>(at[c] / disc.radiance[c]);
        return ratio;
    };
    sky.limb_low = over_mean(disc.low);
    sky.limb_middle = over_mean(disc.middle);
    sky.limb_high = over_mean(disc.high);
    return sky;
}

Sky daylight_sky(const Daylight& daylight, int map_size) {
    Sky sky = daylight_sun(daylight);
    SkyMap::check_size(map_size);
    const double elevation = elevation_of(daylight);
    const glm::dvec2 heading = heading_of(daylight);
    const auto atmosphere = std::make_shared<const Atmosphere>(daylight.turbidity, elevation);
    const ScatteredTable table(*atmosphere);
    sky.air = daylight_air(atmosphere, azimuth_of(daylight));
    const glm::dvec3 sun(heading * std::cos(elevation), std::sin(elevation));
    const BakedSky baked = bake_smooth_sky_map(map_size, [&](glm::vec3 direction) {
        const glm::dvec3 to(direction);
        const double along = glm::dot(heading, glm::dvec2(to)), across = heading.x * to.y - heading.y * to.x;
        const double side = along == 0.0 && across == 0.0 ? 0.0 : std::atan2(across, along);
        return glm::vec3(table.radiance(std::asin(std::clamp(to.z, 0.0, 1.0)), side,
                                        std::clamp(glm::dot(to, sun), -1.0, 1.0)));
    });
    sky.map = baked.map;
    sky.sky_irradiance = baked.irradiance;
    return sky;
}

}  // namespace pelagic
