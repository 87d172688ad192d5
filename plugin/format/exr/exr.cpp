// Writes OpenEXR with the library's own writers into a string.
//
// Why Auto means no compression. Measured on one core: a choppy JONSWAP sea (10 m/s) of
// 1024² pixels. Size relative to the samples', and time relative to None:
//                             None       RLE        ZIPS       ZIP        PIZ
//     displacement, Float   1.00, 1×   1.00, 4×   1.00, 27×  0.96, 39×  0.93, 61×
//     normal, Half          1.00, 1×   0.87, 3×   0.77, 12×  0.77, 11×  1.00, 31×
//     whitecaps, Float      1.00, 1×   1.00, 4×   0.99, 30×  0.99, 34×  1.00, 74×
//     slope variance, Float 1.00, 1×                         0.97, 25×
//     whitecaps by default  1.00, 1×                         0.52, 15×
//     a constant map        1.00, 1×   1.00, 4×   0.01, 3×   0.01, 3×   0.11, 10×
// The low bits of a sea are noise. All four maps by default take 0.75 of the bytes, and 25 times as long (3 s of CPU).
// That takes longer than computing the whole frame, saves time only on disks slower than some 10 MB/s, and
// every read pays again. Callers that know a map to be constant ask for Zip.
#include "plugin/format/exr/exr.h"

#include <ImfChannelList.h>
#include <ImfChromaticitiesAttribute.h>
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineOutputFile.h>
#include <ImfDoubleAttribute.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfFramesPerSecond.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfIntAttribute.h>
#include <ImfMatrixAttribute.h>
#include <ImfOutputFile.h>
#include <ImfPartType.h>
#include <ImfRationalAttribute.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfTileDescription.h>
#include <ImfTiledOutputFile.h>
#include <ImfTimeCodeAttribute.h>
#include <ImfVecAttribute.h>
#include <half.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <set>
#include <stdexcept>

namespace pelagic::exr {
namespace {

constexpr int kTileSize = 64;  // [pixels] per side: what renderers' texture caches expect
// zlib's level, 1 … 9. Level 4, the library's default, makes normals 2 % smaller and takes 1.25 times as
// long.
constexpr int kZipLevel = 1;
// Rows written per call: a multiple of every compression's block (32 for PIZ, 16 for ZIP).
constexpr int kBandRows = 32;
constexpr std::size_t kLongestName = 255;  // [bytes] the format's limit for long names
// The smallest magnitude that rounds to infinity as a half: 65504, the largest half, plus half a step of 32.
constexpr float kHalfOverflow = 65520.0f;

// The stream that the library writes to.
class StringStream : public Imf::OStream {
  public:
    explicit StringStream(std::size_t expected_bytes) : OStream("memory") { bytes_.reserve(expected_bytes); }

    void write(const char bytes[], int count) override {
        const auto n = static_cast<std::size_t>(count);
        const std::size_t overwritten = std::min(n, bytes_.size() - position_);
        std::memcpy(bytes_.data() + position_, bytes, overwritten);
        bytes_.append(bytes + overwritten, n - overwritten);
        position_ += n;
    }
    std::uint64_t tellp() override { return position_; }
    // The library seeks only back to the offset table, and then to the end again.
    void seekp(std::uint64_t position) override {
        if (position > bytes_.size()) bytes_.resize(position);
        position_ = position;
    }

    std::string take() { return std::move(bytes_); }

