#include "plugin/python/watch.h"

#include "plugin/python/bindings.h"

namespace pelagic::python {

namespace py = pybind11;

Watch::Watch(const py::object& progress, const py::object& cancel) : progress_(progress) {
    if (!progress.is_none() && PyCallable_Check(progress.ptr()) == 0)
        throw py::type_error("progress: accepted: a callable, or None");
    if (py::isinstance<Cancel>(cancel))
        cancel_ = cancel.cast<Cancel>();
    else if (cancel.is_none() || PyCallable_Check(cancel.ptr()) != 0)
        asked_ = cancel;
    else
        throw py::type_error("cancel: accepted: a pelagic.Cancel, a callable that returns a bool, or None");
    asks_python_ = !progress_.is_none() || !asked_.is_none();
}

void add_watch(py::module_& module) {
    py::register_exception<Cancelled>(module, "Cancelled").doc() = "Work that was cancelled before its end.";
    py::class_<Cancel>(
        module, "Cancel",
        "Ends long work from another thread: pass it as cancel, and set() it when it is enough.")
        .def(py::init<>())
        .def(
            "set", [](const Cancel& self) { self.flag->store(true); }, "The work ends soon, for good.")
        .def_property_readonly(
            "is_set", [](const Cancel& self) { return self.flag->load(); }, "Whether set() was called.");
}

}  // namespace pelagic::python
