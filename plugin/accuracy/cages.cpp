// Sweep of how finely a cage's limit surface is meshed.
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <memory>
#include <string>
#include <utility>

#include "core/surface/cage_limit.h"
#include "plugin/accuracy/mesh_error.h"
#include "plugin/accuracy/rows.h"
#include "plugin/accuracy/sea_answers.h"

namespace pelagic::rows {
namespace {

constexpr std::size_t kMostPoints = std::size_t{1} << 20;
// Where between a cell's nodes the mesh is compared with the surface, along each side.
constexpr std::array<double, 2> kBetween{0.25, 0.75};

// Each face of four corners with n × n cells, nodes row by row: what a mesh of these rates has there.
class FaceGrids {
  public:
    FaceGrids(std::shared_ptr<const CageLimit> limit, std::shared_ptr<const Cage> cage, int n)
        : n_(n), limit_(std::move(limit)), cage_(std::move(cage)) {
        for (std::size_t face = 0; face < limit_->faces(); ++face)
            if (limit_->face_edges(face).size() == 4) faces_.push_back(face);
    }
    bool empty() const { return faces_.empty(); }
    std::size_t faces() const { return faces_.size(); }
    std::size_t nodes_per_face() const { return static_cast<std::size_t>((n_ + 1) * (n_ + 1)); }
    std::size_t node(std::size_t face, int x, int y) const {
        return face * nodes_per_face() + static_cast<std::size_t>(y * (n_ + 1) + x);
    }

    // On the limit surface, of its nodes and of the places between them.
    std::vector<glm::dvec3> nodes_m() const {
        std::vector<glm::dvec2> uv;
        for (int y = 0; y <= n_; ++y)
            for (int x = 0; x <= n_; ++x) uv.push_back(glm::dvec2(x, y) / static_cast<double>(n_));
        return places_m(uv);
    }
    std::vector<glm::dvec3> between_m() const {
        std::vector<glm::dvec2> uv;
        for (int y = 0; y < n_; ++y)
            for (int x = 0; x < n_; ++x)
                for (const double v : kBetween)
                    for (const double u : kBetween)
                        uv.push_back((glm::dvec2(x, y) + glm::dvec2(u, v)) / static_cast<double>(n_));
        return places_m(uv);
    }
    // What the cells have at the places between their nodes.
    std::vector<glm::dvec3> drawn_between(const std::vector<glm::dvec3>& nodes) const {
        std::vector<glm::dvec3> drawn;
        for (std::size_t face = 0; face < faces_.size(); ++face)
            for (int y = 0; y < n_; ++y)
                for (int x = 0; x < n_; ++x) {
                    const glm::dvec3 &a = nodes[node(face, x, y)], &b = nodes[node(face, x + 1, y)],
                                     &c = nodes[node(face, x + 1, y + 1)], &d = nodes[node(face, x, y + 1)];
                    for (const double v : kBetween)
                        for (const double u : kBetween)
                            drawn.push_back((1.0 - v) * ((1.0 - u) * a + u * b) +
                                            v * ((1.0 - u) * d + u * c));
                }
        return drawn;
    }
    // How far each node's farthest neighbour is: the cell that its positions are filtered by.
    std::vector<float> cells_m(const std::vector<glm::dvec3>& nodes) const {
        std::vector<double> cells(nodes.size(), kFinestCell_m);
        const auto join = [&](std::size_t a, std::size_t b) {
            const double length_m = glm::distance(nodes[a], nodes[b]);
            cells[a] = std::max(cells[a], length_m);
            cells[b] = std::max(cells[b], length_m);
        };
        for (std::size_t face = 0; face < faces_.size(); ++face)
            for (int y = 0; y <= n_; ++y)
                for (int x = 0; x <= n_; ++x) {
                    if (x < n_) join(node(face, x, y), node(face, x + 1, y));
                    if (y < n_) join(node(face, x, y), node(face, x, y + 1));
                }
        return {cells.begin(), cells.end()};
    }

