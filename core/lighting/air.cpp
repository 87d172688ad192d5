#include "core/lighting/air.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/glm.hpp>
#include <limits>
#include <mutex>
#include <stdexcept>
#include <utility>

#include "core/base/constants.h"
#include "core/lighting/colour.h"
#include "core/lighting/daylight_disc.h"
#include "core/lighting/sunlight.h"

namespace pelagic {
namespace {

namespace air_shading {
using namespace glm;

struct Shading {
    static constexpr int kAirColumns = Air::kColumns, kAirRows = Air::kRows, kAirSkyRows = Air::kSkyRows,
                         kAirHorizonRow = Air::kHorizonRow;
    const glm::vec4* texels;

    glm::vec4 air_texel(int column, int row) const {
        return texels[static_cast<std::size_t>(row) * Air::kLayers * Air::kColumns +
                      static_cast<std::size_t>(column)];
    }

#include "core/lighting/air.glsl"
};

}  // namespace air_shading

constexpr double kLeastHeight_m = 0.1;
// Thicker air lets nothing through that single precision could add to its own light.
constexpr double kLeastTransmittance = 1e-9;

// The rays from an eye at one height to each row's distance.
class Rows {
  public:
    explicit Rows(double height_m) : height_m_(std::max(height_m, kLeastHeight_m)) {
        horizon_m_ = std::sqrt(height_m_ * (2.0 * kEarthRadius_m + height_m_));
        constexpr double top_m = kEarthRadius_m + 1e3 * kAirTop_km;
        farthest_m_ = horizon_m_ + std::sqrt(top_m * top_m - kEarthRadius_m * kEarthRadius_m);
    }

    double height_m() const { return height_m_; }
    double distance_m(int row) const {
        const auto part = [](double first, double last, double x) { return first + (last - first) * x * x; };
        if (row <= Air::kHorizonRow)
            return part(height_m_, horizon_m_, static_cast<double>(row) / Air::kHorizonRow);
        return part(horizon_m_, farthest_m_,
                    static_cast<double>(row - Air::kHorizonRow) / (Air::kRows - 1 - Air::kHorizonRow));
    }
    SightLine line(int row) const {
        const double reached_m = std::min(distance_m(row), horizon_m_);
        const double sine = -(horizon_m_ * horizon_m_ + reached_m * reached_m) /
                            (2.0 * reached_m * (kEarthRadius_m + height_m_));
        return {.height_km = 1e-3 * height_m_,
                .elevation_rad = std::asin(std::max(sine, -1.0)),
                .length_km = 1e-3 * distance_m(row)};
    }
    // The dip of the horizon, by its arc from the nadir: never 0, since the eye counts as at least kLeastHeight_m
    // high.
    double dip_rad() const { return std::atan(horizon_m_ / kEarthRadius_m); }
    // Of the sky, above the horizon.
    SightLine sky_line(int row) const {
        const double x = static_cast<double>(row) / (Air::kSkyRows - 1);
        const double grazing = 1e-7;  // [rad] beside the ground
        return {.height_km = 1e-3 * height_m_,
                .elevation_rad = sky_span_rad() * x * x * x - dip_rad() + (row == 0 ? grazing : 0.0)};
    }
    double sky_span_rad() const {
        constexpr double top_m = kEarthRadius_m + 1e3 * kAirTop_km;
        const double eye_m = kEarthRadius_m + height_m_;
        return eye_m > top_m ? dip_rad() - std::acos(top_m / eye_m) : 0.5 * kPi + dip_rad();
    }
    void set(Air& air) const {
        air.sky_span = static_cast<float>(sky_span_rad());
        air.nearest_m = static_cast<float>(height_m_);
        air.horizon_m = static_cast<float>(horizon_m_);
        air.farthest_m = static_cast<float>(farthest_m_);
        air.dip = static_cast<float>(dip_rad());
        air.texels.resize(std::size_t{Air::kWidth} * Air::kHeight);
    }

  private:
    double height_m_, horizon_m_, farthest_m_;
};

glm::vec4& texel(Air& air, int layer, int column, int row) {
    return air.texels[(static_cast<std::size_t>(row) * Air::kLayers + static_cast<std::size_t>(layer)) *
                          Air::kColumns +
                      static_cast<std::size_t>(column)];
}

class DaylightAir final : public AirModel {
  public:
    DaylightAir(std::shared_ptr<const Atmosphere> atmosphere, double azimuth_rad)
        : low_(std::move(atmosphere)), azimuth_(std::cos(azimuth_rad), std::sin(azimuth_rad)) {
        const double elevation = low_->sun_elevation_rad();
        to_sun_ = glm::dvec3(azimuth_ * std::cos(elevation), std::sin(elevation));
        BandValues all;
        all.fill(1.0);
        white_ = colour_of(all);
    }

