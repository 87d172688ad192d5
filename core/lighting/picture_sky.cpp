// Makes a sky from a picture: its sun is cut out and becomes the disc; the rest is resampled into the map.
//
// What counts as a sun: the brightest pixel and its neighbourhood (kReach), if that pixel is kStandsOut times
// as bright as the ring around it. A sun, even one clipped by the camera or spread over a coarse pixel, is
// 100 … 100 000 times as bright as the sky beside it; a cloud's edge or the haze round a hidden sun is at
// most some 5 times as bright. Every nearby pixel that is kTakenOut times as bright as the ring is then
// removed and filled in from its neighbours. The sun's glow stays in the sky.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <exception>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <iterator>
#include <span>
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

void check_size(int width, int height) {
    if (width < 1 || height < 1)
        throw std::invalid_argument("a sky picture of " + std::to_string(width) + " x " +
                                    std::to_string(height) + " pixels: both must be at least 1");
}

// Throws for the first value of these rows that is no radiance.
void check_values(std::span<const glm::vec3> radiance, std::size_t width, std::size_t first_row) {
    for (std::size_t i = 0; i < radiance.size(); ++i)
        for (int c = 0; c < 3; ++c) {
            const float value = radiance[i][c];
            if (value >= 0.0f && value <= kBrightest) continue;
            throw std::invalid_argument(std::string(1, "RGB"[c]) + " of the pixel in column " +
                                        std::to_string(i % width) + ", row " +
                                        std::to_string(first_row + i / width) + " from the top is " +
                                        std::to_string(value) + "; accepted: radiances from 0 to 1e30");
        }
}

// The upper rows of a picture, those that see the sky. The last one may contain the horizon. Pixels are numbered
// from the first row's left end on.
class Upper {
  public:
    explicit Upper(const LatLongRows& picture)
        : picture_(picture),
          width_(static_cast<std::size_t>(picture.width)),
          rows_(static_cast<std::size_t>((picture.height + 1) / 2)) {}

    std::size_t size() const { return width_ * rows_; }
    std::size_t width() const { return width_; }
    std::size_t rows() const { return rows_; }

    // Reads the rows from the first to before the end, piece by piece, and hands each piece over with the number of
    // its first row. On several threads.
    template <class Use>
    void for_each_piece(std::size_t first, std::size_t end, const Use& use) const {
        // Pieces of a few rows are read several at a time: each reading opens the file.
        constexpr std::size_t kLeastRows = 32;
        const auto stored = static_cast<std::size_t>(std::max(1, picture_.rows_in_piece));
        const std::size_t rows = stored * ((kLeastRows + stored - 1) / stored);
        const std::size_t begin = first / rows;
        // What is wrong with the picture is the first thing from the top, whatever thread comes first.
        std::vector<std::exception_ptr> wrong((end + rows - 1) / rows - begin);
        tbb::parallel_for(std::size_t{0}, wrong.size(), [&](std::size_t i) {
            const std::size_t piece = begin + i;
            const std::size_t from = std::max(first, piece * rows), to = std::min(end, (piece + 1) * rows);
            try {
                std::vector<glm::vec3> radiance((to - from) * width_);
                picture_.read(static_cast<int>(from), radiance);
                use(from, std::span<const glm::vec3>(radiance));
            } catch (...) {
                wrong[i] = std::current_exception();
            }
        });
        for (const std::exception_ptr& each : wrong)
            if (each) std::rethrow_exception(each);
    }

    double rotation_rad() const { return picture_.rotation_rad; }
    double pixel_height() const { return kPi / picture_.height; }  // [rad]
    double pixel_width() const { return kTwoPi / static_cast<double>(width_); }

