// The water's formulas (core/lighting/water.glsl) beside Monte Carlo programs that know only Fresnel, Snell, and what
// scatters and absorbs: `bench_water [transmission]`.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "core/base/constants.h"
#include "tests/bench/timing.h"
#include "tests/core/lighting/optics.h"

namespace pelagic::bench {
namespace {

constexpr double kDegree = kPi / 180.0;
constexpr double kIndex = 1.34;

class Lot {
  public:
    explicit Lot(std::uint64_t seed) : engine_(seed) {}
    double operator()() { return static_cast<double>(engine_() >> 11) * 0x1.0p-53; }

  private:
    std::mt19937_64 engine_;
};

// Unpolarised, by Snell's law; index: that beyond over that before the surface.
double fresnel(double cosine, double index) {
    const double sine2 = (1.0 - cosine * cosine) / (index * index);
    if (sine2 >= 1.0) return 1.0;
    const double beyond = std::sqrt(1.0 - sine2);
    const double across = (cosine - index * beyond) / (cosine + index * beyond);
    const double along = (index * cosine - beyond) / (index * cosine + beyond);
    return 0.5 * (across * across + along * along);
}

// ---- Light that enters a rough sea

// A periodic Gaussian surface of triangles, a sum of plane waves with as much slope in each octave; heights in cells,
// scaled so that the triangles' slopes have the deviation `sigma` on either axis.
class RoughSea {
  public:
    RoughSea(double shortest, double longest, double sigma, std::uint64_t seed) : heights_(kSide * kSide) {
        Lot lot(seed);
        constexpr int kWaves = 240;
        for (int wave = 0; wave < kWaves; ++wave) {
            const double length = longest * std::pow(shortest / longest, (wave + lot()) / kWaves);
            const double round = kTwoPi * lot();
            const double kx = std::round(kSide / length * std::cos(round)),
                         ky = std::round(kSide / length * std::sin(round));
            const double k = std::hypot(kx, ky);
            if (k == 0.0) continue;
            const double phase = kTwoPi * lot(), step = kTwoPi * kx / kSide;
            for (int y = 0; y < kSide; ++y) {
                const double start = phase + kTwoPi * ky * y / kSide;
                double re = std::cos(start) / k, im = std::sin(start) / k;
                for (int x = 0; x < kSide; ++x) {
                    at(x, y) += re;
                    const double next = re * std::cos(step) - im * std::sin(step);
                    im = re * std::sin(step) + im * std::cos(step);
                    re = next;
                }
            }
        }
        double slopes2 = 0.0;
        for (int y = 0; y < kSide; ++y)
            for (int x = 0; x < kSide; ++x) {
                const double gx = at(x + 1, y) - at(x, y), gy = at(x, y + 1) - at(x, y);
                slopes2 += gx * gx + gy * gy;
            }
        const double scale = sigma / std::sqrt(0.5 * slopes2 / (kSide * kSide));
        for (double& height : heights_) height *= scale;
        const auto [least, most] = std::ranges::minmax_element(heights_);
        bottom_ = *least;
        top_ = *most;
    }

    // The part of the sun's light that some facet lets in, at its first or a later one.
    double entering(double sun, Lot& lot) const {
        const double round = kTwoPi * lot();
        glm::dvec3 to(-std::cos(sun) * std::cos(round), -std::cos(sun) * std::sin(round), -std::sin(sun));
        glm::dvec3 from(kSide * lot(), kSide * lot(), top_);
        double left = 1.0, entered = 0.0;
        glm::dvec3 normal;
        while (left > 1e-4 && meets(from, to, normal)) {
            const double cosine = -glm::dot(to, normal), reflected = fresnel(cosine, kIndex);
            entered += left * (1.0 - reflected);
            left *= reflected;
            to += 2.0 * cosine * normal;
        }
        return entered;
    }

  private:
    static constexpr int kSide = 512;

    static int wrapped(int i) { return i & (kSide - 1); }
    double at(int x, int y) const {
        return heights_[static_cast<std::size_t>(wrapped(y) * kSide + wrapped(x))];
    }
    double& at(int x, int y) { return heights_[static_cast<std::size_t>(wrapped(y) * kSide + wrapped(x))]; }

