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
#include <map>
#include <memory>
#include <mutex>
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

double thickness_of(const Thickness& vertical, const Matter& column, std::size_t b) {
    return vertical.air[b] * column.air + vertical.haze[b] * column.haze + vertical.ozone[b] * column.ozone;
}
BandValues transmittance_of(const Thickness& vertical, const Matter& column) {
    BandValues out;
    for (std::size_t b = 0; b < kBandCount; ++b) out[b] = thickness_of(vertical, column, b);
    exp_of_minus(out);
    return out;
}

}  // namespace

BandValues transmittance_to_sea(double turbidity, double elevation_rad) {
    const double cosine = std::sin(std::max(elevation_rad, 0.0));
    return transmittance_of(vertical_thickness(turbidity),
                            Columns::integrated(kEarth_km, to_top(kEarth_km, cosine)));
}

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
          first_(highest_km > kNear_km ? kLeastNode : node_below(sun_elevation_rad - kReach)),
          vertical_(vertical_thickness(turbidity)) {
        const int last = highest_km > kNear_km ? -kLeastNode : node_above(sun_elevation_rad + kReach);
        for (int node = first_; node <= last; ++node) twilight_.push_back(twilight(node_elevation(node)));
        suns_ = suns_to(last);
    }

    double turbidity() const { return turbidity_; }
    double sun_elevation() const { return sun_elevation_; }
    double highest_km() const { return highest_km_; }

    BandValues transmittance(const SightLine& line) const { return sighted(line).passed; }

    std::vector<Scattered> scattered(const SightLine& line, std::span<const double> azimuths,
                                     double sun_elevation) const {
        std::vector<Scattered> all(azimuths.size());
        std::vector<Sun> suns;
        for (const double azimuth : azimuths) suns.emplace_back(sun_elevation, azimuth);
        Row row(*this);
        for (const Piece& piece : sighted(line).pieces) {
            row.move_to(piece);
            for (std::size_t k = 0; k < all.size(); ++k) {
                const double cosine = suns[k].cosine(piece.turn);
                BandValues light{};
                const bool lit = sunlight(piece.radius, cosine, light);
                Scattered& out = all[k];
                row.add(cosine, suns[k].side(piece.turn), out.more);
                if (!lit) continue;
                for (std::size_t b = 0; b < kBandCount; ++b) {
                    out.by_air[b] += piece.by_air[b] * light[b];
                    out.by_haze[b] += piece.by_haze[b] * light[b];
                }
            }
        }
        return all;
    }

  private:
    static constexpr int kViewSteps = 48, kGatherSteps = 24;
    // The table of multiple scattering. Heights grow with the cube of the index, which resolves the haze. The sun's
    // elevations are closest in dusk: kSunStep of the inverse hyperbolic sine, the same for all suns. An eye near the sea
    // needs those between the sun over it and over the farthest visible air, 10° away round the earth; from higher up
    // than kNear_km the whole circle may be seen.
    static constexpr std::size_t kHeights = 20;
    static constexpr double kReach = 11.0 * kPi / 180.0, kNear_km = 1.0;
    static constexpr double kDusk = 2.0 * kPi / 180.0, kDuskWidth = 8.0 * kPi / 180.0, kSunStep = 0.25;
    static constexpr double kNight = -18.0 * kPi / 180.0;  // darker than starlight
    static constexpr int kLeastNode = -13;  // beyond the nadir's; its opposite is beyond the zenith's
    // Rays of the table, by elevation, closest at the horizon; and orders of the cosine of the azimuth, as many as
    // there are azimuths of a half circle. Rayleigh's phase function has no more than three. With 16 rays and 7 orders,
    // a quarter slower, light beside the sun is 3 % nearer the Monte Carlo's (tests/bench/sky.cpp).
    static constexpr int kRays = 18, kOrders = 5, kAirOrders = 3;
    static constexpr int kPasses = 2;  // each further one changes light by less than 2 %

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
        double elevation = 0.0;  // of the ray, there
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
            : along(std::cos(elevation) * std::cos(azimuth)),
              up(std::sin(elevation)),
              across(std::cos(elevation) * std::sin(azimuth)) {}
        // Cosine of its azimuth from the plane there.
        double side(Turn turn) const {
            const double ahead = along * turn.cosine - up * turn.sine, all = std::hypot(ahead, across);
            return all > 0.0 ? ahead / all : 1.0;
        }
        // Cosine of the sun's zenith angle at a point of the plane.
        double cosine(Turn turn) const { return along * turn.sine + up * turn.cosine; }
        // Cosine of the scattering angle from the sun into a ray of the plane.
        double turned_into(double elevation) const {
            return along * std::cos(elevation) + up * std::sin(elevation);
        }
        double along, up, across;
    };

    static const Columns& columns() {
        static const Columns columns;
        return columns;
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
        light = transmittance_of(vertical_, columns()(radius, cosine));
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
            piece.elevation = elevation + std::atan2(piece.turn.sine, piece.turn.cosine);
            piece.radius =
                std::clamp(std::hypot(middle * across, radius + middle * up), kEarth_km, kEarth_km + kTop_km);
            const Matter here = density(piece.radius - kEarth_km);
            BandValues extinction, passed;
            for (std::size_t b = 0; b < kBandCount; ++b) {
                extinction[b] = thickness_of(vertical_, here, b);
                passed[b] = extinction[b] * (to - from);
            }
            exp_of_minus(passed);
            for (std::size_t b = 0; b < kBandCount; ++b) {
                // The integral over a segment of constant density, exact for thick segments as well.
                const double seen =
                    ray.passed[b] * (extinction[b] > 0.0 ? (1.0 - passed[b]) / extinction[b] : to - from);
                piece.by_air[b] = seen * vertical_.air[b] * here.air;
                piece.by_haze[b] = seen * kHazeAlbedo * vertical_.haze[b] * here.haze;
                ray.passed[b] *= passed[b];
            }
        }
        return ray;
    }

    // The elevation of a place on the table's axis of rays: i … i + 1 are ray i's, closest at the horizon.
    static double ray_elevation(double i) {
        return 0.5 * kPi * std::sinh(kCrowding * (2.0 * i / kRays - 1.0)) / std::sinh(kCrowding);
    }
    static double ray_index(double elevation) {
        const double x = std::asinh(elevation / (0.5 * kPi) * std::sinh(kCrowding)) / kCrowding;
        return 0.5 * (x + 1.0) * kRays;
    }
    static constexpr double kCrowding = 2.6;

    using Turns = std::array<std::array<double, kOrders>, kRays>;
    using Bands = std::array<float, kBandCount>;
    // Light by ray and order m: that at the azimuth a from the sun's is the sum of cos(m a) times them.
    template <int kCount>
    using Field = std::array<std::array<Bands, kCount>, kRays>;
    // The light that a unit of scattering sends into each ray.
    struct Source {
        Field<kAirOrders> by_air{};
        Field<kOrders> by_haze{};
    };

    // What of each ray's light, by order, is scattered into each ray: [order][into][from].
    using Kernel = std::array<std::array<std::array<float, kRays>, kRays>, kOrders>;
    static Kernel kernel_of(double (*phase)(double)) {
        constexpr int kParts = 3, kAround = 30;  // of a ray's solid angle; of a half circle
        Kernel kernel{};
        for (int into = 0; into < kRays; ++into) {
            std::array<std::array<double, kRays>, kOrders> sums{};
            const double towards = ray_elevation(into + 0.5);
            double all = 0.0;
            for (int i = 0; i < kRays; ++i)
                for (int part = 0; part < kParts; ++part) {
                    const double low = ray_elevation(i + static_cast<double>(part) / kParts);
                    const double high = ray_elevation(i + (part + 1.0) / kParts),
                                 elevation = 0.5 * (low + high);
                    for (int k = 0; k < kAround; ++k) {
                        const double azimuth = kPi * (k + 0.5) / kAround;
                        const double cosine = std::cos(elevation) * std::cos(towards) * std::cos(azimuth) +
                                              std::sin(elevation) * std::sin(towards);
                        const double share = (std::sin(high) - std::sin(low)) * phase(cosine);
                        all += share;
                        for (int m = 0; m < kOrders; ++m) sums[m][i] += share * std::cos(m * azimuth);
                    }
                }
            // Of uniform light as much comes out as goes in.
            for (int m = 0; m < kOrders; ++m)
                for (int i = 0; i < kRays; ++i) kernel[m][into][i] = static_cast<float>(sums[m][i] / all);
        }
        return kernel;
    }
    static const Kernel& air_kernel() {
        static const Kernel kernel = kernel_of(air_phase);
        return kernel;
    }
    static const Kernel& haze_kernel() {
        static const Kernel kernel = kernel_of(haze_phase);
        return kernel;
    }

    // The air as the table's rays see it, whatever the sun.
    struct Columned {
        std::vector<Ray> rays{kHeights * kRays};  // by height
        // The share of light at a height that is scattered into a ray's start: by its height, ray, and that height.
        std::vector<Bands> by_air{kHeights * kRays * kHeights}, by_haze{kHeights * kRays * kHeights};
        std::vector<Bands> from_ground{kHeights * kRays};  // of its irradiance
        // By height: the factors of 1 − A (lower and upper triangle), A: scattering of light that is the same at all heights.
        std::vector<std::array<std::array<std::array<Bands, kRays>, kRays>, kOrders>> factors{kHeights};
    };
    // What air, haze and ground send into each ray under one sun, by height; dark where it is night.
    using Scattering = std::vector<Source>;

    // One height's rays.
    void gather(std::size_t height, Columned& air) const {
        const double x = static_cast<double>(height) / (kHeights - 1);
        const double radius = kEarth_km + kTop_km * x * x * x;
        std::array<BandValues, kRays> by_air{}, by_haze{};
        for (std::size_t i = 0; i < kRays; ++i) {
            Ray& ray = air.rays[height * kRays + i];
            ray = marched(radius, ray_elevation(static_cast<double>(i) + 0.5), kGatherSteps);
            Bands* from_air = &air.by_air[(height * kRays + i) * kHeights];
            Bands* from_haze = &air.by_haze[(height * kRays + i) * kHeights];
            for (const Piece& piece : ray.pieces) {
                const double at = height_index(piece.radius - kEarth_km);
                const std::size_t low = std::min(static_cast<std::size_t>(at), kHeights - 2);
                const double above = at - static_cast<double>(low), below = 1.0 - above;
                for (std::size_t b = 0; b < kBandCount; ++b) {
                    by_air[i][b] += piece.by_air[b];
                    by_haze[i][b] += piece.by_haze[b];
                    from_air[low][b] += static_cast<float>(below * piece.by_air[b]);
                    from_air[low + 1][b] += static_cast<float>(above * piece.by_air[b]);
                    from_haze[low][b] += static_cast<float>(below * piece.by_haze[b]);
                    from_haze[low + 1][b] += static_cast<float>(above * piece.by_haze[b]);
                }
            }
            if (ray.ground)
                for (std::size_t b = 0; b < kBandCount; ++b)
                    air.from_ground[height * kRays + i][b] =
                        static_cast<float>(ray.passed[b] * kGroundAlbedo / kPi);
        }
        for (int m = 0; m < kOrders; ++m) {
            auto& a = air.factors[height][m];
            for (std::size_t i = 0; i < kRays; ++i)
                for (std::size_t k = 0; k < kRays; ++k)
                    for (std::size_t b = 0; b < kBandCount; ++b)
                        a[i][k][b] = (i == k ? 1.0f : 0.0f) -
                                     static_cast<float>(by_air[i][b]) * air_kernel()[m][i][k] -
                                     static_cast<float>(by_haze[i][b]) * haze_kernel()[m][i][k];
            // Less than all light is scattered: no pivots.
            for (std::size_t k = 0; k < kRays; ++k)
                for (std::size_t i = k + 1; i < kRays; ++i) {
                    for (std::size_t b = 0; b < kBandCount; ++b) a[i][k][b] /= a[k][k][b];
                    for (std::size_t l = k + 1; l < kRays; ++l)
                        for (std::size_t b = 0; b < kBandCount; ++b) a[i][l][b] -= a[i][k][b] * a[k][l][b];
                }
        }
    }

    // The light under a sun that is scattered once, in one height's rays.
    Field<kOrders> scattered_once(const Columned& air, std::size_t height, double sun_elevation,
                                  const Turns& haze_turns) const {
        Field<kOrders> once{};
        for (std::size_t i = 0; i < kRays; ++i) {
            const double elevation = ray_elevation(static_cast<double>(i) + 0.5);
            for (int k = 0; k < kOrders; ++k) {
                const double azimuth = kPi * (k + 0.5) / kOrders;
                const Sun sun(sun_elevation, azimuth);
                BandValues sum{};
                add_once(air.rays[height * kRays + i], sun,
                         {air_phase(sun.turned_into(elevation)), haze_turns[i][k], kGroundAlbedo / kPi}, sum);
                for (int m = 0; m < kOrders; ++m) {
                    const double weight = (m > 0 ? 2.0 : 1.0) / kOrders * std::cos(m * azimuth);
                    for (std::size_t b = 0; b < kBandCount; ++b)
                        once[i][m][b] += static_cast<float>(weight * sum[b]);
                }
            }
        }
        return once;
    }

    template <int kCount>
    static void scatter_into(Field<kCount>& out, const Kernel& kernel, const Field<kOrders>& light) {
        for (int i = 0; i < kRays; ++i)
            for (int m = 0; m < kCount; ++m) {
                Bands sum{};
                for (int k = 0; k < kRays; ++k)
                    for (std::size_t b = 0; b < kBandCount; ++b) sum[b] += kernel[m][i][k] * light[k][m][b];
                out[i][m] = sum;
            }
    }

    // One sun's light of all orders, L = L₁ + (scattering of L): by the factors as if it were the same at all heights, and
    // what that leaves unsolved again, kPasses times.
    static Scattering scattering_of(const std::vector<Field<kOrders>>& once, const Columned& air) {
        Scattering more(kHeights);
        std::vector<Field<kOrders>> light(kHeights);
        for (int pass = 0; pass <= kPasses; ++pass) {
            Bands irradiance{};  // of the ground
            for (int k = kRays / 2; k < kRays; ++k) {
                const double low = std::sin(ray_elevation(k)), high = std::sin(ray_elevation(k + 1));
                for (std::size_t b = 0; b < kBandCount; ++b)
                    irradiance[b] += static_cast<float>(kPi * (high * high - low * low)) * light[0][k][0][b];
            }
            for (std::size_t h = 0; h < kHeights; ++h) {
                Field<kOrders> rest = once[h];
                for (std::size_t i = 0; i < kRays; ++i) {
                    for (int m = 0; m < kOrders; ++m)
                        for (std::size_t b = 0; b < kBandCount; ++b) rest[i][m][b] -= light[h][i][m][b];
                    if (pass == 0) continue;
                    const std::size_t ray = h * kRays + i;
                    for (std::size_t b = 0; b < kBandCount; ++b)
                        rest[i][0][b] += air.from_ground[ray][b] * irradiance[b];
                    for (std::size_t from = 0; from < kHeights; ++from) {
                        const Bands &by_air = air.by_air[ray * kHeights + from],
                                    &by_haze = air.by_haze[ray * kHeights + from];
                        if (by_air[0] == 0.0f) continue;
                        const Source& source = more[from];
                        for (int m = 0; m < kAirOrders; ++m)
                            for (std::size_t b = 0; b < kBandCount; ++b)
                                rest[i][m][b] += by_air[b] * source.by_air[i][m][b];
                        for (int m = 0; m < kOrders; ++m)
                            for (std::size_t b = 0; b < kBandCount; ++b)
                                rest[i][m][b] += by_haze[b] * source.by_haze[i][m][b];
                    }
                }
                for (int m = 0; m < kOrders; ++m) {
                    const auto& a = air.factors[h][m];
                    for (std::size_t i = 1; i < kRays; ++i)
                        for (std::size_t k = 0; k < i; ++k)
                            for (std::size_t b = 0; b < kBandCount; ++b)
                                rest[i][m][b] -= a[i][k][b] * rest[k][m][b];
                    for (std::size_t i = kRays; i-- > 0;) {
                        for (std::size_t k = i + 1; k < kRays; ++k)
                            for (std::size_t b = 0; b < kBandCount; ++b)
                                rest[i][m][b] -= a[i][k][b] * rest[k][m][b];
                        for (std::size_t b = 0; b < kBandCount; ++b) {
                            rest[i][m][b] /= a[i][i][b];
                            light[h][i][m][b] += rest[i][m][b];
                        }
                    }
                }
            }
            for (std::size_t h = 0; h < kHeights; ++h) {
                scatter_into<kAirOrders>(more[h].by_air, air_kernel(), light[h]);
                scatter_into<kOrders>(more[h].by_haze, haze_kernel(), light[h]);
            }
        }
        return more;
    }

    // The table's suns from the first to the last. Suns have the same places whichever of them a table needs, and are kept, with their air:
    // a sun that moves needs few others from frame to frame. Without the lock while they are made: a thread that waits inside for the
    // others may be given other work, which may be another sky's.
    std::vector<std::shared_ptr<const Scattering>> suns_to(int last) const {
        struct Kept {
            double turbidity = 0.0;
            std::shared_ptr<const Columned> air;
            std::map<int, std::shared_ptr<const Scattering>> suns;
        };
        static std::mutex mutex;
        static Kept kept;
        Kept now;
        {
            const std::lock_guard lock(mutex);
            if (kept.turbidity == turbidity_) now = kept;
        }
        std::vector<int> missing;
        for (int node = first_; node <= last; ++node)
            if (!now.suns.contains(node)) missing.push_back(node);
        if (!missing.empty()) {
            now.turbidity = turbidity_;
            if (!now.air) {
                const auto air = std::make_shared<Columned>();
                tbb::parallel_for(std::size_t{0}, kHeights, [&](std::size_t i) { gather(i, *air); });
                now.air = air;
            }
            std::vector<std::shared_ptr<const Scattering>> made(missing.size());
            tbb::parallel_for(std::size_t{0}, missing.size(), [&](std::size_t m) {
                const double sun = node_elevation(missing[m]);
                made[m] = std::make_shared<const Scattering>(sun < kNight ? Scattering(kHeights)
                                                                          : scattering_under(sun, *now.air));
            });
            for (std::size_t m = 0; m < missing.size(); ++m) now.suns[missing[m]] = made[m];
            const std::lock_guard lock(mutex);
            if (kept.turbidity == turbidity_) now.suns.merge(std::map(kept.suns));
            kept = now;
        }
        std::vector<std::shared_ptr<const Scattering>> suns;
        for (int node = first_; node <= last; ++node) suns.push_back(now.suns.at(node));
        return suns;
    }
    Scattering scattering_under(double sun_elevation, const Columned& air) const {
        const Turns turns = haze_turns(sun_elevation);
        std::vector<Field<kOrders>> once(kHeights);
        tbb::parallel_for(std::size_t{0}, kHeights, [&](std::size_t height) {
            once[height] = scattered_once(air, height, sun_elevation, turns);
        });
        return scattering_of(once, air);
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

    // The haze's phase function for each ray of gather() and each azimuth of a sun, averaged over the ray's solid angle,
    // which is wider than the forward lobe.
    static Turns haze_turns(double sun_elevation) {
        constexpr int kParts = 6;
        Turns means{};
        for (int i = 0; i < kRays; ++i)
            for (int k = 0; k < kOrders; ++k) {
                double sum = 0.0, weight = 0.0;
                for (int a = 0; a < kParts; ++a) {
                    const double azimuth = kPi * (k + (a + 0.5) / kParts) / kOrders;
                    const Sun sun(sun_elevation, azimuth);
                    for (int e = 0; e < kParts; ++e) {
                        const double elevation = ray_elevation(i + (e + 0.5) / kParts);
                        sum += std::cos(elevation) * haze_phase(sun.turned_into(elevation));
                        weight += std::cos(elevation);
                    }
                }
                means[i][k] = sum / weight;
            }
        return means;
    }

    static double sun_index(double elevation) {
        return std::asinh((elevation + kDusk) / kDuskWidth) / kSunStep;
    }
    static double node_elevation(int node) { return kDuskWidth * std::sinh(kSunStep * node) - kDusk; }
    // The last node but one at or below.
    static int node_below(double elevation) {
        return std::max(kLeastNode, static_cast<int>(std::floor(sun_index(elevation))) - 1);
    }
    static int node_above(double elevation) {
        return std::min(-kLeastNode, static_cast<int>(std::ceil(sun_index(elevation))) + 1);
    }
    static double height_index(double height) {
        return std::cbrt(std::clamp(height / kTop_km, 0.0, 1.0)) * (kHeights - 1);
    }
    // How light falls in dusk, about: by it tabulated light is divided before it is interpolated.
    static double twilight(double sun_elevation) {
        return 1.0 / (1.0 + std::exp(-0.9 * 180.0 / kPi * sun_elevation));
    }

    // The light that a piece of a ray sends to its start after more than one scattering, for any sun: the table at its
    // height and elevation.
    class Row {
      public:
        explicit Row(const Tables& tables)
            : tables_(tables), made_(tables.suns_.size()), by_sun_(tables.suns_.size()) {}

        void move_to(const Piece& piece) {
            std::ranges::fill(made_, 0);
            const double height = piece.radius - kEarth_km;
            const Cubic up(height_index(height), kHeights),
                ray(std::clamp(ray_index(piece.elevation) - 0.5, 0.0, kRays - 1.0), kRays);
            is_hazy_ = height < kHazeless_km;
            for (std::size_t i = 0; i < 4; ++i)
                for (std::size_t k = 0; k < 4; ++k) {
                    Part& part = parts_[4 * i + k];
                    part.height = up.nodes[i];
                    part.ray = ray.nodes[k];
                    const double weight = up.weights[i] * ray.weights[k];
                    for (std::size_t b = 0; b < kBandCount; ++b) {
                        part.by_air[b] = static_cast<float>(weight * piece.by_air[b]);
                        part.by_haze[b] = static_cast<float>(weight * piece.by_haze[b]);
                    }
                }
        }

        // side: cosine of the azimuth between ray and sun.
        void add(double sine, double side, BandValues& sum) {
            const double elevation = std::asin(std::clamp(sine, -1.0, 1.0));
            const Cubic across(std::clamp(sun_index(elevation) - tables_.first_, 0.0,
                                          static_cast<double>(tables_.suns_.size() - 1)),
                               tables_.suns_.size());
            std::array<double, kOrders> turns{1.0, side};
            for (int m = 2; m < kOrders; ++m) turns[m] = 2.0 * side * turns[m - 1] - turns[m - 2];
            const double now = twilight(elevation);
            Bands all{};
            for (std::size_t j = 0; j < 4; ++j) {
                const std::size_t node = across.nodes[j];
                if (!made_[node]) make(node);
                const double weight = across.weights[j] * (now / tables_.twilight_[node]);
                for (int m = 0; m < (is_hazy_ ? kOrders : kAirOrders); ++m) {
                    const auto part = static_cast<float>(weight * turns[m]);
                    for (std::size_t b = 0; b < kBandCount; ++b) all[b] += part * by_sun_[node][m][b];
                }
            }
            for (std::size_t b = 0; b < kBandCount; ++b)
                sum[b] += std::max(static_cast<double>(all[b]), 0.0);  // a cubic undershoots in dusk
        }

      private:
        void make(std::size_t sun) {
            made_[sun] = 1;
            std::array<Bands, kOrders> out{};
            for (const Part& part : parts_) {
                const Source& from = (*tables_.suns_[sun])[part.height];
                for (int m = 0; m < kAirOrders; ++m)
                    for (std::size_t b = 0; b < kBandCount; ++b)
                        out[m][b] += part.by_air[b] * from.by_air[part.ray][m][b];
                if (!is_hazy_) continue;
                for (int m = 0; m < kOrders; ++m)
                    for (std::size_t b = 0; b < kBandCount; ++b)
                        out[m][b] += part.by_haze[b] * from.by_haze[part.ray][m][b];
            }
            by_sun_[sun] = out;
        }

        static constexpr double kHazeless_km = 16.0 * kHazeScale_km;  // where 1e-7 of it is left
        // What of the table's nodes around the piece, and how much of it.
        struct Part {
            std::size_t height, ray;
            Bands by_air, by_haze;
        };
        const Tables& tables_;
        bool is_hazy_ = true;
        std::array<Part, 16> parts_{};
        std::vector<char> made_;
        std::vector<std::array<Bands, kOrders>> by_sun_;
    };

    double turbidity_, sun_elevation_, highest_km_;
    int first_;  // of the table's suns
    std::vector<double> twilight_;
    Thickness vertical_;
    std::vector<std::shared_ptr<const Scattering>> suns_;
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

BandValues Atmosphere::transmittance(const SightLine& line) const {
    return tables_->transmittance(line);
}

std::vector<Atmosphere::Scattered> Atmosphere::scattered(const SightLine& line,
                                                         std::span<const double> azimuths_rad,
                                                         double sun_elevation_rad) const {
    return tables_->scattered(line, azimuths_rad, sun_elevation_rad);
}

}  // namespace pelagic
