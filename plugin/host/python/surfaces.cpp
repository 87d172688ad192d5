// Rest surfaces: pelagic.patch, pelagic.View and its projected grid, and the quads of both.
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "core/scene/limits.h"
#include "core/surface/footprint_levels.h"
#include "core/surface/patch.h"
#include "core/surface/projected_grid.h"
#include "core/surface/view.h"
#include "plugin/host/python/arrays.h"
#include "plugin/host/python/bindings.h"
#include "plugin/host/python/sea.h"
#include "plugin/host/python/watch.h"

namespace pelagic::python {
namespace {

namespace py = pybind11;
using Triple = std::array<double, 3>;

py::array grid_quads(int columns, int rows) {
    Faces faces = beside_others([=] { return grid_faces(columns, rows); });
    const auto quads = static_cast<py::ssize_t>(faces.counts.size());
    return array_of<std::int32_t>(std::move(faces.indices), {quads, 4});
}

py::tuple patch(double size_m, int resolution) {
    if (!limits::kSurfaceSize_m.holds(size_m))
        throw py::value_error("size_m: is outside the range; accepted: " + text_of(limits::kSurfaceSize_m));
    if (!limits::kSurfaceResolution.holds(resolution))
        throw py::value_error("resolution: is outside the range; accepted: " +
                              text_of(limits::kSurfaceResolution));
    auto points = beside_others([=] {
        return rest_points<float>(
            {.per_side = resolution + 1, .spacing_m = size_m / resolution, .first_m = -0.5 * size_m});
    });
    return py::make_tuple(array_of<float>(std::move(points)), grid_quads(resolution, resolution));
}

// ---- View

glm::dvec3 vector_of(const Triple& v) {
    return {v[0], v[1], v[2]};
}
py::tuple tuple_of(glm::dvec3 v) {
    return py::make_tuple(v.x, v.y, v.z);
}

View make_view(const Triple& position_m, const Triple& right, const Triple& up, const Triple& forward,
               double tan_half_width, std::array<int, 2> resolution, std::array<double, 2> shift) {
    return checked_view({.position_m = vector_of(position_m),
                         .right = vector_of(right),
                         .up = vector_of(up),
                         .forward = vector_of(forward),
                         .tan_half_width = tan_half_width,
                         .resolution = {resolution[0], resolution[1]},
                         .shift = {shift[0], shift[1]}});
}

View view_of_scene(const Scene& scene, double frame) {
    require_valid(scene);
    if (!limits::kFrame.holds(frame))
        throw py::value_error("frame: is outside the range; accepted: " + text_of(limits::kFrame));
    return view_at(scene.camera, frame);
}

void add_view(py::module_& module) {
    py::class_<View>(
        module, "View", py::module_local(),
        "A camera: a pinhole whose pixels are square.\n\n"
        "position_m: (x, y, z) [m]. right, up, forward: unit vectors of the picture in world axes, "
        "up = right × forward. tan_half_width: the tangent of half the horizontal field of view. "
        "resolution: (width, height) in pixels. shift: of the picture's middle off the axis, to the right and up, in widths "
        "of the picture.")
        .def(py::init(&make_view), py::kw_only(), py::arg("position_m"), py::arg("right"), py::arg("up"),
             py::arg("forward"), py::arg("tan_half_width"), py::arg("resolution"),
             py::arg("shift") = std::array<double, 2>{})
        .def_static("of_scene", &view_of_scene, py::arg("scene"), py::arg("frame"),
                    "The camera of a scene at a frame, which may lie between frames.")
        .def_property_readonly(
            "position_m", [](const View& self) { return tuple_of(self.position_m); }, "(x, y, z) [m].")
        .def_property_readonly(
            "right", [](const View& self) { return tuple_of(self.right); }, "Unit, world axes.")
        .def_property_readonly(
            "up", [](const View& self) { return tuple_of(self.up); }, "Unit, world axes.")
        .def_property_readonly(
            "forward", [](const View& self) { return tuple_of(self.forward); }, "Unit, world axes.")
        .def_readonly("tan_half_width", &View::tan_half_width,
                      "Tangent of half the horizontal field of view.")
        .def_property_readonly(
            "resolution",
            [](const View& self) { return py::make_tuple(self.resolution.x, self.resolution.y); },
            "(width, height) in pixels.")
        .def_property_readonly(
            "shift", [](const View& self) { return py::make_tuple(self.shift.x, self.shift.y); },
            "(x, y) of the picture's middle off the axis, in widths of the picture.")
        .def(
            "__eq__", [](const View& self, const View& other) { return self == other; }, py::is_operator());
}

// ---- The projected grid

constexpr int kMostCells = 8192;  // as many as a view asks for at most

struct PythonGrid {
    int columns = 0, rows = 0;
    glm::dvec2 origin_m{0.0};
    py::array rest_m, cell_m, pixel_m, cell_axis_m, pixel_axis_m;
};

ProjectedGridSize checked_size(const std::optional<std::array<int, 2>>& size) {
    if (!size) return {};
    for (const int count : *size)
        if (count < 1 || count > kMostCells)
            throw py::value_error("size: accepted: (columns, rows), each 1 … " + std::to_string(kMostCells));
    return {(*size)[0], (*size)[1]};
}

ProjectedGridOptions options_of(const PythonSea& sea) {
    ProjectedGridOptions options = projected_grid_options(*sea.plan().from);
    options.curvature_per_m = 0.0;  // hosts' own meshes of it stay flat
    return options;
}

PythonGrid grid_of(const PythonSea& sea, const View& view, const std::optional<std::array<int, 2>>& size) {
    ProjectedGridOptions options = options_of(sea);
    options.size = checked_size(size);
    options.has_levels = sea.query().cell_m.size() > 1;
    ProjectedGrid grid = beside_others([view, options] { return projected_grid(view, options); });
    return {.columns = grid.columns,
            .rows = grid.rows,
            .origin_m = grid.origin_m,
            .rest_m = array_of<float>(std::move(grid.rest_m)),
            .cell_m = array_of<float>(std::move(grid.cell_m)),
            .pixel_m = array_of<float>(std::move(grid.pixel_m)),
            .cell_axis_m = array_of<float>(std::move(grid.cell_axis_m)),
            .pixel_axis_m = array_of<float>(std::move(grid.pixel_axis_m))};
}

// Whether the sea's levels begin no coarser than the view's own grid needs.
bool serves(const PythonSea& sea, const View& view) {
    const Query& query = sea.query();
    if (!query.is_view) return false;
    if (query.cell_m.size() == 1 && query.cell_m.front() == 0.0) return true;  // trains: any footprint
    const ProjectedGridNeeds needs = projected_grid_needs(view, options_of(sea));
    return query.cell_m.front() <= first_level_m(needs.finest_cell_m);
}

}  // namespace

void add_grids(py::module_& module, py::class_<PythonSea>& sea) {
    py::class_<PythonGrid>(
        module, "ProjectedGrid", py::module_local(),
        "The points at rest that a view shows, to the horizon: cells of about "
        "surface.cell_px pixels, by row from the innermost outwards.\n\n"
        "As a bake writes them: frame.evaluate(grid.rest_m, grid.origin_m, "
        "cell_m=grid.cell_m, cell_axis_m=grid.cell_axis_m, pixel_m=grid.cell_m, "
        "pixel_axis_m=grid.cell_axis_m), since a mesh's vertices are its only samples. With "
        "grid.pixel_m and grid.pixel_axis_m instead normals are as fine as pixels.")
        .def_readonly("columns", &PythonGrid::columns, "Quads a row.")
        .def_readonly("rows", &PythonGrid::rows, "Rows of quads.")
        .def_property_readonly(
            "origin_m",
            [](const PythonGrid& self) { return py::make_tuple(self.origin_m.x, self.origin_m.y); },
            "(x, y) below the camera [m], in double precision: the points are relative to it.")
        .def_readonly("rest_m", &PythonGrid::rest_m,
                      "float32 ((columns+1)·(rows+1), 2) [m], columns fastest.")
        .def_readonly("cell_m", &PythonGrid::cell_m, "float32, of each point: its cell's short side [m].")
        .def_readonly("cell_axis_m", &PythonGrid::cell_axis_m,
                      "float32 (n, 2), of each point: its cell's long side, as a vector [m].")
        .def_readonly("pixel_m", &PythonGrid::pixel_m,
                      "float32, of each point: what a pixel covers there across the view [m].")
        .def_readonly("pixel_axis_m", &PythonGrid::pixel_axis_m,
                      "float32 (n, 2), of each point: what a pixel covers along the view, as a vector [m].")
        .def_property_readonly(
            "quads", [](const PythonGrid& self) { return grid_quads(self.columns, self.rows); },
            "int32 (columns·rows, 4), made anew: grid_quads(columns, rows). They depend on the size alone.");
    sea.def("projected_grid", &grid_of, py::arg("view"), py::arg("size") = py::none(),
            "The projected grid of a view.\n\n"
            "size: (columns, rows), for grids that are to share their quads; by default what the view needs, "
            "which changes with its pose. More make smaller cells, fewer larger ones.")
        .def("serves", &serves, py::arg("view"),
             "Whether the sea shows all waves that the cells of this view's grid can hold. Where it doesn't, "
             "the finest are left out and counted in slope_variance: build another, with views=[view].");
}

void add_surfaces(py::module_& module) {
    module.def("patch", &patch, py::arg("size_m"), py::arg("resolution"),
               "The square patch, as a bake writes it: (rest, quads).\n\n"
               "size_m: side of the patch, centred on the origin [m]. resolution: quads a side, N.\n"
               "rest: float32 ((N+1)², 2), points at rest [m], x fastest, y rising.\n"
               "quads: int32 (N², 4), each quad's points, counter-clockwise from above.");
    module.def("grid_quads", &grid_quads, py::arg("columns"), py::arg("rows"),
               "int32 (columns·rows, 4): the quads over (columns+1)·(rows+1) points, columns fastest, each "
               "quad's points counter-clockwise from above.");
    add_view(module);
}

}  // namespace pelagic::python
