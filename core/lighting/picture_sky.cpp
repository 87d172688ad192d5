// Makes a sky from a picture: its sun is cut out and becomes the disc; the rest is resampled into the map.
//
// What counts as a sun: the brightest pixel and its neighbourhood (kReach), if that pixel is kStandsOut times
// as bright as the ring around it. A sun, even one clipped by the camera or spread over a coarse pixel, is
// 100 … 100 000 times as bright as the sky beside it; a cloud's edge or the haze round a hidden sun is at
// most some 5 times as bright. Every nearby pixel that is kTakenOut times as bright as the ring is then
// removed and filled in from its neighbours. The sun's glow stays in the sky.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <iterator>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "core/base/constants.h"
#include "core/lighting/colour.h"
#include "core/lighting/sky.h"
#include "core/lighting/sky_bake.h"
#include "core/lighting/sunlight.h"

namespace pelagic {
namespace {

constexpr double kReach = 4.0 * kPi / 180.0;      // [rad] from the brightest pixel: disc and glare
constexpr double kRingWidth = 2.0 * kPi / 180.0;  // [rad]
constexpr double kStandsOut = 16.0, kTakenOut = 4.0;
constexpr float kBrightest = 1e30f;  // sums and the disc stay finite in single precision

void check(const LatLong& picture) {
    const auto size_text = std::to_string(picture.width) + " x " + std::to_string(picture.height);
    if (picture.width < 1 || picture.height < 1)
        throw std::invalid_argument("a sky picture of " + size_text + " pixels: both must be at least 1");
    const auto width = static_cast<std::size_t>(picture.width);
    if (picture.radiance.size() != width * static_cast<std::size_t>(picture.height))
        throw std::invalid_argument(std::to_string(picture.radiance.size()) + " pixels in a sky picture of " +
                                    size_text);
    for (std::size_t i = 0; i < picture.radiance.size(); ++i)
        for (int c = 0; c < 3; ++c) {
            const float value = picture.radiance[i][c];
            if (value >= 0.0f && value <= kBrightest) continue;
            throw std::invalid_argument("sky picture: " + std::string(1, "RGB"[c]) +
                                        " of the pixel in column " + std::to_string(i % width) + ", row " +
                                        std::to_string(i / width) + " from the top is " +
                                        std::to_string(value) + "; radiances from 0 to 1e30 are accepted");
        }
}

// The upper rows of a picture, those that see the sky. The last one may contain the horizon.
class Upper {
  public:
    explicit Upper(const LatLong& picture)
        : width_(static_cast<std::size_t>(picture.width)),
          rows_(static_cast<std::size_t>((picture.height + 1) / 2)),
          height_(picture.height),
          pixels_(picture.radiance.begin(),
                  picture.radiance.begin() + static_cast<std::ptrdiff_t>(width_ * rows_)) {}

    std::size_t size() const { return pixels_.size(); }
    std::size_t width() const { return width_; }
    std::size_t rows() const { return rows_; }
    glm::dvec3& operator[](std::size_t i) { return pixels_[i]; }
    const glm::dvec3& operator[](std::size_t i) const { return pixels_[i]; }

    double pixel_height() const { return kPi / height_; }  // [rad]
    double pixel_width() const { return kTwoPi / static_cast<double>(width_); }

    glm::dvec3 direction(std::size_t i) const {
        const double azimuth = kPi - pixel_width() * (static_cast<double>(i % width_) + 0.5);
        const auto [low, high] = edges(i / width_);
        const double elevation = 0.5 * (low + high);
        return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                std::sin(elevation)};
    }
    double solid_angle(std::size_t i) const {
        const auto [low, high] = edges(i / width_);
        return pixel_width() * (std::sin(high) - std::sin(low));
    }
    // The mean over the pixel of the cosine with the vertical.
    double mean_cosine(std::size_t i) const {
        const auto [low, high] = edges(i / width_);
        return 0.5 * (std::sin(high) + std::sin(low));
    }

