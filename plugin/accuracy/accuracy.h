// What accuracy costs: each approximation of the program with its knob swept over a shot, the error against a named
// reference and the time, both measured in one run.
//
// Rows of parts say what each effect that is on costs: the whole shot less the shot without it.
//
// A new approximation is a row of approximation_table() with a function that lays out its trials. Timing, the table, the
// page and the ages of what was recorded follow from the row.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "core/base/build_watch.h"
#include "pelagic/scene.h"

namespace pelagic {

struct PictureBytes {
    std::string exr, png;
};

// One setting of a knob, ready to be timed.
struct Trial {
    std::string setting;    // "cubic, 2 nodes a sample"
    bool is_shots = false;  // what the shot has
    std::function<void()> run;
    // How far the last run is from the reference, in the order of the row's `errors`. Finite, and 0 for the reference
    // itself.
    std::function<std::vector<double>()> errors;
    std::size_t bytes = 0;  // of what the row's `bytes` says
    int transforms = 0;     // a frame, in rows of parts
    // The picture that was made last, as an EXR and as a PNG; empty where there is none.
    std::function<PictureBytes()> picture{};
};

struct Trials {
    std::vector<Trial> trials;
    std::string
        why_none{};  // where the shot has nothing to sweep: the end of a sentence that begins with the row's name
};

struct SweepWatch {
    std::function<void(const std::string& row, const std::string& setting)> progress{};  // may be empty
    // Each setting's picture, by the setting's place in its row, from 1; may be empty.
    std::function<void(const std::string& row, std::size_t setting, const PictureBytes& picture)> picture{};
    const std::atomic<bool>* cancel = nullptr;
};

// Settings of rows of parts: the whole shot; the whole shot again, which shows how far two times of the same differ;
// the shot without each of its parts ("without whitecaps"); and what is left without all of them.
inline constexpr const char *kWholeShot = "the shot", *kShotAgain = "the shot again", *kWithout = "without ",
                            *kBareShot = "without all of these";

enum class RowKind {
    Sweep,  // settings of a knob, each with its error
    Parts,  // what is on in the shot, each with its price
};

struct ApproximationRow {
    const char* name;                 // of the command line and of files: "sky"
    const char* title;                // "Lookups of the sky"
    const char* knob;                 // how a user sets it; or why nobody does
    const char* reference;            // what errors are against
    std::vector<const char*> errors;  // what they are, with their units; of a sweep the first one is drawn
    const char* time;                 // what is timed
    const char* bytes;                // what bytes are of; null: none
    const char* lesson;               // what to learn from it, in a sentence
    Trials (*lay_out)(const Scene& shot);
    RowKind kind = RowKind::Sweep;
};

std::span<const ApproximationRow> approximation_table();

struct MeasuredSetting {
    std::string setting;
    bool is_shots = false;
    std::vector<double> errors;
    double ms = std::numeric_limits<double>::quiet_NaN();
    std::size_t bytes = 0;
    int transforms = 0;
};

// A row as it was measured, now or in an earlier run.
struct MeasuredRow {
    std::string name;
    std::string shot;     // a hash of its keys
    std::string when;     // UTC, "2026-11-21T10:05:00Z"
    std::string machine;  // instruction set and threads
    std::vector<MeasuredSetting> settings;
    std::string why_none{};
};

// Sweeps one row: each trial once to warm up and for its errors, then all in turn, `repeats` times, so that a machine
// whose speed drifts slows all alike; times are medians. A part's time is the whole's less the median of their
// differences. Since differences are small, they are measured kPartRepeats times as often, and more where trials are
// quick. The shot must be valid. Throws BuildCancelled, std::bad_alloc, and std::logic_error for errors that aren't
// finite.
MeasuredRow sweep(const ApproximationRow& row, const Scene& shot, int repeats, const SweepWatch& watch);

inline constexpr int kPartRepeats = 3;

// The time of day, as MeasuredRow::when has it.
std::string utc_now();

// The shot's keys as a hash, by which a recorded row is known to be of this shot.
std::string shot_hash(const Scene& shot);

}  // namespace pelagic
