#include <epoxy/gl.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/vec4.hpp>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "core/evaluate/values.h"
#include "core/lighting/meniscus.h"
#include "core/plan/hulls.h"
#include "core/plan/plan.h"
#include "core/plan/quality.h"
#include "core/scene/number_keys.h"
#include "core/surface/earth.h"
#include "core/surface/footprint_levels.h"
#include "core/surface/view.h"
#include "core/waves/whitecaps.h"
#include "plugin/host/gpu/packed_foam.h"
#include "plugin/host/gpu/sea_layout.h"
#include "plugin/host/preview/drawn_objects.h"
#include "plugin/host/preview/offscreen.h"
#include "plugin/light/light.h"
#include "plugin/machine/memory.h"
#include "plugin/render/floor_light.h"
#include "plugin/render/seen_drops.h"
#include "plugin/render/spray_map.h"
#include "plugin/render/under_water.h"
#include "plugin/render/waterline.h"

namespace pelagic {
namespace {

int largest_picture() {
    std::array<GLint, 3> largest{};
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, largest.data());
    glGetIntegerv(GL_MAX_VIEWPORT_DIMS, largest.data() + 1);
    return *std::min_element(largest.begin(), largest.end());
}

void check_size(glm::ivec2 size) {
    const int largest = largest_picture();
    if (size.x >= 1 && size.y >= 1 && std::max(size.x, size.y) <= largest) return;
    throw PreviewError("a picture of " + std::to_string(size.x) + " x " + std::to_string(size.y) +
                       " does not fit the driver (" +
                       reinterpret_cast<const char*>(glGetString(GL_RENDERER)) + "), whose largest is " +
                       std::to_string(largest) +
                       " a side: ask for a smaller one with --size, or use pelagic render");
}

// Positions of the mesh's points, relative to its origin, with the waves that its cells resolve.
std::vector<glm::vec3> positions_of(const Frame<float>& frame, const SeaMesh& mesh) {
    const ProjectedGrid& grid = mesh.points;
    std::vector<glm::vec3> positions(grid.rest_m.size());
    Results<float> results;
    results.set(Product::Position, {positions.data()});
    evaluate(frame, 0,
             Points<float>{.origin_m = grid.origin_m,
                           .count = positions.size(),
                           .rest_m = {grid.rest_m.data()},
                           .cell_m = {grid.cell_m.data()},
                           .cell_axis_m = {grid.cell_axis_m.data()}},
             results);
    for (std::size_t i = 0; i < mesh.height_m.size(); ++i) positions[i].z += mesh.height_m[i];
    for (glm::vec3& position : positions)
        position = glm::vec3(on_earth(glm::dvec3(position), grid.curvature_per_m));
    return positions;
}

// The finest footprint of a pixel that shows the sea, or more than any where none does: the least of all triangles
// that reach into the picture.
double finest_pixel_in_view(const View& view, const SeaMesh& mesh, std::span<const glm::vec3> positions) {
    const glm::dmat4 clip_from = view.clip_from(glm::dvec3(mesh.points.origin_m, 0.0), kNear_m);
    constexpr int kPlanes = 5;
    std::vector<std::uint8_t> outside(positions.size());  // of which planes, a bit each
    for (std::size_t i = 0; i < positions.size(); ++i) {
        const glm::dvec4 p = clip_from * glm::dvec4(positions[i], 1.0);
        const std::array<bool, kPlanes> beyond{p.x > p.w, p.x<-p.w, p.y> p.w, p.y < -p.w, p.z < -p.w};
        for (int plane = 0; plane < kPlanes; ++plane)
            outside[i] |= static_cast<std::uint8_t>(beyond[plane] ? 1 << plane : 0);
    }
    double finest_m = std::numeric_limits<double>::infinity();
    for (std::size_t t = 0; t + 2 < mesh.triangles.size(); t += 3) {
        const std::span corners = std::span(mesh.triangles).subspan(t, 3);
        if ((outside[corners[0]] & outside[corners[1]] & outside[corners[2]]) != 0) continue;
        for (const std::uint32_t corner : corners)
            finest_m = std::min(finest_m, static_cast<double>(mesh.points.pixel_m[corner]));
    }
    return finest_m;
}

// [bytes] of a point of the grid: itself and while it is made, as a vertex, and in triangles, here and at the driver's.
constexpr std::size_t kPointBytes = 3 * sizeof(glm::vec2) + 2 * sizeof(float) + 2 * sizeof(double) +
                                    2 * (2 * sizeof(glm::vec4) + 6 * sizeof(std::uint32_t)) +
                                    sizeof(glm::vec3);
// [bytes/pixel] of the driver's pictures of five terms, the points and their depth; of what is read back from it.
constexpr std::size_t kDrawnBytes = 8 * sizeof(glm::vec4) + sizeof(float),
                      kReadBytes = sizeof(SeaRadiance) + 1 + sizeof(glm::vec4);
// [bytes/pixel] of those that look through water on the glass, which may be all of a long lens; their vectors double as they grow.
constexpr std::size_t kClimbedBytes = 2 * (sizeof(std::size_t) + sizeof(MeniscusSight)) + sizeof(SeaRadiance);
// Mesa's driver in software, with its compiler and the programs of this sea.
constexpr std::size_t kDriverBytes = std::size_t{64} << 20;

// Whether some of the picture may look through water, and some through air: both are drawn.
bool is_half_below(const DrawnSea& drawn, const View& view) {
    return drawn.has_below() && !drawn.is_below(view) &&
           may_be_in_water(view, drawn.grid_options().bounds.height_m);
}

std::string smaller() {
    return "ask for a smaller picture (--size) or raise surface.cell_px";
}

}  // namespace

