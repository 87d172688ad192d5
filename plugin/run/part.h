// The files of a run, before they are written: their names, their bytes, and what these are made of.
#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace pelagic {

// Hands the bytes of a file over, piece after piece.
using FileContent = std::function<void(const std::function<void(std::string_view)>&)>;

// A file that is to be written: its path below DIR, with /, and its bytes.
struct FileJob {
    std::string path;
    FileContent content;
    // Of what it is made of, where it carries that and its content takes long to make: one of no frame that is there stays then,
    // without being asked for.
    std::string fingerprint{};
};
// Takes a finished file. Files come in the order in which they are to be written.
using FileSink = std::function<void(const FileJob&)>;

// The files of a part at all frames: `prefix`, the frame's number (usd::frame_number), `suffix`.
struct FilePattern {
    std::string prefix, suffix;  // "mesh/sea.", ".usdc"
    std::string file(int frame) const;
};

// A part of a run: the file that it makes of each frame, and what that is made of. A file that was made of the same is kept.
struct RunPart : FilePattern {
    std::function<std::string(int frame)> fingerprint;
};

}  // namespace pelagic
