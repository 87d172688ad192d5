// One frame's fields in the layout of the textures. Needs no OpenGL.
#pragma once

#include <memory>
#include <vector>

#include "plugin/host/gpu/sea_layout.h"

namespace pelagic {

// Any thread may fill it, one at a time. Filling it again allocates nothing.
class PackedFrame {
  public:
    // `query`: index into the queries of the sea's plan. Throws std::invalid_argument for a query on a
    // lattice or of a single cascade: a picture needs arbitrary points and the whole sea.
    PackedFrame(std::shared_ptr<const Sea<float>> sea, int query);

    // Throws std::invalid_argument unless `frame` is of the same sea and has a time.
    void pack(const Frame<float>& frame);

    const std::shared_ptr<const SeaLayout>& layout() const { return layout_; }
    double time_s() const { return time_s_; }
    double time_within_loop_s() const { return time_within_loop_s_; }
    // By texture of the layout: rows of its width, channels interleaved.
    const std::vector<std::vector<float>>& planes() const { return planes_; }
    // The texture wake_table, as the layout has it; empty without vessels.
    const std::vector<glm::vec4>& wakes() const { return wakes_; }

  private:
    std::shared_ptr<const SeaLayout> layout_;
    std::vector<std::vector<float>> planes_;
    std::vector<glm::vec4> wakes_;
    double time_s_ = 0.0, time_within_loop_s_ = 0.0;
};

}  // namespace pelagic
