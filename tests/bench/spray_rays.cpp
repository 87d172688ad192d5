// Spray before a camera: the map that rays go through, at half its rows and columns, as it is, and at the double, against small
// steps through the sea itself (tests/plugin/render/exact_spray.h); and what it costs beside the picture. `bench_spray_rays COLUMNS` has smaller
// pictures.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <vector>

#include "plugin/light/light.h"
#include "plugin/render/render.h"
#include "plugin/render/spray_map.h"
#include "tests/bench/timing.h"
#include "tests/plugin/render/exact_spray.h"

namespace pelagic::bench {
namespace {

constexpr int kFrame = 1;
constexpr double kGain = 10.0;

Scene storm(double eye_m, int columns) {
    Scene scene;
    scene.sea.wind_speed_mps = 22.0;
    scene.effects.spray = true;
    scene.effects.spray_gain = kGain;
    scene.quality.level = QualityLevel::Preview;
    scene.camera.position_m = {0.0, -60.0, eye_m};
    scene.camera.look_at_m = {0.0, 10.0 * eye_m, 0.0};
    scene.camera.resolution = {columns, columns * 9 / 16};
    return scene;
}

// To the sea, over the whole picture.
std::vector<test::SprayRay> rays_of(const Picture& picture, const Frame<float>& frame, const View& view,
                                    double curvature_per_m) {
    std::vector<test::SprayRay> rays;
    const std::vector<float>& position = picture.data[index(PictureLayer::Position)];
    for (std::size_t i = 0; i < picture.sea.size(); i += picture.sea.size() / 700) {
        if (!picture.sea[i]) continue;
        const glm::dvec3 way =
            glm::dvec3(position[3 * i], position[3 * i + 1], position[3 * i + 2]) - view.position_m;
        const double length_m = glm::length(way);
        if (length_m < 8e3) rays.push_back({way / length_m, length_m});
    }
    return test::exact_rays(frame, view.position_m, curvature_per_m, 0.5, rays);
}

void measure(double eye_m, int columns) {
    const Scene scene = storm(eye_m, columns);
    RenderOptions options = render_options(scene);
    options.layers.set(index(PictureLayer::Position));
    const Sky sky = make_sky(scene);
    const View view = view_at(scene.camera, kFrame);
    Frame<float> frame(
        std::make_shared<const Sea<float>>(picture_plan(scene, std::span(&kFrame, 1), options)));
    frame.set(scene.shot.time_s(kFrame));
    const ProjectedGridOptions grid = projected_grid_options(*frame.sea().plan().from);
    Scene clear = scene;
    clear.effects.spray = false;
    Renderer with(scene, options, sky, std::span(&kFrame, 1)),
        without(clear, render_options(clear), sky, std::span(&kFrame, 1));
    Picture picture, clear_picture;
    const auto [map_columns, map_rows] = spray_map_size(columns);
    Spray half, as_is, twice;
    std::vector<Timed> timed{{"without", [&] { without.render(kFrame, clear_picture); }},
                             {"with", [&] { with.render(kFrame, picture); }},
                             {"half",
                              [&] {
                                  half = make_spray_map(frame, view, grid, {map_columns / 2, map_rows / 2});
                              }},
                             {"as is",
                              [&] {
                                  as_is = make_spray_map(frame, view, grid, {map_columns, map_rows});
                              }},
                             {"twice", [&] {
                                  twice = make_spray_map(frame, view, grid, {map_columns * 2, map_rows * 2});
                              }}};
    interleave(timed, 5);
    const double picture_ms = timed[0].median();
    const std::vector<test::SprayRay> rays = rays_of(picture, frame, view, grid.curvature_per_m);
    double exact = 0.0;
    for (const test::SprayRay& ray : rays)
        exact += (1.0 - std::exp(-ray.thickness)) / static_cast<double>(rays.size());
    std::printf("%5.0f m   exact   %7.4f\n", eye_m, exact);
    const auto row = [&](const char* name, const Spray& spray, double map_ms) {
        double mean = 0.0, square = 0.0;
        for (const test::SprayRay& ray : rays) {
            const double left = static_cast<double>(
                spray_before(spray, glm::vec3(ray.direction), static_cast<float>(ray.length_m), true)
                    .transmittance);
            mean += 1.0 - left;
            const double off = left - std::exp(-ray.thickness);
            square += off * off;
        }
        const auto count = static_cast<double>(rays.size());
        std::printf("          %-7s %7.4f   %+6.1f %%   %7.4f   %8.3f\n", name, mean / count,
                    100.0 * (mean / count / exact - 1.0), std::sqrt(square / count), map_ms / picture_ms);
    };
    row("half", half, timed[2].median());
    row("as is", as_is, timed[3].median());
    row("twice", twice, timed[4].median());
    std::printf("          the picture with spray takes %.2f of the one without\n",
                timed[1].median() / picture_ms);
}

}  // namespace
}  // namespace pelagic::bench

int main(int count, char** words) {
    const int columns = count > 1 ? std::atoi(words[1]) : 1280;
    std::printf(
        "Spray over 22 m/s at %g times nature's: the share of light that it takes, over rays to the sea; its error; the rms of a ray's; "
        "the map's time over the picture's, %d columns\n    eye   map       mean     error       rms   map time\n",
        pelagic::bench::kGain, columns);
    for (const double eye_m : {12.0, 40.0, 400.0}) pelagic::bench::measure(eye_m, columns);
}
