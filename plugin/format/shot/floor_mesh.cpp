#include "plugin/format/shot/floor_mesh.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <utility>

#include "core/scene/text.h"
#include "plugin/format/obj/obj.h"
#include "plugin/format/shot/text_file.h"

namespace pelagic {
namespace {

constexpr const char* kAccepted =
    "a Wavefront OBJ of at most 256 MiB and a million faces, none of whose edges three faces share: z up, in metres, with an area from above";
constexpr double kThinnest = 1e-3;     // shorter over longer side
constexpr double kLeastSide_m = 0.01;  // as of a picture
// Texels of triangles' boxes: some seconds. A mesh without folds has two for each texel, or a few for each of many small faces.
constexpr double kMostWork = 1e9;

double cross(glm::dvec2 a, glm::dvec2 b) {
    return a.x * b.y - a.y * b.x;
}

// Raises a grid's heights to a triangle's; x and y are in texels.
void raise(std::vector<float>& heights, glm::ivec2 columns_rows, glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) {
    const double area = cross(glm::dvec2(b - a), glm::dvec2(c - a));
    if (area == 0.0) return;
    const auto first = [](double at, int most) {
        return static_cast<int>(std::clamp(std::ceil(at - 0.5), 0.0, static_cast<double>(most)));
    };
    const glm::dvec3 least = glm::min(a, glm::min(b, c)), most = glm::max(a, glm::max(b, c));
    // Neighbours leave no gap: what lies on their edge is of both.
    constexpr double kEdge = -1e-9;
    for (int y = first(least.y, columns_rows.y); y < columns_rows.y && y + 0.5 <= most.y; ++y)
        for (int x = first(least.x, columns_rows.x); x < columns_rows.x && x + 0.5 <= most.x; ++x) {
            const glm::dvec2 at(x + 0.5, y + 0.5);
            const double of_a = cross(glm::dvec2(b) - at, glm::dvec2(c) - at) / area,
                         of_b = cross(glm::dvec2(c) - at, glm::dvec2(a) - at) / area,
                         of_c = 1.0 - of_a - of_b;
            if (std::min({of_a, of_b, of_c}) < kEdge) continue;
            float& height = heights[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_rows.x) +
                                    static_cast<std::size_t>(x)];
            height = std::max(height, static_cast<float>(of_a * a.z + of_b * b.z + of_c * c.z));
        }
}

}  // namespace

bool is_floor_mesh(const std::string& path) {
    return has_ending(path, ".obj");
}

Cage read_floor_mesh(const std::filesystem::path& path) {
    std::string text;
    try {
        text = read_text_file(path, kMostObjBytes);
    } catch (const TextFileError& error) {
        throw FloorMeshError(error.what(), kAccepted);
    }
    try {
        return parse_obj(text, line_text(path.filename().string()));
    } catch (const ObjError& error) {
        throw FloorMeshError("is no floor: " + error.problem(), error.accepted());
    }
}

FloorDepths depths_of(const CageMesh& mesh, double rest_m, double beyond_m) {
    std::vector<bool> is_hole(mesh.face_counts.size());
    for (const std::int32_t face : mesh.holes) is_hole[static_cast<std::size_t>(face)] = true;
    // Each face's corners, as triangles round its first.
    const auto each_triangle = [&](const auto& take) {
        std::size_t first = 0;
        const auto point = [&](std::size_t i) {
            return mesh.points_m[static_cast<std::size_t>(mesh.indices[i])];
        };
        for (std::size_t face = 0; face < mesh.face_counts.size(); ++face) {
            const auto count = static_cast<std::size_t>(mesh.face_counts[face]);
            for (std::size_t k = 2; k < count && !is_hole[face]; ++k)
                take(point(first), point(first + k - 1), point(first + k));
            first += count;
        }
    };
    glm::dvec3 least(1e300), most(-1e300);
    each_triangle([&](const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
        least = glm::min(least, glm::min(a, glm::min(b, c)));
        most = glm::max(most, glm::max(a, glm::max(b, c)));
    });
    const glm::dvec2 extent(most - least);
    const double longer_m = std::max(extent.x, extent.y);
    if (!(std::min(extent.x, extent.y) > kThinnest * longer_m && longer_m >= kLeastSide_m))
        throw FloorMeshError("has no area from above", kAccepted);
    FloorDepths depths;
    depths.columns_rows = glm::max(glm::ivec2(glm::round(kFloorMeshTexels / longer_m * extent)), 1);
    depths.from_m = glm::dvec2(least);
    depths.size_m = extent;
    constexpr float kNone = -1e30f;
    depths.depths_m.assign(
        static_cast<std::size_t>(depths.columns_rows.x) * static_cast<std::size_t>(depths.columns_rows.y),
        kNone);
    const auto in_texels = [&](const glm::dvec3& point) {
        return glm::dvec3((glm::dvec2(point) - depths.from_m) / extent * glm::dvec2(depths.columns_rows),
                          point.z);
    };
    double work = 0.0;
    each_triangle([&](const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
        const glm::dvec3 p = in_texels(a), q = in_texels(b), r = in_texels(c);
        const glm::dvec2 box(glm::max(p, glm::max(q, r)) - glm::min(p, glm::min(q, r)));
        work += (box.x + 1.0) * (box.y + 1.0);
    });
    if (work > kMostWork) throw FloorMeshError("covers itself too often", kAccepted);
    each_triangle([&](const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
        raise(depths.depths_m, depths.columns_rows, in_texels(a), in_texels(b), in_texels(c));
    });
    constexpr double kMost_m = 1e5;
    for (float& depth : depths.depths_m)
        depth = static_cast<float>(
            std::clamp(depth == kNone ? beyond_m : rest_m - static_cast<double>(depth), -kMost_m, kMost_m));
    return depths;
}

}  // namespace pelagic
