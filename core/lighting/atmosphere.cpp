// Why not one of the usual fits (Preetham 1999, Hosek & Wilkie 2012)? They end when the sun reaches the
// horizon, and they give the sky without its sun. Films of the sea need low suns and twilight, and a sun that
// matches its sky. The integral needs only the few measured constants below.
#include "core/lighting/atmosphere.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "core/base/constants.h"
#include "core/lighting/columns.h"
#include "core/lighting/sky_bake.h"

namespace pelagic {
namespace {

// Two Henyey–Greenstein lobes with a mean cosine of 0.73. The forward lobe makes the aureole.
constexpr double kHazeForward = 0.80, kHazeBackward = -0.45, kHazeForwardShare = 0.945;

// The ground's albedo, that of the sea.
const double kGroundAlbedo = static_cast<double>(diffuse_fresnel());

// The fraction of a disc above a line that lies `above` radii below its centre.
double part_above(double above) {
    const double x = std::clamp(above, -1.0, 1.0);
    return 0.5 + (x * std::sqrt(1.0 - x * x) + std::asin(x)) / kPi;
}

double two_lobe(double cosine, double g) {
    const double bracket = 1.0 + g * g - 2.0 * g * cosine;
    return (1.0 - g * g) / (4.0 * kPi * bracket * std::sqrt(bracket));
}

constexpr std::size_t kBandCount = kBands;

}  // namespace

double air_phase(double cosine) {
    return 3.0 / (16.0 * kPi) * (1.0 + cosine * cosine);  // Rayleigh, without the molecules' anisotropy
}

double haze_phase(double cosine) {
    return kHazeForwardShare * two_lobe(cosine, kHazeForward) +
           (1.0 - kHazeForwardShare) * two_lobe(cosine, kHazeBackward);
}

class Atmosphere::Tables {
  public:
    Tables(double turbidity, double sun_elevation_rad, double highest_km)
        : turbidity_(turbidity),
          sun_elevation_(sun_elevation_rad),
          highest_km_(highest_km),
          outer_(highest_km > kNear_km ? kOuter : 0),
          elevations_(kInner + 2 * outer_),
          vertical_(vertical_thickness(turbidity)),
          more_(kHeights * elevations_) {
        const std::vector<double> turns = haze_turns();
        tbb::parallel_for(std::size_t{0}, kHeights, [&](std::size_t i) { gather(i, turns); });
    }

    double turbidity() const { return turbidity_; }
    double sun_elevation() const { return sun_elevation_; }
    double highest_km() const { return highest_km_; }

    BandValues transmittance(const Matter& column) const {
        BandValues out;
        for (std::size_t b = 0; b < kBandCount; ++b) out[b] = std::exp(-thickness(column, b));
        return out;
    }

    BandValues transmittance(const SightLine& line) const { return sighted(line).passed; }

    std::vector<Scattered> scattered(const SightLine& line, std::span<const double> azimuths,
                                     double sun_elevation) const {
        std::vector<Scattered> all(azimuths.size());
        std::vector<Sun> suns;
        for (const double azimuth : azimuths) suns.emplace_back(sun_elevation, azimuth);
        std::vector<BandValues> row;
        for (const Piece& piece : sighted(line).pieces) {
            more_at(piece.radius - kEarth_km, row);
            for (std::size_t k = 0; k < all.size(); ++k) {
                const double cosine = suns[k].cosine(piece.turn);
                BandValues light;
                const bool lit = sunlight(piece.radius, cosine, light);
                const BandValues more = more_at(row, cosine);
                Scattered& out = all[k];
                for (std::size_t b = 0; b < kBandCount; ++b) {
                    out.more[b] += (piece.by_air[b] + piece.by_haze[b]) * more[b];
                    if (!lit) continue;
                    out.by_air[b] += piece.by_air[b] * light[b];
                    out.by_haze[b] += piece.by_haze[b] * light[b];
                }
            }
        }
        return all;
    }

  private:
    static constexpr int kViewSteps = 48, kGatherSteps = 24;
    // The table of multiple scattering. Heights grow with the cube of the index, which resolves the haze. The
    // sun's elevations cover all those between the observer and the farthest visible air, 10° away round the
    // earth.
    static constexpr std::size_t kHeights = 20, kInner = 15;
    static constexpr double kReach = 11.0 * kPi / 180.0;
    // From higher up than kNear_km farther air is seen, to 31° round the earth from 400 km: coarser steps on both sides.
    static constexpr double kNear_km = 1.0, kOuterStep = 22.0 / 6.0 * kPi / 180.0;
    static constexpr std::size_t kOuter = 6;
    static constexpr int kGatherElevations = 20, kGatherAzimuths = 5;  // azimuths of a half circle

