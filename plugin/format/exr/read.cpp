#include "plugin/format/exr/read.h"

#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <openexr.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <fstream>
#include <new>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

namespace pelagic::exr {
namespace {

constexpr int kLargestSide = 32768;  // [pixels] 16 times a usual sky's; damaged headers may claim anything
// The most that is decoded at once: rows of tiles across the whole picture. 256 lines of the widest picture are half
// of this, and so are usual tiles, 64 to 256 a side.
constexpr std::int64_t kMostPixelsInPiece = std::int64_t{1} << 24;
constexpr const char* kAccepted = "a whole file of half or float channels R, G, B or Y";

// Why a file is refused. RgbFile adds its name.
struct Refusal {
    std::string problem, accepted;
};

[[noreturn]] void refuse_damage(const std::string& reason) {
    throw Refusal{"can't be read as an OpenEXR picture: " + reason, kAccepted};
}

// OpenEXR's library in C, which reads no more of a file than is asked for: the one in C++ believes a header's sizes
// and makes room for them.
class Context {
  public:
    explicit Context(const std::filesystem::path& path) {
        exr_context_initializer_t options = EXR_DEFAULT_CONTEXT_INITIALIZER;
        options.error_handler_fn = [](exr_const_context_t, exr_result_t, const char*) {};
        if (const exr_result_t result = exr_start_read(&context_, path.c_str(), &options);
            result != EXR_ERR_SUCCESS)
            refuse_damage(exr_get_default_error_message(result));
    }
    ~Context() { exr_finish(&context_); }
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;

    // What one of the library's functions returns for the first part.
    template <class Value, class Get>
    Value get(Get ask) const {
        Value value{};
        if (const exr_result_t result = ask(context_, 0, &value); result != EXR_ERR_SUCCESS)
            refuse_damage(exr_get_default_error_message(result));
        return value;
    }
    exr_const_context_t native() const { return context_; }