    Air seen_from(double height_m) const override {
        const Rows rows(height_m);
        const Atmosphere& atmosphere = before(1e-3 * rows.height_m());
        Air air;
        rows.set(air);
        air.azimuth = azimuth_;
        air.to_sun = to_sun_;
        std::vector<double> azimuths;  // the other half of the circle is the same
        for (int column = 0; column <= Air::kColumns / 2; ++column)
            azimuths.push_back(kTwoPi * column / Air::kColumns);
        air.has_sky = has_sky();
        air.by_place = by_place(rows.height_m());
        if (air.by_place > 0.0f)
            std::ranges::copy(places(), air.texels.end() - Air::kPlaceRows * Air::kWidth);
        tbb::parallel_for(0, Air::kRows + Air::kSkyRows, [&](int row) {
            const bool is_sky = row >= Air::kRows;
            const SightLine line = is_sky ? rows.sky_line(row - Air::kRows) : rows.line(row);
            glm::dvec3 extinction(0.0), share(1.0);
            if (!is_sky) {
                // Of light with the sun's spectrum.
                const glm::dvec3 left = glm::clamp(colour_of(atmosphere.transmittance(line)) / white_,
                                                   glm::dvec3(kLeastTransmittance), glm::dvec3(1.0));
                extinction = -glm::log(left) / rows.distance_m(row);
                share = glm::max(1.0 - left, 1e-30);
            }
            const auto all = atmosphere.scattered(line, azimuths);
            for (int column = 0; column < Air::kColumns; ++column) {
                const auto& from = all[static_cast<std::size_t>(std::min(column, Air::kColumns - column))];
                const auto set = [&](int layer, const BandValues& light, double part) {
                    texel(air, layer, column, row) = glm::dvec4(colour_of(light) / share, part);
                };
                set(0, from.by_air, extinction.x);
                set(1, from.by_haze, extinction.y);
                set(2, from.more, extinction.z);
            }
        });
        return air;
    }

    bool has_sky() const override { return true; }

  private:
    // 0 up to half a kilometre, where the sun is less than 0.8° lower at the horizon than below the eye; 1 from four
    // on.
    static float by_place(double height_m) {
        const double x = std::clamp(
            (height_m - kLightByPlaceFrom_m) / (kLightByPlaceWhole_m - kLightByPlaceFrom_m), 0.0, 1.0);
        return static_cast<float>(x * x * (3.0 - 2.0 * x));
    }

    // The rows of place.glsl.
    const std::vector<glm::vec4>& places() const {
        std::call_once(places_made_, [&] {
            const Atmosphere& atmosphere = before(2.0);
            places_.resize(std::size_t{Air::kPlaceRows} * Air::kWidth);
            tbb::parallel_for(0, Air::kWidth, [&](int i) {
                const double x = 2.0 * i / (Air::kWidth - 1) - 1.0, elevation = 0.5 * kPi * x * x * x;
                const Disc disc = disc_at(atmosphere.turbidity(), elevation, kSunAngularRadius);
                // The last that is seen of it is on the horizon.
                const double rise = elevation <= -kSunAngularRadius
                                        ? kSunAngularRadius
                                        : std::sin(disc.elevation_rad) - std::sin(elevation);
                const auto column = static_cast<std::size_t>(i);
                places_[column] = glm::dvec4(disc.radiance, rise);
                places_[column + Air::kWidth] = glm::dvec4(sky_irradiance(atmosphere, elevation), 0.0);
            });
        });
        return places_;
    }

    // On the level sea. Scattered light without its phase functions is smooth: a few directions do, in rings of equal
    // irradiance.
    static glm::dvec3 sky_irradiance(const Atmosphere& atmosphere, double sun_elevation) {
        constexpr int kRings = 10, kAround = 12;
        std::vector<double> azimuths;
        for (int i = 0; i < kAround; ++i) azimuths.push_back(kPi * (i + 0.5) / kAround);
        BandValues sum{};
        for (int ring = 0; ring < kRings; ++ring) {
            const double height2 = (ring + 0.5) / kRings, elevation = std::asin(std::sqrt(height2));
            const auto all = atmosphere.scattered({.elevation_rad = elevation}, azimuths, sun_elevation);
            for (std::size_t i = 0; i < azimuths.size(); ++i) {
                const double cosine = std::sin(elevation) * std::sin(sun_elevation) +
                                      std::cos(elevation) * std::cos(sun_elevation) * std::cos(azimuths[i]);
                for (std::size_t b = 0; b < sum.size(); ++b)
                    sum[b] += (all[i].by_air[b] * air_phase(cosine) + all[i].by_haze[b] * haze_phase(cosine) +
                               all[i].more[b]) *
                              (kPi / (kRings * kAround));
            }
        }
        return glm::max(colour_of(sum), glm::dvec3(0.0));
    }

    // The atmosphere for an eye so high up.
    const Atmosphere& before(double height_km) const {
        if (height_km <= low_->highest_km()) return *low_;
        std::call_once(high_made_, [&] {
            high_ = std::make_unique<const Atmosphere>(low_->turbidity(), low_->sun_elevation_rad(),
                                                       std::numeric_limits<double>::infinity());
        });
        return *high_;
    }

