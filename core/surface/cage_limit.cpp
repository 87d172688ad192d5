#include "core/surface/cage_limit.h"

#include <opensubdiv/bfr/refinerSurfaceFactory.h>
#include <opensubdiv/bfr/surface.h>
#include <opensubdiv/bfr/tessellation.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/far/topologyRefiner.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <mutex>
#include <optional>
#include <shared_mutex>
#include <stdexcept>

namespace pelagic {
namespace {

namespace Bfr = OpenSubdiv::Bfr;
namespace Far = OpenSubdiv::Far;
namespace Sdc = OpenSubdiv::Sdc;

using SharedCache = Bfr::SurfaceFactoryCacheThreaded<std::shared_mutex, std::shared_lock<std::shared_mutex>,
                                                     std::unique_lock<std::shared_mutex>>;
using Factory = Bfr::RefinerSurfaceFactory<SharedCache>;
using LimitSurface = Bfr::Surface<double>;

// How many levels OpenSubdiv isolates irregular places before a single patch replaces the rest. The surface is then
// exact at all points of cage_level's halvings and of one halving more; sharpness of any kind ends within its ten
// levels.
constexpr int kSmoothLevel = 7, kSharpLevel = 10;

Sdc::Options::VtxBoundaryInterpolation rule_of(CageBoundary boundary) {
    switch (boundary) {
        case CageBoundary::EdgeOnly:
            return Sdc::Options::VTX_BOUNDARY_EDGE_ONLY;
        case CageBoundary::None:
            return Sdc::Options::VTX_BOUNDARY_NONE;
        case CageBoundary::EdgeAndCorner:
            break;
    }
    return Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER;
}

std::unique_ptr<const Far::TopologyRefiner> refiner_of(const CageMesh& mesh) {
    std::vector<int> crease_points, corner_points;
    std::vector<float> crease_sharpness, corner_sharpness;
    const auto sharp = [](double sharpness) {
        return static_cast<float>(std::min(sharpness, kInfiniteSharpness));
    };
    for (const CageMesh::Crease& crease : mesh.creases) {
        crease_points.insert(crease_points.end(), {crease.from, crease.to});
        crease_sharpness.push_back(sharp(crease.sharpness));
    }
    for (const CageMesh::Corner& corner : mesh.corners) {
        corner_points.push_back(corner.point);
        corner_sharpness.push_back(sharp(corner.sharpness));
    }
    Far::TopologyDescriptor about;
    about.numVertices = static_cast<int>(mesh.points_m.size());
    about.numFaces = static_cast<int>(mesh.face_counts.size());
    about.numVertsPerFace = mesh.face_counts.data();
    about.vertIndicesPerFace = mesh.indices.data();
    about.numCreases = static_cast<int>(mesh.creases.size());
    about.creaseVertexIndexPairs = crease_points.data();
    about.creaseWeights = crease_sharpness.data();
    about.numCorners = static_cast<int>(mesh.corners.size());
    about.cornerVertexIndices = corner_points.data();
    about.cornerWeights = corner_sharpness.data();
    about.numHoles = static_cast<int>(mesh.holes.size());
    about.holeIndices = mesh.holes.data();
    Sdc::Options options;
    options.SetVtxBoundaryInterpolation(rule_of(mesh.boundary));
    using Make = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
    std::unique_ptr<const Far::TopologyRefiner> refiner(
        Make::Create(about, Make::Options(Sdc::SCHEME_CATMARK, options)));
    if (!refiner) throw std::invalid_argument("a cage that OpenSubdiv doesn't take");
    return refiner;
}

Factory::Options factory_options() {
    Factory::Options options;
    options.SetApproxLevelSmooth(kSmoothLevel).SetApproxLevelSharp(kSharpLevel);
    return options;
}

// A face's pattern: its points by its edges, then inside, and its triangles and quads.
class Pattern {
  public:
    Pattern(int corners, std::span<const int> edge_rates, std::array<int, 2> inner)
        : parameters_(Sdc::SCHEME_CATMARK, corners), rates_(edge_rates.begin(), edge_rates.end()) {
        rates_.push_back(inner[0]);
        if (corners == 4) rates_.push_back(inner[1]);
        const bool is_uniform =
            std::all_of(rates_.begin(), rates_.end(), [&](int rate) { return rate == rates_.front(); });
        Bfr::Tessellation::Options options;
        options.SetFacetSize(4).PreserveQuads(true);
        if (is_uniform)
            pattern_.emplace(parameters_, rates_.front(), options);
        else
            pattern_.emplace(parameters_, static_cast<int>(rates_.size()), rates_.data(), options);
        if (!pattern_->IsValid()) throw std::logic_error("rates that make no pattern");
    }

