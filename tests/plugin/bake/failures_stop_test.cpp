// A bake that is stopped, politely or not: what has its own name is whole, and the next run goes on to the
// very files that an undisturbed run leaves.
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <thread>

#include "tests/plugin/host/cli/program.h"
#include "tests/plugin/host/cli/small_shot.h"

namespace pelagic::test {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

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
    EXPECT_GE(files, 8) << "root, camera, topology, manifest, frame, two maps and the record";
}

// How a bake is stopped, and what of.
struct Stop {
    std::string name;
    int signal;
    SmallShot shot;
};

void PrintTo(const Stop& stop, std::ostream* out) {
    *out << stop.name;
}

class BakeStopped : public ::testing::TestWithParam<Stop> {
  protected:
    // On the disk: in memory its frames take no time beside what comes before the first.
    void SetUp() override { ::unsetenv("TMPDIR"); }
};

// Two shots that differ in their seed only take turns in one folder, so that every run has all of its frames
// to do and finds whole ones of the other shot. After each stop the first shot must come out as if nothing
// had happened. Maps without a mesh are the hardest: their files are just as long whatever is in them, so
// that their sizes tell nothing.
TEST_P(BakeStopped, AtRandomMomentsNothingIsTornAndTheNextRunFinishes) {
    constexpr int kStops = 8;
    constexpr int kMostRounds = 80;
    const TempFolder folder;
    SmallShot shot = GetParam().shot;
    write_file(folder.path() / "one.toml", text_of(shot));
    shot.seed = 2;
    write_file(folder.path() / "two.toml", text_of(shot));
    const fs::path out = folder.path() / "out", undisturbed = folder.path() / "undisturbed";
    const auto bake = [&](const char* file, const char* where) {
        return Launch{.arguments = {"bake", file, "--out", where}, .folder = folder.path()};
    };
    ASSERT_EQ(run(bake("one.toml", "undisturbed")).status, 0);
    const Ended whole = run(bake("one.toml", "out"));
    ASSERT_EQ(whole.status, 0) << whole.err;

    std::mt19937 random(20190206);
    int stops = 0, with_new_frames = 0;
    double whole_s = whole.seconds;  // the last whole run's: other work on the machine comes and goes
    for (int round = 0; round < kMostRounds && (stops < kStops || with_new_frames == 0); ++round) {
        const double moment_s = std::uniform_real_distribution<double>(0.0, whole_s)(random);
        const auto when = [&] { return "stopped after " + std::to_string(moment_s) + " s"; };
        Running running(bake("two.toml", "out"));
        std::this_thread::sleep_for(std::chrono::duration<double>(moment_s));
        running.send(GetParam().signal);
        const Ended ended = running.wait();
        if (ended.status != 0) {
            ++stops;
            ASSERT_EQ(ended.status, 128 + GetParam().signal) << when() << ended.err;
        }
        ASSERT_EQ(torn_files(out), "") << when();
        // A killed process can't clean up; one that is asked to stop does.
        if (GetParam().signal != SIGKILL) {
            ASSERT_EQ(leftovers(out), std::vector<std::string>()) << when();
        }
        const std::string first = "maps/small.displacement.0001.exr";
        const bool has_new_frames = read_file(out / first) != read_file(undisturbed / first);
        with_new_frames += has_new_frames;

        const Ended finished = run(bake("one.toml", "out"));
        ASSERT_EQ(finished.status, 0) << finished.err;
        // A run that finds its frames is short: by its time no stop would come after the first frame any more.
        if (has_new_frames) whole_s = finished.seconds;
        ASSERT_EQ(leftovers(out), std::vector<std::string>()) << when();
        ASSERT_EQ(differences(out, undisturbed), "") << when();
    }
    EXPECT_GE(stops, kStops) << "the program was too quick to be stopped";
    EXPECT_GT(with_new_frames, 0) << "no stop came after the first frame";
}

