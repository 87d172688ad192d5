// Computes frames and builds seas in the background. See live.h.
#include "plugin/host/preview/live.h"

#include <oneapi/tbb/task_arena.h>

#include <chrono>
#include <utility>

#include "core/waves/frame.h"
#include "plugin/host/preview/drawn_objects.h"
#include "plugin/render/seen_drops.h"
#include "plugin/render/spray_map.h"
#include "plugin/render/under_water.h"

namespace pelagic {
namespace {

using Clock = std::chrono::steady_clock;

constexpr SprayMapSize kSprayMap{.columns = 84, .rows = 128};

double milliseconds(Clock::time_point from, Clock::time_point to) {
    return std::chrono::duration<double, std::milli>(to - from).count();
}

// Runs it at lower priority than the frames' parallel loops.
template <class Make>
auto in_the_background(Make make) {
    return [make = std::move(make)](const auto& asked) mutable {
        tbb::task_arena arena(tbb::task_arena::automatic, 1, tbb::task_arena::priority::low);
        return arena.execute([&] { return make(asked); });
    };
}

}  // namespace

LiveSea::LiveSea(Build build)
    : frames_thread_([this] { compute_frames(); }), builder_(in_the_background(std::move(build))) {}

LiveSea::LiveSea(const LiveLimits& limits) : LiveSea(limits, std::make_shared<std::atomic<double>>(0.0)) {}

LiveSea::LiveSea(const LiveLimits& limits, const std::shared_ptr<std::atomic<double>>& built)
    : LiveSea([limits, built](const Scene& scene) {
          *built = 0.0;
          return build_live(scene, limits, {.progress = [built](double done) { *built = done; }});
      }) {
    built_ = built;
}

LiveSea::~LiveSea() {
    {
        const std::lock_guard lock(mutex_);
        stopping_ = true;
    }
    wake_.notify_one();
    frames_thread_.join();
}

void LiveSea::ask(const Scene& scene) {
    if (asked_ && same_sea(*asked_, scene)) return;
    asked_ = scene;
    builder_.ask(scene);
}

void LiveSea::show(double time_s, const std::optional<View>& eye, const std::optional<View>& spray_from,
                   const std::optional<FloorWanted>& floor, std::optional<double> objects_at) {
    auto built = builder_.take();
    std::shared_ptr<const LiveBuild> build;
    {
        const std::lock_guard lock(mutex_);
        time_s_ = time_s;
        eye_ = eye;
        if (!eye) water_over_eye_m_.reset();
        spray_from_ = spray_from;
        if (!spray_from) spray_.reset();
        floor_wanted_ = floor;
        if (!floor) floor_.reset();
        objects_at_ = objects_at;
        if (!objects_at) objects_.reset();
        if (built) {
            build_.swap(built);
            ++seas_;
        }
        build = build_;
    }
    wake_.notify_one();
    if (build && spray_from && are_drops_near(build->scene, *spray_from)) {
        ask_drops(build, time_s, *spray_from);
    } else if (drops_worker_) {
        drops_.reset();
        drops_worker_->take();  // one that came too late
        if (std::exchange(drops_asked_, std::nullopt)) drops_worker_->ask({});
    }
}

void LiveSea::ask_drops(const std::shared_ptr<const LiveBuild>& build, double time_s, const View& view) {
    DropsAsked asked{.build = build, .time_s = time_s, .middle_m = glm::dvec2(view.position_m)};
    if (drops_asked_ == asked) return;
    // A square of the sea elsewhere takes as long as many frames: not on their thread.
    struct Flying {
        std::shared_ptr<const LiveBuild> of;
        std::optional<SprayDrops<float>> drops;
    };
    if (!drops_worker_)
        drops_worker_.emplace(
            in_the_background([flying = std::make_shared<Flying>()](
                                  const DropsAsked& wanted) -> std::shared_ptr<const LiveDrops> {
                if (flying->of != wanted.build) flying->drops.reset();  // before new ones are made
                flying->of = wanted.build;
                if (!wanted.build) return nullptr;
                if (!flying->drops) flying->drops.emplace(*wanted.build->sea->first(), kDropsSquare_m);
                auto made = std::make_shared<LiveDrops>();
                made->build = wanted.build;
                made->time_s = wanted.time_s;
                flying->drops->at(wanted.time_s, wanted.middle_m, made->drops);
                return made;
            }));
    drops_worker_->ask(asked);
    drops_asked_ = std::move(asked);
}

const LiveFrame* LiveSea::newest() {
    const std::lock_guard lock(mutex_);
    if (fresh_) std::swap(waiting_, shown_);
    fresh_ = false;
    const LiveFrame& frame = slots_[shown_];
    return frame.packed ? &frame : nullptr;
}

std::optional<double> LiveSea::water_over_eye() const {
    const std::lock_guard lock(mutex_);
    return water_over_eye_m_;
}

std::shared_ptr<const Spray> LiveSea::newest_spray() const {
    const std::lock_guard lock(mutex_);
    return spray_;
}

std::shared_ptr<const Floor> LiveSea::newest_floor() const {
    const std::lock_guard lock(mutex_);
    return floor_;
}

std::shared_ptr<const LiveDrops> LiveSea::newest_drops() {
    if (!drops_asked_) return nullptr;
    if (auto made = drops_worker_->take()) drops_ = std::move(made);
    return drops_;
}

std::shared_ptr<const std::vector<DrawnObject>> LiveSea::newest_objects() const {
    const std::lock_guard lock(mutex_);
    return objects_;
}

LiveStatus LiveSea::status() const {
    LiveStatus status{
        .building = builder_.is_busy(), .built = built_ ? built_->load() : 0.0, .error = builder_.error()};
    const std::lock_guard lock(mutex_);
    if (status.error.empty()) status.error = frame_error_;
    if (status.error.empty() && drops_asked_) status.error = drops_worker_->error();
    status.seas = seas_;
    status.frames = frames_;
    return status;
}

void LiveSea::compute_frames() {
    std::optional<Frame<float>> frame;
    std::shared_ptr<const LiveBuild> frame_of;
    // The request computed last, whether it succeeded or failed: not repeated.
    std::shared_ptr<const LiveBuild> tried;
    std::optional<double> tried_s;
    std::optional<View> tried_eye, tried_spray;
    std::optional<FloorWanted> tried_floor;
    std::optional<double> tried_objects;
    const auto spray_before = [&](const View& view) {
        return std::make_shared<const Spray>(make_spray_map(*frame, view, tried->drawn->grid_options(),
                                                            kSprayMap, are_drops_near(tried->scene, view)));
    };
    const auto lit_floor = [&](const FloorWanted& wanted) {
        auto floor = std::make_shared<Floor>(*wanted.floor);
        FloorLightWanted light = wanted.light;
        set_footprints(light, *tried->drawn, {light.view, tried->scene.shot.first_frame});
        light_floor(*floor, *frame, light);
        return floor;
    };
    const auto objects_in = [&](double at) {
        return std::make_shared<const std::vector<DrawnObject>>(drawn_objects(
            *frame, tried->scene, {.query = tried->query, .frame = at, .rest_m = [&](glm::dvec2 place) {
                                       return tried->drawn->rest_m(place);
                                   }}));
    };
    std::unique_lock lock(mutex_);
    const auto wants_frame = [&] {
        return build_ != nullptr && time_s_ && (build_ != tried || time_s_ != tried_s);
    };
    for (;;) {
        wake_.wait(lock, [&] {
            return stopping_ || wants_frame() ||
                   (frame && ((eye_ && eye_ != tried_eye) || (spray_from_ && spray_from_ != tried_spray) ||
                              (floor_wanted_ && floor_wanted_ != tried_floor) ||
                              (objects_at_ && objects_at_ != tried_objects)));
        });
        if (stopping_) return;
        tried_eye = eye_;
        tried_spray = spray_from_;
        tried_floor = floor_wanted_;
        tried_objects = objects_at_;
        if (!wants_frame()) {  // the eye has moved over a sea that stands still
            lock.unlock();
            std::optional<double> water_m;
            std::shared_ptr<const Spray> spray;
            std::shared_ptr<const Floor> floor;
            std::shared_ptr<const std::vector<DrawnObject>> objects;
            std::string error;
            try {
                if (tried_eye)
                    water_m = surface_above_camera(*frame, *tried_eye, tried->drawn->grid_options());
                if (tried_spray) spray = spray_before(*tried_spray);
                if (tried_floor) floor = lit_floor(*tried_floor);
                if (tried_objects) objects = objects_in(*tried_objects);
            } catch (...) {
                error = message_of(std::current_exception());
            }
            lock.lock();
            frame_error_ = error;
            if (eye_) water_over_eye_m_ = water_m;
            if (spray_from_) spray_ = spray;
            if (floor_wanted_) floor_ = floor;
            if (objects_at_) objects_ = objects;
            continue;
        }
        tried = build_;
        tried_s = time_s_;
        LiveFrame& slot = slots_[written_];
        lock.unlock();
        std::string error;
        std::optional<double> water_m;
        std::shared_ptr<const Spray> spray;
        std::shared_ptr<const Floor> floor;
        std::shared_ptr<const std::vector<DrawnObject>> objects;
        try {
            if (!frame || frame_of != tried) {
                frame.reset();  // before the new one is made: halves the peak memory
                frame.emplace(tried->sea);
                frame_of = tried;
            }
            if (slot.build != tried) slot.packed.reset();
            slot.build = tried;
            const auto start = Clock::now();
            frame->set(*tried_s);
            const auto transformed = Clock::now();
            if (!slot.packed ||
                &slot.packed->layout()->sea() != &frame->sea())  // a sea that changes is another at each time
                slot.packed.emplace(frame->shared_sea(), tried->query);
            slot.packed->pack(*frame);
            slot.transforms_ms = milliseconds(start, transformed);
            slot.packing_ms = milliseconds(transformed, Clock::now());
            if (tried_eye) water_m = surface_above_camera(*frame, *tried_eye, tried->drawn->grid_options());
            if (tried_spray) spray = spray_before(*tried_spray);
            if (tried_floor) floor = lit_floor(*tried_floor);
            if (tried_objects) objects = objects_in(*tried_objects);
        } catch (...) {
            error = message_of(std::current_exception());
            frame.reset();
            slot = LiveFrame{};
        }
        lock.lock();
        frame_error_ = error;
        if (!error.empty()) continue;
        if (eye_) water_over_eye_m_ = water_m;
        if (spray_from_) spray_ = spray;
        if (floor_wanted_) floor_ = floor;
        if (objects_at_) objects_ = objects;
        slot.number = ++frames_;
        std::swap(written_, waiting_);
        fresh_ = true;
    }
}

}  // namespace pelagic
