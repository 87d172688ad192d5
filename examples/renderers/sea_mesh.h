// What the procedurals for Hydra, Arnold and RenderMan have in common: the sea that a shot's own camera sees, as one mesh. C++17, over the C
// interface alone: to be copied into other hosts.
//
//   SeaStop stop;
//   SeaSource source(stop);
//   const SeaMesh mesh = source.mesh({"storm.toml", 12.0});
#pragma once

#include <pelagic/procedural.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

struct SeaParameters {
    std::string shot;                                   // a shot file
    double frame = 1.0;                                 // of it; may lie between frames
    double finest_cell_m = 0.0;                         // as in pelagic_open_options
    int threads = 0;                                    // 0: all
    double shutter_open = -0.25, shutter_close = 0.25;  // in frames from that one
    // When the shot file was written, by set_shot(): an edited one is another sea. Files that it names aren't looked at.
    std::filesystem::file_time_type written{};

    void set_shot(const std::string& path) {
        std::error_code error;  // opening it tells what is wrong
        shot = path;
        written = std::filesystem::last_write_time(path, error);
    }
    bool has_sea_of(const SeaParameters& other) const {
        return shot == other.shot && written == other.written && finest_cell_m == other.finest_cell_m &&
               threads == other.threads;
    }
    bool operator==(const SeaParameters& other) const {
        return has_sea_of(other) && frame == other.frame && shutter_open == other.shutter_open &&
               shutter_close == other.shutter_close;
    }
};

// Of each point as many floats as its value has, side by side.
struct SeaMesh {
    std::array<double, 3> origin_m{};     // what positions are relative to, in the world
    std::vector<std::uint32_t> corner{};  // of quads, counter-clockwise seen from above
    std::vector<float> position_m{};      // in the middle of the shutter
    std::vector<float> normal{};          // unit
    std::vector<float> slope_variance{};  // xx, yy, xy
    std::vector<float> coverage{};        // of foam, 0 … 1
    std::vector<float> velocity_m_per_frame{};
    double middle = 0.0;  // of the shutter, in frames from the frame

    std::size_t faces() const { return corner.size() / 4; }
    std::size_t points() const { return coverage.size(); }
    // Positions so many frames from the frame: a key of motion.
    std::vector<float> position_at(double frames) const {
        std::vector<float> moved = position_m;
        const auto way = static_cast<float>(frames - middle);
        for (std::size_t i = 0; i < moved.size(); ++i) moved[i] += way * velocity_m_per_frame[i];
        return moved;
    }
};

struct SeaStopped : std::runtime_error {
    using std::runtime_error::runtime_error;
};

// Ends what sources do, from any thread, and what they begin until it is taken back. It must outlive them.
class SeaStop {
  public:
    void set(bool stopped) {
        const std::lock_guard<std::mutex> lock(lock_);
        is_set_ = stopped;
        for (const pelagic_sea* sea : seas_) pelagic_cancel(sea, stopped, nullptr);
    }
    bool is_set() const { return is_set_; }
    void add(const pelagic_sea* sea) {
        const std::lock_guard<std::mutex> lock(lock_);
        seas_.insert(sea);
        pelagic_cancel(sea, is_set_, nullptr);
    }
    void remove(const pelagic_sea* sea) {
        const std::lock_guard<std::mutex> lock(lock_);
        seas_.erase(sea);
    }

  private:
    std::mutex lock_;
    std::atomic<bool> is_set_{false};
    std::set<const pelagic_sea*> seas_;
};

// The sea of the shot that was asked for last, for frame after frame. One thread at a time may use it.
class SeaSource {
  public:
    using Note = std::function<void(const char*)>;

    explicit SeaSource(SeaStop& stop) : stop_(stop) {}

