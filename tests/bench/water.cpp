// The water's formulas (core/lighting/water.glsl) beside Monte Carlo programs that know only Fresnel, Snell, and what
// scatters and absorbs: `bench_water [transmission] [column] [furnace] [crest] [caustics]`, without an argument all of them.
// scatters and absorbs: `bench_water [transmission] [column] [furnace] [crest] [below]`, without an argument all of them.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "core/base/constants.h"
#include "core/evaluate/evaluate.h"
#include "core/lighting/floor.h"
#include "core/lighting/water.h"
#include "core/plan/plan.h"
#include "core/waves/sea.h"
#include "pelagic/scene.h"
#include "plugin/light/light.h"
#include "plugin/render/floor_light.h"
#include "tests/bench/lots.h"
#include "tests/bench/timing.h"
#include "tests/core/lighting/optics.h"

namespace pelagic::bench {
namespace {

constexpr double kDegree = kPi / 180.0;
constexpr double kIndex = 1.34;

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

// ---- Light in the water

// Fournier and Forand's phase function in Mobley's form (2002), particles of index 1.10 and slope 3.5835: backscatters
// 0.018. What it scatters by less than 2° counts as not scattered.
class Particles {
  public:
    Particles() {
        std::vector<double> sum{0.0};
        for (int i = 0; i <= kFine; ++i) density_.push_back(whole(half_sine2(i)));
        for (int i = 1; i <= kFine; ++i)
            sum.push_back(sum.back() + 2.0 * kTwoPi * 0.5 * (density_[i - 1] + density_[i]) *
                                           (half_sine2(i) - half_sine2(i - 1)));
        part = sum.back();
        for (double& density : density_) density /= part;
        for (int i = 0, k = 1; i <= kSteps; ++i) {
            const double wanted = part * i / kSteps;
            while (k < kFine && sum[k] < wanted) ++k;
            const double between = std::clamp((wanted - sum[k - 1]) / (sum[k] - sum[k - 1]), 0.0, 1.0);
            cosines_.push_back(1.0 - 2.0 * std::lerp(half_sine2(k - 1), half_sine2(k), between));
        }
    }
    double operator()(double cosine) const {
        const double place = (1.0 + std::log(std::max(0.5 * (1.0 - cosine), 1e-30)) / kRange) * kFine;
        if (place <= 0.0) return 0.0;
        const int i = std::min(static_cast<int>(place), kFine - 1);
        return std::lerp(density_[i], density_[i + 1], place - i);
    }
    double cosine(double lot) const {
        const int i = std::min(static_cast<int>(lot * kSteps), kSteps - 1);
        return std::lerp(cosines_[i], cosines_[i + 1], lot * kSteps - i);
    }

    // The mean over azimuths between directions of that cosine and others, which has no peaks; by the others' angle from the vertical.
    std::vector<double> over_azimuths(double cosine) const {
        constexpr int kAzimuths = 600;
        const double sine = std::sqrt(1.0 - cosine * cosine);
        std::vector<double> mean(kAngles + 1, 0.0);
        for (int i = 0; i <= kAngles; ++i)
            for (int k = 0; k < kAzimuths; ++k) {
                const double x = (k + 0.5) / kAzimuths, angle = kPi * i / kAngles;
                mean[i] +=
                    3.0 * x * x / kAzimuths *
                    (*this)(std::cos(angle) * cosine + std::sin(angle) * sine * std::cos(kPi * x * x * x));
            }
        return mean;
    }
    static double at(const std::vector<double>& mean, double cosine) {
        const double place = std::acos(std::clamp(cosine, -1.0, 1.0)) / kPi * kAngles;
        const int i = std::min(static_cast<int>(place), kAngles - 1);
        return std::lerp(mean[i], mean[i + 1], place - i);
    }

    double part = 0.0;  // of what is scattered

  private:
    static constexpr int kAngles = 2000;
    static constexpr int kFine = 1 << 13, kSteps = 1 << 14;
    static constexpr double kRange = 8.0966;  // −ln sin² of half of 2°
    static double half_sine2(int i) { return std::exp(kRange * (static_cast<double>(i) / kFine - 1.0)); }
    static double whole(double half_sine2) {
        constexpr double kN = 1.10, kSlope = 3.5835, kNu = 0.5 * (3.0 - kSlope);
        const double delta = 4.0 / (3.0 * (kN - 1.0) * (kN - 1.0)) * half_sine2, power = std::pow(delta, kNu);
        const double back = 4.0 / (3.0 * (kN - 1.0) * (kN - 1.0)), back_power = std::pow(back, kNu);
        const double cosine = 1.0 - 2.0 * half_sine2;
        return (kNu * (1.0 - delta) - (1.0 - power) +
                (delta * (1.0 - power) - kNu * (1.0 - delta)) / half_sine2) /
                   (4.0 * kPi * (1.0 - delta) * (1.0 - delta) * power) +
               (1.0 - back_power) / (16.0 * kPi * (back - 1.0) * back_power) * (3.0 * cosine * cosine - 1.0);
    }

    std::vector<double> density_, cosines_;
};

// Water at one wavelength.
class Medium {
  public:
    Medium(double absorption, double backscatter, double wavelength_nm)
        : water_(0.00288 * std::pow(wavelength_nm / 500.0, -4.32)),
          particles_((backscatter - 0.5 * water_) / 0.018 * of_particles().part),
          extinction(absorption + water_ + particles_),
          albedo((water_ + particles_) / extinction) {}

    double phase(double cosine) const {
        return (water_ * 0.06225 * (1.0 + 0.835 * cosine * cosine) + particles_ * of_particles()(cosine)) /
               (water_ + particles_);
    }
    // Of directions of that cosine and of one of which over_azimuths() is given.
    double phase(double cosine, double other, const std::vector<double>& mean) const {
        const double cosine2 =
            cosine * cosine * other * other + 0.5 * (1.0 - cosine * cosine) * (1.0 - other * other);
        return (water_ * 0.06225 * (1.0 + 0.835 * cosine2) + particles_ * Particles::at(mean, cosine)) /
               (water_ + particles_);
    }
    glm::dvec3 scattered(glm::dvec3 direction, Lot& lot) const {
        double cosine;
        if (lot() * (water_ + particles_) < particles_) {
            cosine = of_particles().cosine(lot());
        } else {
            do cosine = 2.0 * lot() - 1.0;
            while (lot() * 1.835 > 1.0 + 0.835 * cosine * cosine);
        }
        return turned(direction, cosine, kTwoPi * lot());
    }

    static const Particles& of_particles() {
        static const Particles particles;
        return particles;
    }

