// What pictures are asked for in Python, as arrays and as files.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "plugin/budget/budget.h"
#include "plugin/render/render_files.h"

namespace pelagic::python {

using PictureSize = std::optional<std::array<int, 2>>;
using PictureSides = std::array<int, 2>;                  // RenderOptions::overscan_px
using PictureRegion = std::optional<std::array<int, 4>>;  // its low corner, and its high one

struct PictureRequest : PictureOrder {
    FixedSettings fixed;
};

// Of a copy of the scene; `layers` beside the light's. Throws ShotError, pybind11::value_error and std::invalid_argument for
// what no picture can have.
PictureRequest picture_request(const Scene& scene, const PictureSize& size, std::optional<int> samples,
                               const std::optional<std::string>& sky_quality,
                               const std::vector<std::string>& layers, double shutter, bool alpha,
                               const PictureSides& overscan, const PictureRegion& region,
                               double exposure = 0.0);

// How what a budget would decide is asked for by name.
inline constexpr const char* kByName = "samples and sky_quality";

}  // namespace pelagic::python