    std::size_t inside() const { return static_cast<std::size_t>(pattern_->GetNumInteriorCoords()); }
    void coordinates(std::vector<glm::dvec2>& uv) const {
        uv.resize(static_cast<std::size_t>(pattern_->GetNumCoords()));
        pattern_->GetCoords(&uv.data()->x);
    }
    // Four indices each, the last −1 in triangles.
    void facets(std::vector<std::array<int, 4>>& facets) const {
        facets.resize(static_cast<std::size_t>(pattern_->GetNumFacets()));
        pattern_->GetFacets(facets.data()->data());
    }

  private:
    Bfr::Parameterization parameters_;
    std::vector<int> rates_;
    std::optional<Bfr::Tessellation> pattern_;
};

// Bilinear in quads and in each of the quads that another face is cut into first.
glm::dvec2 texture_at(std::span<const glm::dvec2> corners, glm::dvec2 uv) {
    const auto between = [](std::array<glm::dvec2, 4> at, glm::dvec2 place) {
        const glm::dvec2 low = at[0] + place.x * (at[1] - at[0]), high = at[3] + place.x * (at[2] - at[3]);
        return low + place.y * (high - low);
    };
    const std::size_t count = corners.size();
    if (count == 4) return between({corners[0], corners[1], corners[2], corners[3]}, uv);
    const Bfr::Parameterization parameters(Sdc::SCHEME_CATMARK, static_cast<int>(count));
    glm::dvec2 place;
    const auto part = static_cast<std::size_t>(parameters.ConvertCoordToNormalizedSubFace(&uv.x, &place.x));
    glm::dvec2 middle(0.0);
    for (const glm::dvec2& corner : corners) middle += corner / static_cast<double>(count);
    const glm::dvec2 &here = corners[part], &next = corners[(part + 1) % count],
                     &before = corners[(part + count - 1) % count];
    return between({here, 0.5 * (here + next), middle, 0.5 * (before + here)}, place);
}

glm::dvec3 unit_or_none(const glm::dvec3& place_m, const glm::dvec3& along_u, const glm::dvec3& along_v) {
    const glm::dvec3 normal = glm::cross(along_u, along_v);
    const double length = glm::length(normal);
    // The normal of parallel tangents is nothing but rounding.
    const double least = 1e-12 * glm::length(along_u) * glm::length(along_v);
    const double rounding_m = 1e-13 * glm::length(place_m);
    const bool has_tangents = glm::length(along_u) > rounding_m && glm::length(along_v) > rounding_m;
    return has_tangents && length > least ? normal / length : glm::dvec3(0.0);
}

constexpr glm::dvec3 kUp{0.0, 0.0, 1.0};

// Sums of unit normals, in the order of the samples.
void join_normals(const CageMeshing& meshing, std::span<const glm::dvec3> of_samples,
                  std::vector<glm::dvec3>& normals) {
    normals.assign(meshing.points, glm::dvec3(0.0));
    for (std::size_t i = 0; i < meshing.samples.size(); ++i)
        normals[static_cast<std::size_t>(meshing.samples[i].point)] += of_samples[i];
    for (glm::dvec3& normal : normals) {
        const double length = glm::length(normal);
        normal = length > 1e-6 ? normal / length : kUp;
    }
}

}  // namespace

struct CageLimit::Surfaces {
    explicit Surfaces(const CageMesh& mesh)
        : refiner(refiner_of(mesh)), factory(*refiner, factory_options()) {}

    std::unique_ptr<const Far::TopologyRefiner> refiner;
    Factory factory;

    // Calls visit(surface, face, first, end) for the samples of each face that has some, on all threads.
    template <class Visit>
    void for_faces(const CageMeshing& meshing, const Visit& visit) const {
        constexpr std::size_t kGrain = 16;
        const std::size_t faces = meshing.first_samples.size() - 1;
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, faces, kGrain), [&](const auto& range) {
            LimitSurface surface;
            for (std::size_t face = range.begin(); face != range.end(); ++face) {
                const std::size_t first = meshing.first_samples[face], end = meshing.first_samples[face + 1];
                if (first == end) continue;
                if (!factory.InitVertexSurface(static_cast<int>(face), &surface))
                    throw std::logic_error("a face of a cage without a surface has points");
                visit(surface, first, end);
            }
        });
    }
};