  private:
    double water_, particles_;

  public:
    double extinction, albedo;  // [1/m]; of one collision
};

struct NamedWater {
    const char* name;
    WaterBands absorption, backscatter;
};

constexpr std::size_t kFittedWaters = 5;

std::vector<NamedWater> waters() {
    std::vector<NamedWater> all;
    for (const auto& [name, type, chlorophyll] :
         {std::tuple{"ocean, C 0.1", WaterType::Ocean, 0.1},
          std::tuple{"jerlov-II", WaterType::JerlovII, 0.1},
          std::tuple{"coastal, C 1", WaterType::Coastal, 1.0},
          std::tuple{"jerlov-3C", WaterType::Jerlov3C, 0.1},
          std::tuple{"jerlov-5C", WaterType::Jerlov5C, 0.1}, std::tuple{"jerlov-I", WaterType::JerlovI, 0.1},
          std::tuple{"turbid, C 5", WaterType::Turbid, 5.0},
          std::tuple{"jerlov-9C", WaterType::Jerlov9C, 0.1},
          // The formulas' constants are fitted to those before.
          std::tuple{"jerlov-III", WaterType::JerlovIII, 0.1},
          std::tuple{"jerlov-7C", WaterType::Jerlov7C, 0.1}}) {
        Scene scene;
        scene.water.body = true;
        scene.water.type = type;
        scene.water.chlorophyll_mg_m3 = chlorophyll;
        const WaterBody body = make_water(scene);
        all.push_back({name, body.absorption, body.backscatter});
    }
    return all;
}

constexpr std::array kBands_nm{440.0, 480.0, 520.0, 555.0, 590.0, 630.0};

double of_band(const WaterBands& bands, std::size_t i) {
    const int place = static_cast<int>(i % 3);
    return static_cast<double>(i < 3 ? bands.shorter[place] : bands.longer[place]);
}

double refracted(double cosine) {
    return std::sqrt(1.0 - (1.0 - cosine * cosine) / (kIndex * kIndex));
}

// ---- A column over a floor

constexpr std::array kColumnSuns{60.0, 30.0, 15.0};
constexpr std::array kViews{0.0, 40.0, 75.0};
constexpr std::array kDepths{0.5, 2.0, 5.0, 20.0, 100.0, 1e7};
constexpr std::array kFloors{0.0, 0.3, 0.8};
constexpr std::size_t kLights = kColumnSuns.size() + 1;  // the last one: a uniform sky
constexpr std::size_t kMostBounces = 16;

// By light and by how often it met the floor: radiance just below a level surface over the irradiance that enters there.
using ColumnLight = std::array<std::array<double, kMostBounces>, kLights>;

// Backwards from an eye that looks down at this angle in the air; azimuths averaged.
ColumnLight column(const Medium& medium, double depth, double view, int paths, Lot& lot) {
    ColumnLight sum{};
    static const auto kAround = [] {
        std::array<std::vector<double>, kColumnSuns.size()> all;
        for (std::size_t i = 0; i < all.size(); ++i)
            all[i] = Medium::of_particles().over_azimuths(refracted(std::sin(kColumnSuns[i] * kDegree)));
        return all;
    }();
    const double c = medium.extinction;
    const double start = refracted(std::cos(view)), open = std::exp(-c * depth / start);
    const double to_floor = open < 1e-12 ? 0.0 : std::clamp(open, 0.1, 0.7);
    // Light that comes down directly: its cosine, and its weight.
    const auto light_from = [&](std::size_t light, double& cosine) {
        if (light < kColumnSuns.size()) {
            cosine = refracted(std::sin(kColumnSuns[light] * kDegree));
            return 1.0;
        }
        constexpr double kReflected = 0.06751;  // of a uniform sky
        const double outside = std::sqrt(1.0 - lot());
        cosine = refracted(outside);
        return (1.0 - fresnel(outside, kIndex)) / (1.0 - kReflected);
    };
    for (int path = 0; path < paths; ++path) {
        glm::dvec3 to(std::sqrt(1.0 - start * start), 0.0, -start);
        double height = 0.0, weight = 1.0;
        std::size_t bounces = 0;
        // The first flight is drawn so that thin and thick water are alike.
        const bool falls = lot() < to_floor;
        weight = falls ? open / to_floor : (1.0 - open) / (1.0 - to_floor);
        double flight = falls ? 1e300 : -std::log(1.0 - lot() * (1.0 - open)) / c;
        while (true) {
            const double next = height + flight * to.z;
            if (to.z < 0.0 && (next < -depth || flight > 1e299)) {
                height = -depth;
                if (++bounces == kMostBounces) break;
                for (std::size_t light = 0; light < kLights; ++light) {
                    double cosine;
                    const double part = light_from(light, cosine);
                    sum[light][bounces] += weight * part / kPi * std::exp(-c * depth / cosine);
                }
                to = turned({0.0, 0.0, 1.0}, std::sqrt(1.0 - lot()), kTwoPi * lot());
            } else if (to.z > 0.0 && next > 0.0) {
                height = 0.0;
                weight *= fresnel(to.z, 1.0 / kIndex);
                to.z = -to.z;
            } else {
                height = next;
                weight *= medium.albedo;
                for (std::size_t light = 0; light < kLights; ++light) {
                    double cosine;
                    double part = light_from(light, cosine);
                    if (light < kColumnSuns.size()) {
                        part *= medium.phase(to.z, cosine, kAround[light]);
                    } else {
                        const double sine = std::sqrt(1.0 - cosine * cosine);
                        part *= medium.phase(to.z * cosine +
                                             std::hypot(to.x, to.y) * sine * std::cos(kTwoPi * lot()));
                    }
                    sum[light][bounces] += weight * part / cosine * std::exp(c * height / cosine);
                }
                to = medium.scattered(to, lot);
            }
            if (weight < 0.02) {
                if (lot() > 0.1) break;
                weight *= 10.0;
            }
            flight = -std::log(1.0 - lot()) / c;
        }
    }
    for (auto& light : sum)
        for (double& part : light) part /= paths;
    return sum;
}

struct Errors {
    double square = 0.0, worst = 0.0, noise = 0.0;
    int count = 0;
    void add(double error, double deviation) {
        square += error * error;
        noise += deviation * deviation;
        if (std::abs(error) > std::abs(worst)) worst = error;
        ++count;
    }
    double rms() const { return std::sqrt(square / std::max(count, 1)); }
    double rms_noise() const { return std::sqrt(noise / std::max(count, 1)); }
};

void columns() {
    constexpr int kBatches = 8, kPaths = 4000;
    const std::vector<NamedWater> all = waters();
    struct Row {
        std::size_t water, band, depth, view;
        std::array<ColumnLight, kBatches> found;
    };
    std::vector<Row> rows;
    for (std::size_t water = 0; water < all.size(); ++water)
        for (std::size_t band = 0; band < kBands_nm.size(); ++band)
            for (std::size_t depth = 0; depth < kDepths.size(); ++depth)
                for (std::size_t view = 0; view < kViews.size(); ++view)
                    rows.push_back({water, band, depth, view, {}});
    tbb::parallel_for(std::size_t{0}, rows.size(), [&](std::size_t i) {
        Row& row = rows[i];
        const NamedWater& water = all[row.water];
        const Medium medium(of_band(water.absorption, row.band), of_band(water.backscatter, row.band),
                            kBands_nm[row.band]);
        Lot lot(1 + i);
        for (ColumnLight& one : row.found)
            one = column(medium, kDepths[row.depth], kViews[row.view] * kDegree, kPaths, lot);
    });

    std::vector<std::array<Errors, kDepths.size()>> by_depth(all.size() * kFloors.size());
    std::array<std::array<std::array<Errors, kLights>, kViews.size()>, 2>
        by_view{};  // of deep water, and with a floor
    Errors sun, sky, sun_other, sky_other;
    optics::Optics shading;
    for (const Row& row : rows)
        for (std::size_t light = 0; light < kLights; ++light)
            for (std::size_t floor = 0; floor < kFloors.size(); ++floor) {
                const bool deep = kDepths[row.depth] > 1e6;
                if (deep && floor > 0) continue;
                double mean = 0.0, square = 0.0;
                for (const ColumnLight& found : row.found) {
                    double one = 0.0;
                    for (std::size_t k = kMostBounces; k-- > 0;) one = one * kFloors[floor] + found[light][k];
                    mean += one / kBatches;
                    square += one * one / kBatches;
                }
                optics::Optics::WaterWay way{};
                const bool is_sky = light == kColumnSuns.size();
                way.sun = is_sky
                              ? 1.0f
                              : static_cast<float>(1.0 / refracted(std::sin(kColumnSuns[light] * kDegree)));
                way.eye = static_cast<float>(1.0 / refracted(std::cos(kViews[row.view] * kDegree)));
                way.returned = 1.0f - shading.entering_from_sky(glm::vec3(0.0f)) / (1.34f * 1.34f);
                way.floor_m = static_cast<float>(kDepths[row.depth]);
                const NamedWater& water = all[row.water];
                const bool shorter = row.band < 3;
                const auto back =
                    shading.water_back(shorter ? water.absorption.shorter : water.absorption.longer,
                                       shorter ? water.backscatter.shorter : water.backscatter.longer,
                                       shorter ? shading.kOwnShorter : shading.kOwnLonger,
                                       glm::vec3(static_cast<float>(kFloors[floor])), way);
                const double said =
                    static_cast<double>((is_sky ? back.sky : back.sun)[static_cast<int>(row.band % 3)]);
                const double error = said / mean - 1.0,
                             noise = std::sqrt(std::max(0.0, square - mean * mean) / (kBatches - 1)) / mean;
                const bool is_fitted = row.water < kFittedWaters;
                (is_fitted ? is_sky ? sky : sun : is_sky ? sky_other : sun_other).add(error, noise);
                by_view[deep ? 0 : 1][row.view][light].add(error, noise);
                if (!is_sky) by_depth[row.water * kFloors.size() + floor][row.depth].add(error, noise);
            }
    std::printf(
        "Radiance below the surface over the irradiance that enters: water_back() over the traced one, rms [worst], %%\n"
        "  suns 60, 30, 15°, views 0, 40, 75° in the air, six wavelengths; depths 0.5, 2, 5, 20, 100 m, and deep\n");
    for (std::size_t water = 0; water < all.size(); ++water)
        for (std::size_t floor = 0; floor < kFloors.size(); ++floor) {
            std::printf("    %-13s floor %.1f: ", all[water].name, kFloors[floor]);
            for (const Errors& of : by_depth[water * kFloors.size() + floor])
                if (of.count > 0) std::printf("  %4.1f [%+5.1f]", 100.0 * of.rms(), 100.0 * of.worst);
            std::printf("\n");
        }
    for (const bool floors : {false, true}) {
        std::printf("  %s, by view; suns 60, 30, 15°, and a uniform sky\n", floors ? "over a floor" : "deep");
        for (std::size_t view = 0; view < kViews.size(); ++view) {
            std::printf("    %2.0f°: ", kViews[view]);
            for (const Errors& of : by_view[floors][view])
                std::printf("  %4.1f [%+5.1f]", 100.0 * of.rms(), 100.0 * of.worst);
            std::printf("\n");
        }
    }
    for (const bool fitted : {true, false}) {
        const Errors &suns = fitted ? sun : sun_other, &skies = fitted ? sky : sky_other;
        std::printf(
            "    %s, suns: rms %.1f %% (4: %s), worst %+.1f %% (12: %s); sky: rms %.1f, worst %+.1f %%; noise %.2f %%\n",
            fitted ? "the first eight" : "the others", 100.0 * suns.rms(), verdict(suns.rms() <= 0.04),
            100.0 * suns.worst, verdict(std::abs(suns.worst) <= 0.12), 100.0 * skies.rms(),
            100.0 * skies.worst, 100.0 * suns.rms_noise());
    }
}

// ---- A furnace

// Under a uniform sky all of radiance 1, over a white floor and without absorption, everything shows 1.
void furnace(int lookups) {
    optics::Optics shading;
    shading.kSun = shading.kWhitecaps = false;
    shading.kSkyLookups = lookups;
    const bool is_shown = lookups == 1;
    if (is_shown)
        std::printf(
            "Water without absorption over a white floor under a uniform sky of 1, one lookup: radiance, least and most of\n"
            "  views 0 … 85°, by σ on either axis and b_b times depth\n"
            "      σ    bubbles |     0            0.001          0.01           0.1             1             10\n");
    double worst = 0.0, worst_clear = 0.0;
    for (const double sigma : {0.0, 0.05, 0.1, 0.2, 0.3})
        for (const double bubbles : {0.0, 1.0}) {
            if (is_shown) std::printf("    %.2f  %5.0f      |", sigma, bubbles);
            for (const double scatter : {1e-12, 1e-3, 1e-2, 0.1, 1.0, 10.0}) {
                double least = 1e9, most = 0.0;
                for (double view = 0.0; view <= 85.0; view += 5.0) {
                    const float variance = static_cast<float>(std::max(sigma * sigma, 1e-10));
                    optics::Optics::WaterLook look{};
                    const glm::vec3 white(1.0f), each(static_cast<float>(scatter / 5.0));
                    look.has_body = true;
                    look.backscatter = {each, each};
                    look.floor_colour = {white, white};
                    look.floor_m = 5.0f;
                    look.waves = glm::vec3(variance, variance, 0.0f);
                    look.bubbles = 1.0f;
                    look.bubbles_m = 1.0f;
                    optics::Optics::SeaLight light{};
                    light.sun_direction = glm::vec3(0.0f, 0.0f, 1.0f);
                    light.sky_irradiance = glm::vec3(static_cast<float>(kPi));
                    light.water = look;
                    const auto share = static_cast<float>(bubbles);
                    const auto terms = shading.sea_radiance(
                        glm::vec3(glm::dvec3(std::sin(view * kDegree), 0.0, std::cos(view * kDegree))),
                        glm::vec3(0.0f, 0.0f, 1.0f), look.waves, shading.no_foam(),
                        {glm::vec3(0.0f), 0.0f, glm::vec3(0.0f), 0.3f * share, 0.5f * share, 10.0f}, light);
                    const double seen = static_cast<double>(terms.sky.y + terms.sea.y);
                    least = std::min(least, seen);
                    most = std::max(most, seen);
                }
                worst = std::max({worst, most - 1.0, 1.0 - least});
                if (scatter < 1e-6) worst_clear = std::max({worst_clear, most - 1.0, 1.0 - least});
                if (is_shown) std::printf("  %.4f…%.4f", least, most);
            }
            if (is_shown) std::printf("\n");
        }
    std::printf(
        "    %d of the sky's lookups: off by up to %.1e in clear water (5e-3: %s), by %.1e where it scatters (%s)\n",
        lookups, worst_clear, verdict(worst_clear <= 5e-3), worst, verdict(worst <= 5e-3));
}

void furnaces() {
    furnace(1);
    furnace(9);
}

// ---- Light through crests

// Stokes' wave to third order, crests along y, at x = 0.
class SteepWave {
  public:
    SteepWave(double steepness, double wavelength_m) : length(wavelength_m), k(kTwoPi / wavelength_m) {
        const double s = steepness;
        for (int i = 0; i <= kPieces; ++i) {
            const double phase = kTwoPi * i / kPieces;
            heights_.push_back((s * std::cos(phase) + 0.5 * s * s * std::cos(2.0 * phase) +
                                0.375 * s * s * s * std::cos(3.0 * phase)) /
                               k);
            slopes_.push_back(-s * std::sin(phase) - s * s * std::sin(2.0 * phase) -
                              1.125 * s * s * s * std::sin(3.0 * phase));
            if (i == kPieces) continue;
            height2 += heights_.back() * heights_.back() / kPieces;
            slope2 += slopes_.back() * slopes_.back() / kPieces;
        }
        const auto [least, most] = std::ranges::minmax_element(heights_);
        trough = *least;
        crest = *most;
    }
    double height(double x) const { return at(heights_, x); }
    double slope(double x) const { return at(slopes_, x); }
    glm::dvec3 normal(double x) const { return glm::normalize(glm::dvec3(-slope(x), 0.0, 1.0)); }

