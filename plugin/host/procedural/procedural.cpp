// The C interface: looks at what comes in, and lets no exception out.
#include "pelagic/procedural.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <exception>
#include <glm/vec3.hpp>
#include <limits>
#include <new>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/scene/budget.h"
#include "core/scene/course.h"
#include "core/scene/limits.h"
#include "core/scene/object_pose.h"
#include "core/surface/earth.h"
#include "core/surface/view.h"
#include "core/waves/folding.h"
#include "pelagic/version.h"
#include "plugin/format/shot/shot.h"
#include "plugin/host/procedural/c_interface.h"
#include "plugin/host/procedural/expansion.h"
#include "plugin/host/procedural/procedural_frame.h"
#include "plugin/light/light.h"

namespace pelagic::procedural {
namespace {

// That messages use.
const char* name_of(const pelagic_source& source) {
    return source.path ? source.path : "shot.toml";
}

// A budget is left out: a renderer says itself how fine its points are.
Scene scene_of(const pelagic_source& source) {
    if (source.text) {
        const std::size_t length = source.text_length > 0 ? source.text_length : std::strlen(source.text);
        if (length > kMostShotBytes)
            throw std::invalid_argument("source.text has " + std::to_string(length) +
                                        " bytes; accepted: at most " + std::to_string(kMostShotBytes));
        return without_budget(parse_shot({source.text, length}, name_of(source), check_scene));
    }
    return without_budget(load_shot(&required(source.path, "source.path"), check_scene));
}

void check_frame(double frame) {
    if (!limits::kFrame.holds(frame))
        throw std::invalid_argument("frame is outside the range; accepted: " + text_of(limits::kFrame));
}

pelagic_vessel vessel_of(const Scene& scene, std::size_t index, double frame) {
    const Vessel& vessel = scene.waves.vessels[index];
    const ObjectPose pose = object_pose(scene, {.vessel = static_cast<int>(index) + 1}, frame);
    const glm::dvec2 velocity_mps = path_of(scene.shot, vessel).velocity_mps(scene.shot.time_s(frame));
    pelagic_vessel out{};
    for (int axis = 0; axis < 3; ++axis) {
        out.position_m[axis] = pose.place_m[axis];
        out.ahead[axis] = pose.turn[0][axis];
        out.port[axis] = pose.turn[1][axis];
        out.up[axis] = pose.turn[2][axis];
        out.velocity_mps[axis] = axis < 2 ? velocity_mps[axis] : 0.0;
    }
    out.length_m = vessel.length_m;
    out.beam_m = vessel.beam_m;
    out.draught_m = vessel.draught_m;
    return out;
}

View view_of(const pelagic_camera& camera) {
    const auto vector = [](const double(&v)[3]) { return glm::dvec3(v[0], v[1], v[2]); };
    for (const int pixels : {camera.width, camera.height})
        if (!limits::kImageResolution.holds(pixels))
            throw std::invalid_argument("camera.width, height: outside the range; accepted: " +
                                        text_of(limits::kImageResolution));
    return checked_view({.position_m = vector(camera.position_m),
                         .right = vector(camera.right),
                         .up = vector(camera.up),
                         .forward = vector(camera.forward),
                         .tan_half_width = camera.tan_half_width,
                         .resolution = {camera.width, camera.height}});
}

pelagic_camera camera_of(const View& view) {
    pelagic_camera camera{};
    for (int axis = 0; axis < 3; ++axis) {
        camera.position_m[axis] = view.position_m[axis];
        camera.right[axis] = view.right[axis];
        camera.up[axis] = view.up[axis];
        camera.forward[axis] = view.forward[axis];
    }
    // Its axis is in the picture's middle: where the shot's isn't, it sees more, with pixels as large.
    const double across = 1.0 + 2.0 * std::abs(view.shift.x),
                 along = 1.0 + 2.0 * std::abs(view.shift.y) * view.resolution.x / view.resolution.y;
    camera.tan_half_width = view.tan_half_width * across;
    camera.width = static_cast<int>(std::lround(view.resolution.x * across));
    camera.height = static_cast<int>(std::lround(view.resolution.y * along));
    return camera;
}

// What pelagic_expand() and pelagic_expand_size() agree on.
Expansion expansion_of(const ShotFrame& frame, const pelagic_camera* camera,
                       const pelagic_expand_options* options) {
    const auto asked = taken_or_zeros(options, "options");
    const auto within = [](double value, double low, double high) {
        return value == 0.0 || (value >= low && value <= high);
    };
    if (!within(asked.cell_px, kFinestCell_px, 1000.0))
        throw std::invalid_argument(
            "options.cell_px is outside the range; accepted: 0.25 to 1000 pixels, or 0");
    if (!within(asked.error_px, 0.01, 100.0))
        throw std::invalid_argument(
            "options.error_px is outside the range; accepted: 0.01 to 100 pixels, or 0");
    if (asked.cell_px != 0.0 && asked.error_px != 0.0)
        throw std::invalid_argument("options.cell_px and error_px: accepted: one of them");
    return expansion_of(frame, view_of(taken(camera, "camera")),
                        {.cell_px = asked.cell_px == 0.0 ? kCell_px : asked.cell_px,
                         .error_px = asked.error_px,
                         .triangles = flag(asked.triangles, "options.triangles"),
                         .on_earth = flag(asked.on_earth, "options.on_earth")});
}

pelagic_mesh_size size_of(const Expansion& expansion) {
    const ProjectedGridSize grid = expansion.options.size;
    pelagic_mesh_size size{};
    size.points = points_of(grid);
    size.faces = static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows) *
                 (expansion.triangles ? 2 : 1);
    size.corners = size.faces * (expansion.triangles ? 3 : 4);
    return size;
}

// As grid_faces() and projected_grid_triangles() have them.
void fill_corners(const Expansion& expansion, std::uint32_t* corner) {
    const auto columns = static_cast<std::uint32_t>(expansion.options.size.columns),
               rows = static_cast<std::uint32_t>(expansion.options.size.rows);
    for (std::uint32_t row = 0; row < rows; ++row)
        for (std::uint32_t column = 0; column < columns; ++column) {
            const std::uint32_t near = row * (columns + 1) + column, far = near + columns + 1;
            const std::array<std::uint32_t, 6> triangles{near, near + 1, far + 1, near, far + 1, far};
            const std::array<std::uint32_t, 4> quad{near, near + 1, far + 1, far};
            corner = expansion.triangles ? std::copy(triangles.begin(), triangles.end(), corner)
                                         : std::copy(quad.begin(), quad.end(), corner);
        }
}

void expand(const ShotFrame& frame, const Expansion& expansion, const Wanted& wanted,
            pelagic_mesh_buffers& buffers) {
    const Results<float>& results = wanted.results;
    const ProjectedGrid grid = projected_grid(expansion.view, expansion.options, &frame.shot().is_cancelled);
    for (int axis = 0; axis < 2; ++axis) buffers.origin_m[axis] = grid.origin_m[axis];
    buffers.origin_m[2] = 0.0;
    if (buffers.corner) fill_corners(expansion, buffers.corner);
    if (buffers.rest_m)
        std::memcpy(buffers.rest_m, grid.rest_m.data(), grid.rest_m.size() * sizeof(glm::vec2));
    if (results.given().none()) return;
    frame.evaluate_by_all(points_of(grid), results, wanted.coverage);
    if (grid.curvature_per_m == 0.0) return;
    for (std::size_t i = 0; i < grid.rest_m.size(); ++i) {
        const glm::dvec3 up = earth_up(glm::dvec2(grid.rest_m[i]), grid.curvature_per_m);
        if (const auto at = results.vectors(Product::Position))
            at[i] = glm::vec3(on_earth(glm::dvec3(at[i]), grid.curvature_per_m));
        for (const VectorProduct product : {VectorProduct(Product::Normal), VectorProduct(Product::Velocity)})
            if (const auto at = results.vectors(product))
                at[i] = glm::vec3(from_level(glm::dvec3(at[i]), up));
    }
}

// Throws std::invalid_argument.
TimedPoints checked(const ShotFrame& frame, const pelagic_points& asked) {
    for (const double metres : asked.origin_m) check_place(metres, "points.origin_m");
    if (asked.count == 0) return {};
    check_count(asked.count, "points.count");
    frame.check_times(asked.time_s, asked.count, "points.time_s");
    static_assert(sizeof(glm::vec2) == 2 * sizeof(float));
    TimedPoints timed{
        .points = {.origin_m = {asked.origin_m[0], asked.origin_m[1]},
                   .count = asked.count,
                   .rest_m = {reinterpret_cast<const glm::vec2*>(&required(asked.rest_m, "points.rest_m"))}},
        .time_s = asked.time_s};
    if (asked.cell_m) timed.points.cell_m = {asked.cell_m};
    if (asked.pixel_m) timed.points.pixel_m = {asked.pixel_m};
    return timed;
}

}  // namespace
}  // namespace pelagic::procedural

