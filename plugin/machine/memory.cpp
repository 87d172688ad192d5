#include "plugin/machine/memory.h"

#include <malloc.h>
#include <oneapi/tbb/global_control.h>
#include <pthread.h>
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

// The n-th number of the process's "statm" [bytes]: 0 all that is mapped, 5 data and stacks.
std::size_t mapped_bytes(const Sources& sources, int n) {
    std::ifstream stream(sources.process / "statm");
    std::size_t pages = 0;
    for (int i = 0; i <= n; ++i)
        if (!(stream >> pages)) return 0;
    return pages * static_cast<std::size_t>(std::max(sysconf(_SC_PAGE_SIZE), 1L));
}

constexpr std::size_t kMebi = std::size_t{1} << 20;
constexpr std::size_t kStack = 2 * kMebi;      // of threads that aren't TBB's
constexpr std::size_t kMainStack = 8 * kMebi;  // what Linux gives where nobody limits it
constexpr std::size_t kArena = 64 * kMebi;     // glibc: HEAP_MAX_SIZE, reserved for a thread that allocates
// Found by the campaign "memory": 12 of the program and its libraries, 5 of what it allocates in small pieces.
constexpr std::size_t kProgram = 17 * kMebi;
constexpr std::size_t kSky = 10 * kMebi;  // its tables, and a picture or a map of it
// What needs don't count, files' libraries most of all: found by the campaign "limits". Most of kProgram is mapped already.
constexpr std::size_t kBesidePlans = 7 * kMebi;
bool shares_one_heap = false;

// Of threads yet to come: TBB's, and one that writes.
std::size_t threads_bytes(std::size_t heap) {
    using Control = tbb::global_control;
    const std::size_t workers = Control::active_value(Control::max_allowed_parallelism) - 1;
    return workers * (Control::active_value(Control::thread_stack_size) + heap) + kStack + heap;
}

// What a limit of the process leaves. What is mapped now, the program and its libraries, counts as taken.
std::size_t left_of(decltype(RLIMIT_AS) kind, std::size_t mapped, std::size_t heap) {
    rlimit limit{};
    if (getrlimit(kind, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY)
        return std::numeric_limits<std::size_t>::max();
    const std::size_t taken = mapped + threads_bytes(heap) + kBesidePlans;
    return limit.rlim_cur > taken ? limit.rlim_cur - taken : 0;
}

}  // namespace

MemoryLimit memory_limit(const Sources& sources) {
    MemoryLimit limit{machine_bytes(), "this machine has"};
    const auto take = [&](std::size_t bytes, const char* whose) {
        if (bytes < limit.bytes) limit = {bytes, whose};
    };
    take(groups_bytes(sources), "its container or control group allows");
    take(left_of(RLIMIT_AS, mapped_bytes(sources, 0), shares_one_heap ? 0 : kArena),
         "its limit of address space (ulimit -v) leaves, beside libraries and threads,");
    // A heap that is only reserved is no data yet.
    take(left_of(RLIMIT_DATA, mapped_bytes(sources, 5), 0),
         "its limit of data (ulimit -d) leaves, beside libraries and threads,");
    return limit;
}

MemoryLimit memory_limit_or(std::size_t max_memory_bytes) {
    return max_memory_bytes > 0 ? MemoryLimit{max_memory_bytes, "the limit that was asked for is", true}
                                : memory_limit();
}

void add_program(MemoryNeed& need) {
    need.add("the program itself", kProgram, "");
}

void add_sky(MemoryNeed& need) {
    need.add("the sky", kSky, "");
}

void settle_threads() {
    pthread_attr_t attributes;
    if (pthread_attr_init(&attributes) == 0) {
        pthread_attr_setstacksize(&attributes, kStack);
        pthread_setattr_default_np(&attributes);
        pthread_attr_destroy(&attributes);
    }
    rlimit limit{};
    if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
        shares_one_heap = mallopt(M_ARENA_MAX, 1) == 1;
}

bool run_on_large_stack(const std::function<void()>& work) {
    const auto is_below = [](decltype(RLIMIT_AS) kind, rlim_t bytes) {
        rlimit limit{};
        return getrlimit(kind, &limit) == 0 && limit.rlim_cur < bytes;
    };
    // The main thread's stack is mapped as it grows: where a limit has no room for it, a signal ends the process.
    if (!is_below(RLIMIT_STACK, kMainStack) && !is_below(RLIMIT_AS, RLIM_INFINITY) &&
        !is_below(RLIMIT_DATA, RLIM_INFINITY)) {
        work();
        return true;
    }
    pthread_attr_t attributes;
    if (pthread_attr_init(&attributes) != 0) return false;
    pthread_t thread{};
    const auto run = [](void* what) -> void* {
        (*static_cast<const std::function<void()>*>(what))();
        return nullptr;
    };
    const bool is_running =
        pthread_attr_setstacksize(&attributes, kMainStack) == 0 &&
        pthread_create(&thread, &attributes, run, const_cast<std::function<void()>*>(&work)) == 0;
    pthread_attr_destroy(&attributes);
    return is_running && pthread_join(thread, nullptr) == 0;
}

}  // namespace pelagic::machine
