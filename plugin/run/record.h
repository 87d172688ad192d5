// The record of a bake, DIR/NAME.json: what was asked, what the spectrum and the literature say, and for each
// frame that is whole its files and what the sea did. Each file has its size and checksum, and so have each frame's
// entry and the shot's part: a number that was altered since is noticed.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/instruction_set.h"
#include "core/plan/plan.h"
#include "core/spectrum/spectral_moments.h"
#include "pelagic/scene.h"
#include "plugin/files/files.h"
#include "plugin/run/spray_record.h"

namespace pelagic {

// Of the waves of one moment, over their whole period: sums over the modes that the outputs show.
struct WaveRecord {
    double significant_height_m = 0.0, energy_period_s = 0.0, mean_direction_deg = 0.0, mss = 0.0;
};

// A file as it was when it was whole.
struct FileRecord {
    std::uintmax_t bytes = 0;
    std::string checksum{};     // plugin/files/checksum.h
    std::string fingerprint{};  // of what it was made of; it carries the same; empty: none
    // What its output says about the frame.
    std::optional<double> coverage{}, significant_height_m{};
    std::optional<SprayRecord> spray{};
};

// Of one frame. What nobody paid for is absent.
struct FrameRecord {
    std::string fingerprint;  // of what its statistics were made of
    std::string instruction_set = pelagic::instruction_set();
    std::map<std::string, FileRecord> files;  // by path below DIR, with /
    bool is_stale = false;                    // of another version of the shot than the record's
    double time_s = 0.0;
    std::optional<WaveRecord> waves;
    double mss_residual = 0.0;                        // the spectrum's, of what the first output hides
    std::optional<double> mesh_significant_height_m;  // 4 × the standard deviation of the mesh's heights
    std::optional<double> coverage;                   // mean over the first output that has it
    std::optional<SprayRecord> spray;
};

// What a record says about the whole shot.
struct ShotRecord {
    std::string name;
    int first_frame = 0, last_frame = 0;
    std::map<std::string, FileRecord> files;  // that belong to no frame
    std::string chosen{};                     // RunOptions::chosen
};

// What was found in a record.
struct RecordReading {
    std::optional<ShotRecord> shot;  // absent where that part was altered, or isn't ours
    // What is wrong with the file as a whole, as the end of a sentence that begins with its name; what could be read
    // before was read.
    std::string problem;
    bool is_missing = false;  // the problem is that there is none
    bool is_blocked =
        false;  // something is there that can't be read: a pipe, a folder, a file of another user
    std::vector<int> altered{};  // frames whose entries aren't as they were written
};

// Hands over each frame whose entry is as it was written, in the order of the file: never more than one of them is in
// memory. Throws BuildCancelled.
RecordReading read_record(const std::filesystem::path& file,
                          const std::function<void(int, FrameRecord)>& take,
                          const std::atomic<bool>* cancel = nullptr);

// What a run adds to the record of its shot.
class Record {
  public:
    // The part that belongs to the shot and not to a frame. Frames outside the shot's range are left out of
    // the record from now on. whitecap_threshold: without gusts.
    void describe(const Plan& plan, const SpectralMoments& total, double whitecap_threshold,
                  double residual_coverage);
    // After describe(): RunOptions::chosen and chosen_before.
    void set_chosen(const std::string& chosen, const std::string& before) {
        if (chosen.empty()) return;
        shot_["chosen"] = chosen;
        choices_ = {chosen, before};
    }
    // Whether a frame that an earlier run recorded is of another version of the shot; may be empty.
    void mark_stale(std::function<bool(int, const FrameRecord&)> is_stale) {
        is_stale_ = std::move(is_stale);
    }

    // A file that belongs to no frame.
    void set(const std::string& path, const files::FileState& file);
    void set(int frame, FrameRecord record) { unsaved_[frame] = std::move(record); }

    // Writes the record to `file`, with the frames that are there already, of this run and of others, and again where
    // another run has written it meanwhile. Holds one frame of others at a time, and of ours those that weren't found in the
    // record since they were saved: memory doesn't grow with the shot. Throws files::FileError, and what `waiting` throws;
    // then what was set is kept for the next time.
    //
    // The first time it throws std::invalid_argument where the record says that another run has chosen otherwise. `begin`:
    // what is written, and set, before the record and under its lock; not called where that throws.
    void save(const std::filesystem::path& file, const files::LockWatch& waiting = {},
              const std::function<void()>& begin = {});

    // The last save() of a run: where other runs write as well, looks whether what was set last is still there some moments
    // later, and saves it again where another one, whose lock was none, has written over it.
    void finish(const std::filesystem::path& file, const files::LockWatch& waiting = {});

    // Why other runs aren't kept from writing the record at the same time, in words; empty where they are, as far as
    // the system says.
    const std::string& unlocked() const { return unlocked_; }

  private:
    // Returns those of saved_ that `former` has.
    std::vector<int> write(const std::filesystem::path& former,
                           const std::function<void(std::string_view)>& sink) const;
    void refuse_other_choice(const std::filesystem::path& former) const;
    bool is_all_in(const std::filesystem::path& file) const;

    nlohmann::ordered_json shot_;
    std::vector<std::string>
        choices_;  // that the record may have when the run begins, beside none; empty: any
    int first_frame_ = 0, last_frame_ = 0;
    std::function<bool(int, const FrameRecord&)> is_stale_;
    std::map<int, FrameRecord> unsaved_;
    std::map<int, FrameRecord>
        saved_;  // and not found in the record since: another run may have written over it
    std::optional<files::FileIdentity> written_;  // the record as save() left it
    bool is_shared_ = false;                      // another run has written it since
    std::string unlocked_;
};

}  // namespace pelagic
