// Handling of stop signals. See stop.h. The handler does only what POSIX allows in one: lock-free atomics,
// write(), _exit().
#include "plugin/host/cli/stop.h"

#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <string>
#include <string_view>

#include "plugin/host/cli/exit_status.h"

namespace pelagic::cli {
namespace {

constexpr std::array kStopping{SIGINT, SIGTERM, SIGHUP, SIGQUIT};

std::atomic<bool> stop_asked{false};
std::atomic<int> stop_signal{0};
std::atomic<bool> writing{false};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free);

std::array<struct sigaction, kStopping.size()> before{};
struct sigaction pipe_before {};
std::string first_words;  // made before a handler may read them

void say(std::string_view text) {
    // An error of stderr can't be reported.
    [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, text.data(), text.size());
}

extern "C" void pelagic_stop_handler(int signal) {
    const int saved = errno;
    const bool again = stop_asked.exchange(true);
    stop_signal.store(signal);
    if (again || !writing.load()) {
        say(again ? "\npelagic: stopped at once; the files under their own names are whole\n"
                  : "\npelagic: stopped before the first frame; no frame was touched\n");
        _exit(kSignal + signal);
    }
    say(first_words);
    errno = saved;
}

}  // namespace

StopSignals::StopSignals(const std::string& stopping) {
    first_words = "\npelagic: " + stopping + "; again to stop at once\n";
    stop_asked = false;
    stop_signal = 0;
    writing = false;
    struct sigaction action {};
    sigemptyset(&action.sa_mask);
    action.sa_handler = pelagic_stop_handler;
    action.sa_flags = SA_RESTART;  // system calls for the current file continue
    for (std::size_t i = 0; i < kStopping.size(); ++i) {
        sigaction(kStopping[i], nullptr, &before[i]);
        if (before[i].sa_handler != SIG_IGN) sigaction(kStopping[i], &action, nullptr);
    }
    action.sa_handler = SIG_IGN;
    sigaction(SIGPIPE, &action, &pipe_before);
}

StopSignals::~StopSignals() {
    for (std::size_t i = 0; i < kStopping.size(); ++i) sigaction(kStopping[i], &before[i], nullptr);
    sigaction(SIGPIPE, &pipe_before, nullptr);
}

const std::atomic<bool>& StopSignals::cancelled() const {
    return stop_asked;
}
int StopSignals::number() const {
    return stop_signal;
}
void StopSignals::files_begin() {
    writing = true;
}

}  // namespace pelagic::cli
