// The daylight's model beside a Monte Carlo of the same air: `bench_sky [PATHS [TURBIDITY …]]`. `bench_sky kept` writes
// the numbers that Daylight.IsThatOfAMonteCarlo keeps.
//
// Paths go backwards from an observer at sea level through spherical shells: free flights through air, haze and ozone,
// each collision scattered by its own phase function, the ground ideally diffuse, and at each vertex the sun's light
// through the air (a point of its disc). All orders. The first one is integrated, which takes its noise away. All bands
// ride on one path, which a band drawn by lot leads; weights are over the mean of all bands' densities (the balance
// heuristic). From the core come the air itself (columns.h, the phase functions), and nothing of how it is lit.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "core/base/constants.h"
#include "core/lighting/atmosphere.h"
#include "core/lighting/colour.h"
#include "core/lighting/columns.h"
#include "core/lighting/sky_bake.h"
#include "core/lighting/sunlight.h"
#include "tests/bench/lots.h"
#include "tests/bench/timing.h"

namespace pelagic::bench {
namespace {

constexpr double kDegree = kPi / 180.0;

glm::dvec3 towards(double elevation, double azimuth) {
    return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
            std::sin(elevation)};
}

// A phase function's cosines at even steps of its distribution, by halving.
class Deflection {
  public:
    explicit Deflection(double (*phase)(double)) {
        // The integral over cosines, finest forwards, where 1 − cosine grows with the cube.
        std::vector<double> cosine{1.0}, sum{0.0};
        for (int i = 1; i <= kFine; ++i) {
            const double x = static_cast<double>(i) / kFine;
            cosine.push_back(1.0 - 2.0 * x * x * x);
            const double middle = 0.5 * (cosine[cosine.size() - 2] + cosine.back());
            sum.push_back(sum.back() + kTwoPi * phase(middle) * (cosine[cosine.size() - 2] - cosine.back()));
        }
        for (int i = 0; i <= kSteps; ++i) {
            const double part = sum.back() * i / kSteps;
            const auto at =
                std::clamp(std::upper_bound(sum.begin(), sum.end(), part), sum.begin() + 1, sum.end() - 1) -
                sum.begin();
            const auto k = static_cast<std::size_t>(at);
            table_[static_cast<std::size_t>(i)] =
                cosine[k - 1] + (cosine[k] - cosine[k - 1]) * (part - sum[k - 1]) / (sum[k] - sum[k - 1]);
        }
    }
    double operator()(double lot) const {
        const double x = lot * kSteps;
        const auto i = std::min(static_cast<std::size_t>(x), std::size_t{kSteps - 1});
        return table_[i] + (table_[i + 1] - table_[i]) * (x - static_cast<double>(i));
    }

  private:
    static constexpr int kFine = 1 << 18, kSteps = 1 << 14;
    std::array<double, kSteps + 1> table_{};
};

struct Light {
    BandValues radiance{};
    double luminance = 0.0, error = 0.0;  // and its standard error
};

class PathTraced {
  public:
    PathTraced(double turbidity, double sun_elevation)
        : vertical_(vertical_thickness(turbidity)), sun_(towards(sun_elevation, 0.0)) {
        for (std::size_t b = 0; b < kBands; ++b) seen_[b] = luminance(sunlight_colours()[b]);
    }

    Light radiance(glm::dvec3 direction, int paths, std::uint64_t seed) const {
        Lot lot(seed);
        Light light;
        light.radiance = once(direction, lot);
        BandValues sum{};
        double square = 0.0;
        for (int i = 0; i < paths; ++i) {
            const BandValues one = path(direction, (i + lot()) / paths, lot);
            double seen = 0.0;
            for (std::size_t b = 0; b < kBands; ++b) {
                sum[b] += one[b];
                seen += seen_[b] * one[b];
            }
            square += seen * seen;
        }
        double mean = 0.0;
        for (std::size_t b = 0; b < kBands; ++b) {
            light.radiance[b] += sum[b] / paths;
            mean += seen_[b] * sum[b] / paths;
            light.luminance += seen_[b] * light.radiance[b];
        }
        light.error = std::sqrt(std::max(0.0, square / paths - mean * mean) / paths);
        return light;
    }

