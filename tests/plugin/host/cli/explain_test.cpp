// pelagic explain, with and without --measure: its description of a shot and the costs. Times are never
// compared: other programs run at the same time.
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "tests/plugin/host/cli/program.h"
#include "tests/plugin/host/cli/small_shot.h"

namespace pelagic::test {
namespace {

struct Price {
    std::string name;
    long transforms = 0, lines = 0;
};

class Explain : public ::testing::Test {
  protected:
    const std::filesystem::path& folder() const { return folder_.path(); }
    Ended explain(const std::string& shot, const std::vector<std::string>& options = {}) const {
        write_file(folder() / "shot.toml", shot);
        std::vector<std::string> arguments{"explain", "shot.toml"};
        arguments.insert(arguments.end(), options.begin(), options.end());
        return run({.arguments = arguments, .folder = folder()});
    }
    // The table's rows: a name, two counts, three byte counts, two times with their spread.
    std::vector<Price> prices(const std::string& shot) const {
        const Ended ended = explain(shot, {"--measure"});
        EXPECT_EQ(ended.status, 0) << ended.err;
        EXPECT_EQ(files_below(folder()).size(), 1u) << "nothing is written";
        const std::regex row(R"((\S+(?: \S+)*) +(-?\d+) +(-?\d+)(?: +-?[\d.]+(?: \w+)?){3})"
                             R"((?: +-?\d+\.\d\d \(\d+\.\d\d\)){2})");
        std::vector<Price> found;
        std::istringstream table(ended.out.substr(ended.out.find("\nPrices")));
        for (std::string line; std::getline(table, line);)
            if (std::smatch m; std::regex_match(line, m, row))
                found.push_back({m[1], std::stol(m[2]), std::stol(m[3])});
        EXPECT_FALSE(found.empty()) << ended.out;
        // The last row agrees with the description above.
        std::smatch promised;
        EXPECT_TRUE(
            std::regex_search(ended.out, promised, std::regex(R"(Each frame: (\d+) real transforms)")));
        if (!found.empty()) {
            EXPECT_EQ(std::to_string(found.back().transforms), promised[1]);
        }
        return found;
    }
    static std::vector<std::string> names(const std::vector<Price>& prices) {
        std::vector<std::string> list;
        for (const Price& price : prices) list.push_back(price.name);
        return list;
    }

