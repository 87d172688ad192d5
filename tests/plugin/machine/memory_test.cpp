// What the system gives a process: the machine's memory, what its control groups allow, and its own limit.
#include "plugin/machine/memory.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <thread>

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

// Under a limit of the process, for as long as the object lives.
class Limited {
  public:
    Limited(decltype(RLIMIT_AS) kind, std::size_t bytes) : kind_(kind) {
        EXPECT_EQ(getrlimit(kind_, &before_), 0);
        const rlimit limit{bytes, before_.rlim_max};
        is_set_ = setrlimit(kind_, &limit) == 0;
    }
    ~Limited() { setrlimit(kind_, &before_); }
    Limited(const Limited&) = delete;
    Limited& operator=(const Limited&) = delete;
    bool is_set() const { return is_set_; }

  private:
    decltype(RLIMIT_AS) kind_;
    rlimit before_{};
    bool is_set_ = false;
};

// Of address space all that is mapped counts, 1000 pages in the description, of data its 400; each leaves less for the
// threads that are to come, the more of them there are.
TEST(MachineMemory, IsWhatLimitsOfTheProcessLeaveBesideItsThreads) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "sanitizers take terabytes of addresses themselves";
#endif
    const Described system;
    const auto left = [&](decltype(RLIMIT_AS) kind, std::size_t threads, std::string& whose) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        const Limited limited(kind, 2048 * kMebi);
        if (!limited.is_set()) return std::size_t{0};
        const MemoryLimit limit = system.limit();
        whose = limit.whose;
        return limit.bytes;
    };
    std::string of_addresses, of_data;
    const std::size_t addresses = left(RLIMIT_AS, 2, of_addresses), data = left(RLIMIT_DATA, 2, of_data);
    ASSERT_GT(addresses, 0u);
    ASSERT_GT(data, 0u);
    EXPECT_NE(of_addresses.find("ulimit -v"), std::string::npos) << of_addresses;
    EXPECT_NE(of_data.find("ulimit -d"), std::string::npos) << of_data;
    const auto page = static_cast<std::size_t>(sysconf(_SC_PAGE_SIZE));
    // The same threads and heaps; heaps count as addresses alone, one of 64 MiB for the worker and one for who writes.
    EXPECT_EQ(data - addresses, (1000 - 400) * page + 128 * kMebi);
    EXPECT_LT(data, 2048 * kMebi - 400 * page);
    const std::size_t stack = tbb::global_control::active_value(tbb::global_control::thread_stack_size);
    EXPECT_EQ(data - left(RLIMIT_DATA, 8, of_data), 6 * stack);
    EXPECT_EQ(addresses - left(RLIMIT_AS, 8, of_addresses), 6 * (stack + 64 * kMebi));
}

// A limit of stacks is the new threads' in other programs: here it is ours, and work that needs more has its own.
TEST(MachineMemory, WorkHasAStackWhereTheLimitLeavesNone) {
    const auto deep_work = [] {
        volatile char room[std::size_t{1} << 20];
        for (std::size_t i = 0; i < sizeof room; i += 4096) room[i] = 1;
    };
    const Limited limited(RLIMIT_STACK, 64 * 1024);
    ASSERT_TRUE(limited.is_set());
    std::thread::id worker;
    EXPECT_TRUE(run_on_large_stack([&] {
        worker = std::this_thread::get_id();
        deep_work();
    }));
    EXPECT_NE(worker, std::this_thread::get_id());
}

// The main thread's own stack would have to be mapped as it grows, which a limit may refuse: with a signal.
TEST(MachineMemory, WorkHasAStackThatIsThereAlreadyUnderLimitsOfAddressesAndData) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "sanitizers take terabytes of addresses themselves";
#endif
    const auto worker_of = [] {
        std::thread::id worker;
        EXPECT_TRUE(run_on_large_stack([&] { worker = std::this_thread::get_id(); }));
        return worker;
    };
    for (const auto kind : {RLIMIT_AS, RLIMIT_DATA}) {
        const Limited limited(kind, 2048 * kMebi);
        ASSERT_TRUE(limited.is_set());
        EXPECT_NE(worker_of(), std::this_thread::get_id());
    }
}

TEST(MachineMemory, WhatIsAskedForComesFirst) {
    EXPECT_EQ(memory_limit_or(12345).bytes, 12345u);
    EXPECT_EQ(memory_limit_or(0).bytes, memory_limit().bytes);
}

}  // namespace
}  // namespace pelagic::machine
