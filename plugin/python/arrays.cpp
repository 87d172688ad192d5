#include "plugin/python/arrays.h"

#include <cstdint>
#include <cstdlib>
#include <optional>

namespace pelagic::python {
namespace {

namespace py = pybind11;

constexpr py::ssize_t kFloatBytes = sizeof(float);

std::string shape_text(const py::array& array) {
    return py::str(array.attr("shape"));
}

// What every array has to be; `components` 1 stands for a one-dimensional array.
struct Wanted {
    std::string name;
    std::optional<py::ssize_t> count;  // none: any
    py::ssize_t components = 1;
    bool written = false;
};

py::array checked(const py::handle& object, const Wanted& wanted) {
    const std::string shape = wanted.count ? std::to_string(*wanted.count) : "n";
    const std::string expected = "a float32 numpy array of shape (" + shape +
                                 (wanted.components > 1 ? ", " + std::to_string(wanted.components) : ",") +
                                 ")";
    if (!py::isinstance<py::array>(object))
        throw py::type_error(wanted.name + ": is of type " +
                             std::string(py::str(py::type::handle_of(object).attr("__name__"))) +
                             "; accepted: " + expected);
    auto array = py::reinterpret_borrow<py::array>(object);
    if (!py::isinstance<py::array_t<float>>(object))
        throw py::type_error(wanted.name + ": its dtype is " + std::string(py::str(array.dtype())) +
                             "; accepted: " + expected);
    const py::ssize_t dimensions = wanted.components > 1 ? 2 : 1;
    if (array.ndim() != dimensions || (wanted.count && array.shape(0) != *wanted.count) ||
        (wanted.components > 1 && array.shape(1) != wanted.components))
        throw py::value_error(wanted.name + ": its shape is " + shape_text(array) +
                              "; accepted: " + expected);
    if (wanted.written && !array.writeable())
        throw py::value_error(wanted.name + ": is read-only; accepted: an array that may be written to");
    if (array.size() == 0) return array;
    if (wanted.components > 1 && array.strides(1) != kFloatBytes)
        throw py::value_error(wanted.name + ": the components of a point are " +
                              std::to_string(array.strides(1)) +
                              " bytes apart; accepted: 4 (points may be any distance apart)");
    const py::ssize_t step = array.strides(0);
    if (step % kFloatBytes != 0 || reinterpret_cast<std::uintptr_t>(array.data()) % kFloatBytes != 0)
        throw py::value_error(wanted.name +
                              ": its numbers don't lie at multiples of 4 bytes; accepted: aligned memory");
    if (wanted.written && array.shape(0) > 1 && std::abs(step) < kFloatBytes * wanted.components)
        throw py::value_error(wanted.name + ": its points overlap, " + std::to_string(step) +
                              " bytes apart; accepted: at least " +
                              std::to_string(kFloatBytes * wanted.components));
    return array;
}

template <class Element>
Strided<Element> written_view(const py::handle& object, const Asked& asked, py::ssize_t components) {
    py::array array = checked(
        object, {.name = asked.name, .count = asked.count, .components = components, .written = true});
    return {static_cast<Element*>(array.mutable_data()), array.strides(0)};
}

template <class Vector>
Readable<Vector> readable(const py::handle& object, const Asked& asked) {
    const py::array array =
        checked(object, {.name = asked.name, .count = asked.count, .components = Vector::length()});
    return {{static_cast<const Vector*>(array.data()), array.strides(0)}, array.shape(0)};
}

}  // namespace

Strided<glm::vec3> writable_vectors(const py::handle& object, const Asked& asked) {
    return written_view<glm::vec3>(object, asked, 3);
}

Strided<float> writable_numbers(const py::handle& object, const Asked& asked) {
    return written_view<float>(object, asked, 1);
}

Strided<const float> readable_numbers(const py::handle& object, const Asked& asked) {
    const py::array array = checked(object, {.name = asked.name, .count = asked.count});
    return {static_cast<const float*>(array.data()), array.strides(0)};
}

Readable<glm::vec2> readable_points(const py::handle& object, const Asked& asked) {
    return readable<glm::vec2>(object, asked);
}

Readable<glm::vec3> readable_vectors(const py::handle& object, const Asked& asked) {
    return readable<glm::vec3>(object, asked);
}

}  // namespace pelagic::python
