// What a mesh for a camera misses of the sea, by the size of its cells on the screen: the distance from a point of a face to the surface,
// along its normal, over the width of a pixel there. Storms and the default sea, from 4 m.
//   expand [WIDTH HEIGHT]      default 640 480

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <random>
#include <string>
#include <vector>

#include "pelagic/procedural.h"

namespace {

void check(pelagic_status status, const pelagic_error& error) {
    if (status == PELAGIC_OK) return;
    std::fprintf(stderr, "%s: %s\n", pelagic_status_text(status), error.message);
    std::exit(1);
}

double percentile(std::vector<double>& values, double share) {
    const auto at =
        values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}

void run(const char* name, const std::string& shot, int width, int height) {
    pelagic_error error;
    pelagic_source source = PELAGIC_INIT(pelagic_source);
    source.text = shot.c_str();
    pelagic_open_options fine = PELAGIC_INIT(pelagic_open_options);
    fine.finest_cell_m = fine.finest_pixel_m = 0.002;
    pelagic_sea* sea = nullptr;
    check(pelagic_open(&source, &fine, &sea, &error), error);
    pelagic_frame* frame = nullptr;
    check(pelagic_frame_create(sea, 10.0, 10.0, &frame, &error), error);
    pelagic_camera camera = PELAGIC_INIT(pelagic_camera);
    check(pelagic_shot_camera(sea, 1.0, &camera, &error), error);
    camera.width = width;
    camera.height = height;
    const glm::dvec3 eye(camera.position_m[0], camera.position_m[1], camera.position_m[2]);
    const glm::dvec3 forward(camera.forward[0], camera.forward[1], camera.forward[2]),
        right(camera.right[0], camera.right[1], camera.right[2]),
        up(camera.up[0], camera.up[1], camera.up[2]);
    const double pixel = 2.0 * camera.tan_half_width / width;
    std::printf("\n%s, %d x %d\n  %8s %10s %9s   %s\n", name, width, height, "cell px", "points", "ms",
                "error in pixels: median, 95 %, 99 %; of points 10 ... 100 m away, 95 %; farther");
    for (const double cell_px : {0.5, 1.0, 2.0, 4.0, 8.0}) {
        pelagic_expand_options options = PELAGIC_INIT(pelagic_expand_options);
        options.cell_px = cell_px;
        options.triangles = 1;
        pelagic_mesh_size size = PELAGIC_INIT(pelagic_mesh_size);
        check(pelagic_expand_size(frame, &camera, &options, &size, &error), error);
        std::vector<std::uint32_t> corner(size.corners);
        std::vector<glm::vec3> position(size.points);
        std::vector<glm::vec2> rest(size.points);
        pelagic_values values = PELAGIC_INIT(pelagic_values);
        values.position_m = &position[0].x;
        pelagic_mesh_buffers mesh = PELAGIC_INIT(pelagic_mesh_buffers);
        mesh.points = size.points;
        mesh.corners = size.corners;
        mesh.corner = corner.data();
        mesh.rest_m = &rest[0].x;
        mesh.values = &values;
        const auto begin = std::chrono::steady_clock::now();
        check(pelagic_expand(frame, &camera, &options, &mesh, &error), error);
        const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - begin;
        // Faces in view, with as many points as they have pixels.
        const glm::dvec3 origin(mesh.origin_m[0], mesh.origin_m[1], mesh.origin_m[2]);
        std::mt19937 random(3);
        std::uniform_real_distribution<float> uniform(0.0f, 1.0f);
        std::vector<glm::vec2> asked;
        std::vector<glm::vec3> on_face;
        std::vector<double> distance_m;
        const auto on_screen = [&](glm::dvec3 at) {
            const glm::dvec3 to = origin + at - eye;
            const double depth = glm::dot(to, forward);
            return glm::dvec3(glm::dot(to, right), glm::dot(to, up), depth) / (std::max(depth, 1e-9) * pixel);
        };
        for (std::size_t i = 0; i < corner.size(); i += 3) {
            const std::uint32_t a = corner[i], b = corner[i + 1], c = corner[i + 2];
            const glm::dvec3 pa(position[a]), pb(position[b]), pc(position[c]);
            if (glm::dot(origin + pa - eye, forward) < 0.1) continue;
            const glm::dvec3 sa = on_screen(pa), sb = on_screen(pb), sc = on_screen(pc);
            if (std::abs(sa.x) > 0.5 * width || std::abs(sa.y) > 0.5 * height) continue;
            // Those that are seen from behind aren't.
            const double area = 0.5 * ((sb.x - sa.x) * (sc.y - sa.y) - (sb.y - sa.y) * (sc.x - sa.x));
            if (!(area > 0.0) || uniform(random) > area * 0.2) continue;
            float u = uniform(random), v = uniform(random);
            if (u + v > 1.0f) u = 1.0f - u, v = 1.0f - v;
            asked.push_back(rest[a] + u * (rest[b] - rest[a]) + v * (rest[c] - rest[a]));
            on_face.push_back(position[a] + u * (position[b] - position[a]) +
                              v * (position[c] - position[a]));
            distance_m.push_back(glm::length(origin + glm::dvec3(on_face.back()) - eye));
        }
        std::vector<glm::vec3> exact(asked.size()), normal(asked.size());
        pelagic_points points = PELAGIC_INIT(pelagic_points);
        points.origin_m[0] = origin.x;
        points.origin_m[1] = origin.y;
        points.count = asked.size();
        points.rest_m = &asked[0].x;
        pelagic_values answers = PELAGIC_INIT(pelagic_values);
        answers.position_m = &exact[0].x;
        answers.normal = &normal[0].x;
        check(pelagic_evaluate(frame, &points, &answers, &error), error);
        std::vector<double> all, near, far;
        for (std::size_t i = 0; i < asked.size(); ++i) {
            const double off = std::abs(glm::dot(on_face[i] - exact[i], normal[i])) / (pixel * distance_m[i]);
            all.push_back(off);
            if (distance_m[i] > 10.0) (distance_m[i] < 100.0 ? near : far).push_back(off);
        }
        std::printf("  %8.1f %10zu %9.0f   %.3f  %.3f  %.3f;  %.3f;  %.3f   (%zu)\n", cell_px, size.points,
                    took.count(), percentile(all, 0.5), percentile(all, 0.95), percentile(all, 0.99),
                    near.empty() ? 0.0 : percentile(near, 0.95), far.empty() ? 0.0 : percentile(far, 0.95),
                    all.size());
    }
    pelagic_frame_release(frame);
    pelagic_close(sea);
}

}  // namespace

int main(int argc, char** argv) {
    const int width = argc > 2 ? std::atoi(argv[1]) : 640, height = argc > 2 ? std::atoi(argv[2]) : 480;
    const std::string from_4_m = "[camera]\nposition_m = [0, 0, 4]\nlook_at_m = [0, 1000, 0]\n";
    run("A storm, 24 m/s", "[sea]\nwind_speed_mps = 24.0\n" + from_4_m, width, height);
    run("The default sea", from_4_m, width, height);
}
