#include "plugin/host/gpu/packed_frame.h"

#include <stdexcept>
#include <utility>

namespace pelagic {

PackedFrame::PackedFrame(std::shared_ptr<const Sea<float>> sea, int query)
    : layout_(std::make_shared<SeaLayout>(std::move(sea), query)) {}

void PackedFrame::pack(const Frame<float>& frame) {
    if (&frame.sea() != &layout_->sea())
        throw std::invalid_argument("the frame is of another sea than the one that it is packed for");
    if (!frame.is_set()) throw std::invalid_argument("the frame has no time yet: call set() first");
    layout_->fill(frame, planes_);
    wakes_ = layout_->wake_texels(frame);
    time_s_ = frame.time_s();
    time_within_loop_s_ = frame.time_within_loop_s();
}

}  // namespace pelagic
