// One sea, frame after frame, turned into the bytes of files, in three steps that different frames may take
// at the same time. A frame's memory is its slot, which is used again for others; the sea's buffers are
// allocated once.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "core/waves/sea.h"
#include "plugin/bake/output_part.h"
#include "plugin/bake/record.h"

namespace pelagic {

// What one frame needs between its steps.
struct FrameSlot {
    int frame = 0;
    FrameRecord record;  // the sizes of its files are filled in when they are written
    std::vector<std::unique_ptr<OutputSlot>> outputs;  // by part
    std::vector<bool> wanted;                          // by part; empty: all
};

class Sequence {
  public:
    virtual ~Sequence() = default;
    // The frame's values, of the parts that the slot wants. One frame at a time. Throws BuildCancelled: a frame alone goes
    // through its foam's past. `foam_past`: called with the share of that, 0 … 1, rising, where it is long; may be empty.
    virtual void compute(int frame, FrameSlot& slot,
                         const std::function<void(double done)>& foam_past = {}) = 0;
    // Their bytes. Different slots side by side, also while another frame is computed.
    virtual void encode(FrameSlot& slot) const = 0;
    // Hands each wanted file of the frame to `sink`; what that throws passes through. As encode().
    virtual void write(FrameSlot& slot, const FileSink& sink) const = 0;
    // The files that belong to no frame: the stage, whose volumes are those of the frames that are named, topology, manifest.
    // None without a mesh.
    virtual void write_static(std::span<const int> volume_frames, const FileSink& sink) const = 0;
    virtual const SpectralMoments& total() const = 0;
    virtual double whitecap_threshold() const = 0;
    virtual double residual_coverage() const = 0;  // of the sea, over all of it; 0 where foam doesn't live
    virtual long executed_transforms() const = 0;
};

// In the plan's precision. The plan must be one of a bake (plan_bake), and is copied.
// Throws BuildCancelled. What `watch` has to cancel outlives it: frames look at it too.
std::unique_ptr<Sequence> make_sequence(const Plan& plan, const BuildWatch& watch = {});

// What the statistics of a frame's record were made of: they are those of the first output.
std::string statistics_fingerprint(const std::vector<std::unique_ptr<OutputPart>>& parts, int frame);

}  // namespace pelagic
