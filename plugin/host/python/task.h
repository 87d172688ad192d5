// pelagic.Task: work in a native thread that never enters Python.
#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <functional>
#include <future>
#include <mutex>
#include <thread>

#include "plugin/host/python/watch.h"

namespace pelagic::python {

// For hosts that bear no Python beside their own: before Blender enters Python it asks whether some thread is in it, not
// whether its own is, so beside a thread of Python's two would be in it at once. Made and destroyed with the interpreter
// held. The work holds nothing of Python's, and sees the task as it would a Watch: tell() and flag().
class Task final : public NativeWork {
  public:
    // Makes the result of what was worked out, with the interpreter held.
    using Made = std::function<pybind11::object()>;
    using Work = std::function<Made(Task&)>;

    // Begins. inputs: what the work reads and writes, kept alive until it is done. result: of work that makes none.
    // Cancelled while the program ends.
    explicit Task(Work work, pybind11::object inputs = pybind11::none(),
                  pybind11::object result = pybind11::object());
    // Cancels the work, and waits for it.
    ~Task();
    Task(const Task&) = delete;
    Task& operator=(const Task&) = delete;

    // For the work, from any thread.
    template <class... Values>
    void tell(const Values&... values) {
        const std::lock_guard lock(mutex_);
        told_ = [... values = values] { return pybind11::make_tuple(values...); };
    }
    const std::atomic<bool>* flag() const { return &stop_; }

    // For Python.
    pybind11::object progress() const;
    void cancel() override { stop_.store(true); }
    bool is_done() const override;
    void wait() const;
    pybind11::object result();

    void abandon() override;

  private:
    std::atomic<bool> stop_ = false;
    mutable std::mutex mutex_;
    Made told_;
    pybind11::object inputs_, result_;
    Enlisted enlisted_{*this};
    std::shared_future<Made> made_;
    std::thread thread_;
};

}  // namespace pelagic::python