  private:
    static constexpr int kSteps = 96, kFineSteps = 800, kLongest = 300;

    double thickness(const Matter& column, std::size_t b) const {
        return vertical_.air[b] * column.air + vertical_.haze[b] * column.haze +
               vertical_.ozone[b] * column.ozone;
    }

    // The end of a ray, and its places at even steps of the cube root on both sides of its lowest place.
    struct Way {
        Way(glm::dvec3 from, glm::dvec3 to, int count) : steps(count) {
            const double radius = glm::length(from), up = glm::dot(from, to) / radius;
            const double closest2 = radius * radius * (1.0 - up * up);
            ground = up < 0.0 && closest2 < kEarth_km * kEarth_km;
            length = ground ? std::max(0.0, -radius * up - std::sqrt(kEarth_km * kEarth_km - closest2))
                            : to_top(radius, up);
            lowest = std::clamp(-radius * up, 0.0, length);
            const double before = std::cbrt(lowest), after = std::cbrt(length - lowest);
            first = before > 0.0 ? std::max(1, static_cast<int>(steps * before / (before + after))) : 0;
            if (ground) first = steps;
        }
        double at(int i) const {
            if (i <= first && first > 0) {
                const double s = static_cast<double>(first - i) / first;
                return lowest - lowest * s * s * s;
            }
            const double s = static_cast<double>(i - first) / (steps - first);
            return lowest + (length - lowest) * s * s * s;
        }
        int steps, first;
        double length, lowest;
        bool ground;
    };

    static Matter density_at(glm::dvec3 place) {
        return density(std::max(0.0, glm::length(place) - kEarth_km));
    }

    // The sunlight at a place, from one point of the disc.
    BandValues sunlight(glm::dvec3 place, Lot& lot) const {
        const glm::dvec3 to = turned(sun_, 1.0 - lot() * (1.0 - std::cos(kSunAngularRadius)), kTwoPi * lot());
        const double radius = glm::length(place), cosine = glm::dot(place, to) / radius;
        BandValues light{};
        if (cosine < -horizon_distance(radius) / radius) return light;
        const Matter column = columns_(radius, cosine);
        for (std::size_t b = 0; b < kBands; ++b) light[b] = std::exp(-thickness(column, b));
        return light;
    }

    // Scattered once on the way to the observer.
    BandValues once(glm::dvec3 direction, Lot& lot) const {
        const glm::dvec3 eye(0.0, 0.0, kEarth_km);
        const Way way(eye, direction, kFineSteps);
        const double cosine = glm::dot(direction, sun_);
        BandValues sum{}, passed;
        passed.fill(1.0);
        for (int i = 0; i < way.steps; ++i) {
            const double from = way.at(i), to = way.at(i + 1);
            const glm::dvec3 place = eye + direction * (0.5 * (from + to));
            const Matter here = density_at(place);
            const BandValues light = sunlight(place, lot);
            for (std::size_t b = 0; b < kBands; ++b) {
                const double extinction = thickness(here, b), left = std::exp(-extinction * (to - from));
                const double scattered = vertical_.air[b] * here.air * air_phase(cosine) +
                                         kHazeAlbedo * vertical_.haze[b] * here.haze * haze_phase(cosine);
                sum[b] += passed[b] * light[b] * scattered * (1.0 - left) / std::max(extinction, 1e-300);
                passed[b] *= left;
            }
        }
        return sum;
    }

