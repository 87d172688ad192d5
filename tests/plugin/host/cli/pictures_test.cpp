// pelagic render and pelagic preview --offscreen as users run them: the files written, what is rejected, and
// that no file is ever incomplete. The contents of pictures are tested with their libraries.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStandardAttributes.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <limits>
#include <regex>
#include <set>
#include <thread>
#include <vector>

#include "plugin/render/layers.h"
#include "tests/plugin/host/cli/program.h"

namespace pelagic::test {
namespace {

namespace fs = std::filesystem;

// A shot whose pictures take a moment only.
std::string small_shot(const std::string& quality = "draft") {
    return "[shot]\nname = \"small\"\nframes = [1, 4]\n"
           "[waves]\ncascades = [ { size_m = 100.0, resolution = 32 } ]\n"
           "[camera]\nresolution = [48, 27]\n"
           "[quality]\nlevel = \"" +
           quality + "\"\n";
}

// Width and height of a PNG.
std::pair<int, int> png_size(const fs::path& file) {
    const std::string bytes = read_file(file);
    const auto number = [&](std::size_t at) {
        int value = 0;
        for (std::size_t i = 0; i < 4; ++i)
            value = value * 256 + static_cast<unsigned char>(bytes.at(at + i));
        return value;
    };
    return {number(16), number(20)};
}

std::pair<int, int> exr_size(const fs::path& file) {
    const Imf::InputFile exr(file.c_str());
    const auto window = exr.header().dataWindow();
    return {window.max.x - window.min.x + 1, window.max.y - window.min.y + 1};
}

std::set<std::string> exr_channels(const fs::path& file) {
    const Imf::InputFile exr(file.c_str());
    std::set<std::string> names;
    for (auto c = exr.header().channels().begin(); c != exr.header().channels().end(); ++c)
        names.insert(c.name());
    return names;
}

// The picture, and a layer for each term.
const std::set<std::string> kChannels{"R",      "G",      "B",      "sun.R", "sun.G", "sun.B",
                                      "sky.R",  "sky.G",  "sky.B",  "sea.R", "sea.G", "sea.B",
                                      "foam.R", "foam.G", "foam.B", "air.R", "air.G", "air.B"};

std::array<int, 4> data_window(const fs::path& file) {
    const auto window = Imf::InputFile(file.c_str()).header().dataWindow();
    return {window.min.x, window.min.y, window.max.x, window.max.y};
}

// The largest value in a layer; 0 means black.
float brightest(const fs::path& file, const std::string& layer) {
    Imf::InputFile exr(file.c_str());
    const auto [width, height] = exr_size(file);
    std::vector<float> values(static_cast<std::size_t>(width) * height);
    Imf::FrameBuffer buffer;
    buffer.insert(layer + ".G", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data()), sizeof(float),
                                           sizeof(float) * static_cast<std::size_t>(width)));
    exr.setFrameBuffer(buffer);
    exr.readPixels(0, height - 1);
    return *std::max_element(values.begin(), values.end());
}

class Pictures : public ::testing::Test {
  protected:
    void SetUp() override { write_file(folder() / "small.toml", small_shot()); }
    const fs::path& folder() const { return folder_.path(); }
    Ended cli(std::vector<std::string> arguments) const {
        return run({.arguments = std::move(arguments), .folder = folder()});
    }
    std::vector<std::string> files_in(const std::string& out) const {
        std::vector<std::string> names;
        for (const auto& [path, bytes] : files_below(folder() / out)) names.push_back(path);
        return names;
    }
    // Expects rejection with this status and all of these words, without any new file or folder.
    void refused(const std::vector<std::string>& arguments, int status,
                 const std::vector<std::string>& says) {
        if (arguments.at(0) == "preview" && !kHasPreview) return;
        const auto entries = [&] {
            return std::distance(fs::directory_iterator(folder()), fs::directory_iterator());
        };
        const auto before = entries();
        const Ended ended = cli(arguments);
        const std::string line = ended.err + "(" + arguments.at(0) + " … " + arguments.back() + ")";
        EXPECT_EQ(ended.status, status) << line;
        EXPECT_EQ(ended.out, "") << line;
        for (const std::string& part : says) EXPECT_TRUE(has(ended.err, part)) << part << "\n" << line;
        EXPECT_EQ(entries(), before) << "something was begun: " << line;
    }

