// Runs a bake: plan, sea, and then frame after frame into files that are whole or not there.
//
//   DIR/NAME.usda, DIR/NAME.camera.usdc, DIR/NAME.sky.exr, DIR/mesh/…, DIR/maps/…, DIR/tiles/…, DIR/volumes/…, DIR/NAME.json
//
// Files that a former run left, with the fingerprint that they would get now and with the bytes that were written
// (each is read, and its checksum compared), are kept; everything else that is asked for is done again.
//
// One frame is computed while others are encoded and written, kFramesInFlight at most together. Whatever the
// shot's length, that and the sea is all that is held: bake_memory() says how much, and a bake that needs more than
// there is is refused before it begins.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/plan/memory.h"
#include "core/scene/scene.h"
#include "plugin/bake/pipeline.h"

namespace pelagic {

// One being computed, one encoded, one written.
inline constexpr int kFramesInFlight = 3;

// Checking: the files that are there. Waiting: for another process that holds the folder's lock.
enum class BakeStage { Planning, Checking, Building, Frames, Waiting };

struct BakeProgress {
    BakeStage stage = BakeStage::Planning;
    int frame = 0;         // the one that was finished last
    int done = 0;          // frames written by this run
    int kept = 0;          // frames that were whole already
    int total = 0;         // frames asked for: done + kept + what is left
    double seconds = 0.0;  // since the first frame was begun
    double built = 0.0;    // share of the sea, while it is built
    double checked = 0.0;  // share of the files that are there, while they are read
    // Share of the earlier times that the foam of the frame at hand comes from, while it goes through many; otherwise 0.
    double foam_past = 0.0;
};

struct BakeOptions {
    std::filesystem::path out;  // DIR, made where it is missing
    std::vector<int> frames;    // rising, within the shot's range; empty: the whole shot
    // One call at a time, from any thread; may be empty.
    std::function<void(const BakeProgress&)> progress;
    // What it may hold in memory; 0: what the system gives this process (plugin/machine).
    std::size_t max_memory_bytes = 0;
    // Set from elsewhere (a signal handler, another thread): the bake stops as soon as the file at hand is
    // whole, the frame at hand is computed and the maps at hand are encoded.
    const std::atomic<bool>* cancel = nullptr;
    // Files of the recorded size that are no newer than the record count as whole, unread.
    bool trust_times = false;
};

struct BakeReport {
    std::filesystem::path root, maps, volumes;  // DIR/NAME.usda, DIR/maps, DIR/volumes (each empty without)
    std::filesystem::path record;               // DIR/NAME.json
    int done = 0, kept = 0, total = 0;          // frames
    bool cancelled = false;
    double seconds = 0.0;  // from the call to its end
    long executed_transforms = 0;
    PipelineTimes times;  // of the frames that were baked; all 0 where the bake was cancelled
    // Frames of this shot's range that lie in DIR but belong to another version of it, or whose entry in the record was
    // altered: not asked for, not touched.
    std::vector<int> stale;
    std::vector<std::string> foreign;  // files in DIR that aren't this shot's (plugin/bake/foreign.h)
    // Why other bakes into DIR weren't kept from writing the record at the same time, in words; empty where they were, as far
    // as the system says. What they have written was merged.
    std::string unlocked;
    // What wasn't as it was recorded, and was made again, a line each: "mesh/sea.0007.usdc holds other bytes …".
    std::vector<std::string> damaged;
};

// What a bake of so many frames of the plan (plan_bake) holds at most, on so many threads.
MemoryNeed bake_memory(const Plan& plan, std::size_t frames, int threads);

// Throws NotEnoughMemory before anything is written, files::FileError where a file can't be written (what was
// finished is kept and recorded),
// std::invalid_argument for frames outside the shot's range or a scene that problems_of() refuses or that asks
// for nothing.
BakeReport bake(const Scene& scene, const BakeOptions& options);

// Where the time of a finished bake went: "compute 41 %, encode 22 %, write 97 % of the time busy; the disk
// was the bottleneck"; "no stage alone", where none was busy for most of the time. Empty where no frame was
// baked.
std::string time_text(const BakeReport& report);

// "--frames": "1-48", "7", "1-48x5" (every fifth), with negative numbers as in "-3--1": any part of the
// shot's range. Throws std::invalid_argument saying what is accepted.
std::vector<int> parse_frames(const std::string& text, const Shot& shot);

// "1-6, 9", of rising frames.
std::string frames_text(const std::vector<int>& frames);

}  // namespace pelagic
