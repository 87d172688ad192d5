// Medians of interleaved repeats: A B C A B C …, so that a machine whose speed drifts slows all alike and
// ratios hold.
#pragma once

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <string>
#include <vector>

namespace pelagic::bench {

struct Timed {
    std::string name;
    std::function<void()> work;
    std::vector<double> ms{};

    double median() const {
        std::vector<double> sorted = ms;
        std::sort(sorted.begin(), sorted.end());
        return sorted[sorted.size() / 2];
    }
    double least() const { return *std::min_element(ms.begin(), ms.end()); }
};

// Runs each once to warm up, then all in turn, `repeats` times.
inline void interleave(std::vector<Timed>& timed, int repeats) {
    for (int i = -1; i < repeats; ++i)
        for (Timed& t : timed) {
            const auto start = std::chrono::steady_clock::now();
            t.work();
            const std::chrono::duration<double, std::milli> elapsed =
                std::chrono::steady_clock::now() - start;
            if (i >= 0) t.ms.push_back(elapsed.count());
        }
}

// Of this process, both user's and system's [s].
inline double processor_s() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

inline const char* verdict(bool met) {
    return met ? "met" : "missed";
}

// Largest resident memory of this process, or of the children that it has waited for, so far [MiB].
inline double peak_mib(int who = RUSAGE_SELF) {
    rusage usage{};
    getrusage(who, &usage);
    return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

}  // namespace pelagic::bench