  private:
    TempFolder folder_;
};

TEST_F(Pictures, RenderLeavesAnExrWithLayersAndAPngForEachFrame) {
    const Ended ended = cli({"render", "small.toml", "--frames", "1-4x2"});
    ASSERT_EQ(ended.status, 0) << ended.err;
    EXPECT_EQ(files_in("small"), (std::vector<std::string>{"small.0001.exr", "small.0001.png",
                                                           "small.0003.exr", "small.0003.png"}));
    EXPECT_EQ(torn_files(folder() / "small"), "");
    EXPECT_EQ(exr_channels(folder() / "small/small.0003.exr"), kChannels);
    EXPECT_EQ(exr_size(folder() / "small/small.0003.exr"), std::pair(48, 27));
    EXPECT_EQ(png_size(folder() / "small/small.0003.png"), std::pair(48, 27));
    EXPECT_TRUE(has(ended.out, "small/small.0001.exr")) << ended.out;
    EXPECT_TRUE(has(ended.out, "2 frames rendered")) << ended.out;
}

// A share is of the width and of the height; a region's numbers are those of the data window, but for its last pixel. The PNG is what
// of it is in the picture. Neither counts as the other, nor as the picture without.
TEST_F(Pictures, OverscanAndRegionsAreInTheDataWindow) {
    const auto rendered = [&](std::vector<std::string> options) {
        std::vector<std::string> arguments{"render", "small.toml", "--frames", "2", "--out", "out"};
        arguments.insert(arguments.end(), options.begin(), options.end());
        const Ended ended = cli(arguments);
        EXPECT_EQ(ended.status, 0) << ended.err;
        EXPECT_TRUE(has(ended.out, "1 frame rendered")) << ended.out;
        return data_window(folder() / "out/small.0002.exr");
    };
    const auto png = [&] { return png_size(folder() / "out/small.0002.png"); };
    using Corners = std::array<int, 4>;
    EXPECT_EQ(rendered({}), (Corners{0, 0, 47, 26}));
    EXPECT_EQ(rendered({"--overscan", "10%"}), (Corners{-5, -3, 52, 29}));
    EXPECT_EQ(png(), std::pair(48, 27));
    EXPECT_EQ(rendered({"--overscan", "4"}), (Corners{-4, -4, 51, 30}));
    EXPECT_EQ(rendered({"--overscan", "4", "--region=-2,3,20,31"}), (Corners{-2, 3, 19, 30}));
    EXPECT_EQ(png(), std::pair(20, 24));
    EXPECT_EQ(rendered({"--region", "7,3,20,15"}), (Corners{7, 3, 19, 14}));
    EXPECT_EQ(png(), std::pair(13, 12));
}

// Every other layer of the table, the others, none and all: their channels and no others beside the picture's.
// It has the records, the checks and the threads of the other files.
TEST_F(Pictures, DeepOnesLieBesideTheOthers) {
    refused({"render", "small.toml", "--deep"}, 2, {"--deep without --alpha"});
    refused({"render", "small.toml", "--deep", "--alpha", "--shutter", "0.5"}, 2,
            {"--deep of a blurred picture"});
    const auto render = [&](const std::string& out, const std::string& threads) {
        return cli({"render", "small.toml", "--frames", "2", "--alpha", "--deep", "--out", out, "--threads",
                    threads});
    };
    ASSERT_EQ(cli({"render", "small.toml", "--frames", "2", "--alpha", "--out", "out"}).status, 0);
    const std::string exr = read_file(folder() / "out/small.0002.exr");
    EXPECT_FALSE(fs::exists(folder() / "out/small.deep.0002.exr"));
    ASSERT_EQ(render("out", "2").status, 0);
    const fs::path file = folder() / "out/small.deep.0002.exr";
    const std::string deep = read_file(file);
    EXPECT_FALSE(deep.empty());
    EXPECT_EQ(read_file(folder() / "out/small.0002.exr"), exr);
    ASSERT_EQ(render("one", "1").status, 0);
    EXPECT_EQ(read_file(folder() / "one/small.deep.0002.exr"), deep);
    EXPECT_TRUE(has(render("out", "2").out, "kept"));
    EXPECT_EQ(cli({"verify", "out"}).status, 0);
    std::string damaged = deep;
    damaged[damaged.size() / 2] ^= 1;
    write_file(file, damaged);
    const Ended verified = cli({"verify", "out"});
    EXPECT_EQ(verified.status, 3);
    EXPECT_TRUE(has(verified.out + verified.err, "small.deep.0002.exr")) << verified.out << verified.err;
    write_file(file, deep.substr(0, deep.size() / 2));
    ASSERT_EQ(render("out", "2").status, 0);
    EXPECT_EQ(read_file(file), deep);
}

