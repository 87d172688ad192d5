// The Python module's parts: each adds its own names to the module.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>

#include "pelagic/scene.h"

namespace pelagic::python {

void add_cage(pybind11::module_& module);
void add_scene(pybind11::module_& module);
void add_presets(pybind11::module_& module, pybind11::class_<Scene, std::shared_ptr<Scene>>& scene);
void add_objects(pybind11::class_<Scene, std::shared_ptr<Scene>>& scene);
void add_watch(pybind11::module_& module);
void add_task(pybind11::module_& module);
void add_surfaces(pybind11::module_& module);
void add_sea(pybind11::module_& module);
void add_frame(pybind11::module_& module);
void add_drops(pybind11::module_& module);
void add_light(pybind11::module_& module);
void add_picture(pybind11::module_& module);
void add_bake(pybind11::module_& module);
void add_baked(pybind11::module_& module);
void add_viewport(pybind11::module_& module);

// IndexError where there is none.
const SceneObject& object_at(const Scene& scene, pybind11::ssize_t index);

// ShotError with a line for each of problems_of()'s.
void require_valid(const Scene& scene);

}  // namespace pelagic::python
