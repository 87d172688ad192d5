#include "core/surface/cage.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_reduce.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <stdexcept>
#include <utility>

#include "core/scene/text.h"
#include "core/surface/footprint_levels.h"

namespace pelagic {
namespace {

double distance_to_segment(const glm::dvec3& place, const glm::dvec3& from, const glm::dvec3& to) {
    const glm::dvec3 along = to - from;
    const double length2 = glm::dot(along, along);
    const double share = length2 > 0.0 ? std::clamp(glm::dot(place - from, along) / length2, 0.0, 1.0) : 0.0;
    return glm::distance(place, from + share * along);
}

double distance_to_triangle(const glm::dvec3& place, const glm::dvec3& a, const glm::dvec3& b,
                            const glm::dvec3& c) {
    const glm::dvec3 normal = glm::cross(b - a, c - a);
    const double area2 = glm::dot(normal, normal);
    // Above the triangle, if it is on the inner side of each of its sides.
    const auto is_inside = [&](const glm::dvec3& from, const glm::dvec3& to) {
        return glm::dot(glm::cross(to - from, place - from), normal) >= 0.0;
    };
    if (area2 > 0.0 && is_inside(a, b) && is_inside(b, c) && is_inside(c, a))
        return std::abs(glm::dot(place - a, normal)) / std::sqrt(area2);
    return std::min({distance_to_segment(place, a, b), distance_to_segment(place, b, c),
                     distance_to_segment(place, c, a)});
}

int segments_for(double length, double cell) {
    if (!(length > 0.0)) return 1;
    return static_cast<int>(
        std::clamp(std::ceil(length / cell), 1.0, static_cast<double>(CageAdaption::kMostSegments)));
}

// The middle of the box round the points of the faces that have a surface.
glm::dvec3 centre_of(const CageMesh& mesh, const CageLimit& limit) {
    glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
    for (std::size_t face = 0; face < limit.faces(); ++face) {
        if (limit.face_edges(face).empty()) continue;
        for (const std::int32_t index : limit.face_points(face)) {
            const glm::dvec3& point = mesh.points_m[static_cast<std::size_t>(index)];
            low = glm::min(low, point), high = glm::max(high, point);
        }
    }
    return 0.5 * (low + high);
}

std::shared_ptr<const Cage> given(std::shared_ptr<const Cage> cage) {
    if (!cage) throw std::invalid_argument("surface.kind = \"cage\" comes without a cage");
    return cage;
}

}  // namespace

// ---- How finely

CageAdaption::CageAdaption(const CageLimit& limit, std::span<const glm::dvec3> points_m, double cell_px,
                           double significant_height_m)
    : limit_(limit), cell_px_(cell_px), half_height_m_(0.5 * significant_height_m) {
    const CageMeshing coarse = limit.mesh(limit.uniform_rates(2));
    std::vector<glm::dvec3> places_m, normals;
    limit.place(coarse, points_m, places_m, normals);
    const auto take = [&](const std::vector<std::int32_t>& indices, std::vector<glm::dvec3>& out) {
        out.resize(indices.size());
        for (std::size_t i = 0; i < indices.size(); ++i)
            if (indices[i] >= 0) out[i] = places_m[static_cast<std::size_t>(indices[i])];
    };
    take(coarse.of_points, points_);
    take(coarse.of_edges, middles_);
    take(coarse.of_faces, centres_);
}

// From an eye to a face as a fan of triangles, one for each half of its edges.
double CageAdaption::distance_m(const glm::dvec3& eye_m, std::size_t face) const {
    const auto edges = limit_.face_edges(face);
    const auto corners = limit_.face_points(face);
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < edges.size(); ++k) {
        const glm::dvec3& middle = middles_[static_cast<std::size_t>(edges[k])];
        for (const std::size_t corner : {k, (k + 1) % edges.size()})
            least = std::min(
                least, distance_to_triangle(eye_m, points_[static_cast<std::size_t>(corners[corner])], middle,
                                            centres_[face]));
    }
    return least;
}

CageAdaption::Result CageAdaption::uniform(int segments) const {
    Result result{limit_.uniform_rates(segments), 0.0, 0.0};
    result.finest_m = finest_of(result.rates);
    return result;
}