    std::shared_ptr<const Atmosphere> low_;
    mutable std::once_flag high_made_, places_made_;
    mutable std::vector<glm::vec4> places_;
    mutable std::unique_ptr<const Atmosphere> high_;
    glm::dvec2 azimuth_;
    glm::dvec3 to_sun_, white_;
};

class PictureAir final : public AirModel {
  public:
    PictureAir(const SkyMap& map, double visibility_m) : extinction_(kKoschmieder / visibility_m) {
        // Above the band along the horizon where texels are partly below it.
        const double elevation = std::max(kPi / 180.0, 3.0 * static_cast<double>(kSkyMapExtent) / map.size());
        constexpr int kSamples =
            16;  // a column is a mean over its share of the circle, and over its neighbours'
        for (int column = 0; column < Air::kColumns; ++column) {
            glm::dvec3 sum(0.0);
            double weights = 0.0;
            for (int i = -kSamples; i <= kSamples; ++i) {
                const double weight = 1.0 - std::abs(i) / (kSamples + 1.0);
                const double azimuth = kTwoPi * (column + static_cast<double>(i) / kSamples) / Air::kColumns;
                const glm::dvec3 to(std::cos(elevation) * std::cos(azimuth),
                                    std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
                sum += weight * glm::dvec3(map.radiance(sky_map_place(glm::vec3(to)), 0.0f));
                weights += weight;
            }
            horizon_[static_cast<std::size_t>(column)] = sum / weights;
        }
    }

    Air seen_from(double height_m) const override {
        const Rows rows(height_m);
        Air air;
        rows.set(air);
        for (int row = 0; row < Air::kRows; ++row) {
            const auto extinction = static_cast<float>(extinction_ * mean_density(rows.line(row)));
            for (int column = 0; column < Air::kColumns; ++column) {
                texel(air, 0, column, row) = texel(air, 1, column, row) =
                    glm::vec4(glm::vec3(0.0f), extinction);
                texel(air, 2, column, row) =
                    glm::vec4(glm::vec3(horizon_[static_cast<std::size_t>(column)]), extinction);
            }
        }
        return air;
    }

    bool has_sky() const override { return false; }

  private:
    // At the least contrast that an eye sees, 2 %: −ln 0.02.
    static constexpr double kKoschmieder = 3.912;

    // The mean density of haze along a line of sight, relative to that at sea level.
    static double mean_density(const SightLine& line) {
        constexpr int kSteps = 256;
        const double radius = kEarthRadius_km + line.height_km;
        const double up = std::sin(line.elevation_rad), length = line.length_km;
        const double lowest = std::clamp(-radius * up, 0.0, length);
        double sum = 0.0;
        for (const double part : {-lowest, length - lowest})
            for (int i = 0; i < kSteps; ++i) {
                const double a = static_cast<double>(i) / kSteps, b = (i + 1.0) / kSteps;
                const double t = lowest + part * 0.5 * (a * a + b * b);
                const double height =
                    std::sqrt(radius * radius + t * (t + 2.0 * radius * up)) - kEarthRadius_km;
                sum += std::abs(part) * (b * b - a * a) * std::exp(-std::max(height, 0.0) / kHazeScale_km);
            }
        return sum / length;
    }

    double extinction_;  // [1/m] at sea level
    std::array<glm::dvec3, Air::kColumns> horizon_{};
};

}  // namespace

std::shared_ptr<const AirModel> picture_air(const SkyMap& map, double visibility_m) {
    if (!(visibility_m > 0.0)) throw std::invalid_argument("picture_air: give a visibility above 0 m");
    if (map.size() == 0) throw std::invalid_argument("picture_air: the sky has no map");
    return std::make_shared<const PictureAir>(map, visibility_m);
}

std::shared_ptr<const AirModel> daylight_air(std::shared_ptr<const Atmosphere> atmosphere,
                                             double azimuth_rad) {
    return std::make_shared<const DaylightAir>(std::move(atmosphere), azimuth_rad);
}

namespace {

air_shading::Shading::AirView view_of(const Air& air) {
    return {air.azimuth, air.to_sun, air.nearest_m, air.horizon_m, air.farthest_m, air.dip, air.sky_span};
}

}  // namespace

glm::vec3 sky_through(const Air& air, glm::vec3 direction) {
    if (!air.has_sky) throw std::invalid_argument("sky_through: this air has no sky");
    air_shading::Shading shading{air.texels.data()};
    return shading.air_sky(direction, view_of(air));
}

void see_through(const Air& air, std::span<const glm::vec3> to_eye, std::span<const float> distance_m,
                 std::span<SeaRadiance> radiance) {
    if (to_eye.size() != radiance.size() || distance_m.size() != radiance.size())
        throw std::invalid_argument("see_through: give one direction and one distance for each SeaRadiance");
    if (air.empty()) return;
    air_shading::Shading shading{air.texels.data()};
    const air_shading::Shading::AirView view = view_of(air);
    for (std::size_t i = 0; i < radiance.size(); ++i) {
        const auto path = shading.air_path(to_eye[i], distance_m[i], view);
        SeaRadiance& at = radiance[i];
        at.sun *= path.transmittance;
        at.sky *= path.transmittance;
        at.sea *= path.transmittance;
        at.foam *= path.transmittance;
        at.air += path.scattered;
    }
}

}  // namespace pelagic
