// The sea of a window: frames computed beside the drawing of the last one, and a changed sea built beside the
// playing of the old one. Whoever draws never waits.
#pragma once

#include <array>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "core/scene/scene.h"
#include "core/surface/projected_grid.h"
#include "core/waves/sea.h"
#include "plugin/preview/live_worker.h"
#include "plugin/preview/sea_renderer.h"

namespace pelagic {

// A sea ready to play, and what drawing it needs to know.
struct LiveBuild {
    Scene scene;  // that it is of
    std::shared_ptr<const Sea<float>> sea;
    int query = 0;  // of the sea's plan: what pictures ask
    ProjectedGridOptions grid;
    double build_s = 0.0;  // how long it took
};

// Plans and builds what pictures of the scene need. Throws std::invalid_argument with every problem of a
// scene that validate() refuses.
std::shared_ptr<const LiveBuild> build_live(const Scene& scene);

// Whether pictures of the two show the same waves, so that nothing needs to be built.
bool same_sea(const Scene& a, const Scene& b);

// One time of one sea, ready for SeaRenderer::upload().
struct LiveFrame {
    std::shared_ptr<const LiveBuild> build;
    std::optional<PackedFrame> packed;
    long number = 0;  // counts finished frames from 1
    double transforms_ms = 0.0, packing_ms = 0.0;
};

struct LiveStatus {
    bool building = false;      // a sea, beside the one that plays
    std::string error;          // of the sea asked for last, or of the frame; empty: all is well
    long seas = 0, frames = 0;  // how many were finished
};

class LiveSea {
  public:
    using Build = LiveWorker<Scene, LiveBuild>::Make;

    // Two threads: one builds, one computes frames. Frames come first where they share the cores.
    explicit LiveSea(Build build = build_live);
    ~LiveSea();  // waits for the frame and the sea that are being made
    LiveSea(const LiveSea&) = delete;
    LiveSea& operator=(const LiveSea&) = delete;

    // None of these waits for a computation; all are for the one thread that draws.

    // The sea from now on: built beside the one that plays, if its waves are others, and put in its place
    // between two frames. While one is being built only the latest of further ones is kept.
    void ask(const Scene& scene);
    // The time [s], finite, that the next frame should show, of the latest sea that is ready; the latest
    // wins. To be called for every picture drawn: a sea that is ready is put in place here.
    void show(double time_s);
    // The latest frame finished; null before the first. Stays as it is until the next call.
    const LiveFrame* newest();
    LiveStatus status() const;

  private:
    void compute_frames();

    // A frame is written into one slot, one waits to be taken, one is being drawn: nobody waits for
    // another's.
    std::array<LiveFrame, 3> slots_;
    std::size_t written_ = 0, waiting_ = 1, shown_ = 2;  // into slots_
    bool fresh_ = false;                                 // slots_[waiting_] is newer than slots_[shown_]

    mutable std::mutex mutex_;
    std::condition_variable wake_;
    std::shared_ptr<const LiveBuild> build_;  // of the next frame
    std::optional<double> time_s_;            // of the next frame
    std::string frame_error_;
    long seas_ = 0, frames_ = 0;
    bool stopping_ = false;
    std::optional<Scene> asked_;  // the drawing thread's own
    std::thread frames_thread_;
    LiveWorker<Scene, LiveBuild> builder_;
};

}  // namespace pelagic
