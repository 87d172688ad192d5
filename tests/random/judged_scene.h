// What becomes of a shot: refused with a message, or baked and pictured, and whether all of that is as it has to be.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace pelagic::test {

struct Judgement {
    std::string failure;       // of which kind; empty: none
    std::string detail;        // the failure with its numbers
    std::string refusal;       // of the shot file
    bool is_pictured = false;  // false: its camera is refused
};

// Loads the shot file, which may be refused with a message that names a key. Otherwise bakes it into a new folder beside
// it and renders its first frame, both on one thread and on two. `variant` chooses what a shot file doesn't say of
// pictures: samples, shutter, alpha, layers.
//
// What has to be: nothing throws; the same bits on one thread and on two; every number in every file and in the
// picture is finite, variances are not negative, coverage is 0 … 1, normals are unit vectors; and
// waves that are shown have no more energy than the spectrum.
Judgement judge(const std::filesystem::path& shot, std::uint64_t variant);

}  // namespace pelagic::test
