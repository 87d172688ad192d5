// What pictures of `pelagic render` say about themselves, since no record does: the name that they were written under,
// what they were made of, and a checksum of all their bytes (a PNG has the format's own, for each chunk).
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "plugin/exr/exr.h"
#include "plugin/run/check.h"
#include "plugin/run/part.h"

namespace pelagic {

// The attributes of an EXR called `name` ("sea.0007.exr"), and what fills its checksum in once it is encoded.
std::vector<exr::Attribute> seal_attributes(const std::string& name);
void seal(std::string& exr);

// The comment of a PNG called `name`.
std::string png_comment(const std::string& name, const std::string& made_of);

// Reads all of a picture, .exr or .png. What is wrong with it, as the end of a sentence that begins with its name;
// empty: it is as it was written, under this very name. Throws BuildCancelled.
std::string picture_problem(const std::filesystem::path& file, CheckProgress& progress);

// Whether the file is there, whole, under its own name, and was made of this. trust: what it says at its beginning and end
// is enough; otherwise every byte is read. Throws BuildCancelled.
bool is_whole_picture(const std::filesystem::path& file, const std::string& made_of, bool trust = false,
                      const BuildWatch& watch = {});

// Those of the frames of which the folder hasn't all files as they would be made now, in their order. Reads files
// side by side. Throws BuildCancelled.
std::vector<int> unfinished_frames(const std::filesystem::path& folder, std::span<const RunPart> parts,
                                   std::span<const int> frames, bool trust, const BuildWatch& watch);

}  // namespace pelagic