using namespace pelagic;
using namespace pelagic::procedural;

const char* pelagic_version(void) {
    return PELAGIC_VERSION;
}

const char* pelagic_status_text(pelagic_status status) {
    switch (status) {
        case PELAGIC_OK:
            return "ok";
        case PELAGIC_INVALID_ARGUMENT:
            return "invalid argument";
        case PELAGIC_SHOT_REFUSED:
            return "shot refused";
        case PELAGIC_TOO_SMALL:
            return "buffer too small";
        case PELAGIC_OUT_OF_MEMORY:
            return "out of memory";
        case PELAGIC_CANCELLED:
            return "cancelled";
        case PELAGIC_FAILED:
            return "failed";
    }
    return "unknown status";
}

pelagic_status pelagic_open(const pelagic_source* source, const pelagic_open_options* options,
                            pelagic_sea** sea, pelagic_error* error) {
    return guarded(error, [&] {
        pelagic_sea*& out = required(sea, "sea");
        const auto asked = taken_or_zeros(options, "options");
        for (const double metres : {asked.finest_cell_m, asked.finest_pixel_m})
            if (!(metres >= 0.0 && metres <= 1e6))
                throw std::invalid_argument(
                    "options.finest_cell_m, finest_pixel_m are outside the range; accepted: 0 to 1e6 m");
        if (asked.threads < 0)
            throw std::invalid_argument("options.threads is negative; accepted: 0 or more");
        const auto from = taken(source, "source");
        Scene scene = scene_of(from);
        std::atomic<bool> cancel = false;
        BuildWatch watch;
        if (asked.progress) {
            watch.cancel = &cancel;
            watch.progress = [&](double done) {
                if (asked.progress(done, asked.user) != 0) cancel = true;
            };
        }
        const auto tell = [&](double done) {
            if (watch.progress) watch.progress(done);
            if (cancel) throw BuildCancelled();
        };
        tell(0.0);
        if (asked.note)
            for (const std::string& warning : sea_warnings(*prepare(scene)))
                asked.note((std::string(name_of(from)) + ": " + warning).c_str(), asked.user);
        auto shot = std::make_shared<const ShotSea>(
            std::move(scene),
            SeaOptions{asked.finest_cell_m, asked.finest_pixel_m, asked.threads, asked.ray_cache_bytes,
                       asked.max_memory_bytes},
            watch);
        tell(1.0);
        out = new pelagic_sea{std::move(shot)};
        return PELAGIC_OK;
    });
}

