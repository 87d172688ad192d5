// Small cages for tests, and their subdivision by the rules as they stand in the papers, without OpenSubdiv.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "pelagic/cage.h"

namespace pelagic::test {

inline CageMesh mesh_of(std::vector<glm::dvec3> points, const std::vector<std::vector<std::int32_t>>& faces) {
    CageMesh mesh;
    mesh.points_m = std::move(points);
    for (const auto& face : faces) {
        mesh.face_counts.push_back(static_cast<std::int32_t>(face.size()));
        mesh.indices.insert(mesh.indices.end(), face.begin(), face.end());
    }
    return mesh;
}

// columns × rows quads of side 1 from (0, 0), z of x and y.
template <class Height>
CageMesh grid_cage(int columns, int rows, const Height& height) {
    std::vector<glm::dvec3> points;
    for (int y = 0; y <= rows; ++y)
        for (int x = 0; x <= columns; ++x) points.emplace_back(x, y, height(x, y));
    std::vector<std::vector<std::int32_t>> faces;
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x) {
            const std::int32_t first = y * (columns + 1) + x;
            faces.push_back({first, first + 1, first + columns + 2, first + columns + 1});
        }
    return mesh_of(std::move(points), faces);
}

inline CageMesh cube() {
    return mesh_of(
        {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}},
        {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}});
}

inline CageMesh tetrahedron() {
    return mesh_of({{1, 1, 1}, {-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}},
                   {{0, 1, 3}, {0, 2, 1}, {0, 3, 2}, {1, 2, 3}});
}

// A prism over a pentagon: quads, and two faces of five corners.
inline CageMesh prism() {
    std::vector<glm::dvec3> points;
    for (int level = 0; level < 2; ++level)
        for (int i = 0; i < 5; ++i)
            points.emplace_back(std::cos(0.4 * 3.14159265358979 * i), std::sin(0.4 * 3.14159265358979 * i),
                                1.3 * level);
    return mesh_of(std::move(points), {{4, 3, 2, 1, 0},
                                       {5, 6, 7, 8, 9},
                                       {0, 1, 6, 5},
                                       {1, 2, 7, 6},
                                       {2, 3, 8, 7},
                                       {3, 4, 9, 8},
                                       {4, 0, 5, 9}});
}

// ---- Subdivision: Catmull & Clark 1978; sharp edges and points: DeRose, Kass & Truong 1998, where a fraction of a level
// blends the rules of before and after.

struct PlainMesh {
    std::vector<glm::dvec3> points;
    std::vector<std::vector<std::int32_t>> faces;
    std::map<std::pair<std::int32_t, std::int32_t>, double>
        edge_sharpness;  // lower point first; 0: not in it
    std::map<std::int32_t, double> point_sharpness;
};

inline std::pair<std::int32_t, std::int32_t> edge_of(std::int32_t a, std::int32_t b) {
    return {std::min(a, b), std::max(a, b)};
}

inline PlainMesh plain(const CageMesh& mesh) {
    PlainMesh out{mesh.points_m, {}, {}, {}};
    std::size_t first = 0;
    std::map<std::pair<std::int32_t, std::int32_t>, int> faces_at;
    std::map<std::int32_t, int> faces_round;
    for (const std::int32_t count : mesh.face_counts) {
        auto& face = out.faces.emplace_back();
        for (std::int32_t k = 0; k < count; ++k)
            face.push_back(mesh.indices[first + static_cast<std::size_t>(k)]);
        for (std::size_t k = 0; k < face.size(); ++k) {
            ++faces_at[edge_of(face[k], face[(k + 1) % face.size()])];
            ++faces_round[face[k]];
        }
        first += static_cast<std::size_t>(count);
    }
    constexpr double kInfinite = 1e9;
    const auto sharp = [](double sharpness) {
        return sharpness >= kInfiniteSharpness ? kInfinite : sharpness;
    };
    for (const CageMesh::Crease& crease : mesh.creases)
        out.edge_sharpness[edge_of(crease.from, crease.to)] = sharp(crease.sharpness);
    for (const CageMesh::Corner& corner : mesh.corners)
        out.point_sharpness[corner.point] = sharp(corner.sharpness);
    std::set<std::int32_t> at_boundary;
    for (const auto& [edge, faces] : faces_at)
        if (faces == 1) {
            out.edge_sharpness[edge] = kInfinite;
            at_boundary.insert({edge.first, edge.second});
        }
    if (mesh.boundary == CageBoundary::EdgeAndCorner)
        for (const std::int32_t point : at_boundary)
            if (faces_round[point] == 1) out.point_sharpness[point] = kInfinite;
    return out;
}