MemoryNeed offscreen_memory(const OffscreenPlan& planned, int threads) {
    MemoryNeed need;
    machine::add_program(need);
    machine::add_sky(need);
    add_sea(need, planned.plan, threads);
    // Fields of the frame are freed one after another, as soon as the driver has them.
    const std::size_t frame = planned.plan.frame_bytes();
    std::size_t textures = 0, largest = 0;
    for (const SeaLayout::Plane& plane : SeaLayout::planes_of(planned.plan, 0)) {
        const std::size_t bytes = static_cast<std::size_t>(plane.size.x) *
                                  static_cast<std::size_t>(plane.size.y) *
                                  static_cast<std::size_t>(plane.channels) * sizeof(float);
        textures += bytes;
        largest = std::max(largest, bytes);
    }
    need.add("the frame's grids as textures", std::max(textures, frame + largest) - frame,
             "lower quality.level (--quality draft), or the resolutions in waves.cascades");
    if (planned.plan.foam)
        need.add("the foam as textures",
                 2 * PackedFoam::bytes_for(*planned.plan.foam, planned.plan.foam_history_bytes()),
                 "lower effects.foam_decay_s");
    if (const std::size_t coast = SeaLayout::coast_sizes_of(planned.plan).bytes(); coast > 0)
        need.add("the coast as textures", 2 * coast, "lower waves.trains");
    const glm::ivec2 size = planned.scene.camera.resolution;
    need.add("the picture",
             static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) *
                 (kDrawnBytes + (is_half_below(*planned.drawn, view_at(planned.scene.camera, planned.frame))
                                     ? 2 * kReadBytes + kClimbedBytes
                                     : kReadBytes)),
             "ask for a smaller picture (--size)");
    const std::size_t points = planned.mesh.points.rest_m.size();
    need.add("the camera's grid of points", points * kPointBytes, smaller());
    if (planned.scene.surface.kind == SurfaceKind::Cage)
        need.add("the cage's surface", planned.drawn->surface_bytes(points) + points * sizeof(glm::vec4),
                 "lower surface.cage_level, or raise surface.cell_px");
    if (const std::size_t floor =
            floor_light_needs(planned.scene, make_water(planned.scene, planned.plan.from->spectrum),
                              planned.plan.from->extent.height_m)
                .bytes();
        floor > 0)
        need.add("the sun's light on the floor", floor, "set water.caustics to 0");
    if (const std::size_t pictures = floor_bytes(planned.scene); pictures > 0)
        need.add("the floor's pictures", pictures, "give smaller ones");
    if (render_options(planned.scene).lighting.spray) {
        need.add("the map of the spray", spray_map_bytes(spray_map_size(size.x)),
                 "set effects.spray to false");
        add_seen_drops(need, planned.plan);
    }
    if (!planned.scene.objects.empty())
        need.add("the objects", DrawnObjects::bytes(planned.scene), "give simpler meshes");
    need.add("the driver", kDriverBytes, smaller());
    return need;
}