    // How far a ray goes on its side of the surface, at most `most`. Below: starts in the water.
    double way(glm::dvec3 from, glm::dvec3 to, bool below, double most) const {
        const double side = below ? 1.0 : -1.0;
        const auto beyond = [&](double t) {
            const double z = from.z + t * to.z;
            return side * (z - height(from.x + t * to.x)) > 0.0;
        };
        const double edge = below ? trough : crest, other = below ? crest : trough;
        double t = 1e-6 * length;
        if (side * (from.z - edge) < 0.0) {
            if (side * to.z <= 0.0) return most;
            t = std::max(t, (edge - from.z) / to.z);
        }
        const double step = length / 64.0 / std::max(std::hypot(to.x, to.z), 1e-9);
        while (t < most) {
            const double z = from.z + t * to.z;
            if (side * (z - edge) < -1e-12 * length && side * to.z < 0.0) return most;
            if (side * (z - other) > 0.0) break;
            if (beyond(t + step)) break;
            t += step;
        }
        if (t >= most) return most;
        double open = t, shut = t + step;
        for (int i = 0; i < 40; ++i) {
            const double middle = 0.5 * (open + shut);
            (beyond(middle) ? shut : open) = middle;
        }
        return std::min(open, most);
    }

    double length, k, height2 = 0.0, slope2 = 0.0, trough = 0.0, crest = 0.0;