  private:
    std::string bytes_;
    std::size_t position_ = 0;
};

// The uncompressed size of an image's file with some room for the header: allocated once.
std::size_t raw_bytes(const Image& image) {
    constexpr std::size_t kHeader = 1 << 16;
    std::size_t bytes_a_pixel = 0;
    for (const Channel& channel : image.channels) bytes_a_pixel += channel.type == PixelType::Half ? 2 : 4;
    return kHeader +
           bytes_a_pixel * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
}

void check_image(const Image& image) {
    if (image.width <= 0 || image.height <= 0)
        throw std::invalid_argument("an image of " + std::to_string(image.width) + " x " +
                                    std::to_string(image.height) + " pixels: both must be at least 1");
    if (image.channels.empty()) throw std::invalid_argument("an image without channels: give at least one");
    std::set<std::string> names;
    for (const Channel& channel : image.channels) {
        if (channel.name.empty() || channel.name.size() > kLongestName)
            throw std::invalid_argument("channel name '" + channel.name + "': 1 to 255 bytes are accepted");
        if (!names.insert(channel.name).second)
            throw std::invalid_argument("channel '" + channel.name + "' comes twice: names must differ");
        if (channel.data == nullptr)
            throw std::invalid_argument("channel '" + channel.name + "' has no data");
    }
}

Imf::Compression imf_compression(Compression compression) {
    switch (compression) {
        case Compression::Auto:
        case Compression::None:
            return Imf::NO_COMPRESSION;
        case Compression::Rle:
            return Imf::RLE_COMPRESSION;
        case Compression::Zips:
            return Imf::ZIPS_COMPRESSION;
        case Compression::Zip:
            return Imf::ZIP_COMPRESSION;
        case Compression::Piz:
            return Imf::PIZ_COMPRESSION;
    }
    throw std::invalid_argument("unknown compression: Auto, None, Rle, Zips, Zip and Piz are accepted");
}

Imf::PixelType imf_type(PixelType type) {
    return type == PixelType::Half ? Imf::HALF : Imf::FLOAT;
}

void insert(Imf::Header& header, const Attribute& attribute) {
    const char* name = attribute.name.c_str();
    struct {
        Imf::Header& header;
        const char* name;
        void operator()(const std::string& v) const { header.insert(name, Imf::StringAttribute(v)); }
        void operator()(double v) const { header.insert(name, Imf::DoubleAttribute(v)); }
        void operator()(float v) const { header.insert(name, Imf::FloatAttribute(v)); }
        void operator()(int v) const { header.insert(name, Imf::IntAttribute(v)); }
        void operator()(const std::array<float, 2>& v) const {
            header.insert(name, Imf::V2fAttribute({v[0], v[1]}));
        }
        void operator()(const std::array<float, 3>& v) const {
            header.insert(name, Imf::V3fAttribute({v[0], v[1], v[2]}));
        }
        void operator()(const Chromaticities& v) const {
            const auto place = [](const std::array<float, 2>& xy) { return Imath::V2f(xy[0], xy[1]); };
            header.insert(name, Imf::ChromaticitiesAttribute(
                                    {place(v.red), place(v.green), place(v.blue), place(v.white)}));
        }
        void operator()(FramesPerSecond v) const {
            header.insert(name, Imf::RationalAttribute(Imf::guessExactFps(v.value)));
        }
        void operator()(TimeCode v) const {
            const int seconds = v.frame / v.fps;
            header.insert(name, Imf::TimeCodeAttribute(Imf::TimeCode(seconds / 3600, seconds / 60 % 60,
                                                                     seconds % 60, v.frame % v.fps)));
        }
        void operator()(const Matrix& v) const {
            Imath::M44f m;
            for (int row = 0; row < 4; ++row)
                for (int column = 0; column < 4; ++column) m[row][column] = v[row][column];
            header.insert(name, Imf::M44fAttribute(m));
        }
    } visitor{header, name};
    std::visit(visitor, attribute.value);
}

Imf::Header imf_header(const Header& header, const Image& image) {
    const Imath::V2i first(image.x, image.y), last(image.x + image.width - 1, image.y + image.height - 1);
    const auto side = [](int own, int display) { return (display > 0 ? display : own) - 1; };
    Imf::Header result(
        Imath::Box2i({0, 0}, {side(image.width, image.display[0]), side(image.height, image.display[1])}),
        Imath::Box2i(first, last));
    result.compression() = imf_compression(header.compression);
    result.zipCompressionLevel() = kZipLevel;
    for (const Channel& channel : image.channels)
        result.channels().insert(channel.name, Imf::Channel(imf_type(channel.type)));
    Imf::addWrapmodes(result, header.periodic ? "periodic,periodic" : "clamp,clamp");

    // The names of attributes that exist already, and of those that the library adds when it writes.
    std::set<std::string> taken{"name", "type", "version", "chunkCount", "tiles", "view", "preview"};
    for (auto own = result.begin(); own != result.end(); ++own) taken.insert(own.name());
    for (const Attribute& attribute : header.attributes) {
        if (attribute.name.empty() || attribute.name.size() > kLongestName)
            throw std::invalid_argument("attribute name '" + attribute.name +
                                        "': 1 to 255 bytes are accepted");
        if (!taken.insert(attribute.name).second)
            throw std::invalid_argument("attribute '" + attribute.name +
                                        "' comes twice or is one of OpenEXR's own: choose another name");
        insert(result, attribute);
    }
    return result;
}

// A rectangle of the file's pixels: x from the left, y from the top.
struct Block {
    int x, y, width, height;
};

[[noreturn]] void refuse(const Channel& channel, int column, int row, float value) {
    const std::string where = "channel '" + channel.name + "', column " + std::to_string(column) + ", row " +
                              std::to_string(row) + " from the bottom, is " + std::to_string(value) + ": ";
    throw std::invalid_argument(where + (std::isfinite(value)
                                             ? "a half holds up to 65504; write this channel as Float"
                                             : "only finite values are written"));
}

// The block's samples of one channel, top row first, packed, in the file's type.
void gather(const Image& image, const Channel& channel, const Block& block, char* packed) {
    const std::ptrdiff_t row_stride =
        channel.row_stride_bytes != 0 ? channel.row_stride_bytes : channel.pixel_stride_bytes * image.width;
    const float limit =
        channel.type == PixelType::Half ? kHalfOverflow : std::numeric_limits<float>::infinity();
    for (int y = block.y; y < block.y + block.height; ++y) {
        const int row = image.height - 1 - y;
        const char* sample = reinterpret_cast<const char*>(channel.data) + row * row_stride +
                             block.x * channel.pixel_stride_bytes;
        for (int x = block.x; x < block.x + block.width; ++x, sample += channel.pixel_stride_bytes) {
            float value;
            std::memcpy(&value, sample, sizeof value);
            if (!(std::abs(value) < limit)) refuse(channel, x, row, value);
            if (channel.type == PixelType::Half) {
                const half rounded(value);
                std::memcpy(packed, &rounded, sizeof rounded);
                packed += sizeof rounded;
            } else {
                std::memcpy(packed, &value, sizeof value);
                packed += sizeof value;
            }
        }
    }
}

// Memory for one block of all channels, and the library's view (frame buffer) of it.
class Scratch {
  public:
    // The samples of a channel are packed in rows of `width`, whatever the block's height.
    Scratch(const Image& image, int width, int height) {
        for (const Channel& channel : image.channels)
            planes_.emplace_back(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) *
                                 sample_size(channel));
    }