TEST_F(Pictures, RenderWritesTheLayersThatAreAskedFor) {
    const auto channels = [&](const std::string& layers, std::vector<std::string> more = {}) {
        std::vector<std::string> arguments{"render", "small.toml", "--frames", "2",        "--size",
                                           "12x8",   "--out",      "asked",    "--layers", layers};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const Ended ended = cli(arguments);
        EXPECT_EQ(ended.status, 0) << layers << ended.err;
        return exr_channels(folder() / "asked/small.0002.exr");
    };
    const std::set<std::string> picture{"R", "G", "B"};
    std::set<std::string> everything = picture;
    for (const std::size_t first : {std::size_t{0}, std::size_t{1}}) {
        std::string names;
        std::set<std::string> expected = picture;
        for (std::size_t i = first; i < kPictureLayerCount; i += 2) {
            const PictureLayerRow& row = kPictureLayers[i];
            names += (names.empty() ? "" : ",") + std::string(row.name);
            if (!row.of_objects) expected.insert(row.channels.begin(), row.channels.begin() + row.components);
        }
        EXPECT_EQ(channels(names), expected) << names;
        everything.insert(expected.begin(), expected.end());
    }
    EXPECT_EQ(channels("none"), picture);
    everything.insert("A");
    EXPECT_EQ(channels("all", {"--alpha", "--shutter", "0.5"}), everything);
}

// The primaries, and in daylight the luminance of (1, 1, 1).
bool says_what_its_radiance_is(const fs::path& file) {
    const Imf::InputFile exr(file.c_str());
    return Imf::hasChromaticities(exr.header()) && Imf::hasWhiteLuminance(exr.header()) &&
           Imf::whiteLuminance(exr.header()) == 1000.0f;
}

TEST_F(Pictures, RenderSaysWhatItsRadianceIs) {
    ASSERT_EQ(cli({"render", "small.toml", "--frames", "2", "--size", "12x8", "--layers", "none"}).status, 0);
    EXPECT_TRUE(says_what_its_radiance_is(folder() / "small/small.0002.exr"));
}

TEST_F(Pictures, PreviewDrawsAnExrThatSaysWhatItsRadianceIs) {
    if (!kHasPreview) return;
    ASSERT_EQ(cli({"preview", "small.toml", "--offscreen", "drawn.exr", "--size", "12x8"}).status, 0);
    EXPECT_TRUE(says_what_its_radiance_is(folder() / "drawn.exr"));
}

