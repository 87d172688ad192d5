// How the program ends where its surroundings fail: full or closed outputs, readers that leave, limits, no threads.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "tests/plugin/host/cli/program.h"
#include "tests/plugin/host/cli/small_shot.h"

namespace pelagic::test {
namespace {

namespace fs = std::filesystem;

class Endings : public ::testing::Test {
  protected:
    void SetUp() override { write_file(folder() / "small.toml", text_of({.frames = 3})); }
    const fs::path& folder() const { return folder_.path(); }
    // Of bash, in which $P is the program.
    Ended shell(const std::string& line) const {
        return run({.arguments = {"-c", "P='" PELAGIC_PROGRAM "'; " + line},
                    .folder = folder(),
                    .program = "/bin/bash"});
    }
    void bake_whole() const { ASSERT_EQ(shell("$P bake small.toml --out whole >&2").status, 0); }

  private:
    TempFolder folder_;
};

TEST_F(Endings, WhatIsPrintedHasArrivedOrTheProgramSaysThatItHasnt) {
    for (const char* arguments :
         {"--help", "-h", "--version", "bake --help", "render --help", "preview --help", "explain --help",
          "validate --help", "keys --help", "keys", "explain small.toml", "validate small.toml",
          "bake small.toml --out out", "render small.toml --out out --size 16x8 --frames 1 --samples 1"})
        for (const char* output : {">/dev/full", ">&-"}) {
            const Ended ended = shell("$P " + std::string(arguments) + " " + output);
            EXPECT_EQ(ended.status, 75) << arguments << output;
            EXPECT_TRUE(has(ended.err, "standard output can't be written to"))
                << arguments << output << ended.err;
        }
}

TEST_F(Endings, AReaderThatLeavesEndsItWithoutAWord) {
    for (const char* arguments : {"--help", "keys", "explain small.toml", "validate small.toml"}) {
        const Ended ended =
            shell("{ sleep 0.1; $P " + std::string(arguments) + "; echo $? > status; } | true; cat status");
        EXPECT_EQ(ended.out, "141\n") << arguments;
        EXPECT_EQ(ended.err, "") << arguments;
    }
    // A bake finishes before.
    const Ended ended = shell("{ $P bake small.toml --out out; echo $? > status; } | true; cat status");
    EXPECT_EQ(ended.out, "141\n");
    EXPECT_FALSE(has(ended.err, "standard output")) << ended.err;
    bake_whole();
    EXPECT_EQ(differences(folder() / "out", folder() / "whole"), "");
}

TEST_F(Endings, NoFileTakesAClosedStreamsPlace) {
    bake_whole();
    for (const char* closed : {"2>&-", "0<&- 2>&-", "1>&- 2>&-", "0<&- 1>&- 2>&-"}) {
        fs::remove_all(folder() / "out");
        shell("$P bake small.toml --out out " + std::string(closed));
        EXPECT_EQ(differences(folder() / "out", folder() / "whole"), "") << closed;
        EXPECT_EQ(leftovers(folder()), std::vector<std::string>()) << closed;
    }
}

// ulimit -f counts in blocks of 1 KiB.
TEST_F(Endings, ALogBeyondTheLimitOfFilesIsNoSignal) {
    for (const char* verb : {"validate", "explain", "bake", "render", "preview"}) {
        const Ended ended =
            shell("head -c 4096 /dev/zero > log; echo 'x = 1' > wrong.toml; ulimit -f 4; $P " +
                  std::string(verb) + " wrong.toml 2>> log");
        EXPECT_EQ(ended.status, 2) << verb;
    }
    const Ended ended = shell("ulimit -f 4; $P keys > keys.txt");
    EXPECT_EQ(ended.status, 75);
    EXPECT_TRUE(has(ended.err, "standard output can't be written to")) << ended.err;
    const Ended baked = shell("ulimit -f 1; $P bake small.toml --out out");
    EXPECT_EQ(baked.status, 75);
    EXPECT_TRUE(has(baked.err, "ulimit -f")) << baked.err;
    EXPECT_EQ(torn_files(folder() / "out"), "");
    EXPECT_EQ(leftovers(folder() / "out"), std::vector<std::string>());
}

// The system may refuse the first thread, or a later one, which a thread of oneTBB's own asks for.
TEST_F(Endings, ThreadsThatTheSystemRefusesAreSaid) {
    write_file(folder() / "volumes.toml",
               text_of({.name = "volumes", .frames = 1, .volumes = "\"level-set\""}));
    for (const char* arguments :
         {"bake small.toml --out out", "bake volumes.toml --out out",
          "render small.toml --out out --size 16x8 --samples 1", "explain --measure small.toml"})
        for (const int threads : {0, 1, 2, 4, 6}) {
            fs::remove_all(folder() / "out");
            const Ended ended =
                shell("ulimit -c 0; export LD_PRELOAD='" PELAGIC_FEW_THREADS "' PELAGIC_TEST_THREADS=" +
                      std::to_string(threads) + "; $P " + arguments + " --threads 12");
            if (ended.status != 0) {  // it may have done with fewer
                EXPECT_EQ(ended.status, 75) << arguments << ' ' << threads << ended.err;
                EXPECT_TRUE(has(ended.err, "the system refuses another thread; ask for fewer with --threads"))
                    << arguments << ' ' << threads << ended.err;
            }
            EXPECT_EQ(torn_files(folder()), "");
        }
}

// Four tasks of one shot in one folder, whose locks keep nobody out, as on a file system that locks for each machine alone: the
// record has the frames of all of them, and is the one that a single run leaves.
TEST_F(Endings, TasksWhoseLocksDontLockLoseNoFrame) {
    write_file(folder() / "task.toml",
               text_of({.name = "task", .frames = 200, .mesh = false, .maps = "\"displacement\""}));
    std::string tasks = "export LD_PRELOAD='" PELAGIC_NO_LOCKS "'; ";
    for (int first = 1; first <= 200; first += 50)
        tasks += "$P bake task.toml --out out --threads 1 --frames " + std::to_string(first) + '-' +
                 std::to_string(first + 49) + " & ";
    const Ended ended = shell(tasks + "wait");
    const Ended verified = shell("$P verify out");
    EXPECT_EQ(verified.status, 0) << ended.err << verified.out;
    EXPECT_EQ(shell("$P bake task.toml --out one && diff -r one out").status, 0);
}

// A frame of a shot of ten thousand that are there costs what it costs among few: their record isn't written anew for it, nor are
// their entries taken apart.
TEST_F(Endings, AFrameOfALongRecordCostsAFrame) {
    constexpr int kFrames = 10000;
    constexpr double kMost =
        1.6;  // of the processor's time: 1.1 alone on a machine, 2.2 where each entry is looked through twice
    write_file(folder() / "long.toml", text_of({.name = "long", .frames = kFrames}));
    for (const std::string out : {"out", "short"})  // which then have the stage's sky, too
        ASSERT_EQ(shell("$P bake long.toml --frames 1-2 --out " + out).status, 0);
    const fs::path file = folder() / "out" / "long.json";
    std::string record = files_below(folder() / "out").at("long.json");
    const std::size_t begin = record.find("\n    \"2\": {"), end = record.rfind("\n  }\n}\n");
    ASSERT_TRUE(begin < end && end != std::string::npos);
    const std::string entry = record.substr(begin + 8, end - begin - 8), rest = record.substr(end);
    record.resize(end);
    for (int frame = 3; frame <= kFrames; ++frame)
        if (frame != 5000 && frame != 7000) record += ",\n    \"" + std::to_string(frame) + "\"" + entry;
    write_file(file, record + rest);
    fs::remove_all(folder() / "out" / "mesh");
    double least_s[2] = {1e9, 1e9};
    for (int times = 0; times < 5; ++times)
        for (const bool is_long : {false, true}) {
            const std::string out = is_long ? "out" : "short";
            const Ended ended = shell("$P bake long.toml --out " + out + " --frames 5000");
            ASSERT_EQ(ended.status, 0) << ended.err;
            EXPECT_EQ(files_below(folder() / out).count("mesh/long.5000.usda"), 1u)
                << files_below(folder() / out).rbegin()->first;
            least_s[is_long] = std::min(least_s[is_long], ended.cpu_s);
            fs::remove_all(folder() / out / "mesh");
            fs::remove_all(folder() / out / "record");
        }
    EXPECT_LT(least_s[1], kMost * least_s[0]);
}

// A task whose folder has the stage's sky doesn't make it again, which takes several times as long as such a frame; one that is
// damaged or another light's is made.
TEST_F(Endings, ASkyThatIsThereCostsNothing) {
    constexpr double kMost = 0.6;  // of the processor's time; 0.3 alone on a machine
    const std::string shot = text_of({.name = "lit", .frames = 9});
    write_file(folder() / "lit.toml", shot);
    double least_s[2] = {1e9, 1e9};
    for (int times = 0; times < 4; ++times) {
        fs::remove_all(folder() / "out");
        for (const int frame : {1, 2}) {
            const Ended ended = shell("$P bake lit.toml --out out --frames " + std::to_string(frame));
            ASSERT_EQ(ended.status, 0) << ended.err;
            least_s[frame - 1] = std::min(least_s[frame - 1], ended.cpu_s);
        }
    }
    EXPECT_LT(least_s[1], kMost * least_s[0]);

    const std::string sky = read_file(folder() / "out" / "lit.sky.exr");
    write_file(folder() / "out" / "lit.sky.exr", sky.substr(0, sky.size() - 1) + '?');
    for (const bool is_gone : {false, true}) {
        if (is_gone) fs::remove(folder() / "out" / "lit.sky.exr");
        ASSERT_EQ(shell("$P bake lit.toml --out out --frames 2").status, 0);
        EXPECT_TRUE(read_file(folder() / "out" / "lit.sky.exr") == sky);
    }
    write_file(folder() / "lit.toml", shot + "[light]\nsun_elevation_deg = 3.0\n");
    ASSERT_EQ(shell("$P bake lit.toml --out out && $P bake lit.toml --out new && diff -r out new").status, 0);
    EXPECT_FALSE(read_file(folder() / "new" / "lit.sky.exr") == sky);
}

// A frame costs what it costs in a shot of ten, in time and in bytes, however long its shot is and however its camera moves.
TEST_F(Endings, AFrameOfAVeryLongShotCostsAFrame) {
    constexpr std::uintmax_t kMore = 1 << 20;  // bytes: the camera's course between its keys
    const auto shot = [](const std::string& frames, const std::string& camera, const std::string& output) {
        return "[shot]\nname = \"s\"\nframes = " + frames +
               "\ntime_scale = 0.001\n[surface]\nresolution = 8\nsize_m = 20.0\n[waves]\n"
               "cascades = [{ size_m = 64.0, resolution = 32 }]\n[light]\nvisibility_km = 30\n[camera]\n" +
               camera + "\n[effects]\nspray = true\n[output]\nvoxel_m = 4.0\n" + output;
    };
    const std::string keys =
        "keys = [{ frame = 1, position_m = [0, -60, 4], look_at_m = [0, 0, 0], fov_deg = 50 }, { frame = 9000000, "
        "position_m = [90, 7, 9], look_at_m = [3, 2, 1], fov_deg = 40 }, { frame = 90000000, position_m = [-50, 8, 70], "
        "look_at_m = [3, 2, 1], roll_deg = 9 }]\ninterpolation = ";
    const std::string spray = "volumes = [\"spray\"]";
    for (const auto& [camera, output] :
         {std::pair(std::string(), spray), std::pair(keys + "\"linear\"", std::string()),
          std::pair(keys + "\"smooth\"", spray)}) {
        std::uintmax_t bytes[2]{};
        double seconds[2]{};
        for (const bool is_long : {false, true}) {
            fs::remove_all(folder() / "out");
            write_file(folder() / "s.toml",
                       shot(is_long ? "[-100000000, 100000000]" : "[1, 10]", camera, output));
            for (int times = 0; times < 3; ++times) {  // the least, of a machine that others use
                fs::remove_all(folder() / "out");
                const Ended baked = shell("$P bake s.toml --out out --frames 5");
                ASSERT_EQ(baked.status, 0) << baked.err;
                const Ended verified = shell("$P verify out");
                EXPECT_TRUE(has(verified.out, "lacks frames that aren't baked: ")) << verified.out;
                const double took = baked.cpu_s + verified.cpu_s;
                seconds[is_long] = times == 0 ? took : std::min(seconds[is_long], took);
            }
            for (const auto& [name, content] : files_below(folder() / "out"))
                bytes[is_long] += content.size();
        }
        EXPECT_LT(bytes[1], bytes[0] + kMore) << camera << output;
        EXPECT_LT(seconds[1], 3.0 * seconds[0]) << camera << output;
    }
}

TEST_F(Endings, AFolderThatCantBeLockedIsSaid) {
    const Ended ended = shell("export LD_PRELOAD='" PELAGIC_NO_LOCKS
                              "' PELAGIC_TEST_LOCK_ERROR=37; "
                              "$P bake small.toml --out out");
    EXPECT_EQ(ended.status, 0) << ended.err;
    EXPECT_TRUE(has(ended.err, "out can't be locked (No locks available)")) << ended.err;
}

TEST_F(Endings, APipeOrADeviceIsNoFile) {
    const std::string sea = "[sea]\nspectrum = \"file\"\nspectrum_time = 2019-02-06T00:40:00Z\n";
    write_file(folder() / "buoy.toml", sea + "spectrum_file = \"pipe.txt\"\n");
    write_file(folder() / "buoy-device.toml", sea + "spectrum_file = \"/dev/zero\"\n");
    write_file(folder() / "sky.toml", "[light]\nsky = \"pipe.exr\"\n");
    write_file(folder() / "sky-device.toml", "[light]\nsky = \"/dev/null\"\n");
    fs::create_directory(folder() / "folder.toml");
    shell("mkfifo pipe pipe.txt pipe.exr");
    for (const char* file : {"pipe", "folder.toml", "/dev/null/x", "buoy.toml", "buoy-device.toml",
                             "sky.toml", "sky-device.toml"})
        for (const std::string verb :
             {"validate ", "explain ", "bake ", "render --size 16x8 ", "preview --offscreen x.png "}) {
            const Ended ended = shell("timeout 20 $P " + verb + file);
            EXPECT_EQ(ended.status, 2) << verb << file << ended.err;
            EXPECT_TRUE(ended.err.starts_with(file)) << verb << file << ended.err;
        }
}

TEST_F(Endings, AShotMayComeThroughAPipeThatTheShellHolds) {
    EXPECT_EQ(shell("cat small.toml | $P validate /dev/stdin").status, 0);
    EXPECT_EQ(shell("$P validate <(cat small.toml)").status, 0);
}

}  // namespace
}  // namespace pelagic::test