    glm::dvec3 direction(std::size_t i) const {
        const double azimuth =
            kPi - pixel_width() * (static_cast<double>(i % width_) + 0.5) + picture_.rotation_rad;
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

    // The elevations of a row's edges.
    std::pair<double, double> edges(std::size_t row) const {
        const double high = 0.5 * kPi - pixel_height() * static_cast<double>(row);
        return {std::max(0.0, high - pixel_height()), high};
    }

  private:
    const LatLongRows& picture_;
    std::size_t width_, rows_;
};

// A pixel, and what stands there instead.
struct Filled {
    std::size_t pixel;
    glm::dvec3 radiance;
};

// The sun that was removed.
struct Sun {
    glm::dvec3 irradiance{0.0};  // on a horizontal plane
    glm::dvec3 moment{0.0};      // Σ flux · direction
    std::vector<Filled> filled;  // in the order of pixels
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

// The first of the brightest pixels. Looks at every value.
std::size_t brightest_pixel(const Upper& picture) {
    const std::size_t width = picture.width();
    struct Brightest {
        double luminance;
        std::size_t pixel;
    };
    std::vector<Brightest> of_row(picture.rows());
    picture.for_each_piece(0, picture.rows(), [&](std::size_t from, std::span<const glm::vec3> radiance) {
        check_values(radiance, width, from);
        for (std::size_t row = 0; row < radiance.size() / width; ++row) {
            Brightest best{-1.0, 0};
            for (std::size_t i = row * width; i < (row + 1) * width; ++i)
                if (const double here = luminance(glm::dvec3(radiance[i])); here > best.luminance)
                    best = {here, from * width + i};
            of_row[from + row] = best;
        }
    });
    return std::max_element(of_row.begin(), of_row.end(),
                            [](const Brightest& a, const Brightest& b) { return a.luminance < b.luminance; })
        ->pixel;
}

Sun find_sun(const Upper& picture) {
    const std::size_t width = picture.width(), brightest = brightest_pixel(picture);

    // In a coarse picture the ring starts beyond the neighbours of the brightest pixel.
    const double pixel = std::max(picture.pixel_width(), picture.pixel_height());
    const double inner = std::max(kReach, 2.5 * pixel), outer = inner + std::max(kRingWidth, 1.5 * pixel);
    const glm::dvec3 middle = picture.direction(brightest);
    const std::size_t row = brightest / width,
                      reach = 2 + static_cast<std::size_t>(outer / picture.pixel_height());
    const std::size_t first = row - std::min(row, reach), end = std::min(picture.rows(), row + reach + 1);
    std::vector<glm::vec3> pixels((end - first) * width);
    struct Near {
        std::vector<std::size_t> inside;
        double ring = 0.0, ring_angle = 0.0;
    };
    std::vector<Near> of_row(end - first);
    picture.for_each_piece(first, end, [&](std::size_t from, std::span<const glm::vec3> radiance) {
        std::copy(radiance.begin(), radiance.end(),
                  pixels.begin() + static_cast<std::ptrdiff_t>((from - first) * width));
        for (std::size_t k = 0; k < radiance.size(); ++k) {
            const std::size_t i = from * width + k;
            Near& near = of_row[i / width - first];
            const double apart = std::acos(std::clamp(glm::dot(picture.direction(i), middle), -1.0, 1.0));
            if (apart <= inner) near.inside.push_back(i);
            if (apart <= inner || apart > outer) continue;
            near.ring += luminance(glm::dvec3(radiance[k])) * picture.solid_angle(i);
            near.ring_angle += picture.solid_angle(i);
        }
    });
    const auto radiance = [&](std::size_t i) { return glm::dvec3(pixels[i - first * width]); };

    Sun sun;
    double ring = 0.0, ring_angle = 0.0;
    for (const Near& near : of_row) ring += near.ring, ring_angle += near.ring_angle;
    if (ring_angle == 0.0) return sun;
    const double level = ring / ring_angle;
    if (!(luminance(radiance(brightest)) > kStandsOut * level)) return sun;

    std::vector<std::size_t> taken;
    for (const Near& near : of_row)
        std::copy_if(near.inside.begin(), near.inside.end(), std::back_inserter(taken),
                     [&](std::size_t i) { return luminance(radiance(i)) > kTakenOut * level; });
    Rim rim;
    for (const std::size_t i : rim_of(picture, taken)) {
        rim.radiance.push_back(radiance(i));
        rim.direction.push_back(picture.direction(i));
    }
    for (const std::size_t i : taken) {
        const glm::dvec3 to = picture.direction(i), fill = glm::min(rim.inside(to), radiance(i));
        const glm::dvec3 flux = (radiance(i) - fill) * picture.solid_angle(i);
        sun.irradiance += flux * picture.mean_cosine(i);
        sun.moment += luminance(flux) * to;
        sun.filled.push_back({i, fill});
    }
    return sun;
}

// Rows of the picture without its sun, as samples want them: near the zenith pixels are narrow, and each row is
// averaged over as many columns as make a pixel as wide as high, so that samples one pixel height apart miss nothing.
class HeldRows {
  public:
    HeldRows(const Upper& picture, const std::vector<Filled>& filled) : picture_(picture), filled_(filled) {}