// An open shutter blurs, alpha leaves the sky out, and neither changes what the sea is made of.
TEST_F(Pictures, RenderTakesShutterAndAlpha) {
    const auto rendered = [&](std::vector<std::string> more) {
        std::vector<std::string> arguments{"render", "small.toml", "--frames", "2",
                                           "--size", "24x14",      "--out",    "as"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const Ended ended = cli(arguments);
        EXPECT_EQ(ended.status, 0) << ended.err;
        return read_file(folder() / "as/small.0002.png");
    };
    const std::string plain = rendered({});
    EXPECT_EQ(rendered({"--shutter", "0"}), plain);
    EXPECT_NE(rendered({"--shutter", "0.5"}), plain);
    const std::string longest = rendered({"--shutter", "4"});
    EXPECT_NE(longest, plain);
    // A PNG's colour type: 2 without alpha, 6 with it.
    constexpr std::size_t kColourType = 25;
    EXPECT_EQ(plain.at(kColourType), 2);
    EXPECT_EQ(rendered({"--alpha"}).at(kColourType), 6);
    const fs::path file = folder() / "as/small.0002.exr";
    EXPECT_TRUE(exr_channels(file).count("A"));
    EXPECT_FALSE(rendered({}) == longest || exr_channels(file).count("A")) << "made again as asked";
}

TEST_F(Pictures, RenderRefusesLayersAndShuttersThatAreNone) {
    std::vector<std::string> names{"none", "all"};
    for (const PictureLayerRow& row : kPictureLayers) names.emplace_back(row.name);
    for (const char* wrong : {"", ",", "depth,", "Depth", "z", "depth;normal", "none,depth"})
        refused({"render", "small.toml", "--layers", wrong}, 2, names);
    for (const char* wrong : {"-0.1", "4.01", "nan", "inf", "much"})
        refused({"render", "small.toml", "--shutter", wrong}, 2, {"shutter"});
    refused({"render", "small.toml", "--alpha", "0.5"}, 2, {"0.5"});
}

TEST_F(Pictures, RenderTakesSizeSamplesTermsAndExposure) {
    ASSERT_EQ(cli({"render", "small.toml", "--frames", "2", "--out", "deep/as", "--size", "20x11"}).status,
              0);
    EXPECT_EQ(files_in("deep/as"), (std::vector<std::string>{"small.0002.exr", "small.0002.png"}));
    EXPECT_EQ(exr_size(folder() / "deep/as/small.0002.exr"), std::pair(20, 11));
    EXPECT_GT(brightest(folder() / "deep/as/small.0002.exr", "sun"), 0.0f);

    ASSERT_EQ(cli({"render", "small.toml", "--frames", "2", "--out", "sea", "--size", "20x11", "--terms",
                   "sea", "--samples", "2", "--exposure", "1"})
                  .status,
              0);
    const fs::path sea = folder() / "sea/small.0002.exr";
    EXPECT_EQ(exr_channels(sea), kChannels) << "layers that are off are black, not missing";
    EXPECT_EQ(exr_size(sea), std::pair(20, 11));
    EXPECT_GT(brightest(sea, "sea"), 0.0f);
    for (const char* off : {"sun", "sky", "foam", "air"}) EXPECT_EQ(brightest(sea, off), 0.0f) << off;

    // The exposure applies to the PNG; the radiance is unchanged.
    ASSERT_EQ(cli({"render", "small.toml", "--frames", "2", "--out", "dark", "--size", "20x11", "--terms",
                   "sea", "--samples", "2", "--exposure", "-1"})
                  .status,
              0);
    EXPECT_EQ(brightest(folder() / "dark/small.0002.exr", "sea"), brightest(sea, "sea"));
    EXPECT_NE(read_file(folder() / "dark/small.0002.png"), read_file(folder() / "sea/small.0002.png"));
}

TEST_F(Pictures, FramesAreTheSameAloneAndOnAnyNumberOfThreads) {
    ASSERT_EQ(cli({"render", "small.toml", "--out", "all", "--threads", "2"}).status, 0);
    ASSERT_EQ(cli({"render", "small.toml", "--out", "one", "--threads", "1", "--frames", "3"}).status, 0);
    EXPECT_EQ(files_in("all").size(), 8u);
    EXPECT_EQ(files_in("one"), (std::vector<std::string>{"small.0003.exr", "small.0003.png"}));
    for (const std::string& file : files_in("one"))
        EXPECT_EQ(read_file(folder() / "all" / file), read_file(folder() / "one" / file)) << file;
}

TEST_F(Pictures, RenderRefusesWhatItCannotDoBeforeItBegins) {
    for (const char* size : {"640", "640x", "x360", "0x360", "640x-1", "640x360x2", "640 x 360", "",
                             "65537x4", "99999999999x4"}) {
        refused({"render", "small.toml", std::string("--size=") + size}, 2, {"--size"});
        refused({"preview", "small.toml", "--offscreen", "a.png", std::string("--size=") + size}, 2,
                {"--size"});
    }
    refused({"render", "small.toml", "--size", "640"}, 2,
            {"640 is no size", "like 1280x720", "render --help"});
    for (const char* terms : {"", "sun,", "moon", "sun sea", "Sun"})
        refused({"render", "small.toml", "--terms", terms}, 2,
                {std::string("terms \"") + terms + "\"", "accepted: any of sun, sky, sea, foam"});
    for (const char* samples : {"0", "17", "-1"})
        refused({"render", "small.toml", std::string("--samples=") + samples}, 2,
                {std::string("samples ") + samples, "accepted: 1 to 16"});
    for (const char* samples : {"1.5", "many"})
        refused({"render", "small.toml", std::string("--samples=") + samples}, 2, {"--samples"});
    refused({"render", "small.toml", "--sky-quality", "ten"}, 2,
            {"\"ten\"", "accepted: one, nine, integral"});
    for (const char* overscan : {"51%", "-1", "1.5", "49", "10 %", "nan%"})
        refused({"render", "small.toml", std::string("--overscan=") + overscan}, 2,
                {"overscan", "accepted: "});
    refused({"render", "small.toml", "--overscan", "14"}, 2, {"overscan of 14,14", "24,13, is accepted"});
    for (const char* region : {"0,0,9", "0,0,9,9,9", "0,0,49,27", "-1,0,9,9", "9,9,9,12", "a,b,c,d"})
        refused({"render", "small.toml", std::string("--region=") + region}, 2, {"region", "accepted"});
    for (const char* window : {"--overscan", "--region"})
        refused({"render", "small.toml", std::string(window) + '='}, 2, {window, "missing"});
    for (const char* stops : {"31", "-31", "nan", "inf"})
        refused({"render", "small.toml", std::string("--exposure=") + stops}, 2, {"exposure", "-30 to 30"});
    for (const char* frames : {"0", "5", "3-1", "x"})
        refused({"render", "small.toml", "--frames", frames}, 2, {std::string("\"") + frames + "\"", "1-4"});
    refused({"render", "small.toml", "--out", ""}, 2, {"--out", "accepted: "});
    refused({"render", "small.toml", "--threads", "0"}, 2, {"--threads"});
    refused({"render"}, 2, {"SHOT.toml is required", "pelagic render --help"});
    refused({"render", "small.toml", "--sample", "2"}, 2, {"'--sample' is not an option", "--samples?"});
    // 65536 · 16 samples on a side exceed the limit.
    refused({"render", "small.toml", "--size", "65536x1", "--samples", "16"}, 2,
            {"small.toml: ", "fewer samples"});
    refused({"render", "missing.toml"}, 2, {"missing.toml: the shot file does not exist"});
}

// A lat-long picture of halves, grey; `wrong` is the value of one pixel of the upper half.
void write_sky(const fs::path& file, float wrong = 1.0f) {
    constexpr int kWidth = 64, kHeight = 32;
    std::vector<float> values(kWidth * kHeight, 1.0f);
    values[3 * kWidth + 5] = wrong;
    Imf::Header header(kWidth, kHeight);
    header.channels().insert("Y", Imf::Channel(Imf::FLOAT));
    Imf::OutputFile out(file.c_str(), header);
    Imf::FrameBuffer buffer;
    buffer.insert("Y", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.data()), sizeof(float),
                                  sizeof(float) * kWidth));
    out.setFrameBuffer(buffer);
    out.writePixels(kHeight);
}

