// Complete files or none: what a name has after success, failure and a kill.
#include "plugin/files/files.h"

#include "plugin/files/checksum.h"
#include "plugin/files/read.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace pelagic::files {
namespace {

namespace fs = std::filesystem;

std::string contents(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<std::string> names_in(const fs::path& folder) {
    std::vector<std::string> names;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder))
        names.push_back(entry.path().filename());
    std::sort(names.begin(), names.end());
    return names;
}

// The error of writing `bytes` to `target`; without an exception code() is 0 and what() empty.
FileError write_error(const fs::path& target, const std::string& bytes) {
    try {
        write_atomically(target, bytes);
    } catch (const FileError& error) {
        return error;
    }
    return FileError("", target, {});
}

FileError folder_error(const fs::path& folder) {
    try {
        ensure_folder(folder);
    } catch (const FileError& error) {
        return error;
    }
    return FileError("", folder, {});
}

bool says(const FileError& error, const std::string& text) {
    return std::string(error.what()).find(text) != std::string::npos;
}

// A temporary folder for each test.
class Files : public testing::Test {
  protected:
    Files() {
        std::string pattern = (fs::temp_directory_path() / "pelagic-files-XXXXXX").string();
        if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("no temporary folder");
        folder_ = pattern;
    }
    ~Files() override {
        std::error_code ignored;
        fs::remove_all(folder_, ignored);
    }

    fs::path folder_;
};

// A small file system in memory, unmounted at the end. Only root may mount.
class Mount {
  public:
    Mount(const fs::path& folder, const std::string& options) : folder_(folder) {
        fs::create_directories(folder);
        mounted_ = mount("tmpfs", folder.c_str(), "tmpfs", 0, options.c_str()) == 0;
    }
    Mount(const Mount&) = delete;
    Mount& operator=(const Mount&) = delete;
    ~Mount() {
        if (mounted_) umount(folder_.c_str());
    }
    explicit operator bool() const { return mounted_; }
    bool make_read_only() {
        return mount("tmpfs", folder_.c_str(), "tmpfs", MS_REMOUNT | MS_RDONLY, "") == 0;
    }

  private:
    fs::path folder_;
    bool mounted_ = false;
};

TEST_F(Files, AFileIsWrittenAndReplacedAndNothingElseIsLeft) {
    const fs::path target = folder_ / "sea.0001.exr";
    write_atomically(target, std::string_view("first, the longer one"));
    EXPECT_EQ(contents(target), "first, the longer one");
    const std::array<std::byte, 3> bytes{std::byte{0}, std::byte{255}, std::byte{10}};
    write_atomically(target, std::span<const std::byte>(bytes));
    EXPECT_EQ(contents(target), std::string("\0\xff\n", 3));
    write_atomically(target, std::string_view());
    EXPECT_EQ(contents(target), "");
    EXPECT_EQ(names_in(folder_), std::vector<std::string>{"sea.0001.exr"});
}

// A name without a folder is in the working folder. A name of the greatest length still leaves room
// for its hidden file.
TEST_F(Files, PiecesMakeOneFileAndAnErrorBetweenThemLeavesTheOldOne) {
    const fs::path target = folder_ / "a";
    std::string large;  // longer than what is summed at once
    for (int i = 0; i < 700000; ++i) large += static_cast<char>(i % 251);
    const FileState written = write_atomically(target, [&](const ByteSink& sink) {
        for (const std::string& piece : {std::string("one"), large, std::string()}) sink(piece);
    });
    EXPECT_EQ(written, (FileState{700003, checksum_of("one" + large)}));
    EXPECT_EQ(contents(target), "one" + large);
    const auto torn = [](const ByteSink& sink) {
        sink("half");
        throw std::domain_error("no more");
    };
    EXPECT_THROW(write_atomically(target, torn), std::domain_error);
    EXPECT_EQ(contents(target), "one" + large);
    EXPECT_EQ(names_in(folder_), std::vector<std::string>{"a"});
}

