// Pictures of skies: all their pixels, the same whole and in parts, or a refusal.
#include <cstring>
#include <span>
#include <string_view>
#include <vector>

#include "plugin/format/exr/read.h"
#include "tests/fuzz/fuzz.h"

using namespace pelagic;
using fuzz::hold;

namespace {

// Of a damaged block that is compressed OpenEXR 3.1 hands over memory that nobody has written: other values each time.
bool is_uncompressed(std::string_view bytes) {
    constexpr std::string_view kName("compression\0compression\0\x01\0\0\0", 28);
    const std::size_t at = bytes.find(kName);
    return at != std::string_view::npos && at + kName.size() < bytes.size() && bytes[at + kName.size()] == 0;
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    constexpr std::size_t kMostPixels = std::size_t{1} << 18;  // [pixels] more take no other way, only time
    const fuzz::MemoryFile file(data, size);
    const bool is_compared = is_uncompressed({reinterpret_cast<const char*>(data), size});
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
            hold(!is_compared || std::memcmp(part.data(), whole.data() + row * part.size(),
                                             part.size() * sizeof(float)) == 0,
                 "a row is the same alone and in the picture");
        }
    } catch (const exr::ReadError& error) {
        hold(!error.problem().empty() && !error.accepted().empty(), "a refusal says why", error.what());
        hold(std::string_view(error.what()).find(file.path()) != std::string_view::npos,
             "a refusal names the file", error.what());
    }
    return 0;
}
