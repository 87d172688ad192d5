// The preview's window: plays a shot in real time, with controls for everything that an artist may change.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <glm/vec2.hpp>
#include <optional>

#include "pelagic/scene.h"
#include "plugin/host/preview/sea_renderer.h"

namespace pelagic {

struct WindowOptions {
    std::filesystem::path folder = ".";  // where F12 saves pictures
    // Writes a scene into the file of the shot that the window was opened with; what it throws is shown. Empty: it can't.
    std::function<void(const Scene& scene, const Scene& shot)> save{};
    glm::ivec2 size{0};  // of the window; 0: the camera's resolution, limited by the screen
    // 1, 2 or 4: a drawn pixel covers pixel_size² of the window's. 0: 1, or 2 where the driver is software.
    int pixel_size = 0;
    std::optional<int> frame{};  // starts paused at this frame; otherwise plays from the first
    // What the sea may hold; 0: what the system gives this process. A sea that needs more is drawn with less detail.
    std::size_t max_memory_bytes = 0;
    // For tests of the window: saves it, panel included, after this many pictures with the sea, tells how fast they
    // came, and closes it.
    std::optional<std::filesystem::path> screenshot{};
    int screenshot_after = 8;
};

// Opens the window and returns when it is closed. The scene must be valid. Must be called on the program's
// first thread (GLFW's rule), for one window at a time. Throws PreviewError if there is no display or its
// OpenGL lacks something, and if a screenshot is asked for but the sea can't be shown or the window is closed
// too early; FileError if the screenshot can't be written; and what make_sky() throws.
void run_window(const Scene& scene, const WindowOptions& options);

}  // namespace pelagic
