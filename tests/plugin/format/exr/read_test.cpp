// Reads pictures from this project's writers and from OpenEXR's, and rejects files that aren't pictures.
#include "plugin/format/exr/read.h"

#include <ImfChannelList.h>
#include <ImfDeepFrameBuffer.h>
#include <ImfDeepScanLineOutputFile.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfPartType.h>
#include <ImfTileDescription.h>
#include <ImfTiledOutputFile.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "plugin/format/exr/exr.h"

namespace pelagic::exr {
namespace {

constexpr int kWidth = 70, kHeight = 66;  // more than one tile in each direction

// Exact as halves: red counts columns, green rows from the top, blue is the low bits of their product.
std::array<float, 3> pixel(int x, int y) {
    return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(x * y % 64) / 8.0f};
}

class ReadRgb : public ::testing::Test {
  protected:
    void SetUp() override {
        const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
        folder_ = std::filesystem::path(::testing::TempDir()) / ("pelagic-" + std::string(test->name()));
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    std::filesystem::path path(const std::string& name) const { return folder_ / name; }

    std::filesystem::path written(const std::string& bytes) const {
        std::ofstream(path("sky.exr"), std::ios::binary) << bytes;
        return path("sky.exr");
    }

    std::string refusal(const std::filesystem::path& file) const {
        try {
            read_rgb(file);
        } catch (const std::runtime_error& error) {
            EXPECT_NE(std::string(error.what()).find(file.string()), std::string::npos) << error.what();
            EXPECT_NE(std::string(error.what()).find("accepted"), std::string::npos) << error.what();
            return error.what();
        }
        return "(not refused)";
    }

    std::filesystem::path folder_;
};

// Rows in order of rising y, as encoders expect them.
struct Planes {
    int width, height;
    std::array<std::vector<float>, 3> values;

    Planes(int w, int h) : width(w), height(h) {
        for (int j = h - 1; j >= 0; --j)
            for (int i = 0; i < w; ++i)
                for (std::size_t c = 0; c < 3; ++c) values[c].push_back(pixel(i, j)[c]);
    }
    Image image(PixelType type) const {
        Image out{width, height, {}};
        const std::array<const char*, 3> names{"R", "G", "B"};
        for (std::size_t c = 0; c < 3; ++c)
            out.channels.push_back({.name = names[c], .data = values[c].data(), .type = type});
        return out;
    }
};

// The levels of a picture with mip levels, and what they point into.
struct Levels {
    std::vector<Planes> planes;
    std::vector<Image> images;

    Levels() {
        for (int l = 0; l < mip_level_count(kWidth, kHeight); ++l) {
            const auto [width, height] = mip_level_size(kWidth, kHeight, l);
            planes.emplace_back(width, height);
        }
        for (const Planes& level : planes) images.push_back(level.image(PixelType::Half));
    }
};

void expect_pixels(const RgbPixels& read) {
    ASSERT_EQ(read.width, kWidth);
    ASSERT_EQ(read.height, kHeight);
    ASSERT_EQ(read.pixels.size(), static_cast<std::size_t>(kWidth * kHeight));
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
            ASSERT_EQ(read.pixels[static_cast<std::size_t>(y * kWidth + x)], pixel(x, y)) << x << " " << y;
}

TEST_F(ReadRgb, ScanLinesOfHalvesAndFloats) {
    const Planes planes(kWidth, kHeight);
    for (const PixelType type : {PixelType::Half, PixelType::Float})
        for (const Compression compression : {Compression::None, Compression::Piz}) {
            Header header;
            header.compression = compression;
            expect_pixels(read_rgb(written(encode_scanline(header, planes.image(type)))));
        }
}

TEST_F(ReadRgb, TilesOfTheFullPicture) {
    const Levels levels;
    expect_pixels(read_rgb(written(encode_mipmapped({}, levels.images))));
}

TEST_F(ReadRgb, GreyAloneAndOtherChannelsBeside) {
    const Planes planes(kWidth, kHeight);
    Image grey{kWidth, kHeight, {{.name = "Y", .data = planes.values[1].data(), .type = PixelType::Half}}};
    const RgbPixels read = read_rgb(written(encode_scanline({}, grey)));
    EXPECT_EQ(read.pixels[static_cast<std::size_t>(5 * kWidth + 3)],
              (std::array<float, 3>{5.0f, 5.0f, 5.0f}));
    Image more = planes.image(PixelType::Half);
    more.channels.push_back({.name = "A", .data = planes.values[0].data()});
    expect_pixels(read_rgb(written(encode_scanline({}, more))));
}

TEST_F(ReadRgb, ValuesAreHandedOverAsTheyAre) {
    // The caller decides which values it accepts: a NaN is returned unchanged.
    const float nan = std::numeric_limits<float>::quiet_NaN();
    std::vector<float> values{1.0f, nan, -2.0f, std::numeric_limits<float>::infinity()};
    Imf::Header header(2, 2);
    header.channels().insert("Y", Imf::Channel(Imf::FLOAT));
    {
        Imf::OutputFile file(path("odd.exr").c_str(), header);
        Imf::FrameBuffer buffer;
        buffer.insert("Y", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data()), 4, 8));
        file.setFrameBuffer(buffer);
        file.writePixels(2);
    }
    const RgbPixels read = read_rgb(path("odd.exr"));
    EXPECT_TRUE(std::isnan(read.pixels[1][0]));
    EXPECT_EQ(read.pixels[2][2], -2.0f);
    EXPECT_TRUE(std::isinf(read.pixels[3][1]));
}

