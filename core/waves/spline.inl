// Weights of the uniform B-spline, written once for scalars, SIMD vectors and GLSL: see core/base/number.h.

// The P weights of the uniform B-spline at fraction f ∈ [0, 1] after node i, for nodes i − P/2 + 1 … i + P/2.
// They sum to 1. (de Boor's recursion on integer knots.)
template <int P, class T>
inline void bspline_weights(T f, T (&w)[P]) {
    w[0] = T(1);
    for (int degree = 1; degree < P; ++degree) {
        T saved = T(0);
        for (int r = 0; r < degree; ++r) {
            const T share = w[r] * T(1.0 / degree);
            w[r] = saved + (T(r + 1) - f) * share;
            saved = (f + T(degree - 1 - r)) * share;
        }
        w[degree] = saved;
    }
}