CageLimit::~CageLimit() = default;

CageLimit::CageLimit(const CageMesh& mesh)
    : surfaces_(std::make_unique<const Surfaces>(mesh)), control_points_(mesh.points_m.size()) {
    const Far::TopologyLevel level = surfaces_->refiner->GetLevel(0);
    edge_points_.reserve(static_cast<std::size_t>(level.GetNumEdges()));
    is_sharp_point_.resize(control_points_);
    for (int edge = 0; edge < level.GetNumEdges(); ++edge) {
        const auto ends = level.GetEdgeVertices(edge);
        edge_points_.push_back({ends[0], ends[1]});
        const bool is_sharp =
            !level.IsEdgeBoundary(edge) && Sdc::Crease::IsInfinite(level.GetEdgeSharpness(edge));
        is_sharp_edge_.push_back(is_sharp);
        if (is_sharp)
            for (int end = 0; end < 2; ++end) is_sharp_point_[static_cast<std::size_t>(ends[end])] = true;
    }
    for (const CageMesh::Corner& corner : mesh.corners)
        if (corner.sharpness >= kInfiniteSharpness)
            is_sharp_point_[static_cast<std::size_t>(corner.point)] = true;
    first_corners_ = {0};
    corner_points_ = mesh.indices;
    corner_edges_.reserve(mesh.indices.size());
    for (int face = 0; face < level.GetNumFaces(); ++face) {
        const auto of_face = level.GetFaceEdges(face);
        for (int k = 0; k < of_face.size(); ++k) corner_edges_.push_back(of_face[k]);
        first_corners_.push_back(corner_edges_.size());
        has_surface_.push_back(surfaces_->factory.FaceHasLimitSurface(face));
    }
    corner_st_.reserve(mesh.indices.size());
    if (mesh.st.empty()) {
        // Seen from above: the box round the points of its faces.
        glm::dvec2 low(mesh.points_m[static_cast<std::size_t>(mesh.indices.front())]), high = low;
        for (const std::int32_t index : mesh.indices) {
            const glm::dvec2 point(mesh.points_m[static_cast<std::size_t>(index)]);
            low = glm::min(low, point), high = glm::max(high, point);
        }
        const glm::dvec2 size = high - low,
                         by(size.x > 0.0 ? 1.0 / size.x : 0.0, size.y > 0.0 ? 1.0 / size.y : 0.0);
        for (const std::int32_t index : mesh.indices)
            corner_st_.push_back((glm::dvec2(mesh.points_m[static_cast<std::size_t>(index)]) - low) * by);
        return;
    }
    std::vector<const glm::dvec2*> st_of(control_points_, nullptr);
    for (std::size_t k = 0; k < mesh.indices.size(); ++k) {
        const glm::dvec2& st = mesh.st[static_cast<std::size_t>(mesh.st_indices[k])];
        const glm::dvec2*& known = st_of[static_cast<std::size_t>(mesh.indices[k])];
        has_seams_ = has_seams_ || (known && *known != st);
        known = &st;
        corner_st_.push_back(st);
    }
}

std::span<const std::int32_t> CageLimit::face_points(std::size_t face) const {
    return std::span(corner_points_)
        .subspan(first_corners_[face], first_corners_[face + 1] - first_corners_[face]);
}

std::span<const std::int32_t> CageLimit::face_edges(std::size_t face) const {
    if (!has_surface_[face]) return {};
    return std::span(corner_edges_)
        .subspan(first_corners_[face], first_corners_[face + 1] - first_corners_[face]);
}

CageRates CageLimit::uniform_rates(int segments) const {
    return {std::vector<int>(edges(), segments),
            std::vector<std::array<int, 2>>(faces(), {segments, segments})};
}

std::size_t CageLimit::count_points(const CageRates& rates) const {
    std::vector<bool> is_counted_edge(edges()), is_counted_point(control_points_);
    std::vector<int> of_edges;
    std::size_t points = 0;
    const auto is_first = [](std::vector<bool>& counted, std::int32_t index) {
        const bool first = !counted[static_cast<std::size_t>(index)];
        counted[static_cast<std::size_t>(index)] = true;
        return first;
    };
    for (std::size_t face = 0; face < faces(); ++face) {
        if (!has_surface_[face]) continue;
        of_edges.clear();
        for (const std::int32_t point : face_points(face))
            points += is_first(is_counted_point, point) ? 1 : 0;
        for (const std::int32_t edge : face_edges(face)) {
            of_edges.push_back(rates.edges[static_cast<std::size_t>(edge)]);
            if (is_first(is_counted_edge, edge)) points += static_cast<std::size_t>(of_edges.back() - 1);
        }
        points += Pattern(static_cast<int>(of_edges.size()), of_edges, rates.faces[face]).inside();
    }
    return points;
}