TEST_F(Pictures, ASkyThatIsNoneIsRefusedByEveryVerbWithItsPlace) {
    write_sky(folder() / "whole.exr");
    const std::string whole = read_file(folder() / "whole.exr");
    const std::vector<std::pair<std::string, std::string>> skies{
        {"no picture at all", "can't be read as an OpenEXR picture"},
        {"", "can't be read as an OpenEXR picture"},
        {whole.substr(0, whole.size() - 1), "is cut short"},
        {whole.substr(0, 200), "can't be read as an OpenEXR picture"},
    };
    const std::string shot = small_shot() + "[light]\nsky = \"torn.exr\"\n";
    write_file(folder() / "small.toml", shot);
    const auto line = std::count(shot.begin(), shot.end(), '\n');
    const std::string place = "small.toml:" + std::to_string(line) + ":7: light.sky = \"torn.exr\": ";
    for (const auto& [bytes, problem] : skies) {
        write_file(folder() / "torn.exr", bytes);
        for (const std::vector<std::string>& verb :
             std::vector<std::vector<std::string>>{{"validate", "small.toml"},
                                                   {"explain", "small.toml"},
                                                   {"bake", "small.toml", "--out", "out"},
                                                   {"render", "small.toml", "--out", "out"},
                                                   {"preview", "small.toml", "--offscreen", "new/a.png"}})
            refused(verb, 2, {place + problem, "; accepted: a whole file"});
    }
    write_file(folder() / "torn.exr", whole);
    EXPECT_EQ(cli({"validate", "small.toml"}).status, 0);
}

