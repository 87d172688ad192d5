// pelagic.presets and Scene.apply_preset.
#include "core/scene/presets.h"

#include <pybind11/stl.h>

#include <algorithm>
#include <string>
#include <vector>

#include "core/scene/names.h"
#include "core/scene/text.h"
#include "plugin/host/python/bindings.h"
#include "plugin/host/python/values.h"

namespace pelagic::python {
namespace {

namespace py = pybind11;

py::list described_presets() {
    py::list out;
    for (const Preset& preset : presets()) {
        py::dict values;
        for (const auto& [path, value, since] : preset.values)
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

void apply_preset(Scene& scene, const std::string& name, const std::vector<std::string>& parts) {
    PresetParts chosen;
    for (const std::string& part : parts) {
        const auto at = std::find(kPresetParts.begin(), kPresetParts.end(), part);
        if (at == kPresetParts.end())
            throw py::value_error(quoted_text(part) +
                                  " is no part of a preset; accepted: sea, light, camera and water");
        chosen.set(static_cast<std::size_t>(at - kPresetParts.begin()));
    }
    if (const Preset* preset = find_preset(name)) return apply(*preset, scene, chosen);
    const Problem problem = unknown_preset("preset", name);
    throw py::value_error(problem.value + ' ' + problem.problem +
                          "; accepted: the names of pelagic.presets()");
}

}  // namespace

void add_presets(py::module_& module, py::class_<Scene, std::shared_ptr<Scene>>& scene) {
    module.def("presets", &described_presets,
               "Named weathers and seas, each a dictionary: name, label and help for a menu, group "
               "(\"beaufort\" or \"sea\"), and values, a dictionary by the keys' paths.");
    const std::vector<std::string> all(kPresetParts.begin(), kPresetParts.end());
    scene.def(
        "apply_preset", &apply_preset, py::arg("name"), py::arg("parts") = all,
        "Sets the keys of a preset, or those of some of its parts: sea (with its waves, effects and bubbles), light, camera, water. "
        "ValueError, with the nearest name, where there is none.");
}

}  // namespace pelagic::python