    // Moves `from` to the first facet that the ray meets from above. Cell by cell; two triangles each.
    bool meets(glm::dvec3& from, glm::dvec3 to, glm::dvec3& normal) const {
        int x = static_cast<int>(std::floor(from.x)), y = static_cast<int>(std::floor(from.y));
        const int right = to.x > 0.0 ? 1 : -1, up = to.y > 0.0 ? 1 : -1;
        const double each_x = 1.0 / std::max(std::abs(to.x), 1e-12),
                     each_y = 1.0 / std::max(std::abs(to.y), 1e-12);
        double next_x = (right > 0 ? x + 1 - from.x : from.x - x) * each_x,
               next_y = (up > 0 ? y + 1 - from.y : from.y - y) * each_y, gone = 0.0;
        while (true) {
            const double end = std::min(next_x, next_y);
            const double h00 = at(x, y), h10 = at(x + 1, y), h01 = at(x, y + 1), h11 = at(x + 1, y + 1);
            const double highest = std::max(std::max(h00, h10), std::max(h01, h11));
            if (from.z + std::min(gone * to.z, end * to.z) <= highest) {
                double nearest = 1e300;
                for (const bool far : {false, true}) {
                    const double gx = far ? h11 - h01 : h10 - h00, gy = far ? h11 - h10 : h01 - h00;
                    const double falls = to.z - gx * to.x - gy * to.y;
                    if (falls >= 0.0) continue;
                    const double u = from.x - x, v = from.y - y;
                    const double plane = far ? h11 + gx * (u - 1.0) + gy * (v - 1.0) : h00 + gx * u + gy * v;
                    const double t = (plane - from.z) / falls;
                    const double side = u + v + t * (to.x + to.y) - 1.0;
                    if (t < gone - kSlack || t > end + kSlack || (far ? side < -kSlack : side > kSlack))
                        continue;
                    if (t >= nearest) continue;
                    nearest = t;
                    normal = glm::normalize(glm::dvec3(-gx, -gy, 1.0));
                }
                if (nearest < 1e300) {
                    from += nearest * to;
                    return true;
                }
            }
            gone = end;
            const double height = from.z + gone * to.z;
            if (height > top_ ? to.z >= 0.0 : height < bottom_ - 1.0) return false;
            if (next_x < next_y) {
                x += right;
                next_x += each_x;
            } else {
                y += up;
                next_y += each_y;
            }
        }
    }

    static constexpr double kSlack = 1e-9;
    std::vector<double> heights_;
    double bottom_ = 0.0, top_ = 0.0;
};

struct Worst {
    double any = 0.0, from_5 = 0.0, noise = 0.0;
};

Worst transmission(const char* waves, double shortest, double longest) {
    constexpr std::array kSuns{2.0, 5.0, 10.0, 20.0, 45.0, 90.0};
    constexpr int kSeas = 16, kRays = 2000;
    optics::Optics shading;
    Worst worst;
    std::printf("  waves over %s; suns 2, 5, 10, 20, 45, 90°\n", waves);
    for (const double sigma : {0.0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3}) {
        std::array<std::array<double, kSuns.size()>, kSeas> found{};
        tbb::parallel_for(0, kSeas, [&](int sea) {
            const RoughSea surface(shortest, longest, sigma, static_cast<std::uint64_t>(1 + sea));
            Lot lot(static_cast<std::uint64_t>(1000 + sea));
            for (std::size_t i = 0; i < kSuns.size(); ++i) {
                double sum = 0.0;
                for (int ray = 0; ray < kRays; ++ray) sum += surface.entering(kSuns[i] * kDegree, lot);
                found[static_cast<std::size_t>(sea)][i] = sum / kRays;
            }
        });
        std::printf("    σ %.2f: ", sigma);
        for (std::size_t i = 0; i < kSuns.size(); ++i) {
            double mean = 0.0, square = 0.0;
            for (const auto& one : found) {
                mean += one[i] / kSeas;
                square += one[i] * one[i] / kSeas;
            }
            const double elevation = kSuns[i] * kDegree, variance = std::max(sigma * sigma, 1e-10);
            const double said = static_cast<double>(
                shading.entering(glm::vec3(glm::dvec3(std::cos(elevation), 0.0, std::sin(elevation))),
                                 glm::vec3(glm::dvec3(variance, variance, 0.0))));
            const double error = said - mean;
            worst.any = std::max(worst.any, std::abs(error));
            if (kSuns[i] >= 5.0) worst.from_5 = std::max(worst.from_5, std::abs(error));
            worst.noise = std::max(worst.noise, std::sqrt(std::max(0.0, square - mean * mean) / (kSeas - 1)));
            std::printf("  %.3f %+.3f", mean, error);
        }
        std::printf("\n");
    }
    return worst;
}

void transmission() {
    std::printf(
        "Sunlight that enters a rough sea: the traced part, and entering() less it; σ on either axis\n");
    for (const bool narrow : {false, true}) {
        const Worst worst =
            narrow ? transmission("one octave", 8.0, 16.0) : transmission("five octaves", 8.0, 256.0);
        std::printf("    worst %.4f (0.035: %s), from 5° %.4f (0.015: %s); standard error ≤ %.4f\n",
                    worst.any, verdict(worst.any <= 0.035), worst.from_5, verdict(worst.from_5 <= 0.015),
                    worst.noise);
    }
}

}  // namespace
}  // namespace pelagic::bench

int main(int argc, char** argv) {
    using Table = std::pair<std::string, void (*)()>;
    const std::vector<Table> tables{{"transmission", pelagic::bench::transmission}};
    for (const auto& [name, print] : tables) {
        const bool asked =
            argc < 2 || std::any_of(argv + 1, argv + argc, [&](const char* said) { return name == said; });
        if (asked) print();
    }
}