CageMeshing CageLimit::mesh(const CageRates& rates) const {
    CageMeshing out;
    out.faces.is_st_of_corners = has_seams_;
    std::vector<std::int32_t>&point_of = out.of_points, &first_of = out.of_edges;
    point_of.assign(control_points_, -1);
    first_of.assign(edges(), -1);
    out.of_faces.assign(faces(), -1);
    std::vector<int> of_edges;
    std::vector<glm::dvec2> uv;
    std::vector<std::int32_t> global;
    std::vector<std::array<int, 4>> facets;
    std::int32_t points = 0;
    // There are hardly more facets than points.
    const std::size_t all = count_points(rates);
    out.samples.reserve(all);
    out.faces.counts.reserve(all);
    out.faces.indices.reserve(4 * all);
    out.faces.st.reserve(has_seams_ ? 4 * all : all);
    for (std::size_t face = 0; face < faces(); ++face) {
        out.first_samples.push_back(out.samples.size());
        if (!has_surface_[face]) continue;
        const auto corners = face_points(face);
        const auto face_edge = face_edges(face);
        of_edges.clear();
        for (const std::int32_t edge : face_edge)
            of_edges.push_back(rates.edges[static_cast<std::size_t>(edge)]);
        const Pattern pattern(static_cast<int>(corners.size()), of_edges, rates.faces[face]);
        pattern.coordinates(uv);
        global.clear();
        const auto sample = [&](std::int32_t& known, bool is_sharp) {
            const bool is_own = known < 0;
            if (is_own) known = points++;
            if (is_own || is_sharp) out.samples.push_back({known, is_own, uv[global.size()]});
            global.push_back(known);
        };
        for (std::size_t k = 0; k < corners.size(); ++k) {
            const auto point = static_cast<std::size_t>(corners[k]);
            const auto edge = static_cast<std::size_t>(face_edge[k]);
            sample(point_of[point], is_sharp_point_[point]);
            const std::int32_t inner = of_edges[k] - 1;
            const bool is_new = first_of[edge] < 0, is_forward = edge_points_[edge][0] == corners[k];
            if (is_new) first_of[edge] = points, points += inner;
            for (std::int32_t i = 0; i < inner; ++i) {
                const std::int32_t at = first_of[edge] + (is_forward ? i : inner - 1 - i);
                if (is_new || is_sharp_edge_[edge]) out.samples.push_back({at, is_new, uv[global.size()]});
                global.push_back(at);
            }
        }
        if (global.size() < uv.size()) out.of_faces[face] = points;
        while (global.size() < uv.size()) {
            std::int32_t unknown = -1;
            sample(unknown, false);
        }
        const std::span<const glm::dvec2> corner_st =
            std::span(corner_st_).subspan(first_corners_[face], corners.size());
        if (!has_seams_) {
            out.faces.st.resize(static_cast<std::size_t>(points));
            for (std::size_t i = 0; i < uv.size(); ++i)
                out.faces.st[static_cast<std::size_t>(global[i])] = glm::vec2(texture_at(corner_st, uv[i]));
        }
        pattern.facets(facets);
        for (const std::array<int, 4>& facet : facets) {
            const int count = facet[3] < 0 ? 3 : 4;
            out.faces.counts.push_back(count);
            for (int i = 0; i < count; ++i) {
                const auto local = static_cast<std::size_t>(facet[static_cast<std::size_t>(i)]);
                out.faces.indices.push_back(global[local]);
                if (has_seams_) out.faces.st.push_back(glm::vec2(texture_at(corner_st, uv[local])));
            }
        }
    }
    out.first_samples.push_back(out.samples.size());
    out.points = static_cast<std::size_t>(points);
    return out;
}

