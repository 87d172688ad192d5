// The sea on the GPU: what evaluate() and shade_sea() compute on the CPU, by the same steps and from the same
// sources, in OpenGL 3.3 core and single precision.
//
// The life of a picture: a worker computes a Frame and packs it; the thread that has the OpenGL context
// uploads what is packed, draws a view of it, and shows the result or reads it back.
#pragma once

#include <array>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/lighting/lighting.h"
#include "core/surface/projected_grid.h"
#include "core/surface/view.h"
#include "core/waves/frame.h"
#include "plugin/render/render.h"

namespace pelagic {

// What the driver lacks or refuses, and what would help; a message for people.
class PreviewError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

class SeaLayout;  // sea_layout.h

// One frame's fields in the layout of the textures. Needs no OpenGL: any thread may fill one, one thread at a
// time; filled again, it allocates nothing.
class PackedFrame {
  public:
    // `query`: index into the sea's plan's queries. Throws std::invalid_argument for one on a lattice or of a
    // single cascade: pictures are of points that lie anywhere, and of the whole sea.
    PackedFrame(std::shared_ptr<const Sea<float>> sea, int query);

    // `frame` must be of the same sea and have a time: std::invalid_argument otherwise.
    void pack(const Frame<float>& frame);

    const std::shared_ptr<const SeaLayout>& layout() const { return layout_; }
    double time_s() const { return time_s_; }
    double time_within_loop_s() const { return time_within_loop_s_; }
    // By texture of the layout: rows of its width, channels side by side.
    const std::vector<std::vector<float>>& planes() const { return planes_; }

  private:
    std::shared_ptr<const SeaLayout> layout_;
    std::vector<std::vector<float>> planes_;
    double time_s_ = 0.0, time_within_loop_s_ = 0.0;
};

// What a picture shows in place of the light.
enum class FalseColour {
    None,
    FilterLevel,     // which rung of the ladder the pixel's waves come from: hues, blended as they are
    HiddenVariance,  // σxx + σyy of what the pixel hides
    Coverage,        // whitecaps
};

struct DrawOptions {
    LightingChoice lighting;
    FalseColour false_colour = FalseColour::None;
    bool wireframe = false;  // the grid's lines over black
    // Each term in a picture of its own, for read_layers(); without, their sum alone: less memory to write.
    bool layers = false;
};

// Milliseconds of the latest frame whose times have come back: some frames old, nobody waits for them.
struct StageTimes {
    double upload_ms = 0.0, sea_ms = 0.0, sky_ms = 0.0, show_ms = 0.0;  // on the GPU
    double submit_ms = 0.0;                                             // draw() itself, on the CPU
};

// Needs its OpenGL context current on the calling thread, in every call and when it is destroyed.
class SeaRenderer {
  public:
    // Throws PreviewError naming what the context lacks (OpenGL 3.3 core, float textures to draw into).
    SeaRenderer();
    ~SeaRenderer();
    SeaRenderer(const SeaRenderer&) = delete;
    SeaRenderer& operator=(const SeaRenderer&) = delete;

    // The driver's own names, for messages and benchmarks.
    std::string device() const;

    void set_sky(const Sky& sky, const WaterBody& water);
    // The next pictures show this frame. A frame of another sea takes that sea over: textures are made anew,
    // shaders only where the number of cascades or footprints changed. Returns before the copy is done.
    // Throws PreviewError when the driver's textures are too small for the sea.
    void upload(const PackedFrame& frame);
    bool has_frame() const;

    // Draws into a picture of its own, view.resolution large. `grid` must be this view's. Nothing uploaded
    // yet: the sky alone. Throws PreviewError when a shader doesn't compile, with the driver's messages.
    void draw(const View& view, const ProjectedGrid& grid, const DrawOptions& options);

    // The last picture, through display_colour() (core/lighting/tone.glsl), into the framebuffer that is
    // bound, filling the current viewport. False colours and wires come as they are.
    void show(float exposure);

    // The last picture as numbers, waiting for it. Needs options.layers for the terms one by one; without,
    // the whole radiance stands in `sea` (and in `sky` where no sea is).
    Picture read_layers() const;

    StageTimes times() const;

  private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

}  // namespace pelagic
