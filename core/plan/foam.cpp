#include "core/plan/foam.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>

#include "core/base/constants.h"
#include "core/plan/weather.h"
#include "core/scene/lens.h"
#include "core/spectrum/cox_munk.h"
#include "core/spectrum/dispersion.h"
#include "core/surface/footprint_levels.h"

namespace pelagic {

double FoamPlan::cell_of(int level) const {
    return std::ldexp(cell_m, level);
}

glm::dvec2 FoamPlan::drift_of(int level) const {
    if (!(loop_s > 0.0)) return drift_mps;
    const double cell_mps = cell_of(level) / loop_s;
    return {cell_mps * std::round(drift_mps.x / cell_mps), cell_mps * std::round(drift_mps.y / cell_mps)};
}

int FoamPlan::intervals() const {
    return static_cast<int>(std::ceil(window_s / step_s)) + 1;
}

std::size_t FoamPlan::tile_bytes() const {
    const auto kept = static_cast<std::size_t>(intervals() + kSpareIntervals);
    return kTileStride * (kept * sizeof(std::uint16_t) + (6 + sums()) * sizeof(float));
}

FoamPlan::Weight FoamPlan::weight(double from_s, double to_s) const {
    const double a = std::max(from_s, 0.0), b = std::min(to_s, window_s);
    if (!(a < b)) return {};
    const double at_a = std::exp(-a / decay_s), at_b = std::exp(-b / decay_s);
    return {decay_s * (at_a - at_b), decay_s * ((a + decay_s) * at_a - (b + decay_s) * at_b)};
}

namespace {

namespace bubbles {
using std::exp, std::max, std::pow;
#include "core/base/bubbles.inl"
}  // namespace bubbles

// ∫ f from a to b, by Simpson's rule.
template <class F>
double integral(double a, double b, int pairs, const F& f) {
    const double h = 0.5 * (b - a) / pairs;
    double sum = f(a) - f(b);
    for (int i = 0; i < pairs; ++i) sum += 4.0 * f(a + (2 * i + 1) * h) + 2.0 * f(a + (2 * i + 2) * h);
    return sum * h / 3.0;
}

}  // namespace

double FoamPlan::bubbles_weight_s(double from_s, double to_s) const {
    const double a = std::max(from_s, 0.0), b = std::min(to_s, window_s);
    if (!(a < b && bubbles_m > 0.0)) return 0.0;
    const int pairs = 2 + static_cast<int>(std::min((b - a) / std::min(bubbles_m, 1.0), 100.0));
    return integral(a, b, pairs, [&](double age_s) {
        const double late = std::clamp(3.0 * age_s / window_s - 2.0, 0.0, 1.0);
        return (1.0 - late * late * (3.0 - 2.0 * late)) *
               bubbles::bubbles_left(static_cast<float>(age_s), static_cast<float>(bubbles_m));
    });
}

bool has_bubbles(const Scene& scene) {
    return scene.water.body && scene.water.bubbles > 0.0;
}

double breaker_height_m(const Scene& scene, const DirectionalSpectrum& spectrum) {
    // Most whitecaps are those of waves much shorter than the peak's, some 0.4 of its speed and 0.3 of its height.
    constexpr double kBreakerOverHs = 0.3;
    SeaState wind = scene.sea;  // swell doesn't break in the open sea
    wind.swell.clear();
    const double m0 =
        scene.sea.swell.empty() ? spectrum.m0() : DirectionalSpectrum(wind, scene.waves.band_gains).m0();
    return kBreakerOverHs * 4.0 * std::sqrt(m0);
}

double highest_breaker_m(const PreparedScene& prepared) {
    if (!prepared.weather) return breaker_height_m(prepared.scene, prepared.spectrum);
    double highest_m = 0.0;
    for (const Weather::Key& key : prepared.weather->keys)
        highest_m = std::max(highest_m, breaker_height_m(key.sea->scene, key.sea->spectrum));
    return highest_m;
}

double bubbles_depth_m(const Scene& scene, const DirectionalSpectrum& spectrum) {
    return 0.25 * breaker_height_m(scene, spectrum);  // clouds reach half of it: Kalvoda 2003
}

FoamPlan plan_foam(const Scene& scene, double finest_m, double steps_a_period) {
    const Effects& effects = scene.effects;
    constexpr double kFinestCell_m = 0.25;
    constexpr double kCell =
        1.4;  // of the finest that breaking resolves: a half as many cells, and none of the foam is lost
    constexpr double kWindow = 3.0;  // 5 % of the foam is older
    FoamPlan foam;
    foam.decay_s = effects.foam_decay_s;
    foam.window_s = kWindow * foam.decay_s;
    foam.cell_m = std::max(kCell * finest_m, kFinestCell_m);
    foam.past_m = finest_m;
    foam.step_s = std::sqrt(kTwoPi * 2.0 * foam.cell_m / kGravity) / steps_a_period;
    const double towards = scene.sea.wind_direction_deg * kPi / 180.0;
    foam.drift_mps =
        effects.foam_drift * scene.sea.wind_speed_mps * glm::dvec2(std::cos(towards), std::sin(towards));
    foam.loop_s = scene.shot.sea_loop_s();
    if (foam.loop_s > foam.step_s)
        foam.step_s = foam.loop_s / std::ceil(foam.loop_s / foam.step_s);
    else if (foam.loop_s > 0.0)  // whole loops: each interval sees the same of them
        foam.step_s = foam.loop_s * std::round(foam.step_s / foam.loop_s);
    return foam;
}

float foam_footprint_m(float width_m, float length_m) {
    return length_m > width_m ? std::sqrt(width_m * length_m) : width_m;
}

FoamLevelBlend foam_level_blend(const FoamPlan& foam, float footprint_m) {
    const float cells = 2.0f * footprint_m / static_cast<float>(foam.cell_m);
    if (!(cells > 1.0f)) return {};
    const int level = std::ilogb(cells);
    if (level >= FoamPlan::kLevels) return {FoamPlan::kLevels, 0.0f};
    return {level, std::ldexp(cells, -level) - 1.0f};
}

namespace {

// How far the water that is kept from one time to another drifts between them, in tiles.
glm::dvec2 drift_between(const FoamPlan& foam, int level) {
    const double tile_m = FoamPlan::kTileCells * foam.cell_of(level);
    return glm::abs(foam.drift_of(level)) * (foam.window_s + FoamPlan::kSpareIntervals * foam.step_s) /
           tile_m;
}

double tiles_over(const FoamPlan& foam, int level, double side_m) {
    const glm::dvec2 sides =
        side_m / (FoamPlan::kTileCells * foam.cell_of(level)) + drift_between(foam, level);
    return (std::ceil(sides.x) + 1.0) * (std::ceil(sides.y) + 1.0);
}

// What of the sea round it a camera at rest shows: distances from below it, and half the angle that it sees.
struct Sector {
    double nearest_m = 0.0, farthest_m = std::numeric_limits<double>::infinity(), half_angle = kPi;
};

Sector sector_of(const Camera& camera, double height_m) {
    const glm::dvec3 ahead = glm::normalize(camera.look_at_m - camera.position_m);
    const double level = std::hypot(ahead.x, ahead.y);
    const double across = std::tan(0.5 * lens_fov_deg(camera) * kPi / 180.0);
    const double upright = across * camera.resolution.y / camera.resolution.x;
    // Of the frame's lowest and highest lines: how far ahead and how far down a ray of length 1 along the axis goes.
    const double middle = 2.0 * across * camera.shift_y, down = upright - middle, up = upright + middle;
    const glm::dvec2 low(level + down * ahead.z, down * level - ahead.z),
        high(level - up * ahead.z, -up * level - ahead.z);
    const auto distance_m = [&](glm::dvec2 line, double aside) {
        return line.y > 0.0 ? height_m * std::hypot(line.x, aside) / line.y
                            : std::numeric_limits<double>::infinity();
    };
    if (!(low.y > 0.0)) return {.farthest_m = 0.0};  // no sea is in the frame
    Sector sector{.farthest_m = std::max(distance_m(low, across), distance_m(high, across))};
    const double least_ahead = std::min(low.x, high.x);
    if (!(least_ahead > 0.0)) return sector;  // what is below it is in the frame
    sector.half_angle = std::atan(across * (1.0 + 2.0 * std::abs(camera.shift_x)) / least_ahead);
    sector.nearest_m = distance_m(low, 0.0);
    return sector;
}

// Which points a view asks for: a picture's or a mesh's, all round a camera or those of its frame.
struct ViewKind {
    bool are_pictures = false, is_of_frame = false, is_run = false;
    double faces = 0.0;  // the slope of waves' faces that pixels see
};

// Those whose cells footprints of so many of a camera's pixels need, whichever way it turns, or in its frame alone. A pixel is
// α s wide and α s/sin γ long at the slant distance s from an eye at the height h, sin γ = h/s on a flat sea: its area is that of
// the square of a cell at s = (cell/α)^⅔ h^⅓, and further away coarser levels have it. Where h/s is less than the slope of waves'
// faces those are seen under γ of that slope: their pixels have that area at s = cell/α √slope.
double tiles_in_view(const FoamPlan& foam, int level, const Camera& camera, double pixels,
                     const ViewKind& kind) {
    const double cell_m = foam.cell_of(level);
    const auto pixel_of = [&](double fov_deg) {
        return pixels * 2.0 * std::tan(0.5 * fov_deg * kPi / 180.0) / camera.resolution.x;
    };
    const auto reach_m = [&](double height_m, double fov_deg, double footprint_m, double faces) {
        const double wide_m = footprint_m / pixel_of(fov_deg);
        // Seen steeply no wave hides another, and each pixel counts with the footprint that blurs as it does: kPixel of
        // core/surface/projected_grid.cpp. What the faces' fit says of level views has that in it: to slants of kSteep heights,
        // 14° below the horizon, where waves begin to hide each other.
        constexpr double kPixel = 0.6, kSteep = 4.0;
        const auto slant_of = [&](double pixel_wide_m) {
            return std::pow(pixel_wide_m, 2.0 / 3.0) * std::cbrt(height_m);
        };
        const double steep_m = kind.is_of_frame && kind.are_pictures
                                   ? std::min(slant_of(wide_m / kPixel), kSteep * height_m)
                                   : 0.0;
        const double slant_m = std::max({slant_of(wide_m), wide_m * std::sqrt(faces), steep_m});
        return std::sqrt(std::max(slant_m * slant_m - height_m * height_m, 0.0));
    };
    double lowest_m = std::max(camera.position_m.z, 1.0), highest_m = lowest_m,
           narrowest_deg = lens_fov_deg(camera);
    for (const CameraKey& key : camera.keys) {
        const double height_m = std::max(key.position_m.z, 1.0);
        lowest_m = std::min(lowest_m, height_m);
        highest_m = std::max(highest_m, height_m);
        narrowest_deg = std::min(narrowest_deg, key.fov_deg.value_or(lens_fov_deg(camera)));
    }
    // Between the keys a camera passes all heights. The reach grows with the height up to this one.
    const double farthest_height_m = cell_m / pixel_of(narrowest_deg) * std::pow(3.0, -0.75);
    const double farthest_m =
        reach_m(std::clamp(farthest_height_m, lowest_m, highest_m), narrowest_deg, cell_m, kind.faces);
    if (!(farthest_m > 0.0)) return 0.0;
    const double tile_m = FoamPlan::kTileCells * cell_m;
    // A tile that touches a disc lies within a diagonal of it. A camera that moves looks from two places at the two times.
    const double radius = farthest_m / tile_m + std::sqrt(2.0);
    const double round_it = [&] {
        if (kind.are_pictures) return kPi * radius * radius;
        if (!camera.keys.empty()) return 2.0 * kPi * radius * radius;
        return kPi * radius * radius + 2.0 * radius * glm::length(drift_between(foam, level));
    }();
    if (!kind.is_of_frame) return round_it;
    // Footprints of less than a quarter of a cell read finer levels.
    const Sector sector = sector_of(camera, lowest_m);
    const double finer_m = level > 0 ? reach_m(lowest_m, lens_fov_deg(camera), 0.25 * cell_m, 0.0) : 0.0;
    const double from = std::max(sector.nearest_m, finer_m) / tile_m;
    const double to = std::min(sector.farthest_m, farthest_m) / tile_m;
    if (!(from < to)) return 0.0;
    // A region meets so many tiles of a lattice whose place is chance: its area, 2/π of its outline and one (Santaló 1976).
    const double outline = 2.0 * (to - from) + 2.0 * sector.half_angle * (to + from);
    const double in_frame = sector.half_angle * (to * to - from * from) + 2.0 / kPi * outline + 1.0;
    if (!kind.is_run) return in_frame;
    // A run keeps what waves hide for a while, and makes the surroundings as well: fitted to what three frames hold, from 4, 15
    // and, steeply, 60 m.
    constexpr double kRoom = 1.7;
    return std::min(kRoom * (in_frame + outline), round_it);
}

// Those of a mesh from near to far, whose footprints double from square to square (core/surface/near_far.h): a level is read by
// two squares, round the one within them.
double tiles_near_to_far(const FoamPlan& foam, int level, const Surface& surface, double finest_m) {
    const double tile_m = FoamPlan::kTileCells * foam.cell_of(level);
    const double level_m = first_level_m(surface.size_m / surface.resolution);
    const double side = surface.size_m / level_m;  // of the first, in footprints
    if (!(finest_m > 0.0)) finest_m = level_m;     // trains have no levels: each point's own counts
    double tiles = 0.0;
    for (double footprint_m = finest_m; footprint_m < foam.cell_of(level); footprint_m *= 2.0) {
        const FoamLevelBlend blend = foam_level_blend(foam, static_cast<float>(footprint_m));
        if (blend.level != level && blend.level + 1 != level) continue;
        const double within =
            level > 0 && footprint_m > 2.0 * finest_m ? 0.25 * side * footprint_m / tile_m : 0.0;
        tiles = tiles_over(foam, level, side * footprint_m) - within * within;
    }
    return tiles;
}

// Of the RMS slope, since waves hide each other near the horizon. Fitted to what pictures hold, from 4 and 15 m, 6 … 20 m/s.
constexpr double kFaces = 0.4;

}  // namespace

std::array<double, FoamPlan::kLevels> foam_tiles(const FoamPlan& foam, const Scene& scene,
                                                 const std::vector<Query>& queries, bool are_pictures) {
    std::array<double, FoamPlan::kLevels> tiles{};
    const double mean_square = 0.5 * CoxMunk::at_wind(scene.sea.wind_speed_mps).total;  // along one direction
    for (const Query& query : queries) {
        if (!query.asks_for_past()) continue;
        const bool is_view = query.is_view && !query.lattice;
        // Pictures and meshes that a camera lays out know their points. Who looks round, as a preview's window does, doesn't, and a
        // cage lies where it was made.
        const bool is_laid_out = are_pictures ? query.is_picture : scene.surface.kind != SurfaceKind::Cage;
        const ViewKind kind{.are_pictures = are_pictures,
                            .is_of_frame = is_laid_out && query.points > 0 && scene.camera.keys.empty(),
                            // Only pictures make surroundings, and lose tiles behind waves.
                            .is_run = are_pictures && scene.shot.first_frame != scene.shot.last_frame,
                            .faces = are_pictures ? kFaces * std::sqrt(mean_square) : 0.0};
        const bool is_near_to_far = !are_pictures && scene.surface.kind == SurfaceKind::NearFar;
        const double points = static_cast<double>(query.points);
        const double spacing_m = query.lattice ? query.lattice->spacing_m : query.pixel_m.front();
        const FoamLevelBlend blend = foam_level_blend(foam, static_cast<float>(query.pixel_m.front()));
        for (int level = 0; level < FoamPlan::kLevels; ++level) {
            double& here = tiles[static_cast<std::size_t>(level)];
            if (is_view && is_near_to_far)
                here += tiles_near_to_far(foam, level, scene.surface, query.pixel_m.front()) *
                        (scene.camera.keys.empty() ? 1.0 : 2.0);
            else if (is_view)
                here += tiles_in_view(foam, level, scene.camera, are_pictures ? 1.0 : scene.surface.cell_px,
                                      kind);
            else if (level == blend.level || (level == blend.level + 1 && blend.t > 0.0f))
                here += tiles_over(foam, level, std::sqrt(points) * spacing_m);
        }
    }
    return tiles;
}

}  // namespace pelagic
