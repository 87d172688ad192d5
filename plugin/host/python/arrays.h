// numpy arrays as the query's strided views: the caller's memory, read and written where it lies.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <deque>
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

// Stand-ins for arrays that no view can be of, because the components of a point aren't adjacent or numbers don't lie at multiples of 4
// bytes. Views of them last as long as this. Work in any thread may hold it: nothing in it is Python's.
class Copies {
  public:
    // Puts what was written into stand-ins into their arrays, which must still be there. Needs no interpreter.
    void give_back() const;

    // Of an array of n points with so many float32 components.
    float* copy_of(const pybind11::array& array, pybind11::ssize_t components);
    float* stand_in_for(pybind11::array& array, pybind11::ssize_t components);

  private:
    struct Copy {
        std::vector<float> numbers;
        char* array;  // of an output; null: only read
        pybind11::ssize_t count, components, step, apart;
        pybind11::ssize_t offset(pybind11::ssize_t point, pybind11::ssize_t component) const {
            return point * step + component * apart;
        }
    };
    Copy& add(const pybind11::array& array, pybind11::ssize_t components);
    std::deque<Copy> copies_;
};

// Views of float32 arrays of any strides, of their own memory or of a copy of it. The array and the copies must outlive the view, and
// Copies::give_back() must follow what writes. pybind11::type_error for anything but a float32 array, pybind11::value_error for a wrong shape
// and, of those that are written to, read-only arrays and numbers that overlap.
Strided<glm::vec3> writable_vectors(const pybind11::handle& object, const Asked& asked, Copies& copies);
Strided<float> writable_numbers(const pybind11::handle& object, const Asked& asked, Copies& copies);
Strided<const float> readable_numbers(const pybind11::handle& object, const Asked& asked, Copies& copies);

// The same for (n, 2) and (n, 3) of any n, or of as many as are asked for.
template <class Vector>
struct Readable {
    Strided<const Vector> view;
    pybind11::ssize_t count = 0;
};
Readable<glm::vec2> readable_points(const pybind11::handle& object, const Asked& asked, Copies& copies);
Readable<glm::vec3> readable_vectors(const pybind11::handle& object, const Asked& asked, Copies& copies);

// Whether numbers of both share a byte.
bool overlap(const pybind11::array& a, const pybind11::array& b);

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
