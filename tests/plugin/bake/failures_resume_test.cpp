// A second run: it keeps the frames that are whole and of this very shot, does all others again, and always
// ends at the same bytes.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <thread>

#include "tests/plugin/host/cli/program.h"
#include "tests/plugin/host/cli/small_shot.h"

namespace pelagic::test {
namespace {

namespace fs = std::filesystem;

class BakeResume : public ::testing::Test {
  protected:
    void SetUp() override {
        write_shot({.frames = 8});
        ASSERT_EQ(bake().status, 0);
    }
    const fs::path& folder() const { return folder_.path(); }
    void write_shot(const SmallShot& shot) const { write_file(folder() / "shot.toml", text_of(shot)); }
    Ended bake(std::vector<std::string> more = {}, const std::string& out = "out") const {
        std::vector<std::string> arguments{"bake", "shot.toml", "--out", out};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run({.arguments = arguments, .folder = folder()});
    }
    // The same as a bake of this shot into an empty folder.
    void expect_as_new() const {
        fs::remove_all(folder() / "new");
        ASSERT_EQ(bake({}, "new").status, 0);
        EXPECT_EQ(differences(folder() / "out", folder() / "new"), "");
    }

  private:
    TempFolder folder_;
};

TEST_F(BakeResume, WholeFramesAreKept) {
    const fs::path frame = folder() / "out/mesh/small.0005.usda";
    const auto before = fs::last_write_time(frame);
    const Ended ended = bake();
    EXPECT_EQ(ended.status, 0);
    EXPECT_NE(ended.out.find("0 frames baked, 8 kept as they were"), std::string::npos) << ended.out;
    EXPECT_EQ(fs::last_write_time(frame), before);
    expect_as_new();
}

TEST_F(BakeResume, AShotThatGrowsKeepsWhatItHas) {
    write_shot({.frames = 10});
    const Ended ended = bake();
    EXPECT_EQ(ended.status, 0);
    EXPECT_NE(ended.out.find("2 frames baked, 8 kept as they were"), std::string::npos) << ended.out;
    expect_as_new();
}

TEST_F(BakeResume, FramesOfAnotherVersionThatWereNotAskedForAreNamed) {
    write_shot({.frames = 8, .seed = 2});
    const Ended ended = bake({"--frames", "3-4"});
    EXPECT_EQ(ended.status, 0) << "all that was asked for is there";
    EXPECT_NE(ended.err.find("the frames 1-2, 5-8 are of another version of this shot"), std::string::npos)
        << ended.err;
    EXPECT_NE(ended.err.find("--frames"), std::string::npos) << "what to do: " << ended.err;
    EXPECT_EQ(bake().err.find("another version"), std::string::npos);
    expect_as_new();
}

// Frame by frame, whatever the order, the number of threads and what else the run does: what lets a farm
// split a shot.
TEST_F(BakeResume, OneFrameAloneOnOneThreadIsTheSameBitsAsInARunOnTwo) {
    ASSERT_EQ(bake({"--frames", "1-8", "--threads", "2"}, "run").status, 0);
    ASSERT_EQ(bake({"--frames", "7", "--threads", "1"}, "alone").status, 0);
    for (const char* file : {"mesh/small.0007.usda", "maps/small.displacement.0007.exr",
                             "maps/small.whitecaps.0007.exr", "small.usda", "small.camera.usdc",
                             "small.sky.exr", "mesh/small.topology.usda", "mesh/small.manifest.usda"}) {
        ASSERT_TRUE(fs::exists(folder() / "alone" / file)) << file;
        EXPECT_EQ(read_file(folder() / "alone" / file), read_file(folder() / "run" / file)) << file;
    }
}

TEST_F(BakeResume, PartsThatAreBakedOneAfterAnotherMakeTheWhole) {
    ASSERT_EQ(bake({"--frames", "5-8"}, "parts").status, 0);
    ASSERT_EQ(bake({"--frames", "1-8x3"}, "parts").status, 0);
    ASSERT_EQ(bake({"--frames", "1-4"}, "parts").status, 0);
    EXPECT_EQ(differences(folder() / "out", folder() / "parts"), "");
    const Ended all = bake({}, "parts");
    EXPECT_NE(all.out.find("0 frames baked, 8 kept as they were"), std::string::npos) << all.out;
}

// A camera that comes down sees finer water from frame to frame; what the record says of the plan is the shot's.
TEST_F(BakeResume, PartsOfWhatACameraSeesMakeTheWhole) {
    write_file(folder() / "shot.toml", R"(
[shot]
name = "small"
frames = [1, 4]
[surface]
kind = "projected-grid"
[camera]
resolution = [32, 18]
keys = [ { frame = 1, position_m = [0, -60, 200], look_at_m = [0, 0, 2] }, { frame = 4, position_m = [0, -60, 3], look_at_m = [0, 0, 2] } ]
[effects]
whitecaps = false
)");
    ASSERT_EQ(bake({}, "whole").status, 0);
    for (const char* part : {"4", "1", "2-3"}) ASSERT_EQ(bake({"--frames", part}, "parts").status, 0);
    EXPECT_EQ(differences(folder() / "whole", folder() / "parts"), "");
}

// `pelagic verify`: what it says and its exit status.
TEST_F(BakeResume, VerifySaysWhatIsWrongAndItsStatus) {
    const auto verify = [&](std::vector<std::string> folders) {
        folders.insert(folders.begin(), "verify");
        return run({.arguments = folders, .folder = folder()});
    };
    Ended ended = verify({"out"});
    EXPECT_EQ(ended.status, 0) << ended.out;
    EXPECT_NE(ended.out.find("out: 1 shot, 29 files, "), std::string::npos) << ended.out;
    EXPECT_NE(ended.out.find(": all whole"), std::string::npos) << ended.out;
    std::string mesh = read_file(folder() / "out/mesh/small.0003.usda");
    mesh[mesh.size() / 2] ^= 1;
    write_file(folder() / "out/mesh/small.0003.usda", mesh);
    fs::remove(folder() / "out/maps/small.whitecaps.0004.exr");
    write_file(folder() / "out/maps/old.normal.0001.exr", "somebody's");
    ended = verify({"out"});
    EXPECT_EQ(ended.status, 3);
    for (const char* line :
         {"damaged: out/mesh/small.0003.usda holds other bytes than were written",
          "missing: out/maps/small.whitecaps.0004.exr is missing",
          "foreign: out/maps/old.normal.0001.exr is in no record here", "1 missing, 1 damaged, 1 foreign"})
        EXPECT_NE(ended.out.find(line), std::string::npos) << line << "\n" << ended.out;
    ended = bake();
    EXPECT_EQ(ended.status, 0);
    EXPECT_NE(ended.out.find("2 frames baked, 6 kept"), std::string::npos) << ended.out;
    EXPECT_NE(ended.err.find("in out mesh/small.0003.usda holds other bytes than were written"),
              std::string::npos)
        << ended.err;
    fs::remove(folder() / "out/maps/old.normal.0001.exr");
    expect_as_new();
    EXPECT_EQ(verify({"out", "new"}).status, 0);
    EXPECT_EQ(verify({"out", "nowhere", "new"}).status, 3);
    EXPECT_EQ(verify({}).status, 2);
    fs::create_directory(folder() / "empty");
    ended = verify({"empty"});
    EXPECT_EQ(ended.status, 3);
    EXPECT_NE(ended.out.find("no bake and no pictures are here"), std::string::npos) << ended.out;
}

// A pipe in the record's place: it would wait for a writer for ever.
TEST_F(BakeResume, APipeInTheRecordsPlaceIsRefused) {
    fs::remove(folder() / "out/small.json");
    ASSERT_EQ(mkfifo((folder() / "out/small.json").c_str(), 0600), 0);
    const Ended ended = bake();
    EXPECT_EQ(ended.status, 2);
    EXPECT_NE(ended.err.find("the record 'out/small.json' is a pipe, not a file: move it away"),
              std::string::npos)
        << ended.err;
}

TEST_F(BakeResume, ALockHeldElsewhereIsSaidAndCtrlCEndsTheWaiting) {
    const int theirs = open((folder() / "out").c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    ASSERT_EQ(flock(theirs, LOCK_EX), 0);
    Running waiting({.arguments = {"bake", "shot.toml", "--out", "out"}, .folder = folder()});
    const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(1);
    while (waiting.messages().find("waiting for another bake") == std::string::npos && !waiting.has_ended() &&
           std::chrono::steady_clock::now() < end)
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    waiting.send(SIGINT);
    const Ended ended = waiting.wait();
    EXPECT_NE(ended.err.find("waiting for another bake that writes into the same folder"), std::string::npos)
        << ended.err;
    EXPECT_EQ(ended.status, 130);
    close(theirs);
    EXPECT_EQ(bake().status, 0);
}

}  // namespace
}  // namespace pelagic::test