  private:
    static constexpr int kPieces = 2048;
    double at(const std::vector<double>& table, double x) const {
        const double place = (x / length - std::floor(x / length)) * kPieces;
        const auto i = std::min(static_cast<std::size_t>(place), std::size_t{kPieces - 1});
        return std::lerp(table[i], table[i + 1], place - static_cast<double>(i));
    }
    std::vector<double> heights_, slopes_;
};

glm::dvec3 into_water(glm::dvec3 to, glm::dvec3 normal) {
    const double cosine = -glm::dot(to, normal);
    return glm::normalize(to / kIndex + (cosine / kIndex - refracted(cosine)) * normal);
}

// The sun's rays below a steep wave, at even steps along it; per irradiance across the sun's beam.
class Beams {
  public:
    Beams(const SteepWave& wave, glm::dvec3 to_sun) : wave_(wave), exact_to_(-0.4 * wave.length) {
        for (int i = 0; i < kRays; ++i) {
            const double x = wave.length * i / kRays;
            Ray ray{{x, 0.0, wave.height(x)}, {}, 0.0};
            const glm::dvec3 normal = wave.normal(x);
            const double cosine = glm::dot(to_sun, normal);
            const glm::dvec3 above = ray.from + 1e-9 * wave.length * normal;
            if (cosine > 0.0 && !(wave.way(above, to_sun, false, 40.0 * wave.length) < 39.0 * wave.length)) {
                ray.to = into_water(-to_sun, normal);
                ray.flux = (1.0 - fresnel(cosine, kIndex)) * cosine / normal.z * wave.length / kRays;
                least_ = std::min(least_, -ray.to.x / ray.to.z);
                most_ = std::max(most_, -ray.to.x / ray.to.z);
                lit_.push_back(i);
            }
            rays_.push_back(ray);
        }
    }

