// How sharp pictures are: one sample a pixel against 8 × 8, by band of lines below the horizon. Horizontal detail is the
// gradient of the logarithm of luminance from pixel to pixel; its correlation with that of 8 × 8 tells detail from
// aliasing. And rims: pixels on silhouettes outside the range of their 5 × 5 neighbours on the same surface.
// bench_sharpness [WIDTH [SAMPLES]]

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "core/surface/view.h"
#include "plugin/format/shot/shot.h"
#include "plugin/light/light.h"
#include "plugin/render/render.h"
#include "tests/bench/timing.h"
#include "tests/plugin/render/rims.h"

namespace pelagic::bench {
namespace {

struct Shown {
    const char* name;
    Scene scene;
};

std::vector<Shown> shots() {
    const auto file = [](const char* path) {
        return load_shot(std::string(PELAGIC_SOURCE_DIR "/examples/pictures/") + path, check_scene);
    };
    // A gale against the light: the sun is ahead of the camera, 25° high.
    Scene gale;
    gale.sea.wind_speed_mps = 20.0;
    gale.sea.wind_direction_deg = 200.0;
    gale.camera.position_m = {0.0, -60.0, 6.0};
    gale.camera.look_at_m = {0.0, 0.0, 2.5};
    gale.light.sun_elevation_deg = 25.0;
    gale.light.sun_azimuth_deg = 90.0;
    return {{"storm", file("storm.toml")}, {"noon", file("noon.toml")}, {"a backlit gale", gale}};
}

Picture picture_of(const Scene& scene, int samples, double* seconds = nullptr) {
    RenderOptions options = render_options(scene);
    options.samples = samples;
    options.layers = parse_picture_layers("depth");
    Picture picture;
    Renderer renderer(scene, options, make_sky(scene), std::array{1});
    const auto before = std::chrono::steady_clock::now();
    renderer.render(1, picture);
    if (seconds) *seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - before).count();
    return picture;
}

double luminance(const Picture& picture, std::size_t i) {
    return pelagic::luminance(picture.layers[i]);
}

struct Detail {
    double one2 = 0.0, many2 = 0.0, both = 0.0, one = 0.0, many = 0.0;
};

void compare(const Shown& shot, int width, int samples) {
    Scene scene = shot.scene;
    scene.camera.resolution = {width, width * 9 / 16};
    double seconds = 0.0;
    const Picture one = picture_of(scene, samples, &seconds), many = picture_of(scene, 8);
    // From the first line that is all sea down: bands that are twice as high each.
    int first = 0;
    const auto is_sea = [&](int y) {
        for (int x = 0; x < width; ++x)
            if (!one.sea[static_cast<std::size_t>(y) * width + x] ||
                !many.sea[static_cast<std::size_t>(y) * width + x])
                return false;
        return true;
    };
    while (first < one.resolution.y && !is_sea(first)) ++first;
    std::printf("%s, %d x %d: %.2f s\n  %-14s %9s %12s %10s\n", shot.name, one.resolution.x, one.resolution.y,
                seconds, "lines below", "gradient", "correlation", "mean");
    for (int from = 2, to; first + from < one.resolution.y; from = to) {
        to = std::min(2 * from + 4, one.resolution.y - first);
        Detail sum;
        for (int y = first + from; y < first + to; ++y)
            for (int x = 0; x + 1 < width; ++x) {
                const std::size_t i = static_cast<std::size_t>(y) * width + x;
                const double a = std::log(luminance(one, i + 1) / luminance(one, i));
                const double b = std::log(luminance(many, i + 1) / luminance(many, i));
                sum.one2 += a * a;
                sum.many2 += b * b;
                sum.both += a * b;
                sum.one += luminance(one, i);
                sum.many += luminance(many, i);
            }
        const double ratio = std::sqrt(sum.one2 / sum.many2),
                     correlation = sum.both / std::sqrt(sum.one2 * sum.many2);
        const double mean = sum.one / sum.many - 1.0;
        std::printf("  %4d … %-6d %9.2f %12.2f %9.1f %%   0.85 … 1.15 %s, >= 0.8 %s, within 2 %% %s\n", from,
                    to, ratio, correlation, 100.0 * mean, verdict(ratio >= 0.85 && ratio <= 1.15),
                    verdict(correlation >= 0.8), verdict(std::abs(mean) <= 0.02));
    }
    // Silhouettes as one sample sees them: of many, a pixel has several depths.
    const auto rims_of = [&](const Picture& picture) {
        return rims(picture, one.data[index(PictureLayer::Depth)], scene.camera.position_m.z,
                    view_at(scene.camera, 1).pixel_tangent());
    };
    const Rims of_one = rims_of(one), of_many = rims_of(many);
    std::printf("  rims: %d of %d pixels on silhouettes, 8 x 8: %d   %s\n", of_one.outside, of_one.silhouette,
                of_many.outside, verdict(of_one.outside <= of_many.outside));
}

}  // namespace
}  // namespace pelagic::bench

int main(int argc, char** argv) {
    const int width = argc > 1 ? std::atoi(argv[1]) : 640, samples = argc > 2 ? std::atoi(argv[2]) : 1;
    std::printf("One sample a pixel against 8 x 8: horizontal gradient of log luminance\n");
    for (const auto& shot : pelagic::bench::shots()) pelagic::bench::compare(shot, width, samples);
}
