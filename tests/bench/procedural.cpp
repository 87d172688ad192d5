// What each call of the C interface costs, over the interface alone, as the table in plugin/host/procedural/README.md has it: CPU time, all threads
// together, of the least of some repeats, and what the process holds afterwards that it didn't before.
//   procedural [SHOT.toml…]      default: the default sea, then examples/north-sea-storm.toml
#include <malloc.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "pelagic/procedural.h"

namespace {

double cpu_ms() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto ms = [](const timeval& t) {
        return 1e3 * static_cast<double>(t.tv_sec) + 1e-3 * static_cast<double>(t.tv_usec);
    };
    return ms(usage.ru_utime) + ms(usage.ru_stime);
}

double heap_mib() {
    const struct mallinfo2 now = mallinfo2();
    return static_cast<double>(now.uordblks + now.hblkhd) / 1048576.0;
}

void check(pelagic_status status, const pelagic_error& error) {
    if (status == PELAGIC_OK) return;
    std::fprintf(stderr, "%s: %s\n", pelagic_status_text(status), error.message);
    std::exit(1);
}

// A line of the table. `each`: how many things a call does, of which one is told in microseconds; 0: the call as a whole.
void tell(const char* what, std::size_t each, int repeats, const std::function<void()>& call) {
    double least_ms = HUGE_VAL, first_ms = 0.0;
    const double before_mib = heap_mib();
    double grown_mib = 0.0;
    for (int i = 0; i < repeats; ++i) {
        const double start_ms = cpu_ms();
        call();
        const double ms = cpu_ms() - start_ms;
        if (i == 0) {
            first_ms = ms;
            grown_mib = heap_mib() - before_mib;
        }
        least_ms = std::min(least_ms, ms);
    }
    if (each > 0)
        std::printf("| %s | %.2f µs each | %.0f ms for the first %zu | %.0f |\n", what,
                    1e3 * least_ms / static_cast<double>(each), first_ms, each, grown_mib);
    else
        std::printf("| %s | %.1f ms | %.1f ms | %.0f |\n", what, least_ms, first_ms, grown_mib);
}

