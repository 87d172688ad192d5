// The paths of waves.vessels as text.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace pelagic {

// A place of a vessel's middle, as waves.vessels[].path says it.
struct CourseKey {
    double frame = 0.0, east_m = 0.0, north_m = 0.0;
};
// "1 0 0, 48 20 5": a frame and a place each. None for a text that isn't one.
std::optional<std::vector<CourseKey>> course_of(std::string_view path);

}  // namespace pelagic
