// A bake that is stopped, politely or not: what has its own name is whole, and the next run goes on to the
// very files that an undisturbed run leaves.
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <random>
#include <thread>

#include "tests/plugin/cli/program.h"
#include "tests/plugin/cli/small_shot.h"

namespace pelagic::test {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

// Waits until `condition` holds; whether it did before the program ended or a minute was over.
template <class Condition>
bool wait_until(Running& running, Condition condition) {
    for (const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(1);
         std::chrono::steady_clock::now() < end && !running.has_ended();
         std::this_thread::sleep_for(milliseconds(1)))
        if (condition()) return true;
    return false;
}

// The files' own checker: what a killed writer without care would leave is noticed.
TEST(BakeStop, TheCheckOfThisTestNoticesTornFiles) {
    const TempFolder folder;
    write_file(folder.path() / "shot.toml", text_of({.frames = 1}));
    ASSERT_EQ(run({.arguments = {"bake", "shot.toml", "--out", "out"}, .folder = folder.path()}).status, 0);
    ASSERT_EQ(torn_files(folder.path() / "out"), "");
    int files = 0;
    for (const auto& [path, bytes] : files_below(folder.path() / "out")) {
        ++files;
        for (const std::size_t kept : {std::size_t{0}, bytes.size() / 2, bytes.size() - 3}) {
            write_file(folder.path() / "out" / path, bytes.substr(0, kept));
            EXPECT_TRUE(has(torn_files(folder.path() / "out"), path))
                << path << " cut to " << kept << " bytes";
        }
        write_file(folder.path() / "out" / path, bytes);
    }
    EXPECT_GE(files, 7) << "root, topology, manifest, frame, two maps and the record";
}

// Two shots that differ in their seed only take turns in one folder, so that every run has all of its frames
// to do and finds whole ones of the other shot, whose files are just as long in their maps. After each kill
// the first shot must come out as if nothing had happened.
TEST(BakeStop, KilledAtRandomMomentsNothingIsTornAndTheNextRunFinishes) {
    constexpr int kKills = 16;
    constexpr int kMostRounds = 80;
    const TempFolder folder;
    write_file(folder.path() / "one.toml", text_of({.seed = 1}));
    write_file(folder.path() / "two.toml", text_of({.seed = 2}));
    const fs::path out = folder.path() / "out";
    const auto bake = [&](const char* shot, const char* where) {
        return Launch{.arguments = {"bake", shot, "--out", where}, .folder = folder.path()};
    };
    const Ended undisturbed = run(bake("one.toml", "undisturbed"));
    ASSERT_EQ(undisturbed.status, 0) << undisturbed.err;
    ASSERT_EQ(run(bake("one.toml", "out")).status, 0);

    std::mt19937 random(20190206);
    int kills = 0, with_new_frames = 0;
    for (int round = 0; round < kMostRounds && kills < kKills; ++round) {
        const auto moment = std::chrono::duration<double>(
            std::uniform_real_distribution<double>(0.0, undisturbed.seconds)(random));
        {
            Running running(bake("two.toml", "out"));
            std::this_thread::sleep_for(moment);
            running.send(SIGKILL);
            const Ended ended = running.wait();
            if (ended.killed) ++kills;
        }
        ASSERT_EQ(torn_files(out), "") << "after " << moment.count() << " s";
        if (read_file(out / "mesh/small.0001.usda") !=
            read_file(folder.path() / "undisturbed/mesh/small.0001.usda"))
            ++with_new_frames;
        const Ended finished = run(bake("one.toml", "out"));
        ASSERT_EQ(finished.status, 0) << finished.err;
        ASSERT_EQ(leftovers(out), std::vector<std::string>()) << "after " << moment.count() << " s";
        ASSERT_EQ(differences(out, folder.path() / "undisturbed"), "") << "after " << moment.count() << " s";
    }
    EXPECT_EQ(kills, kKills) << "the program was too quick to be killed";
    EXPECT_GT(with_new_frames, 0) << "no kill came after the first frame";
}

class BakeSignal : public ::testing::TestWithParam<int> {};

TEST_P(BakeSignal, StopsAfterTheFileAtHandAndTheNextRunGoesOn) {
    const TempFolder folder;
    write_file(folder.path() / "shot.toml", text_of({.frames = 60}));
    const fs::path out = folder.path() / "out";
    const Launch bake{.arguments = {"bake", "shot.toml", "--out", "out"}, .folder = folder.path()};
    Running running(bake);
    ASSERT_TRUE(wait_until(running, [&] { return fs::exists(out / "mesh/small.0003.usda"); }))
        << running.messages();
    running.send(GetParam());
    const Ended ended = running.wait();
    EXPECT_FALSE(ended.killed) << "it ends by itself";
    EXPECT_EQ(ended.status, 128 + GetParam()) << ended.err;
    EXPECT_TRUE(has(ended.err, "of the 60 frames asked for are whole in out")) << ended.err;
    EXPECT_TRUE(has(ended.err, "run the same command again to continue")) << ended.err;
    EXPECT_EQ(ended.out, "");
    EXPECT_EQ(torn_files(out), "");
    EXPECT_EQ(leftovers(out), std::vector<std::string>());
    EXPECT_FALSE(fs::exists(out / "mesh/small.0060.usda")) << "it went on to the end";

    const Ended finished = run(bake);
    EXPECT_EQ(finished.status, 0) << finished.err;
    EXPECT_TRUE(has(finished.out, "kept as they were")) << finished.out;
    EXPECT_TRUE(fs::exists(out / "mesh/small.0060.usda"));
    ASSERT_EQ(run({.arguments = {"bake", "shot.toml", "--out", "whole"}, .folder = folder.path()}).status, 0);
    EXPECT_EQ(differences(out, folder.path() / "whole"), "");
}

INSTANTIATE_TEST_SUITE_P(Failures, BakeSignal, ::testing::Values(SIGINT, SIGTERM, SIGHUP),
                         [](const auto& info) -> std::string { return sigabbrev_np(info.param); });

TEST(BakeStop, ASecondSignalEndsItAtOnce) {
    const TempFolder folder;
    // Frames of some megabytes, so that there is time between the first signal and the end of the file at
    // hand.
    write_file(folder.path() / "shot.toml", text_of({.frames = 60, .quads = 300}));
    const fs::path out = folder.path() / "out";
    bool at_once = false;
    for (int attempt = 0; attempt < 10 && !at_once; ++attempt) {
        fs::remove_all(out);
        Running running({.arguments = {"bake", "shot.toml", "--out", "out"}, .folder = folder.path()});
        ASSERT_TRUE(wait_until(running, [&] { return fs::exists(out / "mesh/small.0001.usda"); }))
            << running.messages();
        ASSERT_TRUE(wait_until(running, [&] { return fs::exists(out / "maps/whitecaps.0001.exr"); }));
        running.send(SIGINT);
        wait_until(running, [&] { return has(running.messages(), "again to stop at once"); });
        running.send(SIGINT);
        const Ended ended = running.wait();
        EXPECT_EQ(ended.status, 130) << ended.err;
        EXPECT_EQ(torn_files(out), "");
        at_once = has(ended.err, "stopped at once; the files under their own names are whole");
    }
    EXPECT_TRUE(at_once);
}

TEST(BakeStop, AnInterruptThatIsIgnoredFromTheStartStaysIgnored) {
    const TempFolder folder;
    write_file(folder.path() / "shot.toml", text_of({.frames = 20}));
    Running running({.arguments = {"bake", "shot.toml", "--out", "out"},
                     .folder = folder.path(),
                     .ignore_interrupt = true});
    ASSERT_TRUE(wait_until(running, [&] { return fs::exists(folder.path() / "out/mesh/small.0001.usda"); }));
    running.send(SIGINT);
    EXPECT_EQ(running.wait().status, 0);
    EXPECT_TRUE(fs::exists(folder.path() / "out/mesh/small.0020.usda"));
}

}  // namespace
}  // namespace pelagic::test
