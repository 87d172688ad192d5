// Layers of meshes, crates and text: arrays that fit together, or a refusal.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "plugin/format/usd/read_mesh.h"
#include "tests/fuzz/fuzz.h"

using namespace pelagic;
using fuzz::hold;

namespace {

template <class T>
std::span<const T> values_of(const usd::MeshLayer& layer, std::string_view name) {
    for (const usd::MeshArray& array : layer.arrays)
        if (array.name == name) {
            hold(std::holds_alternative<std::vector<T>>(array.values), "an array has its type", array.name);
            return std::get<std::vector<T>>(array.values);
        }
    return {};
}

void expect_whole(const usd::MeshLayer& layer) {
    if (layer.frame) hold(std::isfinite(*layer.frame), "a frame is a number");
    if (layer.origin_m)
        for (int axis = 0; axis < 3; ++axis)
            hold(std::isfinite((*layer.origin_m)[axis]), "an origin is finite");
    for (const usd::MeshArray& array : layer.arrays) {
        hold(array.components >= 1 && array.components <= 3, "components", array.name);
        if (const auto* floats = std::get_if<std::vector<float>>(&array.values)) {
            hold(floats->size() % static_cast<std::size_t>(array.components) == 0, "whole vectors",
                 array.name);
            hold(
                std::all_of(floats->begin(), floats->end(), [](float value) { return std::isfinite(value); }),
                "values are finite", array.name);
        }
    }
    const std::size_t points = values_of<float>(layer, "points").size() / 3;
    if (layer.frame)
        for (const usd::MeshArray& array : layer.arrays)
            for (const std::string_view varying :
                 {"normals", "velocities", "primvars:slopeVariance", "primvars:whitecapCoverage",
                  "primvars:foamActive", "primvars:foamAge", "primvars:wet"})
                if (array.name == varying)
                    hold(values_of<float>(layer, array.name).size() ==
                             points * static_cast<std::size_t>(array.components),
                         "arrays are as long as the points", array.name);
    const auto counts = values_of<std::int32_t>(layer, "faceVertexCounts"),
               indices = values_of<std::int32_t>(layer, "faceVertexIndices");
    std::size_t corners = 0;
    for (const std::int32_t count : counts) {
        hold(count >= 3, "faces have three corners or more");
        corners += static_cast<std::size_t>(count);
    }
    hold(corners == indices.size(), "as many indices as corners");
    for (const std::int32_t index : indices)
        hold(index >= 0 && (!layer.frame || static_cast<std::size_t>(index) < points), "corners are points");
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    try {
        expect_whole(usd::read_mesh_layer({reinterpret_cast<const char*>(data), size}));
    } catch (const usd::ReadError& error) {
        hold(error.what()[0] != '\0', "a refusal says why");
    }
    return 0;
}
