// What `pelagic farm` writes into DIR/farm, and reads there again: JOB.json beside the scripts says which task makes what. JOB is NAME.VERB, or
// of a part of the shot NAME.VERB.FIRST-LAST.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pelagic/scene.h"

namespace pelagic::cli {

struct FarmTask {
    std::string frames;  // as of --frames
    // Of what each frame's files are made: made_of() of a bake (plugin/run/record.h), PictureFingerprint of pictures; empty: not known.
    std::vector<std::string> made_of{};
    std::string log;    // below DIR/farm
    std::string slurm;  // what Slurm itself says of it, below DIR/farm
};

struct FarmJob {
    std::string verb, shot;         // "bake" or "render", and the path of the shot file
    Shot of{};                      // its name and frames alone
    std::string instruction_set{};  // that all must be made by; empty: any
    bool is_deep = false;           // of pictures, with deep ones
    std::string
        id{};  // of its frames and versions: a script runs only while the job is the one that it was written for
    std::vector<FarmTask> tasks{};
};

// The lines with which a task's log tells when it begins and ends: "pelagic farm: begun ID on HOST", "… ended ID with status N".
inline constexpr const char* kFarmBegun = "pelagic farm: begun ";
inline constexpr const char* kFarmEnded = "pelagic farm: ended ";
// A line of its own: what stands before says nothing of the job that is there now.
inline constexpr const char* kFarmShared = "pelagic farm: shared out anew";

// As a shell takes it for one word.
std::string shell_word(const std::string& text);

// --status: prints it, of all jobs in DIR/farm or of the one whose JOB.json this is; the exit status.
int print_farm_status(const std::filesystem::path& path);

}  // namespace pelagic::cli
