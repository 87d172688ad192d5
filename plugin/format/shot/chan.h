// A camera's path as .chan text, which Nuke, Blender and others write: a line for each frame,
//   frame x y z rx ry rz [fov]
// between spaces or tabs. Metres and degrees in a world whose y is up; a camera that isn't turned looks along −z. It is turned
// about z, then x, then y, as Nuke has it; fov is the vertical angle of view. Empty lines and those that begin with # say nothing.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "pelagic/scene.h"

namespace pelagic {

inline constexpr std::size_t kMostChanBytes = std::size_t{16} << 20;

// What is wrong with it, the line before a colon, and what would be right.
class ChanError : public std::runtime_error {
  public:
    ChanError(std::string problem, std::string accepted)
        : std::runtime_error(problem), accepted_(std::move(accepted)) {}
    const std::string& accepted() const { return accepted_; }

  private:
    std::string accepted_;
};

// The keys of a camera that goes that way, with z up: x stays, y is the file's −z. Their targets are 100 m ahead. The picture's
// proportions turn angles of view into horizontal ones. ChanError, naming the line, for what isn't such a text, for frames that
// don't rise, and for values that camera.keys doesn't accept.
std::vector<CameraKey> parse_chan(std::string_view text, glm::ivec2 resolution);

}  // namespace pelagic
