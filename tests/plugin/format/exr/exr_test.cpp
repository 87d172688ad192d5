// Encoded files, read back with OpenEXR's own readers.
#include "plugin/format/exr/exr.h"

#include <ImfChannelList.h>
#include <ImfDoubleAttribute.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfIntAttribute.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>
#include <ImfTiledInputFile.h>
#include <ImfVecAttribute.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numeric>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

namespace pelagic::exr {
namespace {

class StringReader : public Imf::IStream {
  public:
    explicit StringReader(const std::string& bytes) : IStream("memory"), bytes_(bytes) {}
    bool read(char out[], int n) override {
        if (position_ + static_cast<std::size_t>(n) > bytes_.size()) throw std::runtime_error("past the end");
        std::memcpy(out, bytes_.data() + position_, static_cast<std::size_t>(n));
        position_ += static_cast<std::size_t>(n);
        return position_ < bytes_.size();
    }
    std::uint64_t tellg() override { return position_; }
    void seekg(std::uint64_t position) override { position_ = position; }

  private:
    const std::string& bytes_;
    std::size_t position_ = 0;
};

// A channel as it is in the file: the picture's top row first.
struct Plane {
    int width = 0, height = 0;
    std::vector<float> samples;
    float at(int x, int y_from_top) const {
        return samples[static_cast<std::size_t>(y_from_top) * static_cast<std::size_t>(width) +
                       static_cast<std::size_t>(x)];
    }
};

Imf::FrameBuffer frame_buffer(const std::string& channel, Plane& plane) {
    plane.samples.assign(static_cast<std::size_t>(plane.width) * static_cast<std::size_t>(plane.height),
                         -1e9f);
    Imf::FrameBuffer buffer;
    buffer.insert(channel, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(plane.samples.data()),
                                      sizeof(float), sizeof(float) * static_cast<std::size_t>(plane.width)));
    return buffer;
}

Plane read_scanlines(const std::string& bytes, const std::string& channel) {
    StringReader reader(bytes);
    Imf::InputFile file(reader);
    const Imath::Box2i window = file.header().dataWindow();
    EXPECT_EQ(window.min, Imath::V2i(0, 0));
    EXPECT_EQ(window, file.header().displayWindow());
    Plane plane{window.max.x + 1, window.max.y + 1, {}};
    file.setFrameBuffer(frame_buffer(channel, plane));
    file.readPixels(0, window.max.y);
    return plane;
}

Plane read_level(Imf::TiledInputFile& file, const std::string& channel, int level) {
    Plane plane{file.levelWidth(level), file.levelHeight(level), {}};
    file.setFrameBuffer(frame_buffer(channel, plane));
    file.readTiles(0, file.numXTiles(level) - 1, 0, file.numYTiles(level) - 1, level);
    return plane;
}

// Random samples, bottom row first.
std::vector<float> noise(int width, int height, unsigned seed) {
    std::mt19937 generator(seed);
    std::uniform_real_distribution<float> uniform(-1.0f, 1.0f);
    std::vector<float> samples(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    for (float& sample : samples) sample = uniform(generator);
    return samples;
}

float bottom_up(const std::vector<float>& samples, int width, int i, int j) {
    return samples[static_cast<std::size_t>(j) * static_cast<std::size_t>(width) +
                   static_cast<std::size_t>(i)];
}

Image one_channel(int width, int height, const std::vector<float>& samples,
                  PixelType type = PixelType::Float) {
    return {width, height, {{.name = "Y", .data = samples.data(), .type = type}}};
}

std::string refusal(const Header& header, const Image& image) {
    try {
        encode_scanline(header, image);
    } catch (const std::invalid_argument& error) {
        return error.what();
    }
    return "(not refused)";
}

// A picture of which some is outside the display window, and some of that isn't there.
TEST(Exr, DataWindowMayBeAnotherThanTheDisplays) {
    constexpr int kWidth = 5, kHeight = 70;  // more rows than are written at once
    std::vector<float> values(kWidth * kHeight);
    std::iota(values.begin(), values.end(), 0.0f);
    const Image image{.width = kWidth,
                      .height = kHeight,
                      .channels = {{.name = "Y", .data = values.data()}},
                      .x = -2,
                      .y = 3,
                      .display = {100, 50}};
    const std::string bytes = encode_scanline({}, image);
    StringReader reader(bytes);
    Imf::InputFile file(reader);
    EXPECT_EQ(file.header().dataWindow(), Imath::Box2i({-2, 3}, {2, 72}));
    EXPECT_EQ(file.header().displayWindow(), Imath::Box2i({0, 0}, {99, 49}));
    std::vector<float> read(values.size());
    Imf::FrameBuffer buffer;
    buffer.insert("Y", Imf::Slice::Make(Imf::FLOAT, read.data(), Imath::V2i(-2, 3), kWidth, kHeight));
    file.setFrameBuffer(buffer);
    file.readPixels(3, 72);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
            ASSERT_EQ(read[static_cast<std::size_t>(y * kWidth + x)],
                      values[static_cast<std::size_t>((kHeight - 1 - y) * kWidth + x)]);
}

// The contract: column i is at x = −L/2 + i·L/N, the bottom row is at y = −L/2, and up is +y. A wave along
// (1, 2)·2π/L is evaluated at those corners and compared with the picture, whose rows begin at the top.
TEST(Exr, TheBottomRowIsTheSmallestYAndColumnsAreCorners) {
    const int n = 8;
    const double length_m = 100.0;
    const double k = 2.0 * std::acos(-1.0) / length_m;
    const auto wave = [k](double x, double y) {
        return static_cast<float>(std::sin(k * x + 2.0 * k * y + 0.3));
    };
    std::vector<float> samples;
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i)
            samples.push_back(wave(-length_m / 2 + i * length_m / n, -length_m / 2 + j * length_m / n));
    const Plane plane = read_scanlines(encode_scanline({}, one_channel(n, n, samples)), "Y");
    for (int row_from_top = 0; row_from_top < n; ++row_from_top) {
        for (int i = 0; i < n; ++i) {
            const double y = length_m / 2 - (row_from_top + 1) * length_m / n;
            EXPECT_EQ(plane.at(i, row_from_top), wave(-length_m / 2 + i * length_m / n, y));
        }
    }
}

// Lossless: every bit of every float, with each compression, at odd sizes, and for more than one band of
// rows.
TEST(Exr, FloatsComeBackExactlyWithEveryCompression) {
    for (const auto& [width, height] : {std::pair{1, 1}, {1, 7}, {7, 1}, {37, 101}, {100000, 2}}) {
        const std::vector<float> samples = noise(width, height, 1);
        for (Compression compression : {Compression::Auto, Compression::None, Compression::Rle,
                                        Compression::Zips, Compression::Zip, Compression::Piz}) {
            const Header header{.attributes = {}, .periodic = false, .compression = compression};
            const Plane plane =
                read_scanlines(encode_scanline(header, one_channel(width, height, samples)), "Y");
            ASSERT_EQ(plane.width, width);
            ASSERT_EQ(plane.height, height);
            int wrong = 0;
            for (int j = 0; j < height; ++j)
                for (int i = 0; i < width; ++i)
                    wrong += plane.at(i, height - 1 - j) != bottom_up(samples, width, i, j);
            EXPECT_EQ(wrong, 0) << width << " x " << height << ", compression "
                                << static_cast<int>(compression);
        }
    }
}

// A half has 11 significant bits: rounding to nearest is off by at most 2^-11 of the value. Below 2^-14 the
// step is 2^-24, and the error at most half of it.
TEST(Exr, HalvesAreRoundedToTheNearest) {
    const int n = 70;
    std::vector<float> samples = noise(n, n, 2);
    samples[0] = 1.0f;
    samples[1] = -0.333251953125f;       // -1365/4096, exactly a half
    samples[2] = 1.0f + 3.0f / 4096.0f;  // halfway from 1 + 2/4096 to 1 + 4/4096: rounds to the even one
    samples[3] = 65519.0f;               // nearer to 65504 than to the next step
    samples[4] = 0.0f;
    const std::string bytes = encode_scanline({}, one_channel(n, n, samples, PixelType::Half));
    const Plane plane = read_scanlines(bytes, "Y");
    int inexact = 0;
    for (int j = 0; j < n; ++j) {
        for (int i = 0; i < n; ++i) {
            const float exact = bottom_up(samples, n, i, j), read = plane.at(i, n - 1 - j);
            EXPECT_LE(std::abs(read - exact),
                      std::max(std::ldexp(std::abs(exact), -11), std::ldexp(1.0f, -25)));
            inexact += read != exact;
        }
    }
    EXPECT_GT(inexact, n * n / 2);  // the file has halves indeed
    EXPECT_EQ(plane.at(0, n - 1), 1.0f);
    EXPECT_EQ(plane.at(1, n - 1), samples[1]);
    EXPECT_EQ(plane.at(2, n - 1), 1.0f + 4.0f / 4096.0f);
    EXPECT_EQ(plane.at(3, n - 1), 65504.0f);
    EXPECT_EQ(plane.at(4, n - 1), 0.0f);

    StringReader reader(bytes);
    Imf::InputFile file(reader);
    EXPECT_EQ(file.header().channels().findChannel("Y")->type, Imf::HALF);
    EXPECT_EQ(file.header().compression(), Imf::NO_COMPRESSION);
}

// Interleaved vectors with a gap after each row, and different types per channel.
TEST(Exr, ChannelsAreReadThroughTheirStrides) {
    struct Texel {
        float x, y, z;
    };
    const int width = 5, height = 3, row = 9;
    std::vector<Texel> texels(row * height, Texel{NAN, NAN, NAN});  // NaN in the gaps shows reads of them
    for (int j = 0; j < height; ++j)
        for (int i = 0; i < width; ++i)
            texels[static_cast<std::size_t>(j * row + i)] = {static_cast<float>(i), static_cast<float>(j),
                                                             0.5f};
    const std::ptrdiff_t pixel_stride = sizeof(Texel), row_stride = row * pixel_stride;
    const Image image{width,
                      height,
                      {{"R", &texels[0].x, pixel_stride, row_stride, PixelType::Float},
                       {"G", &texels[0].y, pixel_stride, row_stride, PixelType::Half},
                       {"B", &texels[0].z, pixel_stride, row_stride, PixelType::Float}}};
    const std::string bytes = encode_scanline({}, image);
    const Plane r = read_scanlines(bytes, "R"), g = read_scanlines(bytes, "G"),
                b = read_scanlines(bytes, "B");
    for (int j = 0; j < height; ++j) {
        for (int i = 0; i < width; ++i) {
            EXPECT_EQ(r.at(i, height - 1 - j), static_cast<float>(i));
            EXPECT_EQ(g.at(i, height - 1 - j), static_cast<float>(j));
            EXPECT_EQ(b.at(i, height - 1 - j), 0.5f);
        }
    }
}

TEST(Exr, AttributesComeBack) {
    const std::vector<float> samples = noise(2, 2, 3);
    const Header header{.attributes = {{"period", 123.456789012345},
                                       {"space", "object"},
                                       {"comment", ""},
                                       {"frame", 48},
                                       {"fps", 24.0f},
                                       {"wind", std::array<float, 2>{7.0f, -3.0f}},
                                       {"minimum", std::array<float, 3>{-1.0f, -2.0f, -3.0f}},
                                       {"aNameOfMoreThanThirtyOneCharacters", "kept"}},
                        .periodic = true,
                        .compression = Compression::Auto};
    const std::string bytes = encode_scanline(header, one_channel(2, 2, samples));
    StringReader reader(bytes);
    Imf::InputFile file(reader);
    const Imf::Header& read = file.header();
    EXPECT_EQ(read.typedAttribute<Imf::DoubleAttribute>("period").value(), 123.456789012345);
    EXPECT_EQ(read.typedAttribute<Imf::StringAttribute>("space").value(), "object");
    EXPECT_EQ(read.typedAttribute<Imf::StringAttribute>("comment").value(), "");
    EXPECT_EQ(read.typedAttribute<Imf::IntAttribute>("frame").value(), 48);
    EXPECT_EQ(read.typedAttribute<Imf::FloatAttribute>("fps").value(), 24.0f);
    EXPECT_EQ(read.typedAttribute<Imf::V2fAttribute>("wind").value(), Imath::V2f(7.0f, -3.0f));
    EXPECT_EQ(read.typedAttribute<Imf::V3fAttribute>("minimum").value(), Imath::V3f(-1.0f, -2.0f, -3.0f));
    EXPECT_EQ(read.typedAttribute<Imf::StringAttribute>("aNameOfMoreThanThirtyOneCharacters").value(),
              "kept");
    EXPECT_EQ(Imf::wrapmodes(read), "periodic,periodic");
    EXPECT_EQ(read.compression(), Imf::NO_COMPRESSION);
    EXPECT_EQ(read.find("capDate"), read.end());

    const std::string patch = encode_scanline({}, one_channel(2, 2, samples));
    StringReader patch_reader(patch);
    EXPECT_EQ(Imf::wrapmodes(Imf::InputFile(patch_reader).header()), "clamp,clamp");
}

// Each level is the data that the caller gives, not derived from the level before. Sizes are halved and
// rounded down.
TEST(Exr, EveryMipLevelIsTheCallersOwn) {
    for (const auto& [width, height] : {std::pair{1, 1}, {200, 131}, {64, 64}, {3, 300}, {128, 1}}) {
        std::vector<std::vector<float>> data;
        std::vector<Image> levels;
        for (int l = 0; l < mip_level_count(width, height); ++l) {
            const auto [w, h] = mip_level_size(width, height, l);
            data.push_back(noise(w, h, static_cast<unsigned>(10 + l)));
            levels.push_back(one_channel(w, h, data.back()));
        }
        EXPECT_EQ(levels.back().width, 1);
        EXPECT_EQ(levels.back().height, 1);
        const std::string bytes = encode_mipmapped({}, levels);

        StringReader reader(bytes);
        Imf::TiledInputFile file(reader);
        EXPECT_TRUE(file.isComplete());
        EXPECT_EQ(file.levelMode(), Imf::MIPMAP_LEVELS);
        EXPECT_EQ(file.levelRoundingMode(), Imf::ROUND_DOWN);
        EXPECT_EQ(file.tileXSize(), 64u);
        EXPECT_EQ(file.tileYSize(), 64u);
        ASSERT_EQ(file.numLevels(), static_cast<int>(levels.size()));
        for (int l = 0; l < file.numLevels(); ++l) {
            const Image& level = levels[static_cast<std::size_t>(l)];
            const Plane plane = read_level(file, "Y", l);
            ASSERT_EQ(plane.width, level.width);
            ASSERT_EQ(plane.height, level.height);
            int wrong = 0;
            for (int j = 0; j < level.height; ++j)
                for (int i = 0; i < level.width; ++i)
                    wrong += plane.at(i, level.height - 1 - j) !=
                             bottom_up(data[static_cast<std::size_t>(l)], level.width, i, j);
            EXPECT_EQ(wrong, 0) << width << " x " << height << ", level " << l;
        }
    }
}

TEST(Exr, MipLevelsOfAnotherShapeAreRefused) {
    const std::vector<float> samples = noise(8, 8, 4);
    std::vector<Image> levels{one_channel(5, 4, samples), one_channel(2, 2, samples),
                              one_channel(1, 1, samples)};
    EXPECT_NO_THROW(encode_mipmapped({}, levels));
    EXPECT_THROW(encode_mipmapped({}, {}), std::invalid_argument);
    EXPECT_THROW(encode_mipmapped({}, std::span(levels).first(2)), std::invalid_argument);
    levels[1].width = 3;  // rounded up
    EXPECT_THROW(encode_mipmapped({}, levels), std::invalid_argument);
    levels[1].width = 2;
    levels[1].channels[0].type = PixelType::Half;
    EXPECT_THROW(encode_mipmapped({}, levels), std::invalid_argument);
    levels[1].channels[0].type = PixelType::Float;
    levels[2].channels[0].name = "Z";
    EXPECT_THROW(encode_mipmapped({}, levels), std::invalid_argument);
}

TEST(Exr, WhatCannotBeShownIsRefusedByChannelAndPixel) {
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                            -std::numeric_limits<float>::infinity()}) {
        std::vector<float> samples = noise(6, 4, 5);
        samples[6 * 1 + 5] = bad;
        for (const PixelType type : {PixelType::Float, PixelType::Half}) {
            const std::string message = refusal({}, one_channel(6, 4, samples, type));
            EXPECT_NE(message.find("channel 'Y', column 5, row 1 from the bottom"), std::string::npos)
                << message;
        }
        const Image level = one_channel(1, 1, samples);
        samples[0] = bad;
        EXPECT_THROW(encode_mipmapped({}, std::span(&level, 1)), std::invalid_argument);
    }
    // 65520 is the smallest that rounds to infinity.
    const std::vector<float> large{65520.0f};
    EXPECT_NE(refusal({}, one_channel(1, 1, large, PixelType::Half)).find("65504"), std::string::npos);
    EXPECT_EQ(read_scanlines(encode_scanline({}, one_channel(1, 1, large)), "Y").at(0, 0), 65520.0f);
}

