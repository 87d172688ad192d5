// Shot files: TOML in, a validated Scene out. The keys, their defaults and what they accept are core's
// (core/scene/keys.h).
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "core/scene/problem.h"
#include "pelagic/scene.h"

namespace pelagic {

// A shot file that is refused. what() has one line for each problem, in the order of the file:
//   FILE:LINE:COLUMN: KEY = VALUE: PROBLEM; accepted: WHAT IS
// (FILE alone before the colon where the file itself can't be read; no KEY where the text goes beyond the bounds of
// bounds.h or is no TOML). Lines count from 1, columns from 1 in characters. Of very many problems the first are
// there and the number of the others.
class ShotError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

inline constexpr std::size_t kMostShotBytes = std::size_t{16} << 20;  // 100 000 camera keys are 10 MiB

// The problems that this reader can't see: files that the scene names and whose formats it doesn't know, and seas that
// can't be. plugin/light has the check for hosts, check_scene().
using SceneCheck = std::function<std::vector<Problem>(const Scene&)>;

// The scene that a shot file describes, a measured spectrum and a cage that it names included; it has passed validate(), and
// the files that it names have been looked at. The file's first problems and the number of the others are collected
// into one ShotError; of errors in the TOML itself the first.
Scene load_shot(const std::filesystem::path& file, const SceneCheck& check_scene);

// The same for a text that is already in memory: `file` is its name in messages, and the folder that it names
// paths from.
Scene parse_shot(std::string_view text, const std::filesystem::path& file, const SceneCheck& check_scene);

// "FILE:LINE:COLUMN: PROBLEM", where the problem begins with a key of the file ("quality.max_error = 0.01, which …"), and
// otherwise "FILE: PROBLEM": for what is refused after the file was read.
std::string placed(const std::filesystem::path& file, const std::string& problem);

// Help: every table and key, with its default, unit, what it accepts, what it does and what depends on it;
// the words that the parser uses.
std::string describe_keys();

}  // namespace pelagic
