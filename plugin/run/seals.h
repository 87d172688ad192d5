// What pictures of `pelagic render` say about themselves, since no record does: the name that they were written under,
// what they were made of, and a checksum of all their bytes (a PNG has the format's own, for each chunk).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "plugin/format/exr/exr.h"
#include "plugin/run/check.h"

namespace pelagic {

// The attributes of an EXR called `name` ("sea.0007.exr"), and what fills its checksum in once it is encoded.
std::vector<exr::Attribute> seal_attributes(const std::string& name);
void seal(std::string& exr);

// The comment of a PNG called `name`.
std::string png_comment(const std::string& name, const std::string& made_of);

// Whether the picture says that this set (instruction_set()) made it.
bool says_instruction_set(const std::filesystem::path& file, const std::string& set);

// Whether the picture is there, and says at its beginning and end that it is whole and was made of this.
bool seems_whole(const std::filesystem::path& file, const std::string& made_of);

// Reads all of a picture, .exr or .png. What is wrong with it, as the end of a sentence that begins with its name;
// empty: it is as it was written, under this very name. Throws BuildCancelled.
std::string picture_problem(const std::filesystem::path& file, CheckProgress& progress);

}  // namespace pelagic
