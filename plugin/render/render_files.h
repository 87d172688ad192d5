// A sequence of pictures in files, DIR/NAME.####.png and .exr for each frame (plugin/render/picture_files.h). Both say of
// themselves what they were made of: plugin/run keeps those that are as they would be made now.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "core/base/build_watch.h"
#include "core/scene/scene.h"
#include "plugin/render/render.h"
#include "plugin/run/run.h"

namespace pelagic {

inline constexpr double kMostStops = 30.0;

// What is asked of the pictures. The scene must be valid.
struct PictureOrder {
    Scene scene;  // its resolution is the pictures'
    RenderOptions options;
    double exposure_stops = 0.0;  // -kMostStops … kMostStops
    // Those of the options that are asked for by name: no budget decides them.
    std::optional<int> samples{};
    std::optional<SkyQuality> sky_quality{};
};

// Turns the scene's budget, if it has one, into settings of the scene and the options. Returns what was chosen, and why, for
// people. Throws as picture_budget(), and std::invalid_argument where nothing holds the budget, which then says that
// `by_name` would do instead of it.
std::string spend_budget(PictureOrder& order, std::size_t max_memory_bytes, const std::string& by_name,
                         const BuildWatch& watch);

// The scene has no budget any more. Throws as run() and check_render(), and NotEnoughMemory before anything is written.
RunReport render_files(const PictureOrder& order, const RunOptions& options);

}  // namespace pelagic
