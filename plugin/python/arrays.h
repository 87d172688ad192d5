// numpy arrays as the query's strided views: the caller's memory, read and written where it lies.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/strided.h"

namespace pelagic::python {

// What an array is for: `name`, as the caller wrote it, for messages, and the number of points; none: any.
struct Asked {
    std::string name;
    std::optional<pybind11::ssize_t> count{};
};

// Views of float32 arrays; points may lie any multiple of 4 bytes apart, also backwards. The components of
// one point must be adjacent. The array must outlive the view. pybind11::type_error for anything but a
// float32 array, pybind11::value_error for a wrong shape, components that aren't adjacent, an address that no
// float may have, and, of those that are written to, read-only arrays and points that overlap.
Strided<glm::vec3> writable_vectors(const pybind11::handle& object, const Asked& asked);
Strided<float> writable_numbers(const pybind11::handle& object, const Asked& asked);
Strided<const float> readable_numbers(const pybind11::handle& object, const Asked& asked);

// The same for (n, 2) and (n, 3) of any n, or of as many as are asked for.
template <class Vector>
struct Readable {
    Strided<const Vector> view;
    pybind11::ssize_t count = 0;
};
Readable<glm::vec2> readable_points(const pybind11::handle& object, const Asked& asked);
Readable<glm::vec3> readable_vectors(const pybind11::handle& object, const Asked& asked);

// A new array that owns the vector's memory: of this shape, or else (n,) of numbers and (n, components) of
// glm's vectors.
template <class Number, class Element>
pybind11::array_t<Number> array_of(std::vector<Element>&& values, std::vector<pybind11::ssize_t> shape = {}) {
    constexpr auto kComponents = static_cast<pybind11::ssize_t>(sizeof(Element) / sizeof(Number));
    if (shape.empty()) shape = {static_cast<pybind11::ssize_t>(values.size())};
    if (kComponents > 1) shape.push_back(kComponents);
    auto held = std::make_unique<std::vector<Element>>(std::move(values));
    const auto* data = reinterpret_cast<const Number*>(held->data());
    const pybind11::capsule owner(held.release(),
                                  [](void* vector) { delete static_cast<std::vector<Element>*>(vector); });
    return pybind11::array_t<Number>(std::move(shape), data, owner);
}

}  // namespace pelagic::python
