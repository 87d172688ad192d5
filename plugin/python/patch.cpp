// pelagic.patch: the points and quads of the mesh that a bake writes.
#include <pybind11/numpy.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <string>

#include "core/scene/limits.h"
#include "core/surface/patch.h"
#include "plugin/python/bindings.h"

namespace pelagic::python {
namespace {

namespace py = pybind11;

py::tuple patch(double size_m, int resolution) {
    if (!limits::kSurfaceSize_m.holds(size_m))
        throw py::value_error("size_m: is outside the range; accepted: " + text_of(limits::kSurfaceSize_m));
    if (!limits::kSurfaceResolution.holds(resolution))
        throw py::value_error("resolution: is outside the range; accepted: " +
                              text_of(limits::kSurfaceResolution));
    const auto points = rest_points<float>(
        {.per_side = resolution + 1, .spacing_m = size_m / resolution, .first_m = -0.5 * size_m});
    py::array_t<float> rest({static_cast<py::ssize_t>(points.size()), py::ssize_t{2}});
    std::memcpy(rest.mutable_data(), points.data(), points.size() * sizeof points[0]);

    const py::ssize_t n = resolution;
    py::array_t<std::int32_t> quads({n * n, py::ssize_t{4}});
    std::int32_t* corner = quads.mutable_data();
    for (std::int32_t y = 0; y < resolution; ++y)
        for (std::int32_t x = 0; x < resolution; ++x) {
            const std::int32_t below = y * (resolution + 1) + x, above = below + resolution + 1;
            for (const std::int32_t point : std::array{below, below + 1, above + 1, above}) *corner++ = point;
        }
    return py::make_tuple(rest, quads);
}

}  // namespace

void add_patch(py::module_& module) {
    module.def("patch", &patch, py::arg("size_m"), py::arg("resolution"),
               "The square patch, as a bake writes it: (rest, quads).\n\n"
               "size_m: side of the patch, centred on the origin [m]. resolution: quads a side, N.\n"
               "rest: float32 ((N+1)², 2), points at rest [m], x fastest, y rising.\n"
               "quads: int32 (N², 4), each quad's points, counter-clockwise from above.");
}

}  // namespace pelagic::python