    // From here on these rows are there, from the first to before the end.
    void hold(std::size_t first, std::size_t end) {
        const std::size_t width = picture_.width();
        std::vector<glm::dvec3> pixels((end - first) * width);
        const std::size_t kept_from = std::clamp(first_, first, end);
        const std::size_t kept_end = std::clamp(end_, kept_from, end);
        const auto at = [&](std::size_t row, std::size_t from) {
            return static_cast<std::ptrdiff_t>((row - from) * width);
        };
        if (kept_from < kept_end)
            std::copy(pixels_.begin() + at(kept_from, first_), pixels_.begin() + at(kept_end, first_),
                      pixels.begin() + at(kept_from, first));
        const auto read = [&](std::size_t from, std::size_t to) {
            picture_.for_each_piece(from, to, [&](std::size_t begin, std::span<const glm::vec3> radiance) {
                std::copy(radiance.begin(), radiance.end(), pixels.begin() + at(begin, first));
                for (std::size_t row = begin; row < begin + radiance.size() / width; ++row)
                    prepare(row, {pixels.data() + at(row, first), width});
            });
        };
        if (kept_from < kept_end) {
            read(first, kept_from);
            read(kept_end, end);
        } else {
            read(first, end);
        }
        pixels_ = std::move(pixels);
        first_ = first;
        end_ = end;
    }

    // Bilinear, for directions with z ≥ 0.
    glm::dvec3 interpolated(glm::dvec3 to) const {
        const double azimuth = to.x == 0.0 && to.y == 0.0 ? 0.0 : std::atan2(to.y, to.x);
        const double y = (0.5 * kPi - std::asin(std::clamp(to.z, 0.0, 1.0))) / picture_.pixel_height() - 0.5;
        const double x = (kPi - azimuth + picture_.rotation_rad()) / picture_.pixel_width() - 0.5;
        const double row = std::floor(y);
        const double half_turn = 0.5 * static_cast<double>(picture_.width());
        // Beyond the zenith the top row continues on the opposite side.
        const glm::dvec3 above =
            row < 0.0 ? in_row(0, x + half_turn) : in_row(static_cast<std::size_t>(row), x);
        return glm::mix(above, in_row(static_cast<std::size_t>(row + 1.0), x), y - row);
    }

  private:
    void prepare(std::size_t row, std::span<glm::dvec3> pixels) const {
        const std::size_t start = row * pixels.size();
        for (auto at = std::lower_bound(filled_.begin(), filled_.end(), start,
                                        [](const Filled&f, std::size_t pixel) { return f.pixel < pixel; });
             at != filled_.end() && at->pixel < start + pixels.size(); ++at)
            pixels[at->pixel - start] = at->radiance;
        const auto [low, high] = picture_.edges(row);
        const double reach =
            0.5 * picture_.pixel_height() / (picture_.pixel_width() * std::cos(0.5 * (low + high)));
        if (reach > 0.5) widen(pixels, std::min(reach, 0.5 * static_cast<double>(pixels.size())));
    }

    glm::dvec3 in_row(std::size_t row, double x) const {
        const double left = std::floor(x);
        const glm::dvec3* pixels = &pixels_[(std::min(row, picture_.rows() - 1) - first_) * picture_.width()];
        return glm::mix(pixels[wrapped(left)], pixels[wrapped(left + 1.0)], x - left);
    }

    std::size_t wrapped(double column) const {
        const auto n = static_cast<double>(picture_.width());
        return std::min(static_cast<std::size_t>(column - n * std::floor(column / n)), picture_.width() - 1);
    }

