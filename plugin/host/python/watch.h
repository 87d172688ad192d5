// Long work, between Python and the core: progress, cancelling, other threads meanwhile, and the program's end.
#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <chrono>
#include <exception>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/base/build_watch.h"

namespace pelagic::python {

// pelagic.Cancel: whoever holds it sets it, from any thread, and what was begun with it ends. Copies are the same.
class Cancel {
  public:
    void set();
    bool is_set() const;
    // Sets this work's flag as well, now or when the time comes.
    void ends(const std::shared_ptr<std::atomic<bool>>& work);

  private:
    struct State {
        std::mutex mutex;
        bool is_set = false;
        std::vector<std::weak_ptr<std::atomic<bool>>> works;
    };
    std::shared_ptr<State> state_ = std::make_shared<State>();
};

// pelagic.Cancelled.
class Cancelled : public std::exception {
  public:
    explicit Cancelled(const char* what) : what_(what) {}
    const char* what() const noexcept override { return what_; }

  private:
    const char* what_;
};

// During its lifetime other Python threads run, as with pybind11's gil_scoped_release, but Python doesn't end: it
// would end this thread in the middle of its work, which C++ can't survive. At the program's end watched work is
// cancelled and all work is waited for. Work begun by another thread after that throws Cancelled; work in a process
// that was forked after any had begun throws std::runtime_error.
class OthersMayRun {
  public:
    OthersMayRun();
    ~OthersMayRun();
    OthersMayRun(const OthersMayRun&) = delete;
    OthersMayRun& operator=(const OthersMayRun&) = delete;

  private:
    std::optional<pybind11::gil_scoped_release> released_;
};

// Work in a native thread, as the program's end and a fork see it: both hold the interpreter.
class NativeWork {
  public:
    virtual void cancel() = 0;  // it ends soon
    virtual bool is_done() const = 0;
    virtual void abandon() = 0;  // in a forked process, which doesn't have the thread and begins none

  protected:
    ~NativeWork() = default;
};

// While it lives, the program's end cancels this work and waits for it. Throws as OthersMayRun.
class Enlisted {
  public:
    explicit Enlisted(NativeWork& work);
    ~Enlisted();
    Enlisted(const Enlisted&) = delete;
    Enlisted& operator=(const Enlisted&) = delete;

  private:
    NativeWork& work_;
};

// What a caller of long work passes: `progress`, a callable or None, and `cancel`, a Cancel, a callable that is
// true when it is enough, or None. Made and destroyed with the interpreter held; everything else is called
// without it, from any thread.
class Watch {
  public:
    // pybind11::type_error for other objects.
    Watch(const pybind11::object& progress, const pybind11::object& cancel);
    ~Watch();
    Watch(const Watch&) = delete;
    Watch& operator=(const Watch&) = delete;

    const std::atomic<bool>* flag() const { return stop_.get(); }
    void stop() { stop_->store(true); }
    // With the interpreter held: stops, and calls nobody any more.
    void leave() {
        is_left_ = true;
        stop();
    }

    // Calls progress with these, then the callable `cancel`, whose answer counts as in an `if`. An exception of
    // either ends this work, not what else a Cancel is for, and is kept for rethrow().
    template <class... Values>
    void tell(const Values&... values) {
        if (!asks_python_) return;
        const pybind11::gil_scoped_acquire python;
        if (failed_ || is_left_) return;
        try {
            if (!progress_.is_none()) progress_(values...);
            if (!asked_.is_none() && pybind11::bool_(asked_())) stop();
        } catch (...) {
            failed_ = std::current_exception();
            stop();
        }
    }
    // With the interpreter held, after the work: what a callable threw.
    void rethrow() {
        if (failed_) std::rethrow_exception(std::exchange(failed_, nullptr));
    }

  private:
    pybind11::object progress_, asked_ = pybind11::none();
    std::shared_ptr<std::atomic<bool>> stop_ = std::make_shared<std::atomic<bool>>(false);
    bool asks_python_ = false, is_left_ = false;
    std::exception_ptr failed_;
};

// Whether this is Python's main thread, which alone runs the handlers of signals.
bool answers_signals();

// Begins work in a thread beside this one, which keeps it for later work: a new one each time would leave its scratch memory in the frames
// that it works on. The program's end waits for it.
std::future<void> begin_beside(std::function<void()> work);

// Waits for it while other threads run. What a signal's handler raises meanwhile, such as Ctrl-C's KeyboardInterrupt: null, or to be
// rethrown, with the interpreter held. on_signal: what then ends the work, which is waited for that long and otherwise left alone.
template <class Future>
std::exception_ptr wait_for(const Future& done, const std::function<void()>& on_signal,
                            std::chrono::milliseconds then_for) {
    constexpr auto kPatience = std::chrono::milliseconds(50);
    using Clock = std::chrono::steady_clock;
    Clock::time_point raised_at;
    std::exception_ptr raised;
    const OthersMayRun others_may_run;
    while (done.wait_for(kPatience) != std::future_status::ready) {
        if (raised && Clock::now() - raised_at >= then_for) break;
        const pybind11::gil_scoped_acquire python;
        if (PyErr_CheckSignals() == 0) continue;
        if (!raised) raised_at = Clock::now();
        raised = std::make_exception_ptr(pybind11::error_already_set());
        if (on_signal) on_signal();
        if (then_for == std::chrono::milliseconds(0)) break;
    }
    return raised;
}

// Long work without the interpreter, while other threads run and Ctrl-C ends it. work() tells the watch, and ends soon when its flag
// is set. What it throws is thrown.
void beside_others(Watch& watch, const std::function<void()>& work);

// The same for work some of whose steps take long: after Ctrl-C it may go on to the end of its step by itself. So work() refers to
// nothing but the watch that it doesn't own, and to nothing of Python's.
void beside_others(const std::shared_ptr<Watch>& watch, const std::function<void()>& work);
// Made with the interpreter held, as a Watch; may be released without.
std::shared_ptr<Watch> shared_watch(const pybind11::object& progress, const pybind11::object& cancel);

inline Watch& watch_behind(Watch& watch) {
    return watch;
}
inline Watch& watch_behind(const std::shared_ptr<Watch>& watch) {
    return *watch;
}

// The same, by the watch or what shares it. Then what a callable threw is thrown; of work that ended by BuildCancelled otherwise
// Cancelled, in these words.
template <class Watched>
void beside_others(Watched& watch, const std::function<void()>& work, const char* cancelled) {
    try {
        beside_others(watch, work);
    } catch (const BuildCancelled&) {
        watch_behind(watch).rethrow();
        throw Cancelled(cancelled);
    }
    watch_behind(watch).rethrow();  // small work is done before it looks at the flag
}

// The same for work that nothing can end: Ctrl-C leaves it to itself, and what it makes is dropped. So it refers to nothing that it
// doesn't own, and to nothing of Python's.
template <class Make>
auto beside_others(Make make) -> std::invoke_result_t<Make&> {
    if (!answers_signals()) {
        const OthersMayRun others_may_run;
        return make();
    }
    using Made = std::invoke_result_t<Make&>;
    const auto made = std::make_shared<std::optional<Made>>();
    std::future<void> done =
        begin_beside([made, make = std::move(make)]() mutable { made->emplace(make()); });
    if (const std::exception_ptr raised = wait_for(done, {}, std::chrono::milliseconds(0)))
        std::rethrow_exception(raised);
    done.get();
    return std::move(**made);
}

}  // namespace pelagic::python
