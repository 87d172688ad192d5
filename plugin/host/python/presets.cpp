// pelagic.presets and Scene.apply_preset.
#include "core/scene/presets.h"

#include <string>
#include <vector>

#include "core/scene/names.h"
#include "plugin/host/python/bindings.h"
#include "plugin/host/python/values.h"

namespace pelagic::python {
namespace {

namespace py = pybind11;

py::list described_presets() {
    py::list out;
    for (const Preset& preset : presets()) {
        py::dict values;
        for (const auto& [path, value] : preset.values)
            values[py::str(path)] = to_python(key_at(path), value);
        py::dict made;
        made["name"] = preset.name;
        made["label"] = preset.label;
        made["help"] = preset.help;
        made["group"] = std::string(word_of(preset.group));
        made["values"] = values;
        out.append(made);
    }
    return out;
}

void apply_preset(Scene& scene, const std::string& name) {
    if (const Preset* preset = find_preset(name)) return apply(*preset, scene);
    const Problem problem = unknown_preset("preset", name);
    throw py::value_error(problem.value + ' ' + problem.problem +
                          "; accepted: the names of pelagic.presets()");
}

}  // namespace

void add_presets(py::module_& module, py::class_<Scene, std::shared_ptr<Scene>>& scene) {
    module.def("presets", &described_presets,
               "Named weathers and seas, each a dictionary: name, label and help for a menu, group "
               "(\"beaufort\" or \"sea\"), and values, a dictionary by the keys' paths.");
    scene.def("apply_preset", &apply_preset, py::arg("name"),
              "Sets the keys of a preset. ValueError, with the nearest name, where there is none.");
}

}  // namespace pelagic::python
