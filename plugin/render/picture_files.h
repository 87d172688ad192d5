// Pictures as the bytes of files: HDR with its layers, and as a screen shows it.
#pragma once

#include <string>

#include "core/scene/scene.h"
#include "plugin/render/render.h"

namespace pelagic {

// NAME.0012.exr: of the shot's name and a frame.
std::string picture_file(const Shot& shot, int frame, const char* extension);

struct PictureContext {
    const Scene& scene;
    const RenderOptions& options;
    const Sky& sky;
    std::string fingerprint;  // Plan::fingerprint_text() of the sea
    double exposure_stops = 0.0;
};

// EXR: scan lines; R, G, B and the layers sun.R … foam.B, in the sky's units; halves where no value that the
// light can give is beyond their range, floats for the others; what it was made of in the header. The layers
// add up to R, G, B.
// PNG: display_colour() of the whole, at the light's own exposure and so many stops more.
std::string encode_exr(const PictureContext& context, const Picture& picture, int frame);
std::string encode_png(const PictureContext& context, const Picture& picture);

}  // namespace pelagic
