#include "plugin/host/python/watch.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <stdexcept>
#include <thread>

#include "plugin/host/python/bindings.h"

namespace pelagic::python {

namespace py = pybind11;

namespace {

// What runs just now. The interpreter's lock guards it.
struct Work {
    int running = 0;
    std::vector<Watch*> watched;
    std::vector<NativeWork*> native;
    std::atomic<int> beside = 0;            // in threads of ours; they count without the lock
    bool was_any = false;                   // in this process, or in those that it was forked from
    bool was_before_fork = false;           // this process is a fork's child
    std::optional<std::thread::id> ending;  // the thread that ends the program, once it does
    unsigned long main_thread =
        0;  // not asked for at each call: Python's code may be where the program's end meets a thread
};
Work& work() {
    static Work work;
    return work;
}

bool is_at_work() {
    return work().running > 0 || work().beside > 0 ||
           !std::all_of(work().native.begin(), work().native.end(),
                        [](NativeWork* each) { return each->is_done(); });
}

void end_all_work() {
    work().ending = std::this_thread::get_id();
    for (Watch* watch : work().watched) watch->stop();
    for (NativeWork* each : work().native) each->cancel();
    while (is_at_work()) {
        const py::gil_scoped_release others_may_run;
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
}

bool is_finalizing() {
#if PY_VERSION_HEX >= 0x030D0000
    return Py_IsFinalizing() != 0;
#else
    return _Py_IsFinalizing() != 0;
#endif
}

// What begins work calls it first. TBB's threads don't live on in a forked process, and its lists of them may have been
// copied in the middle of a change.
void begin_any() {
    if (work().was_before_fork)
        throw std::runtime_error(
            "this process was forked from one that had computed with Pelagic, and a fork leaves threads behind: "
            "start worker processes with multiprocessing's \"spawn\" or \"forkserver\", or before the first "
            "computation");
    work().was_any = true;
}

}  // namespace

void Cancel::set() {
    const std::lock_guard lock(state_->mutex);
    state_->is_set = true;
    for (const auto& each : state_->works)
        if (const auto flag = each.lock()) flag->store(true);
    state_->works.clear();
}

bool Cancel::is_set() const {
    const std::lock_guard lock(state_->mutex);
    return state_->is_set;
}

void Cancel::ends(const std::shared_ptr<std::atomic<bool>>& flag) {
    const std::lock_guard lock(state_->mutex);
    if (state_->is_set) return flag->store(true);
    std::erase_if(state_->works, [](const auto& each) { return each.expired(); });
    state_->works.push_back(flag);
}

OthersMayRun::OthersMayRun() {
    if (work().ending && *work().ending != std::this_thread::get_id()) throw Cancelled("the program ends");
    begin_any();
    ++work().running;
    released_.emplace();
}

OthersMayRun::~OthersMayRun() {
    released_.reset();
    --work().running;
}

Enlisted::Enlisted(NativeWork& work) : work_(work) {
    if (python::work().ending) throw Cancelled("the program ends");
    begin_any();
    python::work().native.push_back(&work);
}

Enlisted::~Enlisted() {
    std::erase(work().native, &work_);
}

Watch::Watch(const py::object& progress, const py::object& cancel) : progress_(progress) {
    if (!progress.is_none() && PyCallable_Check(progress.ptr()) == 0)
        throw py::type_error("progress: accepted: a callable, or None");
    if (py::isinstance<Cancel>(cancel))
        cancel.cast<Cancel>().ends(stop_);
    else if (cancel.is_none() || PyCallable_Check(cancel.ptr()) != 0)
        asked_ = cancel;
    else
        throw py::type_error("cancel: accepted: a pelagic.Cancel, a callable that returns a bool, or None");
    asks_python_ = !progress_.is_none() || !asked_.is_none();
    work().watched.push_back(this);
}

Watch::~Watch() {
    std::erase(work().watched, this);
}

namespace {

// A thread that waits for work, for ever.
class Worker {
  public:
    Worker() {
        std::thread([this] {
            for (;;) next()();
        }).detach();
    }
    void give(std::function<void()> task) {
        {
            const std::lock_guard lock(mutex_);
            task_ = std::move(task);
        }
        has_task_.notify_one();
    }

