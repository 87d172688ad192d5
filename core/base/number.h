// The operations of formulas that are written once (*.inl) and compiled for scalars (here), for SIMD vectors
// (pack-inl.h) and for GLSL (plugin/host/gpu/prelude.glsl). Each includer does so inside the namespace with
// the operations of its number type; OpenGL gets the text. So *.inl files use only what both languages have
// (plugin/host/gpu/shader_source.h lists the lines that it adapts): arguments by value, structs made by their
// constructor, `T(2)` for numbers, no `auto`.
#pragma once

#include <algorithm>
#include <cmath>

namespace pelagic {

inline float select(bool which, float yes, float no) {
    return which ? yes : no;
}
inline double select(bool which, double yes, double no) {
    return which ? yes : no;
}
template <class T>
T minimum(T a, T b) {
    return std::min(a, b);
}
template <class T>
T maximum(T a, T b) {
    return std::max(a, b);
}
template <class T>
T magnitude(T x) {
    return std::abs(x);
}
template <class T>
T minus_product(T c, T a, T b) {  // c − ab; with one rounding where vectors have FMA
    return c - a * b;
}
template <class T>
T square_root(T x) {
    return std::sqrt(x);
}
template <class T>
T cube_root(T x) {
    return std::cbrt(x);
}
template <class T>
T complementary_error(T x) {  // erfc
    return std::erfc(x);
}
template <class T>
T exponential(T x) {
    return std::exp(x);
}
template <class T>
T power(T x, T y) {
    return std::pow(x, y);
}

}  // namespace pelagic
