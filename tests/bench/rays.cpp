// A camera's rays against the sea: Embree with our user geometry, beside Embree over the sparsest mesh of ours that is as near to the
// surface. The error is the distance from a hit to the exact surface along its normal, over the width of a pixel there.
//   rays [WIDTH HEIGHT]      default 640 480
#include <malloc.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <string>
#include <vector>

#include "embree_sea.h"
#include "tests/bench/timing.h"

namespace {

constexpr double kOpen_s = 10.0;
constexpr double kMost = 0.25;  // of a pixel, at the 95th percentile

void check(pelagic_status status, const pelagic_error& error) {
    if (status == PELAGIC_OK) return;
    std::fprintf(stderr, "%s: %s\n", pelagic_status_text(status), error.message);
    std::exit(1);
}

double since_ms(std::chrono::steady_clock::time_point begin) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

double heap_mib() {
    const struct mallinfo2 now = mallinfo2();
    return static_cast<double>(now.uordblks + now.hblkhd) / 1048576.0;
}

std::atomic<long long> embree_bytes{0};
bool count_bytes(void*, ssize_t bytes, bool) {
    embree_bytes += bytes;
    return true;
}

struct Shot {
    pelagic_sea* sea = nullptr;
    pelagic_frame* frame = nullptr;
    pelagic_camera camera = PELAGIC_INIT(pelagic_camera);
    double shutter_s = 0.0, spread = 0.0;
    std::vector<glm::vec3> direction;
    std::vector<float> time;  // 0 … 1
};

// By ray; a rest of a ray without a hit is no number.
struct Hits {
    std::vector<glm::vec2> rest_m;
    std::vector<float> distance_m;
};

struct Rays {
    RTCScene scene;
    std::function<glm::vec2(const RTCHit16&, int)> rest_m;
};

// Packets of 16 neighbours in a row.
void trace(const Shot& shot, const Rays& rays, Hits& hits) {
    const std::size_t count = shot.direction.size();
    hits.rest_m.assign(count, glm::vec2(NAN));
    hits.distance_m.assign(count, INFINITY);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count / 16, 20), [&](const auto& range) {
        SeaRayContext context({.footprint_m = 0.0f, .spread = static_cast<float>(shot.spread)});
        context.embree.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
        alignas(64) int valid[16];
        std::fill_n(valid, 16, -1);
        for (std::size_t packet = range.begin(); packet < range.end(); ++packet) {
            alignas(64) RTCRayHit16 ray{};
            for (int i = 0; i < 16; ++i) {
                const std::size_t at = 16 * packet + static_cast<std::size_t>(i);
                ray.ray.org_z[i] = static_cast<float>(shot.camera.position_m[2]);
                ray.ray.dir_x[i] = shot.direction[at].x;
                ray.ray.dir_y[i] = shot.direction[at].y;
                ray.ray.dir_z[i] = shot.direction[at].z;
                ray.ray.time[i] = shot.time[at];
                ray.ray.tfar[i] = INFINITY;
                ray.ray.mask[i] = ~0u;
                ray.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
            }
            rtcIntersect16(valid, rays.scene, &context.embree, &ray);
            for (int i = 0; i < 16; ++i) {
                if (ray.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
                hits.rest_m[16 * packet + static_cast<std::size_t>(i)] = rays.rest_m(ray.hit, i);
                hits.distance_m[16 * packet + static_cast<std::size_t>(i)] = ray.ray.tfar[i];
            }
        }
    });
}

struct Errors {
    std::size_t hits = 0;
    double median = 0.0, most95 = 0.0, most99 = 0.0;
};