TEST(Exr, MalformedArgumentsAreRefused) {
    const std::vector<float> samples = noise(2, 2, 6);
    const Image good = one_channel(2, 2, samples);
    EXPECT_NE(refusal({}, one_channel(0, 2, samples)).find("0 x 2"), std::string::npos);
    EXPECT_NE(refusal({}, {2, 2, {}}).find("channels"), std::string::npos);
    EXPECT_NE(refusal({}, {2, 2, {{.name = "Y"}}}).find("no data"), std::string::npos);
    EXPECT_NE(refusal({}, {2, 2, {good.channels[0], good.channels[0]}}).find("twice"), std::string::npos);
    EXPECT_NE(refusal({}, {2, 2, {{.name = "", .data = samples.data()}}}).find("name"), std::string::npos);
    EXPECT_NE(refusal({{{"", 1}}}, good).find("name"), std::string::npos);
    EXPECT_NE(refusal({{{std::string(256, 'a'), 1}}}, good).find("255"), std::string::npos);
    for (const char* own : {"channels", "wrapmodes", "dataWindow", "compression", "tiles", "type", "name"})
        EXPECT_NE(refusal({{{own, "x"}}}, good).find(own), std::string::npos);
    EXPECT_NE(refusal({{{"seed", 1}, {"seed", 2}}}, good).find("twice"), std::string::npos);
}

// No time stamp and no uninitialised memory: copies of the data elsewhere give the same bytes.
TEST(Exr, BytesDependOnTheArgumentsAlone) {
    const std::vector<float> a = noise(70, 33, 7), b = a;
    for (const PixelType type : {PixelType::Float, PixelType::Half}) {
        const Header header{.attributes = {{"z", 1}, {"a", "text"}}, .periodic = true, .compression = {}};
        Header turned = header;
        std::swap(turned.attributes[0], turned.attributes[1]);
        EXPECT_EQ(encode_scanline(header, one_channel(70, 33, a, type)),
                  encode_scanline(turned, one_channel(70, 33, b, type)));
    }
}

}  // namespace
}  // namespace pelagic::exr