CageAdaption::Result CageAdaption::at(const View& view) const {
    const auto cell_at = [&](double distance_m) {
        return std::max(cell_px_ * view.pixel_tangent() * std::hypot(distance_m, half_height_m_),
                        kFinestCell_m);
    };
    Result result{limit_.uniform_rates(1), 0.0, 0.0};
    std::vector<bool> is_done(limit_.edges());
    for (std::size_t face = 0; face < limit_.faces(); ++face) {
        const auto edges = limit_.face_edges(face);
        if (edges.empty()) continue;
        const double cell_m = cell_at(distance_m(view.position_m, face));
        std::array<double, 2> across_m{0.0, 0.0};
        for (std::size_t k = 0; k < edges.size(); ++k) {
            const auto edge = static_cast<std::size_t>(edges[k]);
            // Twice the half on this edge's side: the cell at the nearest place decides for the whole face.
            double& across = across_m[edges.size() == 4 ? (k + 1) % 2 : 0];
            across = std::max(across, 2.0 * glm::distance(middles_[edge], centres_[face]));
            if (is_done[edge]) continue;
            is_done[edge] = true;
            int segments = 1;
            for (const std::int32_t end : limit_.edge_points(edge)) {
                const glm::dvec3& corner = points_[static_cast<std::size_t>(end)];
                const double half_cell_m =
                    cell_at(distance_to_segment(view.position_m, corner, middles_[edge]));
                segments = std::max(segments,
                                    segments_for(2.0 * glm::distance(corner, middles_[edge]), half_cell_m));
            }
            result.rates.edges[edge] = segments;
            result.points += segments;
        }
        for (std::size_t i = 0; i < 2; ++i) result.rates.faces[face][i] = segments_for(across_m[i], cell_m);
        const auto [u, v] = result.rates.faces[face];
        result.points += edges.size() == 4
                             ? static_cast<double>(u) * v
                             : static_cast<double>(u) * u * static_cast<double>(edges.size()) / 4.0;
    }
    result.finest_m = finest_of(result.rates);
    return result;
}

double CageAdaption::finest_of(const CageRates& rates) const {
    double finest_m = std::numeric_limits<double>::infinity();
    for (std::size_t face = 0; face < limit_.faces(); ++face) {
        const auto edges = limit_.face_edges(face);
        for (std::size_t k = 0; k < edges.size(); ++k) {
            const auto edge = static_cast<std::size_t>(edges[k]);
            for (const std::int32_t end : limit_.edge_points(edge))
                finest_m =
                    std::min(finest_m, glm::distance(points_[static_cast<std::size_t>(end)], middles_[edge]) /
                                           rates.edges[edge]);
            const int across = rates.faces[face][edges.size() == 4 ? (k + 1) % 2 : 0];
            finest_m = std::min(finest_m, glm::distance(middles_[edge], centres_[face]) / across);
        }
    }
    return std::max(finest_m, kFinestCell_m);
}

// ---- The surface

CageSurface::CageSurface(const Scene& scene, const Extent& extent)
    : cage_(given(scene.surface.cage)),
      level_(scene.surface.cage_level),
      camera_(scene.camera),
      first_frame_(scene.shot.first_frame),
      cell_px_(scene.surface.cell_px),
      limit_(cage_->mesh()),
      adaption_(limit_, cage_->mesh().points_m, scene.surface.cell_px, extent.significant_height_m) {
    const glm::dvec3 centre_m = centre_of(cage_->mesh(), limit_);
    origin_m_ = local_origin({centre_m.x, centre_m.y, 0.0}, fineness_at(first_frame_)->rates.finest_m);
}

bool CageSurface::has_origin() const {
    return level_.is_adaptive || origin_m_ != glm::dvec3(0.0);
}

std::optional<View> CageSurface::shaped_by(int frame) const {
    if (!level_.is_adaptive) return {};
    return view_at(camera_, frame);
}

KeyPartSet CageSurface::key_parts() const {
    return level_.is_adaptive ? pelagic::key_parts(KeyPart::Cage, KeyPart::Grid)
                              : pelagic::key_parts(KeyPart::Cage);
}

CageSurface::Fineness CageSurface::made_fineness(int frame) const {
    Fineness made{.view = shaped_by(frame), .rates = {}, .points = 0};
    made.rates = made.view ? adaption_.at(*made.view) : adaption_.uniform(1 << level_.splits);
    constexpr auto kMost = static_cast<double>(CageAdaption::kMostPoints);
    if (made.rates.points > kMost)
        throw std::invalid_argument(
            "surface.cell_px = " + number_text(cell_px_) + " makes " +
            number_text(std::round(made.rates.points * 1e-6)) + " million points of the cage at frame " +
            std::to_string(frame) + "; accepted: up to " + number_text(std::round(kMost * 1e-6)) +
            " million: raise it to " +
            number_text(std::ceil(11.0 * cell_px_ * std::sqrt(made.rates.points / kMost)) / 10.0));
    made.points = limit_.count_points(made.rates.rates);
    return made;
}

std::shared_ptr<const CageSurface::Fineness> CageSurface::fineness_at(int frame) const {
    const std::optional<View> view = shaped_by(frame);
    const std::lock_guard<std::mutex> lock(fineness_mutex_);
    if (!fineness_ || fineness_->view != view)
        fineness_ = std::make_shared<const Fineness>(made_fineness(frame));
    return fineness_;
}

