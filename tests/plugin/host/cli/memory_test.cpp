// Shots that need more memory, or larger pictures, than there is are refused before any work: nothing is written, the
// memory stays small, and nobody waits.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <algorithm>
#include <filesystem>
#include <regex>
#include <string>
#include <vector>

#include "tests/plugin/host/cli/program.h"

namespace pelagic::test {
namespace {

class Memory : public testing::Test {
  protected:
    const std::filesystem::path& folder() const { return folder_.path(); }
    Ended pelagic(std::vector<std::string> arguments) {
        return run({.arguments = std::move(arguments), .folder = folder()});
    }
    // Refused in words, with nothing left behind. That no work was begun shows in the memory that it takes
    // (RefusingTakesLittle); the time is no more than a guard: such shots take minutes to build.
    void expect_refused(std::vector<std::string> arguments, const std::vector<std::string>& words,
                        int status = 2) {
        const Ended explained = pelagic({"explain", "shot.toml"});
        const Ended refused = pelagic(std::move(arguments));
        EXPECT_EQ(refused.status, status) << refused.err;
        for (const std::string& word : words)
            EXPECT_TRUE(has(refused.err, word)) << word << "\n" << refused.err;
        EXPECT_LT(refused.seconds, 20.0 * explained.seconds + 60.0);
        EXPECT_EQ(files_below(folder()).size(), 1u) << "the shot alone";
    }

  private:
    TempFolder folder_;
};

const std::string kHuge =
    "[waves]\ncascades = [ { size_m = 4000.0, resolution = 8192 }, { size_m = 300.0, resolution = 8192 } ]\n"
    "[surface]\nresolution = 4096\nsize_m = 20\n";

TEST_F(Memory, ABakeThatDoesNotFitIsRefusedBeforeItBegins) {
    write_file(folder() / "shot.toml", kHuge);
    expect_refused({"bake", "shot.toml", "--out", "out", "--max-memory", "2G"},
                   {"shot.toml: this bake needs about ", "the limit that was asked for is 2.00 GiB",
                    "most of it, ", "lower the resolutions in waves.cascades", "--max-memory"});
}

TEST_F(Memory, APictureThatDoesNotFitIsRefusedBeforeItBegins) {
    write_file(folder() / "shot.toml", "[quality]\nlevel = \"draft\"\n");
    expect_refused({"render", "shot.toml", "--out", "out", "--size", "65536x65536", "--max-memory", "8G"},
                   {"this picture needs about ", "most of it, ", "--size"});
    expect_refused({"render", "shot.toml", "--out", "out", "--size", "65536x2048", "--max-memory", "1G"},
                   {"this picture needs about ", "--size"});
}

TEST_F(Memory, TheSystemsOwnLimitCounts) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "sanitizers take terabytes of addresses themselves";
#endif
    write_file(folder() / "shot.toml", kHuge);
    for (const char* verb : {"bake", "render"}) {
        const Ended refused = run({.arguments = {verb, "shot.toml", "--out", "out"},
                                   .folder = folder(),
                                   .most_address_space = std::size_t{1500} << 20});
        EXPECT_EQ(refused.status, 75);
        EXPECT_TRUE(has(refused.err, "its limit of address space (ulimit -v) leaves")) << refused.err;
    }
    EXPECT_EQ(files_below(folder()).size(), 1u);
}

TEST_F(Memory, WhatFitsExactlyIsBaked) {
    write_file(folder() / "shot.toml",
               "[shot]\nframes = [1, 1]\n[waves]\ncascades = [ { size_m = 60.0, resolution = 32 } ]\n"
               "[surface]\nresolution = 16\n");
    const std::vector<std::string> bake{"bake",      "shot.toml", "--out",       "out",
                                        "--threads", "2",         "--max-memory"};
    const auto with = [&](const char* memory) {
        auto arguments = bake;
        arguments.emplace_back(memory);
        return pelagic(arguments);
    };
    EXPECT_EQ(with("1K").status, 2);
    const Ended baked = with("64M");
    EXPECT_EQ(baked.status, 0) << baked.err;
}

TEST_F(Memory, ASizeOfMemoryThatIsNoneIsRefused) {
    write_file(folder() / "shot.toml", "");
    for (const char* text : {"", "8", "G", "-1G", "8X", "8GX", "nan", "1e30T", "0K", "8 G"}) {
        const Ended ended = pelagic({"bake", "shot.toml", "--max-memory", text});
        EXPECT_EQ(ended.status, 2) << text;
        EXPECT_TRUE(has(ended.err, "like 8G or 512M") || *text == '\0') << ended.err;
    }
}

TEST_F(Memory, APreviewThatDoesNotFitIsRefusedBeforeTheSeaIsBuilt) {
    if (!kHasPreview) GTEST_SKIP() << "built without the preview";
    write_file(folder() / "shot.toml",
               kHuge + "[camera]\nposition_m = [0.0, -60.0, 1.0]\nlook_at_m = [0.0, -59.5, 0.0]\n");
    // The driver's own limit, asked before anything else.
    expect_refused({"preview", "shot.toml", "--offscreen", "out.png", "--size", "65536x36"},
                   {"65536 x 36", "whose largest is ", "--size"});
    expect_refused(
        {"preview", "shot.toml", "--offscreen", "out.png", "--size", "32x18", "--max-memory", "200M"},
        {"this picture needs at least ", "--max-memory"});
}

// Largest resident memory of a run [KiB], and its exit status.
struct Peak {
    long kib = 0;
    int status = -1;
};
Peak peak_of(std::vector<std::string> words) {
    words.insert(words.begin(), PELAGIC_PROGRAM);
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t silent;
    posix_spawn_file_actions_init(&silent);
    for (const int stream : {STDOUT_FILENO, STDERR_FILENO})
        posix_spawn_file_actions_addopen(&silent, stream, "/dev/null", O_WRONLY, 0);
    pid_t process = 0;
    EXPECT_EQ(posix_spawn(&process, PELAGIC_PROGRAM, &silent, nullptr, arguments.data(), environ), 0);
    posix_spawn_file_actions_destroy(&silent);
    int status = -1;
    rusage usage{};
    EXPECT_EQ(wait4(process, &status, 0, &usage), process);
    return {usage.ru_maxrss, WIFEXITED(status) ? WEXITSTATUS(status) : -1};
}

TEST_F(Memory, RefusingTakesLittle) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "sanitizers take memory of their own";
#endif
    const std::string shot = folder() / "shot.toml", out = folder() / "out";
    write_file(shot, kHuge);
    constexpr long kMost_kib = 300 << 10;
    for (const std::vector<std::string>& words :
         {std::vector<std::string>{"bake", shot, "--out", out, "--max-memory", "1G"},
          {"render", shot, "--out", out, "--size", "65536x65536", "--max-memory", "8G"}}) {
        const Peak peak = peak_of(words);
        EXPECT_EQ(peak.status, 2) << words[0];
        EXPECT_LT(peak.kib, kMost_kib) << words[0];
    }
    if (!kHasPreview) return;
    const Peak peak = peak_of({"preview", shot, "--offscreen", out + ".png", "--size", "65536x36"});
    EXPECT_EQ(peak.status, 2);
    EXPECT_LT(peak.kib, kMost_kib);
}

