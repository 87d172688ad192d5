// --threads: the number of threads of a verb.
#pragma once

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

#include <CLI/CLI.hpp>
#include <string>

namespace pelagic::cli {

// Adds the option, which rejects invalid numbers. `threads` must outlive the parsing. It stays empty for all
// cores of the process's affinity mask.
CLI::Option* add_threads(CLI::App& command, std::string& threads, const char* help);

// Runs work on that many threads.
class Threads {
  public:
    explicit Threads(const std::string& threads);  // the text from add_threads()
    int count() const { return count_; }
    template <class Work>
    auto execute(const Work& work) {
        return arena_.execute(work);
    }

  private:
    int count_;
    // limit_ bounds the threads of the process; the arena asks for that many, even beyond the number of
    // cores.
    tbb::global_control limit_;
    tbb::task_arena arena_;
};

}  // namespace pelagic::cli
