// Values of keys in Python: words are strings, vectors and lists are tuples, a list's entries named tuples.
#pragma once

#include <pybind11/pybind11.h>

#include <string_view>

#include "core/scene/keys.h"

namespace pelagic::python {

// The class of a list's entries; null until add_scene() has made it. Not looked up in the module: Blender knows that by another name.
pybind11::object& entry_class(const Key& key);

pybind11::object to_python(const Key& key, const KeyValue& value);
// As an assignment in Python does: pybind11::type_error for a value of another type, ShotError for one that the key
// refuses.
void set_from_python(Scene& scene, const Key& key, pybind11::handle value);

// The key of a path that must be there: "output.maps".
const Key& key_at(std::string_view path);

}  // namespace pelagic::python
