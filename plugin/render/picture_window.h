// Which pixels of a picture are computed: the display window's, more round them (overscan), or some of either (a region).
#pragma once

#include <glm/common.hpp>
#include <glm/vec2.hpp>

#include "core/surface/view.h"

namespace pelagic {

// Pixels from the display window's upper left corner, x to the right and y down, as OpenEXR counts them: those from `low` on, before
// `high`.
struct PixelWindow {
    glm::ivec2 low{0}, high{0};

    glm::ivec2 size() const { return high - low; }
    bool is_empty() const { return high.x <= low.x || high.y <= low.y; }
    bool operator==(const PixelWindow&) const = default;
};

inline PixelWindow intersection(const PixelWindow& a, const PixelWindow& b) {
    return {glm::max(a.low, b.low), glm::min(a.high, b.high)};
}

// What the same camera sees in a picture that is larger by so many pixels at the left and the right, and above and below.
inline View with_overscan(View view, glm::ivec2 by) {
    if (by == glm::ivec2(0)) return view;
    const double width = view.resolution.x;
    view.resolution += 2 * by;
    const double wider = view.resolution.x / width;
    view.tan_half_width *= wider;
    view.shift /= wider;
    return view;
}

}  // namespace pelagic