// What only the pixels tell is refused when they are read, before any other work.
TEST_F(Pictures, ASkyThatIsNoRadianceIsRefusedBeforeAnythingIsWritten) {
    write_file(folder() / "small.toml", small_shot() + "[light]\nsky = \"odd.exr\"\n");
    for (const float wrong : {std::numeric_limits<float>::quiet_NaN(), -1.0f}) {
        write_sky(folder() / "odd.exr", wrong);
        const std::vector<std::string> says{
            "light.sky = \"odd.exr\": R of the pixel in column 5, row 3 from the top is ",
            "; accepted: radiances from 0 to 1e30"};
        refused({"render", "small.toml", "--out", "out"}, 2, says);
        refused({"preview", "small.toml", "--offscreen", "new/a.png"}, 2, says);
    }
}

// The preview's option for its file is --offscreen; it has none for a folder.
TEST_F(Pictures, WhatAPreviewCantWriteIsAnsweredWithoutAnotherVerbsOption) {
    write_file(folder() / "small.toml", small_shot());
    write_file(folder() / "file", "");
    const Ended ended = cli({"preview", "small.toml", "--offscreen", "file/a.png"});
    EXPECT_EQ(ended.status, 2);
    EXPECT_NE(ended.err.find("a part of the path is a file"), std::string::npos) << ended.err;
    EXPECT_EQ(ended.err.find("--out"), std::string::npos) << ended.err;
}

// Unix takes any bytes for a name. Nothing written in text needs to name these folders, or it escapes them.
TEST_F(Pictures, FoldersWhoseNamesAreNotUtf8) {
    const std::string odd = "caf\xe9\x80\n";
    fs::create_directories(folder() / odd / odd);
    write_sky(folder() / odd / odd / "sky.exr");
    const std::string shot =
        "[surface]\nresolution = 8\n[output]\nmaps = [\"displacement\", \"whitecaps\"]\n"
        "map_resolution = 8\n[light]\nsky = \"sky.exr\"\n";
    write_file(folder() / odd / odd / "small.toml", small_shot() + shot);
    // The shot's folder; with the working folder above it, in it, and elsewhere.
    int number = 0;
    for (const auto& [from, file] :
         std::vector<std::pair<fs::path, std::string>>{{folder(), odd + '/' + odd + "/small.toml"},
                                                       {folder() / odd, odd + "/small.toml"},
                                                       {folder() / odd / odd, "small.toml"},
                                                       {"/", (folder() / odd / odd / "small.toml").string()}})
        for (const char* verb : {"bake", "render"}) {
            const std::string out = (folder() / odd / ("out\xff" + std::to_string(++number))).string();
            const Ended ended =
                run({.arguments = {verb, file, "--frames", "1-2", "--out", out}, .folder = from});
            EXPECT_EQ(ended.status, 0) << ended.err;
            EXPECT_EQ(torn_files(out), "");
            EXPECT_EQ(leftovers(out), std::vector<std::string>());
            const Ended again =
                run({.arguments = {verb, file, "--frames", "1-2", "--out", out}, .folder = from});
            EXPECT_EQ(again.status, 0) << again.err;
            EXPECT_TRUE(has(again.out, "2 kept as they were")) << again.out;
        }
    for (const char* verb : {"validate", "explain"})
        EXPECT_EQ(run({.arguments = {verb, "small.toml"}, .folder = folder() / odd / odd}).status, 0);
    const Ended preview = run({.arguments = {"preview", "small.toml", "--offscreen", odd + "/a.png"},
                               .folder = folder() / odd / odd});
    EXPECT_EQ(preview.status, 0) << preview.err;
}

TEST_F(Pictures, PreviewRefusesWhatItCannotDoBeforeItBegins) {
    for (const char* file : {"a.jpg", "a", ".png", "a.png/", "", "a.PNG"})
        refused({"preview", "small.toml", "--offscreen", file}, 2,
                {std::string("--offscreen \"") + file + "\"", ".png, .exr", "pelagic preview --help"});
    refused({"preview", "small.toml", "--screenshot", "a.exr"}, 2, {"--screenshot \"a.exr\"", ".png"});
    for (const char* frame : {"0", "5"})
        refused({"preview", "small.toml", "--offscreen", "a.png", "--frame", frame}, 2,
                {std::string("\"") + frame + "\"", "1-4"});
    refused({"preview", "small.toml", "--offscreen", "a.png", "--frame", "1.5"}, 2, {"--frame"});
    refused({"preview", "small.toml", "--offscreen", "a.png", "--quality", "best"}, 2,
            {"\"best\"", "accepted: draft, preview, final, reference"});
    refused({"preview", "small.toml", "--offscreen", "a.png", "--screenshot", "b.png"}, 2,
            {"--screenshot", "--offscreen"});
    refused({"preview", "small.toml", "--scale", "3"}, 2, {"--scale"});
    refused({"preview", "small.toml", "--after", "3"}, 2, {"--after", "--screenshot"});
    refused({"preview"}, 2, {"SHOT.toml is required", "pelagic preview --help"});
}

