// The record of a bake, DIR/NAME.json: what was asked, what the spectrum and the literature say, and for each
// frame that is whole its files and what the sea did.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/instruction_set.h"
#include "core/plan/plan.h"
#include "core/scene/scene.h"
#include "core/spectrum/spectral_moments.h"

namespace pelagic {

// Of the waves of one moment, over their whole period: sums over the modes that the outputs show.
struct WaveRecord {
    double significant_height_m = 0.0, energy_period_s = 0.0, mean_direction_deg = 0.0, mss = 0.0;
};

// A file as it was when it was whole.
struct FileRecord {
    std::uintmax_t bytes = 0;
    std::string fingerprint;  // of what it was made of; it carries the same
    // What its output says about the frame.
    std::optional<double> coverage{}, significant_height_m{};
};

// Of one frame. What nobody paid for is absent.
struct FrameRecord {
    std::string fingerprint;  // of what its statistics were made of
    std::string instruction_set = pelagic::instruction_set();
    std::map<std::string, FileRecord> files;  // by path below DIR, with /
    double time_s = 0.0;
    std::optional<WaveRecord> waves;
    double mss_residual = 0.0;                        // the spectrum's, of what the first output hides
    std::optional<double> mesh_significant_height_m;  // 4 × the standard deviation of the mesh's heights
    std::optional<double> coverage;                   // mean over the first output that has it
};

// The frames that the record at `file` holds; none where there is no record, or one that can't be read as
// ours: its frames are baked again.
std::map<int, FrameRecord> recorded_frames(const std::filesystem::path& file);

// Whether the frame's file at `path` is there, has its recorded size and fingerprint, and says itself that it
// is of this fingerprint: the record alone would vouch for a file that another shot has replaced since.
bool is_whole(const FrameRecord& frame, const std::string& path, const std::string& fingerprint,
              const std::filesystem::path& folder);

// What a run adds to the record of its shot.
class Record {
  public:
    // The part that belongs to the shot and not to a frame. Frames outside the shot's range are left out of
    // the record from now on.
    void describe(const Plan& plan, const SpectralMoments& total, double whitecap_threshold);

    void set(int frame, FrameRecord record) { unsaved_[frame] = std::move(record); }

    // Writes the record to `file`, with the frames that are there already, of this run and of others. Holds
    // one of those at a time: memory doesn't grow with the shot. Throws files::FileError; then what was set
    // is kept for the next time.
    void save(const std::filesystem::path& file);

  private:
    void write(const std::filesystem::path& former, const std::function<void(std::string_view)>& sink) const;

    nlohmann::ordered_json shot_;
    int first_frame_ = 0, last_frame_ = 0;
    std::map<int, FrameRecord> unsaved_;
};

}  // namespace pelagic
