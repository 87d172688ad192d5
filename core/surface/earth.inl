// The sea at rest as the earth's sphere, for plain numbers, for vectors of them and for GLSL: see core/base/number.h.
//
// Seen from a place on it, to whose tangent plane z is the normal: a point of the flat sea at the distance s from the place
// lies as far along the sphere, in the same direction (azimuthal equidistant projection), and as high above it. A curvature
// of 0 is the flat sea, to the last bit.

template <class T>
struct EarthTurn {
    T sine;    // sin γ/γ, of the angle γ = s · curvature between the verticals
    T versed;  // 2 (1 − cos γ)/γ²
    T angle2;  // γ²
};

// Series in γ², as exact as single precision to the quarter of the earth that anybody sees.
template <class T>
inline EarthTurn<T> earth_turn(T x, T y, T curvature) {
    const T a = (x * x + y * y) * curvature * curvature;
    const T sine =
        T(1) - a / T(6) * (T(1) - a / T(20) * (T(1) - a / T(42) * (T(1) - a / T(72) * (T(1) - a / T(110)))));
    const T versed =
        T(1) - a / T(12) * (T(1) - a / T(30) * (T(1) - a / T(56) * (T(1) - a / T(90) * (T(1) - a / T(132)))));
    return EarthTurn<T>(sine, versed, a);
}

template <class T>
struct EarthPoint {
    T x, y, z;
};

// Where the point (x, y, z) of the flat sea is, relative to the same place.
template <class T>
inline EarthPoint<T> on_earth(T x, T y, T z, T curvature) {
    EarthTurn<T> turn = earth_turn(x, y, curvature);
    const T outwards = turn.sine * (T(1) + z * curvature);
    const T drop = T(0.5) * curvature * (x * x + y * y) * turn.versed;
    return EarthPoint<T>(x * outwards, y * outwards, z * (T(1) - T(0.5) * turn.versed * turn.angle2) - drop);
}

// The vertical there.
template <class T>
inline EarthPoint<T> earth_up(T x, T y, T curvature) {
    EarthTurn<T> turn = earth_turn(x, y, curvature);
    const T outwards = turn.sine * curvature;
    return EarthPoint<T>(x * outwards, y * outwards, T(1) - T(0.5) * turn.versed * turn.angle2);
}