  private:
    exr_context_t context_ = nullptr;
};

std::string channel_names(std::span<const exr_attr_chlist_entry_t> channels) {
    std::string names;
    for (const exr_attr_chlist_entry_t& channel : channels) {
        constexpr std::size_t kMostBytes = 200;
        if (names.size() > kMostBytes) return names + ", …";
        names += (names.empty() ? "" : ", ") + std::string(channel.name.str);
    }
    return names.empty() ? "none" : names;
}

// Whether the picture is grey: Y alone, instead of red, green and blue.
bool looks_grey(std::span<const exr_attr_chlist_entry_t> channels) {
    const auto find = [&](std::string_view name) {
        return std::find_if(channels.begin(), channels.end(),
                            [&](const exr_attr_chlist_entry_t& channel) { return channel.name.str == name; });
    };
    const auto has = [&](std::string_view name) { return find(name) != channels.end(); };
    const bool is_grey = !(has("R") && has("G") && has("B"));
    if (is_grey && !(has("Y") && !has("RY") && !has("BY")))
        throw Refusal{"has the channels " + channel_names(channels), "R, G, B or Y alone"};
    for (const char* name : is_grey ? std::vector{"Y"} : std::vector{"R", "G", "B"}) {
        const exr_attr_chlist_entry_t& channel = *find(name);
        if (channel.pixel_type != EXR_PIXEL_HALF && channel.pixel_type != EXR_PIXEL_FLOAT)
            throw Refusal{"has integers in channel " + std::string(name), "half and float"};
        if (channel.x_sampling != 1 || channel.y_sampling != 1)
            throw Refusal{"has fewer samples than pixels in channel " + std::string(name),
                          "one sample a pixel"};
    }
    return is_grey;
}

// Nobody else may have looked at the path. A pipe would be waited for as soon as it is opened.
void refuse_no_file(const std::filesystem::path& path) {
    std::error_code ignored;
    const std::filesystem::file_status status = std::filesystem::status(path, ignored);
    if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
        throw Refusal{"is a pipe or a folder, or another thing that is no file", kAccepted};
}

// An attribute that claims to be longer than what is left of the file: the library in C++ makes room for it.
void refuse_long_attributes(const std::filesystem::path& path, std::uintmax_t bytes) {
    std::ifstream file(path, std::ios::binary);
    std::array<char, 8> start{};
    file.read(start.data(), start.size());
    const bool has_parts = (start[5] & 0x10) != 0;
    std::string name, type;
    for (bool begins = true; file;) {
        std::getline(file, name, '\0');
        if (name.empty()) {  // the end of a header, and of them all
            if (!has_parts || begins) return;
            begins = true;
            continue;
        }
        begins = false;
        std::array<unsigned char, 4> size{};
        std::getline(file, type, '\0');
        file.read(reinterpret_cast<char*>(size.data()), size.size());
        const std::uint32_t length = size[0] | size[1] << 8 | size[2] << 16 | std::uint32_t{size[3]} << 24;
        if (!file || length > bytes - static_cast<std::uintmax_t>(file.tellg())) break;
        file.seekg(length, std::ios::cur);
    }
    throw Refusal{"has a damaged header, or is cut short", "a whole file"};
}

// Whether the file ends before its pixels do. Looks at the place and size of each chunk of level 0, not into it.
void refuse_short_file(const Context& file, std::uintmax_t bytes, const exr_attr_box2i_t& window,
                       bool is_tiled) {
    const auto refuse = [] {
        throw Refusal{"is cut short, or its table of chunks is damaged", "a whole file"};
    };
    const auto chunks = file.get<std::int32_t>(exr_get_chunk_count);
    if (chunks < 1 || static_cast<std::uintmax_t>(chunks) * sizeof(std::uint64_t) > bytes) refuse();
    const auto look = [&](exr_result_t result, const exr_chunk_info_t& chunk) {
        if (result != EXR_ERR_SUCCESS || chunk.data_offset > bytes ||
            chunk.packed_size > bytes - chunk.data_offset)
            refuse();
    };
    exr_chunk_info_t chunk{};
    if (!is_tiled) {
        const auto lines = file.get<std::int32_t>(exr_get_scanlines_per_chunk);
        for (std::int64_t y = window.min.y; y <= window.max.y; y += lines)
            look(exr_read_scanline_chunk_info(file.native(), 0, static_cast<int>(y), &chunk), chunk);
        return;
    }
    const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
    const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
    std::int32_t tile_width = 0, tile_height = 0;
    if (exr_get_tile_sizes(file.native(), 0, 0, 0, &tile_width, &tile_height) != EXR_ERR_SUCCESS) refuse();
    for (int y = 0; std::int64_t{y} * tile_height < height; ++y)
        for (int x = 0; std::int64_t{x} * tile_width < width; ++x)
            look(exr_read_tile_chunk_info(file.native(), 0, x, y, 0, 0, &chunk), chunk);
}

}  // namespace

RgbFile::RgbFile(std::filesystem::path path) : path_(std::move(path)) {
    try {
        refuse_no_file(path_);
        const Context file(path_);
        const auto storage = file.get<exr_storage_t>(exr_get_storage);
        if (storage == EXR_STORAGE_DEEP_SCANLINE || storage == EXR_STORAGE_DEEP_TILED)
            throw Refusal{"has deep pixels", "flat ones, as scan lines or tiles"};
        const auto* channels = file.get<const exr_attr_chlist_t*>(exr_get_channels);
        is_grey_ = looks_grey({channels->entries, static_cast<std::size_t>(channels->num_channels)});

        const auto window = file.get<exr_attr_box2i_t>(exr_get_data_window);
        const auto shown = file.get<exr_attr_box2i_t>(exr_get_display_window);
        const auto corners = [](const exr_attr_box2i_t& box) {
            return std::array{box.min.x, box.min.y, box.max.x, box.max.y};
        };
        if (corners(window) != corners(shown))
            throw Refusal{
                "holds only a part of its picture, or more (its data window isn't its display window)",
                "whole pictures"};
        // 64-bit: corners may lie anywhere in the range of int.
        const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
        const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
        if (width < 1 || height < 1 || width > kLargestSide || height > kLargestSide)
            throw Refusal{"is " + std::to_string(width) + " x " + std::to_string(height) + " pixels",
                          "1 to " + std::to_string(kLargestSide) + " a side"};
        width_ = static_cast<int>(width);
        height_ = static_cast<int>(height);
        std::error_code ignored;
        const std::uintmax_t bytes = std::filesystem::file_size(path_, ignored);
        const bool is_tiled = storage == EXR_STORAGE_TILED;
        refuse_long_attributes(path_, bytes);
        refuse_short_file(file, bytes, window, is_tiled);
        if (is_tiled) {
            std::int32_t tile_width = 0;
            exr_get_tile_sizes(file.native(), 0, 0, 0, &tile_width, &rows_in_piece_);
            if (const std::int64_t most = kMostPixelsInPiece / width; rows_in_piece_ > most)
                throw Refusal{"has tiles that are " + std::to_string(rows_in_piece_) + " pixels high",
                              "scan lines, or tiles of at most " + std::to_string(most) +
                                  " in a picture of this width"};
        } else {
            rows_in_piece_ = file.get<std::int32_t>(exr_get_scanlines_per_chunk);
        }
    } catch (const Refusal& refusal) {
        throw ReadError(path_.string(), refusal.problem, refusal.accepted);
    }
}

void RgbFile::read(int first_row, std::span<float> rgb) const {
    const std::size_t row = std::size_t{3} * static_cast<std::size_t>(width_);
    if (first_row < 0 || first_row > height_ || rgb.size() % row != 0 ||
        rgb.size() / row > static_cast<std::size_t>(height_ - first_row))
        throw std::invalid_argument("RgbFile::read: rows that the picture doesn't have");
    if (rgb.empty()) return;
    try {
        Imf::MultiPartInputFile file(path_.c_str(), 0);
        const Imath::Box2i window = file.header(0).dataWindow();
        if (window.max.x - window.min.x + 1 != width_ || window.max.y - window.min.y + 1 != height_)
            throw std::runtime_error("it has changed while it was read");
        const Imath::V2i first(window.min.x, window.min.y + first_row);
        const auto rows = static_cast<int>(rgb.size() / row);
        // The library reads each channel into one slice only: a grey one is copied.
        Imf::FrameBuffer buffer;
        constexpr std::size_t kStep = 3 * sizeof(float);
        const std::array names{"R", "G", "B"};
        for (std::size_t c = 0; c < (is_grey_ ? 1u : 3u); ++c)
            buffer.insert(is_grey_ ? "Y" : names[c],
                          Imf::Slice::Make(Imf::FLOAT, rgb.data() + c, first, width_, rows, kStep,
                                           row * sizeof(float)));
        Imf::InputPart part(file, 0);
        part.setFrameBuffer(buffer);
        part.readPixels(first.y, first.y + rows - 1);
    } catch (const std::bad_alloc&) {
        throw;
    } catch (const std::exception& error) {
        throw ReadError(path_.string(), std::string("can't be read as an OpenEXR picture: ") + error.what(),
                        kAccepted);
    }
    if (is_grey_)
        for (std::size_t i = 0; i < rgb.size(); i += 3) rgb[i + 1] = rgb[i + 2] = rgb[i];
}

RgbPixels read_rgb(const std::filesystem::path& path) {
    const RgbFile file(path);
    RgbPixels out{file.width(), file.height(), {}};
    out.pixels.resize(static_cast<std::size_t>(out.width) * static_cast<std::size_t>(out.height));
    file.read(0, {out.pixels.data()->data(), 3 * out.pixels.size()});
    return out;
}

bool ends_whole(const std::filesystem::path& path) {
    try {
        refuse_no_file(path);
        const Context file(path);
        const auto storage = file.get<exr_storage_t>(exr_get_storage);
        if (storage != EXR_STORAGE_SCANLINE && storage != EXR_STORAGE_DEEP_SCANLINE) return false;
        const auto window = file.get<exr_attr_box2i_t>(exr_get_data_window);
        std::error_code ignored;
        refuse_short_file(file, std::filesystem::file_size(path, ignored), window, false);
        return true;
    } catch (const Refusal&) {
        return false;
    }
}

}  // namespace pelagic::exr
