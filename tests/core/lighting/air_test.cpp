// The air between eye and sea against the atmosphere's model along the same ray, and its limits.
#include "core/lighting/air.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <stdexcept>
#include <vector>

#include "core/base/constants.h"
#include "core/lighting/atmosphere.h"
#include "core/lighting/colour.h"
#include "core/lighting/sky.h"
#include "core/lighting/sunlight.h"

namespace pelagic {
namespace {

constexpr double kDegree = kPi / 180.0, kRadius_m = 1e3 * kEarthRadius_km;

// The ray from an eye to a place on the sea at a distance: its elevation.
double elevation_to(double height_m, double distance_m) {
    const double horizon2 = height_m * (2.0 * kRadius_m + height_m);
    return std::asin(
        std::max(-1.0, -(horizon2 + distance_m * distance_m) / (2.0 * distance_m * (kRadius_m + height_m))));
}
double horizon_of(double height_m) {
    return std::sqrt(height_m * (2.0 * kRadius_m + height_m));
}
glm::dvec3 towards(double elevation, double azimuth) {
    return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
            std::sin(elevation)};
}

glm::dvec3 light_of(const Atmosphere::Scattered& scattered, double cosine) {
    return colour_of(scattered.by_air) * air_phase(cosine) +
           colour_of(scattered.by_haze) * haze_phase(cosine) + colour_of(scattered.more);
}
glm::dvec3 colour_left(const BandValues& left) {
    BandValues all;
    all.fill(1.0);
    return colour_of(left) / colour_of(all);
}

// A white surface of radiance 1 through the air: what is left in `sky`, what was added in `air`.
SeaRadiance seen(const Air& air, glm::dvec3 direction, double distance_m) {
    SeaRadiance radiance;
    radiance.sky = glm::vec3(1.0f);
    const glm::vec3 to_eye(-direction);
    const auto metres = static_cast<float>(distance_m);
    see_through(air, {&to_eye, 1}, {&metres, 1}, {&radiance, 1});
    return radiance;
}

bool is_finite(glm::vec3 v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

struct Case {
    double turbidity, sun_deg;
};
constexpr std::array kCases{Case{2.0, 40.0}, Case{8.0, 12.0}, Case{3.0, 2.0}};

// The sum over short pieces of the ray, each looked at from its own start, dimmed by those before it. Elevations are
// those of the turned horizon; the sun's, which is the model's own, would turn by less than 0.2°, of a low sun by 0.04°.
TEST(Air, IsTheModelsIntegralAlongTheRay) {
    for (const auto& [turbidity, sun_deg] : kCases) {
        const auto atmosphere = std::make_shared<const Atmosphere>(turbidity, sun_deg * kDegree);
        const auto model = daylight_air(atmosphere, 0.3);
        for (const double height_m : {2.0, 60.0, 900.0}) {
            const Air air = model->seen_from(height_m);
            const double farthest_m = std::min(horizon_of(height_m), sun_deg < 5.0 ? 4e3 : 20e3);
            for (const double part : {0.05, 0.4, 1.0})
                for (const double azimuth : {0.1, 1.3, 3.0}) {
                    const double distance_m = height_m + part * (farthest_m - height_m);
                    const double elevation = elevation_to(height_m, distance_m);
                    const glm::dvec3 sun = towards(sun_deg * kDegree, 0.0);
                    const double cosine = glm::dot(towards(elevation, azimuth), sun);
                    constexpr int kPieces = 100;
                    const double piece_m = distance_m / kPieces;
                    BandValues left;
                    left.fill(1.0);
                    glm::dvec3 added(0.0);
                    for (int i = 0; i < kPieces; ++i) {
                        const double t = piece_m * i, up = std::sin(elevation);
                        const double radius = std::sqrt(std::pow(kRadius_m + height_m, 2) +
                                                        t * (t + 2.0 * up * (kRadius_m + height_m)));
                        const SightLine line{
                            .height_km = 1e-3 * (radius - kRadius_m),
                            .elevation_rad = std::asin(((kRadius_m + height_m) * up + t) / radius),
                            .length_km = 1e-3 * piece_m};
                        const std::array azimuths{azimuth};
                        Atmosphere::Scattered own = atmosphere->scattered(line, azimuths)[0];
                        const BandValues through = atmosphere->transmittance(line);
                        for (std::size_t b = 0; b < left.size(); ++b) {
                            own.by_air[b] *= left[b];
                            own.by_haze[b] *= left[b];
                            own.more[b] *= left[b];
                            left[b] *= through[b];
                        }
                        added += light_of(own, cosine);
                    }
                    const SeaRadiance found = seen(air, towards(elevation, 0.3 + azimuth), distance_m);
                    const auto said = [&] {
                        return testing::Message()
                               << "turbidity " << turbidity << " sun " << sun_deg << " from " << height_m
                               << " m, " << distance_m << " m far, azimuth " << azimuth;
                    };
                    for (int c = 0; c < 3; ++c) {
                        EXPECT_NEAR(found.sky[c], colour_left(left)[c], 2e-4) << said();
                        // At 2° the sun's own light changes by a third with each degree that it turns.
                        EXPECT_NEAR(found.air[c], added[c],
                                    (sun_deg < 5.0 ? 0.04 : 0.01) * std::max(luminance(added), added[c]))
                            << said();
                    }
                }
        }
    }
}

// From all heights, with every ray's end: the table against the model's own ray.
TEST(Air, IsInterpolatedWell) {
    for (const auto& [turbidity, sun_deg] : kCases) {
        const auto atmosphere = std::make_shared<const Atmosphere>(turbidity, sun_deg * kDegree, 1e3);
        const auto model = daylight_air(atmosphere, -2.0);
        for (const double height_m : {0.5, 30.0, 8e3, 120e3, 400e3}) {
            const Air air = model->seen_from(height_m);
            for (const double part : {0.003, 0.11, 0.37, 0.71, 0.93, 0.995})
                for (const double azimuth : {0.05, 0.9, 2.2, 4.0}) {
                    const double distance_m = height_m + part * (horizon_of(height_m) - height_m);
                    const double elevation = elevation_to(height_m, distance_m);
                    const SightLine line{1e-3 * height_m, elevation, 1e-3 * distance_m};
                    const std::array azimuths{azimuth};
                    const double cosine =
                        glm::dot(towards(elevation, azimuth), towards(sun_deg * kDegree, 0.0));
                    const glm::dvec3 added = light_of(atmosphere->scattered(line, azimuths)[0], cosine);
                    const glm::dvec3 left = colour_left(atmosphere->transmittance(line));
                    const SeaRadiance found = seen(air, towards(elevation, azimuth - 2.0), distance_m);
                    // From orbit a low sun has its terminator in view: finer than the table's columns.
                    const bool terminator = height_m > 50e3 && sun_deg < 25.0;
                    const double tolerance =
                        (terminator ? 0.12 : 0.005) * luminance(added) + (terminator ? 0.02 : 1e-4);
                    EXPECT_NEAR(luminance(glm::dvec3(found.air)), luminance(added), tolerance)
                        << turbidity << " " << sun_deg << " " << height_m << " " << part << " " << azimuth;
                    EXPECT_NEAR(luminance(glm::dvec3(found.sky)), luminance(left), 2e-3);
                }
        }
    }
}

TEST(Air, AtNoDistanceIsNothing) {
    const Sky sky = daylight_sky({}, 16);
    for (const double height_m : {0.0, 2.0, 8e3}) {
        const SeaRadiance found = seen(sky.air->seen_from(height_m), towards(-0.3, 1.0), 0.0);
        EXPECT_EQ(found.sky, glm::vec3(1.0f));
        EXPECT_EQ(found.air, glm::vec3(0.0f));
    }
}

// Nothing tells the sea at the horizon from the sky above it where the air between is thick.
TEST(Air, HidesTheHorizonFromHighUp) {
    for (const double sun_deg : {5.0, 20.0, 60.0}) {
        const auto atmosphere = std::make_shared<const Atmosphere>(8.0, sun_deg * kDegree, 1e3);
        const Air air = daylight_air(atmosphere, 0.0)->seen_from(8e3);
        const double dip = elevation_to(8e3, horizon_of(8e3));
        for (const double azimuth : {0.3, 1.6, 3.1}) {
            const std::array azimuths{azimuth};
            const double cosine = glm::dot(towards(dip, azimuth), towards(sun_deg * kDegree, 0.0));
            const double above = luminance(
                light_of(atmosphere->scattered({8.0, dip + 1e-6, std::numeric_limits<double>::infinity()},
                                               azimuths)[0],
                         cosine));
            const SeaRadiance found = seen(air, towards(dip, azimuth), horizon_of(8e3));
            // Of a sea as bright as that sky, or black.
            for (const double sea : {0.0, above}) {
                const double below =
                    luminance(glm::dvec3(found.air)) + sea * luminance(glm::dvec3(found.sky));
                EXPECT_LT(std::abs(below - above) / (below + above), 0.05) << sun_deg << " " << azimuth;
            }
        }
    }
}

// The sky before an eye pixel by pixel, 40° on 1280: the model's value and gradient; and the gradient itself is without
// steps, as an eye would see them in so smooth a sky. With straight lines between the values of the model's tables it had steps
// of up to 18 % of the largest gradient, and the pictures' was off by 10 %.
TEST(Air, SkyIsTheModelsAndWithoutSteps) {
    constexpr double kPixel = 5.7e-4, kEye_m = 2.0;
    for (const auto& [turbidity, sun_deg] :
         {Case{2.0, 60.0}, Case{8.0, 60.0}, Case{3.0, 5.0}, Case{8.0, 0.0}}) {
        const auto atmosphere = std::make_shared<const Atmosphere>(turbidity, sun_deg * kDegree);
        const Air air = daylight_air(atmosphere, 0.0)->seen_from(kEye_m);
        const std::array<double, 2> azimuths{0.1, 1.6};
        std::array<std::vector<double>, 2> expected, found;
        for (int row = 4; row < 300; ++row) {
            const double elevation = kPixel * row;
            const auto light =
                atmosphere->scattered({.height_km = 1e-3 * kEye_m, .elevation_rad = elevation}, azimuths);
            for (std::size_t k = 0; k < azimuths.size(); ++k) {
                const glm::dvec3 to = towards(elevation, azimuths[k]);
                expected[k].push_back(
                    luminance(light_of(light[k], glm::dot(to, towards(sun_deg * kDegree, 0.0)))));
                found[k].push_back(luminance(glm::dvec3(sky_through(air, glm::vec3(to)))));
            }
        }
        for (std::size_t k = 0; k < azimuths.size(); ++k) {
            const auto slope = [](const std::vector<double>& rows, std::size_t i) {
                return rows[i + 1] - rows[i];
            };
            double steepest = 0.0, off = 0.0, step = 0.0;
            for (std::size_t i = 0; i + 1 < expected[k].size(); ++i) {
                EXPECT_NEAR(found[k][i] / expected[k][i], 1.0, 2e-3)
                    << turbidity << ' ' << sun_deg << ' ' << i;
                steepest = std::max(steepest, std::abs(slope(expected[k], i)));
                off = std::max(off, std::abs(slope(found[k], i) - slope(expected[k], i)));
                if (i > 0) step = std::max(step, std::abs(slope(expected[k], i) - slope(expected[k], i - 1)));
            }
            EXPECT_LT(off / steepest, 0.02) << turbidity << ' ' << sun_deg << ' ' << azimuths[k];
            EXPECT_LT(step / steepest, 0.03) << turbidity << ' ' << sun_deg << ' ' << azimuths[k];
        }
    }
}

TEST(Air, IsFiniteEverywhere) {
    for (const double sun_deg : {-90.0, -4.0, 0.0, 90.0}) {
        const Sky sky = daylight_sky({.sun_elevation_deg = sun_deg, .turbidity = 10.0}, 16);
        for (const double height_m : {-1e3, 0.0, 1e-9, 0.5, 99999.0, 100001.0, 400e3, 1e9, 1e15}) {
            const Air air = sky.air->seen_from(height_m);
            for (int i = 0; i <= 64; ++i) {
                const glm::vec3 through = sky_through(air, glm::vec3(towards(kPi * (i / 64.0 - 0.5), 1.0)));
                ASSERT_TRUE(is_finite(through) && through.x >= 0.0f)
                    << sun_deg << " " << height_m << " " << i;
            }
            for (const double elevation : {-0.5 * kPi, -1.0, -1e-6, 0.0, 0.4, 0.5 * kPi})
                for (const double azimuth : {0.0, kPi, -kPi, 1.0})
                    for (const double distance_m : {0.0, 1e-6, 1.0, 1e4, 1e7, 1e15, 3e38}) {
                        const SeaRadiance found = seen(air, towards(elevation, azimuth), distance_m);
                        ASSERT_TRUE(is_finite(found.sky) && is_finite(found.air))
                            << sun_deg << " " << height_m << " " << elevation << " " << distance_m;
                        for (int c = 0; c < 3; ++c) ASSERT_TRUE(found.sky[c] >= 0.0f && found.air[c] >= 0.0f);
                    }
        }
    }
}

// Koschmieder: at the distance of visibility 2 % of the sea's light are left, before the horizon's.
TEST(Air, OfAPictureHidesTheSeaAtTheVisibility) {
    LatLong grey{.width = 64, .height = 32, .radiance = {}};
    grey.radiance.assign(64 * 32, glm::vec3(2.0f, 3.0f, 4.0f));
    const Sky sky = picture_sky(grey, 64);
    EXPECT_EQ(sky.air, nullptr);  // without a visibility
    const Air air = picture_air(sky.map, 5e3)->seen_from(3.0);
    for (const double azimuth : {0.0, 2.0, 5.0}) {
        const SeaRadiance found = seen(air, towards(elevation_to(3.0, 5e3), azimuth), 5e3);
        for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(found.sky[c], 0.02f, 2e-4f);
            EXPECT_NEAR(found.air[c], 0.98f * (2.0f + static_cast<float>(c)), 2e-3f);
        }
    }
    EXPECT_THROW(picture_air(sky.map, 0.0), std::invalid_argument);
    EXPECT_THROW(picture_air(SkyMap(), 1e3), std::invalid_argument);
    // None at all: nothing changes.
    const SeaRadiance clear = seen(Air(), towards(-0.1, 0.0), 5e3);
    EXPECT_EQ(clear.sky, glm::vec3(1.0f));
    EXPECT_EQ(clear.air, glm::vec3(0.0f));
}

}  // namespace
}  // namespace pelagic
