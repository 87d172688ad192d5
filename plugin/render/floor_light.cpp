#include "plugin/render/floor_light.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/glm.hpp>
#include <set>
#include <span>
#include <utility>

#include "core/scene/number_keys.h"
#include "core/surface/footprint_levels.h"
#include "plugin/light/caustics.h"
#include "plugin/light/light.h"

namespace pelagic {
namespace {

// The finer map's: the net of light at that depth has lines some three texels wide.
constexpr double kTexelsADepth = 128.0;
// Where pixels are as wide as a net's mesh, it is even.
constexpr double kMeshesADepth = 8.0;
constexpr int kShaftSide = 512;       // texels of the shafts' map
constexpr double kMostMargin = 0.25;  // over a map's side

SunThroughWaves sun_of(const FloorLightWanted& wanted) {
    return {.to_sun = wanted.sun_direction,
            .angular_radius = wanted.sun_angular_radius,
            .waves = wanted.water.waves};
}

template <class T>
void fill(const CausticsMap& map, const Floor& floor, const Frame<T>& frame, const FloorLightWanted& wanted,
          double depth_m, const std::atomic<bool>* cancel) {
    find_caustics(map, floor, frame, 0, sun_of(wanted),
                  {.depth_m = depth_m,
                   .most_margin_m = kMostMargin * map.side * map.texel_m,
                   .finest_cell_m = wanted.finest_cell_m},
                  cancel);
}

// Where most of the floor is looked at from near: some depths ahead.
glm::dvec2 middle_of(const View& view, double width_m) {
    const glm::dvec2 forward(view.forward);
    const double level = glm::length(forward);
    return glm::dvec2(view.position_m) +
           (level > 1e-6 ? forward / level : glm::dvec2(0.0)) * (0.45 * width_m * std::min(2.0 * level, 1.0));
}

// Of a floor of uneven depth the least that is in the picture, by steps of √2, so that the maps stay as they are while the camera moves a little.
double depth_before(const View& view, const Floor& floor) {
    constexpr int kRays = 5;  // a side
    double least_m = floor.depth_m(glm::dvec2(view.position_m));
    bool is_first = view.position_m.z > 0.0;
    for (int y = 0; y < kRays; ++y)
        for (int x = 0; x < kRays; ++x) {
            const glm::dvec3 to = view.direction((glm::dvec2(x, y) + 0.5) / static_cast<double>(kRays) *
                                                 glm::dvec2(view.resolution));
            if (!(view.position_m.z > 0.0 && to.z < -0.02)) continue;
            const double here_m =
                floor.depth_m(glm::dvec2(view.position_m) + view.position_m.z / -to.z * glm::dvec2(to));
            least_m = is_first ? here_m : std::min(least_m, here_m);
            is_first = false;
        }
    return std::exp2(0.5 * std::round(2.0 * std::log2(std::max(least_m, 0.01))));
}

}  // namespace

void set_footprints(FloorLightWanted& wanted, const DrawnSea& drawn, const SeaView& seen) {
    const DrawnSea::Needs needs = drawn.needs(seen);
    const bool has_levels = drawn.grid_options().has_levels;
    const auto first = [&](double finest_m) { return has_levels ? first_level_m(finest_m) : finest_m; };
    wanted.finest_m = first(needs.finest_pixel_m);
    wanted.finest_cell_m = first(std::max(needs.finest_cell_m, needs.finest_pixel_m));
}

FloorLightNeeds floor_light_needs(const Scene& scene, const WaterBody& water, double waves_m, double finest_m,
                                  int side) {
    if (!water.has_body || scene.water.caustics == 0.0) return {};
    double lowest_m = scene.camera.position_m.z;
    for (const auto& key : scene.camera.keys) lowest_m = std::min(lowest_m, key.position_m.z);
    const bool has_map = scene.sea.depth_file != SeaState{}.depth_file,
               shows = has_map || (shows_floor(water, static_cast<double>(water.floor_m)) &&
                                   kMeshesADepth * finest_m <= static_cast<double>(water.floor_m)),
               has_shafts = lowest_m < waves_m;
    const auto texels = [](int of_side) {
        return static_cast<std::size_t>(of_side) * static_cast<std::size_t>(of_side);
    };
    const std::size_t on_floor = shows ? 2 * texels(side) : 0, in_water = has_shafts ? texels(kShaftSide) : 0;
    // Shafts have a level of half the side after the other: a third more, and once more while they grow.
    return {.held_bytes = (on_floor + 3 * in_water) * sizeof(float),
            .making_bytes = std::max(shows ? caustics_bytes(side, kMostMargin) : 0,
                                     has_shafts ? caustics_bytes(kShaftSide, kMostMargin) : 0),
            .texels = on_floor + (lowest_m < 0.0 ? in_water : 0)};  // above that few waves reach the lens
}

FloorLightNeeds most_floor_light_needs(const Scene& scene, const Plan& plan) {
    const PreparedScene& prepared = *plan.from;
    const double finest_m = plan.queries.front().query.pixel_m.front();
    // It is at one of the keys, since the way to the floor and how clear the water is go straight from key to key, or nearly.
    std::set<int> frames{scene.shot.first_frame};
    for (const KeyedNumber& number : scene.keyed)
        for (const NumberKeys::Key& key : number.keys.keys)
            frames.insert(std::clamp(key.frame, scene.shot.first_frame, scene.shot.last_frame));
    FloorLightNeeds most;
    for (const int frame : frames) {
        const Scene moment = scene_at(scene, frame);
        const FloorLightNeeds here = floor_light_needs(moment, make_water(moment, prepared.spectrum),
                                                       prepared.extent.height_m, finest_m);
        if (here.bytes() > most.bytes()) most = here;
    }
    return most;
}

bool shows_floor(const WaterBody& water, double depth_m) {
    if (!water.has_body || !(depth_m < 1e6)) return false;
    float clearest = 1e9f;
    for (const auto& [a, b] : {std::pair(water.absorption.shorter, water.backscatter.shorter),
                               std::pair(water.absorption.longer, water.backscatter.longer)})
        for (int i = 0; i < 3; ++i) clearest = std::min(clearest, a[i] + b[i]);
    constexpr double kWays = 2.2;  // down and up again, both a little slanted
    return kWays * static_cast<double>(clearest) * depth_m < std::log(100.0);
}

namespace {

// In the water about as deep as a camera in it looks through: its map, as wide as eight of that depth.
template <class T>
void light_shafts(Floor& floor, const Frame<T>& frame, const FloorLightWanted& wanted, double gain,
                  const std::atomic<bool>* cancel) {
    constexpr double kShallowest_m = 1.0, kDeepest_m = 12.0, kDepths = 8.0;
    const double eye_m = floor.rest_m() - wanted.view.position_m.z,
                 depth_m = std::clamp(eye_m, kShallowest_m, kDeepest_m);
    const double texel_m = std::max(kDepths * depth_m / kShaftSide, wanted.finest_m);
    // An eye deeper than the plane sees the light that came through it nearer to the sun.
    const glm::dvec2 middle = middle_of(wanted.view, kShaftSide * texel_m) -
                              std::max(eye_m - depth_m, 0.0) * level_way(sun_of(wanted));
    const Floor::Shafts shafts{
        .side = kShaftSide,
        .texel_m = texel_m,
        .depth_m = depth_m,
        .from_m = texel_m * glm::floor((middle - 0.5 * kShaftSide * texel_m) / texel_m),
        .gain = gain};
    fill({shafts.from_m, texel_m, kShaftSide, floor.set_shafts(shafts)}, Floor(depth_m), frame, wanted,
         depth_m, cancel);
    floor.halve_shafts();
}

}  // namespace

template <class T>
void light_floor(Floor& floor, const Frame<T>& frame, const FloorLightWanted& wanted,
                 const std::atomic<bool>* cancel) {
    const View& view = wanted.view;
    const int side = wanted.side;
    const double gain = wanted.gain * caustics_share(sun_of(wanted));
    const double depth_m =
        floor.has_depths() ? depth_before(view, floor) : static_cast<double>(wanted.water.floor_m);
    floor.set_light({});
    if (!(gain > 0.0)) return;
    if (depth_m > 0.0 && shows_floor(wanted.water, depth_m) && kMeshesADepth * wanted.finest_m <= depth_m) {
        const double texel_m = std::max(depth_m / kTexelsADepth, wanted.finest_m);
        Floor::Light light{.side = side, .texel_m = texel_m, .from_m = {}, .gain = gain};
        const double coarse_m = kFloorLightStep * texel_m;
        for (std::size_t i = 0; i < 2; ++i) {
            const double width_m = side * texel_m * (i == 0 ? 1.0 : kFloorLightStep);
            light.from_m[i] = coarse_m * glm::floor((middle_of(view, width_m) - 0.5 * width_m) / coarse_m);
        }
        const std::span<float> texels = floor.set_light(light);
        const auto count = static_cast<std::size_t>(side) * static_cast<std::size_t>(side);
        for (std::size_t i = 0; i < 2; ++i)
            fill({light.from_m[i], texel_m * (i == 0 ? 1.0 : kFloorLightStep), side,
                  texels.subspan(i * count, count)},
                 floor, frame, wanted, depth_m, cancel);
    }
    if (wanted.is_below) light_shafts(floor, frame, wanted, gain, cancel);
}

template void light_floor(Floor&, const Frame<float>&, const FloorLightWanted&, const std::atomic<bool>*);
template void light_floor(Floor&, const Frame<double>&, const FloorLightWanted&, const std::atomic<bool>*);

}  // namespace pelagic
