// Pictures from the GPU without a display.
#pragma once

#include <glm/vec2.hpp>
#include <memory>

#include "core/lighting/lighting.h"
#include "core/scene/scene.h"
#include "plugin/preview/sea_renderer.h"
#include "plugin/render/render.h"

namespace pelagic {

// An OpenGL 3.3 core context without window or display (surfaceless EGL), current on the thread that made it.
// Throws PreviewError saying what is missing.
class OffscreenContext {
  public:
    OffscreenContext();
    ~OffscreenContext();
    OffscreenContext(const OffscreenContext&) = delete;
    OffscreenContext& operator=(const OffscreenContext&) = delete;

  private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

struct OffscreenPicture {
    Picture picture;
    std::string device;  // the driver's name
    std::string note;    // what the scene asks for and the GPU doesn't do; usually empty
};

// The scene at `frame` through its camera, in `size` pixels (0: the camera's resolution), one sample per
// pixel. Needs a current context. The GPU computes in single precision; a note says so if quality.level asks
// for double. Throws std::invalid_argument for a camera under water (plugin/render/under_water.h).
OffscreenPicture render_offscreen(const Scene& scene, const Sky& sky, int frame,
                                  glm::ivec2 size = glm::ivec2(0));

}  // namespace pelagic
