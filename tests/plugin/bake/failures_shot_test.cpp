// Shots that are refused before work starts: the message says where, which key, which value and what is
// accepted, the exit status isn't 0, and nothing is on disk.
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/plugin/host/cli/program.h"

namespace pelagic::test {
namespace {

struct Refused {
    std::string name;
    std::string text;      // of the shot file
    std::string at;        // line:column
    std::string says;      // "key = value: " and the beginning of what is wrong
    std::string accepted;  // the beginning of what follows "accepted: "
};

void PrintTo(const Refused& refused, std::ostream* out) {
    *out << refused.name;
}

class RefusedShot : public ::testing::TestWithParam<Refused> {};

TEST_P(RefusedShot, SaysWhereWhatAndWhatInstead) {
    const TempFolder folder;
    const Refused& refused = GetParam();
    write_file(folder.path() / "shot.toml", refused.text);
    for (const char* verb : {"bake", "explain", "validate"}) {
        const Ended ended = run({.arguments = {verb, "shot.toml"}, .folder = folder.path()});
        EXPECT_EQ(ended.status, 2) << verb;
        EXPECT_EQ(ended.out, "") << verb;
        EXPECT_TRUE(ended.err.starts_with("shot.toml:" + refused.at + ": " + refused.says)) << verb << "\n"
                                                                                            << ended.err;
        EXPECT_NE(ended.err.find("; accepted: " + refused.accepted), std::string::npos) << verb << "\n"
                                                                                        << ended.err;
    }
    EXPECT_EQ(files_below(folder.path()).size(), 1u) << "only the shot file";
}

const std::string kBuoy =
    std::string("\"") + PELAGIC_SOURCE_DIR + "/tests/plugin/format/shot/data/made-99001w2021.txt\"";

INSTANTIATE_TEST_SUITE_P(
    Failures, RefusedShot,
    ::testing::Values(
        Refused{"UnknownKey", "[sea]\n  wind_sped_mps = 12.5\n", "2:3",
                "sea.wind_sped_mps = 12.5: is an unknown key, the nearest is sea.wind_speed_mps",
                "in sea the keys wind_speed_mps,"},
        Refused{"WrongType", "[surface]\nresolution = \"fine\"\n", "2:14",
                "surface.resolution = \"fine\": is a string", "an integer, 1 … 8192"},
        Refused{"NotANumber", "[sea]\nfetch_m = nan\n", "2:11", "sea.fetch_m = nan: is not a number",
                "1 … 1e8"},
        Refused{"NegativeWind", "[sea]\nwind_speed_mps = -3.5\n", "2:18",
                "sea.wind_speed_mps = -3.5: is outside the range", "0 … 80"},
        Refused{"ResolutionZero", "[surface]\nresolution = 0\n", "2:14",
                "surface.resolution = 0: is outside the range", "1 … 8192"},
        Refused{"ResolutionABillion", "[surface]\n\nresolution = 1000000000\n", "3:14",
                "surface.resolution = 1000000000: is outside the range", "1 … 8192"},
        Refused{"FramesBackwards", "[shot]\nframes = [48, 1]\n", "2:10",
                "shot.frames = [48, 1]: runs backwards", "[first, last] with first ≤ last"},
        Refused{"NameWithSlash", "[shot]\nname = \"a/b\"\n", "2:8",
                "shot.name = \"a/b\": ", "letters, digits, _ and -"},
        Refused{"MissingSpectrumFile",
                "[sea]\nspectrum = \"file\"\nspectrum_file = \"41010w2019.txt\"\nspectrum_time = "
                "2019-02-06T00:40:00Z\n",
                "3:17", "sea.spectrum_file = \"41010w2019.txt\": 41010w2019.txt does not exist",
                "NDBC's five files"},
        Refused{"MissingSpectrumHour",
                "[sea]\nspectrum = \"file\"\nspectrum_file = " + kBuoy +
                    "\nspectrum_time = 1999-02-06T00:40:00Z\n",
                "4:17", "sea.spectrum_time = 1999-02-06T00:40:00Z: ", ""},
        Refused{"CameraOnItsTarget", "[camera]\nposition_m = [1.0, 2.0, 3.0]\nlook_at_m = [1.0, 2.0, 3.0]\n",
                "3:13", "camera.look_at_m = [1, 2, 3]: ", "a target"},
        Refused{"CageWithoutItsFile", "[surface]\nkind = \"cage\"\n", "2:8",
                "surface.kind = \"cage\": comes without cage_file", "\"cage\" together with cage_file"},
        Refused{"TwoBudgets", "[quality]\nmax_error = 0.1\nframe_ms = 8\n", "3:12",
                "quality.frame_ms = 8: is a second budget", "one of the two"},
        Refused{"NoToml", "[output\nmesh = \"none\"\n", "1:8", "", "TOML"}),
    [](const auto& one) { return one.param.name; });

TEST(RefusedShots, AllProblemsOfAFileAreSaidAtOnce) {
    const TempFolder folder;
    write_file(folder.path() / "shot.toml", "[shot]\nfps = 0\n[sea]\nwind_speed_mps = -1\ndepht_m = 3\n");
    const Ended ended = run({.arguments = {"bake", "shot.toml"}, .folder = folder.path()});
    EXPECT_EQ(ended.status, 2);
    for (const char* line : {"shot.toml:2:7: shot.fps = 0: ", "\nshot.toml:4:18: sea.wind_speed_mps = -1: ",
                             "\nshot.toml:5:1: sea.depht_m = 3: "})
        EXPECT_NE(ended.err.find(line), std::string::npos) << line << "\n" << ended.err;
}

}  // namespace
}  // namespace pelagic::test
