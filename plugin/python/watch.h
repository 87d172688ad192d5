// Long work, between Python and the core: progress, cancelling, other threads meanwhile, and the program's end.
#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

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

    // Calls progress with these, then the callable `cancel`, whose answer counts as in an `if`. An exception of
    // either ends this work, not what else a Cancel is for, and is kept for rethrow().
    template <class... Values>
    void tell(const Values&... values) {
        if (!asks_python_) return;
        const pybind11::gil_scoped_acquire python;
        if (failed_) return;
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
    bool asks_python_ = false;
    std::exception_ptr failed_;
};

}  // namespace pelagic::python