    // Copies the image's block into the memory. The slices count x and y from the block's corner if
    // `from_corner` (tiles), otherwise from the picture's.
    Imf::FrameBuffer load(const Image& image, const Block& block, bool from_corner) {
        Imf::FrameBuffer buffer;
        for (std::size_t c = 0; c < image.channels.size(); ++c) {
            const Channel& channel = image.channels[c];
            gather(image, channel, block, planes_[c].data());
            const std::size_t step = sample_size(channel);
            const std::size_t row = step * static_cast<std::size_t>(block.width);
            const Imath::V2i origin =
                from_corner ? Imath::V2i(0, 0) : Imath::V2i(image.x + block.x, image.y + block.y);
            buffer.insert(channel.name,
                          Imf::Slice::Make(imf_type(channel.type), planes_[c].data(), origin, block.width,
                                           block.height, step, row, 1, 1, 0.0, from_corner, from_corner));
        }
        return buffer;
    }

  private:
    static std::size_t sample_size(const Channel& channel) {
        return channel.type == PixelType::Half ? sizeof(half) : sizeof(float);
    }

    std::vector<std::vector<char>> planes_;
};

std::string size_text(int width, int height) {
    return std::to_string(width) + " x " + std::to_string(height);
}

void check_levels(std::span<const Image> levels) {
    if (levels.empty()) throw std::invalid_argument("no mip levels: give at least the picture itself");
    for (const Image& level : levels) check_image(level);
    const Image& full = levels.front();
    const int count = mip_level_count(full.width, full.height);
    if (levels.size() != static_cast<std::size_t>(count))
        throw std::invalid_argument(std::to_string(levels.size()) + " mip levels for a picture of " +
                                    size_text(full.width, full.height) + ": " + std::to_string(count) +
                                    " are needed, down to 1 x 1");
    const auto alike = [](const Channel& a, const Channel& b) {
        return a.name == b.name && a.type == b.type;
    };
    for (int l = 1; l < count; ++l) {
        const Image& level = levels[static_cast<std::size_t>(l)];
        const auto [width, height] = mip_level_size(full.width, full.height, l);
        if (level.width != width || level.height != height)
            throw std::invalid_argument("mip level " + std::to_string(l) + " is " +
                                        size_text(level.width, level.height) + ": it must be " +
                                        size_text(width, height));
        if (!std::equal(level.channels.begin(), level.channels.end(), full.channels.begin(),
                        full.channels.end(), alike))
            throw std::invalid_argument("mip level " + std::to_string(l) +
                                        " has other channels than the picture: the same in the same order");
    }
}

}  // namespace

