#include "plugin/render/glare.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/common.hpp>
#include <limits>

#include "core/base/buffer.h"
#include "core/base/constants.h"
#include "core/plan/grid_layout.h"
#include "core/waves/transform.h"

namespace pelagic {
namespace {

// The next length that has no prime factors above 5, for which transforms are fast.
int fast_length(int least) {
    for (int n = least;; ++n) {
        int left = n;
        for (const int factor : {2, 3, 5})
            while (left % factor == 0) left /= factor;
        if (left == 1) return n;
    }
}

// A cyclic picture of complex numbers: a line's real parts, then its imaginary ones.
class Plane {
  public:
    Plane(int lines, int length)
        : lines_(lines),
          stride_(line_stride<float>(length)),
          values_(2 * stride_ * static_cast<std::size_t>(lines)) {}
    float* re(int line) { return values_.data() + 2 * stride_ * static_cast<std::size_t>(line); }
    float* im(int line) { return re(line) + stride_; }
    const float* re(int line) const { return values_.data() + 2 * stride_ * static_cast<std::size_t>(line); }
    const float* im(int line) const { return re(line) + stride_; }
    int lines() const { return lines_; }

  private:
    int lines_;
    std::size_t stride_;
    Buffer<float> values_;
};

// Squares, so that lines of both planes stay in the cache.
void transpose(const Plane& from, int length, Plane& to) {
    constexpr int kTile = 32;
    tbb::parallel_for(0, (length + kTile - 1) / kTile, [&](int tile) {
        const int first = tile * kTile, last = std::min(first + kTile, length);
        for (int y0 = 0; y0 < from.lines(); y0 += kTile)
            for (int x = first; x < last; ++x)
                for (int y = y0; y < std::min(y0 + kTile, from.lines()); ++y) {
                    to.re(x)[y] = from.re(y)[x];
                    to.im(x)[y] = from.im(y)[x];
                }
    });
}

// Two-dimensional transforms of planes of one size, by lines.
class Transforms {
  public:
    explicit Transforms(glm::ivec2 size)
        : size_(size), along_x_(size.x), along_y_(size.y), rows_(size.y, size.x), columns_(size.x, size.y) {}

    // Takes rows, of which those from `filled` on are 0, and leaves columns.
    void rows_to_columns(Plane& rows, int filled, Plane& columns) {
        tbb::parallel_for(0, size_.y, [&](int y) {
            if (y < filled)
                along_x_.execute(rows.re(y), rows_.re(y));
            else
                std::fill_n(rows_.re(y), 2 * line_stride<float>(size_.x), 0.0f);
        });
        transpose(rows_, size_.x, columns_);
        tbb::parallel_for(0, size_.x, [&](int x) { along_y_.execute(columns_.re(x), columns.re(x)); });
    }
    void columns_to_rows(Plane& columns, Plane& rows) {
        tbb::parallel_for(0, size_.x, [&](int x) { along_y_.execute(columns.re(x), columns_.re(x)); });
        transpose(columns_, size_.y, rows_);
        tbb::parallel_for(0, size_.y, [&](int y) { along_x_.execute(rows_.re(y), rows.re(y)); });
    }

  private:
    glm::ivec2 size_;
    LineTransform<float> along_x_, along_y_;
    Plane rows_, columns_;
};

// The share of the scattered light that falls so many pixels from where it belongs, to a factor: a mean over the pixel, finer where
// the density changes within it.
double falls_at(glm::dvec2 pixels, double pixel_tangent) {
    const double distance = std::hypot(pixels.x, pixels.y);
    const int n = distance < 1.5 ? 32 : distance < 8.0 ? 6 : 1;
    double sum = 0.0;
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const glm::dvec2 at = pixels + (glm::dvec2(i, j) + 0.5) / static_cast<double>(n) - 0.5;
            sum += glare_density(std::atan(std::hypot(at.x, at.y) * pixel_tangent) * (180.0 / kPi));
        }
    return sum / (n * n);
}

}  // namespace

double glare_density(double angle_deg) {
    const double from = angle_deg + 0.02;
    return 0.478 * 20.91 / (from * from * from) + 0.138 * 72.37 / (from * from);
}

