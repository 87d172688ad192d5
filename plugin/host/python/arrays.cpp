#include "plugin/host/python/arrays.h"

#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>
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

// No two numbers share a byte: steps along one axis go beyond all that lies along the other. Layouts whose steps go past each other are
// refused as well, whether they meet or not.
void require_apart(const py::array& array, const Wanted& wanted) {
    py::ssize_t within = kFloatBytes;
    std::array<int, 2> axes{0, 1};
    if (array.ndim() == 2 && std::abs(array.strides(1)) < std::abs(array.strides(0))) axes = {1, 0};
    for (int i = 0; i < array.ndim(); ++i) {
        const int axis = array.ndim() == 1 ? 0 : axes[i];
        const py::ssize_t step = std::abs(array.strides(axis));
        if (array.shape(axis) < 2) continue;
        if (step < within)
            throw py::value_error(wanted.name + ": its numbers overlap, " + std::to_string(step) +
                                  " bytes apart; accepted: at least " + std::to_string(within));
        within += step * (array.shape(axis) - 1);
    }
}

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
    if (wanted.written && array.size() > 0) require_apart(array, wanted);
    return array;
}

// Whether a view can be of its own memory.
bool is_direct(const py::array& array, py::ssize_t components) {
    return array.size() == 0 ||
           ((components == 1 || array.strides(1) == kFloatBytes) && array.strides(0) % kFloatBytes == 0 &&
            reinterpret_cast<std::uintptr_t>(array.data()) % kFloatBytes == 0);
}

template <class Element>
Strided<Element> written_view(const py::handle& object, const Asked& asked, py::ssize_t components,
                              Copies& copies) {
    py::array array = checked(
        object, {.name = asked.name, .count = asked.count, .components = components, .written = true});
    if (is_direct(array, components)) return {static_cast<Element*>(array.mutable_data()), array.strides(0)};
    return {reinterpret_cast<Element*>(copies.stand_in_for(array, components))};
}

template <class Element>
Readable<Element> readable(const py::handle& object, const Asked& asked, py::ssize_t components,
                           Copies& copies) {
    const py::array array =
        checked(object, {.name = asked.name, .count = asked.count, .components = components});
    if (is_direct(array, components))
        return {{static_cast<const Element*>(array.data()), array.strides(0)}, array.shape(0)};
    return {{reinterpret_cast<const Element*>(copies.copy_of(array, components))}, array.shape(0)};
}

}  // namespace

Copies::Copy& Copies::add(const py::array& array, py::ssize_t components) {
    return copies_.emplace_back(Copy{.numbers = std::vector<float>(static_cast<std::size_t>(array.size())),
                                     .array = nullptr,
                                     .count = array.shape(0),
                                     .components = components,
                                     .step = array.strides(0),
                                     .apart = components > 1 ? array.strides(1) : 0});
}

float* Copies::copy_of(const py::array& array, py::ssize_t components) {
    Copy& copy = add(array, components);
    float* to = copy.numbers.data();
    for (py::ssize_t i = 0; i < copy.count; ++i)
        for (py::ssize_t c = 0; c < components; ++c)
            std::memcpy(to++, static_cast<const char*>(array.data()) + copy.offset(i, c), sizeof(float));
    return copy.numbers.data();
}

float* Copies::stand_in_for(py::array& array, py::ssize_t components) {
    Copy& copy = add(array, components);
    copy.array = static_cast<char*>(array.mutable_data());
    return copy.numbers.data();
}

void Copies::give_back() const {
    for (const Copy& copy : copies_) {
        if (!copy.array) continue;
        const float* from = copy.numbers.data();
        for (py::ssize_t i = 0; i < copy.count; ++i)
            for (py::ssize_t c = 0; c < copy.components; ++c)
                std::memcpy(copy.array + copy.offset(i, c), from++, sizeof(float));
    }
}

bool overlap(const py::array& a, const py::array& b) {
    const auto span_of = [](const py::array& array) {
        const auto at = reinterpret_cast<std::intptr_t>(array.data());
        std::array<std::intptr_t, 2> span{at, at + array.itemsize()};
        for (py::ssize_t axis = 0; axis < array.ndim(); ++axis) {
            const py::ssize_t way = array.strides(axis) * (array.shape(axis) - 1);
            span[way < 0 ? 0 : 1] += way;
        }
        return span;
    };
    if (a.size() == 0 || b.size() == 0) return false;
    const auto of_a = span_of(a), of_b = span_of(b);
    // Columns of one table lie between each other, and apart.
    return of_a[0] < of_b[1] && of_b[0] < of_a[1] &&
           py::module_::import("numpy").attr("shares_memory")(a, b).cast<bool>();
}

Strided<glm::vec3> writable_vectors(const py::handle& object, const Asked& asked, Copies& copies) {
    return written_view<glm::vec3>(object, asked, 3, copies);
}

Strided<float> writable_numbers(const py::handle& object, const Asked& asked, Copies& copies) {
    return written_view<float>(object, asked, 1, copies);
}

Strided<const float> readable_numbers(const py::handle& object, const Asked& asked, Copies& copies) {
    return readable<float>(object, asked, 1, copies).view;
}

Readable<glm::vec2> readable_points(const py::handle& object, const Asked& asked, Copies& copies) {
    return readable<glm::vec2>(object, asked, 2, copies);
}

Readable<glm::vec3> readable_vectors(const py::handle& object, const Asked& asked, Copies& copies) {
    return readable<glm::vec3>(object, asked, 3, copies);
}

}  // namespace pelagic::python
