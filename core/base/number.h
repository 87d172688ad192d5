// What formulas need that are written once for plain numbers and for vectors of them (*.inl files: included
// here and there inside the namespace that holds the operations on their kind of number).
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