    // The angle at the earth's centre between the ray's start and a point of the ray.
    struct Turn {
        double sine = 0.0, cosine = 1.0;
    };
    // A segment of a ray, evaluated at its middle.
    struct Piece {
        double radius = 0.0;
        Turn turn;
        // The share of light that falls on the segment and is scattered to the ray's start, without phase
        // functions.
        BandValues by_air{}, by_haze{};
    };
    struct Ray {
        std::vector<Piece> pieces;
        bool ground = false;  // the ray ends on the ground, otherwise in space
        Turn end;
        BandValues passed{};  // transmittance from its end to its start
    };
    // The sun's direction relative to a vertical plane, at this azimuth from the sun.
    struct Sun {
        Sun(double elevation, double azimuth)
            : along(std::cos(elevation) * std::cos(azimuth)), up(std::sin(elevation)) {}
        // Cosine of the sun's zenith angle at a point of the plane.
        double cosine(Turn turn) const { return along * turn.sine + up * turn.cosine; }
        // Cosine of the scattering angle from the sun into a ray of the plane.
        double turned_into(double elevation) const {
            return along * std::cos(elevation) + up * std::sin(elevation);
        }
        double along, up;
    };

    double thickness(const Matter& column, std::size_t b) const {
        return vertical_.air[b] * column.air + vertical_.haze[b] * column.haze + vertical_.ozone[b] * column.ozone;
    }

    // The sunlight at a point: transmittance times the fraction of the disc above the local horizon. Returns
    // false and writes nothing if the whole disc is below.
    bool sunlight(double radius, double cosine, BandValues& light) const {
        const double horizon = -horizon_distance(radius) / radius;  // cosine of its zenith angle
        double part = 1.0;
        if (cosine < horizon + 2.0 * kSunAngularRadius) {
            part = part_above((std::asin(std::clamp(cosine, -1.0, 1.0)) - std::asin(horizon)) /
                              kSunAngularRadius);
            if (part <= 0.0) return false;
        }
        light = transmittance(columns_(radius, cosine));
        for (double& value : light) value *= part;
        return true;
    }

    // The ray from an observer, in or above the air.
    Ray sighted(const SightLine& line) const {
        double radius = kEarth_km + std::max(line.height_km, 0.0), elevation = line.elevation_rad;
        double length = std::max(line.length_km, 0.0);
        constexpr double top = kEarth_km + kTop_km;
        Turn start;
        if (radius > top) {
            const double across = std::cos(elevation), up = std::sin(elevation);
            const double inside2 = top * top - radius * radius * across * across;
            if (!(inside2 > 0.0 && up < 0.0)) {  // nothing but space
                Ray none;
                none.passed.fill(1.0);
                return none;
            }
            const double empty = -radius * up - std::sqrt(inside2);
            start = turn_at(radius, across, up, empty);
            elevation =
                std::atan2(radius * up + empty, radius * across);  // at the place where it enters the air
            radius = top;
            length = std::max(0.0, length - empty);
        }
        Ray ray = marched(radius, elevation, kViewSteps, length, -radius * std::sin(elevation));
        if (start.sine == 0.0) return ray;
        const auto turned = [&](Turn turn) {
            return Turn{turn.sine * start.cosine + turn.cosine * start.sine,
                        turn.cosine * start.cosine - turn.sine * start.sine};
        };
        for (Piece& piece : ray.pieces) piece.turn = turned(piece.turn);
        ray.end = turned(ray.end);
        return ray;
    }

    static Turn turn_at(double radius, double across, double up, double t) {
        const double r = std::hypot(t * across, radius + t * up);
        return Turn{t * across / r, (radius + t * up) / r};
    }