std::vector<double> cells_of(const Faces& faces, std::span<const glm::dvec3> places_m, double finest_m) {
    std::vector<double> cells_m(places_m.size(), finest_m);
    const std::int32_t* corners = faces.indices.data();
    for (const std::int32_t count : faces.counts) {
        for (std::int32_t k = 0; k < count; ++k) {
            const auto a = static_cast<std::size_t>(corners[k]),
                       b = static_cast<std::size_t>(corners[(k + 1) % count]);
            const double length_m = glm::distance(places_m[a], places_m[b]);
            cells_m[a] = std::max(cells_m[a], length_m);
            cells_m[b] = std::max(cells_m[b], length_m);
        }
        corners += count;
    }
    return cells_m;
}

void CageLimit::place(const CageMeshing& meshing, std::span<const glm::dvec3> points_m,
                      std::vector<glm::dvec3>& places_m, std::vector<glm::dvec3>& normals) const {
    const Bfr::Surface<double>::PointDescriptor triples(3);
    places_m.resize(meshing.points);
    std::vector<glm::dvec3> of_samples(meshing.samples.size());
    surfaces_->for_faces(meshing, [&](const LimitSurface& surface, std::size_t first, std::size_t end) {
        std::vector<glm::dvec3> patch(static_cast<std::size_t>(surface.GetNumPatchPoints()));
        surface.PreparePatchPoints(&points_m.data()->x, triples, &patch.data()->x, triples);
        for (std::size_t i = first; i < end; ++i) {
            const CageMeshing::Sample& sample = meshing.samples[i];
            glm::dvec3 place, along_u, along_v;
            surface.Evaluate(&sample.uv.x, &patch.data()->x, triples, &place.x, &along_u.x, &along_v.x);
            if (sample.is_own) places_m[static_cast<std::size_t>(sample.point)] = place;
            of_samples[i] = unit_or_none(place, along_u, along_v);
        }
    });
    join_normals(meshing, of_samples, normals);
}

CageStencils CageLimit::stencils(const CageMeshing& meshing) const {
    CageStencils out;
    const std::size_t samples = meshing.samples.size();
    out.first.resize(samples + 1);
    // First how many weights each has, then the weights where they belong.
    surfaces_->for_faces(meshing, [&](const LimitSurface& surface, std::size_t first, std::size_t end) {
        for (std::size_t i = first; i < end; ++i)
            out.first[i + 1] = static_cast<std::size_t>(surface.GetNumControlPoints());
    });
    for (std::size_t i = 0; i < samples; ++i) out.first[i + 1] += out.first[i];
    out.control.resize(out.first.back());
    out.weights.resize(out.first.back());
    surfaces_->for_faces(meshing, [&](const LimitSurface& surface, std::size_t first, std::size_t end) {
        const auto count = static_cast<std::size_t>(surface.GetNumControlPoints());
        std::vector<int> control(count);
        std::vector<double> weights(3 * count);
        surface.GetControlPointIndices(control.data());
        for (std::size_t i = first; i < end; ++i) {
            double* const along_u = weights.data() + count;
            surface.EvaluateStencil(&meshing.samples[i].uv.x, weights.data(), along_u, along_u + count);
            for (std::size_t k = 0; k < count; ++k) {
                out.control[out.first[i] + k] = control[k];
                out.weights[out.first[i] + k] = {weights[k], along_u[k], along_u[count + k]};
            }
        }
    });
    return out;
}

void CageLimit::place(const CageMeshing& meshing, const CageStencils& stencils,
                      std::span<const glm::dvec3> points_m, std::vector<glm::dvec3>& places_m,
                      std::vector<glm::dvec3>& normals) {
    places_m.resize(meshing.points);
    std::vector<glm::dvec3> of_samples(meshing.samples.size());
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, meshing.samples.size(), 1024), [&](const auto& range) {
            for (std::size_t i = range.begin(); i != range.end(); ++i) {
                glm::dvec3 place(0.0), along_u(0.0), along_v(0.0);
                for (std::size_t k = stencils.first[i]; k < stencils.first[i + 1]; ++k) {
                    const glm::dvec3& at = points_m[static_cast<std::size_t>(stencils.control[k])];
                    const auto& [weight, by_u, by_v] = stencils.weights[k];
                    place += weight * at;
                    along_u += by_u * at;
                    along_v += by_v * at;
                }
                const CageMeshing::Sample& sample = meshing.samples[i];
                if (sample.is_own) places_m[static_cast<std::size_t>(sample.point)] = place;
                of_samples[i] = unit_or_none(place, along_u, along_v);
            }
        });
    join_normals(meshing, of_samples, normals);
}

}  // namespace pelagic