    // Sunlight there over its beam's irradiance, times the phase function for light that goes on along −to; what is lost on its way included.
    double scattered(const Medium& medium, glm::dvec3 place, glm::dvec3 to, Lot& lot) const {
        if (lit_.empty()) return 0.0;
        if (place.z < exact_to_) {  // so deep that waves hardly matter: one ray, at any place
            const Ray& ray = rays_[lit_[static_cast<std::size_t>(lot() * static_cast<double>(lit_.size()))]];
            const double far = (place.z - ray.from.z) / ray.to.z;
            return static_cast<double>(lit_.size()) * ray.flux / wave_.length / -ray.to.z *
                   std::exp(-medium.extinction * far) * medium.phase(-glm::dot(ray.to, to));
        }
        double sum = 0.0;
        const double high = wave_.crest - place.z, low = std::max(wave_.trough - place.z, 0.0);
        const double each = wave_.length / kRays;
        const double first = place.x - std::max(most_ * high, most_ * low),
                     last = place.x - std::min(least_ * high, least_ * low);
        const int start = static_cast<int>(std::floor(first / each)) - 1,
                  end = static_cast<int>(std::ceil(last / each)) + 1;
        for (int i = start; i < end; ++i) {
            const Ray &one = rays_[wrapped(i)], &next = rays_[wrapped(i + 1)];
            if (!(one.flux > 0.0 && next.flux > 0.0)) continue;
            const double x = place.x - each * i, x_next = x - each;
            const double off = x * one.to.z - (place.z - one.from.z) * one.to.x,
                         off_next = x_next * next.to.z - (place.z - next.from.z) * next.to.x;
            if (off * off_next > 0.0 || off == off_next) continue;
            const double part = off / (off - off_next);
            const glm::dvec3 from(each * (i + part), 0.0, std::lerp(one.from.z, next.from.z, part));
            const glm::dvec3 way = glm::dvec3(place.x, 0.0, place.z) - from;
            const glm::dvec3 direction = glm::normalize(one.to + part * (next.to - one.to));
            const double far = glm::dot(way, direction);
            if (far <= 0.0) continue;
            bool leaves = false;
            for (int j = 1; j < 6 && !leaves; ++j) {
                const glm::dvec3 between = from + way * (j / 6.0);
                leaves = between.z > wave_.height(between.x) + 1e-6 * wave_.length;
            }
            if (leaves) continue;
            sum += std::lerp(one.flux, next.flux, part) / std::abs(off - off_next) *
                   std::exp(-medium.extinction * far) * medium.phase(-glm::dot(direction, to));
        }
        return sum;
    }

  private:
    struct Ray {
        glm::dvec3 from, to;
        double flux;
    };
    static constexpr int kRays = 256;
    static std::size_t wrapped(int i) { return static_cast<std::size_t>(i & (kRays - 1)); }

