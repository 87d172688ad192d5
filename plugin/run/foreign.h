// Files in a bake's folder that aren't the shot's: of frames outside its range, of another format, of outputs
// that it no longer has, of another name. A bake names them; it deletes nothing. Those of a shot that has a record of
// its own in the folder are that shot's business.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pelagic/scene.h"
#include "plugin/run/part.h"

namespace pelagic {

// A line for each group, sorted: "mesh/sea.0007.usdc: outside the shot's frames", "maps/sea.normal.####.exr:
// 48 files of an output that the shot doesn't have", "mesh/old.####.usdc: 48 files of another shot". Only
// names that bakes give to files are looked at, in DIR and its folders mesh, maps, tiles and volumes.
std::vector<std::string> foreign_files(const std::filesystem::path& folder, const Shot& shot,
                                       std::span<const RunPart> parts,
                                       const std::vector<std::string>& static_files);

// The files that have names such as bakes give, by path below the folder, in DIR and its folders mesh, maps, tiles and
// volumes.
void for_each_bake_file(const std::filesystem::path& folder,
                        const std::function<void(const std::string& path)>& take);

// The name of the shot that a file is of by its own name, which ends at the first dot: "sea" of "mesh/sea.0007.usdc".
std::string shot_of(const std::string& path);

// The frame's number, if the name is one that a file of this pattern has.
std::optional<int> frame_of(std::string_view path, const FilePattern& pattern);

// The numbers of the files of this pattern in the folder, rising.
std::vector<int> frames_in(const std::filesystem::path& folder, const FilePattern& pattern);

// As foreign_files(), of pictures that `pelagic render` leaves: those of this shot, of frames outside its range.
std::vector<std::string> foreign_pictures(const std::filesystem::path& folder, const Shot& shot,
                                          std::span<const RunPart> parts);

}  // namespace pelagic
