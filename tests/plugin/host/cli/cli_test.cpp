// The command line as users run it: what it accepts, its messages, and its exit status.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "core/scene/canonical.h"
#include "core/scene/presets.h"
#include "pelagic/version.h"
#include "plugin/format/shot/shot.h"
#include "plugin/render/layers.h"
#include "tests/plugin/format/shot/no_check.h"
#include "tests/plugin/host/cli/program.h"
#include "tests/plugin/host/cli/small_shot.h"

namespace pelagic::test {
namespace {

namespace fs = std::filesystem;

class Cli : public ::testing::Test {
  protected:
    // Of tiles that repeat: copies of so small a tile would be remarked on.
    void SetUp() override {
        std::string text = text_of({.frames = 12});
        const std::string waves = "[waves]\n";
        text.insert(text.find(waves) + waves.size(), "tiling = \"periodic\"\n");
        write_file(folder() / "small.toml", text);
    }
    const fs::path& folder() const { return folder_.path(); }
    Ended cli(std::vector<std::string> arguments) const {
        return run({.arguments = std::move(arguments), .folder = folder()});
    }
    // The numbers of the mesh layers in a subfolder.
    std::vector<std::string> frames_in(const std::string& out) const {
        std::vector<std::string> found;
        for (const auto& [path, bytes] : files_below(folder() / out / "mesh")) {
            const std::string number = path.substr(6, 4);  // small.0007.usda
            if (std::all_of(number.begin(), number.end(), ::isdigit)) found.push_back(number);
        }
        return found;
    }

