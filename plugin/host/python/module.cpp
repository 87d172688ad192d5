// The Python module `pelagic`: thin, because the work is core's. Arrays are numpy's, exceptions Python's, and
// long work lets other Python threads run.
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include "core/plan/effects.h"
#include "core/plan/memory.h"
#include "core/plan/plan.h"
#include "pelagic/version.h"
#include "plugin/budget/budget.h"
#include "plugin/files/files.h"
#include "plugin/format/shot/shot.h"
#include "plugin/host/python/bindings.h"
#include "plugin/host/python/watch.h"

namespace {

namespace py = pybind11;

// As `pelagic explain` prints it.
std::string explain_bake(const pelagic::Scene& scene) {
    pelagic::python::require_valid(scene);
    const pelagic::Scene kept = scene;
    const pelagic::python::OthersMayRun others_may_run;  // a plan looks at each frame's view
    const pelagic::Settled settled =
        pelagic::settle(kept, pelagic::Purpose::Mesh, pelagic::with_rates(pelagic::recorded_rates()));
    return (settled.text.empty() ? "" : "Budget\n  " + settled.text + "\n\n") +
           pelagic::explain(pelagic::plan_bake(settled.scene));
}

}  // namespace

// pybind11 gives an object whose __init__() was never called (cls.__new__(cls), a subclass that uses it first) memory
// without a value when it is first used. Here that is an error.
void refuse_objects_without_a_value(const py::module_& module) {
    for (const auto& [name, member] : module.attr("__dict__").cast<py::dict>()) {
        if (PyType_Check(member.ptr()) == 0) continue;
        if (auto* type = py::detail::get_type_info(reinterpret_cast<PyTypeObject*>(member.ptr())))
            type->operator_new = [](std::size_t) -> void* {
                throw py::type_error("an object of pelagic whose __init__() was not called has no value");
            };
    }
    // What pybind11 says of such an object where it is held by several.
    py::register_local_exception_translator([](std::exception_ptr error) {
        try {
            if (error) std::rethrow_exception(error);
        } catch (const py::cast_error& wrong) {
            PyErr_SetString(PyExc_TypeError, wrong.what());
        }
    });
}

// pybind11 imports numpy when the first array is made. In a daemon thread that may be while the program ends: Python
// would then end the thread in the middle of our C++, which has no answer to that.
void import_numpy() {
    const py::array_t<float> first(0);
}

PYBIND11_MODULE(pelagic, module) {
    import_numpy();
    module.doc() =
        "An open sea: a moving surface, and what the surface hides below its own resolution.\n\n"
        "    scene = pelagic.Scene.from_file(\"shot.toml\")\n"
        "    rest, quads = pelagic.patch(scene.surface.size_m, scene.surface.resolution)\n"
        "    frame = pelagic.Frame(pelagic.Sea(scene))\n"
        "    frame.set(1.5)\n"
        "    position = frame.evaluate(rest, outputs=(\"position\",))[\"position\"]\n\n"
        "Metres, seconds, radians unless a name says otherwise; z is up, x east, y north. Ctrl-C ends what the main thread "
        "waits for; a step of it that takes longer than half a second ends by itself. At the program's end "
        "work in other threads is cancelled, or waited for. A process that is forked after the first computation "
        "can't compute: start workers with multiprocessing's \"spawn\" or \"forkserver\".";
    module.attr("__version__") = PELAGIC_VERSION;
    py::register_local_exception<pelagic::ShotError>(module, "ShotError", PyExc_ValueError).doc() =
        "A shot that is refused: a line for each problem, FILE:LINE:COLUMN: KEY = VALUE: PROBLEM; accepted: "
        "WHAT IS.\n"
        "Without the place for a scene that is not read from a file.";

    py::register_local_exception_translator([](std::exception_ptr thrown) {
        try {
            if (thrown) std::rethrow_exception(thrown);
        } catch (const pelagic::NotEnoughMemory& error) {
            PyErr_SetString(PyExc_MemoryError, error.what());
        }
    });
    py::register_local_exception<pelagic::files::FileError>(module, "FileError", PyExc_OSError).doc() =
        "A file or folder that can't be read or written: its path, why, and what would do.";

    pelagic::python::add_watch(module);
    pelagic::python::add_task(module);
    pelagic::python::add_cage(module);
    pelagic::python::add_scene(module);
    pelagic::python::add_surfaces(module);
    pelagic::python::add_sea(module);
    pelagic::python::add_frame(module);
    pelagic::python::add_drops(module);
    pelagic::python::add_light(module);
    pelagic::python::add_picture(module);
    pelagic::python::add_bake(module);
    pelagic::python::add_baked(module);
    pelagic::python::add_viewport(module);
    refuse_objects_without_a_value(module);
    module.def(
        "explain", &explain_bake, py::arg("scene"),
        "What baking this scene computes, and why: each output, product, field, transform with its size, "
        "bytes held.");
    module.def(
        "effects",
        [](const pelagic::Scene& scene) {
            std::vector<std::string> on;
            for (const pelagic::EffectRow& row : pelagic::effect_table())
                if (row.is_on(scene)) on.emplace_back(row.name);
            return on;
        },
        py::arg("scene"), "The names of the effects that are on in this scene: \"whitecaps\", ...");
}