pelagic_status pelagic_cancel(const pelagic_sea* sea, int cancelled, pelagic_error* error) {
    return guarded(error, [&] {
        required(sea, "sea").shot->is_cancelled = cancelled != 0;
        return PELAGIC_OK;
    });
}

void pelagic_close(pelagic_sea* sea) {
    delete sea;
}

pelagic_status pelagic_get_info(const pelagic_sea* sea, pelagic_info* info, pelagic_error* error) {
    return guarded(error, [&] {
        const ShotSea& shot = *required(sea, "sea").shot;
        const Plan& plan = shot.sea->plan();
        pelagic_info about{};
        about.first_frame = shot.scene.shot.first_frame;
        about.last_frame = shot.scene.shot.last_frame;
        about.frames_per_second = shot.scene.shot.fps;
        about.time_scale = shot.scene.shot.time_scale;
        about.loop_s = shot.sea->first()->loop_s();
        about.significant_height_m = shot.sea->first()->total().significant_height_m();
        about.peak_wavelength_m = kTwoPi / plan.from->spectrum.peak_wavenumber();
        about.finest_cell_m = shot.finest_cell_m;
        about.finest_pixel_m = shot.finest_pixel_m;
        about.frame_bytes = plan.frame_bytes();
        about.foam_bytes = plan.foam_history_bytes();
        about.vessels = shot.scene.waves.vessels.size();
        give(about, info, "info");
        return PELAGIC_OK;
    });
}

