// A picture of where a calm or rough place holds (WaveMask::picture): data of a scene, as a cage is, wherever it came from.
#pragma once

#include <glm/vec2.hpp>
#include <map>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "pelagic/version.h"

namespace pelagic {
inline namespace PELAGIC_VERSION_NAMESPACE {

// Numbers that are no such picture: what is wrong with them, and what would be right.
class MaskPictureError : public std::runtime_error {
  public:
    MaskPictureError(std::string problem, std::string accepted)
        : std::runtime_error(problem + "; accepted: " + accepted),
          problem_(std::move(problem)),
          accepted_(std::move(accepted)) {}
    const std::string& problem() const { return problem_; }  // "has a value of 2"
    const std::string& accepted() const { return accepted_; }

  private:
    std::string problem_, accepted_;
};

// A picture's means over the cells of a grid that fills it.
struct MaskCells {
    glm::ivec2 count{0};
    std::vector<float> shares;  // columns fastest, rows from the picture's bottom
    float most = 0.0f;          // the largest of them
    glm::ivec2 most_at{0};      // and the first cell that has it
};

// A picture that has passed all checks and never changes: a scene's copies share it.
class MaskPicture {
  public:
    // Shares of the mask that hold, 0 … 1, rows from the top, x fastest. Throws MaskPictureError for a side outside
    // limits::kMaskPicture, another number of values than its texels, and values that aren't 0 … 1.
    MaskPicture(int width, int height, std::vector<float> shares);

    glm::ivec2 size() const { return size_; }
    const std::vector<float>& shares() const { return shares_; }
    // Its size and a hash of its values: "64 x 32 texels, 0123456789abcdef". Equal texts, equal pictures.
    const std::string& content() const { return content_; }

    // At most as many cells a side as texels. Those that were asked for last are kept, and all that somebody holds are shared.
    std::shared_ptr<const MaskCells> cells(glm::ivec2 count) const;

  private:
    glm::ivec2 size_{0};
    std::vector<float> shares_;
    std::string content_;
    mutable std::mutex lock_;
    mutable std::map<std::pair<int, int>, std::weak_ptr<const MaskCells>> made_;
    mutable std::shared_ptr<const MaskCells> last_;
};
}  // namespace PELAGIC_VERSION_NAMESPACE
}  // namespace pelagic