TEST_F(Pictures, PreviewDrawsWithoutADisplay) {
    if (!kHasPreview) GTEST_SKIP() << "built without the preview";
    const Ended png = cli({"preview", "small.toml", "--offscreen", "new/a.png", "--frame", "3"});
    ASSERT_EQ(png.status, 0) << png.err;
    const std::regex progress("((building the sea|the foam's past): [0-9]+ %\n)*");
    EXPECT_TRUE(std::regex_match(png.err, progress)) << png.err;
    EXPECT_TRUE(has(png.out, "picture: new/a.png\ndrawn by ")) << png.out;
    EXPECT_EQ(png_size(folder() / "new/a.png"), std::pair(48, 27));
    const Ended exr = cli({"preview", "small.toml", "--offscreen", "b.exr", "--size", "30x20"});
    ASSERT_EQ(exr.status, 0) << exr.err;
    EXPECT_EQ(exr_size(folder() / "b.exr"), std::pair(30, 20));
    EXPECT_EQ(exr_channels(folder() / "b.exr"), kChannels);
    for (const char* layer : {"sun", "sky", "sea"})
        EXPECT_GT(brightest(folder() / "b.exr", layer), 0.0f) << layer;
    EXPECT_EQ(torn_files(folder()), "");
    EXPECT_TRUE(leftovers(folder()).empty());
}

TEST_F(Pictures, PreviewSaysThatItsReferenceIsOfSinglePrecision) {
    if (!kHasPreview) GTEST_SKIP() << "built without the preview";
    const Ended ended =
        cli({"preview", "small.toml", "--offscreen", "a.png", "--size", "8x6", "--quality", "reference"});
    ASSERT_EQ(ended.status, 0) << ended.err;
    EXPECT_TRUE(has(ended.err, "single precision")) << ended.err;
    EXPECT_TRUE(has(ended.err, "pelagic render")) << ended.err;
}

// A file is in the way, which stops even root.
TEST_F(Pictures, AFolderThatCantBeMadeIsSaid) {
    write_file(folder() / "in-the-way", "a file");
    for (const std::vector<std::string>& arguments :
         {std::vector<std::string>{"render", "small.toml", "--frames", "1", "--out", "in-the-way/out"},
          std::vector<std::string>{"render", "small.toml", "--frames", "1", "--out", "in-the-way"},
          std::vector<std::string>{"preview", "small.toml", "--offscreen", "in-the-way/a.png"}}) {
        if (arguments.front() == "preview" && !kHasPreview) continue;
        const Ended ended = cli(arguments);
        EXPECT_EQ(ended.status, 2) << ended.err;
        EXPECT_EQ(ended.out, "");
        EXPECT_TRUE(has(ended.err, "in-the-way")) << ended.err;
    }
    EXPECT_EQ(read_file(folder() / "in-the-way"), "a file");
    EXPECT_EQ(files_below(folder()).size(), 2u);
}

TEST_F(Pictures, AFullDiskIsSaidAndWhatIsThereIsWhole) {
    fs::create_directory(folder() / "disk");
    const std::string problem = mount_disk({.folder = folder() / "disk", .size = "64k"});
    if (!problem.empty()) GTEST_SKIP() << "this machine lets us mount nothing: " << problem;
    const Ended ended = cli({"render", "small.toml", "--out", "disk", "--size", "96x54"});
    EXPECT_EQ(ended.status, 75);
    EXPECT_TRUE(has(ended.err, "disk is full") || has(ended.err, "space")) << ended.err;
    EXPECT_EQ(torn_files(folder() / "disk"), "");
    EXPECT_TRUE(leftovers(folder() / "disk").empty());
}

