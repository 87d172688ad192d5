// pelagic.read_mesh: the mesh files of a bake as arrays.
#include <pybind11/numpy.h>
#include <pybind11/stl/filesystem.h>

#include <filesystem>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/base/text.h"
#include "plugin/files/files.h"
#include "plugin/python/arrays.h"
#include "plugin/python/bindings.h"
#include "plugin/python/watch.h"
#include "plugin/shot/text_file.h"
#include "plugin/usd/read_mesh.h"

namespace pelagic::python {
namespace {

namespace py = pybind11;

constexpr std::size_t kMostBytes = std::size_t{8} << 30;  // a frame of 8192² quads has 3.5 GB

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& problem) {
    throw files::FileError(
        line_text(path.string()) + ": " + problem + "; accepted: a mesh file of a bake, mesh/NAME.####.usdc",
        path, std::make_error_code(std::errc::io_error));
}

usd::MeshLayer read_layer(const std::filesystem::path& path) {
    try {
        return usd::read_mesh_layer(read_text_file(path, kMostBytes));
    } catch (const TextFileError& error) {
        refuse(path, error.what());
    } catch (const usd::ReadError& error) {
        refuse(path, error.what());
    }
}

// USD's names and those of evaluate().
constexpr std::pair<std::string_view, std::string_view> kNames[] = {
    {"points", "position"},
    {"normals", "normal"},
    {"velocities", "velocity"},
    {"primvars:slopeVariance", "slope_variance"},
    {"primvars:whitecapCoverage", "coverage"},
    {"primvars:foamActive", "foam_active"},
    {"primvars:foamAge", "foam_age"},
    {"primvars:st", "st"},
    {"faceVertexCounts", "face_counts"},
    {"faceVertexIndices", "face_corners"}};

py::array as_array(usd::MeshArray& array) {
    return std::visit(
        [&](auto& values) -> py::array {
            using Number = typename std::remove_reference_t<decltype(values)>::value_type;
            std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(values.size()) / array.components};
            if (array.components > 1) shape.push_back(array.components);
            return array_of<Number>(std::move(values), shape);
        },
        array.values);
}

py::dict read_mesh(const std::filesystem::path& path) {
    usd::MeshLayer layer = beside_others([path] { return read_layer(path); });
    py::dict arrays;
    if (layer.frame) {
        const glm::dvec3 at = layer.origin_m.value_or(glm::dvec3(0.0));
        arrays["origin_m"] = array_of<double>(std::vector{at.x, at.y, at.z});
    }
    for (usd::MeshArray& array : layer.arrays)
        for (const auto& [name, key] : kNames)
            if (name == array.name) arrays[py::str(std::string(key))] = as_array(array);
    return arrays;
}

}  // namespace

void add_baked(py::module_& module) {
    module.def(
        "read_mesh", &read_mesh, py::arg("path"),
        "What a mesh file of a bake holds, DIR/mesh/NAME.####.usdc or .usda, NAME.topology.usdc: a "
        "dict of those that are there, float32 but for the origin and the faces.\n\n"
        "origin_m: float64 (3,), of each frame: where in the world the positions' origin is [m]. origin_m + position "
        "are the places. (0, 0, 0) but for what follows a camera far from the world's origin.\n"
        "position: (n, 3) [m]. normal: (n, 3). velocity: (n, 3) [m/s of the screen]. slope_variance: (n, 3), xx, yy, "
        "xy. coverage: (n,); of foam that lives foam_active: (n,), what of it breaks now, and foam_age: (n,) [s]. st: (n, 2), "
        "0 to 1; where the texture has seams one for each of face_corners.\n"
        "face_counts: int32 (f,), corners of each face. face_corners: int32, their points.\n\n"
        "A frame of a camera's grid has its own faces; of other surfaces they and st are in the "
        "topology's file alone. FileError for a file that is missing, cut short, damaged or another "
        "program's; what is returned fits together. Other threads run meanwhile.");
}

}  // namespace pelagic::python