// Frames enough that what comes before the first, the same for any number of them, isn't most of a bake.
const SmallShot kBoth{.frames = 12};
const SmallShot kMapsOnly{.frames = 12, .mesh = false, .maps = "\"displacement\", \"slope-variance\""};
const SmallShot kVolumes{
    .frames = 12, .mesh = false, .maps = "\"displacement\"", .volumes = "\"spray\", \"level-set\""};

INSTANTIATE_TEST_SUITE_P(Failures, BakeStopped,
                         ::testing::Values(Stop{"Killed", SIGKILL, kBoth},
                                           Stop{"KilledMapsOnly", SIGKILL, kMapsOnly},
                                           Stop{"KilledVolumes", SIGKILL, kVolumes},
                                           Stop{"Interrupted", SIGINT, kBoth},
                                           Stop{"InterruptedVolumes", SIGINT, kVolumes},
                                           Stop{"InterruptedMapsOnly", SIGINT, kMapsOnly}),
                         [](const auto& one) { return one.param.name; });

class BakeSignal : public ::testing::TestWithParam<int> {};

TEST_P(BakeSignal, StopsAfterTheFileAtHandAndTheNextRunGoesOn) {
    const TempFolder folder;
    write_file(folder.path() / "shot.toml", text_of({.frames = 30}));
    const fs::path out = folder.path() / "out";
    const Launch bake{.arguments = {"bake", "shot.toml", "--out", "out"}, .folder = folder.path()};
    Running running(bake);
    ASSERT_TRUE(wait_until(running, [&] { return fs::exists(out / "mesh/small.0003.usda"); }))
        << running.messages();
    running.send(GetParam());
    const Ended ended = running.wait();
    EXPECT_FALSE(ended.killed) << "it ends by itself";
    EXPECT_EQ(ended.status, 128 + GetParam()) << ended.err;
    EXPECT_TRUE(has(ended.err, "of the 30 frames asked for are whole in out")) << ended.err;
    EXPECT_TRUE(has(ended.err, "run the same command again to continue")) << ended.err;
    EXPECT_EQ(ended.out, "");
    EXPECT_EQ(torn_files(out), "");
    EXPECT_EQ(leftovers(out), std::vector<std::string>());
    EXPECT_FALSE(fs::exists(out / "mesh/small.0030.usda")) << "it went on to the end";

    const Ended finished = run(bake);
    EXPECT_EQ(finished.status, 0) << finished.err;
    EXPECT_TRUE(has(finished.out, "kept as they were")) << finished.out;
    EXPECT_TRUE(fs::exists(out / "mesh/small.0030.usda"));
    ASSERT_EQ(run({.arguments = {"bake", "shot.toml", "--out", "whole"}, .folder = folder.path()}).status, 0);
    EXPECT_EQ(differences(out, folder.path() / "whole"), "");
}

INSTANTIATE_TEST_SUITE_P(Failures, BakeSignal, ::testing::Values(SIGINT, SIGTERM, SIGHUP, SIGQUIT),
                         [](const auto& one) -> std::string { return sigabbrev_np(one.param); });

// A killed bake of a shot with a mesh, and then one without in the same folder.
TEST(BakeStop, WhatAKilledBakeLeftIsGoneAfterTheNextWhateverItMakes) {
    const TempFolder folder;
    write_file(folder.path() / "maps.toml", text_of(kMapsOnly));
    const fs::path out = folder.path() / "out";
    fs::create_directories(out / "mesh");
    std::array<char, 256> host{};
    ASSERT_EQ(gethostname(host.data(), host.size() - 1), 0);
    write_file(out / "mesh" / (std::string(".pelagic-1-5@") + host.data()), "half a file");
    ASSERT_FALSE(leftovers(out).empty());
    EXPECT_EQ(run({.arguments = {"bake", "maps.toml", "--out", "out"}, .folder = folder.path()}).status, 0);
    EXPECT_EQ(leftovers(out), std::vector<std::string>());
}

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
        ASSERT_TRUE(wait_until(running, [&] { return fs::exists(out / "mesh/small.0002.usda"); }))
            << running.messages();
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
