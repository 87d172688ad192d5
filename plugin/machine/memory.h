// How much memory the system gives this process, and how a program prepares its threads for small limits. Linux;
// elsewhere the machine's memory alone.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>

#include "core/plan/memory.h"

namespace pelagic::machine {

// Where the system says it; other places for tests.
struct Sources {
    std::filesystem::path process = "/proc/self";     // whose "cgroup" names its control groups
    std::filesystem::path groups = "/sys/fs/cgroup";  // where they are mounted, of version 1 or 2
};

// The least of the machine's memory, what the process's control groups (containers) allow, and what its own limits of
// address space and data (ulimit -v, -d) leave beside what is mapped, the threads that are to come, and what a run takes
// that no plan counts. Not what is free at the moment: a run is refused or not whatever else runs.
MemoryLimit memory_limit(const Sources& sources = {});

// The limit that a user gives, or memory_limit() where none is given (0).
MemoryLimit memory_limit_or(std::size_t max_memory_bytes);

// Adds what a run takes whatever it is of: the program and its libraries, the shot as it was read, tables of its own.
void add_program(MemoryNeed& need);
// What making a sky takes and what it holds, by daylight or of a picture.
void add_sky(MemoryNeed& need);

// For a program's main(), before it has threads: those that it and its libraries make get stacks of 2 MiB, whatever the
// limit of stacks (ulimit -s) is, and under a limit of address space all share one heap: each further one of glibc's takes
// 64 MiB of it.
void settle_threads();

// Runs `work` here, or on a thread with a stack of 8 MiB where the limit of stacks leaves less than that here, or a limit of
// address space or data might not let this one grow. False where there is no such thread to be had.
bool run_on_large_stack(const std::function<void()>& work);

}  // namespace pelagic::machine
