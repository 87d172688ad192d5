// What one run is: its parts, and how their files are made. run() does the rest.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/base/build_watch.h"
#include "plugin/run/part.h"
#include "plugin/run/record.h"
#include "plugin/run/run.h"

namespace pelagic {

// What one frame needs between its steps. Slots are used again for other frames.
struct RunSlot {
    virtual ~RunSlot() = default;
    bool wants(std::size_t part) const { return wanted.empty() || wanted[part]; }

    int frame = 0;
    std::vector<bool> wanted;  // by part; empty: all
    FrameRecord record;  // of a run with one; the sizes of its files are filled in when they are written
};

// Turns frames into the bytes of files, in three steps that different frames may take at the same time.
class Sequence {
  public:
    virtual ~Sequence() = default;
    virtual std::unique_ptr<RunSlot> make_slot() const = 0;
    // The frame's values, of the parts that the slot wants. One frame at a time. Throws BuildCancelled. `progress`: called
    // with the share that is done (RunProgress), rising; may be empty.
    virtual void compute(int frame, RunSlot& slot, const std::function<void(double done)>& progress = {}) = 0;
    // Their bytes. Different slots side by side, also while another frame is computed.
    virtual void encode(RunSlot& slot) const = 0;
    // Hands each wanted file of the frame to `sink`; what that throws passes through. As encode().
    virtual void write(RunSlot& slot, const FileSink& sink) const = 0;
    // The files that belong to no frame, which name these frames.
    virtual void write_static(std::span<const int>, const FileSink&) const {}
    // Of a run with a record: what it says of the shot.
    virtual void describe(Record&) const {}
    virtual long executed_transforms() const { return 0; }
};

struct RunWork {
    Shot shot;
    // Whether a record says which files are whole, DIR/NAME.json, or each file itself (plugin/run/seals.h).
    bool has_record = false;
    int in_flight = 1;  // frames
    // Refuses what can't be made of these frames, and names the parts. The statistics of a frame's record are of the first.
    std::function<std::vector<RunPart>(std::span<const int> frames)> plan;
    // Gets ready to make the frames that aren't whole, and the folders. Throws BuildCancelled. What the watch has to cancel
    // outlives what is made.
    std::function<std::unique_ptr<Sequence>(std::span<const int> frames,
                                            const std::function<BuildWatch(RunStage)>& watch)>
        build;
};

// Makes the folders that the parts' files lie in, or throws files::FileError; what killed runs have left unfinished goes.
void prepare_folders(const std::filesystem::path& out, std::span<const RunPart> parts);

}  // namespace pelagic
