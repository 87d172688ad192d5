// pelagic.Cage, a mesh whose limit surface the sea lies on, and pelagic.CageSurface, points on that surface.
#include "plugin/host/python/cage.h"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/scene/limits.h"
#include "core/scene/text.h"
#include "core/surface/cage_limit.h"
#include "core/surface/rest_surface.h"
#include "plugin/format/obj/obj.h"
#include "plugin/format/shot/text_file.h"
#include "plugin/host/python/arrays.h"
#include "plugin/host/python/bindings.h"
#include "plugin/host/python/watch.h"

namespace pelagic::python {
namespace {

namespace py = pybind11;

[[noreturn]] void refuse_shape(const char* name, const std::string& accepted) {
    throw py::value_error(std::string(name) + ": accepted: " + accepted);
}

std::string shape_text(py::ssize_t columns, const char* what) {
    return columns == 1 ? std::string(what) + " of shape (n,)"
                        : std::string(what) + " of shape (n, " + std::to_string(columns) + ')';
}

// None: empty. Numbers of any type, or whole ones.
template <class Number>
std::vector<Number> list_of(const py::object& given, const char* name, py::ssize_t columns) {
    constexpr bool kWhole = std::is_integral_v<Number>;
    const std::string accepted = shape_text(columns, kWhole ? "whole numbers" : "numbers");
    if (given.is_none()) return {};
    const auto any = py::array::ensure(given);
    if (!any) refuse_shape(name, accepted);
    if (any.size() == 0) return {};
    const char kind = any.dtype().kind();
    if (kWhole ? kind != 'i' && kind != 'u' : kind != 'i' && kind != 'u' && kind != 'f')
        refuse_shape(name, accepted);
    const bool has_shape = columns == 1 ? any.ndim() == 1 : any.ndim() == 2 && any.shape(1) == columns;
    if (!has_shape) refuse_shape(name, accepted);
    using Wide = std::conditional_t<kWhole, std::int64_t, double>;
    const py::array_t<Wide, py::array::c_style | py::array::forcecast> values(any);
    std::vector<Number> out;
    out.reserve(static_cast<std::size_t>(values.size()));
    for (py::ssize_t i = 0; i < values.size(); ++i) {
        const Wide value = values.data()[i];
        if constexpr (kWhole)
            if (!std::in_range<Number>(value)) refuse_shape(name, accepted + ", of 32 bits");
        out.push_back(static_cast<Number>(value));
    }
    return out;
}

std::vector<glm::dvec3> points_of(const py::object& given, const char* name) {
    const std::vector<double> numbers = list_of<double>(given, name, 3);
    std::vector<glm::dvec3> points(numbers.size() / 3);
    for (std::size_t i = 0; i < points.size(); ++i)
        points[i] = {numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]};
    return points;
}

// One number for all, or one each.
std::vector<double> sharpness_of(const py::object& given, const char* name, std::size_t count) {
    if (given.is_none()) return std::vector<double>(count, kInfiniteSharpness);
    if (!py::isinstance<py::array>(given) && PyNumber_Check(given.ptr()) != 0)
        return std::vector<double>(count, py::float_(given));
    std::vector<double> numbers = list_of<double>(given, name, 1);
    if (numbers.size() != count)
        refuse_shape(name, "a number, or " + std::to_string(count) + " of them, one each");
    return numbers;
}

CageBoundary boundary_of(const std::string& word) {
    if (word == "edge-and-corner") return CageBoundary::EdgeAndCorner;
    if (word == "edge") return CageBoundary::EdgeOnly;
    if (word == "none") return CageBoundary::None;
    throw py::value_error("boundary: accepted: \"edge-and-corner\", \"edge\" or \"none\"");
}

PythonCage make_cage(const py::object& points, const py::object& face_counts, const py::object& indices,
                     const py::object& creases, const py::object& crease_sharpness, const py::object& corners,
                     const py::object& corner_sharpness, const py::object& holes, const py::object& st,
                     const py::object& st_indices, const std::string& boundary) {
    CageMesh mesh;
    mesh.points_m = points_of(points, "points");
    mesh.face_counts = list_of<std::int32_t>(face_counts, "face_counts", 1);
    mesh.indices = list_of<std::int32_t>(indices, "indices", 1);
    const std::vector<std::int32_t> ends = list_of<std::int32_t>(creases, "creases", 2);
    const std::vector<double> of_creases =
        sharpness_of(crease_sharpness, "crease_sharpness", ends.size() / 2);
    for (std::size_t i = 0; i < of_creases.size(); ++i)
        mesh.creases.push_back({ends[2 * i], ends[2 * i + 1], of_creases[i]});
    const std::vector<std::int32_t> sharp = list_of<std::int32_t>(corners, "corners", 1);
    const std::vector<double> of_corners = sharpness_of(corner_sharpness, "corner_sharpness", sharp.size());
    for (std::size_t i = 0; i < sharp.size(); ++i) mesh.corners.push_back({sharp[i], of_corners[i]});
    mesh.holes = list_of<std::int32_t>(holes, "holes", 1);
    const std::vector<double> texture = list_of<double>(st, "st", 2);
    for (std::size_t i = 0; i < texture.size(); i += 2) mesh.st.emplace_back(texture[i], texture[i + 1]);
    mesh.st_indices = list_of<std::int32_t>(st_indices, "st_indices", 1);
    mesh.boundary = boundary_of(boundary);
    return {beside_others(
                [mesh = std::move(mesh)]() mutable { return std::make_shared<const Cage>(std::move(mesh)); }),
            ""};
}

PythonCage cage_of_file(const std::filesystem::path& path) {
    try {
        return {beside_others([path] {
                    return std::make_shared<const Cage>(
                        parse_obj(read_text_file(path, kMostObjBytes), line_text(path.string())));
                }),
                path.string()};
    } catch (const TextFileError& error) {
        throw std::invalid_argument(line_text(path.string()) + ": the cage " + error.what());
    }
}

// ---- Its surface

class PythonCageSurface : public std::enable_shared_from_this<PythonCageSurface> {
  public:
    static std::shared_ptr<PythonCageSurface> make(const PythonCage& given, int level) {
        if (!limits::kCageLevel.holds(level))
            throw py::value_error("level: accepted: an integer, " + text_of(limits::kCageLevel));
        return beside_others(
            [cage = given.cage, level] { return std::make_shared<PythonCageSurface>(cage, level); });
    }
    PythonCageSurface(std::shared_ptr<const Cage> cage, int level)
        : cage_(std::move(cage)),
          limit_(cage_->mesh()),
          meshing_(limit_.mesh(limit_.uniform_rates(1 << level))) {}

