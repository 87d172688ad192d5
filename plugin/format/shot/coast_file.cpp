#include "plugin/format/shot/coast_file.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include "core/base/text.h"
#include "core/scene/text.h"
#include "plugin/format/exr/read.h"
#include "plugin/format/shot/floor_mesh.h"

namespace pelagic {
namespace {

constexpr int kMostPixels = 2048;  // a side, as of the floor that is seen

}  // namespace

std::vector<Problem> read_coast_depths(Scene& scene) {
    scene.waves.coast_depths.reset();
    const SeaState& sea = scene.sea;
    // What isn't read is refused by validate().
    const bool is_mesh = is_floor_mesh(sea.depth_file);
    if (!scene.waves.coast || !(is_mesh || has_ending(sea.depth_file, ".exr")) || !(sea.depth_size_m > 0.0))
        return {};
    const auto refused = [&](const std::string& problem, const std::string& accepted) {
        return std::vector{
            Problem{"sea.depth_file", quoted_text(sea.depth_file), line_text(problem), accepted}};
    };
    try {
        if (is_mesh) {
            FloorDepths of = depths_of(read_floor_mesh(sea.depth_file).mesh(), 0.0,
                                       std::min(sea.depth_m, kDeepestFloor_m));
            scene.waves.coast_depths = std::make_shared<const DepthMap>(
                of.columns_rows, std::move(of.depths_m), of.from_m, of.size_m);
            return {};
        }
        const exr::RgbFile picture(sea.depth_file);
        const int width = picture.width(), height = picture.height();
        if (std::max(width, height) > kMostPixels)
            return refused("has " + std::to_string(width) + " x " + std::to_string(height) + " pixels",
                           "a picture of up to " + std::to_string(kMostPixels) + " pixels a side");
        const auto columns = static_cast<std::size_t>(width);
        std::vector<float> depths(columns * static_cast<std::size_t>(height)),
            rgb(3 * columns * static_cast<std::size_t>(picture.rows_in_piece()));
        for (int row = 0; row < height; row += picture.rows_in_piece()) {
            const int rows = std::min(picture.rows_in_piece(), height - row);
            picture.read(row, std::span(rgb).first(3 * columns * static_cast<std::size_t>(rows)));
            for (int y = 0; y < rows; ++y)  // rows of a map are from the south
                for (std::size_t x = 0; x < columns; ++x)
                    depths[static_cast<std::size_t>(height - 1 - row - y) * columns + x] =
                        rgb[3 * (static_cast<std::size_t>(y) * columns + x)];
        }
        if (!std::ranges::all_of(depths, [](float depth) { return std::isfinite(depth); }))
            return refused("has depths that are no numbers", "depths in metres");
        const glm::dvec2 size_m(sea.depth_size_m, sea.depth_size_m * height / width);
        scene.waves.coast_depths = std::make_shared<const DepthMap>(
            glm::ivec2(width, height), std::move(depths),
            glm::dvec2(sea.depth_east_m, sea.depth_north_m) - 0.5 * size_m, size_m);
    } catch (const exr::ReadError& error) {
        return refused(error.problem(), error.accepted());
    } catch (const FloorMeshError& error) {
        return refused(error.what(), error.accepted());
    }
    return {};
}

}  // namespace pelagic