std::string text_attribute_bytes(std::string_view name, std::string_view value) {
    std::string bytes(name);
    bytes += '\0';
    bytes += "string";
    bytes += '\0';
    for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>(value.size() >> shift & 0xff);
    return bytes.append(value);
}

std::string encode_scanline(const Header& header, const Image& image) {
    check_image(image);
    StringStream stream(raw_bytes(image));
    {
        // No threads: callers encode several files in parallel. The destructor writes the offset table.
        Imf::OutputFile file(stream, imf_header(header, image), 0);
        const int band = std::min(kBandRows, image.height);
        Scratch scratch(image, image.width, band);
        for (int y = 0; y < image.height; y += band) {
            const int rows = std::min(band, image.height - y);
            file.setFrameBuffer(scratch.load(image, {0, y, image.width, rows}, false));
            file.writePixels(rows);
        }
    }
    return stream.take();
}

std::string encode_deep_scanline(const Header& header, const DeepImage& image) {
    const Image flat{.width = image.width,
                     .height = image.height,
                     .channels = image.channels,
                     .x = image.x,
                     .y = image.y,
                     .display = image.display};
    check_image(flat);
    const auto width = static_cast<std::size_t>(image.width);
    if (image.counts.size() != width * static_cast<std::size_t>(image.height))
        throw std::invalid_argument("deep pixels without a count for each: give width times height");
    Imf::Header deep = imf_header(header, flat);
    deep.setType(Imf::DEEPSCANLINE);
    deep.compression() = Imf::ZIPS_COMPRESSION;
    StringStream stream(1 << 16);
    {
        Imf::DeepScanLineOutputFile file(stream, deep, 0);
        // One row at a time. The library adds x and y times the strides to where a slice begins: strides of y are 0.
        std::vector<std::uint32_t> counts(width);
        std::vector<std::vector<char>> packed(image.channels.size());
        std::vector<std::vector<char*>> begins(image.channels.size(), std::vector<char*>(width));
        const auto base = [&](auto* first) {
            return reinterpret_cast<char*>(reinterpret_cast<std::intptr_t>(first) -
                                           image.x * static_cast<std::intptr_t>(sizeof(*first)));
        };
        std::size_t sample = 0;
        for (int y = 0; y < image.height; ++y) {
            const auto row = image.counts.subspan(width * static_cast<std::size_t>(y), width);
            std::copy(row.begin(), row.end(), counts.begin());
            std::size_t samples = 0;
            for (const std::uint32_t count : row) samples += count;
            Imf::DeepFrameBuffer buffer;
            buffer.insertSampleCountSlice(
                Imf::Slice(Imf::UINT, base(counts.data()), sizeof(std::uint32_t), 0));
            for (std::size_t c = 0; c < image.channels.size(); ++c) {
                const Channel& channel = image.channels[c];
                const std::size_t bytes = channel.type == PixelType::Half ? sizeof(half) : sizeof(float);
                const float limit =
                    channel.type == PixelType::Half ? kHalfOverflow : std::numeric_limits<float>::infinity();
                packed[c].resize(bytes * samples);
                for (std::size_t i = 0; i < samples; ++i) {
                    float value;
                    std::memcpy(&value,
                                reinterpret_cast<const char*>(channel.data) +
                                    static_cast<std::ptrdiff_t>(sample + i) * channel.pixel_stride_bytes,
                                sizeof value);
                    if (!(std::abs(value) < limit))
                        throw std::invalid_argument("channel '" + channel.name + "', deep sample " +
                                                    std::to_string(sample + i) + ", is " +
                                                    std::to_string(value) +
                                                    ": finite values that its type holds are written");
                    const half rounded(channel.type == PixelType::Half ? value : 0.0f);
                    if (channel.type == PixelType::Half)
                        std::memcpy(packed[c].data() + bytes * i, &rounded, bytes);
                    else
                        std::memcpy(packed[c].data() + bytes * i, &value, bytes);
                }
                char* at = packed[c].data();
                for (std::size_t x = 0; x < width; at += bytes * row[x], ++x) begins[c][x] = at;
                buffer.insert(channel.name, Imf::DeepSlice(imf_type(channel.type), base(begins[c].data()),
                                                           sizeof(char*), 0, bytes));
            }
            sample += samples;
            file.setFrameBuffer(buffer);
            file.writePixels(1);
        }
    }
    return stream.take();
}