    // Bilinear, for directions with z ≥ 0.
    glm::dvec3 interpolated(glm::dvec3 to) const {
        const double azimuth = to.x == 0.0 && to.y == 0.0 ? 0.0 : std::atan2(to.y, to.x);
        const double y = (0.5 * kPi - std::asin(std::clamp(to.z, 0.0, 1.0))) / pixel_height() - 0.5;
        const double x = (kPi - azimuth) / pixel_width() - 0.5;
        const double row = std::floor(y);
        const double half_turn = 0.5 * static_cast<double>(width_);
        // Beyond the zenith the top row continues on the opposite side.
        const glm::dvec3 above =
            row < 0.0 ? in_row(0, x + half_turn) : in_row(static_cast<std::size_t>(row), x);
        return glm::mix(above, in_row(static_cast<std::size_t>(row + 1.0), x), y - row);
    }

    // Near the zenith pixels are narrow. Averages each row over as many columns as make a pixel as wide as
    // high, so that samples one pixel height apart miss nothing.
    void round_pixels() {
        for (std::size_t j = 0; j < rows_; ++j) {
            const auto [low, high] = edges(j);
            const double reach = 0.5 * pixel_height() / (pixel_width() * std::cos(0.5 * (low + high)));
            if (reach > 0.5) widen(j, std::min(reach, 0.5 * static_cast<double>(width_)));
        }
    }

  private:
    // The elevations of a row's edges.
    std::pair<double, double> edges(std::size_t row) const {
        const double high = 0.5 * kPi - pixel_height() * static_cast<double>(row);
        return {std::max(0.0, high - pixel_height()), high};
    }

    glm::dvec3 in_row(std::size_t row, double x) const {
        const double left = std::floor(x);
        const glm::dvec3* pixels = &pixels_[std::min(row, rows_ - 1) * width_];
        return glm::mix(pixels[wrapped(left)], pixels[wrapped(left + 1.0)], x - left);
    }

    std::size_t wrapped(double column) const {
        const auto n = static_cast<double>(width_);
        return std::min(static_cast<std::size_t>(column - n * std::floor(column / n)), width_ - 1);
    }

    // Replaces each pixel by the mean over `reach` columns to either side of its middle, from running sums.
    void widen(std::size_t row, double reach) {
        glm::dvec3* pixels = &pixels_[row * width_];
        std::vector<glm::dvec3> sum(width_ + 1, glm::dvec3(0.0));
        for (std::size_t i = 0; i < width_; ++i) sum[i + 1] = sum[i] + pixels[i];
        const auto up_to = [&](double x) {  // integral of the periodic row
            const double turns = std::floor(x / static_cast<double>(width_));
            const double inside = x - turns * static_cast<double>(width_);
            const std::size_t i = std::min(static_cast<std::size_t>(inside), width_ - 1);
            return turns * sum[width_] + sum[i] + (inside - static_cast<double>(i)) * (sum[i + 1] - sum[i]);
        };
        std::vector<glm::dvec3> means(width_);
        for (std::size_t i = 0; i < width_; ++i) {
            const double middle = static_cast<double>(i) + 0.5;
            means[i] = glm::max((up_to(middle + reach) - up_to(middle - reach)) / (2.0 * reach), 0.0);
        }
        std::copy(means.begin(), means.end(), pixels);
    }

    std::size_t width_, rows_;
    int height_;
    std::vector<glm::dvec3> pixels_;
};

// The sun that was removed.
struct Sun {
    glm::dvec3 irradiance{0.0};  // on a horizontal plane
    glm::dvec3 moment{0.0};      // Σ flux · direction
};

// The pixels next to the removed ones.
std::vector<std::size_t> rim_of(const Upper& picture, const std::vector<std::size_t>& taken) {
    const std::size_t width = picture.width();
    std::vector<std::size_t> beside;
    for (const std::size_t i : taken) {
        const std::size_t row = i - i % width;
        beside.push_back(row + (i + 1) % width);
        beside.push_back(row + (i + width - 1) % width);
        if (i >= width) beside.push_back(i - width);
        if (i + width < picture.size()) beside.push_back(i + width);
    }
    std::sort(beside.begin(), beside.end());
    beside.erase(std::unique(beside.begin(), beside.end()), beside.end());
    std::vector<std::size_t> rim;
    std::set_difference(beside.begin(), beside.end(), taken.begin(), taken.end(), std::back_inserter(rim));
    return rim;
}

// Fills the inside of a rim: the mean of the rim's pixels, weighted by inverse squared distance.
struct Rim {
    std::vector<glm::dvec3> radiance, direction;