Errors errors_of(const Shot& shot, const Hits& hits) {
    std::vector<glm::vec2> rest_m;
    std::vector<glm::vec3> at_m;
    std::vector<float> time_s, width_m;
    const glm::vec3 eye(0.0f, 0.0f, static_cast<float>(shot.camera.position_m[2]));
    for (std::size_t i = 0; i < hits.distance_m.size(); ++i) {
        if (!std::isfinite(hits.rest_m[i].x)) continue;
        rest_m.push_back(hits.rest_m[i]);
        at_m.push_back(eye + hits.distance_m[i] * shot.direction[i]);
        time_s.push_back(static_cast<float>(shot.shutter_s) * shot.time[i]);
        width_m.push_back(static_cast<float>(shot.spread) * hits.distance_m[i]);
    }
    std::vector<glm::vec3> exact_m(rest_m.size()), normal(rest_m.size());
    pelagic_points points = PELAGIC_INIT(pelagic_points);
    points.origin_m[0] = shot.camera.position_m[0];
    points.origin_m[1] = shot.camera.position_m[1];
    points.count = rest_m.size();
    points.rest_m = &rest_m[0].x;
    points.time_s = time_s.data();
    pelagic_values values = PELAGIC_INIT(pelagic_values);
    values.position_m = &exact_m[0].x;
    values.normal = &normal[0].x;
    pelagic_error error;
    check(pelagic_evaluate(shot.frame, &points, &values, &error), error);
    std::vector<double> off;
    for (std::size_t i = 0; i < rest_m.size(); ++i)
        off.push_back(std::abs(glm::dot(at_m[i] - exact_m[i], normal[i])) / static_cast<double>(width_m[i]));
    std::sort(off.begin(), off.end());
    const auto share = [&](double of) {
        return off[static_cast<std::size_t>(of * static_cast<double>(off.size() - 1))];
    };
    return {off.size(), share(0.5), share(0.95), share(0.99)};
}

struct Side {
    double geometry_ms = 0.0, build_ms = 0.0, trace_ms = 0.0, mib = 0.0, first_pixel_ms = 0.0;
    Errors errors;
    double frame_ms() const { return geometry_ms + build_ms + trace_ms; }
};

void print(const char* name, const Side& side) {
    std::printf("  %-26s %8.0f = %6.0f + %5.0f + %5.0f %9.1f %9.1f   %.3f %.3f %.3f  (%zu)\n", name,
                side.frame_ms(), side.geometry_ms, side.build_ms, side.trace_ms, side.mib,
                side.first_pixel_ms, side.errors.median, side.errors.most95, side.errors.most99,
                side.errors.hits);
}