ScatteredLight scattered_light(std::span<const glm::vec3> picture, glm::ivec2 size, double pixel_tangent) {
    const glm::ivec2 all(fast_length(2 * size.x), fast_length(2 * size.y));
    ScatteredLight out{.size = all, .light = {}};
    out.light.assign(static_cast<std::size_t>(all.x) * all.y, glm::vec3(0.0f));
    // Each colour's sums of millions of pixels stay in range, and its rounding is its own.
    glm::vec3 strongest(std::numeric_limits<float>::min());
    for (const glm::vec3& pixel : picture) strongest = glm::max(strongest, glm::abs(pixel));

    Transforms transforms(all);
    Plane rows(all.y, all.x), columns(all.x, all.y);
    // The spread is even, so that its transform is real, and it is the same to the left and right, above and below.
    std::vector<double> quarter(static_cast<std::size_t>(all.x / 2 + 1) * (all.y / 2 + 1));
    tbb::parallel_for(0, all.y / 2 + 1, [&](int y) {
        for (int x = 0; x <= all.x / 2; ++x)
            quarter[static_cast<std::size_t>(y) * (all.x / 2 + 1) + x] = falls_at({x, y}, pixel_tangent);
    });
    const auto spread_at = [&](int x, int y) {
        return quarter[static_cast<std::size_t>(std::min(y, all.y - y)) * (all.x / 2 + 1) +
                       std::min(x, all.x - x)];
    };
    double sum = 0.0;
    for (int y = 0; y < all.y; ++y)
        for (int x = 0; x < all.x; ++x) sum += spread_at(x, y);
    for (int y = 0; y < all.y; ++y)
        for (int x = 0; x < all.x; ++x) {
            rows.re(y)[x] = static_cast<float>(spread_at(x, y) / sum);
            rows.im(y)[x] = 0.0f;
        }
    transforms.rows_to_columns(rows, all.y, columns);
    std::vector<float> response(out.light.size());  // by column
    // A transform there and another of the same sign give the picture back, turned round, times their lengths.
    const double scale = 1.0 / (static_cast<double>(all.x) * all.y);
    for (int x = 0; x < all.x; ++x)
        for (int y = 0; y < all.y; ++y)
            response[static_cast<std::size_t>(x) * all.y + y] = static_cast<float>(columns.re(x)[y] * scale);

    // Two colours at a time, as real and imaginary parts.
    for (const int colour : {0, 2}) {
        const bool has_second = colour == 0;
        for (int y = 0; y < all.y; ++y) {
            std::fill_n(rows.re(y), all.x, 0.0f);
            std::fill_n(rows.im(y), all.x, 0.0f);
            if (y >= size.y) continue;
            for (int x = 0; x < size.x; ++x) {
                const glm::vec3& pixel = picture[static_cast<std::size_t>(y) * size.x + x];
                rows.re(y)[x] = pixel[colour] / strongest[colour];
                if (has_second) rows.im(y)[x] = pixel[colour + 1] / strongest[colour + 1];
            }
        }
        transforms.rows_to_columns(rows, size.y, columns);
        tbb::parallel_for(0, all.x, [&](int x) {
            for (int y = 0; y < all.y; ++y) {
                const float factor = response[static_cast<std::size_t>(x) * all.y + y];
                columns.re(x)[y] *= factor;
                columns.im(x)[y] *= factor;
            }
        });
        transforms.columns_to_rows(columns, rows);
        tbb::parallel_for(0, all.y, [&](int y) {
            const int turned_y = (all.y - y) % all.y;
            for (int x = 0; x < all.x; ++x) {
                const int turned_x = (all.x - x) % all.x;
                glm::vec3& to = out.light[static_cast<std::size_t>(y) * all.x + x];
                to[colour] = rows.re(turned_y)[turned_x] * strongest[colour];
                if (has_second) to[colour + 1] = rows.im(turned_y)[turned_x] * strongest[colour + 1];
            }
        });
    }
    return out;
}

void add_glare(std::span<glm::vec3> picture, glm::ivec2 size, const Glare& glare) {
    const ScatteredLight scattered = scattered_light(picture, size, glare.pixel_tangent);
    const auto share = static_cast<float>(glare.share);
    tbb::parallel_for(0, size.y, [&](int y) {
        for (int x = 0; x < size.x; ++x) {
            glm::vec3& pixel = picture[static_cast<std::size_t>(y) * size.x + x];
            const glm::vec3& here = scattered.light[static_cast<std::size_t>(y) * scattered.size.x + x];
            // Rounding, of a sun a million times as bright as the sky, reaches a bit below 0.
            for (int c = 0; c < 3; ++c)
                pixel[c] = (1.0f - share) * pixel[c] + share * std::max(here[c], 0.0f);
        }
    });
}

std::size_t glare_bytes(glm::ivec2 size) {
    const auto pixels =
        static_cast<std::size_t>(fast_length(2 * size.x)) * static_cast<std::size_t>(fast_length(2 * size.y));
    return pixels * (4 * 2 * sizeof(float) + sizeof(float) + sizeof(double) / 4 + sizeof(glm::vec3)) * 11 /
           10;
}

}  // namespace pelagic