    glm::dvec3 inside(glm::dvec3 to) const {
        glm::dvec3 sum(0.0);
        double weights = 0.0;
        for (std::size_t k = 0; k < radiance.size(); ++k) {
            const glm::dvec3 apart = direction[k] - to;
            const double weight = 1.0 / glm::dot(apart, apart);
            sum += weight * radiance[k];
            weights += weight;
        }
        return sum / weights;
    }
};

Sun take_sun_out(Upper& picture) {
    std::size_t brightest = 0;
    for (std::size_t i = 1; i < picture.size(); ++i)
        if (luminance(picture[i]) > luminance(picture[brightest])) brightest = i;

    // In a coarse picture the ring starts beyond the neighbours of the brightest pixel.
    const double pixel = std::max(picture.pixel_width(), picture.pixel_height());
    const double inner = std::max(kReach, 2.5 * pixel), outer = inner + std::max(kRingWidth, 1.5 * pixel);
    const glm::dvec3 middle = picture.direction(brightest);
    std::vector<std::size_t> near;
    double ring = 0.0, ring_angle = 0.0;
    for (std::size_t i = 0; i < picture.size(); ++i) {
        const double apart = std::acos(std::clamp(glm::dot(picture.direction(i), middle), -1.0, 1.0));
        if (apart <= inner) near.push_back(i);
        if (apart <= inner || apart > outer) continue;
        ring += luminance(picture[i]) * picture.solid_angle(i);
        ring_angle += picture.solid_angle(i);
    }
    Sun sun;
    if (ring_angle == 0.0) return sun;
    const double level = ring / ring_angle;
    if (!(luminance(picture[brightest]) > kStandsOut * level)) return sun;

    std::vector<std::size_t> taken;
    std::copy_if(near.begin(), near.end(), std::back_inserter(taken),
                 [&](std::size_t i) { return luminance(picture[i]) > kTakenOut * level; });
    Rim rim;
    for (const std::size_t i : rim_of(picture, taken)) {
        rim.radiance.push_back(picture[i]);
        rim.direction.push_back(picture.direction(i));
    }
    for (const std::size_t i : taken) {
        const glm::dvec3 to = picture.direction(i), fill = glm::min(rim.inside(to), picture[i]);
        const glm::dvec3 flux = (picture[i] - fill) * picture.solid_angle(i);
        sun.irradiance += flux * picture.mean_cosine(i);
        sun.moment += luminance(flux) * to;
        picture[i] = fill;
    }
    return sun;
}

}  // namespace

Sky picture_sky(const LatLong& picture, int map_size) {
    check(picture);
    SkyMap::check_size(map_size);
    Upper upper(picture);
    const Sun sun = take_sun_out(upper);
    upper.round_pixels();

    Sky sky;
    if (const double length = glm::length(sun.moment); length > 0.0) {
        const glm::dvec3 direction = sun.moment / length;
        const double radius = static_cast<double>(sky.sun_angular_radius);
        sky.sun_direction = direction;
        sky.sun_irradiance = sun.irradiance;
        sky.sun_radiance = sun.irradiance / (kPi * radius * radius * direction.z);
    }
    SkyDome dome;
    dome.radiance = [&](glm::vec3 direction) { return glm::vec3(upper.interpolated(glm::dvec3(direction))); };
    dome.samples = [&](glm::vec3, float angle) {
        return 1 + static_cast<int>(std::ceil(static_cast<double>(angle) / upper.pixel_height()));
    };
    const BakedSky baked = bake_sky_map(map_size, dome);
    sky.map = baked.map;
    sky.sky_irradiance = baked.irradiance;
    return sky;
}

}  // namespace pelagic