TEST_F(ReadRgb, AWindowAwayFromTheOrigin) {
    const Imath::Box2i window({10, -7}, {12, -6});
    Imf::Header header(window, window);
    header.channels().insert("Y", Imf::Channel(Imf::FLOAT));
    std::vector<float> values{1.0f, 2.0f, 3.0f, 4.0f, 5.0f, 6.0f};
    {
        Imf::OutputFile file(path("away.exr").c_str(), header);
        Imf::FrameBuffer buffer;
        buffer.insert("Y", Imf::Slice::Make(Imf::FLOAT, values.data(), window));
        file.setFrameBuffer(buffer);
        file.writePixels(2);
    }
    const RgbPixels read = read_rgb(path("away.exr"));
    ASSERT_EQ(read.pixels.size(), 6u);
    for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(read.pixels[i][0], values[i]);
}

TEST_F(ReadRgb, RefusesWhatIsNoPicture) {
    EXPECT_NE(refusal(path("missing.exr")).find("can't be read"), std::string::npos);
    EXPECT_NE(refusal(written("no picture at all")).find("can't be read"), std::string::npos);
    ASSERT_EQ(mkfifo(path("pipe.exr").c_str(), 0600), 0);
    EXPECT_NE(refusal(path("pipe.exr")).find("is a pipe or a folder"), std::string::npos);
    EXPECT_NE(refusal(path("")).find("is a pipe or a folder"), std::string::npos);
    const Planes planes(kWidth, kHeight);
    const std::string whole = encode_scanline({}, planes.image(PixelType::Half));
    EXPECT_NE(refusal(written(whole.substr(0, whole.size() / 2))).find("is cut short"), std::string::npos);

    Image named = planes.image(PixelType::Half);
    named.channels[0].name = "red";
    EXPECT_NE(refusal(written(encode_scanline({}, named))).find("B, G, red"), std::string::npos);
    Image chroma = planes.image(PixelType::Half);
    chroma.channels[0].name = "Y", chroma.channels[1].name = "RY", chroma.channels[2].name = "BY";
    EXPECT_NE(refusal(written(encode_scanline({}, chroma))).find("BY, RY, Y"), std::string::npos);
}

// A small file may ask for gigabytes: whoever reads a row of such tiles holds the whole picture.
TEST_F(ReadRgb, RefusesTilesAsHighAsALargePicture) {
    constexpr int kWide = 20000, kHigh = 1000;
    const auto written_in = [&](int tile_rows) {
        Imf::Header header(kWide, kHigh);
        header.channels().insert("Y", Imf::Channel(Imf::HALF));
        header.setTileDescription(Imf::TileDescription(kWide, tile_rows, Imf::ONE_LEVEL));
        const std::vector<std::uint16_t> black(std::size_t{kWide} * kHigh);
        Imf::FrameBuffer buffer;
        buffer.insert("Y", Imf::Slice::Make(Imf::HALF, black.data(), Imath::V2i(0), kWide, kHigh));
        Imf::TiledOutputFile file(path("tiles.exr").c_str(), header);
        file.setFrameBuffer(buffer);
        file.writeTiles(0, 0, 0, file.numYTiles() - 1);
        return path("tiles.exr");
    };
    EXPECT_NE(refusal(written_in(kHigh)).find("tiles that are 1000 pixels high"), std::string::npos);
    EXPECT_EQ(RgbFile(written_in(256)).rows_in_piece(), 256);
}

