// How a cascade is filtered along a footprint that is longer than wide, for plain numbers and for GLSL: see
// core/base/number.h.
//
// Its grids are filtered by round footprints. One as wide as the ellipse is read at several places along the long axis,
// evenly apart, and the mean of these is what the ellipse shows. A wave (k, at an angle α to the axis) counts with its
// weight in the grid times R(k cos α), R being the cosine transform of the places' weights: the real sinc of a box whose
// ends are smooth. The box's length brings R to ½ for waves of three footprints, as the round filter has it
// (core/plan/filter.inl). Places further apart than the waves of the grid are long would bring back what the grid has
// filtered away: they are 1.6 widths apart, where the shortest are two.

template <class T>
struct Taps {
    T spacing_m;
    T reach;  // of the box to either side, in spacings; ½: one tap
};

// Of an ellipse, width_m being its width, or what a cascade lets through whole if that is more.
template <class T>
inline Taps<T> taps_of(T width_m, T length_m) {
    const T spacing_m = T(1.6) * width_m;
    const T beyond_m = square_root(maximum(length_m * length_m - width_m * width_m, T(0)));
    return Taps<T>(spacing_m, maximum(T(0.9) * beyond_m / spacing_m, T(0.5)));
}

// Of tap j, …, −1, 0, 1, …: the part of its spacing that the box covers. All add up to 1; those from reach + ½ on are 0.
template <class T>
inline T tap_weight(T reach, T j) {
    return minimum(maximum(reach + T(0.5) - magnitude(j), T(0)), T(1)) / (T(2) * reach);
}
