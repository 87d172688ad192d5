// The skyline of rendered pictures against the query's: winds and eyes' heights of issue and gallery, one sample a
// pixel, else default settings. `bench_skyline COLUMNS` has smaller pictures.

#include <cstdio>
#include <cstdlib>
#include <optional>
#include <stdexcept>

#include "plugin/light/light.h"
#include "tests/bench/timing.h"
#include "tests/plugin/render/skyline.h"

namespace pelagic::bench {
namespace {

// Level, from so high above the sea at rest.
Scene seen_from(double eye_m, double wind_mps, int columns) {
    Scene scene;
    scene.sea.wind_speed_mps = wind_mps;
    scene.camera.position_m = {0.0, -60.0, eye_m};
    scene.camera.look_at_m = {0.0, 0.0, eye_m};
    scene.camera.resolution = {columns, columns * 9 / 16};
    return scene;
}

// nullopt: the camera is under water.
std::optional<Picture> picture_of(const Scene& scene, int frame) {
    RenderOptions options = render_options(scene);
    options.samples = 1;
    const Sky sky = daylight_sky(
        {.sun_elevation_deg = scene.light.sun_elevation_deg, .sun_azimuth_deg = scene.light.sun_azimuth_deg});
    Renderer renderer(scene, options, sky, std::span(&frame, 1));
    Picture picture;
    try {
        renderer.render(frame, picture);
    } catch (const std::invalid_argument&) {
        return std::nullopt;
    }
    return picture;
}

void compare(double eye_m, double wind_mps, int columns) {
    const Scene scene = seen_from(eye_m, wind_mps, columns);
    std::optional<Picture> picture;
    int frame = 1;
    while (!(picture = picture_of(scene, frame))) frame += 12;  // low eyes are under water now and then
    const std::vector<double> query = skyline_of_query(scene, frame), seen = skyline_of(*picture);
    const double horizon_px = 0.5 * scene.camera.resolution.y;
    double above = 0.0, highest = 0.0;
    std::vector<double> off(query.size());
    for (std::size_t i = 0; i < off.size(); ++i) {
        above += horizon_px - query[i] > 1.5 ? 1.0 : 0.0;
        highest = std::max(highest, horizon_px - query[i]);
        off[i] = std::abs(query[i] - seen[i]);
    }
    std::sort(off.begin(), off.end());
    const double share = agreement(query, seen);
    std::printf("%6g %6g %6d %9.1f %9.0f %% %9.1f %% %9.2f %9.2f   >= 95 %% %s\n", wind_mps, eye_m, frame,
                highest, 100.0 * above / static_cast<double>(query.size()), 100.0 * share,
                off[off.size() / 2], off[off.size() * 95 / 100], verdict(share >= 0.95));
}

// Eight frames, the camera standing still or on its way: no frame may be worse than its neighbours.
void play(glm::dvec3 step_m, int columns) {
    Scene scene = seen_from(4.0, 20.0, columns);
    CameraKey first{.frame = 1, .position_m = scene.camera.position_m, .look_at_m = scene.camera.look_at_m},
        last = first;
    last.frame = 8;
    last.position_m += 7.0 * step_m;
    last.look_at_m += 7.0 * step_m;
    scene.camera.keys = {first, last};
    std::printf("  %4.1f m a frame:", glm::length(step_m));
    for (int frame = 1; frame <= 8; ++frame) {
        const std::optional<Picture> picture = picture_of(scene, frame);
        if (picture)
            std::printf(" %6.1f", 100.0 * agreement(skyline_of_query(scene, frame), skyline_of(*picture)));
        else
            std::printf("  under");
    }
    std::printf(" %%\n");
}

}  // namespace
}  // namespace pelagic::bench

int main(int count, char** words) {
    const int columns = count > 1 ? std::atoi(words[1]) : 1280;
    std::printf(
        "The skyline of pictures of %d columns against the query's [px]\n  wind    eye  frame   highest   above "
        "1.5    within 1    median      95 %%\n",
        columns);
    for (const double wind_mps : {6.0, 12.0, 20.0})
        for (const double eye_m : {2.0, 4.0, 15.0}) pelagic::bench::compare(eye_m, wind_mps, columns);
    std::printf("Frames 1 ... 8 of 20 m/s from 4 m, columns within a pixel\n");
    pelagic::bench::play(glm::dvec3(0.0), columns);
    pelagic::bench::play({0.3, 0.6, 0.02}, columns);
}
