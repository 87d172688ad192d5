// A sequence of pictures in files, DIR/NAME.####.png and .exr for each frame (plugin/render/picture_files.h). Both say of
// themselves what they were made of: plugin/run keeps those that are as they would be made now.
#pragma once

#include "pelagic/scene.h"
#include "plugin/render/picture_files.h"
#include "plugin/render/render.h"
#include "plugin/run/run.h"

namespace pelagic {

inline constexpr double kMostStops = 30.0;

// What is asked of the pictures. The scene must be valid.
struct PictureOrder {
    Scene scene;  // its resolution is the pictures'
    RenderOptions options;
    double exposure_stops = 0.0;  // -kMostStops … kMostStops
    PictureColours colours{};
};

// Of what they are made.
PictureFingerprint picture_fingerprint(const PictureOrder& order);

// Throws as run() and check_render(), and NotEnoughMemory before anything is written.
RunReport render_files(const PictureOrder& order, const RunOptions& options);

}  // namespace pelagic