  private:
    TempFolder folder_;
};

TEST_F(Cli, HelpOfTheProgramNamesEveryVerb) {
    for (const char* flag : {"--help", "-h"}) {
        const Ended ended = cli({flag});
        EXPECT_EQ(ended.status, 0);
        for (const char* part : {"  bake ", "  render ", "  preview ", "  explain ", "  verify ", "  farm ",
                                 "  validate ", "  keys ", "  presets ", "Examples:", "Exit status"})
            EXPECT_TRUE(has(ended.out, part)) << part << "\n" << ended.out;
        EXPECT_EQ(ended.err, "");
    }
}

TEST_F(Cli, HelpOfEachVerbNamesEachOption) {
    const std::vector<std::pair<std::string, std::vector<std::string>>> verbs{
        {"bake",
         {"SHOT.toml", "--out", "--frames", "--trust-times", "--threads", "--instruction-set", "--help",
          "folder in the working folder"}},
        {"render",
         {"SHOT.toml", "--out", "--frames", "--size", "--exposure", "--samples", "--sky-quality", "--terms",
          "--trust-times", "--threads", "--help", "sun, sky, sea, foam and air"}},
        {"preview",
         {"SHOT.toml", "--offscreen", "--frame", "--size", "--quality", "--scale", "--screenshot", "--after",
          "--threads", "--help", "F1"}},
        {"explain", {"SHOT.toml", "--measure", "--threads", "--json", "--help"}},
        {"farm",
         {"SHOT.toml", "--out", "--frames", "--verb", "--submit", "--status", "--tasks", "--minutes",
          "--sbatch", "--threads", "--samples", "--json", "--help", "Exit status of --status: 0"}},
        {"verify",
         {"DIR", "--threads", "--help", "missing", "damaged", "stale", "foreign", "Exit status: 0"}},
        {"validate", {"SHOT.toml", "--help"}},
        {"presets", {"NAME", "--help"}},
        {"keys", {"--help"}}};
    for (const auto& [verb, options] : verbs) {
        if (verb == "preview" && !kHasPreview) continue;
        const Ended ended = cli({verb, "--help"});
        EXPECT_EQ(ended.status, 0) << verb;
        EXPECT_TRUE(has(ended.out, "Examples:")) << verb;
        for (const std::string& option : options)
            EXPECT_TRUE(has(ended.out, option)) << verb << ' ' << option;
    }
}

TEST_F(Cli, VersionSaysWhatItWasBuiltWith) {
    const Ended ended = cli({"--version"});
    EXPECT_EQ(ended.status, 0);
    EXPECT_TRUE(ended.out.starts_with("pelagic " PELAGIC_VERSION "\n")) << ended.out;
    for (const char* part :
         {"built with ", "(", "parts: ", kHasPreview ? ": preview, " : ": no preview, ", " python",
          "sanitizer", "libraries: ", "FFTW 3.", "oneTBB 20", "OpenEXR 3.", "GLM ", "Highway ", "CLI11 ",
          "libpng ", "toml++ ", "xxHash ", "instruction set on this machine: "})
        EXPECT_TRUE(has(ended.out, part)) << part << "\n" << ended.out;
}

TEST_F(Cli, HelpOfRenderNamesEachLayer) {
    const std::string help = cli({"render", "--help"}).out;
    const std::size_t from = help.find("Layers of the EXR");
    ASSERT_NE(from, std::string::npos);
    std::istringstream lines(help.substr(from, help.find("Light is a mean") - from));
    std::set<std::string> named;  // at the beginnings of lines, with commas between
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        for (std::string word; words >> word;) {
            const bool goes_on = word.back() == ',';
            named.insert(goes_on ? word.substr(0, word.size() - 1) : word);
            if (!goes_on) break;
        }
    }
    std::string by_default;
    for (const PictureLayerRow& row : kPictureLayers) {
        EXPECT_TRUE(named.contains(std::string(row.name))) << row.name << "\n" << help;
        if (is_light(row)) by_default += (by_default.empty() ? "" : ",") + std::string(row.name);
    }
    EXPECT_TRUE(has(help, "Default: " + by_default)) << help;
}

TEST_F(Cli, WrongUsageIsStatus2AndSaysWhatIsAccepted) {
    struct Case {
        std::vector<std::string> arguments;
        std::vector<std::string> says;
    };
    const std::vector<Case> cases{
        {{}, {"a verb is missing", "pelagic --help"}},
        {{"paint", "small.toml"}, {"'paint' is not a verb", "bake, render, preview, explain, "}},
        {{"baek", "small.toml"}, {"'baek' is not a verb", "did you mean bake?"}},
        {{"bake"}, {"SHOT.toml is required", "pelagic bake --help"}},
        {{"bake", "small.toml", "--frame", "3"}, {"'--frame' is not an option", "did you mean --frames?"}},
        {{"bake", "small.toml", "other.toml"}, {"'other.toml' is one argument too many"}},
        {{"explain"}, {"SHOT.toml is required", "pelagic explain --help"}},
        {{"--frames", "3"}, {"'--frames' is not an option", "pelagic --help"}},
    };
    for (const Case& one : cases) {
        const Ended ended = cli(one.arguments);
        EXPECT_EQ(ended.status, 2) << ended.err;
        EXPECT_EQ(ended.out, "");
        for (const std::string& part : one.says)
            EXPECT_TRUE(has(ended.err, part)) << part << "\n" << ended.err;
    }
    EXPECT_EQ(files_below(folder()).size(), 1u) << "only the shot file: nothing was begun";
}

TEST_F(Cli, ThreadsOutsideTheirRangeAreRefused) {
    for (const char* threads : {"0", "-1", "257", "2.5", "many", "", "99999999999999999999"}) {
        const Ended ended = cli({"bake", "small.toml", std::string("--threads=") + threads});
        EXPECT_EQ(ended.status, 2) << threads;
        EXPECT_TRUE(has(ended.err, "--threads")) << ended.err;
        EXPECT_FALSE(fs::exists(folder() / "small")) << threads;
    }
    const Ended zero = cli({"bake", "small.toml", "--threads", "0"});
    EXPECT_EQ(zero.status, 2);
    EXPECT_TRUE(has(zero.err, "--threads: 0")) << zero.err;
    EXPECT_TRUE(has(zero.err, "accepted: 1 … 256")) << zero.err;
}

TEST_F(Cli, FramesThatAreAskedForAreBakedAndNoOthers) {
    const std::vector<std::pair<std::string, std::vector<std::string>>> cases{
        {"7", {"0007"}},
        {"2-4", {"0002", "0003", "0004"}},
        {"1-12x5", {"0001", "0006", "0011"}},
        {"12-12", {"0012"}},
        {"3-5x9", {"0003"}}};
    int n = 0;
    for (const auto& [frames, expected] : cases) {
        const std::string out = "out" + std::to_string(n++);
        const Ended ended = cli({"bake", "small.toml", "--out", out, "--frames", frames});
        EXPECT_EQ(ended.status, 0) << ended.err;
        EXPECT_EQ(frames_in(out), expected) << frames;
    }
}

TEST_F(Cli, FramesOutsideTheShotOrMalformedAreRefused) {
    for (const char* frames : {"9-3", "0", "13", "1-13", "-3--1", "x", "1-", "1-12x0", "1-12x", "1.5",
                               "1-12x5x", "1 - 2", "99999999999", "1,", "1,,3", "1,13"}) {
        const Ended ended = cli({"bake", "small.toml", "--frames", frames});
        EXPECT_EQ(ended.status, 2) << frames << ended.err;
        EXPECT_TRUE(has(ended.err, std::string("\"") + frames + "\"")) << ended.err;
        EXPECT_TRUE(has(ended.err, "accepted: ")) << ended.err;
        EXPECT_TRUE(has(ended.err, "1-12")) << "names the shot's range: " << ended.err;
        EXPECT_FALSE(fs::exists(folder() / "small")) << frames;
    }
}

TEST_F(Cli, NegativeFramesCanBeAskedFor) {
    std::string text = text_of({});
    text.replace(text.find("[1, 4]"), 6, "[-3, 4]");
    write_file(folder() / "early.toml", text);
    for (const std::vector<std::string>& arguments :
         {std::vector<std::string>{"--frames", "-3--2"}, std::vector<std::string>{"--frames=-3--2"}}) {
        std::vector<std::string> all{"bake", "early.toml", "--out", "early"};
        all.insert(all.end(), arguments.begin(), arguments.end());
        EXPECT_EQ(cli(all).status, 0);
        EXPECT_TRUE(fs::exists(folder() / "early/mesh/small.-003.usda"));
        EXPECT_FALSE(fs::exists(folder() / "early/mesh/small.-001.usda"));
        fs::remove_all(folder() / "early");
    }
}

TEST_F(Cli, TheDefaultFolderIsNamedAsTheShotInTheWorkingFolder) {
    write_file(folder() / "named.toml", text_of({.name = "bay-7", .frames = 1}));
    fs::create_directory(folder() / "elsewhere");
    const Ended ended = run({.arguments = {"bake", "../named.toml"}, .folder = folder() / "elsewhere"});
    EXPECT_EQ(ended.status, 0) << ended.err;
    EXPECT_TRUE(fs::exists(folder() / "elsewhere/bay-7/bay-7.usda"));
    EXPECT_TRUE(fs::exists(folder() / "elsewhere/bay-7/bay-7.json"));
    EXPECT_TRUE(has(ended.out, "bay-7/bay-7.usda")) << ended.out;
    EXPECT_TRUE(has(ended.out, "bay-7/bay-7.json")) << ended.out;
    EXPECT_TRUE(has(ended.out, "1 frame baked")) << ended.out;
}

TEST_F(Cli, TheProgramNeedsNoFileBesideIt) {
    fs::create_directory(folder() / "bin");
    fs::copy_file(PELAGIC_PROGRAM, folder() / "bin/sea");
    const Ended ended = run({.arguments = {"bake", (folder() / "small.toml").string(), "--out",
                                           (folder() / "there").string(), "--frames", "1"},
                             .folder = "/",
                             .program = folder() / "bin/sea"});
    EXPECT_EQ(ended.status, 0) << ended.err;
    EXPECT_TRUE(fs::exists(folder() / "there/small.usda"));
}

TEST_F(Cli, ExplainPrintsThePlanAndWritesNothing) {
    const Ended ended = cli({"explain", "small.toml"});
    EXPECT_EQ(ended.status, 0) << ended.err;
    for (const char* part : {"normal", "velocity", "displacement", "transform", "nm absorbs"})
        EXPECT_TRUE(has(ended.out, part)) << part << "\n" << ended.out;
    EXPECT_EQ(files_below(folder()).size(), 1u);
    // Explaining a sea of 8192² points is as quick as any: no transform is planned, nothing of that size
    // allocated. The address space is limited below one such buffer (8193² positions, 800 MB).
    write_file(folder() / "large.toml",
               "[surface]\nresolution = 8192\n[output]\nmaps = [\"normal\"]\nmap_resolution = 8192\n");
#if !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)  // its shadow memory takes terabytes of addresses
    const Ended large = run({.arguments = {"explain", "large.toml"},
                             .folder = folder(),
                             .most_address_space = std::size_t{600} << 20});
    EXPECT_EQ(large.status, 0) << large.err;
#endif
}

TEST_F(Cli, ValidateLooksAtEveryFile) {
    write_file(folder() / "wrong.toml", "[sea]\nwind_speed_mps = -3.5\nfetch_m = nan\n");
    write_file(folder() / "empty.toml", "");
    const Ended ended = cli({"validate", "wrong.toml", "small.toml", "missing.toml", "empty.toml"});
    EXPECT_EQ(ended.status, 2);
    EXPECT_TRUE(has(
        ended.out,
        "small.toml: fine\n    12 frames at 24 frames/s, a patch of 8 × 8 quads over 40 m, 2 maps, jonswap at 10 m/s"))
        << ended.out;
    EXPECT_TRUE(has(ended.out, "empty.toml: fine\n    48 frames")) << ended.out;
    EXPECT_FALSE(has(ended.out, "wrong.toml"));
    EXPECT_TRUE(has(ended.err, "wrong.toml:2:18: sea.wind_speed_mps = -3.5")) << ended.err;
    EXPECT_TRUE(has(ended.err, "wrong.toml:3:11: sea.fetch_m = nan")) << ended.err;
    EXPECT_TRUE(has(ended.err, "missing.toml: the shot file does not exist")) << ended.err;
    EXPECT_EQ(cli({"validate", "small.toml", "empty.toml"}).status, 0);
}

TEST_F(Cli, KeysDescribesTheShotFile) {
    const Ended ended = cli({"keys"});
    EXPECT_EQ(ended.status, 0);
    for (const char* key :
         {"shot.name", "sea.wind_speed_mps", "waves.cascades", "camera.keys", "output.maps"})
        EXPECT_TRUE(has(ended.out, key)) << key;
}

// What is printed of a preset is a shot file of it.
TEST_F(Cli, PresetsAreListedAndPrintedAsShotFiles) {
    const Ended all = cli({"presets"});
    EXPECT_EQ(all.status, 0);
    for (const Preset& preset : presets()) {
        EXPECT_TRUE(has(all.out, preset.name + "  ")) << preset.name;
        EXPECT_TRUE(has(all.out, preset.label + ": " + preset.help)) << preset.name;
        const Ended one = cli({"presets", preset.name});
        EXPECT_EQ(one.status, 0) << preset.name;
        Scene scene;
        apply(preset, scene);
        EXPECT_EQ(canonical(parse_shot(one.out, "preset.toml", no_check)), canonical(scene)) << one.out;
    }
    const Ended none = cli({"presets", "glasy-swell"});
    EXPECT_EQ(none.status, 2);
    EXPECT_TRUE(has(none.err, "the nearest is \"glassy-swell\"")) << none.err;
}

// What can be built is built, and what should be known of it is said.
TEST_F(Cli, ASeaThatFoldsIsWarnedOf) {
    std::ofstream(folder() / "folds.toml") << "[sea]\nwind_speed_mps = 15\n[waves]\nchoppiness = 4\n"
                                              "[surface]\nresolution = 4\n[shot]\nframes = [1, 1]\n";
    for (const char* verb : {"validate", "explain", "bake"}) {
        const Ended ended = cli({verb, "folds.toml"});
        EXPECT_EQ(ended.status, 0) << verb << ended.err;
        EXPECT_TRUE(has(ended.err, "folds.toml: note: the surface folds over itself on "))
            << verb << ended.err;
        EXPECT_TRUE(has(ended.err, " leaves 5 %")) << verb << ended.err;
    }
    std::ofstream(folder() / "breaks.toml")
        << "[sea]\nswell = [ { height_m = 50, period_s = 1, direction_deg = 0 } ]\n";
    const Ended refused = cli({"validate", "breaks.toml"});
    EXPECT_EQ(refused.status, 2);
    EXPECT_TRUE(
        has(refused.err,
            "breaks.toml:2:24: sea.swell[0].height_m = 50: is more than waves can have that are 1.5 m long"))
        << refused.err;
}

TEST_F(Cli, ResultsThatCantBePrintedAreAnError) {
    if (!fs::exists("/dev/full")) GTEST_SKIP() << "this machine has no /dev/full";
    const Ended ended = run({.arguments = {"keys"}, .folder = folder(), .stdout_to = "/dev/full"});
    EXPECT_EQ(ended.status, 75);
    EXPECT_TRUE(has(ended.err, "standard output")) << ended.err;
}

TEST_F(Cli, ALogGetsPlainLinesAndFewOfThem) {
    const Ended ended = cli({"bake", "small.toml"});
    ASSERT_EQ(ended.status, 0) << ended.err;
    EXPECT_FALSE(has(ended.err, "\r") || has(ended.err, "\x1b")) << ended.err;
    EXPECT_TRUE(has(ended.err, "building the sea\n")) << ended.err;
    EXPECT_TRUE(has(ended.err, "frame 12: 12 of 12, ")) << ended.err;
    // One line for the stage, the first and the last frame, and every five seconds between.
    EXPECT_LE(std::count(ended.err.begin(), ended.err.end(), '\n'),
              3 + static_cast<long>(ended.seconds / 5.0))
        << ended.err;
}

TEST_F(Cli, ATerminalGetsOneLineThatIsRewritten) {
    if (!std::filesystem::exists("/dev/pts/ptmx")) GTEST_SKIP() << "this machine has no pseudo-terminals";
    const Ended ended = run({.arguments = {"bake", "small.toml"}, .folder = folder(), .terminal = true});
    ASSERT_EQ(ended.status, 0) << ended.err;
    EXPECT_TRUE(has(ended.err, "\r\x1b[Kbuilding the sea")) << ended.err;
    EXPECT_TRUE(has(ended.err, "\r\x1b[K[########################################] frame 12  12/12  "))
        << ended.err;
    EXPECT_FALSE(has(ended.err, "\n")) << "one line: " << ended.err;
    EXPECT_TRUE(ended.err.ends_with("\r\x1b[K")) << "and gone at the end";
    EXPECT_TRUE(has(ended.out, "12 frames baked")) << ended.out;
}

TEST_F(Cli, ALogThatIsClosedDoesNotEndABake) {
    // With and without a remark on the sea before the bake begins.
    write_file(folder() / "noted.toml", text_of({.name = "noted", .frames = 12}));
    ASSERT_TRUE(has(cli({"validate", "noted.toml"}).err, "note: "));
    for (const std::string name : {"small", "noted"}) {
        const std::string line = "'" PELAGIC_PROGRAM "' bake " + name + ".toml 2>&1 | true";
        run({.arguments = {"-c", line}, .folder = folder(), .program = "/bin/sh"});
        EXPECT_TRUE(fs::exists(folder() / (name + "/mesh/" + name + ".0012.usda"))) << name;
    }
}

TEST_F(Cli, AShotThatAsksForNothingIsRefused) {
    write_file(folder() / "nothing.toml", "[output]\nmesh = \"none\"\n");
    const Ended ended = cli({"bake", "nothing.toml"});
    EXPECT_EQ(ended.status, 2);
    EXPECT_TRUE(has(ended.err, "nothing.toml:")) << ended.err;
    EXPECT_TRUE(has(ended.err, "output.mesh = \"none\"")) << ended.err;
    EXPECT_TRUE(has(ended.err, "accepted: ")) << ended.err;
    EXPECT_FALSE(fs::exists(folder() / "sea"));
}

TEST_F(Cli, OutOfMemoryIsSaidAndIsNoCrash) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "sanitizers take terabytes of addresses themselves";
#endif
    write_file(folder() / "large.toml", "[surface]\nresolution = 8192\n");
    // Somebody who allows more than there is gets as far as that goes.
    const Ended ended = run({.arguments = {"bake", "large.toml", "--threads", "1", "--max-memory", "1T"},
                             .folder = folder(),
                             .most_address_space = std::size_t{600} << 20});
    EXPECT_FALSE(ended.killed) << "signal " << ended.status - 128;
    EXPECT_EQ(ended.status, 75);
    for (const char* part :
         {"out of memory; this bake holds about ", "for values of the mesh", "lower surface.resolution"})
        EXPECT_TRUE(has(ended.err, part)) << part << "\n" << ended.err;
    EXPECT_EQ(torn_files(folder() / "sea"), "");
}

}  // namespace
}  // namespace pelagic::test