    py::dict limit(const py::object& given) const {
        std::vector<glm::dvec3> moved = points_of(given, "points");
        if (!given.is_none() && moved.size() != limit_.control_points())
            refuse_shape("points", "numbers of shape (" + std::to_string(limit_.control_points()) +
                                       ", 3), as the cage's");
        for (const glm::dvec3& point : moved)
            for (int axis = 0; axis < 3; ++axis)
                if (!limits::kCagePoint_m.holds(point[axis]))
                    refuse_shape("points", "finite numbers, each " + text_of(limits::kCagePoint_m));
        Placed made =
            beside_others([self = shared_from_this(), moved = std::move(moved), own = given.is_none()] {
                return self->placed(own ? self->cage_->mesh().points_m : moved);
            });
        py::dict out;
        out["origin_m"] = py::make_tuple(made.origin_m.x, made.origin_m.y);
        out["rest_m"] = array_of<float>(std::move(made.rest_m));
        out["height_m"] = array_of<float>(std::move(made.height_m));
        out["normal"] = array_of<float>(std::move(made.normal));
        out["cell_m"] = array_of<float>(std::move(made.cell_m));
        return out;
    }

    const CageMeshing& meshing() const { return meshing_; }

  private:
    struct Placed {
        glm::dvec3 origin_m;
        std::vector<glm::vec2> rest_m;
        std::vector<float> height_m, cell_m;
        std::vector<glm::vec3> normal;
    };
    Placed placed(const std::vector<glm::dvec3>& points_m) const {
        // Made when they are first asked for.
        std::call_once(once_, [&] { stencils_ = limit_.stencils(meshing_); });
        std::vector<glm::dvec3> places_m, normals;
        CageLimit::place(meshing_, stencils_, points_m, places_m, normals);
        const std::vector<double> cells_m = cells_of(meshing_.faces, places_m, kFinestCell_m);
        Placed made;
        made.cell_m.assign(cells_m.begin(), cells_m.end());
        glm::dvec3 low = places_m.front(), high = low;
        for (const glm::dvec3& place : places_m) low = glm::min(low, place), high = glm::max(high, place);
        made.origin_m = local_origin({0.5 * (low.x + high.x), 0.5 * (low.y + high.y), 0.0},
                                     *std::min_element(cells_m.begin(), cells_m.end()));
        for (const glm::dvec3& place : places_m) {
            made.rest_m.emplace_back(glm::dvec2(place) - glm::dvec2(made.origin_m));
            made.height_m.push_back(static_cast<float>(place.z));
        }
        for (const glm::dvec3& each : normals) made.normal.emplace_back(each);
        return made;
    }

    std::shared_ptr<const Cage> cage_;
    CageLimit limit_;
    CageMeshing meshing_;
    mutable std::once_flag once_;
    mutable CageStencils stencils_;
};

}  // namespace

