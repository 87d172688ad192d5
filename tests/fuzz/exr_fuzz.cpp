// Pictures of skies: all their pixels, the same whole and in parts, or a refusal.
#include <cstring>
#include <span>
#include <vector>

#include "plugin/exr/read.h"
#include "tests/fuzz/fuzz.h"

using namespace pelagic;
using fuzz::hold;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    constexpr std::size_t kMostPixels = std::size_t{1} << 18;  // [pixels] more take no other way, only time
    const fuzz::MemoryFile file(data, size);
    exr::ends_whole(file.path());
    try {
        const exr::RgbFile picture(file.path());
        const auto width = static_cast<std::size_t>(picture.width()),
                   height = static_cast<std::size_t>(picture.height());
        hold(picture.width() > 0 && picture.height() > 0 && picture.rows_in_piece() > 0,
             "a picture has pixels");
        if (width * height > kMostPixels) return 0;
        std::vector<float> whole(3 * width * height), part(3 * width);
        picture.read(0, whole);
        for (const std::size_t row : {std::size_t{0}, height / 2, height - 1}) {
            picture.read(static_cast<int>(row), part);
            hold(std::memcmp(part.data(), whole.data() + row * part.size(), part.size() * sizeof(float)) == 0,
                 "a row is the same alone and in the picture");
        }
    } catch (const exr::ReadError& error) {
        hold(!error.problem().empty() && !error.accepted().empty(), "a refusal says why", error.what());
        hold(std::string_view(error.what()).find(file.path()) != std::string_view::npos,
             "a refusal names the file", error.what());
    }
    return 0;
}
