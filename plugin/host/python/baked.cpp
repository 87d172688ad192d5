// pelagic.read_mesh: the mesh files of a bake as arrays.
#include <pybind11/numpy.h>
#include <pybind11/stl/filesystem.h>

#include <filesystem>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/base/text.h"
#include "core/plan/products.h"
#include "plugin/files/files.h"
#include "plugin/format/shot/text_file.h"
#include "plugin/format/usd/read_mesh.h"
#include "plugin/host/python/arrays.h"
#include "plugin/host/python/bindings.h"
#include "plugin/host/python/watch.h"

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

// Of an attribute: the product's, or the faces' own.
const char* key_of(std::string_view attribute) {
    for (const ProductRow& row : kProductTable)
        if (row.in_meshes && attribute == row.in_meshes) return row.identifier;
    return attribute == "primvars:st"         ? "st"
           : attribute == "primvars:wet"      ? "wet"
           : attribute == "faceVertexCounts"  ? "face_counts"
           : attribute == "faceVertexIndices" ? "face_corners"
                                              : nullptr;
}

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
        if (const char* key = key_of(array.name)) arrays[key] = as_array(array);
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
        "xy. coverage: (n,); of foam that lives also what of it breaks now and its age [s], (n,), under evaluate()'s names. st: (n, 2), "
        "0 to 1; where the texture has seams one for each of face_corners.\n"
        "face_counts: int32 (f,), corners of each face. face_corners: int32, their points.\n\n"
        "A frame of a camera's grid has its own faces; of other surfaces they and st are in the "
        "topology's file alone. FileError for a file that is missing, cut short, damaged or another "
        "program's; what is returned fits together. Other threads run meanwhile.");
}

}  // namespace pelagic::python
