// Budgets on the command line: what a user sees of them, what is written, and what is refused.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <regex>
#include <string>
#include <vector>

#include "plugin/budget/calibration.h"
#include "tests/plugin/host/cli/program.h"

namespace pelagic::test {
namespace {

class Budget : public ::testing::Test {
  protected:
    // A machine that takes the recorded times, whichever this is.
    void SetUp() override {
        ASSERT_FALSE(keep(as_recorded(), folder_.path() / "cache" / "pelagic").empty());
        setenv("XDG_CACHE_HOME", (folder_.path() / "cache").c_str(), 1);
    }
    Ended ended(const std::string& verb, const std::string& quality = {},
                std::vector<std::string> options = {}) const {
        write_file(
            folder_.path() / "shot.toml",
            "[shot]\nname = \"s\"\nframes = [1, 2]\n[waves]\ncascades = [{ size_m = 100, resolution = 64 }]\n"
            "[camera]\nresolution = [16, 9]\n[light]\nvisibility_km = 30\n[effects]\nwhitecaps = false\n"
            "[quality]\n" +
                quality + "\n");
        options.insert(options.begin(), {verb, "shot.toml"});
        if (verb == "calibrate") options.pop_back();
        return run({.arguments = options, .folder = folder_.path()});
    }
    std::string record() const { return read_file(folder_.path() / "s" / "s.json"); }
    TempFolder folder_;
};

TEST_F(Budget, AMeshIsBakedAsItAsks) {
    Ended first = ended("bake", "max_error = 0.05");
    ASSERT_EQ(first.status, 0) << first.err;
    EXPECT_TRUE(has(record(), "\"quality.max_error\": null")) << "files are those of ordinary keys";
    EXPECT_FALSE(has(record(), "\"surface.resolution\": 256"));
    // Another budget that asks for the same keeps every file.
    const Ended again = ended("bake", "max_error = 0.0501");
    ASSERT_EQ(again.status, 0) << again.err;
    EXPECT_TRUE(has(again.out, "2 kept")) << again.out;
    const Ended in_time = ended("bake", "frame_ms = 1.5");
    EXPECT_EQ(in_time.status, 0) << in_time.err;
}

TEST_F(Budget, WhatNothingHoldsIsRefusedWithWhatComesNearest) {
    for (const char* verb : {"bake", "validate"}) {
        const Ended refused = ended(verb, "frame_ms = 0.01");
        EXPECT_EQ(refused.status, 2) << verb;
        EXPECT_TRUE(has(refused.err, "shot.toml:13:12: quality.frame_ms")) << verb << '\n' << refused.err;
        for (const char* part :
             {"quality.frame_ms = 0.01, which nothing holds", "surface.resolution = 8", "raise the budget"})
            EXPECT_TRUE(has(refused.err, part)) << verb << '\n' << refused.err;
    }
    EXPECT_FALSE(std::filesystem::exists(folder_.path() / "s"));
    const Ended picture = ended("render", "frame_ms = 0.01");
    EXPECT_EQ(picture.status, 2);
    EXPECT_TRUE(has(picture.err, "shot.toml:13:12: quality.frame_ms = 0.01, which nothing holds"))
        << picture.err;
    // A draft isn't among what a budget chooses from, and takes less.
    std::smatch ms;
    ASSERT_TRUE(std::regex_search(
        picture.err, ms,
        std::regex(
            "the cheapest final pictures have .* about ([0-9.]+) ms a picture; a draft .* takes about ([0-9.]+) ms")))
        << picture.err;
    EXPECT_LT(std::stod(ms[2]), std::stod(ms[1]));
}

TEST_F(Budget, PicturesTakeItAndNamedSettingsStay) {
    const Ended part = ended("render", "frame_ms = 1000", {"--frames", "1"});
    EXPECT_EQ(part.status, 2);
    EXPECT_TRUE(has(part.err, "shot.toml:13:12: quality.frame_ms = 1000: isn't settled yet")) << part.err;
    const Ended cheap = ended("render", "frame_ms = 1000");
    ASSERT_EQ(cheap.status, 0) << cheap.err;
    EXPECT_TRUE(has(cheap.out, "samples a pixel and")) << cheap.out;
    const Ended named = ended("render", "frame_ms = 999", {"--samples", "3"});
    ASSERT_EQ(named.status, 0) << named.err;
    EXPECT_TRUE(has(named.out, "3 × 3 samples a pixel")) << named.out;
    // All is named: nothing is left to it.
    const Ended all =
        ended("render", "max_error = 1e-6", {"--frames", "1", "--samples", "1", "--sky-quality", "one"});
    EXPECT_EQ(all.status, 0) << all.err;
}

TEST_F(Budget, ExplainSaysWhatIsChosen) {
    const Ended page = ended("explain", "max_error = 0.1");
    ASSERT_EQ(page.status, 0) << page.err;
    for (const char* part : {"Budget\n  quality.max_error = 0.1: the cheapest mesh is quality.level",
                             "ms a frame\n", "Budget of pictures\n  quality.max_error = 0.1"})
        EXPECT_TRUE(has(page.out, part)) << page.out;
}

// By the verb, into the same file.
TEST_F(Budget, AMachineIsMeasuredAnew) {
    const Ended printed = ended("calibrate");
    ASSERT_EQ(printed.status, 0) << printed.err;
    for (const char* part : {"transforms", "integral", "kept in "})
        EXPECT_TRUE(has(printed.out, part)) << printed.out;
    EXPECT_NE(kept_calibration(folder_.path() / "cache" / "pelagic")->times, as_recorded().times);
    setenv("XDG_CACHE_HOME", "/proc/no", 1);
    const Ended homeless = ended("calibrate");
    EXPECT_EQ(homeless.status, 0) << homeless.err;
    EXPECT_TRUE(has(homeless.err, "no cache folder that can be written")) << homeless.err;
}

}  // namespace
}  // namespace pelagic::test