TEST_F(ReadRgb, RowsInAnyPieces) {
    for (const bool tiled : {false, true}) {
        Header header;
        header.compression = Compression::Piz;  // chunks of 32 rows
        const Planes planes(kWidth, kHeight);
        const Levels levels;
        const RgbFile file(written(tiled ? encode_mipmapped(header, levels.images)
                                         : encode_scanline(header, planes.image(PixelType::Half))));
        EXPECT_EQ(file.rows_in_piece(), tiled ? 64 : 32);
        for (const auto& [first, count] : {std::pair(0, 1), {31, 2}, {5, 60}, {65, 1}, {66, 0}}) {
            std::vector<std::array<float, 3>> rows(static_cast<std::size_t>(count) * kWidth);
            file.read(first, {rows.empty() ? nullptr : rows.data()->data(), 3 * rows.size()});
            for (int y = 0; y < count; ++y)
                for (int x = 0; x < kWidth; ++x)
                    ASSERT_EQ(rows[static_cast<std::size_t>(y * kWidth + x)], pixel(x, first + y));
        }
        std::vector<float> beyond(3 * kWidth);
        EXPECT_THROW(file.read(kHeight, beyond), std::invalid_argument);
        EXPECT_THROW(file.read(0, std::span(beyond).first(5)), std::invalid_argument);
    }
}

// Without its pixels being read: wherever a file ends too soon.
TEST_F(ReadRgb, ACutFileIsRefusedWhenItIsLookedAt) {
    const Planes planes(kWidth, kHeight);
    const Levels levels;
    Header header;
    header.compression = Compression::Zip;
    const std::string lines = encode_scanline(header, planes.image(PixelType::Half));
    for (std::size_t bytes = 0; bytes < lines.size(); bytes += bytes < 1000 ? 1 : 97)
        EXPECT_THROW(RgbFile(written(lines.substr(0, bytes))), ReadError) << bytes;
    EXPECT_THROW(RgbFile(written(lines.substr(0, lines.size() - 1))), ReadError);
    EXPECT_NO_THROW(RgbFile(written(lines)));
    // Of tiles with mip levels the first level has to be there.
    const std::string tiles = encode_mipmapped(header, levels.images);
    for (std::size_t bytes = 0; bytes < tiles.size() / 2; bytes += 97)
        EXPECT_THROW(RgbFile(written(tiles.substr(0, bytes))), ReadError) << bytes;
}

TEST_F(ReadRgb, RefusesIntegersCropsAndDeepPixels) {
    const auto empty_file = [&](const Imf::Header& header) {
        // No rows are written: the header alone is reason to reject the file.
        Imf::OutputFile(path("header.exr").c_str(), header);
        return path("header.exr");
    };
    Imf::Header integers(4, 2);
    integers.channels().insert("Y", Imf::Channel(Imf::UINT));
    EXPECT_NE(refusal(empty_file(integers)).find("integers"), std::string::npos);
    Imf::Header crop({{0, 0}, {7, 3}}, {{2, 0}, {5, 3}});
    crop.channels().insert("Y", Imf::Channel(Imf::HALF));
    EXPECT_NE(refusal(empty_file(crop)).find("only a part"), std::string::npos);
    Imf::Header sparse(4, 2);
    sparse.channels().insert("Y", Imf::Channel(Imf::HALF, 2, 2));
    EXPECT_NE(refusal(empty_file(sparse)).find("fewer samples"), std::string::npos);
    Imf::Header huge(40000, 1);
    huge.channels().insert("Y", Imf::Channel(Imf::HALF));
    EXPECT_NE(refusal(empty_file(huge)).find("40000 x 1"), std::string::npos);

    Imf::Header deep(2, 1);
    deep.channels().insert("R", Imf::Channel(Imf::HALF));
    deep.setType(Imf::DEEPSCANLINE);
    deep.compression() = Imf::ZIPS_COMPRESSION;
    Imf::DeepScanLineOutputFile(path("deep.exr").c_str(), deep);
    EXPECT_NE(refusal(path("deep.exr")).find("deep"), std::string::npos);
}

}  // namespace
}  // namespace pelagic::exr