void add_cage(py::module_& module) {
    py::register_local_exception_translator([](std::exception_ptr thrown) {
        try {
            if (thrown) std::rethrow_exception(thrown);
        } catch (const CageError& error) {
            PyErr_SetString(PyExc_ValueError, error.what());
        } catch (const ObjError& error) {
            PyErr_SetString(PyExc_ValueError, error.what());
        }
    });
    const py::object none = py::none();
    py::class_<PythonCage>(
        module, "Cage", py::module_local(),
        "A mesh whose limit surface (Catmull–Clark, by OpenSubdiv) the sea lies on: scene.surface.cage with "
        "scene.surface.kind = \"cage\". It never changes.")
        .def(
            py::init(&make_cage), py::arg("points"), py::arg("face_counts"), py::arg("indices"),
            py::kw_only(), py::arg("creases") = none, py::arg("crease_sharpness") = none,
            py::arg("corners") = none, py::arg("corner_sharpness") = none, py::arg("holes") = none,
            py::arg("st") = none, py::arg("st_indices") = none, py::arg("boundary") = "edge-and-corner",
            "points: (n, 3) [m], z up. face_counts: (f,), corners of each face, 3 or more. indices: of all corners, into "
            "points, counter-clockwise seen from above.\n"
            "creases: (c, 2), edges that stay sharp, each by its two points. corners: points that do. Their sharpness: a "
            "number or one each, levels of refinement; 10 and more, and the default, for ever. A crease c of "
            "Blender's, 0 … 1, is 10 c² here.\n"
            "holes: faces that are left out. st: (m, 2) texture coordinates, st_indices: of all corners, into st.\n"
            "boundary: what edges with one face do: \"edge-and-corner\", \"edge\" (corners of one face are rounded off) or "
            "\"none\" (the outermost faces only shape the others).\n\n"
            "ValueError for what is no cage, such as edges with three faces, saying which part and what is accepted.")
        .def_static("from_file", &cage_of_file, py::arg("path"),
                    "The cage of a Wavefront OBJ, as surface.cage_file names it. ValueError with the line.")
        .def_property_readonly(
            "points", [](const PythonCage& self) { return self.cage->mesh().points_m.size(); },
            "How many points it has.")
        .def_property_readonly(
            "faces", [](const PythonCage& self) { return self.cage->mesh().face_counts.size(); },
            "How many faces it has, holes included.")
        .def_property_readonly(
            "content", [](const PythonCage& self) { return self.cage->content(); },
            "Numbers of faces and points and a hash of all that is in it: equal for equal cages.")
        .def(
            "__eq__",
            [](const PythonCage& self, const PythonCage& other) {
                return self.cage->content() == other.cage->content();
            },
            py::is_operator());
    py::class_<PythonCageSurface, std::shared_ptr<PythonCageSurface>>(
        module, "CageSurface", py::module_local(),
        "Points on the limit surface of a cage. What OpenSubdiv derives from faces and sharpness is made once; a cage that "
        "moves from frame to frame, its faces staying, asks limit() with its new points.")
        .def(py::init(&PythonCageSurface::make), py::arg("cage"), py::arg("level") = CageLevel{}.splits,
             "level: how often each edge is halved, 0 … 6.")
        .def(
            "limit", &PythonCageSurface::limit, py::arg("points") = none,
            "Where the points lie, of a cage with these points (n, 3) [m], or its own: a dict of origin_m (x, y), and float32 "
            "arrays: rest_m (m, 2) relative to origin_m, height_m (m,), normal (m, 3), the surface's, and cell_m (m,), the "
            "distance to the farthest neighbour [m].\n\n"
            "The sea on it: frame.evaluate(made[\"rest_m\"], made[\"origin_m\"], cell_m=made[\"cell_m\"], pixel_m=made[\"cell_m\"], "
            "rest_normal=made[\"normal\"]), whose positions then get height_m on top.")
        .def_property_readonly(
            "face_counts",
            [](const PythonCageSurface& self) {
                return array_of<std::int32_t>(std::vector<std::int32_t>(self.meshing().faces.counts));
            },
            "int32: corners of each face, 3 or 4. A new array each time, as below.")
        .def_property_readonly(
            "indices",
            [](const PythonCageSurface& self) {
                return array_of<std::int32_t>(std::vector<std::int32_t>(self.meshing().faces.indices));
            },
            "int32: of the faces' corners, into the points.")
        .def_property_readonly(
            "st",
            [](const PythonCageSurface& self) {
                return array_of<float>(std::vector<glm::vec2>(self.meshing().faces.st));
            },
            "float32 (n, 2): texture coordinates of the points, or where the cage has seams of the faces' corners; without "
            "any in the cage, x and y within the box round its points.");
}

}  // namespace pelagic::python