TEST_F(Files, BareNamesAndLongestNamesAreFine) {
    const fs::path before = fs::current_path();
    fs::current_path(folder_);
    EXPECT_NO_THROW(write_atomically("bare", std::string_view("x")));
    fs::current_path(before);
    EXPECT_EQ(contents(folder_ / "bare"), "x");
    const fs::path longest = folder_ / std::string(255, 'n');
    EXPECT_NO_THROW(write_atomically(longest, std::string_view("y")));
    EXPECT_EQ(contents(longest), "y");
}

// New files follow the umask, like those of any other program.
TEST_F(Files, ModeFollowsTheUmask) {
    const mode_t before = umask(027);
    write_atomically(folder_ / "file", std::string_view("x"));
    umask(before);
    struct stat status {};
    ASSERT_EQ(stat((folder_ / "file").c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777u, 0640u);
}

TEST_F(Files, AFullDiskIsReportedAndTheOldFileStays) {
    const fs::path disk = folder_ / "disk";
    const Mount mounted(disk, "size=64k");
    if (!mounted) GTEST_SKIP() << "a small file system can't be mounted here (needs root)";
    const fs::path target = disk / "sea.0001.exr";
    write_atomically(target, std::string_view("the old one"));
    const FileError error = write_error(target, std::string(1 << 20, 'x'));
    EXPECT_EQ(error.code().value(), ENOSPC);
    EXPECT_EQ(error.path(), target);
    EXPECT_TRUE(says(error, target.string())) << error.what();
    EXPECT_TRUE(says(error, "no space left")) << error.what();
    EXPECT_TRUE(says(error, "choose another folder")) << error.what();
    EXPECT_EQ(contents(target), "the old one");
    EXPECT_EQ(names_in(disk), std::vector<std::string>{"sea.0001.exr"});
    // The space is free again: a file that fits can be written at once.
    EXPECT_NO_THROW(write_atomically(target, std::string(30000, 'y')));
}

// The same failure halfway where mounting isn't allowed: a limit on file sizes instead of a full disk.
TEST_F(Files, AFileOverTheLimitIsReportedAndTheOldFileStays) {
    const fs::path target = folder_ / "sea.0001.exr";
    write_atomically(target, std::string_view("the old one"));
    rlimit before{};
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
    const auto handler = signal(SIGXFSZ, SIG_IGN);
    const rlimit small{4096, before.rlim_max};
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
    const FileError error = write_error(target, std::string(10000, 'x'));
    setrlimit(RLIMIT_FSIZE, &before);
    signal(SIGXFSZ, handler);
    EXPECT_EQ(error.code().value(), EFBIG);
    EXPECT_TRUE(says(error, target.string())) << error.what();
    EXPECT_EQ(contents(target), "the old one");
    EXPECT_EQ(names_in(folder_), std::vector<std::string>{"sea.0001.exr"});
}

TEST_F(Files, AReadOnlyFileSystemIsReported) {
    const fs::path disk = folder_ / "disk";
    Mount mounted(disk, "size=64k");
    if (!mounted) GTEST_SKIP() << "a small file system can't be mounted here (needs root)";
    write_atomically(disk / "file", std::string_view("old"));
    if (!mounted.make_read_only()) GTEST_SKIP() << "it can't be made read-only here";
    const FileError error = write_error(disk / "file", "new");
    EXPECT_EQ(error.code().value(), EROFS);
    EXPECT_TRUE(says(error, "read-only")) << error.what();
    EXPECT_EQ(contents(disk / "file"), "old");
    EXPECT_EQ(folder_error(disk).code().value(), EROFS);
    EXPECT_EQ(folder_error(disk / "maps").code().value(), EROFS);
}

// Root may write everywhere, so root becomes another user for a moment.
TEST_F(Files, AnUnwritableFolderIsReported) {
    const bool is_root = geteuid() == 0;
    const uid_t nobody = 65534;
    fs::permissions(folder_, fs::perms(0555));
    if (is_root) {
        if (seteuid(nobody) != 0) GTEST_SKIP() << "no rights can be given up here";
    }
    const FileError file = write_error(folder_ / "file", "x");
    const FileError folder = folder_error(folder_);
    const FileError deeper = folder_error(folder_ / "maps");
    if (is_root) {
        ASSERT_EQ(seteuid(0), 0);
    }
    fs::permissions(folder_, fs::perms::owner_all);
    EXPECT_EQ(file.code().value(), EACCES);
    EXPECT_TRUE(says(file, "permission denied")) << file.what();
    EXPECT_EQ(folder.code().value(), EACCES);
    EXPECT_EQ(deeper.code().value(), EACCES);
    EXPECT_TRUE(says(deeper, (folder_ / "maps").string())) << deeper.what();
    EXPECT_TRUE(names_in(folder_).empty());
}

TEST_F(Files, ThingsInTheWayAreReported) {
    fs::create_directory(folder_ / "taken");
    const FileError taken = write_error(folder_ / "taken", "x");
    EXPECT_EQ(taken.code().value(), EISDIR);
    EXPECT_TRUE(says(taken, "a folder of that name is in the way")) << taken.what();
    EXPECT_TRUE(fs::is_directory(folder_ / "taken"));

    write_atomically(folder_ / "file", std::string_view("x"));
    EXPECT_EQ(write_error(folder_ / "file" / "sea.exr", "x").code().value(), ENOTDIR);
    EXPECT_EQ(write_error(folder_ / "nowhere" / "sea.exr", "x").code().value(), ENOENT);
    EXPECT_EQ(names_in(folder_), (std::vector<std::string>{"file", "taken"}));
}

TEST_F(Files, FoldersAreMadeWithTheirParents) {
    EXPECT_NO_THROW(ensure_folder(folder_ / "a" / "b"));
    EXPECT_NO_THROW(ensure_folder(folder_ / "a" / "b"));
    EXPECT_NO_THROW(ensure_folder(folder_ / "a" / "c" / ""));
    EXPECT_NO_THROW(ensure_folder(""));  // the working folder, as parent_path() of a bare name
    EXPECT_TRUE(fs::is_directory(folder_ / "a" / "b"));
    fs::create_directory_symlink(folder_ / "a", folder_ / "link");
    EXPECT_NO_THROW(ensure_folder(folder_ / "link" / "d"));
    EXPECT_TRUE(fs::is_directory(folder_ / "a" / "d"));
}

TEST_F(Files, AFolderThatHoldsNoFilesIsReported) {
    if (!fs::is_directory("/proc/self")) GTEST_SKIP() << "this machine has no /proc";
    for (const char* folder : {"/proc/sea", "/proc/sea/maps"}) {
        EXPECT_THROW(check_folder(folder), FileError);
        const FileError error = folder_error(folder);
        EXPECT_EQ(error.code(), std::errc::not_supported) << error.what();
        EXPECT_TRUE(says(error, "the system keeps no files there: choose another folder")) << error.what();
    }
    EXPECT_EQ(write_error("/proc/sea.json", "x").code(), std::errc::not_supported);
}

TEST_F(Files, AFileWhereAFolderShouldBeIsReported) {
    write_atomically(folder_ / "file", std::string_view("x"));
    for (const fs::path& folder :
         {folder_ / "file", folder_ / "file" / "maps", folder_ / "file" / "maps" / "deep"}) {
        const FileError error = folder_error(folder);
        EXPECT_TRUE(says(error, folder.string())) << error.what();
        EXPECT_TRUE(says(error, "is a file, not a folder")) << error.what();
    }
    fs::create_symlink(folder_ / "gone", folder_ / "link");
    EXPECT_NE(folder_error(folder_ / "link").code().value(), 0);
    EXPECT_EQ(contents(folder_ / "file"), "x");
}

TEST_F(Files, SizesOfRegularFilesOnly) {
    write_atomically(folder_ / "file", std::string(12345, 'x'));
    EXPECT_EQ(files::file_size(folder_ / "file"), 12345u);
    EXPECT_EQ(files::file_size(folder_), std::nullopt);
    EXPECT_EQ(files::file_size(folder_ / "nowhere"), std::nullopt);
    EXPECT_EQ(files::file_size(folder_ / "file" / "deep"), std::nullopt);
}

// A process that keeps writing is killed until it leaves a hidden file. The name then has a complete file or
// none, and the leftover is deleted, also while others work in the same folder.
TEST_F(Files, AKilledWriterLeavesAWholeFileAndItsLeftoverIsCleared) {
    const fs::path target = folder_ / "sea.0001.exr";
    const std::string bytes(8 << 20, 'x');
    bool left = false;
    for (int attempt = 0; attempt < 50 && !left; ++attempt) {
        const pid_t child = fork();
        ASSERT_GE(child, 0);
        if (child == 0) {
            for (;;) write_atomically(target, bytes);
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(40 + attempt));
        kill(child, SIGKILL);
        int status = 0;
        waitpid(child, &status, 0);
        for (const std::string& name : names_in(folder_)) left = left || name.starts_with(".pelagic-");
    }
    ASSERT_TRUE(left) << "no kill hit a write";
    if (fs::exists(target)) {
        EXPECT_EQ(files::file_size(target), bytes.size());
    }
    EXPECT_EQ(remove_stale_temporaries(folder_), 1u);
    for (const std::string& name : names_in(folder_)) EXPECT_EQ(name, "sea.0001.exr");
}

// A process that keeps deleting leftovers never disturbs the writers.
TEST_F(Files, WritersAndClearersDoNotDisturbEachOther) {
    const auto repeat_in_child = [](auto&& work) {
        const pid_t child = fork();
        if (child != 0) return child;
        try {
            for (int i = 0; i < 1000; ++i) work(i);
        } catch (...) {
            _exit(1);
        }
        _exit(0);
    };
    std::vector<pid_t> children;
    for (const std::string name : {"a", "a", "b"})
        children.push_back(
            repeat_in_child([&](int i) { write_atomically(folder_ / name, std::to_string(i)); }));
    for (int c = 0; c < 4; ++c)
        children.push_back(repeat_in_child([&](int) { remove_stale_temporaries(folder_); }));
    for (const pid_t child : children) {
        int status = 0;
        waitpid(child, &status, 0);
        EXPECT_EQ(status, 0);
    }
    EXPECT_EQ(names_in(folder_), (std::vector<std::string>{"a", "b"}));
    EXPECT_EQ(contents(folder_ / "b"), "999");
}

// Another machine's lock may be invisible here, so its files are deleted only when older than a day. A locked
// file stays at any age, and so does a file with another kind of name.
TEST_F(Files, OnlyTheLeftoversOfTheDeadAreCleared) {
    const auto make = [this](const char* name, bool old) {
        std::ofstream(folder_ / name) << "x";
        if (old)
            fs::last_write_time(folder_ / name, fs::file_time_type::clock::now() - std::chrono::hours(25));
    };
    make(".pelagic-1-0@another.machine", false);
    make(".pelagic-1-1@another.machine", true);
    make(".pelagic-1-2@another.machine", true);
    make(".hidden", true);
    make("pelagic-1-0@another.machine", true);
    const int locked = open((folder_ / ".pelagic-1-2@another.machine").c_str(), O_RDWR | O_CLOEXEC);
    ASSERT_EQ(flock(locked, LOCK_EX | LOCK_NB), 0);
    EXPECT_EQ(remove_stale_temporaries(folder_), 1u);
    EXPECT_EQ(names_in(folder_),
              (std::vector<std::string>{".hidden", ".pelagic-1-0@another.machine",
                                        ".pelagic-1-2@another.machine", "pelagic-1-0@another.machine"}));
    close(locked);
    EXPECT_EQ(remove_stale_temporaries(folder_), 1u);
    EXPECT_EQ(remove_stale_temporaries(folder_ / "nowhere"), 0u);
}

// The published values of XXH3 with 64 bits and no seed.
TEST(Checksums, AreXxh3WhateverThePieces) {
    EXPECT_EQ(checksum_of(""), "2d06800538d394c2");
    const std::string bytes = std::string(5000, 'a') + '\0' + std::string(300, 'b');
    Checksum sum;
    for (std::size_t at = 0; at < bytes.size(); at += 77) sum.add(std::string_view(bytes).substr(at, 77));
    EXPECT_EQ(sum.text(), checksum_of(bytes));
    EXPECT_EQ(sum.text().size(), 16u);
}

TEST_F(Files, ThatAreTheSameStayUntouched) {
    const fs::path target = folder_ / "a";
    const auto content = [](const ByteSink& sink) {
        sink("one");
        sink("two");
    };
    const FileState state{6, checksum_of("onetwo")};
    for (const char* there : {"", "onetw", "onetwo!", "oneTwo"}) {
        std::ofstream(target) << there;
        EXPECT_EQ(write_if_different(target, content), state);
        EXPECT_EQ(contents(target), "onetwo") << there;
    }
    const fs::file_time_type before = fs::last_write_time(target) - std::chrono::hours(1);
    fs::last_write_time(target, before);
    EXPECT_EQ(write_if_different(target, content), state);
    EXPECT_EQ(fs::last_write_time(target), before);
}

TEST_F(Files, ThatAreNoneAreSaidAndNotWaitedFor) {
    EXPECT_EQ(FileReader(folder_ / "a").problem(), "is missing");
    EXPECT_TRUE(FileReader(folder_ / "a").is_missing());
    EXPECT_EQ(FileReader(folder_).problem(), "is a folder, not a file");
    EXPECT_EQ(FileReader("/dev/zero").problem(), "is a device, not a file");
    ASSERT_EQ(mkfifo((folder_ / "pipe").c_str(), 0600), 0);
    EXPECT_EQ(FileReader(folder_ / "pipe").problem(), "is a pipe, not a file");
    EXPECT_FALSE(carries(folder_ / "pipe", "x"));
    std::ofstream(folder_ / "a") << "some bytes";
    std::string read;
    EXPECT_EQ(read_pieces(folder_ / "a", [&](std::string_view piece) { read += piece; }), "");
    EXPECT_EQ(read, "some bytes");
}

// A lock that another holds is waited for, told of after a second, and given up when the watch says so.
TEST_F(Files, ALockThatIsAwaitedIsToldOfAndCanBeGivenUp) {
    struct Enough {};
    double told_s = 0.0;
    {
        const files::FolderLock theirs(folder_);
        EXPECT_THROW(files::FolderLock(folder_,
                                       [&](double waited_s) {
                                           told_s = waited_s;
                                           throw Enough();
                                       }),
                     Enough);
    }
    EXPECT_GE(told_s, 1.0);
    files::FolderLock(folder_, [](double) { FAIL() << "it is free"; });
}

TEST_F(Files, CheckFolderRefusesWhatEnsureFolderWouldAndMakesNothing) {
    check_folder(folder_);
    check_folder(folder_ / "new/and/below");
    check_folder("");
    check_folder("new");
    EXPECT_TRUE(fs::is_empty(folder_));
    write_atomically(folder_ / "file", std::string_view("kept"));
    EXPECT_THROW(check_folder(folder_ / "file"), FileError);
    EXPECT_THROW(check_folder(folder_ / "file/below"), FileError);
}

}  // namespace
}  // namespace pelagic::files