// Many frames, interrupted when the first is complete.
TEST_F(Pictures, AnInterruptedRenderLeavesWholeFilesAndSaysHowMany) {
    std::string text = small_shot();
    text.replace(text.find("[1, 4]"), 6, "[1, 9000]");
    write_file(folder() / "small.toml", text);
    Running render({.arguments = {"render", "small.toml", "--out", "out"}, .folder = folder()});
    while (!fs::exists(folder() / "out/small.0001.exr")) {
        ASSERT_FALSE(render.has_ended()) << render.messages();
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    render.send(SIGINT);
    const Ended ended = render.wait();
    EXPECT_EQ(ended.status, 128 + SIGINT) << ended.err;
    EXPECT_FALSE(ended.killed) << "it ends by itself";
    EXPECT_TRUE(has(ended.err, "\npelagic: stopping: the picture at hand is given up")) << ended.err;
    EXPECT_EQ(ended.out, "");
    const std::vector<std::string> left = files_in("out");
    const auto exrs = std::count_if(left.begin(), left.end(),
                                    [](const std::string& file) { return file.ends_with(".exr"); });
    EXPECT_GE(exrs, 1);
    EXPECT_LT(exrs, 9000);
    EXPECT_EQ(left.size(), 2u * static_cast<std::size_t>(exrs)) << "a .png with each .exr, and nothing else";
    EXPECT_TRUE(has(ended.err, std::to_string(exrs) + " of the 9000 frames asked for are whole"))
        << ended.err;
    EXPECT_EQ(torn_files(folder() / "out"), "");
}

TEST_F(Pictures, ACameraUnderWaterIsRefusedForTheFramesAskedFor) {
    const auto with_camera = [](const std::string& camera) {
        std::string text = small_shot();
        const std::string table = "[camera]\n";
        return text.insert(text.find(table) + table.size(), camera) + "[water]\nbody = false\n";
    };
    write_file(folder() / "below.toml", with_camera("position_m = [0, -60, -9]\n"));
    write_file(folder() / "diving.toml",
               with_camera("keys = [ { frame = 1, position_m = [0, -60, 9], look_at_m = [0, 0, 0] }, "
                           "{ frame = 4, position_m = [0, -60, -9], look_at_m = [0, 0, 0] } ]\n"));
    refused({"render", "below.toml"}, 2,
            {"below.toml: camera.position_m: at frame 1 the camera is under water: it is at z = -9 m",
             "the surface there", "water.body = true"});
    refused({"render", "diving.toml"}, 2, {"diving.toml: camera.keys: at frame ", "raise the camera"});
    refused({"render", "diving.toml", "--frames", "4"}, 2,
            {"at frame 4 the camera is under water: it is at z = -9 m"});
    EXPECT_EQ(cli({"render", "diving.toml", "--frames", "1"}).status, 0);
    EXPECT_EQ(cli({"bake", "below.toml"}).status, 0);
    // It has a body where nobody says otherwise.
    const std::string below = with_camera("position_m = [0, -60, -9]\n");
    write_file(folder() / "below.toml", below.substr(0, below.find("[water]")));
    EXPECT_EQ(cli({"render", "below.toml"}).status, 0);
    write_file(folder() / "floor.toml", below.substr(0, below.find("[water]")) + "[sea]\ndepth_m = 8\n");
    refused({"render", "floor.toml"}, 2,
            {"floor.toml: camera.position_m: at frame 1 the camera is in the sea's floor: it is at z = -9 m",
             "sea.depth_m"});
}

TEST_F(Pictures, PreviewLooksThroughWaterThatHasABody) {
    const auto shot_at = [](const char* z, const char* water) {
        std::string text = small_shot();
        const std::string table = "[camera]\n";
        return text.insert(text.find(table) + table.size(),
                           std::string("position_m = [0, -60, ") + z + "]\n") +
               water;
    };
    write_file(folder() / "below.toml", shot_at("-9", "[water]\nbody = false\n"));
    refused({"preview", "below.toml", "--offscreen", "new/x.png"}, 2,
            {"below.toml: camera.position_m: at frame 1 the camera is under water", "water.body = true"});
    write_file(folder() / "among.toml", shot_at("-2", ""));
    write_file(folder() / "deep.toml", shot_at("-9", ""));
    if (!kHasPreview) return;
    for (const std::string shot : {"among", "deep"})
        EXPECT_EQ(cli({"preview", shot + ".toml", "--offscreen", shot + ".png"}).status, 0) << shot;
}

}  // namespace
}  // namespace pelagic::test
