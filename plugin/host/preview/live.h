// The sea of a window. Frames are computed while the last one is drawn, and a changed sea is built while the
// old one plays. The drawing thread never waits.
#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "core/effects/spray_drops.h"
#include "core/lighting/floor.h"
#include "core/lighting/spray.h"
#include "core/plan/memory.h"
#include "core/surface/view.h"
#include "core/waves/sea.h"
#include "pelagic/scene.h"
#include "plugin/host/gpu/live_worker.h"
#include "plugin/host/preview/sea_renderer.h"
#include "plugin/render/floor_light.h"

namespace pelagic {

// A sea that is ready to play, and what is needed to draw it.
struct LiveBuild {
    Scene scene;  // the scene it was made from
    std::shared_ptr<const SeaOverTime<float>> sea;
    int query = 0;  // the picture's query, an index into the plan
    std::shared_ptr<const DrawnSea> drawn;
    double build_s = 0.0;  // time that building took
    std::string note;  // what was left out so that it fits, and sea_warnings(), a line each; empty: nothing
};

// What a window's sea may hold, and its textures' sides.
struct LiveLimits {
    MemoryLimit memory{std::numeric_limits<std::size_t>::max(), "there are"};
    int texture = std::numeric_limits<int>::max();
};

// Plans and builds the sea for pictures of the scene. Where that exceeds the limits, the shortest waves become mere
// slope variance until it fits, and the note says so. Throws std::invalid_argument with every problem that
// problems_of() finds, and NotEnoughMemory where nothing can be left out any more.
std::shared_ptr<const LiveBuild> build_live(const Scene& scene, const LiveLimits& limits,
                                            const BuildWatch& watch = {});

// Whether the two scenes have the same waves in pictures, so that nothing needs to be built.
bool same_sea(const Scene& a, const Scene& b);

// A sea at one time, ready for SeaRenderer::upload().
struct LiveFrame {
    std::shared_ptr<const LiveBuild> build;
    std::optional<PackedFrame> packed;
    long number = 0;  // of the finished frame, from 1
    double transforms_ms = 0.0, packing_ms = 0.0;
};

// Large drops of the spray round a camera, at one time.
struct LiveDrops {
    std::shared_ptr<const LiveBuild> build;
    double time_s = 0.0;
    std::vector<SprayDrop> drops;
};

struct LiveStatus {
    bool building = false;      // a sea is being built
    double built = 0.0;         // how much of it, 0 … 1, where that is known
    std::string error;          // of the latest sea, frame or drops; empty if it succeeded
    long seas = 0, frames = 0;  // numbers finished
};

class LiveSea {
  public:
    using Build = LiveWorker<Scene, LiveBuild>::Make;

    // Two threads: one builds seas, one computes frames. Frames have priority on the cores. A third computes the drops of the
    // spray, once there are some.
    explicit LiveSea(Build build);
    explicit LiveSea(const LiveLimits& limits = {});
    ~LiveSea();  // waits for the frame and the sea being made
    LiveSea(const LiveSea&) = delete;
    LiveSea& operator=(const LiveSea&) = delete;

    // None of these waits for a computation. Only the drawing thread may call them.

    // Requests the sea of this scene. If its waves differ it is built in the background and replaces the
    // current sea between two frames. During a build only the latest request is kept.
    void ask(const Scene& scene);
    // Requests a frame at this time [s], finite, of the latest sea that is ready; the latest request wins.
    // Must be called for every picture drawn: this call swaps in a sea that is ready. `eye`: a camera among the waves
    // (is_among_waves()), for water_over_eye(). `spray_from`: a camera for newest_spray() and newest_drops(). `floor`: for newest_floor(),
    // without its footprints.
    struct FloorWanted {
        std::shared_ptr<const Floor> floor;
        FloorLightWanted light;
        bool operator==(const FloorWanted&) const = default;
    };
    // `objects_at`: the frame, of a scene with objects, for newest_objects().
    void show(double time_s, const std::optional<View>& eye = {}, const std::optional<View>& spray_from = {},
              const std::optional<FloorWanted>& floor = {}, std::optional<double> objects_at = {});
    // The latest finished frame; null before the first. Unchanged until the next call.
    const LiveFrame* newest();
    // The height z [m] of the surface above the eye, in the latest frame computed; nullopt for one in the air.
    std::optional<double> water_over_eye() const;
    // The spray before the latest camera that was asked for, not lit yet; null before the first. It has fewer texels
    // than that of a single picture.
    std::shared_ptr<const Spray> newest_spray() const;
    // Its drops that are seen one by one, of the latest request that is done: of some earlier time, and elsewhere, where the
    // camera moves far. Null before the first, and where that camera sees none.
    std::shared_ptr<const LiveDrops> newest_drops();
    // The floor that was asked for, lit through the latest frame computed; null before the first.
    std::shared_ptr<const Floor> newest_floor() const;
    // The sea's objects where they are in the latest frame computed; null before the first.
    std::shared_ptr<const std::vector<DrawnObject>> newest_objects() const;
    LiveStatus status() const;

  private:
    LiveSea(const LiveLimits& limits, const std::shared_ptr<std::atomic<double>>& built);
    void compute_frames();
    void ask_drops(const std::shared_ptr<const LiveBuild>& build, double time_s, const View& view);

    // Triple buffering: one slot is being written, one waits, one is being drawn.
    std::array<LiveFrame, 3> slots_;
    std::size_t written_ = 0, waiting_ = 1, shown_ = 2;  // into slots_
    bool fresh_ = false;                                 // slots_[waiting_] is newer than slots_[shown_]

    mutable std::mutex mutex_;
    std::condition_variable wake_;
    std::shared_ptr<const LiveBuild> build_;  // for the next frame
    std::optional<double> time_s_;            // for the next frame
    std::optional<View> eye_, spray_from_;
    std::optional<double> water_over_eye_m_;
    std::shared_ptr<const Spray> spray_;
    std::optional<FloorWanted> floor_wanted_;
    std::shared_ptr<const Floor> floor_;
    std::optional<double> objects_at_;
    std::shared_ptr<const std::vector<DrawnObject>> objects_;
    std::string frame_error_;
    long seas_ = 0, frames_ = 0;
    bool stopping_ = false;
    std::optional<Scene> asked_;                        // used by the drawing thread only
    std::shared_ptr<const std::atomic<double>> built_;  // null where nobody tells
    struct DropsAsked {
        std::shared_ptr<const LiveBuild> build;  // null: forgets what it has
        double time_s = 0.0;
        glm::dvec2 middle_m{0.0};
        bool operator==(const DropsAsked&) const = default;
    };
    // Used by the drawing thread only.
    std::optional<DropsAsked> drops_asked_;  // none: the camera sees none
    std::shared_ptr<const LiveDrops> drops_;
    std::optional<LiveWorker<DropsAsked, LiveDrops>> drops_worker_;
    std::thread frames_thread_;
    LiveWorker<Scene, LiveBuild> builder_;
};

}  // namespace pelagic
