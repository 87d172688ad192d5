// The sea on the GPU: evaluate() and shade_sea() in OpenGL 3.3 core and single precision, by the same steps
// and from the same sources as on the CPU.
//
// For a picture, a worker computes a Frame and packs it. The thread with the OpenGL context uploads the
// packed frame, draws a view of it, and shows the result or reads it back.
#pragma once

#include <array>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/effects/spray_drops.h"
#include "core/lighting/floor.h"
#include "core/lighting/lighting.h"
#include "core/lighting/object.h"
#include "core/lighting/spray.h"
#include "core/surface/view.h"
#include "plugin/host/gpu/draw_options.h"
#include "plugin/host/gpu/packed_foam.h"
#include "plugin/host/gpu/packed_frame.h"
#include "plugin/render/drawn_sea.h"
#include "plugin/render/render.h"

namespace pelagic {

// Something that the driver lacks or refuses, and a remedy; what() is a message for users.
class PreviewError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

struct DrawnObject;

// Milliseconds of the latest frame whose timer queries have finished: a few frames old, because nothing waits
// for them.
struct StageTimes {
    double upload_ms = 0.0, sea_ms = 0.0, sky_ms = 0.0, show_ms = 0.0;  // on the GPU; drops are the sky's
    double submit_ms = 0.0;                                             // of draw() on the CPU
};

// The OpenGL context must be current on the calling thread for every call and for destruction.
class SeaRenderer {
  public:
    // Throws PreviewError naming what the context lacks: OpenGL 3.3 core, or float textures as render
    // targets.
    SeaRenderer();
    ~SeaRenderer();
    SeaRenderer(const SeaRenderer&) = delete;
    SeaRenderer& operator=(const SeaRenderer&) = delete;

    int largest_texture() const;  // the driver's, texels a side

    // The driver's name for the device, for messages and benchmarks.
    std::string device() const;
    // Whether that is a processor rather than a graphics card.
    bool is_software() const;

    void set_sky(const Sky& sky, const WaterBody& water);
    // Under the same sky, as when the sea is another one.
    void set_water(const WaterBody& water);
    // The floor below the sea, with its light at the frame's time; null: level and evenly lit.
    void set_floor(std::shared_ptr<const Floor> floor);
    // What the next pictures have between their eye and the sea; none before the first call. drops: those that are seen one
    // by one, which the map lacks, as they were so long ago.
    void set_spray(const Spray& spray, std::shared_ptr<const std::vector<SprayDrop>> drops = {},
                   double late_s = 0.0);
    // The objects of the next pictures, and the light round them; none before the first call.
    void set_objects(std::vector<DrawnObject> objects, const ObjectSurroundings& surroundings);
    // Sets the frame of the next pictures. A frame of another sea replaces that sea: textures are made again,
    // shaders only if the number of cascades or footprints changed. Returns before the copy is done. Throws
    // PreviewError if the driver's textures are too small for the sea.
    void upload(const PackedFrame& frame);
    // The same for a single picture: takes the frame apart as it is copied, so that nothing is in memory twice.
    // `query`: as PackedFrame's.
    void upload_once(Frame<float>&& frame, int query);
    bool has_frame() const;
    // What earlier breaking has left in the uploaded sea, whose foam must be persistent. Before the first call there
    // is none.
    void upload_foam(std::shared_ptr<const PackedFoam> foam);
    // The points at rest that a picture's pixels of the sea show, with their footprints. Waits for the GPU.
    struct ShownPoints {
        std::vector<glm::vec2> rest_m;  // relative to the mesh's origin
        std::vector<float> pixel_m;
        std::vector<glm::vec2> pixel_axis_m;
    };
    ShownPoints shown_points(const View& view, const SeaMesh& mesh);

    // Draws a picture of view.resolution into the renderer's own framebuffer. `mesh` must be this view's.
    // Without an uploaded frame only the sky is drawn. Throws PreviewError with the driver's messages if a
    // shader doesn't compile.
    void draw(const View& view, const SeaMesh& mesh, const DrawOptions& options);

    // Shows the last picture in the bound framebuffer, filling the viewport, through display_colour()
    // (core/lighting/tone.glsl). False colours and wireframes are shown unchanged.
    void show(float exposure, const glm::mat3& white_balance);

    // Reads the last picture back, and waits for it. The terms are separate with options.layers. Otherwise
    // `sea` has the whole radiance (and `sky` has it where there is no sea). Of pictures with objects their light is the layer Object;
    // what the sea mirrors of them is in `sky`, and Reflection is 0.
    Picture read_layers() const;

    StageTimes times() const;

  private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

}  // namespace pelagic