pelagic_status pelagic_time_of_frame(const pelagic_sea* sea, double frame, double* time_s,
                                     pelagic_error* error) {
    return guarded(error, [&] {
        const Shot& shot = required(sea, "sea").shot->scene.shot;
        check_frame(frame);
        // Not reduced to the first round of a loop: a shutter may lie across its seam.
        required(time_s, "time_s") = shot.time_offset_s + shot.time_scale * ((frame - 1.0) / shot.fps);
        return PELAGIC_OK;
    });
}

pelagic_status pelagic_shot_camera(const pelagic_sea* sea, double frame, pelagic_camera* camera,
                                   pelagic_error* error) {
    return guarded(error, [&] {
        const Scene& scene = required(sea, "sea").shot->scene;
        check_frame(frame);
        give(camera_of(view_at(scene.camera, frame)), camera, "camera");
        return PELAGIC_OK;
    });
}

pelagic_status pelagic_vessel_at(const pelagic_sea* sea, size_t vessel, double frame, pelagic_vessel* at,
                                 pelagic_error* error) {
    return guarded(error, [&] {
        const Scene& scene = required(sea, "sea").shot->scene;
        const std::size_t count = scene.waves.vessels.size();
        if (count == 0) throw std::invalid_argument("the shot has no waves.vessels");
        if (vessel >= count)
            throw std::invalid_argument("vessel is " + std::to_string(vessel) + "; accepted: below " +
                                        std::to_string(count) + ", as many as waves.vessels has");
        check_frame(frame);
        give(vessel_of(scene, vessel, frame), at, "at");
        return PELAGIC_OK;
    });
}

pelagic_status pelagic_frame_create(const pelagic_sea* sea, double open_s, double close_s,
                                    pelagic_frame** frame, pelagic_error* error) {
    return guarded(error, [&] {
        pelagic_frame*& out = required(frame, "frame");
        out = new pelagic_frame{ShotFrame(required(sea, "sea").shot, open_s, close_s)};
        return PELAGIC_OK;
    });
}

pelagic_status pelagic_frame_set(pelagic_frame* frame, double open_s, double close_s, pelagic_error* error) {
    return guarded(error, [&] {
        required(frame, "frame").frame.set(open_s, close_s);
        return PELAGIC_OK;
    });
}

void pelagic_frame_release(pelagic_frame* frame) {
    delete frame;
}

pelagic_status pelagic_bounds(const pelagic_frame* frame, const pelagic_region* region, pelagic_box* box,
                              pelagic_error* error) {
    return guarded(error, [&] {
        const auto asked = taken(region, "region");
        for (const double metres : {asked.min_m[0], asked.min_m[1], asked.max_m[0], asked.max_m[1]})
            check_place(metres, "region.min_m, max_m");
        const double any = std::numeric_limits<double>::infinity();
        const auto [least, greatest] = frame_of(frame).bounds(
            {{asked.min_m[0], asked.min_m[1]}, {asked.max_m[0], asked.max_m[1]}},
            {.finest_m = asked.finest_cell_m,
             .coarsest_m = asked.coarsest_cell_m == 0.0 ? any : asked.coarsest_cell_m});
        pelagic_box found{};
        for (int axis = 0; axis < 3; ++axis) {
            found.min_m[axis] = least[axis];
            found.max_m[axis] = greatest[axis];
        }
        give(found, box, "box");
        return PELAGIC_OK;
    });
}

