// Being asked to stop: SIGINT (Ctrl-C), SIGTERM, SIGHUP.
#pragma once

#include <atomic>

namespace pelagic::cli {

// While it lives, the first of these signals sets cancelled(), and the second ends the program at once; files
// are written so that even that tears none. Until files_begin() the first one already ends it at once:
// nothing is being written then. A signal that is ignored when it begins (nohup, background jobs) stays
// ignored. SIGPIPE is ignored: a log that is closed must not end a bake. One at a time.
class StopSignals {
  public:
    StopSignals();
    ~StopSignals();
    StopSignals(const StopSignals&) = delete;
    StopSignals& operator=(const StopSignals&) = delete;

    const std::atomic<bool>& cancelled() const;
    int number() const;  // the signal that came; 0: none
    void files_begin();  // from now on files may be being written
};

}  // namespace pelagic::cli