    const SteepWave& wave_;
    double exact_to_;
    std::vector<Ray> rays_;
    std::vector<std::size_t> lit_;
    double least_ = 1e9, most_ = -1e9;
};

struct CrestSun {
    double elevation_deg;
    bool is_before;
    glm::dvec3 to() const {
        const double e = elevation_deg * kDegree;
        return {(is_before ? 1.0 : -1.0) * std::cos(e), 0.0, std::sin(e)};
    }
};
constexpr std::array<CrestSun, 6> kCrestSuns{
    {{5.0, true}, {15.0, true}, {35.0, true}, {5.0, false}, {15.0, false}, {35.0, false}}};
using CrestValues = std::array<double, kCrestSuns.size()>;

// Radiance that comes up to a place just below the surface, against `to`, by sun.
CrestValues below(const SteepWave& wave, const std::vector<Beams>& beams, const Medium& medium,
                  glm::dvec3 place, glm::dvec3 to, int paths, Lot& lot) {
    CrestValues sum{};
    for (int path = 0; path < paths; ++path) {
        glm::dvec3 at = place, along = to;
        double weight = 1.0;
        for (int first = 1;; first = 0) {
            const double drawn = first ? (path + lot()) / paths : lot();
            const double flight = std::min(-std::log(1.0 - drawn) / medium.extinction, 1e6);
            const double open = wave.way(at, along, true, flight);
            at += open * along;
            if (open < flight) {
                const glm::dvec3 normal = wave.normal(at.x);
                const double cosine = glm::dot(along, normal);
                if (cosine <= 0.0) break;
                weight *= fresnel(cosine, 1.0 / kIndex);
                along -= 2.0 * cosine * normal;
                at.z = std::min(at.z, wave.height(at.x) - 1e-9 * wave.length);
            } else {
                weight *= medium.albedo;
                for (std::size_t i = 0; i < beams.size(); ++i)
                    sum[i] += weight * beams[i].scattered(medium, at, along, lot) / paths;
                along = medium.scattered(along, lot);
            }
            if (weight < 0.05) {
                if (lot() > 0.2) break;
                weight *= 5.0;
            }
        }
    }
    return sum;
}

struct CrestPoint {
    double steepness, length_m;
    std::size_t water, band;
    double x, slope, height;       // what the eye sees there
    CrestValues traced{}, flat{};  // radiance above the surface before its transmission
    CrestValues noise{};           // of ln traced
    CrestValues said{}, without{}, level{};
};

constexpr double kEyeElevation = 5.0 * kDegree;
constexpr int kCrestPlaces = 10;

void crests() {
    constexpr int kPaths = 1500, kBatches = 4;
    const std::vector<NamedWater> every = waters();
    const std::vector<NamedWater> all{every[0], every[3]};
    constexpr std::array<std::size_t, 3> kSomeBands{0, 3, 5};
    std::vector<CrestPoint> points;
    const glm::dvec3 looks(std::cos(kEyeElevation), 0.0, -std::sin(kEyeElevation));
    for (std::size_t water = 0; water < all.size(); ++water)
        for (const std::size_t band : kSomeBands)
            for (const double length : {10.0, 40.0, 100.0})
                for (const double steepness : {0.2, 0.3, 0.4})
                    for (int i = 0; i < kCrestPlaces; ++i) {
                        const SteepWave wave(steepness, length);
                        const glm::dvec3 eye(length * (i + 0.5) / kCrestPlaces, 0.0, wave.crest + 1e-6);
                        const double x = eye.x + looks.x * wave.way(eye, looks, false, 1e9);
                        points.push_back({steepness, length, water, band, x, wave.slope(x), wave.height(x)});
                    }
    // The level sea's, by water and band.
    std::array<std::array<CrestValues, 6>, 2> level{};
    const auto medium_of = [&](std::size_t water, std::size_t band) {
        return Medium(of_band(all[water].absorption, band), of_band(all[water].backscatter, band),
                      kBands_nm[band]);
    };
    const auto trace = [&](const SteepWave& wave, double x, const Medium& medium, int count,
                           std::uint64_t seed) {
        std::vector<Beams> beams;
        for (const CrestSun& sun : kCrestSuns) beams.emplace_back(wave, sun.to());
        Lot lot(seed);
        const glm::dvec3 place(x, 0.0, wave.height(x) - 1e-9 * wave.length);
        CrestValues seen = below(wave, beams, medium, place, into_water(looks, wave.normal(x)), count, lot);
        for (double& value : seen) value /= kIndex * kIndex;
        return seen;
    };
    tbb::parallel_for(std::size_t{0}, points.size() + 6, [&](std::size_t i) {
        if (i < 6) {
            const std::size_t water = i / 3, band = kSomeBands[i % 3];
            level[water][band] = trace(SteepWave(0.0, 10.0), 0.0, medium_of(water, band), 60 * kPaths, i);
            return;
        }
        CrestPoint& point = points[i - 6];
        CrestValues square{};
        for (std::uint64_t batch = 0; batch < kBatches; ++batch) {
            const CrestValues one = trace(SteepWave(point.steepness, point.length_m), point.x,
                                          medium_of(point.water, point.band), kPaths, kBatches * i + batch);
            for (std::size_t sun = 0; sun < one.size(); ++sun) {
                point.traced[sun] += one[sun] / kBatches;
                square[sun] += one[sun] * one[sun] / kBatches;
            }
        }
        for (std::size_t sun = 0; sun < square.size(); ++sun)
            point.noise[sun] = std::sqrt(
                std::max(0.0, square[sun] / (point.traced[sun] * point.traced[sun]) - 1.0) / (kBatches - 1));
    });

    optics::Optics shading;
    for (CrestPoint& point : points) {
        point.flat = level[point.water][point.band];
        const SteepWave wave(point.steepness, point.length_m);
        optics::Optics::WaterLook look{};
        look.has_body = true;
        look.floor_m = 1e9f;
        // Only this wavelength comes back, in the channel that has the most of it.
        const glm::vec3 black(1e9f);
        const NamedWater& holds = all[point.water];
        look.absorption = {black, black};
        look.backscatter = {holds.backscatter.shorter, holds.backscatter.longer};
        const int place = static_cast<int>(point.band % 3), channel = point.band < 2   ? 2
                                                                      : point.band < 4 ? 1
                                                                                       : 0;
        (point.band < 3 ? look.absorption.shorter : look.absorption.longer)[place] =
            static_cast<float>(of_band(holds.absorption, point.band));
        look.crest_per_m = static_cast<float>(std::sqrt(wave.slope2 / wave.height2));
        const auto said = [&](const CrestSun& sun, bool is_level, float gain) {
            optics::Optics::WaterLook here = look;
            here.crest_light = gain;
            here.waves = is_level ? glm::vec3(1e-10f, 1e-10f, 0.0f)
                                  : glm::vec3(static_cast<float>(wave.slope2), 1e-10f, 0.0f);
            optics::Optics::SeenBody seen{};
            if (!is_level)
                seen.crest =
                    glm::vec3(static_cast<float>(point.slope), 0.0f, static_cast<float>(point.height));
            const glm::vec3 irradiance(static_cast<float>(sun.to().z));
            const glm::vec3 normal(glm::normalize(glm::dvec3(is_level ? 0.0 : -point.slope, 0.0, 1.0)));
            return static_cast<double>(shading.body_radiance(glm::vec3(-looks), normal, glm::vec3(sun.to()),
                                                             irradiance, glm::vec3(1.0f), glm::vec3(0.0f),
                                                             here, {}, glm::vec3(0.0f), seen)[channel]);
        };
        for (std::size_t i = 0; i < kCrestSuns.size(); ++i) {
            point.said[i] = said(kCrestSuns[i], false, 1.0f);
            point.without[i] = said(kCrestSuns[i], false, 0.0f);
            point.level[i] = said(kCrestSuns[i], true, 0.0f);
        }
    }

    const auto print = [&](const char* what,
                           const std::function<bool(const CrestPoint&, std::size_t)>& is_in) {
        std::printf("    %-22s", what);
        for (std::size_t i = 0; i < kCrestSuns.size(); ++i) {
            Errors with, without;
            double mean = 0.0, within = 0.0, seen = 0.0;
            for (const CrestPoint& point : points) {
                if (!is_in(point, i)) continue;
                const double traced = std::log(point.traced[i] / point.flat[i]);
                const double error = std::log(point.said[i] / point.level[i]) - traced;
                with.add(error, point.noise[i]);
                without.add(std::log(point.without[i] / point.level[i]) - traced, 0.0);
                mean += error;
                seen += traced;
                within += std::abs(error) <= 0.35 ? 1.0 : 0.0;
            }
            std::printf(" | %.2f; %.2f (%+.2f, %2.0f %%; %.2f)", std::exp(seen / with.count), with.rms(),
                        mean / with.count, 100.0 * within / with.count, without.rms());
        }
        std::printf("\n");
    };
    std::printf(
        "Light through crests: radiance before the surface's transmission over a level sea's; the traced one's mean, and\n"
        "body_radiance()'s error in ln: rms (mean, share within 0.35; rms without the crests' light)\n"
        "    suns before the eye at 5, 15, 35°, behind it at 5, 15, 35°\n");
    print("all", [](const CrestPoint&, std::size_t) { return true; });
    for (const double steepness : {0.2, 0.3, 0.4})
        print(("kA " + std::to_string(steepness).substr(0, 3)).c_str(),
              [&](const CrestPoint& point, std::size_t) { return point.steepness == steepness; });
    for (const double length : {10.0, 40.0, 100.0})
        print((std::to_string(static_cast<int>(length)) + " m").c_str(),
              [&](const CrestPoint& point, std::size_t) { return point.length_m == length; });
    for (std::size_t water = 0; water < all.size(); ++water)
        for (const std::size_t band : kSomeBands)
            print((std::string(all[water].name) + ", " + std::to_string(static_cast<int>(kBands_nm[band])))
                      .c_str(),
                  [&](const CrestPoint& point, std::size_t) {
                      return point.water == water && point.band == band;
                  });
    print("upper half, facing",
          [](const CrestPoint& point, std::size_t) { return point.height > 0.0 && point.slope > 0.0; });
    print("lower half, facing",
          [](const CrestPoint& point, std::size_t) { return point.height <= 0.0 && point.slope > 0.0; });
    print("more than a third",
          [](const CrestPoint& point, std::size_t sun) { return point.traced[sun] > point.flat[sun] / 3.0; });
    Errors noise;
    for (const CrestPoint& point : points)
        for (const double one : point.noise) noise.add(0.0, one);
    std::printf("    noise: rms %.2f in ln\n", noise.rms_noise());
}

// ---- The sun's light on the floor

void caustics() {
    std::printf(
        "The sun's light on a floor below a sea of 4 m/s and 2 km of fetch, over what a level sea lets fall there: mean and contrast of the\n"
        "finer and of the coarser map; the time beside that of 1 Mi places of the same frame, positions and normals\n");
    for (const double depth_m : {0.5, 2.5, 10.0, 20.0})
        for (const double elevation : {15.0, 30.0, 60.0, 85.0}) {
            Scene scene;
            scene.sea.wind_speed_mps = 4.0;
            scene.sea.fetch_m = 2e3;
            scene.sea.depth_m = depth_m;
            scene.water.type = WaterType::JerlovIB;
            const auto prepared = prepare(scene);
            const double finest_m = 0.01;
            const Query query = view_query(
                *prepared,
                {.products = {}, .finest_cell_m = finest_m, .finest_pixel_m = finest_m, .points = 1 << 20});
            const auto sea =
                std::make_shared<const Sea<float>>(make_plan(prepared, {query}, {.double_precision = false}));
            Frame<float> frame(sea);
            frame.set(3.0);
            FloorLightWanted wanted;
            wanted.view.position_m = {0.0, 0.0, 3.0};
            wanted.view.forward = {0.0, 0.0, -1.0};
            wanted.view.up = {0.0, 1.0, 0.0};
            wanted.water = make_water(scene, prepared->spectrum);
            const double e = elevation * kDegree;
            wanted.sun_direction = glm::vec3(glm::dvec3(std::cos(e), 0.0, std::sin(e)));
            wanted.sun_angular_radius = 0.00465f;
            wanted.finest_m = finest_m;
            Floor floor(depth_m);
            const auto begun = std::chrono::steady_clock::now();
            light_floor(floor, frame, wanted);
            const auto lit = std::chrono::steady_clock::now();
            std::vector<glm::vec2> rest(std::size_t{1} << 20);
            for (std::size_t i = 0; i < rest.size(); ++i)
                rest[i] = 0.02f * glm::vec2(static_cast<float>(i % 1024), static_cast<float>(i / 1024));
            std::vector<glm::vec3> position(rest.size()), normal(rest.size());
            Results<float> results;
            results.set(Product::Position, {position.data()});
            results.set(Product::Normal, {normal.data()});
            evaluate(frame, 0, Points<float>{.count = rest.size(), .rest_m = {rest.data()}}, results);
            const auto ended = std::chrono::steady_clock::now();
            std::printf("    %4.1f m, %2.0f°:", depth_m, elevation);
            const std::size_t count =
                static_cast<std::size_t>(wanted.side) * static_cast<std::size_t>(wanted.side);
            for (std::size_t map = 0; map < 2; ++map) {
                double sum = 0.0, squares = 0.0;
                for (std::size_t i = 0; i < count; ++i) {
                    const auto light = static_cast<double>(floor.values()[map * count + i]);
                    sum += light;
                    squares += light * light;
                }
                const double mean = sum / static_cast<double>(count);
                std::printf(" %.3f (%.2f)", mean,
                            std::sqrt(std::max(squares / static_cast<double>(count) - mean * mean, 0.0)));
            }
            std::printf("; %.1f times\n", std::chrono::duration<double>(lit - begun).count() /
                                              std::chrono::duration<double>(ended - lit).count());
        }
}

// ---- What an eye in deep water sees, below a level surface

constexpr std::array kBelowSuns{60.0, 20.0};
constexpr std::array kBelowViews{30.0, 60.0, 80.0, 90.0, 100.0, 120.0, 150.0, 180.0};  // from the zenith
constexpr std::array kBelowAzimuths{0.0, 90.0, 180.0};                                 // from the sun's
constexpr std::array kBelowDepths{0.5, 3.0, 12.0};
constexpr std::size_t kBelowLights = kBelowSuns.size() + 1;  // the last one: a uniform sky
constexpr double kSkyMirrored = 0.06751;

glm::dvec3 direction_of(double zenith_deg, double azimuth_deg) {
    const double theta = zenith_deg * kDegree, azimuth = azimuth_deg * kDegree;
    return {std::sin(theta) * std::cos(azimuth), std::sin(theta) * std::sin(azimuth), std::cos(theta)};
}
glm::dvec3 in_water(glm::dvec3 to_light) {
    return {to_light.x / kIndex, to_light.y / kIndex, refracted(to_light.z)};
}

// Radiance in the water of a uniform sky that is seen through the surface, over the irradiance that enters.
double sky_through(double cosine) {
    return kIndex * kIndex * (1.0 - fresnel(cosine, 1.0 / kIndex)) / (kPi * (1.0 - kSkyMirrored));
}

// Backwards from the eye: radiance, of the sun only what is scattered, over the irradiance that enters, of each light.
// floor: how deep, and its albedo.
std::array<double, kBelowLights> seen_below(const Medium& medium, double depth,
                                            std::pair<double, double> floor, glm::dvec3 to, int paths,
                                            Lot& lot) {
    std::array<double, kBelowLights> sum{};
    const double c = medium.extinction;
    const glm::dvec3 start = to;
    for (int path = 0; path < paths; ++path) {
        to = start;
        double height = -depth, weight = 1.0;
        bool is_scattered = false;
        while (true) {
            const double next = height - std::log(1.0 - lot()) / c * to.z;
            if (next > 0.0) {
                height = 0.0;
                if (!is_scattered) sum.back() += weight * sky_through(to.z);
                weight *= fresnel(to.z, 1.0 / kIndex);
                to.z = -to.z;
            } else {
                const bool is_floor = next < -floor.first;
                height = is_floor ? -floor.first : next;
                weight *= is_floor ? floor.second : medium.albedo;
                if (is_floor && floor.second == 0.0) break;
                for (std::size_t light = 0; light < kBelowLights; ++light) {
                    double part = 1.0;
                    glm::dvec3 from;
                    if (light < kBelowSuns.size()) {
                        from = in_water(direction_of(90.0 - kBelowSuns[light], 0.0));
                    } else {
                        const double outside = std::sqrt(1.0 - lot());
                        from = in_water(direction_of(std::acos(outside) / kDegree, 360.0 * lot()));
                        part = (1.0 - fresnel(outside, kIndex)) / (1.0 - kSkyMirrored);
                    }
                    const double towards = is_floor ? from.z / kPi : medium.phase(glm::dot(to, from));
                    sum[light] += weight * part * towards / from.z * std::exp(c * height / from.z);
                }
                to = is_floor ? turned({0.0, 0.0, 1.0}, std::sqrt(1.0 - lot()), kTwoPi * lot())
                              : medium.scattered(to, lot);
                is_scattered = true;
            }
            if (weight < 0.05) {
                if (lot() > 0.1) break;
                weight *= 10.0;
            }
        }
    }
    for (double& part : sum) part /= paths;
    return sum;
}

// floor_m, albedo: kNoFloor_m and more: deep water.
void below(const char* name, double floor_m, double floor_albedo) {
    std::printf(
        "Light of %s around an eye, under a level surface: the model over the Monte Carlo, as a logarithm, by the\n"
        "view's angle from the zenith; of the sun further than 15 degrees from it in the water, and of a uniform sky\n",
        name);
    constexpr int kPaths = 20000;
    constexpr double kDarkest = 3.0;  // of depth times a + b_b: beyond, few paths find light
    const std::vector<NamedWater> all = waters();
    optics::Optics shading;
    struct Row {
        std::size_t water, band, depth, view, azimuth;
        std::array<double, kBelowLights> traced, ours;
    };
    std::vector<Row> rows;
    for (std::size_t water = 0; water < kFittedWaters; ++water)
        for (const std::size_t band : {0, 2, 4})
            for (std::size_t depth = 0; depth < kBelowDepths.size(); ++depth)
                for (std::size_t view = 0; view < kBelowViews.size(); ++view)
                    for (std::size_t azimuth = 0; azimuth < kBelowAzimuths.size(); ++azimuth)
                        if (kBelowDepths[depth] < floor_m &&
                            kBelowDepths[depth] * (of_band(all[water].absorption, band) +
                                                   of_band(all[water].backscatter, band)) <
                                kDarkest)
                            rows.push_back({water, band, depth, view, azimuth, {}, {}});
    tbb::parallel_for(std::size_t{0}, rows.size(), [&](std::size_t i) {
        Row& row = rows[i];
        Lot lot(77 + i);
        const NamedWater& water = all[row.water];
        const double a = of_band(water.absorption, row.band), back = of_band(water.backscatter, row.band),
                     own = 0.00144 * std::pow(kBands_nm[row.band] / 500.0, -4.32);
        const glm::dvec3 to = direction_of(kBelowViews[row.view], kBelowAzimuths[row.azimuth]);
        const double depth = kBelowDepths[row.depth];
        row.traced =
            seen_below(Medium(a, back, kBands_nm[row.band]), depth, {floor_m, floor_albedo}, to, kPaths, lot);
        const auto bands = [](double of) { return glm::vec3(static_cast<float>(of)); };
        optics::Optics::WaterLook look{};
        look.floor_m = static_cast<float>(floor_m);
        look.waves = {1e-10f, 1e-10f, 0.0f};
        for (std::size_t light = 0; light < kBelowLights; ++light) {
            const double sun = light < kBelowSuns.size() ? kBelowSuns[light] : 60.0;
            const auto seen = [&](glm::dvec3 along, double height, double surface) {
                const auto sight = shading.water_sight(glm::vec3(along), static_cast<float>(height),
                                                       static_cast<float>(surface),
                                                       glm::vec3(direction_of(90.0 - sun, 0.0)), look);
                const auto of = shading.seen_in_water(bands(a), bands(2.0 * own + (back - own) / 0.018),
                                                      bands(back), bands(own), bands(floor_albedo), sight);
                return std::pair(static_cast<double>(light < kBelowSuns.size() ? of.sun.x : of.sky.x),
                                 static_cast<double>(of.left.x));
            };
            if (to.z > 1e-6) {
                const auto [light_between, left] = seen(to, -depth, depth / to.z);
                const double behind = light < kBelowSuns.size() ? 0.0 : sky_through(to.z);
                row.ours[light] =
                    light_between + left * behind +
                    left * fresnel(to.z, 1.0 / kIndex) * seen({to.x, to.y, -to.z}, 0.0, -1.0).first;
            } else {
                row.ours[light] = seen(to, -depth, -1.0).first;
            }
        }
    });
    for (const bool of_sky : {false, true}) {
        std::printf("    %s", of_sky ? "sky" : "sun");
        for (const double depth : kBelowDepths)
            for (std::size_t azimuth = 0; depth < floor_m && azimuth < (of_sky ? 1 : kBelowAzimuths.size());
                 ++azimuth)
                std::printf(of_sky ? "   %4.1f m    " : "  %4.1f m %3.0f", depth, kBelowAzimuths[azimuth]);
        std::printf("\n");
        for (std::size_t view = 0; view < kBelowViews.size(); ++view) {
            std::printf("    %5.0f", kBelowViews[view]);
            for (std::size_t depth = 0; depth < kBelowDepths.size() && kBelowDepths[depth] < floor_m; ++depth)
                for (std::size_t azimuth = 0; azimuth < (of_sky ? 1 : kBelowAzimuths.size()); ++azimuth) {
                    double sum = 0.0, square = 0.0;
                    int count = 0;
                    for (const Row& row : rows) {
                        if (row.view != view || row.depth != depth || row.azimuth != azimuth) continue;
                        for (std::size_t light = 0; light < kBelowLights; ++light) {
                            if ((light == kBelowSuns.size()) != of_sky) continue;
                            if (!of_sky && glm::dot(direction_of(kBelowViews[view], kBelowAzimuths[azimuth]),
                                                    in_water(direction_of(90.0 - kBelowSuns[light], 0.0))) >
                                               std::cos(15.0 * kDegree))
                                continue;
                            const double error = std::log(row.ours[light] / row.traced[light]);
                            sum += error;
                            square += error * error;
                            ++count;
                        }
                    }
                    count = std::max(count, 1);
                    std::printf("  %+5.2f %4.2f", sum / count, std::sqrt(square / count));
                }
            std::printf("\n");
        }
    }
}

void below() {
    below("deep water", 1e9, 0.0);
    below("water over a floor at 4 m, albedo 0.5", 4.0, 0.5);
}

}  // namespace
}  // namespace pelagic::bench

int main(int argc, char** argv) {
    using Table = std::pair<std::string, void (*)()>;
    const std::vector<Table> tables{
        {"transmission", pelagic::bench::transmission}, {"column", pelagic::bench::columns},
        {"furnace", pelagic::bench::furnaces},          {"crest", pelagic::bench::crests},
        {"caustics", pelagic::bench::caustics},         {"below", pelagic::bench::below}};
    for (const auto& [name, print] : tables) {
        const bool asked =
            argc < 2 || std::any_of(argv + 1, argv + argc, [&](const char* said) { return name == said; });
        if (asked) print();
    }
}
