// Runs what makes files, frame after frame: a bake, a sequence of pictures. Files are whole or not there. Those that a
// former run left, made of what they would be made of now and with the bytes that were written (each is read, and its
// checksum compared), are kept; everything else that is asked for is done again.
//
// One frame is computed while others are encoded and written, a fixed number at most together: whatever the shot's
// length, those and the sea are all that is held.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "pelagic/scene.h"
#include "plugin/run/pipeline.h"

namespace pelagic {

struct RunWork;

// Checking: the files that are there. Looking: whether the cameras are above water. Waiting: for another process that
// holds the folder's lock.
enum class RunStage { Planning, Checking, Building, Looking, Frames, Waiting };

struct RunProgress {
    RunStage stage = RunStage::Planning;
    int frame = 0;         // the one that was finished last
    int at = 0;            // the one that is computed
    int done = 0;          // frames written by this run
    int kept = 0;          // frames that were whole already
    int total = 0;         // frames asked for: done + kept + what is left
    double seconds = 0.0;  // since the first frame was begun
    // What is done of the stage: of the files that are read, of the sea, of the cameras. While a frame is computed: of the
    // earlier times that a bake's foam comes from, if they are many, and of a picture; otherwise 0.
    double share = 0.0;
};

struct RunOptions {
    std::filesystem::path out;  // DIR, made where it is missing
    std::vector<int> frames;    // rising, within the shot's range; empty: the whole shot
    // One call at a time, from any thread; may be empty.
    std::function<void(const RunProgress&)> progress;
    // What it may hold in memory; 0: what the system gives this process (plugin/machine).
    std::size_t max_memory_bytes = 0;
    // Set from elsewhere (a signal handler, another thread). A bake stops as soon as the file at hand is whole, the frame
    // at hand is computed and the maps at hand are encoded; pictures that are computed are still written.
    const std::atomic<bool>* cancel = nullptr;
    // Files of the recorded size that are no newer than the record count as whole, unread; pictures that say so at their
    // beginning and end.
    bool trust_times = false;
    // Files that another instruction set made (instruction_set()) than this process uses are made again, and said; otherwise they are kept,
    // and said where a record knows of them.
    bool same_instruction_set = false;
    // What the shot's settings were chosen for, and which they are (plugin/budget): the record or the pictures say it. Empty: they
    // are the shot's own.
    std::string chosen{};
    // What whoever shared the shot out says was chosen for its budget (the same words as `chosen`): settle_for() takes that.
    std::string settled{};
    // What the record said of that when they were settled. A run whose record says by now what another one has chosen is refused.
    std::string chosen_before{};
};

struct RunReport {
    std::filesystem::path root, maps,
        volumes;                   // of a bake: DIR/NAME.usda, DIR/maps, DIR/volumes (each empty without)
    std::filesystem::path record;  // DIR/NAME.json; empty: the run has none
    int done = 0, kept = 0, total = 0;  // frames
    bool cancelled = false;
    double seconds = 0.0;  // from the call to its end
    long executed_transforms = 0;
    PipelineTimes times;  // of the frames that were made; all 0 where the run was cancelled
    // Frames of this shot's range that lie in DIR but belong to another version of it, or whose entry in the record was
    // altered: not asked for, not touched.
    std::vector<int> stale;
    std::vector<std::string> foreign;  // files in DIR that aren't this shot's (plugin/run/foreign.h)
    // Why other runs into DIR weren't kept from writing the record at the same time, in words; empty where they were, as far
    // as the system says. What they have written was merged.
    std::string unlocked;
    std::string
        note;  // of whoever settles a budget for the run: where files that are there say otherwise, and that stays
    // Frames that were asked for and that another instruction set had made: of which set (empty: pictures don't say which). Kept, or
    // made again (RunOptions::same_instruction_set).
    std::map<std::string, std::vector<int>> of_other_sets;
    // What wasn't as it was recorded, and was made again, a line each: "mesh/sea.0007.usdc holds other bytes …".
    std::vector<std::string> damaged;
};

// Throws what the work throws, files::FileError where a file can't be written (what was finished is kept and recorded), and
// std::invalid_argument for frames outside the shot's range, and ChosenMeanwhile and BegunAnew where another run has chosen other
// settings, or begun another version, meanwhile.
RunReport run(const RunWork& work, const RunOptions& options);

// Where the time of a finished run went: "compute 41 %, encode 22 %, write 97 % of the time busy; the disk
// was the bottleneck"; "no stage alone", where none was busy for most of the time. Empty where no frame was
// made.
std::string time_text(const RunReport& report);

// "--frames": "1-48", "7", "1-48x5" (every fifth), "1,5,10-20x5", with negative numbers as in "-3--1": any part of the shot's
// range, in any order; rising. Throws std::invalid_argument saying what is accepted.
std::vector<int> parse_frames(const std::string& text, const Shot& shot);

// "1-6, 9", of rising frames.
std::string frames_text(const std::vector<int>& frames);

}  // namespace pelagic
