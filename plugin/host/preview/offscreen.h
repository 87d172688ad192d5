// Pictures from the GPU without a display.
#pragma once

#include <cstddef>
#include <glm/vec2.hpp>
#include <memory>
#include <string>

#include "core/lighting/lighting.h"
#include "core/plan/memory.h"
#include "core/plan/plan.h"
#include "core/waves/sea.h"
#include "pelagic/scene.h"
#include "plugin/host/preview/sea_renderer.h"
#include "plugin/render/drawn_sea.h"
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

// What a picture needs, known before the sea is built: its mesh, and a sea whose levels are as fine as the pixels
// that show it. Frames and pictures of other plans give the same picture.
struct OffscreenPlan {
    Scene scene;  // its resolution is the picture's
    int frame = 1;
    Plan plan;
    SeaMesh mesh;
    std::shared_ptr<const DrawnSea> drawn;  // which that is of
};

// The scene at `frame` through its camera, in `size` pixels (0: the camera's resolution). Needs a current context.
// Throws PreviewError for a picture that is larger than the driver's largest, and NotEnoughMemory for one that needs
// more than max_memory_bytes (0: what the system gives this process).
OffscreenPlan plan_offscreen(const Scene& scene, int frame, glm::ivec2 size = glm::ivec2(0),
                             std::size_t max_memory_bytes = 0);

// What drawing it holds at most: with a driver in software that is all memory of this process.
MemoryNeed offscreen_memory(const OffscreenPlan& planned, int threads);

// Progress of building the sea, and of going through its foam's past where that is long.
struct OffscreenWatch {
    BuildWatch sea{}, foam_past{};
};

// One sample per pixel. Needs a current context. The GPU computes in single precision; a note says so if
// quality.level asks for double. Throws std::invalid_argument for a camera under water
// where that can't be drawn (plugin/render/under_water.h), and BuildCancelled.
OffscreenPicture render_offscreen(const OffscreenPlan& planned, const Sky& sky,
                                  const OffscreenWatch& watch = {});

}  // namespace pelagic