void table(const char* path) {
    pelagic_error error;
    pelagic_source source = PELAGIC_INIT(pelagic_source);
    if (path)
        source.path = path;
    else
        source.text = "[shot]\n";
    pelagic_sea* sea = nullptr;
    std::printf("\n%s\n\n| Call | CPU | the first | MiB |\n|---|---|---|---|\n",
                path ? path : "the default sea");
    tell("`pelagic_open`", 0, 1, [&] { check(pelagic_open(&source, nullptr, &sea, &error), error); });
    pelagic_info info = PELAGIC_INIT(pelagic_info);
    check(pelagic_get_info(sea, &info, &error), error);
    double open_s = 0.0;
    check(pelagic_time_of_frame(sea, 1.0, &open_s, &error), error);
    const double close_s = open_s + 0.5 / info.frames_per_second * info.time_scale;
    pelagic_frame* frame = nullptr;
    tell("`pelagic_frame_create`", 0, 1,
         [&] { check(pelagic_frame_create(sea, open_s, close_s, &frame, &error), error); });
    tell("`pelagic_frame_set`", 0, 3,
         [&] { check(pelagic_frame_set(frame, open_s, close_s, &error), error); });

    pelagic_region region = PELAGIC_INIT(pelagic_region);
    region.max_m[0] = region.max_m[1] = 2.0 * info.peak_wavelength_m;
    pelagic_box box = PELAGIC_INIT(pelagic_box);
    tell("`pelagic_bounds` of two peak waves", 0, 3,
         [&] { check(pelagic_bounds(frame, &region, &box, &error), error); });

    pelagic_camera camera = PELAGIC_INIT(pelagic_camera);
    check(pelagic_shot_camera(sea, 1.0, &camera, &error), error);
    pelagic_mesh_size size = PELAGIC_INIT(pelagic_mesh_size);
    check(pelagic_expand_size(frame, &camera, nullptr, &size, &error), error);
    std::vector<float> three(3 * size.points), one(size.points);
    struct Kind {
        const char* name;
        float* pelagic_values::*member;
        bool is_number;
    };
    const std::vector<Kind> kinds{{"positions", &pelagic_values::position_m, false},
                                  {"normals", &pelagic_values::normal, false},
                                  {"velocities", &pelagic_values::velocity_mps, false},
                                  {"slope variances", &pelagic_values::slope_variance, false},
                                  {"breaking", &pelagic_values::breaking, true},
                                  {"coverage", &pelagic_values::coverage, true},
                                  {"age", &pelagic_values::age_s, true}};
    for (const Kind& kind : kinds) {
        pelagic_values values = PELAGIC_INIT(pelagic_values);
        values.*kind.member = kind.is_number ? one.data() : three.data();
        pelagic_mesh_buffers mesh = PELAGIC_INIT(pelagic_mesh_buffers);
        mesh.points = size.points;
        mesh.values = &values;
        tell((std::string("`pelagic_expand`, ") + kind.name).c_str(), size.points, 3,
             [&] { check(pelagic_expand(frame, &camera, nullptr, &mesh, &error), error); });
    }

    constexpr std::size_t kPoints = 100'000;
    std::mt19937 random(1);
    std::uniform_real_distribution<float> place_m(-100.0f, 100.0f);
    std::vector<float> rest_m(2 * kPoints);
    for (float& metres : rest_m) metres = place_m(random);
    std::vector<float> vectors(3 * kPoints), numbers(kPoints);
    pelagic_points points = PELAGIC_INIT(pelagic_points);
    points.count = kPoints;
    points.rest_m = rest_m.data();
    for (const Kind& kind : kinds) {
        pelagic_values values = PELAGIC_INIT(pelagic_values);
        values.*kind.member = kind.is_number ? numbers.data() : vectors.data();
        tell((std::string("`pelagic_evaluate`, ") + kind.name).c_str(), kPoints, 3,
             [&] { check(pelagic_evaluate(frame, &points, &values, &error), error); });
    }

    constexpr std::size_t kPlaces = 1000;
    std::vector<double> places(2 * kPlaces);
    for (std::size_t i = 0; i < places.size(); ++i) places[i] = rest_m[i];
    std::vector<pelagic_water> water(kPlaces);
    for (pelagic_water& w : water) w.size = sizeof w;
    tell("`pelagic_water_at`", kPlaces, 3,
         [&] { check(pelagic_water_at(frame, places.data(), kPlaces, 0.5, water.data(), &error), error); });

    // Those of the shot's camera, which meet the sea or the sky.
    const std::size_t width = 320, height = 180;
    std::vector<float> direction;
    const double pixel = 2.0 * camera.tan_half_width / static_cast<double>(width);
    for (std::size_t row = 0; row < height; ++row)
        for (std::size_t column = 0; column < width; ++column)
            for (int axis = 0; axis < 3; ++axis)
                direction.push_back(
                    static_cast<float>(camera.forward[axis] +
                                       pixel * ((static_cast<double>(column) - 159.5) * camera.right[axis] +
                                                (89.5 - static_cast<double>(row)) * camera.up[axis])));
    const std::vector<float> spread(width * height, static_cast<float>(pixel));
    pelagic_rays rays = PELAGIC_INIT(pelagic_rays);
    std::copy(camera.position_m, camera.position_m + 3, rays.origin_m);
    rays.count = width * height;
    rays.direction = direction.data();
    rays.spread = spread.data();
    std::vector<float> distance(rays.count);
    pelagic_hits hits = PELAGIC_INIT(pelagic_hits);
    hits.distance = distance.data();
    tell("`pelagic_intersect`, the camera's rays", rays.count, 3,
         [&] { check(pelagic_intersect(frame, &rays, &hits, &error), error); });
    std::vector<unsigned char> occluded(rays.count);
    tell("`pelagic_occluded`, the camera's rays", rays.count, 3,
         [&] { check(pelagic_occluded(frame, &rays, occluded.data(), &error), error); });
    std::printf("\na frame says %.0f MiB, its foam's past %.0f MiB; finest cells %.3f m\n",
                static_cast<double>(info.frame_bytes) / 1048576.0,
                static_cast<double>(info.foam_bytes) / 1048576.0, info.finest_cell_m);
    pelagic_frame_release(frame);
    pelagic_close(sea);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc > 1) {
        for (int i = 1; i < argc; ++i) table(argv[i]);
        return 0;
    }
    table(nullptr);
    table(PELAGIC_SOURCE_DIR "/examples/north-sea-storm.toml");
    return 0;
}
