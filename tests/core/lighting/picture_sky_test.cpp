// Lat-long pictures: their orientation, that the sun counts once, and that no light is lost on the way to the
// map.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <functional>
#include <glm/geometric.hpp>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>

#include "core/base/constants.h"
#include "core/lighting/sky.h"

namespace pelagic {
namespace {

constexpr double kDegreeOfPicture = kPi / 180.0;

glm::dvec3 towards_deg(double elevation_deg, double azimuth_deg) {
    const double e = elevation_deg * kDegreeOfPicture, a = azimuth_deg * kDegreeOfPicture;
    return {std::cos(e) * std::cos(a), std::cos(e) * std::sin(a), std::sin(e)};
}

// The direction of a point of a picture, in pixels from the upper left corner, as LatLong
// (core/lighting/sky.h) has it.
glm::dvec3 direction_at(const LatLong& picture, double x, double y) {
    return towards_deg(90.0 - 180.0 * y / picture.height, 180.0 - 360.0 * x / picture.width);
}

// A picture of a radiance. Each pixel is the mean over parts(direction of its centre)² points, weighted by
// solid angle.
LatLong painted(
    int width, int height, const std::function<glm::vec3(glm::dvec3)>& radiance,
    const std::function<int(glm::dvec3)>& parts_at = [](glm::dvec3) { return 1; }) {
    LatLong picture{width, height, {}};
    for (int j = 0; j < height; ++j)
        for (int i = 0; i < width; ++i) {
            const int parts = parts_at(direction_at(picture, i + 0.5, j + 0.5));
            glm::dvec3 sum(0.0);
            double weights = 0.0;
            for (int b = 0; b < parts; ++b)
                for (int a = 0; a < parts; ++a) {
                    const double y = j + (b + 0.5) / parts, weight = std::sin(kPi * y / height);
                    sum += weight * glm::dvec3(radiance(direction_at(picture, i + (a + 0.5) / parts, y)));
                    weights += weight;
                }
            picture.radiance.push_back(glm::vec3(sum / weights));
        }
    return picture;
}

// ∫ L cosθ dω over the upper half, with constant pixels.
glm::dvec3 irradiance(const LatLong& picture) {
    glm::dvec3 sum(0.0);
    for (int j = 0; j < picture.height / 2; ++j) {
        const double high = std::sin(kPi * (0.5 - static_cast<double>(j) / picture.height));
        const double low = std::sin(kPi * (0.5 - (j + 1.0) / picture.height));
        for (int i = 0; i < picture.width; ++i)
            sum += glm::dvec3(picture.radiance[static_cast<std::size_t>(j * picture.width + i)]) *
                   (0.5 * (high * high - low * low) * kTwoPi / picture.width);
    }
    return sum;
}

// A smooth sky that isn't symmetric.
glm::vec3 plain_sky(glm::dvec3 d) {
    return glm::vec3(2.0 + d.x, 2.0 + 0.5 * d.y, 3.0 + d.z * d.z);
}

// The same with a sun 100 000 times as bright, and a glow around it.
glm::vec3 sunny_sky(glm::dvec3 d, glm::dvec3 sun) {
    const double apart = std::acos(std::min(1.0, glm::dot(d, sun)));
    glm::vec3 colour = plain_sky(d) * static_cast<float>(1.0 + std::exp(-apart / 0.2));
    if (apart < 0.00465) colour += glm::vec3(3e5f, 2.5e5f, 2e5f);
    return colour;
}

template <class A, class B>
void expect_close(const A& a, const B& b, double tolerance) {
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(static_cast<double>(a[c]) / static_cast<double>(b[c]), 1.0, tolerance) << c;
}

TEST(PictureSky, UniformPictureOfOneGivesPi) {
    const Sky sky = picture_sky(painted(64, 32, [](glm::dvec3) { return glm::vec3(1.0f); }), 128);
    EXPECT_NEAR(static_cast<double>(sky.sky_irradiance.y), kPi, 1e-3);
    EXPECT_EQ(sky.sun_radiance, glm::vec3(0.0f));
    EXPECT_EQ(sky.sun_irradiance, glm::vec3(0.0f));
    EXPECT_FLOAT_EQ(sky.map.radiance({0.5f, 0.5f}, 0.0f).x, 1.0f);
}

TEST(PictureSky, TheMiddleColumnIsXAndAzimuthGrowsToTheLeft) {
    // Interpolation between pixels of 0.7° is accurate to their angle squared in a smooth sky, also at the
    // seam behind, and around the zenith, where columns converge. Next to the horizon the last row stands for
    // half a pixel more.
    const Sky sky = picture_sky(painted(512, 256, plain_sky), 256);
    for (const double azimuth : {0.0, 45.0, 90.0, 135.0, 179.9, -179.9, -90.0})
        for (const double elevation : {1.0, 30.0, 80.0, 89.9, 90.0}) {
            const glm::dvec3 d = towards_deg(elevation, azimuth);
            const glm::vec3 seen = sky.map.radiance(sky_map_place(glm::vec3(d)), 0.0f);
            expect_close(seen, plain_sky(d), 3e-3);
        }
}

TEST(PictureSky, NoLightIsLostBetweenPictureAndMap) {
    // Finer than the map, coarser, and of other proportions than 2 : 1.
    for (const glm::ivec2 size : {glm::ivec2(1024, 512), glm::ivec2(64, 32), glm::ivec2(300, 256)}) {
        // Stripes three pixels wide and a step, which point samples would miss or count twice.
        LatLong picture{size.x, size.y, {}};
        for (int j = 0; j < size.y; ++j)
            for (int i = 0; i < size.x; ++i)
                picture.radiance.push_back(
                    glm::vec3((i / 3) % 2 ? 3.0f : 1.0f, i < size.x / 2 ? 2.0f : 1.0f, 1.0f));
        const Sky sky = picture_sky(picture, 128);
        expect_close(sky.sky_irradiance, irradiance(picture), 1e-3);
    }
}

TEST(PictureSky, ColumnsThatConvergeAtTheZenithAreAveraged) {
    // Every other column is black. Within 10° of the zenith a pixel as wide as high has at least 6 columns,
    // whose mean is off by at most half a column.
    LatLong picture{256, 128, {}};
    for (int i = 0; i < 256 * 128; ++i) picture.radiance.push_back(glm::vec3(i % 2 ? 2.0f : 0.0f));
    const Sky sky = picture_sky(picture, 128);
    for (int j = 0; j < 128; ++j)
        for (int i = 0; i < 128; ++i)
            if (std::hypot(i - 63.5, j - 63.5) * 2.5 / 128.0 < std::tan(5.0 * kDegreeOfPicture)) {
                EXPECT_NEAR(sky.map.level(0)[static_cast<std::size_t>(j * 128 + i)].x, 1.0f, 0.1f)
                    << i << " " << j;
            }
}

TEST(PictureSky, TheSunIsFoundAndCountedOnce) {
    // At the seam, low, high, at the zenith; with pixels smaller than the disc (0.53°) and larger.
    for (const glm::dvec2 place :
         {glm::dvec2(35.0, 60.0), glm::dvec2(8.0, 179.9), glm::dvec2(75.0, -120.0), glm::dvec2(89.8, 30.0)})
        for (const int height : {512, 128}) {
            const glm::dvec3 sun = towards_deg(place.x, place.y);
            const double pixel_deg = 180.0 / height;
            const auto parts = [&](glm::dvec3 d) {
                return std::acos(std::min(1.0, glm::dot(d, sun))) < 3.0 * kDegreeOfPicture ? 24 : 1;
            };
            const LatLong picture = painted(
                2 * height, height, [&](glm::dvec3 d) { return sunny_sky(d, sun); }, parts);
            const Sky sky = picture_sky(picture, 256);
            // A tenth of a degree. The place of a disc inside one coarse pixel is known to half a diagonal.
            const double apart =
                std::acos(std::min(1.0, glm::dot(glm::normalize(glm::dvec3(sky.sun_direction)), sun)));
            const double off_deg = pixel_deg < 0.53 ? 0.1 : 0.71 * pixel_deg;
            EXPECT_LT(apart / kDegreeOfPicture, off_deg) << place.x << " " << height;
            expect_close(glm::dvec3(sky.sun_irradiance) + glm::dvec3(sky.sky_irradiance), irradiance(picture),
                         1e-3);
            // The disc has the light that was painted, up to the error of its elevation and of painting with
            // 24² points per pixel: a few per mille. (The sky's own light and the glow stay in the sky.)
            const double solid_angle = kTwoPi * (1.0 - std::cos(0.00465));
            const double tolerance =
                0.01 + off_deg * kDegreeOfPicture * std::sqrt(1.0 - sun.z * sun.z) / sun.z;
            EXPECT_NEAR(static_cast<double>(sky.sun_irradiance.x) / (3e5 * solid_angle * sun.z), 1.0,
                        tolerance)
                << place.x << " " << height;
            const double across = 0.00465;
            expect_close(glm::dvec3(sky.sun_irradiance) /
                             (kPi * across * across * static_cast<double>(sky.sun_direction.z)),
                         sky.sun_radiance, 1e-5);
            const glm::vec3 at_sun = sky.map.radiance(sky_map_place(glm::vec3(sun)), 0.0f);
            EXPECT_LT(at_sun.x, 2.5f * plain_sky(sun).x);
            EXPECT_GT(at_sun.x, 1.4f * plain_sky(sun).x);
        }
}

// As if it had been painted so; also by a part of a pixel.
TEST(PictureSky, ATurnedPictureTurnsWithItsSun) {
    const auto of = [](double azimuth_deg, double rotation_deg) {
        const glm::dvec3 sun = towards_deg(30.0, azimuth_deg);
        const LatLong picture = painted(
            512, 256, [&](glm::dvec3 d) { return sunny_sky(d, sun); },
            [&](glm::dvec3 d) { return glm::dot(d, sun) > 0.998 ? 24 : 1; });
        const auto read = [&](int first_row, std::span<glm::vec3> radiance) {
            std::copy_n(picture.radiance.begin() + first_row * 512, radiance.size(), radiance.begin());
        };
        return picture_sky(
            {.width = 512, .height = 256, .rotation_rad = rotation_deg * kDegreeOfPicture, .read = read},
            128);
    };
    const Sky plain = of(170.0, 0.0);
    for (const double turn_deg : {45.0, -100.2, 179.9}) {
        const Sky turned = of(170.0, turn_deg);
        const glm::dvec3 sun = towards_deg(30.0, 170.0 + turn_deg);
        EXPECT_LT(glm::length(glm::dvec3(turned.sun_direction) - sun), 5e-3) << turn_deg;
        EXPECT_NEAR(turned.sun_irradiance.x / plain.sun_irradiance.x, 1.0f, 1e-4f) << turn_deg;
        EXPECT_NEAR(turned.sky_irradiance.x / plain.sky_irradiance.x, 1.0f, 1e-3f) << turn_deg;
        for (const double beside_deg : {8.0, -60.0, 120.0}) {
            const auto at = [&](const Sky& sky, double azimuth_deg) {
                return sky.map.radiance(sky_map_place(glm::vec3(towards_deg(35.0, azimuth_deg))), 1.0f).x;
            };
            EXPECT_NEAR(at(turned, 170.0 + turn_deg + beside_deg) / at(plain, 170.0 + beside_deg), 1.0f,
                        0.02f)
                << turn_deg << ' ' << beside_deg;
        }
    }
}

TEST(PictureSky, ABrightCloudIsNoSun) {
    const glm::dvec3 middle = towards_deg(40.0, 10.0);
    const auto clouds = [&](glm::dvec3 d) {
        const double apart = std::acos(std::min(1.0, glm::dot(d, middle)));
        return glm::vec3(static_cast<float>(1.0 + 20.0 * std::exp(-apart * apart / 0.03)));
    };
    const LatLong picture = painted(256, 128, clouds);
    const Sky sky = picture_sky(picture, 128);
    EXPECT_EQ(sky.sun_radiance, glm::vec3(0.0f));
    expect_close(sky.sky_irradiance, irradiance(picture), 1e-3);
}

TEST(PictureSky, TheLowerHalfIsNotUsed) {
    const auto above = [](glm::dvec3 d) { return d.z > 0.0 ? glm::vec3(1.0f) : glm::vec3(1e4f); };
    const Sky sky = picture_sky(painted(64, 32, above), 64);
    EXPECT_EQ(sky.sun_radiance, glm::vec3(0.0f));
    EXPECT_NEAR(static_cast<double>(sky.sky_irradiance.x), kPi, 1e-3);
}

// A picture that is read in parts gives the same sky, and never has many rows at hand.
TEST(PictureSky, RowsAreReadInPartsAndTheLowerHalfIsNot) {
    const LatLong picture = painted(512, 256, [](glm::dvec3 d) {
        const double sun = glm::dot(d, glm::normalize(glm::dvec3(0.3, -0.5, 0.6)));
        return glm::vec3(static_cast<float>(2.0 + d.x + 0.5 * d.y + (sun > 0.9995 ? 5000.0 : 0.0)));
    });
    const Sky whole = picture_sky(picture, 128);
    EXPECT_GT(whole.sun_radiance.x, 0.0f);
    for (const int rows_in_piece : {1, 7, 32, 512}) {
        std::atomic<int> rows_read = 0, lowest = 0;
        const auto read = [&](int first, std::span<glm::vec3> radiance) {
            const int count = static_cast<int>(radiance.size() / 512);
            rows_read += count;
            for (int now = lowest;
                 now < first + count && !lowest.compare_exchange_weak(now, first + count);) {
            }
            std::copy_n(picture.radiance.begin() + std::ptrdiff_t{512} * first, radiance.size(),
                        radiance.begin());
        };
        const Sky parts =
            picture_sky({.width = 512, .height = 256, .rows_in_piece = rows_in_piece, .read = read}, 128);
        EXPECT_EQ(parts.map.level(0), whole.map.level(0)) << rows_in_piece;
        EXPECT_EQ(parts.sun_irradiance, whole.sun_irradiance) << rows_in_piece;
        EXPECT_EQ(parts.sky_irradiance, whole.sky_irradiance) << rows_in_piece;
        EXPECT_EQ(lowest, 128) << "the lower half is not read";
        EXPECT_LE(rows_read, 3 * 128) << "each row twice, near the sun three times";
    }
}

// Of a large picture some rows are held at a time, unless it is stored in one piece: the sky is the same.
TEST(PictureSky, ALargePictureIsHeldInRings) {
    constexpr int kWidth = 8192, kHeight = 4096;
    const auto read = [&](int first, std::span<glm::vec3> rows) {
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const std::size_t pixel = std::size_t{kWidth} * static_cast<std::size_t>(first) + i;
            rows[i] = glm::vec3(1.0f + static_cast<float>(pixel * 2654435761u % 64u) / 64.0f);
        }
    };
    const auto sky = [&](int rows_in_piece) {
        return picture_sky({.width = kWidth, .height = kHeight, .rows_in_piece = rows_in_piece, .read = read},
                           64);
    };
    const Sky rings = sky(16), whole = sky(kHeight);
    EXPECT_EQ(rings.map.level(0), whole.map.level(0));
    EXPECT_EQ(rings.sky_irradiance, whole.sky_irradiance);
}

TEST(PictureSky, SmallAndOddPicturesAreSkies) {
    for (const glm::ivec2 size : {glm::ivec2(1, 1), glm::ivec2(2, 1), glm::ivec2(5, 3), glm::ivec2(4, 9)}) {
        LatLong picture{size.x, size.y, {}};
        picture.radiance.assign(static_cast<std::size_t>(size.x * size.y), glm::vec3(1.0f));
        EXPECT_NEAR(static_cast<double>(picture_sky(picture, 64).sky_irradiance.x), kPi, 1e-3) << size.x;
        picture.radiance[0] = glm::vec3(1e6f);  // the result stays finite
        const Sky sky = picture_sky(picture, 64);
        EXPECT_TRUE(std::isfinite(sky.sky_irradiance.x) && std::isfinite(sky.sun_radiance.x));
    }
    // The brightest possible sun in the lowest possible pixel.
    LatLong glaring{64, 32, std::vector<glm::vec3>(64 * 32, glm::vec3(0.0f))};
    glaring.radiance[15 * 64 + 20] = glm::vec3(1e30f);
    const Sky bright = picture_sky(glaring, 64);
    EXPECT_GT(bright.sun_radiance.x, 0.0f);
    EXPECT_TRUE(std::isfinite(bright.sun_radiance.x) && std::isfinite(bright.sun_irradiance.x));
    // One bright pixel in a black sky.
    LatLong night{64, 32, std::vector<glm::vec3>(64 * 32, glm::vec3(0.0f))};
    EXPECT_EQ(picture_sky(night, 64).sky_irradiance, glm::vec3(0.0f));
    night.radiance[8 * 64 + 20] = glm::vec3(5.0f);
    expect_close(picture_sky(night, 64).sun_irradiance, irradiance(night), 1e-3);
}

TEST(PictureSky, RefusesWhatIsNoRadiance) {
    for (const float wrong :
         {-0.1f, 1e31f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        LatLong picture{8, 4, std::vector<glm::vec3>(32, glm::vec3(1.0f))};
        picture.radiance[13].y = wrong;
        picture.radiance[20].x = wrong;
        try {
            picture_sky(picture, 64);
            FAIL() << wrong;
        } catch (const std::invalid_argument& error) {
            EXPECT_NE(std::string(error.what()).find("G of the pixel in column 5, row 1"), std::string::npos)
                << error.what();
        }
    }
    EXPECT_THROW(picture_sky(LatLong{}, 64), std::invalid_argument);
    EXPECT_THROW(picture_sky(LatLong{2, 2, std::vector<glm::vec3>(3)}, 64), std::invalid_argument);
}

}  // namespace
}  // namespace pelagic
