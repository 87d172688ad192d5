#include "core/surface/rest_surface.h"

#include <algorithm>
#include <array>
#include <glm/common.hpp>
#include <limits>
#include <stdexcept>

#include "core/scene/text.h"
#include "core/surface/earth.h"
#include "core/surface/footprint_levels.h"
#include "core/surface/near_far.h"
#include "core/surface/patch.h"
#include "core/surface/projected_grid.h"

namespace pelagic {

// Of the library pelagic_cage, which alone needs OpenSubdiv: null where a program isn't linked with it.
[[gnu::weak]] std::unique_ptr<const RestSurface> make_cage_surface(const Scene& scene, const Extent& extent);

namespace {

// Points on a square lattice about the origin, `margin` of them outside the patch on each side.
class SquareLattice : public RestSurface {
  public:
    SquareLattice(const Scene& scene, int margin)
        : quads_(scene.surface.resolution),
          size_m_(scene.surface.size_m),
          lattice_{.per_side = quads_ + 1 + 2 * margin,
                   .spacing_m = size_m_ / quads_,
                   .first_m = -0.5 * size_m_ - margin * (size_m_ / quads_)} {}

    std::string describe() const override {
        const std::string quads = std::to_string(quads_);
        return "a patch of " + quads + " × " + quads + " quads over " + number_text(size_m_) + " m";
    }
    std::string remedy() const override { return "lower surface.resolution"; }
    bool is_constant() const override { return true; }
    bool has_constant_faces() const override { return true; }
    bool is_even() const override { return true; }
    std::optional<View> shaped_by(int) const override { return {}; }
    KeyPartSet key_parts() const override { return {}; }
    SurfaceNeeds needs(std::span<const int>) const override {
        const auto side = static_cast<std::size_t>(lattice_.per_side);
        return {.finest_cell_m = lattice_.spacing_m,
                .finest_pixel_m = lattice_.spacing_m,
                .lattice = Lattice{lattice_.first_m, lattice_.spacing_m, -lattice_.first_m},
                .points = side * side};
    }
    void points_at(int, RestPoints<float>& points) const override { lay_out(points); }
    void points_at(int, RestPoints<double>& points) const override { lay_out(points); }

  protected:
    int quads() const { return quads_; }

  private:
    template <class T>
    void lay_out(RestPoints<T>& points) const {
        points = {.rest_m = rest_points<T>(lattice_)};
    }

    int quads_;
    double size_m_;
    PatchLattice lattice_;
};

// A square of quads, centred on the origin.
class Patch final : public SquareLattice {
  public:
    Patch(const Scene& scene, const Extent&) : SquareLattice(scene, 0) {}
    void faces_at(int, Faces& faces) const override { set_grid_faces(quads(), quads(), faces); }
};

// The same as the limit surface of a cage.
class FittedPatch final : public SquareLattice {
  public:
    FittedPatch(const Scene& scene, const Extent&) : SquareLattice(scene, FittedCage::kMargin) {}
    std::string describe() const override {
        return SquareLattice::describe() +
               ", as the limit surface of a cage with a ring of vertices round it";
    }
    std::optional<FittedCage> fitted() const override { return FittedCage{quads()}; }
    // st is 0 … 1 over the patch, and goes on in the ring.
    void faces_at(int, Faces& faces) const override {
        const int with_ring = quads() + 2 * FittedCage::kRing;
        set_grid_faces(with_ring, with_ring, faces);
        std::size_t vertex = 0;
        for (int row = 0; row <= with_ring; ++row)
            for (int column = 0; column <= with_ring; ++column)
                faces.st[vertex++] = glm::dvec2(column - FittedCage::kRing, row - FittedCage::kRing) /
                                     static_cast<double>(quads());
    }
};

// What the camera sees. Each frame's grid has the size that its own pose asks for: a grid that served the
// whole shot would make each frame depend on all others.
class CameraGrid : public RestSurface {
  public:
    CameraGrid(const Scene& scene, const Extent& extent)
        : camera_(scene.camera),
          first_frame_(scene.shot.first_frame),
          options_(projected_grid_options(scene, extent)) {
        options_.has_levels = scene.waves.model == WaveModel::Fft || !scene.waves.cascades.empty();
    }

