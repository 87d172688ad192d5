// The projected grid on the earth's sphere, drawn: a pixel shows the sea where its ray meets the sphere, and nowhere else.
#include "core/surface/earth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <span>
#include <vector>

#include "core/surface/projected_grid.h"
#include "core/surface/view.h"
#include "plugin/render/raster.h"

namespace pelagic {
namespace {

constexpr glm::ivec2 kSize(160, 90);

std::vector<std::uint32_t> drawn(const View& view, const ProjectedGrid& grid) {
    const glm::dmat4 clip_from = view.clip_from(glm::dvec3(grid.origin_m, 0.0), 1e-6);
    std::vector<glm::dvec4> clip;
    for (const glm::vec2& rest : grid.rest_m)
        clip.push_back(clip_from *
                       glm::dvec4(on_earth(glm::dvec3(glm::dvec2(rest), 0.0), grid.curvature_per_m), 1.0));
    const auto triangles = projected_grid_triangles({grid.columns, grid.rows});
    Rasteriser raster;
    raster.set(clip, triangles, kSize);
    std::vector<std::uint32_t> shown(static_cast<std::size_t>(kSize.x) * kSize.y);
    for (int band = 0; band < raster.band_count(); ++band) {
        const std::size_t first = static_cast<std::size_t>(band) * Rasteriser::kBandRows * kSize.x;
        raster.draw(band, std::span(shown).subspan(
                              first, std::min<std::size_t>(shown.size() - first,
                                                           std::size_t{Rasteriser::kBandRows} * kSize.x)));
    }
    return shown;
}

TEST(Earth, IsWhereThePixelsRaysMeetIt) {
    for (const double height_m : {0.5, 4.0, 100.0, 8e3, 400e3})
        for (const double below : {0.0, 0.3, 1.0, 0.5 * kPi})  // of the horizon [rad]
            for (const double fov_deg : {8.0, 60.0}) {
                const double dip = std::acos(kEarthRadius_m / (kEarthRadius_m + height_m));
                const double elevation = std::max(-dip - below, -0.5 * kPi);
                Camera camera;
                camera.resolution = kSize;
                camera.fov_deg = fov_deg;
                camera.position_m = {3e4, -2e5, height_m};
                camera.look_at_m =
                    camera.position_m + height_m * glm::dvec3(0.6 * std::cos(elevation),
                                                              0.8 * std::cos(elevation), std::sin(elevation));
                const View view = view_at(camera, 1);
                const ProjectedGrid grid = projected_grid(view, {.cell_px = 4.0,
                                                                 .bounds = {.height_m = 3.0, .reach_m = 3.0},
                                                                 .significant_height_m = 2.0,
                                                                 .curvature_per_m = kEarthCurvature_per_m});
                const std::vector<std::uint32_t> shown = drawn(view, grid);
                int wrong = 0;
                for (int y = 0; y < kSize.y; ++y)
                    for (int x = 0; x < kSize.x; ++x) {
                        const glm::dvec3 way = view.direction({x + 0.5, y + 0.5});
                        const double over = std::asin(way.z) + dip;
                        if (std::abs(over) < 0.1 * view.pixel_tangent()) continue;  // a tenth of a pixel
                        const bool sea =
                            shown[static_cast<std::size_t>(y) * kSize.x + x] != Rasteriser::kNone;
                        if (sea != (over < 0.0)) ++wrong;
                    }
                EXPECT_EQ(wrong, 0) << "from " << height_m << " m, " << below << " below, lens " << fov_deg;
            }
}

}  // namespace
}  // namespace pelagic
