// Written files, read back with libpng's simplified reader, which shares only the format with the writer.
#include "plugin/format/png/png.h"

#include <gtest/gtest.h>
#include <png.h>

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace pelagic::png {
namespace {

std::vector<std::uint8_t> pattern(int width, int height) {
    std::vector<std::uint8_t> bytes;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < 3; ++c) bytes.push_back(static_cast<std::uint8_t>(7 * x + 31 * y + 101 * c));
    return bytes;
}

struct Chunk {
    std::string name, content;
};

std::uint32_t number(const std::string& file, std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<std::uint8_t>(file.at(at + i));
    return value;
}

// The format: eight bytes, then chunks of length, name, content and checksum.
std::vector<Chunk> chunks_of(const std::string& file) {
    std::vector<Chunk> chunks;
    for (std::size_t at = 8; at < file.size();) {
        const std::size_t length = number(file, at);
        chunks.push_back({file.substr(at + 4, 4), file.substr(at + 8, length)});
        at += 12 + length;
    }
    return chunks;
}

TEST(Png, IsReadBackByteForByte) {
    for (const auto& [width, height] :
         {std::pair(1, 1), std::pair(5, 3), std::pair(3, 700), std::pair(640, 2)}) {
        const std::vector<std::uint8_t> rgb = pattern(width, height);
        const std::string file = encode({.width = width, .height = height, .bytes = rgb});
        png_image image{};
        image.version = PNG_IMAGE_VERSION;
        ASSERT_NE(png_image_begin_read_from_memory(&image, file.data(), file.size()), 0) << image.message;
        EXPECT_EQ(image.width, static_cast<unsigned>(width));
        EXPECT_EQ(image.height, static_cast<unsigned>(height));
        image.format = PNG_FORMAT_RGB;
        std::vector<std::uint8_t> read(PNG_IMAGE_SIZE(image));
        ASSERT_NE(png_image_finish_read(&image, nullptr, read.data(), 0, nullptr), 0) << image.message;
        EXPECT_EQ(read, rgb);
    }
}

TEST(Png, SaysThatItIsSrgbAndOfEightBits) {
    const std::string file = encode({.width = 4, .height = 2, .bytes = pattern(4, 2)});
    bool srgb = false;
    for (const Chunk& chunk : chunks_of(file)) {
        if (chunk.name == "sRGB") srgb = true;
        if (chunk.name == "IHDR") {
            EXPECT_EQ(chunk.content.at(8), 8);  // bits per sample
            EXPECT_EQ(chunk.content.at(9), 2);  // truecolour
        }
        EXPECT_NE(chunk.name, "tIME");  // the bytes depend on the picture alone
    }
    EXPECT_TRUE(srgb);
    EXPECT_EQ(file, encode({.width = 4, .height = 2, .bytes = pattern(4, 2)}));
}

TEST(Png, HoldsAlpha) {
    std::vector<std::uint8_t> bytes;
    for (int i = 0; i < 4 * 5 * 3; ++i) bytes.push_back(static_cast<std::uint8_t>(7 * i));
    const std::string file = encode({.width = 5, .height = 3, .bytes = bytes, .has_alpha = true});
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    ASSERT_NE(png_image_begin_read_from_memory(&image, file.data(), file.size()), 0) << image.message;
    image.format = PNG_FORMAT_RGBA;
    std::vector<std::uint8_t> read(PNG_IMAGE_SIZE(image));
    ASSERT_NE(png_image_finish_read(&image, nullptr, read.data(), 0, nullptr), 0) << image.message;
    EXPECT_EQ(read, bytes);
    EXPECT_TRUE(is_whole(file));
    EXPECT_FALSE(is_whole(file.substr(0, file.size() - 20)));
    EXPECT_THROW(encode({.width = 5, .height = 4, .bytes = bytes, .has_alpha = true}), std::invalid_argument);
}

TEST(Png, RefusesSizesThatItCannotHold) {
    const std::vector<std::uint8_t> rgb = pattern(4, 2);
    EXPECT_THROW(encode({.width = 0, .height = 2, .bytes = {}}), std::invalid_argument);
    EXPECT_THROW(encode({.width = 4, .height = -2, .bytes = rgb}), std::invalid_argument);
    EXPECT_THROW(encode({.width = 1000001, .height = 1, .bytes = rgb}), std::invalid_argument);
    EXPECT_THROW(encode({.width = 4, .height = 3, .bytes = rgb}), std::invalid_argument);
}

// Ours, and those of libpng's simplified writer: grey, with alpha, of 16 bits, with a palette.
TEST(Decode, ReadsWhatOthersWrite) {
    const std::vector<std::uint8_t> pixels = pattern(5, 3);
    const std::string ours = encode({.width = 5, .height = 3, .bytes = pixels});
    EXPECT_EQ(decode(ours, 15).rgb, pixels);
    EXPECT_EQ(decode(ours, 15).width, 5);
    EXPECT_THROW(decode(ours, 14), ReadError);
    EXPECT_THROW(decode("", 1), ReadError);
    for (std::size_t size = 8; size < ours.size(); ++size)
        EXPECT_THROW(decode(std::string_view(ours).substr(0, size), 15), ReadError) << size;
    const auto written = [](std::uint32_t format, const void* buffer, const void* colours = nullptr) {
        png_image image{};
        image.version = PNG_IMAGE_VERSION;
        image.width = 2, image.height = 1;
        image.format = format;
        image.colormap_entries = colours ? 2 : 0;
        png_alloc_size_t size = 0;
        png_image_write_to_memory(&image, nullptr, &size, 0, buffer, 0, colours);
        std::string bytes(size, 0);
        EXPECT_TRUE(png_image_write_to_memory(&image, bytes.data(), &size, 0, buffer, 0, colours));
        return bytes;
    };
    const std::vector<std::uint8_t> grey{7, 200}, alpha{1, 2, 3, 0, 4, 5, 6, 128}, index{1, 0},
        palette{9, 8, 7, 6, 5, 4};
    const std::vector<std::uint16_t> wide{65535, 0};
    using Rgb = std::vector<std::uint8_t>;
    EXPECT_EQ(decode(written(PNG_FORMAT_GRAY, grey.data()), 2).rgb, (Rgb{7, 7, 7, 200, 200, 200}));
    EXPECT_EQ(decode(written(PNG_FORMAT_RGBA, alpha.data()), 2).rgb, (Rgb{1, 2, 3, 4, 5, 6}));
    EXPECT_EQ(decode(written(PNG_FORMAT_RGB_COLORMAP, index.data(), palette.data()), 2).rgb,
              (Rgb{6, 5, 4, 9, 8, 7}));
    EXPECT_EQ(decode(written(PNG_FORMAT_LINEAR_Y, wide.data()), 2).rgb, (Rgb{255, 255, 255, 0, 0, 0}));
}

}  // namespace
}  // namespace pelagic::png