    // Scattered or reflected more than once. `first`: the lot of the first flight.
    BandValues path(glm::dvec3 direction, double first, Lot& lot) const {
        BandValues out{}, share, chance;  // the path's throughput and density, by band, both scaled alike
        share.fill(1.0);
        chance.fill(1.0);
        const auto lead = std::min(static_cast<std::size_t>(lot() * kBands), std::size_t{kBands - 1});
        glm::dvec3 place(0.0, 0.0, kEarth_km);
        for (int order = 1; order < kLongest; ++order) {
            // The flight.
            const Way way(place, direction, kSteps);
            const double wanted = -std::log(1.0 - (order == 1 ? first : lot()));
            Matter here, column;
            bool collides = false;
            double flown = way.length, passed = 0.0;
            for (int i = 0; i < way.steps && !collides; ++i) {
                const double from = way.at(i), to = way.at(i + 1);
                here = density_at(place + direction * (0.5 * (from + to)));
                double length = to - from;
                const double extinction = thickness(here, lead);
                if (passed + extinction * length > wanted) {
                    length = (wanted - passed) / extinction;
                    collides = true;
                    flown = from + length;
                }
                passed += extinction * length;
                column.air += here.air * length;
                column.haze += here.haze * length;
                column.ozone += here.ozone * length;
            }
            if (!collides && !way.ground) return out;
            place += direction * flown;
            for (std::size_t b = 0; b < kBands; ++b) {
                const double left = std::exp(-thickness(column, b));
                share[b] *= left;
                chance[b] *= left * (collides ? thickness(here, b) : 1.0);
            }
            const BandValues light = sunlight(place, lot);
            const double over = over_mean(chance);
            if (!collides) {
                const glm::dvec3 up = glm::normalize(place);
                place = up * kEarth_km;
                const double albedo = static_cast<double>(diffuse_fresnel());
                const double lit = order > 1 ? albedo / kPi * std::max(0.0, glm::dot(up, sun_)) : 0.0;
                for (std::size_t b = 0; b < kBands; ++b) {
                    out[b] += over * share[b] * lit * light[b];
                    share[b] *= albedo;
                }
                direction = turned(up, std::sqrt(lot()), kTwoPi * lot());
            } else {
                const auto by_air = [&](std::size_t b) { return vertical_.air[b] * here.air; };
                const auto by_haze = [&](std::size_t b) {
                    return kHazeAlbedo * vertical_.haze[b] * here.haze;
                };
                if (order > 1) {
                    const double cosine = glm::dot(direction, sun_);
                    const double air = air_phase(cosine), haze = haze_phase(cosine);
                    for (std::size_t b = 0; b < kBands; ++b)
                        out[b] += over * share[b] * (by_air(b) * air + by_haze(b) * haze) * light[b];
                }
                const bool is_air = lot() * (by_air(lead) + by_haze(lead)) < by_air(lead);
                const double cosine = is_air ? by_air_(lot()) : by_haze_(lot());
                direction = turned(direction, cosine, kTwoPi * lot());
                const double air = air_phase(cosine), haze = haze_phase(cosine);
                for (std::size_t b = 0; b < kBands; ++b) {
                    const double scattered = by_air(b) * air + by_haze(b) * haze;
                    share[b] *= scattered;
                    chance[b] *= scattered / (by_air(b) + by_haze(b));
                }
            }
            // Faint paths end by lot.
            const double now = over_mean(chance), strongest = now * *std::ranges::max_element(share);
            const double stays = std::min(1.0, strongest / 0.2);
            if (!(lot() < stays)) return out;
            for (std::size_t b = 0; b < kBands; ++b) {
                share[b] *= now / stays;
                chance[b] *= now;
            }
        }
        return out;
    }

    static double over_mean(const BandValues& chance) {
        double sum = 0.0;
        for (const double value : chance) sum += value;
        return kBands / sum;
    }