std::string CageSurface::describe() const {
    const CageMesh& mesh = cage_->mesh();
    const std::string points = std::to_string(fineness_at(first_frame_)->points) + " points";
    return "the limit surface of a cage of " + std::to_string(mesh.face_counts.size()) + " faces, " +
           (level_.is_adaptive
                ? "as finely as the camera sees it: " + points + " at frame " + std::to_string(first_frame_)
                : "its edges halved " + std::to_string(level_.splits) + " times: " + points);
}

std::string CageSurface::remedy() const {
    return level_.is_adaptive ? "raise surface.cell_px" : "lower surface.cage_level";
}

SurfaceNeeds CageSurface::needs(std::span<const int> frames) const {
    SurfaceNeeds needs{.own_footprints = true};
    if (frames.empty()) return needs;
    // Successive frames with the same view count once.
    std::vector<int> seen;
    for (const int frame : frames)
        if (seen.empty() || shaped_by(frame) != shaped_by(seen.back())) seen.push_back(frame);
    struct Needed {
        double finest_m = std::numeric_limits<double>::infinity();
        std::size_t points = 0;
    };
    const Needed needed = tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, seen.size(), 1), Needed{},
        [&](const tbb::blocked_range<std::size_t>& range, Needed so_far) {
            for (std::size_t i = range.begin(); i < range.end(); ++i) {
                const Fineness fineness = made_fineness(seen[i]);
                so_far.finest_m = std::min(so_far.finest_m, fineness.rates.finest_m);
                so_far.points = std::max(so_far.points, fineness.points);
            }
            return so_far;
        },
        [](const Needed& a, const Needed& b) {
            return Needed{std::min(a.finest_m, b.finest_m), std::max(a.points, b.points)};
        });
    needs.points = needed.points;
    // A file's vertices are its only samples: cells filter normals, too, as in a patch.
    needs.finest_cell_m = needs.finest_pixel_m = needed.finest_m;
    return needs;
}

std::shared_ptr<const CageSurface::Laid> CageSurface::laid_at(int frame) const {
    const std::optional<View> view = shaped_by(frame);
    const std::lock_guard<std::mutex> lock(laid_mutex_);
    if (laid_ && laid_->view == view) return laid_;
    laid_.reset();
    const std::shared_ptr<const Fineness> fineness = fineness_at(frame);
    CageMeshing meshing = limit_.mesh(fineness->rates.rates);
    auto laid = std::make_shared<Laid>();
    laid->view = view;
    // A thread that waits here must not take up other work that asks for this surface: it would wait for itself.
    tbb::this_task_arena::isolate(
        [&] { limit_.place(meshing, cage_->mesh().points_m, laid->places_m, laid->normals); });
    laid->faces = std::move(meshing.faces);
    laid->cell_m = cells_of(laid->faces, laid->places_m, first_level_m(fineness->rates.finest_m));
    return laid_ = std::move(laid);
}

template <class T>
void CageSurface::lay_out(int frame, RestPoints<T>& points) const {
    const std::shared_ptr<const Laid> laid = laid_at(frame);
    points.origin_m = glm::dvec2(origin_m_);
    points.rest_m.clear();
    points.height_m.clear();
    points.normal.clear();
    for (const glm::dvec3& place : laid->places_m) {
        points.rest_m.emplace_back(glm::dvec2(place) - points.origin_m);
        points.height_m.push_back(static_cast<T>(place.z));
    }
    for (const glm::dvec3& normal : laid->normals) points.normal.emplace_back(normal);
    points.cell_m.assign(laid->cell_m.begin(), laid->cell_m.end());
    points.pixel_m = points.cell_m;
}

SurfaceBytes CageSurface::bytes(std::size_t points, std::size_t scalar) const {
    // A pose's points and faces; while they are made, the mesh on the cage, with two samples at the points of its
    // edges; and of the points at rest the height, the normal and two footprints.
    const std::size_t faces = kQuadFaceBytes + (limit_.has_seams() ? kQuadSeamBytes : 0);
    constexpr std::size_t kLaid = 2 * sizeof(glm::dvec3) + sizeof(double);
    constexpr std::size_t kMade = sizeof(CageMeshing::Sample) + sizeof(glm::dvec3);
    return {.held = points * (kLaid + faces + 6 * scalar), .making = points * kMade};
}

void CageSurface::faces_at(int frame, Faces& faces) const {
    faces = laid_at(frame)->faces;
}

std::unique_ptr<const RestSurface> make_cage_surface(const Scene& scene, const Extent& extent) {
    return std::make_unique<const CageSurface>(scene, extent);
}

}  // namespace pelagic

// Whoever links pelagic_cage asks for this name, and so gets the function above, which the core asks for weakly.
extern "C" {
extern const char cages_are_linked;
const char cages_are_linked = 0;
}
