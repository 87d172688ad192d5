// Progress and cancelling of long work, between Python and the core.
#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <exception>
#include <memory>
#include <utility>

namespace pelagic::python {

// pelagic.Cancel: work looks at its flag; whoever holds it sets it, from any thread.
struct Cancel {
    std::shared_ptr<std::atomic<bool>> flag = std::make_shared<std::atomic<bool>>(false);
};

// pelagic.Cancelled.
class Cancelled : public std::exception {
  public:
    explicit Cancelled(const char* what) : what_(what) {}
    const char* what() const noexcept override { return what_; }

  private:
    const char* what_;
};

// What a caller of long work passes: `progress`, a callable or None, and `cancel`, a Cancel, a callable that is
// true when it is enough, or None. Made and destroyed with the interpreter held; everything else is called
// without it, from any thread.
class Watch {
  public:
    // pybind11::type_error for other objects.
    Watch(const pybind11::object& progress, const pybind11::object& cancel);

    const std::atomic<bool>* flag() const { return cancel_.flag.get(); }

    // Calls progress with these, then the callable `cancel`, whose answer counts as in an `if`. An exception of
    // either cancels the work, and is kept for rethrow().
    template <class... Values>
    void tell(const Values&... values) {
        if (!asks_python_) return;
        const pybind11::gil_scoped_acquire python;
        if (failed_) return;
        try {
            if (!progress_.is_none()) progress_(values...);
            if (!asked_.is_none() && pybind11::bool_(asked_())) cancel_.flag->store(true);
        } catch (...) {
            failed_ = std::current_exception();
            cancel_.flag->store(true);
        }
    }
    // With the interpreter held, after the work: what a callable threw.
    void rethrow() {
        if (failed_) std::rethrow_exception(std::exchange(failed_, nullptr));
    }

  private:
    pybind11::object progress_, asked_ = pybind11::none();
    Cancel cancel_;
    bool asks_python_ = false;
    std::exception_ptr failed_;
};

}  // namespace pelagic::python
