// How much memory the system gives this process. Linux; elsewhere the machine's own alone.
#pragma once

#include <cstddef>
#include <filesystem>

#include "core/plan/memory.h"

namespace pelagic::machine {

// Where the system says it; other places for tests.
struct Sources {
    std::filesystem::path process = "/proc/self";     // whose "cgroup" names its control groups
    std::filesystem::path groups = "/sys/fs/cgroup";  // where they are mounted, of version 1 or 2
};

// The least of the machine's memory, what the process's control groups (containers) allow, and what its own limit
// of address space (ulimit -v) leaves. Not what is free at the moment: a run is refused or not whatever else runs.
MemoryLimit memory_limit(const Sources& sources = {});

// The limit that somebody asks for, or memory_limit() where he asks for none (0).
MemoryLimit memory_limit_or(std::size_t max_memory_bytes);

}  // namespace pelagic::machine