  private:
    std::vector<glm::dvec3> places_m(const std::vector<glm::dvec2>& uv) const {
        CageMeshing meshing;
        for (std::size_t face = 0, next = 0; face < limit_->faces(); ++face) {
            meshing.first_samples.push_back(meshing.samples.size());
            if (next == faces_.size() || faces_[next] != face) continue;
            ++next;
            for (const glm::dvec2& place : uv)
                meshing.samples.push_back({static_cast<std::int32_t>(meshing.samples.size()), true, place});
        }
        meshing.first_samples.push_back(meshing.samples.size());
        meshing.points = meshing.samples.size();
        std::vector<glm::dvec3> places, normals;
        limit_->place(meshing, cage_->mesh().points_m, places, normals);
        return places;
    }

    int n_;
    std::shared_ptr<const CageLimit> limit_;
    std::shared_ptr<const Cage> cage_;
    std::vector<std::size_t> faces_;
};

RestPoints<float> rest_of(const std::vector<glm::dvec3>& places_m, glm::dvec2 origin_m) {
    RestPoints<float> points;
    points.origin_m = origin_m;
    for (const glm::dvec3& place : places_m) points.rest_m.emplace_back(glm::dvec2(place) - origin_m);
    return points;
}

// The sea on the cage: its displacements where the surface lies at rest.
std::vector<glm::dvec3> displaced(const SeenSurface& seen, const RestPoints<float>& at,
                                  const std::vector<glm::dvec3>& places_m) {
    const std::vector<glm::vec3> position_m = positions_of(seen, at);
    std::vector<glm::dvec3> out;
    for (std::size_t i = 0; i < places_m.size(); ++i)
        out.push_back(glm::dvec3(position_m[i]) + glm::dvec3(0.0, 0.0, places_m[i].z));
    return out;
}

}  // namespace

Trials cage_levels(const Scene& shot) {
    if (shot.surface.kind != SurfaceKind::Cage) return {{}, "has nothing to sweep: the shot has no cage"};
    const auto cage = shot.surface.cage;
    const auto limit = std::make_shared<const CageLimit>(cage->mesh());
    const auto seen =
        std::make_shared<SeenSurface>(seen_surface(shot, view_at(shot.camera, middle_frame(shot))));
    seen->sea->set(middle_time_s(shot));
    const double height_m = std::max(seen->prepared->extent.significant_height_m, 1e-12);
    Trials trials;
    for (int splits = 0; splits <= 6; ++splits) {
        const int n = 1 << splits;
        const auto grids = std::make_shared<const FaceGrids>(limit, cage, n);
        if (grids->empty()) return {{}, "has nothing to sweep: no face of the cage has four corners"};
        if (splits > 1 && grids->faces() * grids->nodes_per_face() > kMostPoints) break;
        const auto nodes = std::make_shared<const std::vector<glm::dvec3>>(grids->nodes_m());
        const glm::dvec2 origin_m(nodes->front());
        auto points = std::make_shared<RestPoints<float>>(rest_of(*nodes, origin_m));
        points->cell_m = grids->cells_m(*nodes);
        trials.trials.push_back(
            {.setting = std::to_string(splits) + (splits == 1 ? " halving" : " halvings"),
             .is_shots = !shot.surface.cage_level.is_adaptive && shot.surface.cage_level.splits == splits,
             .run = [=] { positions_of(*seen, *points); },
             .errors =
                 [=] {
                     const std::vector<glm::dvec3> between = grids->between_m();
                     const std::vector<glm::dvec3> exact =
                         displaced(*seen, rest_of(between, origin_m), between);
                     return std::vector<double>{
                         rms(grids->drawn_between(displaced(*seen, *points, *nodes)), exact) / height_m};
                 },
             .bytes = points->rest_m.size() * 3 * sizeof(float)});
    }
    return trials;
}

}  // namespace pelagic::rows