  private:
    TempFolder folder_;
};

const char* const kOneCascade =
    "[effects]\nfoam_decay_s = 0\n[waves]\nsecond_order = 0\ntiling = \"periodic\"\ncascades = [ { size_m = 40.0, resolution = 32 } ]\n[surface]\nsize_m = 40\nresolution = 32\n";

TEST_F(Explain, GivesEachOutputAndEffectAPrice) {
    const auto rows = prices(std::string(kOneCascade) +
                             "[output]\nmaps = [\"displacement\", \"normal\", \"slope-variance\", "
                             "\"whitecaps\"]\nmap_resolution = 16\ncascade_tiles = true\n");
    const std::vector<std::string> expected{"mesh",
                                            "mesh normal",
                                            "mesh velocity",
                                            "mesh slope-variance",
                                            "mesh whitecaps",
                                            "map displacement",
                                            "map normal",
                                            "map slope-variance",
                                            "map whitecaps",
                                            "tiles",
                                            "horizontal displacement",
                                            "whitecaps",
                                            "foam structure",
                                            "the whole"};
    EXPECT_EQ(names(rows), expected);
}

// One mesh on one grid. Position's three fields are always needed; normals need two slopes for themselves,
// and J's three fields, which they share with whitecaps and slope variances; velocities need three. Whitecaps keep J's
// without horizontal displacement.
TEST_F(Explain, CountsWhatNothingElseNeeds) {
    std::map<std::string, long> transforms, lines;
    for (const Price& price : prices(kOneCascade)) {
        transforms[price.name] = price.transforms;
        lines[price.name] = price.lines;
    }
    EXPECT_EQ(transforms["the whole"], 11);
    EXPECT_EQ(transforms["mesh"], 11);
    EXPECT_EQ(transforms["mesh normal"], 2);
    EXPECT_EQ(transforms["mesh velocity"], 3);
    EXPECT_EQ(transforms["mesh slope-variance"], 0);
    EXPECT_EQ(transforms["mesh whitecaps"], 0);
    EXPECT_EQ(transforms["horizontal displacement"], 4);
    EXPECT_EQ(transforms["whitecaps"], 0);
    // The largest mode of 32 samples is 15: 16 columns and 16 pairs of rows per field.
    EXPECT_EQ(lines["mesh velocity"], 3 * 32);
}

TEST_F(Explain, PricesAddUpWhereNothingIsShared) {
    const auto rows =
        prices(std::string(kOneCascade) +
               "[output]\nmesh = \"none\"\nmaps = [\"displacement\", \"normal\"]\nmap_resolution = 32\n");
    ASSERT_EQ(rows.size(), 6u);
    EXPECT_EQ(rows[0].name, "map displacement");
    EXPECT_EQ(rows[0].transforms, 3);
    EXPECT_EQ(rows[1].transforms, 5);
    EXPECT_EQ(rows[5].transforms, rows[0].transforms + rows[1].transforms);
    EXPECT_EQ(rows[5].lines, rows[0].lines + rows[1].lines);
}

// The numbers that its --json has.
TEST_F(Explain, SaysWhatAFrameTakes) {
    const Ended ended = explain(kOneCascade);
    EXPECT_EQ(ended.status, 0) << ended.err;
    for (const char* of : {"A baked frame", "A picture"})
        EXPECT_TRUE(std::regex_search(
            ended.out, std::regex(std::string("\n  ") + of +
                                  " takes about [0-9.e-]+ s of computing and [0-9.]+ [KM]iB in its files")))
            << ended.out;
    EXPECT_TRUE(std::regex_search(ended.out, std::regex("\nOn [0-9]+ threads?, by "))) << ended.out;
}

TEST_F(Explain, HasNoRowForWhatIsOff) {
    const auto rows = prices(std::string("[effects]\nwhitecaps = false\n[output]\nattributes = []\n") +
                             "[surface]\nsize_m = 40\nresolution = 32\n[waves]\nchoppiness = 0\n"
                             "cascades = [ { size_m = 40.0, resolution = 32 } ]\n");
    EXPECT_EQ(names(rows), (std::vector<std::string>{"mesh", "the whole"}));
}

TEST_F(Explain, SaysOnWhatItMeasuredAndHowFarItIs) {
    const Ended ended = explain(kOneCascade, {"--measure", "--threads", "1"});
    EXPECT_EQ(ended.status, 0);
    EXPECT_TRUE(std::regex_search(ended.out, std::regex("on 1 thread, \\w+\\."))) << ended.out;
    EXPECT_TRUE(has(ended.err, "measuring ")) << ended.err;
    EXPECT_FALSE(has(ended.err, "\r") || has(ended.err, "\x1b")) << ended.err;
}

TEST_F(Explain, TakesThreadsOnlyToMeasure) {
    for (const auto& options :
         std::vector<std::vector<std::string>>{{"--threads", "1"}, {"--measure", "--threads", "0"}}) {
        const Ended ended = explain(kOneCascade, options);
        EXPECT_EQ(ended.status, 2);
        EXPECT_TRUE(has(ended.err, "--threads")) << ended.err;
        EXPECT_EQ(ended.out, "");
    }
}

TEST_F(Explain, CanBeInterrupted) {
    write_file(
        folder() / "shot.toml",
        "[waves]\ncascades = [ { size_m = 200.0, resolution = 2048 } ]\n[surface]\nresolution = 2048\n");
    Running measuring({.arguments = {"explain", "shot.toml", "--measure"}, .folder = folder()});
    while (!has(measuring.messages(), "measuring") && !measuring.has_ended())
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    measuring.send(SIGINT);
    EXPECT_EQ(measuring.wait().status, 128 + SIGINT);
}

// Grids of 32768² in double, for mesh and maps: terabytes.
TEST_F(Explain, RefusesToMeasureWhatDoesNotFit) {
    const Ended ended = explain(
        "[quality]\nlevel = \"reference\"\n[waves]\ncascades = [ { size_m = 4000.0, resolution = 8192 }, "
        "{ size_m = 150.0, resolution = 8192 }, { size_m = 5.0, resolution = 8192 } ]\n"
        "[surface]\nresolution = 8192\nsize_m = 5\n"
        "[output]\nmaps = [\"displacement\", \"normal\", \"whitecaps\"]\nmap_resolution = 4000\n",
        {"--measure"});
    EXPECT_EQ(ended.status, 75);
    EXPECT_TRUE(has(ended.out, "Each frame: ")) << "the page itself is there";
    EXPECT_TRUE(has(ended.err, "measuring holds the sea twice")) << ended.err;
    EXPECT_TRUE(has(ended.err, "GiB, and ")) << ended.err;
    EXPECT_FALSE(has(ended.out, "the whole"));
}

TEST_F(Explain, RefusesWhereThisProcessGetsNoMemory) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "sanitizers take terabytes of addresses themselves";
#endif
    write_file(folder() / "shot.toml", "[surface]\nresolution = 4096\n");
    const Ended ended = run({.arguments = {"explain", "shot.toml", "--measure", "--threads", "1"},
                             .folder = folder(),
                             .most_address_space = std::size_t{600} << 20});
    EXPECT_FALSE(ended.killed);
    EXPECT_EQ(ended.status, 75);
    EXPECT_TRUE(has(ended.err, "measuring holds the sea twice")) << ended.err;
}

// 60 trains from 100 m to 1 m: one every 7.4 %, in the middle of its bin. A mesh with cells of 0.78 m shows
// waves from 1.5625 m: ln(100/1.5625)/ln(100) of 60 are 54.2 bins, so 54 trains are longer.
TEST_F(Explain, SaysThatTrainsAreNotTransformed) {
    const Ended ended = explain(
        "[waves]\nmodel = \"trochoid\"\ntrains = 60\nlongest_m = 100\nshortest_m = 1\n[surface]\nsize_m = 200\n");
    EXPECT_EQ(ended.status, 0) << ended.err;
    for (const char* part : {"60, of waves from 100 m down to 1 m", "nothing is transformed",
                             "mesh: the 54 longest are summed; 6 are below the pixel: kept as variance",
                             "Each frame: 0 real transforms", "none: the trains are the whole sea"})
        EXPECT_TRUE(has(ended.out, part)) << part << "\n" << ended.out;
    EXPECT_FALSE(has(explain(kOneCascade).out, "trains"));
}

}  // namespace
}  // namespace pelagic::test