inline PlainMesh subdivided(const PlainMesh& mesh) {
    PlainMesh out;
    const auto points = static_cast<std::int32_t>(mesh.points.size());
    struct Edge {
        std::vector<std::int32_t> faces;
        std::int32_t point = 0;
    };
    std::map<std::pair<std::int32_t, std::int32_t>, Edge> edges;
    std::vector<glm::dvec3> face_points;
    std::vector<std::vector<std::int32_t>> faces_of(mesh.points.size());
    for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
        const auto& face = mesh.faces[f];
        glm::dvec3 sum(0.0);
        for (std::size_t k = 0; k < face.size(); ++k) {
            sum += mesh.points[static_cast<std::size_t>(face[k])];
            edges[edge_of(face[k], face[(k + 1) % face.size()])].faces.push_back(
                static_cast<std::int32_t>(f));
            faces_of[static_cast<std::size_t>(face[k])].push_back(static_cast<std::int32_t>(f));
        }
        face_points.push_back(sum / static_cast<double>(face.size()));
    }
    const auto sharpness_of = [&](const std::pair<std::int32_t, std::int32_t>& edge) {
        const auto found = mesh.edge_sharpness.find(edge);
        return found == mesh.edge_sharpness.end() ? 0.0 : found->second;
    };
    std::vector<std::vector<std::pair<std::int32_t, double>>> neighbours(
        mesh.points.size());  // and the edge's sharpness
    for (const auto& [ends, edge] : edges) {
        neighbours[static_cast<std::size_t>(ends.first)].emplace_back(ends.second, sharpness_of(ends));
        neighbours[static_cast<std::size_t>(ends.second)].emplace_back(ends.first, sharpness_of(ends));
    }
    for (std::int32_t p = 0; p < points; ++p) {
        const glm::dvec3 here = mesh.points[static_cast<std::size_t>(p)];
        const auto& around = neighbours[static_cast<std::size_t>(p)];
        const auto found = mesh.point_sharpness.find(p);
        const double own = found == mesh.point_sharpness.end() ? 0.0 : found->second;
        // By how sharp the edges are so much later.
        const auto moved = [&](double later) {
            std::vector<glm::dvec3> along;
            for (const auto& [other, sharpness] : around)
                if (sharpness - later > 0.0) along.push_back(mesh.points[static_cast<std::size_t>(other)]);
            if (own - later > 0.0 || along.size() > 2) return here;
            if (along.size() == 2) return 0.75 * here + 0.125 * (along[0] + along[1]);
            const auto n = static_cast<double>(around.size());
            glm::dvec3 faces(0.0), ends(0.0);
            for (const std::int32_t f : faces_of[static_cast<std::size_t>(p)])
                faces += face_points[static_cast<std::size_t>(f)] / n;
            for (const auto& [other, sharpness] : around)
                ends += mesh.points[static_cast<std::size_t>(other)] / n;
            return ((n - 2.0) * here + ends + faces) / n;
        };
        // The mean of what fades within this level.
        double fading = 0.0;
        int count = 0;
        const auto add = [&](double sharpness) {
            if (sharpness > 0.0 && sharpness < 1.0) fading += sharpness, ++count;
        };
        add(own);
        for (const auto& each : around) add(each.second);
        const glm::dvec3 now = moved(0.0);
        out.points.push_back(count == 0 ? now : glm::mix(moved(1.0), now, fading / count));
    }
    const auto first_face = static_cast<std::int32_t>(out.points.size());
    out.points.insert(out.points.end(), face_points.begin(), face_points.end());
    for (auto& [ends, edge] : edges) {
        const glm::dvec3 middle = 0.5 * (mesh.points[static_cast<std::size_t>(ends.first)] +
                                         mesh.points[static_cast<std::size_t>(ends.second)]);
        glm::dvec3 smooth = middle;
        if (edge.faces.size() == 2)
            smooth = 0.5 * middle + 0.25 * (face_points[static_cast<std::size_t>(edge.faces[0])] +
                                            face_points[static_cast<std::size_t>(edge.faces[1])]);
        const double sharpness = sharpness_of(ends);
        edge.point = static_cast<std::int32_t>(out.points.size());
        out.points.push_back(glm::mix(smooth, middle, std::min(sharpness, 1.0)));
        if (sharpness > 1.0)
            for (const std::int32_t end : {ends.first, ends.second})
                out.edge_sharpness[edge_of(end, edge.point)] = sharpness - 1.0;
    }
    for (const auto& [point, sharpness] : mesh.point_sharpness)
        if (sharpness > 1.0) out.point_sharpness[point] = sharpness - 1.0;
    for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
        const auto& face = mesh.faces[f];
        for (std::size_t k = 0; k < face.size(); ++k)
            out.faces.push_back({face[k], edges[edge_of(face[k], face[(k + 1) % face.size()])].point,
                                 first_face + static_cast<std::int32_t>(f),
                                 edges[edge_of(face[(k + face.size() - 1) % face.size()], face[k])].point});
    }
    return out;
}

}  // namespace pelagic::test
