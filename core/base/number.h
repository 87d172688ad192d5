// What formulas need that are written once for plain numbers, for vectors of them (pack-inl.h) and for GLSL
// (plugin/preview/prelude.glsl): *.inl files, included here and there inside the namespace that holds the
// operations on their kind of number, and handed to OpenGL as text. So they keep to what both languages have
// (plugin/preview/shader_source.h says which lines are changed on the way): arguments by value, structs made
// by their constructor, `T(2)` for numbers, and no `auto`.
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
T minus_product(T c, T a, T b) {  // c − ab; vectors round once where the CPU can
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

}  // namespace pelagic