    std::string describe() const override {
        const ProjectedGridSize size = projected_grid_needs(seen(first_frame_), options_).size;
        return "the camera's projected grid, cells of at most " + number_text(options_.cell_px) +
               " pixels: " + std::to_string(size.columns) + " × " + std::to_string(size.rows) + " quads" +
               (camera_.keys.empty() ? ""
                                     : " at frame " + std::to_string(first_frame_) +
                                           ", each frame as many as its camera needs");
    }
    std::string remedy() const override { return "raise surface.cell_px, lower camera.resolution"; }
    bool is_constant() const override { return false; }
    bool has_constant_faces() const override { return false; }
    bool is_even() const override { return false; }
    std::optional<View> shaped_by(int frame) const override { return view_at(camera_, frame); }
    KeyPartSet key_parts() const override { return pelagic::key_parts(KeyPart::Grid); }

    SurfaceNeeds needs(std::span<const int> frames) const override {
        if (frames.empty()) return {.own_footprints = true};
        std::vector<View> views;
        for (const int frame : frames) views.push_back(seen(frame));
        const ProjectedGridNeeds all = projected_grid_needs(views, options_);
        // A file's vertices are its only samples: cells filter normals, too, as in a patch.
        return {.finest_cell_m = all.finest_cell_m,
                .finest_pixel_m = all.finest_cell_m,
                .own_footprints = true,
                .points = points_of(all.size)};
    }
    void points_at(int frame, RestPoints<float>& points) const override { lay_out(frame, points); }
    void points_at(int frame, RestPoints<double>& points) const override { lay_out(frame, points); }
    void faces_at(int frame, Faces& faces) const override {
        const ProjectedGridSize size = projected_grid_needs(seen(frame), options_).size;
        set_grid_faces(size.columns, size.rows, faces);
    }

  protected:
    // The camera's view; on a planet in the axes of the place below it.
    virtual View seen(int frame) const { return view_at(camera_, frame); }

    template <class T>
    void lay_out(int frame, RestPoints<T>& points) const {
        const ProjectedGrid grid = projected_grid(seen(frame), options_);
        points.origin_m = grid.origin_m;
        points.curvature_per_m = grid.curvature_per_m;
        points.touches_at_m = grid.origin_m;
        points.rest_m.assign(grid.rest_m.begin(), grid.rest_m.end());
        points.cell_m.assign(grid.cell_m.begin(), grid.cell_m.end());
        points.cell_axis_m.assign(grid.cell_axis_m.begin(), grid.cell_axis_m.end());
        points.pixel_m = points.cell_m;
        points.pixel_axis_m = points.cell_axis_m;
    }

    Camera camera_;

  private:
    int first_frame_;

  protected:
    ProjectedGridOptions options_;
};

// The same on one earth that stays: it touches z = 0 at the origin, where the shot's axes are its own, and points rest
// where the plane's lie as far from the origin in the same direction (azimuthal equidistant projection).
class Planet final : public CameraGrid {
  public:
    Planet(const Scene& scene, const Extent& extent) : CameraGrid(scene, extent) {
        options_.curvature_per_m = kEarthCurvature_per_m;
    }
    std::string describe() const override { return CameraGrid::describe() + ", on the earth's sphere"; }
    void points_at(int frame, RestPoints<float>& points) const override { lay_round(frame, points); }
    void points_at(int frame, RestPoints<double>& points) const override { lay_round(frame, points); }

  private:
    View seen(int frame) const override { return over_nadir(view_at(camera_, frame)); }

