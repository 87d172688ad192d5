#include "plugin/machine/memory.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <optional>
#include <string>

namespace pelagic::machine {
namespace {

namespace fs = std::filesystem;

// A file's number; nothing where there is none ("max").
std::optional<std::size_t> number_in(const fs::path& file) {
    std::ifstream stream(file);
    std::size_t number = 0;
    if (stream >> number) return number;
    return {};
}

std::size_t machine_bytes() {
    const long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGE_SIZE);
    if (pages <= 0 || page <= 0) return std::numeric_limits<std::size_t>::max();
    return static_cast<std::size_t>(pages) * static_cast<std::size_t>(page);
}

// The least that a group or one above it allows. Inside a container a group may be named as the machine outside
// sees it: then its own folder isn't there, and the mount's top stands for it.
std::size_t group_bytes(const fs::path& mount, const fs::path& group, const char* file) {
    std::size_t least = std::numeric_limits<std::size_t>::max();
    fs::path at;
    const auto take = [&] {
        if (const auto bytes = number_in(mount / at / file)) least = std::min(least, *bytes);
    };
    take();
    for (const fs::path& name : group.relative_path()) {
        at /= name;
        take();
    }
    return least;
}

// Of all the groups that the process is in. A line of the file is "0::/path" in version 2, and "4:memory:/path"
// in version 1, which mounts each kind of limit in a folder of its own.
std::size_t groups_bytes(const Sources& sources) {
    std::size_t least = std::numeric_limits<std::size_t>::max();
    std::ifstream groups(sources.process / "cgroup");
    for (std::string line; std::getline(groups, line);) {
        const std::size_t first = line.find(':'), second = line.find(':', first + 1);
        if (first == std::string::npos || second == std::string::npos) continue;
        const std::string kinds = "," + line.substr(first + 1, second - first - 1) + ",";
        const std::string group = line.substr(second + 1);
        if (kinds == ",,") {
            least = std::min(least, group_bytes(sources.groups, group, "memory.max"));
            least = std::min(least, group_bytes(sources.groups / "unified", group, "memory.max"));
        } else if (kinds.find(",memory,") != std::string::npos) {
            least = std::min(least, group_bytes(sources.groups / "memory", group, "memory.limit_in_bytes"));
        }
    }
    return least;
}

// What is left of the limit of address space: what is mapped now, the program and its libraries, stays.
std::size_t address_bytes(const Sources& sources) {
    rlimit limit{};
    if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY)
        return std::numeric_limits<std::size_t>::max();
    const std::size_t mapped = number_in(sources.process / "statm").value_or(0) *
                               static_cast<std::size_t>(std::max(sysconf(_SC_PAGE_SIZE), 1L));
    return limit.rlim_cur > mapped ? limit.rlim_cur - mapped : 0;
}

}  // namespace

MemoryLimit memory_limit(const Sources& sources) {
    MemoryLimit limit{machine_bytes(), "this machine has"};
    if (const std::size_t bytes = groups_bytes(sources); bytes < limit.bytes)
        limit = {bytes, "its container or control group allows"};
    if (const std::size_t bytes = address_bytes(sources); bytes < limit.bytes)
        limit = {bytes, "its limit of address space (ulimit -v) leaves"};
    return limit;
}

MemoryLimit memory_limit_or(std::size_t max_memory_bytes) {
    return max_memory_bytes > 0 ? MemoryLimit{max_memory_bytes, "the limit that was asked for is"}
                                : memory_limit();
}

}  // namespace pelagic::machine
