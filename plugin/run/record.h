// The record of a bake, DIR/NAME.json: what was asked, what the spectrum and the literature say, and for each
// frame that is whole its files and what the sea did. Each file has its size and checksum, and so have each frame's
// entry and the shot's part: a number that was altered since is noticed. Nothing in it depends on when, where, by whom or in which
// order frames were made: runs of parts of a shot leave the record that one run leaves. What a run adds lies beside it until then
// (plugin/run/fragments.h).
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

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
    std::string fingerprint;                  // of what its statistics were made of
    std::string instruction_set{};            // that it was made with
    std::map<std::string, FileRecord> files;  // by path below DIR, with /
    bool is_stale = false;                    // of another version of the shot than the record's
    double time_s = 0.0;
    std::optional<WaveRecord> waves;
    double mss_residual = 0.0;                        // the spectrum's, of what the first output hides
    std::optional<double> mesh_significant_height_m;  // 4 × the standard deviation of the mesh's heights
    std::optional<double> coverage;                   // mean over the first output that has it
    std::optional<SprayRecord> spray;
};

// Of what a frame's files are made, by path and fingerprint, as one number.
std::string made_of(const std::map<std::string, FileRecord>& files);

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
    std::string
        version{};  // what that part says, but for the files: alike for all runs of one version of the shot
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

// A record of fewer bytes is read and written in milliseconds.
inline constexpr std::uintmax_t kSmallRecord = std::uintmax_t{1} << 18;

inline constexpr std::size_t kFewFrames = 16;

// Whether these frames are few and the record isn't small: then read_frames() parses no other.
bool is_read_in_part(const std::filesystem::path& file, std::span<const int> frames);

// The same of these frames, rising, and the numbers of all that have an entry and aren't stale; null: nobody asks for them. In part, other entries
// aren't looked at for what was altered, nor is what lies between them; else all of them are handed over. So a long record that is
// broken in its middle stays as it is until the shot is whole, or its part about the shot is written anew: its frames that
// are asked for are made again, like any that aren't recorded.
RecordReading read_frames(const std::filesystem::path& file, std::span<const int> frames,
                          const std::function<void(int, FrameRecord)>& take, std::set<int>* numbers,
                          const std::atomic<bool>* cancel = nullptr);

// The same of no frame: what the record says of the shot.
RecordReading read_shot_part(const std::filesystem::path& file, const std::atomic<bool>* cancel = nullptr);

// Another run into the folder has chosen other settings since this one looked: the same command again takes those.
class ChosenMeanwhile : public std::invalid_argument {
  public:
    using invalid_argument::invalid_argument;
};

// Whether the files of no frame name all of the shot's, a line of some 70 bytes for each, or those that are recorded.
inline bool names_all_frames(int first, int last) {
    return std::int64_t{last} - first < 32768;
}

// Another run has begun another version of the shot in the folder: what this one still made would lie among that one's files.
class BegunAnew : public std::runtime_error {
  public:
    using runtime_error::runtime_error;
};

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
    void set(const std::string& path, const FileRecord& file);
    void set(int frame, FrameRecord record) { unsaved_[frame] = std::move(record); }

    // All of these take the record's file, DIR/NAME.json, and throw files::FileError.
    //
    // Makes sure that the record tells of this version of the shot. Where it is of another one, or missing, it is written anew with
    // the frames that it has, those of other versions as stale; fragments stay as they are. Throws ChosenMeanwhile where it says that another run
    // has chosen otherwise, and what `waiting` throws. `write_static`: what is written, and set, before the record and under its
    // lock; it hears of the files of no frame that are recorded. Not called where that throws. makes_frames: whether the run has a
    // fragment from now on.
    using WriteStatic = std::function<void(const std::map<std::string, FileRecord>& recorded)>;
    void begin(const std::filesystem::path& file, const files::LockWatch& waiting = {},
               const WriteStatic& write_static = {}, bool makes_frames = false);
    // As the run begins: read_shot_part().version. begin() throws BegunAnew where the record tells of a third version by then.
    void expect_version(const std::string& version) { before_ = version; }

    // Throws BegunAnew where the record tells of another version of the shot by now. Costs a look at the file where it is as it was.
    void refuse_other_version(const std::filesystem::path& file);

    // Writes what was set into the run's fragment. Holds one frame in memory of those that are there already.
    void save(const std::filesystem::path& file);

    // The last save() of a run. Throws BegunAnew. Where all the shot's frames are there, the fragments become a part of the record, which
    // is as one run would have written it; two that do so at once write the same, and a lock needn't hold. Where the record is small and no other
    // fragment is there, this run's does. `write_static`: as of begin(), before a record that is whole.
    void finish(const std::filesystem::path& file, const files::LockWatch& waiting = {},
                const WriteStatic& write_static = {});

    // Of a folder whose runs are over: where the fragments make the record whole they become a part of it, as by finish(), and the
    // record is the one that a single run leaves. False where nothing was done: there are none, or they don't. Throws
    // files::FileError.
    static bool take_in_fragments(const std::filesystem::path& file, const files::LockWatch& waiting = {});

    // Why other runs aren't kept from writing the record at the same time, in words; empty where they are, as far as
    // the system says.
    const std::string& unlocked() const { return unlocked_; }

  private:
    using Take = std::function<void(int, FrameRecord)>;
    enum class Merged { Yes, Changed, NotWhole };  // Changed: by another run meanwhile
    // Into the record: nothing, so that it tells of this version of the shot; this run's fragment; all of them, if that makes it whole.
    enum class Taken { Nothing, Ours, All };

    void refuse_other_choice(const RecordReading& there, const std::filesystem::path& file) const;
    void refuse_begun_anew(const RecordReading& there, const std::filesystem::path& file) const;
    // Writes the record with these and what was set since, and deletes the fragments that it took in.
    Merged merge(const std::filesystem::path& file, Taken taken);
    std::int64_t write(const files::ByteSink& sink, const std::function<void(const Take&)>& former) const;
    void take_in(const std::filesystem::path& file, const files::LockWatch& waiting,
                 const WriteStatic& write_static);
    bool is_alone(const std::filesystem::path& file) const;
    // Whether all that is in the fragment is there as well; and the numbers of the record's frames.
    bool is_in_record(const std::filesystem::path& file, std::set<int>& numbers_there) const;
    void drop_fragment();

    nlohmann::ordered_json shot_;
    std::vector<std::string>
        choices_;  // that the record may have when the run begins, beside none; empty: any
    int first_frame_ = 0, last_frame_ = 0;
    std::function<bool(int, const FrameRecord&)> is_stale_;
    std::map<int, FrameRecord> unsaved_;
    std::filesystem::path fragment_{};  // of what was saved; empty: none yet
    std::size_t saved_ = 0;             // frames in it
    std::string id_{};                  // in its name
    std::string unlocked_;
    std::optional<std::string> before_{};  // expect_version()
    files::FileIdentity seen_{};           // the record when it was last known to tell of this version
};

}  // namespace pelagic