    // Replaces each pixel by the mean over `reach` columns to either side of its middle, from running sums.
    static void widen(std::span<glm::dvec3> pixels, double reach) {
        const std::size_t width = pixels.size();
        std::vector<glm::dvec3> sum(width + 1, glm::dvec3(0.0));
        for (std::size_t i = 0; i < width; ++i) sum[i + 1] = sum[i] + pixels[i];
        const auto up_to = [&](double x) {  // integral of the periodic row
            const double turns = std::floor(x / static_cast<double>(width));
            const double inside = x - turns * static_cast<double>(width);
            const std::size_t i = std::min(static_cast<std::size_t>(inside), width - 1);
            return turns * sum[width] + sum[i] + (inside - static_cast<double>(i)) * (sum[i + 1] - sum[i]);
        };
        std::vector<glm::dvec3> means(width);
        for (std::size_t i = 0; i < width; ++i) {
            const double middle = static_cast<double>(i) + 0.5;
            means[i] = glm::max((up_to(middle + reach) - up_to(middle - reach)) / (2.0 * reach), 0.0);
        }
        std::copy(means.begin(), means.end(), pixels.begin());
    }

    const Upper& picture_;
    const std::vector<Filled>& filled_;
    std::vector<glm::dvec3> pixels_;
    std::size_t first_ = 0, end_ = 0;
};

}  // namespace

Sky picture_sky(const LatLongRows& picture, int map_size) {
    check_size(picture.width, picture.height);
    // A texel at the horizon is 2 · extent/size wide, a pixel 2π/width.
    if (map_size == 0)
        map_size = static_cast<double>(kSkyMapExtent) / kPi * picture.width > 768.0 ? 1024 : 512;
    SkyMap::check_size(map_size);
    const Upper upper(picture);
    const Sun sun = find_sun(upper);

    Sky sky;
    if (const double length = glm::length(sun.moment); length > 0.0) {
        const glm::dvec3 direction = sun.moment / length;
        const double radius = static_cast<double>(sky.sun_angular_radius);
        sky.sun_direction = direction;
        sky.sun_irradiance = sun.irradiance;
        sky.sun_radiance = sun.irradiance / (kPi * radius * radius * direction.z);
    }
    HeldRows held(upper, sun.filled);
    SkyDome dome;
    dome.radiance = [&](glm::vec3 direction) { return glm::vec3(held.interpolated(glm::dvec3(direction))); };
    dome.samples = [&](glm::vec3, float angle) {
        return 1 + static_cast<int>(std::ceil(static_cast<double>(angle) / upper.pixel_height()));
    };
    // Rings of 50 MB, or of the pieces that the picture is stored in.
    constexpr std::size_t kPixelsInRing = std::size_t{1} << 21;
    const std::size_t rows_in_ring = std::max({std::size_t{1}, kPixelsInRing / upper.width(),
                                               static_cast<std::size_t>(std::max(1, picture.rows_in_piece))});
    dome.ring = static_cast<double>(rows_in_ring) * upper.pixel_height();
    dome.prepare = [&](double from_zenith, double to_zenith) {
        // Samples lie between the middles of two rows; one row more on each side, for rounding.
        const auto row = [&](double angle) { return std::floor(angle / upper.pixel_height() - 0.5); };
        const auto rows = static_cast<double>(upper.rows());
        held.hold(static_cast<std::size_t>(std::clamp(row(from_zenith) - 1.0, 0.0, rows - 1.0)),
                  static_cast<std::size_t>(std::clamp(row(to_zenith) + 3.0, 1.0, rows)));
    };
    const BakedSky baked = bake_sky_map(map_size, dome);
    sky.map = baked.map;
    sky.sky_irradiance = baked.irradiance;
    return sky;
}

Sky picture_sky(const LatLong& picture, int map_size) {
    check_size(picture.width, picture.height);
    const auto width = static_cast<std::size_t>(picture.width);
    if (picture.radiance.size() != width * static_cast<std::size_t>(picture.height))
        throw std::invalid_argument(std::to_string(picture.radiance.size()) + " pixels in a sky picture of " +
                                    std::to_string(picture.width) + " x " + std::to_string(picture.height));
    check_values(picture.radiance, width, 0);
    const auto read = [&](int first_row, std::span<glm::vec3> radiance) {
        const auto from = picture.radiance.begin() +
                          static_cast<std::ptrdiff_t>(width * static_cast<std::size_t>(first_row));
        std::copy_n(from, radiance.size(), radiance.begin());
    };
    return picture_sky({.width = picture.width, .height = picture.height, .rows_in_piece = 1, .read = read},
                       map_size);
}

}  // namespace pelagic
