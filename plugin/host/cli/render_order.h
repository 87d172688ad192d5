// The options of `pelagic render`, which `pelagic farm` takes as well.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "plugin/budget/budget.h"
#include "plugin/host/cli/guarded_run.h"
#include "plugin/render/render_files.h"

namespace pelagic::cli {

struct RenderArguments : RunArguments {
    std::optional<std::string> terms, sky_quality, layers;
    std::optional<int> samples;
    double exposure_stops = 0.0, shutter_frames = 0.0;
    bool alpha = false, deep = false;
    std::optional<std::string> overscan, region;
    std::string size, ocio, display, view, space, primaries = "rec709";
};

// Those that say what the pictures are; those of every run are add_run_options().
void add_picture_options(CLI::App& command, RenderArguments& arguments);

// Throws WrongUsage, ShotError. fixed: what the options leave to no budget.
PictureOrder order_of(const RenderArguments& arguments, FixedSettings& fixed);

}  // namespace pelagic::cli
