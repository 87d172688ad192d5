// A view of n values in the caller's memory, a fixed number of bytes apart. Results reach numpy arrays,
// Blender's vertices or interleaved GPU buffers without a copy.
#pragma once

#include <cstddef>
#include <type_traits>

namespace pelagic {

// Non-owning. T is the element as it lies in memory, e.g. glm::vec3 for three packed floats. As an output, an
// empty view (data == nullptr) means "not wanted".
template <class T>
struct Strided {
    T* data = nullptr;
    std::ptrdiff_t stride_bytes = sizeof(T);

    T& operator[](std::size_t i) const {
        using Byte = std::conditional_t<std::is_const_v<T>, const char, char>;
        return *reinterpret_cast<T*>(reinterpret_cast<Byte*>(data) +
                                     static_cast<std::ptrdiff_t>(i) * stride_bytes);
    }
    explicit operator bool() const { return data != nullptr; }
};

}  // namespace pelagic