    Thickness vertical_;
    glm::dvec3 sun_;
    BandValues seen_{};
    Columns columns_;
    Deflection by_air_{air_phase}, by_haze_{haze_phase};
};

struct View {
    double elevation_deg, azimuth_deg;  // from the sun's
};

std::vector<View> views() {
    std::vector<View> all;
    for (const double elevation : {1.0, 3.0, 6.0, 12.0, 20.0, 45.0})
        for (const double azimuth : {10.0, 25.0, 60.0, 110.0, 180.0})
            all.push_back(elevation == 45.0 && azimuth == 10.0 ? View{90.0, 0.0} : View{elevation, azimuth});
    return all;
}

struct Range {
    double least = 1e9, most = 0.0;
    void add(double value) {
        least = std::min(least, value);
        most = std::max(most, value);
    }
};

// The ratios of luminance, and the range of them; the bands' beside it.
void table(double turbidity, int paths, bool is_short) {
    const std::vector<View> all = views();
    Range range, blue, red;
    for (const double sun_deg : {-2.0, 2.0, 6.0, 20.0, 45.0, 60.0}) {
        const PathTraced traced(turbidity, sun_deg * kDegree);
        const Atmosphere air(turbidity, sun_deg * kDegree);
        std::vector<Light> found(all.size());
        tbb::parallel_for(std::size_t{0}, all.size(), [&](std::size_t i) {
            found[i] = traced.radiance(towards(all[i].elevation_deg * kDegree, all[i].azimuth_deg * kDegree),
                                       paths, 1 + i);
        });
        Range here;
        std::string rows;
        double last = -1.0;
        for (std::size_t i = 0; i < all.size(); ++i) {
            const double elevation = all[i].elevation_deg * kDegree, azimuth = all[i].azimuth_deg * kDegree;
            const auto said = air.scattered(elevation, std::array{azimuth})[0];
            const double cosine = glm::dot(towards(elevation, azimuth), towards(sun_deg * kDegree, 0.0));
            BandValues model;
            for (std::size_t b = 0; b < kBands; ++b)
                model[b] =
                    said.by_air[b] * air_phase(cosine) + said.by_haze[b] * haze_phase(cosine) + said.more[b];
            const double ratio = luminance(colour_of(model)) / found[i].luminance;
            here.add(ratio);
            blue.add(model[3] / found[i].radiance[3]);
            red.add(model[13] / found[i].radiance[13]);
            if (all[i].elevation_deg != last && all[i].elevation_deg != 90.0) {
                std::array<char, 64> start{};
                std::snprintf(start.data(), start.size(), "\n   %4.0f° |", all[i].elevation_deg);
                rows += start.data();
                last = all[i].elevation_deg;
            }
            std::array<char, 64> cell{};
            std::snprintf(cell.data(), cell.size(),
                          all[i].elevation_deg == 90.0 ? "  zenith %.3f ± %.3f" : "  %.3f ± %.3f", ratio,
                          ratio * found[i].error / found[i].luminance);
            rows += cell.data();
        }
        range.add(here.least);
        range.add(here.most);
        if (!is_short)
            std::printf("  sun %.0f°: %.3f … %.3f%s\n", sun_deg, here.least, here.most, rows.c_str());
    }
    std::printf(
        "turbidity %.1f: %.3f … %.3f (0.9 … 1.1: %s); at %.0f nm %.3f … %.3f, at %.0f nm %.3f … %.3f\n",
        turbidity, range.least, range.most, verdict(range.least >= 0.9 && range.most <= 1.1),
        1e3 * band_um(3), blue.least, blue.most, 1e3 * band_um(13), red.least, red.most);
}

void kept() {
    constexpr int kPaths = 150000;
    for (const double sun_deg : {2.0, 6.0, 45.0}) {
        const PathTraced traced(3.0, sun_deg * kDegree);
        const std::array all{View{3.0, 25.0}, View{12.0, 180.0}, View{90.0, 0.0}};
        std::array<Light, 3> found;
        tbb::parallel_for(std::size_t{0}, all.size(), [&](std::size_t i) {
            found[i] = traced.radiance(towards(all[i].elevation_deg * kDegree, all[i].azimuth_deg * kDegree),
                                       kPaths, 1 + i);
        });
        for (std::size_t i = 0; i < all.size(); ++i)
            std::printf("    {%.1f, %.1f, %.1f, %.4g},  // ± %.2g\n", sun_deg, all[i].elevation_deg,
                        all[i].azimuth_deg, found[i].luminance, found[i].error);
    }
}

}  // namespace
}  // namespace pelagic::bench

int main(int argc, char** argv) {
    if (argc > 1 && std::string(argv[1]) == "kept") {
        pelagic::bench::kept();
        return 0;
    }
    const int paths = argc > 1 ? std::atoi(argv[1]) : 20000;
    std::printf(
        "The model over the Monte Carlo (%d paths), its luminance, by the view's elevation;\n"
        "azimuths from the sun's: 10, 25, 60, 110, 180°\n",
        paths);
    if (argc < 3) pelagic::bench::table(3.0, paths, false);
    for (int i = 2; i < argc; ++i) pelagic::bench::table(std::atof(argv[i]), paths, argc > 3);
}