    // At most `longest` long. The pieces are shortest where the air is `densest` along the way.
    Ray marched(double radius, double elevation, int steps,
                double longest = std::numeric_limits<double>::infinity(), double densest = 0.0) const {
        const double across = std::cos(elevation), up = std::sin(elevation);
        const double closest2 = radius * radius * across * across;
        Ray ray;
        ray.ground = up < 0.0 && closest2 < kEarth_km * kEarth_km;
        double length = ray.ground ? std::max(0.0, -radius * up - std::sqrt(kEarth_km * kEarth_km - closest2))
                                   : to_top(radius, up);
        ray.ground = ray.ground && length <= longest;
        length = std::min(length, longest);
        densest = std::clamp(densest, 0.0, length);
        ray.passed.fill(1.0);
        ray.end = turn_at(radius, across, up, length);
        ray.pieces.resize(static_cast<std::size_t>(steps));
        // Cubic spacing on both sides: most of the light comes from dense air, however long the ray is.
        const double before = std::cbrt(densest), after = std::cbrt(length - densest);
        const int first = before > 0.0 ? static_cast<int>(std::lround(steps * before / (before + after))) : 0;
        const auto at = [&](int i) {
            if (i < first) {
                const double s = static_cast<double>(first - i) / first;
                return densest - densest * s * s * s;
            }
            const double s = static_cast<double>(i - first) / std::max(steps - first, 1);
            return i == steps ? length : densest + (length - densest) * s * s * s;
        };
        for (int i = 0; i < steps; ++i) {
            const double from = at(i), to = at(i + 1);
            const double middle = 0.5 * (from + to);
            Piece& piece = ray.pieces[static_cast<std::size_t>(i)];
            piece.turn = turn_at(radius, across, up, middle);
            piece.radius =
                std::clamp(std::hypot(middle * across, radius + middle * up), kEarth_km, kEarth_km + kTop_km);
            const Matter here = density(piece.radius - kEarth_km);
            for (std::size_t b = 0; b < kBandCount; ++b) {
                // The integral over a segment of constant density, exact for thick segments as well.
                const double extinction = thickness(here, b);
                const double passed = std::exp(-extinction * (to - from));
                const double seen =
                    ray.passed[b] * (extinction > 0.0 ? (1.0 - passed) / extinction : to - from);
                piece.by_air[b] = seen * vertical_.air[b] * here.air;
                piece.by_haze[b] = seen * kHazeAlbedo * vertical_.haze[b] * here.haze;
                ray.passed[b] *= passed;
            }
        }
        return ray;
    }

    // Fills one height's row of the table. For each elevation of the sun: the mean over all directions of the
    // light scattered once or reflected by the ground, divided by 1 − f. Here f is the share of isotropic
    // light that is scattered back. The result is the radiance of all further orders of scattering.
    void gather(std::size_t height, const std::vector<double>& haze_turns) {
        const double x = static_cast<double>(height) / (kHeights - 1);
        const double radius = kEarth_km + kTop_km * x * x * x;
        BandValues* row = &more_[height * elevations_];
        BandValues again{};
        for (int i = 0; i < kGatherElevations; ++i) {
            // Equal steps of elevation resolve the dense air near the horizon better than equal solid angles.
            const double from = kPi * i / kGatherElevations - 0.5 * kPi, to = from + kPi / kGatherElevations;
            const double share = 0.5 * (std::sin(to) - std::sin(from)) / kGatherAzimuths;
            const double elevation = 0.5 * (from + to);
            const Ray ray = marched(radius, elevation, kGatherSteps);
            for (const Piece& piece : ray.pieces)
                for (std::size_t b = 0; b < kBandCount; ++b)
                    again[b] += kGatherAzimuths * share * (piece.by_air[b] + piece.by_haze[b]);
            for (std::size_t j = 0; j < elevations_; ++j)
                for (int k = 0; k < kGatherAzimuths; ++k) {
                    const Sun sun(table_elevation(j), kPi * (k + 0.5) / kGatherAzimuths);
                    const double air = share * air_phase(sun.turned_into(elevation));
                    const double haze = share * haze_turns[turn_index(i, j, k)];
                    add_once(ray, sun, {air, haze, share * kGroundAlbedo / kPi}, row[j]);
                }
        }
        for (std::size_t j = 0; j < elevations_; ++j)
            for (std::size_t b = 0; b < kBandCount; ++b) row[j][b] /= 1.0 - again[b];
    }

    // Weights of the light that haze, air and ground send into a ray.
    struct Weights {
        double air, haze, ground;
    };

    // Adds the light that reaches the ray's start after exactly one scattering or reflection.
    void add_once(const Ray& ray, const Sun& sun, const Weights& weights, BandValues& sum) const {
        BandValues light;
        for (const Piece& piece : ray.pieces)
            if (sunlight(piece.radius, sun.cosine(piece.turn), light))
                for (std::size_t b = 0; b < kBandCount; ++b)
                    sum[b] += (weights.air * piece.by_air[b] + weights.haze * piece.by_haze[b]) * light[b];
        if (ray.ground && sunlight(kEarth_km, sun.cosine(ray.end), light)) {
            const double sent = weights.ground * std::max(0.0, sun.cosine(ray.end));
            for (std::size_t b = 0; b < kBandCount; ++b) sum[b] += sent * ray.passed[b] * light[b];
        }
    }

    std::size_t turn_index(int ray, std::size_t sun, int azimuth) const {
        return (static_cast<std::size_t>(ray) * elevations_ + sun) * kGatherAzimuths +
               static_cast<std::size_t>(azimuth);
    }

