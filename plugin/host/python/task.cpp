#include "plugin/host/python/task.h"

#include <chrono>
#include <exception>
#include <memory>
#include <utility>

#include "core/waves/sea.h"
#include "plugin/host/python/bindings.h"
#include "plugin/host/python/watch.h"

namespace pelagic::python {

namespace py = pybind11;

Task::Task(Work work, py::object inputs, py::object result)
    : inputs_(std::move(inputs)), result_(std::move(result)) {
    std::promise<Made> promise;
    made_ = promise.get_future().share();
    thread_ = std::thread([this, work = std::move(work), promise = std::move(promise)]() mutable {
        try {
            promise.set_value(work(*this));
        } catch (const BuildCancelled& cancelled) {
            promise.set_exception(std::make_exception_ptr(Cancelled(cancelled.what())));
        } catch (...) {
            promise.set_exception(std::current_exception());
        }
    });
}

Task::~Task() {
    cancel();
    if (thread_.joinable()) thread_.join();  // the work needs no interpreter to end
}

py::object Task::progress() const {
    Made told;
    {
        const std::lock_guard lock(mutex_);
        told = told_;
    }
    return told ? told() : py::none();
}

bool Task::is_done() const {
    return made_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

void Task::wait() const {
    if (is_done()) return;
    if (const std::exception_ptr raised = wait_for(made_, {}, std::chrono::milliseconds(0)))
        std::rethrow_exception(raised);
}

py::object Task::result() {
    wait();
    const Made& made = made_.get();
    if (!result_) result_ = made();
    inputs_ = py::none();
    return result_;
}

void Task::abandon() {
    new std::thread(std::move(thread_));  // never joined nor destroyed
    std::promise<Made> promise;
    promise.set_exception(std::make_exception_ptr(Cancelled("the process was forked")));
    made_ = promise.get_future().share();
}

void add_task(py::module_& module) {
    py::class_<Task>(
        module, "Task", py::module_local(),
        "Work in a native thread, which never enters Python: for hosts such as Blender, beside whose own "
        "Python no thread of Python's may run. What begins one refuses bad arguments at once. A task that "
        "nobody holds any more, or that runs at the program's end, is cancelled and waited for.")
        .def_property_readonly("is_done", &Task::is_done, "Whether it has ended, well or not.")
        .def_property_readonly(
            "progress", &Task::progress,
            "What the blocking form last called its progress with, a tuple; None before that.")
        .def("cancel", &Task::cancel, "The work ends soon, where it can.")
        .def(
            "wait", &Task::wait,
            "Until it has ended. Other threads run meanwhile; Ctrl-C ends the waiting, and the work goes on.")
        .def("result", &Task::result, "What came of it, after waiting for it; raises what went wrong.");
}

}  // namespace pelagic::python