// A mesh of the camera, which is refitted frame after frame; its first pixel takes a build.
Side mesh_side(RTCDevice device, const Shot& shot, double error_px) {
    Side side;
    pelagic_error error;
    pelagic_expand_options options = PELAGIC_INIT(pelagic_expand_options);
    options.error_px = error_px;
    options.triangles = 1;
    pelagic_mesh_size size = PELAGIC_INIT(pelagic_mesh_size);
    check(pelagic_expand_size(shot.frame, &shot.camera, &options, &size, &error), error);
    std::vector<glm::vec2> rest_m(size.points);
    std::vector<glm::vec3> position_m(size.points), velocity_mps(shot.shutter_s > 0.0 ? size.points : 0);
    const long long before = embree_bytes;
    RTCScene scene = rtcNewScene(device);
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_REFIT);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_DYNAMIC);
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_REFIT);
    const unsigned steps = shot.shutter_s > 0.0 ? 2 : 1;
    rtcSetGeometryTimeStepCount(geometry, steps);
    glm::vec3* vertices[2] = {};
    for (unsigned step = 0; step < steps; ++step)
        vertices[step] = static_cast<glm::vec3*>(rtcSetNewGeometryBuffer(
            geometry, RTC_BUFFER_TYPE_VERTEX, step, RTC_FORMAT_FLOAT3, sizeof(glm::vec3), size.points));
    auto* corners = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), size.faces));
    pelagic_values values = PELAGIC_INIT(pelagic_values);
    values.position_m = shot.shutter_s > 0.0 ? &position_m[0].x : &vertices[0]->x;
    if (shot.shutter_s > 0.0) values.velocity_mps = &velocity_mps[0].x;
    pelagic_mesh_buffers mesh = PELAGIC_INIT(pelagic_mesh_buffers);
    mesh.points = size.points;
    mesh.corners = size.corners;
    mesh.corner = corners;
    mesh.rest_m = &rest_m[0].x;
    mesh.values = &values;
    const auto fill = [&] {
        check(pelagic_expand(shot.frame, &shot.camera, &options, &mesh, &error), error);
        const float half_s = static_cast<float>(0.5 * shot.shutter_s);
        for (unsigned step = 0; step < steps && steps > 1; ++step)
            tbb::parallel_for(std::size_t(0), size.points, [&](std::size_t i) {
                vertices[step][i] = position_m[i] + (step == 0 ? -half_s : half_s) * velocity_mps[i];
            });
        for (unsigned step = 0; step < steps; ++step)
            rtcUpdateGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, step);
        rtcCommitGeometry(geometry);
    };
    const auto cold = std::chrono::steady_clock::now();
    fill();
    rtcAttachGeometry(scene, geometry);
    rtcCommitScene(scene);
    side.first_pixel_ms = since_ms(cold);
    auto begin = std::chrono::steady_clock::now();
    fill();
    side.geometry_ms = since_ms(begin);
    begin = std::chrono::steady_clock::now();
    rtcCommitScene(scene);
    side.build_ms = since_ms(begin);
    Hits hits;
    begin = std::chrono::steady_clock::now();
    trace(shot,
          {scene,
           [&](const RTCHit16& hit, int i) {
               const std::uint32_t* corner = corners + 3 * std::size_t{hit.primID[i]};
               const glm::vec2 a = rest_m[corner[0]], b = rest_m[corner[1]], c = rest_m[corner[2]];
               return a + hit.u[i] * (b - a) + hit.v[i] * (c - a);
           }},
          hits);
    side.trace_ms = since_ms(begin);
    side.mib = static_cast<double>(embree_bytes - before) / 1048576.0;
    side.errors = errors_of(shot, hits);
    rtcReleaseGeometry(geometry);
    rtcReleaseScene(scene);
    return side;
}

// Our user geometry: what rays need is made while they ask.
Side tiles_side(RTCDevice device, const Shot& shot, double tolerance) {
    Side side;
    pelagic_error error;
    Hits hits;
    for (const bool only_first : {true, false}) {
        check(pelagic_frame_set(shot.frame, kOpen_s, kOpen_s + shot.shutter_s, &error), error);
        const long long before = embree_bytes;
        const double heap = heap_mib();
        auto begin = std::chrono::steady_clock::now();
        RTCScene scene = rtcNewScene(device);
        EmbreeSea sea(device, shot.frame,
                      {.origin_m = {shot.camera.position_m[0], shot.camera.position_m[1], 0.0},
                       .shutter_s = shot.shutter_s,
                       .tolerance = tolerance});
        rtcAttachGeometry(scene, sea.geometry());
        rtcCommitScene(scene);
        side.build_ms = since_ms(begin);
        Shot one = shot;
        if (only_first) {
            const std::size_t middle = shot.direction.size() * 3 / 4;
            one.direction.assign(16, shot.direction[middle]);
            one.time.assign(16, shot.time[middle]);
        }
        hits = {};
        const Rays rays{scene, [](const RTCHit16& hit, int i) { return glm::vec2(hit.u[i], hit.v[i]); }};
        if (only_first) {
            trace(one, rays, hits);
            side.first_pixel_ms = since_ms(begin);
        } else {
            begin = std::chrono::steady_clock::now();
            trace(shot, rays, hits);
            side.trace_ms = since_ms(begin);
            side.mib = heap_mib() - heap + static_cast<double>(embree_bytes - before) / 1048576.0 -
                       static_cast<double>(hits.rest_m.size() * 12) / 1048576.0;
        }
        rtcReleaseScene(scene);
    }
    side.errors = errors_of(shot, hits);
    return side;
}