    template <class T>
    void lay_round(int frame, RestPoints<T>& points) const {
        lay_out(frame, points);
        const glm::dvec3 up = earth_up(points.origin_m, kEarthCurvature_per_m);
        for (glm::vec<2, T>& rest : points.rest_m) {
            const glm::dvec3 there = from_level(earth_up(glm::dvec2(rest), kEarthCurvature_per_m), up);
            rest = glm::vec<2, T>(earth_place(there) - points.origin_m);
        }
        points.touches_at_m = glm::dvec2(0.0);
    }
};

template <class Kind>
std::unique_ptr<const RestSurface> make(const Scene& scene, const Extent& extent) {
    return std::make_unique<const Kind>(scene, extent);
}

struct SurfaceRow {
    SurfaceKind kind;
    std::unique_ptr<const RestSurface> (*make)(const Scene&, const Extent&);
};

std::unique_ptr<const RestSurface> make_patch(const Scene& scene, const Extent& extent) {
    return scene.output.mesh_scheme == MeshScheme::CatmullClark ? make<FittedPatch>(scene, extent)
                                                                : make<Patch>(scene, extent);
}

std::unique_ptr<const RestSurface> make_cage(const Scene& scene, const Extent& extent) {
    if (!make_cage_surface)
        throw std::invalid_argument("surface.kind = \"cage\": this program isn't linked with Pelagic::cage");
    return make_cage_surface(scene, extent);
}

constexpr std::array kSurfaceTable = std::to_array<SurfaceRow>({
    {SurfaceKind::Patch, make_patch},
    {SurfaceKind::ProjectedGrid, make<CameraGrid>},
    {SurfaceKind::NearFar, make<NearFar>},
    {SurfaceKind::Planet, make<Planet>},
    {SurfaceKind::Cage, make_cage},
});

}  // namespace

glm::dvec3 local_origin(glm::dvec3 place_m, double finest_cell_m) {
    constexpr double kLongest_m = 4096.0;
    // A place is at most half a step away from the origin along each axis. Floats err by 2^−26 steps there, or by 2^−25
    // just beyond: by 2^−7 cells where a step is 2^18 of them.
    constexpr double kCells = 1 << 18;
    const double step_m = std::min(level_below_m(finest_cell_m) * kCells, kLongest_m);
    return glm::round(place_m / step_m) * step_m + 0.0;  // −0 is 0
}

void set_grid_faces(int columns, int rows, Faces& faces) {
    constexpr std::int64_t kMostQuads = std::numeric_limits<std::int32_t>::max() / 4;
    if (columns < 1 || rows < 1 || std::int64_t{columns} * rows > kMostQuads)
        throw std::invalid_argument("a grid of " + std::to_string(columns) + " × " + std::to_string(rows) +
                                    " quads: 1 … " + std::to_string(kMostQuads) + " quads are accepted");
    const auto quads = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
    const std::int32_t stride = columns + 1;
    faces.counts.assign(quads, 4);
    faces.indices.clear();
    faces.indices.reserve(4 * quads);
    for (std::int32_t row = 0; row < rows; ++row)
        for (std::int32_t column = 0; column < columns; ++column) {
            const std::int32_t first = row * stride + column;
            faces.indices.insert(faces.indices.end(), {first, first + 1, first + 1 + stride, first + stride});
        }
    faces.st.clear();
    faces.st.reserve(static_cast<std::size_t>(stride) * (static_cast<std::size_t>(rows) + 1));
    for (int row = 0; row <= rows; ++row)
        for (int column = 0; column <= columns; ++column)
            faces.st.emplace_back(static_cast<float>(static_cast<double>(column) / columns),
                                  static_cast<float>(static_cast<double>(row) / rows));
}

Faces grid_faces(int columns, int rows) {
    Faces faces;
    set_grid_faces(columns, rows, faces);
    return faces;
}

std::unique_ptr<const RestSurface> make_surface(const Scene& scene, const Extent& extent) {
    for (const SurfaceRow& row : kSurfaceTable)
        if (row.kind == scene.surface.kind) return row.make(scene, extent);
    throw std::logic_error("a surface without a row");
}

std::vector<int> representative_frames(const Scene& scene, int most) {
    const Shot& shot = scene.shot;
    const auto& keys = scene.camera.keys;
    if (keys.empty()) return {shot.first_frame};
    // Before its first key and after its last the camera stands still.
    const auto within = [&](int frame) { return std::clamp(frame, shot.first_frame, shot.last_frame); };
    const int first = within(keys.front().frame), last = within(keys.back().frame);
    const std::int64_t span = std::int64_t{last} - first;
    const std::int64_t steps = std::min<std::int64_t>(span, most - 1);
    std::vector<int> frames{first};
    for (std::int64_t i = 1; i <= steps; ++i) frames.push_back(static_cast<int>(first + span * i / steps));
    return frames;
}

}  // namespace pelagic
