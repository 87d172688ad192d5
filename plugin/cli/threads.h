// --threads: how many threads a verb's work may take.
#pragma once

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

#include <CLI/CLI.hpp>
#include <string>

namespace pelagic::cli {

// Adds the option, which refuses what is no number of threads. `threads` must outlive the parsing; it stays
// empty for all cores of the process's affinity mask.
CLI::Option* add_threads(CLI::App& command, std::string& threads, const char* help);

// That many threads while it lives.
class Threads {
  public:
    explicit Threads(const std::string& threads);  // as add_threads() leaves it
    int count() const { return count_; }
    template <class Work>
    auto execute(const Work& work) {
        return arena_.execute(work);
    }

  private:
    int count_;
    // The first bounds the threads of the process, the second asks for that many, also beyond the cores.
    tbb::global_control limit_;
    tbb::task_arena arena_;
};

}  // namespace pelagic::cli