void run(RTCDevice device, const char* name, const std::string& text, int width, int height,
         double shutter_s) {
    Shot shot;
    pelagic_error error;
    pelagic_source source = PELAGIC_INIT(pelagic_source);
    source.text = text.c_str();
    pelagic_open_options fine = PELAGIC_INIT(pelagic_open_options);
    fine.finest_cell_m = fine.finest_pixel_m = 0.002;
    check(pelagic_open(&source, &fine, &shot.sea, &error), error);
    check(pelagic_frame_create(shot.sea, kOpen_s, kOpen_s + shutter_s, &shot.frame, &error), error);
    check(pelagic_shot_camera(shot.sea, 1.0, &shot.camera, &error), error);
    shot.camera.width = width;
    shot.camera.height = height;
    shot.shutter_s = shutter_s;
    shot.spread = 2.0 * shot.camera.tan_half_width / width;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            glm::dvec3 direction;
            for (int axis = 0; axis < 3; ++axis)
                direction[axis] = shot.camera.forward[axis] +
                                  shot.spread * ((x + 0.5 - 0.5 * width) * shot.camera.right[axis] -
                                                 (y + 0.5 - 0.5 * height) * shot.camera.up[axis]);
            shot.direction.emplace_back(glm::normalize(direction));
            shot.time.push_back(
                shutter_s > 0.0 ? (static_cast<float>(shot.direction.size() * 7 % 16) + 0.5f) / 16.0f : 0.0f);
        }
    std::printf("\n%s, %d x %d%s\n  %-26s %8s   %6s + %5s + %5s %9s %9s   %s\n", name, width, height,
                shutter_s > 0.0 ? ", 16 times over a shutter of 1/48 s" : "", "", "ms", "mesh", "refit",
                "rays", "MiB", "first ms", "error in pixels: median, 95 %, 99 %");
    Side mesh;
    for (const double error_px : {kMost, 0.95 * kMost, 0.9 * kMost}) {
        mesh = mesh_side(device, shot, error_px);
        print(("mesh, error " + std::to_string(error_px).substr(0, 5) + " px").c_str(), mesh);
        if (mesh.errors.most95 <= kMost) break;
    }
    for (const double tolerance : {1.0, 0.5}) {
        const Side tiles = tiles_side(device, shot, tolerance);
        print(("tiles, tolerance " + std::to_string(tolerance).substr(0, 4)).c_str(), tiles);
        const double time = tiles.frame_ms() / mesh.frame_ms(), memory = tiles.mib / mesh.mib;
        if (tiles.errors.most95 <= kMost && mesh.errors.most95 <= kMost)
            std::printf("    time %.2f of the mesh's (1.5: %s), memory %.3f (0.25: %s), first pixel %.3f\n",
                        time, pelagic::bench::verdict(time <= 1.5), memory,
                        pelagic::bench::verdict(memory <= 0.25), tiles.first_pixel_ms / mesh.first_pixel_ms);
    }
    pelagic_frame_release(shot.frame);
    pelagic_close(shot.sea);
}

}  // namespace

int main(int argc, char** argv) {
    const int width = argc > 2 ? std::atoi(argv[1]) : 640, height = argc > 2 ? std::atoi(argv[2]) : 480;
    const std::string from_4_m = "[camera]\nposition_m = [0, 0, 4]\nlook_at_m = [0, 1000, 0]\n";
    RTCDevice device = rtcNewDevice(nullptr);
    rtcSetDeviceMemoryMonitorFunction(device, count_bytes, nullptr);
    for (const double shutter_s : {0.0, 1.0 / 48.0}) {
        run(device, "A storm, 24 m/s", "[sea]\nwind_speed_mps = 24.0\n" + from_4_m, width, height, shutter_s);
        run(device, "The default sea", from_4_m, width, height, shutter_s);
    }
    rtcReleaseDevice(device);
}
