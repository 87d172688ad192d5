// A bake's memory doesn't grow with its length. A program of its own: a child's peak, as the system counts
// it, is never below that of the process that started it, and this one is small.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "tests/plugin/host/cli/program.h"

namespace pelagic::test {
namespace {

// Largest resident memory of a bake of that many frames [KiB].
long peak_kib_of(int frames, const std::filesystem::path& shot) {
    const std::string out = shot.parent_path() / std::to_string(frames),
                      range = "1-" + std::to_string(frames);
    std::array<std::string, 9> words{PELAGIC_PROGRAM, "bake", shot.string(), "--out", out,
                                     "--frames",      range,  "--threads",   "2"};
    std::array<char*, 10> arguments{};
    for (std::size_t i = 0; i < words.size(); ++i) arguments[i] = words[i].data();
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
    EXPECT_EQ(status, 0);
    EXPECT_TRUE(std::filesystem::exists(
        std::filesystem::path(out) / "mesh" /
        ("small." + std::string(frames < 1000 ? "0" : "") + std::to_string(frames) + ".usdc")));
    std::filesystem::remove_all(out);
    return usage.ru_maxrss;
}

TEST(BakeMemory, OfAThousandFramesIsThatOfAHundred) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "the sanitizer keeps freed memory";
#endif
    const TempFolder folder;
    // In memory where the system lets us: a disk's flushes would take most of the time.
    const std::string on_disk = mount_disk({.folder = folder.path(), .size = "600m"});
    if (!on_disk.empty()) RecordProperty("on_disk", on_disk);
    const std::filesystem::path shot = folder.path() / "shot.toml";
    write_file(shot,
               "[shot]\nname = \"small\"\nframes = [1, 1000]\n"
               "[waves]\ncascades = [ { size_m = 60.0, resolution = 192 } ]\n"
               "[surface]\nsize_m = 6\nresolution = 64\n"
               "[output]\nmesh = \"usdc\"\nmaps = [\"displacement\", \"normal\", \"whitecaps\"]\n"
               "map_resolution = 64\n");
    rusage own{};
    getrusage(RUSAGE_SELF, &own);
    // What the allocator keeps for each thread is chance, and so is how many frames are under way at once on busy cores: one
    // arena for all threads, and the most of three short runs.
    setenv("MALLOC_ARENA_MAX", "1", 1);
    long hundred = 0;
    for (int run = 0; run < 3; ++run) hundred = std::max(hundred, peak_kib_of(100, shot));
    const long thousand = peak_kib_of(1000, shot);
    ASSERT_GT(hundred, own.ru_maxrss) << "else it is this process that is measured";
    // One or two per cent on quiet cores and on busy ones. The rest is what two kilobytes a frame take.
    EXPECT_LT(static_cast<double>(thousand) / static_cast<double>(hundred), 1.05)
        << hundred << " KiB for a hundred, " << thousand << " for a thousand";
}

}  // namespace
}  // namespace pelagic::test