int mip_level_count(int width, int height) {
    return std::bit_width(static_cast<unsigned>(std::max({width, height, 1})));
}

std::pair<int, int> mip_level_size(int width, int height, int level) {
    return {std::max(1, width >> level), std::max(1, height >> level)};
}

std::string encode_mipmapped(const Header& header, std::span<const Image> levels) {
    check_levels(levels);
    const Image& full = levels.front();
    Imf::Header with_tiles = imf_header(header, full);
    with_tiles.setTileDescription(
        Imf::TileDescription(kTileSize, kTileSize, Imf::MIPMAP_LEVELS, Imf::ROUND_DOWN));
    StringStream stream(raw_bytes(levels.front()) * 4 / 3);
    {
        Imf::TiledOutputFile file(stream, with_tiles, 0);
        Scratch scratch(full, std::min(kTileSize, full.width), std::min(kTileSize, full.height));
        for (int l = 0; l < file.numLevels(); ++l) {
            const Image& level = levels[static_cast<std::size_t>(l)];
            for (int y = 0; y < level.height; y += kTileSize) {
                for (int x = 0; x < level.width; x += kTileSize) {
                    const Block tile{x, y, std::min(kTileSize, level.width - x),
                                     std::min(kTileSize, level.height - y)};
                    file.setFrameBuffer(scratch.load(level, tile, true));
                    file.writeTile(x / kTileSize, y / kTileSize, l);
                }
            }
        }
    }
    return stream.take();
}

}  // namespace pelagic::exr
