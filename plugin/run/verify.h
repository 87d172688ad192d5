// Whether everything in a folder is as it was written: the bakes of all its shots, and the pictures.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "plugin/run/check.h"

namespace pelagic {

enum class Flaw {
    Missing,  // a file that the record knows, or frames of the shot that aren't baked
    Damaged,  // other bytes than were written; a record with a changed number
    Stale,  // frames of another version of the shot than the record's, or of another instruction set than is asked for
    Foreign,      // named as a bake's files are, and no record knows it
    Interrupted,  // of a bake that was stopped before it wrote its record
};
const char* word_of(Flaw flaw);  // "missing", …

struct Finding {
    std::string path;  // below the folder, with /
    Flaw flaw = Flaw::Missing;
    std::string what;  // the end of a sentence that begins with the path: "is missing"
};

struct Verification {
    std::vector<Finding> findings;      // by path
    int shots = 0;                      // records
    int files = 0;                      // that the records know, and pictures
    std::uintmax_t bytes = 0;           // that these have
    std::vector<std::string> merged{};  // records that took in what lay beside them: NAME.json
    std::vector<std::string>
        notes{};  // why others couldn't, and which shots several instruction sets have made; a line each
    bool is_whole() const { return findings.empty() && files > 0; }
};

// Reads all files in full. A shot's files are known by its record; pictures (NAME.####.exr, .png) by what they say
// about themselves: those that a folder lacks altogether, nobody knows. Of a shot whose record is damaged, files that
// are in no entry that is left aren't called foreign. Nor are files of a frame that the record lacks, and those of a
// stale frame aren't looked at: a bake is at them, or was stopped there. Of a shot that is whole, what runs have recorded beside its
// record is taken into it, which then is the one that a single run leaves; nothing else is written. `instruction_set`: that must have made
// all frames and pictures; empty: any may, and a note says of a shot that several have. Throws files::FileError where there is no such folder, and
// BuildCancelled.
Verification verify(const std::filesystem::path& folder, const BuildWatch& watch = {},
                    const std::string& instruction_set = {});

}  // namespace pelagic