// Small runs, which the program itself takes most of, and a planet's picture from 30 km. Larger ones are the campaign memory's.
TEST_F(Memory, WhatIsSaidIsTaken) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "sanitizers take memory of their own";
#endif
    const std::string shot = folder() / "shot.toml", out = folder() / "out";
    const std::string small =
        "[shot]\nframes = [1, 1]\n[waves]\ncascades = [ { size_m = 60.0, resolution = 64 } ]\n"
        "[surface]\nsize_m = 20\nresolution = 16\n";
    const std::string planet =
        "[shot]\nframes = [1, 1]\n[surface]\nkind = \"planet\"\n[camera]\nresolution = [320, 180]\n"
        "position_m = [0.0, 0.0, 3e4]\nlook_at_m = [3e4, 0.0, 0.0]\n";
    struct Case {
        std::string text;
        std::vector<std::string> verb;
    };
    for (const Case& one :
         {Case{small, {"bake"}},
          {small + "[output]\nmesh = \"none\"\nmaps = [\"normal\"]\nmap_resolution = 64\n", {"bake"}},
          {small, {"render", "--samples", "1", "--size", "64x36"}},
          {planet, {"render", "--samples", "1"}}}) {
        write_file(shot, one.text);
        std::vector<std::string> words = one.verb;
        words.insert(words.begin() + 1, {shot, "--out", out, "--threads", "2"});
        std::vector<std::string> refused = words;
        refused.insert(refused.end(), {"--max-memory", "1K"});
        const std::string said = pelagic(refused).err;
        std::smatch mebi;
        ASSERT_TRUE(std::regex_search(said, mebi, std::regex("needs about ([0-9.]+) MiB"))) << said;
        const Peak peak = peak_of(words);
        EXPECT_EQ(peak.status, 0) << said;
        const double share = static_cast<double>(peak.kib) / 1024.0 / std::stod(mebi[1]);
        EXPECT_GT(share, 0.8) << peak.kib << " KiB; " << said;
        rusage own{};  // below which a child's peak never is
        getrusage(RUSAGE_SELF, &own);
        if (peak.kib > own.ru_maxrss) {
            EXPECT_LT(share, 1.3) << peak.kib << " KiB; " << said;
        }
        std::filesystem::remove_all(out);
    }
    // With little room it is refused before it begins, or rendered; it doesn't run out on its way.
    write_file(shot, planet);
    const Ended tight = run(
        {.arguments = {"render", shot, "--out", out, "--samples", "1", "--size", "480x270", "--threads", "2"},
         .folder = folder(),
         .most_address_space = std::size_t{150'000} << 10});
    EXPECT_FALSE(has(tight.err, "pelagic: out of memory")) << tight.err;
    EXPECT_TRUE(tight.status == 75 || tight.status == 0) << tight.status << tight.err;
}

// A strong wind over a low camera: what no pixel shows is not computed. With grids for all that the camera's points might ask it was
// 4.4 GB at twice the size. A small picture, which takes 14 s in software; one of 640 × 360 has 0.77 GB, in 48 s.
TEST_F(Memory, APreviewOfAStormIsBounded) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "sanitizers take memory of their own";
#endif
    if (!kHasPreview) GTEST_SKIP() << "built without the preview";
    const std::string shot = folder() / "shot.toml";
    write_file(shot, "[sea]\nwind_speed_mps = 20.0\n");
    const Peak peak =
        peak_of({"preview", shot, "--offscreen", folder() / "out.png", "--frame", "1", "--size", "320x180"});
    EXPECT_EQ(peak.status, 0);
    // It has 0.47 GB. In software, textures are in the program's memory.
    EXPECT_LT(peak.kib, 700 << 10);
}

}  // namespace
}  // namespace pelagic::test