OffscreenPlan plan_offscreen(const Scene& scene, int frame, glm::ivec2 size, std::size_t max_memory_bytes) {
    OffscreenPlan planned{
        .scene = scene_at(scene, frame), .frame = frame, .plan = {}, .mesh = {}, .drawn = {}};
    if (size.x > 0 && size.y > 0) planned.scene.camera.resolution = size;
    check_size(planned.scene.camera.resolution);
    const MemoryLimit limit = machine::memory_limit_or(max_memory_bytes);
    const int threads = tbb::this_task_arena::max_concurrency();
    const char* const run = "this picture";

    Scene shot = scene;  // whose sea may have keys
    shot.camera.resolution = planned.scene.camera.resolution;
    const auto prepared = prepare(std::move(shot));
    const SeaView seen{view_at(planned.scene.camera, frame), frame};
    const DrawnSea::Needs needs = DrawnSea(*prepared, false).needs(seen);
    const auto plan_for = [&](ProductSet wanted, double finest_pixel_m) {
        const Query query = view_query(*prepared, {.products = wanted,
                                                   .finest_cell_m = needs.finest_cell_m,
                                                   .finest_pixel_m = finest_pixel_m,
                                                   .points = needs.points});
        std::vector<Query> queries{query};
        if (auto hulls = hulls_query_of_picture(prepared->scene)) queries.push_back(std::move(*hulls));
        return make_plan(prepared, queries, {.double_precision = false});
    };
    // Positions alone, with waves no shorter than the cells: little beside what pixels resolve. They tell which
    // pixels are in the picture. A low camera has points nearby that a crest might bring into view and that no pixel
    // shows: their footprints would ask for gigabytes.
    MemoryNeed first;
    const Plan of_points = plan_for(products(Product::Position), needs.finest_cell_m);
    add_sea(first, of_points, threads);
    first.add("the camera's grid of points", needs.points * kPointBytes, smaller());
    require_memory(first, limit, run, "at least");
    const bool has_levels = of_points.queries.front().query.cell_m.size() > 1;
    planned.drawn = std::make_shared<const DrawnSea>(*prepared, has_levels);
    planned.drawn->lay_out(seen, planned.mesh);
    double finest_pixel_m = needs.finest_pixel_m;
    if (has_levels) {
        Frame<float> state(std::make_shared<const SeaOverTime<float>>(of_points));
        state.set(planned.scene.shot.time_s(frame));
        const double in_view_m =
            finest_pixel_in_view(seen.view, planned.mesh, positions_of(state, planned.mesh));
        // The level below, as every point reads the two levels beside its footprint.
        finest_pixel_m = std::max(first_level_m(needs.finest_pixel_m),
                                  level_below_m(std::min(in_view_m, needs.finest_cell_m)));
    }
    planned.plan = plan_for({}, finest_pixel_m);
    require_memory(offscreen_memory(planned, threads), limit, run);
    return planned;
}

namespace {

// Takes the pixels that look through water from another picture, and draws those that look through what of it climbs the glass.
void take_below(const Waterline& waterline, const View& view, const LightingChoice& lighting, const Sky& sky,
                const WaterBody& water, const FloorSeen& floor, const Picture& below, Picture& picture) {
    const auto width = static_cast<std::size_t>(picture.resolution.x);
    std::vector<float>& object = picture.data[index(PictureLayer::Object)];  // empty without objects
    std::vector<std::size_t> climbed;
    std::vector<MeniscusSight> sights;
    for (std::size_t at = 0; at < picture.layers.size(); ++at) {
        const glm::dvec2 pixel = glm::dvec2(at % width, at / width) + 0.5;
        const double height_m = waterline.height_m(pixel);
        if (height_m < 0.0) {
            picture.layers[at] = below.layers[at];
            picture.sea[at] = below.sea[at];
            if (!object.empty()) object[3 * at] = object[3 * at + 1] = object[3 * at + 2] = 0.0f;
        } else if (meniscus_share(height_m) > 0.0f) {
            climbed.push_back(at);
            sights.push_back({glm::vec3(view.direction(pixel)), static_cast<float>(height_m)});
        }
    }
    std::vector<SeaRadiance> lit(sights.size());
    shade_meniscus(lighting, sky, water, static_cast<float>(view.position_m.z), glm::vec3(view.forward),
                   sights, lit, floor);
    for (std::size_t i = 0; i < climbed.size(); ++i) {
        const float share = meniscus_share(static_cast<double>(sights[i].height_m));
        picture.layers[climbed[i]] = mixed(picture.layers[climbed[i]], lit[i], share);
        if (!object.empty())
            for (std::size_t c = 0; c < 3; ++c) object[3 * climbed[i] + c] *= 1.0f - share;
        if (share == 1.0f) picture.sea[climbed[i]] = 1;
    }
}

// Uploads what earlier breaking has left where the picture's pixels are.
void upload_foam(SeaRenderer& renderer, const std::shared_ptr<const SeaOverTime<float>>& sea, double time_s,
                 const View& view, const SeaMesh& mesh, const BuildWatch& watch) {
    const SeaRenderer::ShownPoints shown = renderer.shown_points(view, mesh);
    FoamHistory<float> history(sea);
    history.set(time_s);
    history.prepare(Points<float>{.origin_m = mesh.points.origin_m,
                                  .count = shown.rest_m.size(),
                                  .rest_m = {shown.rest_m.data()},
                                  .pixel_m = {shown.pixel_m.data()},
                                  .pixel_axis_m = {shown.pixel_axis_m.data()}},
                    0, watch);
    renderer.upload_foam(std::make_shared<const PackedFoam>(history, mesh.points.origin_m));
}

}  // namespace

