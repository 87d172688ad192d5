// Stop signals: SIGINT (Ctrl-C), SIGTERM, SIGHUP, SIGQUIT (Ctrl-\).
#pragma once

#include <atomic>
#include <string>

namespace pelagic::cli {

// During its lifetime, the first of these signals sets cancelled(), and the second ends the program at once;
// no file is torn even then, because files are written atomically. Before files_begin() the first signal ends
// the program at once: nothing is being written. A signal that was ignored before (nohup, background jobs)
// stays ignored. SIGPIPE is ignored: closing a log must not end a bake. Only one object at a time.
class StopSignals {
  public:
    // stopping: what is said of the first signal, "stopping after the current file".
    explicit StopSignals(const std::string& stopping);
    ~StopSignals();
    StopSignals(const StopSignals&) = delete;
    StopSignals& operator=(const StopSignals&) = delete;

    const std::atomic<bool>& cancelled() const;
    int number() const;  // of the signal received; 0: none
    void files_begin();  // declares that files may be written from now on
};

}  // namespace pelagic::cli
