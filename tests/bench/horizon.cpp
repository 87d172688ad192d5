// The horizon in pictures of the CPU: its contrast from 8 km up, and its dip below the horizontal.
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "core/base/constants.h"
#include "core/lighting/colour.h"
#include "core/scene/scene.h"
#include "plugin/light/light.h"
#include "plugin/render/render.h"

namespace pelagic::bench {
namespace {

double dip_at(double height_m) {
    return std::acos(kEarthRadius_m / (kEarthRadius_m + height_m));
}

// Looks at the true horizon; `across` pixels wide, of which one covers this tangent.
Scene scene_at(double height_m, int across, double pixel_tangent) {
    Scene scene;
    scene.quality.level = QualityLevel::Draft;
    scene.sea.wind_speed_mps = 8.0;
    scene.camera.resolution = {across, across};
    scene.camera.fov_deg = 2.0 * std::atan(0.5 * across * pixel_tangent) * 180.0 / kPi;
    const double dip = dip_at(height_m);
    scene.camera.position_m = {0.0, 0.0, height_m};
    scene.camera.look_at_m = scene.camera.position_m + 1e3 * glm::dvec3(0.0, std::cos(dip), -std::sin(dip));
    return scene;
}

Picture rendered(const Scene& scene) {
    Renderer renderer(scene, render_options(scene), make_sky(scene), std::array{1});
    Picture picture;
    renderer.render(1, picture);
    return picture;
}

void print_contrast() {
    std::printf("The horizon from 8 km, sun 20° high: (sky − sea)/(sky + sea) of the rows beside it\n");
    std::printf("  %9s %10s %10s\n", "turbidity", "row above", "row below");
    for (const double turbidity : {2.0, 3.0, 8.0})
        for (const double azimuth_deg : {0.0, 90.0, 180.0}) {  // of the sun, from the view's
            Scene scene = scene_at(8e3, 64, 1.46e-3);          // 50° on 640
            scene.light.turbidity = turbidity;
            scene.light.sun_azimuth_deg = 90.0 + azimuth_deg;
            const Picture picture = rendered(scene);
            const auto mean = [&](int row) {
                double sum = 0.0;
                for (int x = 0; x < 64; ++x)
                    sum += luminance(
                        glm::dvec3(radiance_of(picture.layers[static_cast<std::size_t>(row) * 64 + x])));
                return sum / 64.0;
            };
            int row = 0;  // the first with sea in its middle
            while (row < 63 && picture.sea[static_cast<std::size_t>(row) * 64 + 32] == 0) ++row;
            const double above = mean(row - 1), below = mean(row);
            std::printf("  %9.0f %10.3f %10.3f   %5.1f %%, %3.0f° from the sun\n", turbidity, above, below,
                        100.0 * std::abs(above - below) / (above + below), azimuth_deg);
        }
}

// Of a picture 640 wide, 50°: measured with pixels a sixteenth as large, of a calm.
void print_dip() {
    constexpr double kPixel = 1.46e-3, kFiner = 16.0;
    std::printf(
        "\nDip of the horizon below the horizontal: picture − arccos(R/(R + h)), pixels of 50° on 640\n");
    std::printf("  %9s %10s %10s\n", "height", "dip", "error");
    for (const double height_m : {2.0, 10.0, 100.0, 1e3, 8e3, 100e3, 400e3}) {
        Scene scene = scene_at(height_m, 64, kPixel / kFiner);
        scene.sea.wind_speed_mps = 0.0;
        const Picture picture = rendered(scene);
        double worst = 0.0;
        for (int x = 0; x < 64; ++x) {
            int row = 0;
            while (row < 64 && picture.sea[static_cast<std::size_t>(row) * 64 + x] == 0) ++row;
            // The horizon is a circle's arc: lower beside the picture's middle.
            const double tangent = (x + 0.5 - 32.0) * kPixel / kFiner;
            const double sag = 0.5 * tangent * tangent * std::tan(dip_at(height_m)) * kFiner / kPixel;
            worst = std::max(worst, std::abs(row - 32.0 - sag) / kFiner);
        }
        std::printf("  %7.0f m %9.4f° %7.3f px\n", height_m, dip_at(height_m) * 180.0 / kPi, worst);
    }
}

}  // namespace
}  // namespace pelagic::bench

int main() {
    pelagic::bench::print_contrast();
    pelagic::bench::print_dip();
}
