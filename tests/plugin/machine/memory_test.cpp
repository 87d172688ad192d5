// What the system gives a process: the machine's memory, what its control groups allow, and its own limit.
#include "plugin/machine/memory.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>

namespace pelagic::machine {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMebi = std::size_t{1} << 20;

// A system as /proc/self and /sys/fs/cgroup describe it.
class Described {
  public:
    Described() {
        std::string name = (fs::temp_directory_path() / "pelagic-machine-XXXXXX").string();
        root_ = mkdtemp(name.data());
        write("process/statm", "1000 500 300 1 0 400 0");
    }
    ~Described() { fs::remove_all(root_); }
    Described(const Described&) = delete;
    Described& operator=(const Described&) = delete;

    void write(const std::string& file, const std::string& text) const {
        fs::create_directories((root_ / file).parent_path());
        std::ofstream(root_ / file) << text << '\n';
    }
    MemoryLimit limit() const {
        return memory_limit({.process = root_ / "process", .groups = root_ / "groups"});
    }

  private:
    fs::path root_;
};

std::size_t of_the_machine() {
    return static_cast<std::size_t>(sysconf(_SC_PHYS_PAGES)) *
           static_cast<std::size_t>(sysconf(_SC_PAGE_SIZE));
}

TEST(MachineMemory, IsTheMachinesWhereNothingLimitsIt) {
    const Described system;
    EXPECT_LE(system.limit().bytes, of_the_machine());
    system.write("process/cgroup", "0::/user.slice");
    system.write("groups/user.slice/memory.max", "max");
    const MemoryLimit limit = system.limit();
    EXPECT_EQ(limit.bytes, of_the_machine());
    EXPECT_EQ(limit.whose, "this machine has");
}

TEST(MachineMemory, IsTheLeastOfAGroupAndThoseAboveIt) {
    const Described system;
    system.write("process/cgroup", "0::/batch/job/step");
    system.write("groups/batch/job/step/memory.max", "max");
    system.write("groups/batch/job/memory.max", std::to_string(700 * kMebi));
    system.write("groups/batch/memory.max", std::to_string(900 * kMebi));
    EXPECT_EQ(system.limit().bytes, 700 * kMebi);
    EXPECT_NE(system.limit().whose.find("control group"), std::string::npos);
    system.write("groups/batch/job/step/memory.max", std::to_string(64 * kMebi));
    EXPECT_EQ(system.limit().bytes, 64 * kMebi);
}

TEST(MachineMemory, KnowsGroupsOfVersionOne) {
    const Described system;
    system.write("process/cgroup", "12:cpu,cpuacct:/a\n5:memory:/docker/abc\n1:name=systemd:/b\n0::/");
    system.write("groups/memory/memory.limit_in_bytes",
                 "9223372036854771712");  // none, as version 1 writes it
    EXPECT_EQ(system.limit().bytes, of_the_machine());
    system.write("groups/memory/docker/abc/memory.limit_in_bytes", std::to_string(300 * kMebi));
    EXPECT_EQ(system.limit().bytes, 300 * kMebi);
}

// A container sees its own group at the mount's top, under whatever name the machine outside gave it.
TEST(MachineMemory, TakesTheMountsTopForAGroupNamedFromOutside) {
    const Described system;
    system.write("process/cgroup", "0::/../../pod7/container9");
    system.write("groups/memory.max", std::to_string(512 * kMebi));
    EXPECT_EQ(system.limit().bytes, 512 * kMebi);
}

TEST(MachineMemory, IsWhatTheLimitOfAddressSpaceLeaves) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "sanitizers take terabytes of addresses themselves";
#endif
    const Described system;
    rlimit before{};
    ASSERT_EQ(getrlimit(RLIMIT_AS, &before), 0);
    const rlimit lower{.rlim_cur = 800 * kMebi, .rlim_max = before.rlim_max};
    ASSERT_EQ(setrlimit(RLIMIT_AS, &lower), 0);
    const MemoryLimit limit = system.limit();
    ASSERT_EQ(setrlimit(RLIMIT_AS, &before), 0);
    EXPECT_EQ(limit.bytes, 800 * kMebi - 1000 * static_cast<std::size_t>(sysconf(_SC_PAGE_SIZE)));
    EXPECT_NE(limit.whose.find("ulimit -v"), std::string::npos);
}

TEST(MachineMemory, WhatIsAskedForComesFirst) {
    EXPECT_EQ(memory_limit_or(12345).bytes, 12345u);
    EXPECT_EQ(memory_limit_or(0).bytes, memory_limit().bytes);
}

}  // namespace
}  // namespace pelagic::machine
