// A budget in the place of settings: quality.max_error or quality.frame_ms. The host that reads a scene resolves it once
// (plugin/budget), or leaves it out where it asks for points of its own; nothing that is planned has one.
#pragma once

#include "pelagic/scene.h"

namespace pelagic {

inline bool has_budget(const Quality& quality) {
    return quality.max_error || quality.frame_ms;
}

inline Scene without_budget(Scene scene) {
    scene.quality.max_error.reset();
    scene.quality.frame_ms.reset();
    return scene;
}

}  // namespace pelagic