    // Throws SeaStopped, and std::runtime_error with a sentence for people, of a mistake in the shot file with a line for each. `note` is
    // told what its author may not have meant.
    SeaMesh mesh(const SeaParameters& asked, const Note& note = {}) {
        if (!sea_ || !asked.has_sea_of(opened_)) open(asked, note);
        set_frame(asked);
        pelagic_info info = PELAGIC_INIT(pelagic_info);
        check(pelagic_get_info(sea_.get(), &info, &error_));
        pelagic_camera camera = PELAGIC_INIT(pelagic_camera);
        check(pelagic_shot_camera(sea_.get(), asked.frame, &camera, &error_));
        pelagic_mesh_size size = PELAGIC_INIT(pelagic_mesh_size);
        check(pelagic_expand_size(frame_.get(), &camera, nullptr, &size, &error_));

        SeaMesh mesh;
        pelagic_values values = PELAGIC_INIT(pelagic_values);
        values.position_m = room(mesh.position_m, 3 * size.points);
        values.normal = room(mesh.normal, 3 * size.points);
        values.velocity_mps = room(mesh.velocity_m_per_frame, 3 * size.points);
        values.slope_variance = room(mesh.slope_variance, 3 * size.points);
        values.coverage = room(mesh.coverage, size.points);
        pelagic_mesh_buffers buffers = PELAGIC_INIT(pelagic_mesh_buffers);
        buffers.points = size.points;
        buffers.corners = size.corners;
        buffers.corner = room(mesh.corner, size.corners);
        buffers.values = &values;
        check(pelagic_expand(frame_.get(), &camera, nullptr, &buffers, &error_));

        for (std::size_t axis = 0; axis < 3; ++axis) mesh.origin_m[axis] = buffers.origin_m[axis];
        mesh.middle = 0.5 * (asked.shutter_open + asked.shutter_close);
        const auto seconds = static_cast<float>(info.time_scale / info.frames_per_second);
        for (float& velocity : mesh.velocity_m_per_frame) velocity *= seconds;
        return mesh;
    }

  private:
    struct CloseSea {
        SeaStop* stop;
        void operator()(pelagic_sea* sea) const {
            stop->remove(sea);
            pelagic_close(sea);
        }
    };
    struct ReleaseFrame {
        void operator()(pelagic_frame* frame) const { pelagic_frame_release(frame); }
    };
    struct Listener {
        const SeaStop& stop;
        const Note& note;
    };

    template <class T>
    static T* room(std::vector<T>& values, std::size_t count) {
        values.resize(count);
        return values.data();
    }
    void check(pelagic_status status) const {
        if (status == PELAGIC_OK) return;
        if (status == PELAGIC_CANCELLED) throw SeaStopped(error_.message);
        throw std::runtime_error(error_.message);
    }

    void open(const SeaParameters& asked, const Note& note) {
        frame_.reset();
        sea_.reset();
        Listener listener{stop_, note};
        pelagic_source source = PELAGIC_INIT(pelagic_source);
        source.path = asked.shot.c_str();
        pelagic_open_options options = PELAGIC_INIT(pelagic_open_options);
        options.finest_cell_m = asked.finest_cell_m;
        options.threads = asked.threads;
        options.user = &listener;
        options.progress = [](double, void* user) {
            return static_cast<Listener*>(user)->stop.is_set() ? 1 : 0;
        };
        options.note = [](const char* sentence, void* user) {
            if (const Note& tell = static_cast<Listener*>(user)->note) tell(sentence);
        };
        pelagic_sea* sea = nullptr;
        check(pelagic_open(&source, &options, &sea, &error_));
        sea_.reset(sea);
        opened_ = asked;
        stop_.add(sea);
    }

    void set_frame(const SeaParameters& asked) {
        double open_s = 0.0, close_s = 0.0;
        check(pelagic_time_of_frame(sea_.get(), asked.frame + asked.shutter_open, &open_s, &error_));
        check(pelagic_time_of_frame(sea_.get(), asked.frame + asked.shutter_close, &close_s, &error_));
        if (frame_) return check(pelagic_frame_set(frame_.get(), open_s, close_s, &error_));
        pelagic_frame* frame = nullptr;
        check(pelagic_frame_create(sea_.get(), open_s, close_s, &frame, &error_));
        frame_.reset(frame);
    }

    SeaStop& stop_;
    SeaParameters opened_;
    std::unique_ptr<pelagic_sea, CloseSea> sea_{nullptr, CloseSea{&stop_}};
    std::unique_ptr<pelagic_frame, ReleaseFrame> frame_;
    pelagic_error error_{};
};