OffscreenPicture render_offscreen(const OffscreenPlan& planned, const Sky& sky, const OffscreenWatch& watch) {
    const auto shot = std::make_shared<const SeaOverTime<float>>(planned.plan, watch.sea);
    SeaRenderer renderer;
    const View view = view_at(planned.scene.camera, planned.frame);
    const LightingChoice lighting = render_options(planned.scene).lighting;
    Frame<float> state(shot);
    state.set(planned.scene.shot.time_s(planned.frame));
    const std::shared_ptr<const Sea<float>> sea = state.shared_sea();
    const ProjectedGridOptions& grid = planned.drawn->grid_options();
    const bool from_below = planned.drawn->is_below(view);
    const auto floor = std::make_shared<Floor>(make_floor(planned.scene, planned.drawn->rest_m()));
    if (planned.drawn->has_below()) refuse_in_floor(planned.scene, planned.frame, *floor);
    std::optional<Waterline> waterline;
    if (is_half_below(*planned.drawn, view))
        waterline.emplace(view, grid.bounds.height_m, planned.mesh.points.origin_m,
                          std::span<const glm::vec3>(positions_of(state, planned.mesh)),
                          planned.mesh.triangles);
    else if (!from_below)
        planned.drawn->refuse_under_water(state, planned.scene, planned.frame);
    const WaterBody water = make_water(planned.scene, sea->plan().from->spectrum);
    if (water.has_body) {
        if (lighting.water && lighting.sun && sky.sun_irradiance != glm::vec3(0.0f)) {
            FloorLightWanted wanted{.view = view,
                                    .water = water,
                                    .sun_direction = sky.sun_direction,
                                    .sun_angular_radius = sky.sun_angular_radius,
                                    .gain = planned.scene.water.caustics,
                                    .is_below = from_below || (waterline && waterline->is_any_under())};
            set_footprints(wanted, *planned.drawn, {view, planned.frame});
            light_floor(*floor, state, wanted);
        }
        renderer.set_floor(floor);
    }
    renderer.set_sky(sky, water);
    if (!planned.scene.objects.empty())
        renderer.set_objects(
            drawn_objects(state, planned.scene,
                          {.frame = static_cast<double>(planned.frame),
                           .rest_m = [&](glm::dvec2 place) { return planned.drawn->rest_m(place); }}),
            object_surroundings(lighting, sky, water, law_coverage(planned.scene)));
    if (lighting.spray && !from_below) {
        const bool are_near = are_drops_near(planned.scene, view);
        Spray spray = make_spray_map(state, view, grid, spray_map_size(view.resolution.x), are_near);
        light_spray(spray, lighting, sky, water, law_coverage(planned.scene));
        const auto drops = std::make_shared<std::vector<SprayDrop>>();
        if (are_near && !spray.empty())
            SprayDrops<float>(*sea, kDropsSquare_m)
                .at(planned.scene.shot.time_s(planned.frame), glm::dvec2(view.position_m), *drops);
        renderer.set_spray(spray, drops);
    }
    renderer.upload_once(std::move(state), 0);
    const bool lives = planned.plan.foam && lighting.whitecaps;
    if (lives)
        upload_foam(renderer, shot, planned.scene.shot.time_s(planned.frame), view, planned.mesh,
                    watch.foam_past);
    const FoamLook foam = make_foam(planned.scene, make_foam_picture(planned.scene),
                                    lives ? active_foam(planned.scene, sea->residual_coverage()) : 1.0);
    const auto draw = [&](bool below) {
        renderer.draw(view, planned.mesh,
                      {.lighting = lighting,
                       .foam = foam,
                       .from_below = below,
                       .behind_glass = waterline.has_value(),
                       .layers = true});
        return renderer.read_layers();
    };
    OffscreenPicture drawn{draw(from_below), renderer.device(), {}};
    if (waterline)
        take_below(*waterline, view, lighting, sky, water,
                   floor->seen_from({.position_m = view.position_m,
                                     .curvature_per_m = planned.mesh.points.curvature_per_m,
                                     .pixel_tangent = view.pixel_tangent()}),
                   draw(true), drawn.picture);
    if (quality_of(planned.scene.quality.level).double_precision)
        drawn.note =
            "the preview computes in single precision, quality.level \"reference\" in double: "
            "use pelagic render for that";
    return drawn;
}

}  // namespace pelagic
