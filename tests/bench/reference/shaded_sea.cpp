// Shades pixels with the projected grid. See shaded_sea.h.
#include "tests/bench/reference/shaded_sea.h"

#include <tbb/parallel_for.h>

#include <glm/geometric.hpp>

#include "core/evaluate/evaluate.h"
#include "core/surface/pixel_footprint.h"

namespace pelagic::bench {
namespace {

// The water's radiance from below in the units of shade_sea(), computed where its share is known: straight
// from above the Fresnel term of a mirror is ((n − 1)/(n + 1))², which the paper rounds to 0.02.
double radiance_from_below(const LightingChoice& choice, const Sky& sky, const WaterBody& water) {
    const SeaPoint level;
    SeaRadiance seen;
    shade_sea(choice, sky, water, {&level, 1}, {&seen, 1});
    const double reflected = choice.fresnel == FresnelFit::Paper ? 0.02 : (0.34 / 2.34) * (0.34 / 2.34);
    return luminance(seen.sea) / (1.0 - reflected);
}

// As the renderer has it: on the plane of the mesh's triangle. On a plane N·x = c a pixel's 1/w grows with N·ray.
PixelFootprint<float> pixel_on_mesh(const View& view, glm::vec3 direction, const SeaHit& hit) {
    const glm::vec3 right(view.right), up(view.up),
        ray = direction / glm::dot(direction, glm::vec3(view.forward));
    const float towards = glm::dot(hit.facet_normal, ray);
    return footprint_on_mesh(
        PixelFootprint<float>{
            .width = hit.pixel_m, .axis_x = hit.pixel_axis_m.x, .axis_y = hit.pixel_axis_m.y},
        right.x, right.y, up.x, up.y, ray.x, ray.y, glm::dot(hit.facet_normal, right) / towards,
        glm::dot(hit.facet_normal, up) / towards);
}

}  // namespace

SeaPixels sea_pixels(const WaveTile& tile, const View& view, const PixelOptions& options) {
    const ProjectedSea sea(tile, view, options.cell_px);
    SeaPixels pixels;
    const int n = options.samples;
    pixels.per_line = view.resolution.x * n * n;
    std::vector<glm::vec2> rest_m;
    std::vector<float> footprints_m;
    std::vector<glm::vec2> axes_m;
    for (int row = options.first_row; row < view.resolution.y; ++row) {
        pixels.first.push_back(rest_m.size());
        for (int i = 0; i < pixels.per_line; ++i) {
            const double column = i / (n * n), across = i % n, down = i / n % n;
            const glm::vec3 direction(view.direction({column + (across + 0.5) / n, row + (down + 0.5) / n}));
            SeaHit hit;
            if (!sea.trace({.origin_m = glm::vec3(view.position_m), .direction = direction}, hit)) continue;
            rest_m.push_back(hit.rest_m);
            const auto scale = static_cast<float>(options.pixels);
            const auto pixel = pixel_on_mesh(view, direction, hit);
            footprints_m.push_back(scale > 0.0f ? scale * pixel.width : hit.cell_m);
            axes_m.push_back(scale > 0.0f ? scale * glm::vec2(pixel.axis_x, pixel.axis_y) : hit.cell_axis_m);
            pixels.points.push_back({.to_eye = -direction});
        }
    }
    pixels.first.push_back(rest_m.size());
    Results<float> results;
    results.set(Product::Normal, {&pixels.points.front().normal, sizeof(SeaPoint)});
    results.set(Product::SlopeVariance, {&pixels.points.front().slope_variance, sizeof(SeaPoint)});
    evaluate(tile.frame(), kPixels,
             Points<float>{.count = rest_m.size(),
                           .rest_m = {rest_m.data()},
                           .pixel_m = {footprints_m.data()},
                           .pixel_axis_m = {axes_m.data()}},
             results);
    return pixels;
}

SeaPixels with_constant_variance(SeaPixels pixels) {
    const std::size_t begin = pixels.first[pixels.first.size() - 2], end = pixels.first.back();
    glm::vec3 sum(0.0f);
    for (std::size_t i = begin; i < end; ++i) sum += pixels.points[i].slope_variance;
    for (SeaPoint& point : pixels.points)
        point.slope_variance = sum / static_cast<float>(std::max<std::size_t>(end - begin, 1));
    return pixels;
}

Lines shaded_lines(const SeaPixels& pixels, const LightingChoice& choice, const Sky& sky, double refracted) {
    const WaterBody water{.reflectance = glm::vec3(0.05f)};
    const double scale = refracted / radiance_from_below(choice, sky, water);
    // The integral takes a hundred times as long. It is used for sky and water, which vary little between
    // samples: a prime number of them is left out, so that each place in a pixel and each column counts.
    const std::size_t step = choice.sky_quality == SkyQuality::Integral ? 29 : 1;
    Lines lines(pixels.first.size() - 1);
    tbb::parallel_for(std::size_t{0}, lines.size(), [&](std::size_t row) {
        std::vector<SeaPoint> points;
        for (std::size_t i = pixels.first[row]; i < pixels.first[row + 1]; i += step)
            points.push_back(pixels.points[i]);
        std::vector<SeaRadiance> radiance(points.size());
        shade_sea(choice, sky, water, points, radiance);
        const double all = static_cast<double>(pixels.first[row + 1] - pixels.first[row]);
        const double weight =
            all / pixels.per_line / static_cast<double>(std::max<std::size_t>(points.size(), 1));
        for (const SeaRadiance& sample : radiance) {
            lines[row].term[kSun] += weight * luminance(sample.sun);
            lines[row].term[kRefracted] += weight * scale * luminance(sample.sea);
            lines[row].term[kSky] += weight * luminance(sample.sky);
        }
    });
    return lines;
}

}  // namespace pelagic::bench