    // The haze's phase function for each ray of gather() and each sun, averaged over the ray's solid angle,
    // which is wider than the forward lobe.
    std::vector<double> haze_turns() const {
        constexpr int kParts = 6;
        std::vector<double> means(kGatherElevations * elevations_ * kGatherAzimuths);
        tbb::parallel_for(0, kGatherElevations, [&](int i) {
            for (std::size_t j = 0; j < elevations_; ++j)
                for (int k = 0; k < kGatherAzimuths; ++k) {
                    double sum = 0.0, weight = 0.0;
                    for (int a = 0; a < kParts; ++a) {
                        const double azimuth = kPi * (k + (a + 0.5) / kParts) / kGatherAzimuths;
                        const Sun sun(table_elevation(j), azimuth);
                        for (int e = 0; e < kParts; ++e) {
                            const double elevation =
                                kPi * ((i + (e + 0.5) / kParts) / kGatherElevations - 0.5);
                            sum += std::cos(elevation) * haze_phase(sun.turned_into(elevation));
                            weight += std::cos(elevation);
                        }
                    }
                    means[turn_index(i, j, k)] = sum / weight;
                }
        });
        return means;
    }

    double table_elevation(std::size_t j) const {
        if (j < outer_) return sun_elevation_ - kReach - kOuterStep * static_cast<double>(outer_ - j);
        if (j >= outer_ + kInner)
            return sun_elevation_ + kReach + kOuterStep * static_cast<double>(j - outer_ - kInner + 1);
        return sun_elevation_ + kReach * (2.0 * static_cast<double>(j - outer_) / (kInner - 1) - 1.0);
    }

    // The table's row at a height [km], by the sun's elevation.
    void more_at(double height, std::vector<BandValues>& row) const {
        const Cubic up(std::cbrt(std::clamp(height / kTop_km, 0.0, 1.0)) * (kHeights - 1), kHeights);
        row.assign(elevations_, BandValues{});
        for (std::size_t i = 0; i < 4; ++i)
            for (std::size_t j = 0; j < elevations_; ++j)
                for (std::size_t b = 0; b < kBandCount; ++b)
                    row[j][b] += up.weights[i] * more_[up.nodes[i] * elevations_ + j][b];
    }

    // In that row, at this sine of the sun's elevation.
    BandValues more_at(const std::vector<BandValues>& row, double sine) const {
        const double from_sun = std::asin(std::clamp(sine, -1.0, 1.0)) - sun_elevation_;
        const double off = from_sun / kReach;
        double y = static_cast<double>(outer_) + 0.5 * (std::clamp(off, -1.0, 1.0) + 1.0) * (kInner - 1);
        const double beyond = (std::abs(from_sun) - kReach) / kOuterStep;
        if (beyond > 0.0) y += std::copysign(std::min(beyond, static_cast<double>(outer_)), from_sun);
        const Cubic across(y, elevations_);
        BandValues out{};
        for (std::size_t j = 0; j < 4; ++j)
            for (std::size_t b = 0; b < kBandCount; ++b)
                out[b] += across.weights[j] * row[across.nodes[j]][b];
        for (double& value : out)
            value = std::max(value, 0.0);  // a cubic undershoots where dusk falls steeply
        return out;
    }

    double turbidity_, sun_elevation_, highest_km_;
    std::size_t outer_, elevations_;
    Thickness vertical_;
    Columns columns_;
    std::vector<BandValues> more_;  // by height and sun elevation
};

Atmosphere::Atmosphere(double turbidity, double sun_elevation_rad, double highest_km)
    : tables_(std::make_unique<const Tables>(turbidity, sun_elevation_rad, highest_km)) {}
Atmosphere::~Atmosphere() = default;

double Atmosphere::turbidity() const {
    return tables_->turbidity();
}
double Atmosphere::sun_elevation_rad() const {
    return tables_->sun_elevation();
}
double Atmosphere::highest_km() const {
    return tables_->highest_km();
}

BandValues Atmosphere::transmittance(double elevation_rad) const {
    const double cosine = std::sin(std::max(elevation_rad, 0.0));
    return tables_->transmittance(Columns::integrated(kEarth_km, to_top(kEarth_km, cosine)));
}

BandValues Atmosphere::transmittance(const SightLine& line) const {
    return tables_->transmittance(line);
}

std::vector<Atmosphere::Scattered> Atmosphere::scattered(const SightLine& line,
                                                         std::span<const double> azimuths_rad,
                                                         double sun_elevation_rad) const {
    return tables_->scattered(line, azimuths_rad, sun_elevation_rad);
}

}  // namespace pelagic
