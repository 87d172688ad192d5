// The preview's window: plays a shot in real time, with everything that an artist turns beside it.
#pragma once

#include <filesystem>
#include <glm/vec2.hpp>
#include <optional>

#include "core/scene/scene.h"
#include "plugin/preview/sea_renderer.h"

namespace pelagic {

struct WindowOptions {
    std::filesystem::path folder = ".";  // where F12 leaves its pictures
    glm::ivec2 size{0};          // of the window; 0: the camera's, or what of it the screen has room for
    int pixel_size = 1;          // 1, 2, 4: a drawn pixel covers this many of the window's, squared
    std::optional<int> frame{};  // begins there, paused; otherwise it plays from the first
    // For trying the window without a hand: saves it, panel included, once so many pictures with the sea
    // were drawn, and closes.
    std::optional<std::filesystem::path> screenshot{};
    int screenshot_after = 8;
};

// Opens the window and returns when it is closed. The scene must be valid. On the calling thread, which must
// be the program's first (GLFW's rule); one window at a time. Throws PreviewError where there is no display
// or its OpenGL lacks something, saying what, and where a screenshot is asked for and the sea can't be shown
// or the window is closed too early; FileError when the screenshot can't be written; and what make_sky()
// throws.
void run_window(const Scene& scene, const WindowOptions& options);

}  // namespace pelagic