  private:
    std::function<void()> next() {
        std::unique_lock lock(mutex_);
        has_task_.wait(lock, [&] { return task_ != nullptr; });
        return std::exchange(task_, nullptr);
    }

    std::mutex mutex_;
    std::condition_variable has_task_;
    std::function<void()> task_;
};

// Those that wait. Neither they nor this are ever destroyed: the program's end may come while they wait.
struct Workers {
    std::mutex mutex;
    std::vector<Worker*> idle;
};
Workers& workers() {
    static Workers& workers = *new Workers;
    return workers;
}

}  // namespace

bool answers_signals() {
    return work().main_thread == PyThread_get_thread_ident();
}

std::future<void> begin_beside(std::function<void()> task) {
    begin_any();
    const auto promise = std::make_shared<std::promise<void>>();
    Worker* worker = nullptr;
    {
        const std::lock_guard lock(workers().mutex);
        if (!workers().idle.empty()) {
            worker = workers().idle.back();
            workers().idle.pop_back();
        }
    }
    if (!worker) worker = new Worker;
    ++work().beside;
    worker->give([promise, worker, task = std::move(task)]() mutable {
        std::exception_ptr failed;
        try {
            task();
        } catch (...) {
            failed = std::current_exception();
        }
        task = nullptr;  // before it counts as done
        {
            const std::lock_guard lock(workers().mutex);
            workers().idle.push_back(worker);
        }
        --work().beside;
        failed ? promise->set_exception(failed) : promise->set_value();
    });
    return promise->get_future();
}

namespace {

void beside_others(const std::function<void()>& work, const std::function<void()>& on_signal,
                   std::chrono::milliseconds then_for) {
    if (!answers_signals()) {
        const OthersMayRun others_may_run;
        return work();
    }
    std::future<void> done = begin_beside(work);
    if (const std::exception_ptr raised = wait_for(done, on_signal, then_for)) std::rethrow_exception(raised);
    done.get();
}

}  // namespace

void beside_others(Watch& watch, const std::function<void()>& work) {
    beside_others(
        work, [&] { watch.stop(); }, std::chrono::hours(24));
}

void beside_others(const std::shared_ptr<Watch>& watch, const std::function<void()>& work) {
    beside_others(
        work, [&] { watch->leave(); }, std::chrono::milliseconds(500));
}

std::shared_ptr<Watch> shared_watch(const py::object& progress, const py::object& cancel) {
    return {new Watch(progress, cancel), [](Watch* watch) {
                // The interpreter ends a thread that asks it for anything by unwinding its stack: this may be a part of that, and
                // asking again would end the program.
                if (is_finalizing()) return;
                const py::gil_scoped_acquire python;
                delete watch;
            }};
}

void add_watch(py::module_& module) {
    py::register_local_exception<Cancelled>(module, "Cancelled").doc() =
        "Work that was cancelled before its end.";
    py::class_<Cancel>(
        module, "Cancel", py::module_local(),
        "Ends long work from another thread: pass it as cancel, and set() it when it is enough.")
        .def(py::init<>())
        .def("set", &Cancel::set, "The work ends soon, for good.")
        .def_property_readonly("is_set", &Cancel::is_set, "Whether set() was called.");
    work().main_thread =
        py::module_::import("threading").attr("main_thread")().attr("ident").cast<unsigned long>();
    py::module_::import("atexit").attr("register")(py::cpp_function(&end_all_work));
    // A child has this thread alone.
    py::module_::import("os").attr("register_at_fork")(py::arg("after_in_child") = py::cpp_function([] {
                                                           work().main_thread = PyThread_get_thread_ident();
                                                           work().running = work().beside = 0;
                                                           work().was_before_fork = work().was_any;
                                                           for (NativeWork* each : work().native)
                                                               each->abandon();
                                                       }));
}

}  // namespace pelagic::python