pelagic_status pelagic_evaluate(const pelagic_frame* frame, const pelagic_points* points,
                                const pelagic_values* values, pelagic_error* error) {
    return guarded(error, [&] {
        const auto asked = taken(points, "points");
        const Wanted wanted = wanted_in(taken(values, "values"));
        const ShotFrame& of = frame_of(frame);
        const TimedPoints timed = checked(of, asked);
        stop_if(&of.shot().is_cancelled);
        if (timed.points.count > 0) of.evaluate(timed, wanted.results, wanted.coverage);
        return PELAGIC_OK;
    });
}

pelagic_status pelagic_water_at(const pelagic_frame* frame, const double* places_m, size_t count,
                                double footprint_m, pelagic_water* water, pelagic_error* error) {
    return guarded(error, [&] {
        const ShotFrame& of = frame_of(frame);
        if (!(footprint_m >= 0.0 && footprint_m <= 1e6))
            throw std::invalid_argument("footprint_m is outside the range; accepted: 0 to 1e6 m");
        if (count == 0) return PELAGIC_OK;
        check_count(count, "count");
        required(places_m, "places_m");
        const std::size_t size = checked_size(water, "water");
        std::vector<glm::dvec2> places(count);
        for (std::size_t i = 0; i < count; ++i) places[i] = {places_m[2 * i], places_m[2 * i + 1]};
        std::vector<WaterState> found(count);
        of.water_at(places, static_cast<float>(footprint_m), found);
        for (std::size_t i = 0; i < count; ++i) {
            const WaterState& here = found[i];
            const pelagic_water there{
                .size = size,
                .height_m = here.height_m,
                .normal = {here.normal.x, here.normal.y, here.normal.z},
                .velocity_mps = {here.velocity_mps.x, here.velocity_mps.y, here.velocity_mps.z}};
            std::memcpy(reinterpret_cast<char*>(water) + i * size, &there, std::min(size, sizeof there));
        }
        return PELAGIC_OK;
    });
}

pelagic_status pelagic_prepare(const pelagic_frame* frame, const pelagic_points* points,
                               pelagic_error* error) {
    return guarded(error, [&] {
        const auto asked = taken(points, "points");
        const ShotFrame& of = frame_of(frame);
        of.prepare(checked(of, asked).points);
        return PELAGIC_OK;
    });
}

pelagic_status pelagic_expand_size(const pelagic_frame* frame, const pelagic_camera* camera,
                                   const pelagic_expand_options* options, pelagic_mesh_size* mesh_size,
                                   pelagic_error* error) {
    return guarded(error, [&] {
        const ShotFrame& of = frame_of(frame);
        stop_if(&of.shot().is_cancelled);
        give(of.shot().arena->execute([&] { return size_of(expansion_of(of, camera, options)); }), mesh_size,
             "mesh_size");
        return PELAGIC_OK;
    });
}

pelagic_status pelagic_expand(const pelagic_frame* frame, const pelagic_camera* camera,
                              const pelagic_expand_options* options, pelagic_mesh_buffers* buffers,
                              pelagic_error* error) {
    return guarded(error, [&]() -> pelagic_status {
        auto into = taken(buffers, "buffers");
        const Wanted wanted = into.values ? wanted_in(taken(into.values, "buffers.values")) : Wanted{};
        const ShotFrame& of = frame_of(frame);
        stop_if(&of.shot().is_cancelled);
        const Expansion expansion =
            of.shot().arena->execute([&] { return expansion_of(of, camera, options); });
        const pelagic_mesh_size needed = size_of(expansion);
        const bool wants_points = into.rest_m || wanted.results.given().any();
        if ((wants_points && into.points < needed.points) || (into.corner && into.corners < needed.corners)) {
            say(error, ("the mesh has " + std::to_string(needed.points) + " points and " +
                        std::to_string(needed.corners) + " corners; the buffers have room for " +
                        std::to_string(into.points) + " and " + std::to_string(into.corners))
                           .c_str());
            return PELAGIC_TOO_SMALL;
        }
        of.shot().arena->execute([&] { expand(of, expansion, wanted, into); });
        into.points = needed.points;
        into.corners = needed.corners;
        give(into, buffers, "buffers");
        return PELAGIC_OK;
    });
}
