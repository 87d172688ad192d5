// Folders that can't be written and disks that fill up: a message, no torn file, nothing left behind, and
// everything that was done is kept for the next run.
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/plugin/host/cli/program.h"
#include "tests/plugin/host/cli/small_shot.h"

namespace pelagic::test {
namespace {

namespace fs = std::filesystem;

// Root may write anywhere: what stops everybody is a file where a folder should be.
TEST(BakeDisk, AFileInTheWayOfTheFolderIsSaid) {
    const TempFolder folder;
    write_file(folder.path() / "shot.toml", text_of({}));
    write_file(folder.path() / "file", "kept");
    for (const char* out : {"file", "file/below"}) {
        const Ended ended = run({.arguments = {"bake", "shot.toml", "--out", out}, .folder = folder.path()});
        EXPECT_EQ(ended.status, 2) << out;
        EXPECT_TRUE(has(ended.err, "'" + std::string(out) + "'")) << ended.err;
        EXPECT_TRUE(has(ended.err, "a file, not a folder")) << ended.err;
        EXPECT_TRUE(has(ended.err, "choose another folder")) << "what to do: " << ended.err;
        EXPECT_EQ(ended.out, "");
    }
    EXPECT_EQ(read_file(folder.path() / "file"), "kept");
    EXPECT_EQ(files_below(folder.path()).size(), 2u);
}

TEST(BakeDisk, AFolderInTheWayOfAFileIsSaid) {
    const TempFolder folder;
    write_file(folder.path() / "shot.toml", text_of({.frames = 3}));
    fs::create_directories(folder.path() / "out/mesh/small.0002.usda");
    const Ended ended = run({.arguments = {"bake", "shot.toml", "--out", "out"}, .folder = folder.path()});
    EXPECT_EQ(ended.status, 2);
    EXPECT_TRUE(has(ended.err, "small.0002.usda")) << ended.err;
    EXPECT_TRUE(fs::exists(folder.path() / "out/mesh/small.0001.usda")) << "the frame before is kept";
    EXPECT_EQ(leftovers(folder.path()), std::vector<std::string>());
}

TEST(BakeDisk, AReadOnlyFileSystemIsSaid) {
    const TempFolder folder;
    write_file(folder.path() / "shot.toml", text_of({}));
    fs::create_directory(folder.path() / "disk");
    const std::string problem = mount_disk({.folder = folder.path() / "disk", .read_only = true});
    if (!problem.empty()) GTEST_SKIP() << "a read-only file system can't be mounted here: " << problem;
    for (const char* out : {"disk", "disk/new"}) {
        const Ended ended = run({.arguments = {"bake", "shot.toml", "--out", out}, .folder = folder.path()});
        EXPECT_EQ(ended.status, 75) << out;
        EXPECT_TRUE(has(ended.err, "the file system is read-only")) << ended.err;
        EXPECT_TRUE(has(ended.err, "'" + std::string(out) + "'")) << ended.err;
    }
}

TEST(BakeDisk, AFullDiskLosesNothingAndMoreRoomFinishesTheShot) {
    const TempFolder folder;
    // About 250 kB a frame: a few fit into a megabyte, twelve don't.
    write_file(folder.path() / "shot.toml",
               text_of({.frames = 12, .quads = 32, .volumes = "\"spray\", \"level-set\""}));
    fs::create_directory(folder.path() / "disk");
    const std::string problem = mount_disk({.folder = folder.path() / "disk", .size = "1m"});
    if (!problem.empty()) GTEST_SKIP() << "a small disk can't be mounted here: " << problem;
    const Launch bake{.arguments = {"bake", "shot.toml", "--out", "disk"}, .folder = folder.path()};

    const Ended full = run(bake);
    EXPECT_EQ(full.status, 75);
    EXPECT_TRUE(has(full.err, "no space left on the device")) << full.err;
    EXPECT_TRUE(has(full.err, "disk/")) << "names the file: " << full.err;
    EXPECT_TRUE(has(full.err, "run again to continue")) << full.err;
    EXPECT_EQ(torn_files(folder.path() / "disk"), "");
    EXPECT_EQ(leftovers(folder.path() / "disk"), std::vector<std::string>());
    ASSERT_TRUE(fs::exists(folder.path() / "disk/mesh/small.0001.usda"))
        << "the test needs frames before the disk fills";
    ASSERT_FALSE(fs::exists(folder.path() / "disk/mesh/small.0012.usda")) << "and a disk that fills";
    const fs::file_time_type first = fs::last_write_time(folder.path() / "disk/mesh/small.0001.usda");

    EXPECT_EQ(run(bake).status, 75) << "still full";
    EXPECT_EQ(torn_files(folder.path() / "disk"), "");
    EXPECT_EQ(leftovers(folder.path() / "disk"), std::vector<std::string>());

    ASSERT_EQ(mount_disk({.folder = folder.path() / "disk", .size = "16m", .again = true}), "");
    const Ended finished = run(bake);
    EXPECT_EQ(finished.status, 0) << finished.err;
    EXPECT_TRUE(has(finished.out, "kept as they were")) << finished.out;
    EXPECT_EQ(fs::last_write_time(folder.path() / "disk/mesh/small.0001.usda"), first)
        << "kept, not baked again";
    ASSERT_EQ(run({.arguments = {"bake", "shot.toml", "--out", "whole"}, .folder = folder.path()}).status, 0);
    EXPECT_EQ(differences(folder.path() / "disk", folder.path() / "whole"), "");
}

}  // namespace
}  // namespace pelagic::test
