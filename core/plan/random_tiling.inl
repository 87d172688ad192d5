// Where a cascade's tiles lie and how they blend, for plain numbers, for vectors of them and for GLSL: see
// core/base/number.h. The rule is in core/plan/random_tiling.h.

// The width of the blend from a cell to the next, in cells: half of it lies on either side of the border.
inline constexpr double kBlendRamp = 0.15;
inline constexpr double kTileSteps = 1024.0;  // offsets are whole multiples of the tile's size by this
inline constexpr double kEighthTurnTangent = 0.41421356237309504880;  // tan(π/8)

// Two random numbers of a cell (i, j), 0 … 1023: pcg3d of Jarzynski and Olano 2020, "Hash functions for GPU rendering". All
// sums are modulo 2³².
struct TileBits {
    uint x, y;
#ifdef __cplusplus  // GLSL has them by itself, and clang 14 not yet
    TileBits(uint x_, uint y_) : x(x_), y(y_) {}
#endif
};
inline TileBits tile_bits(uint key, uint i, uint j) {
    uint x = key * 1664525u + 1013904223u;
    uint y = i * 1664525u + 1013904223u;
    uint z = j * 1664525u + 1013904223u;
    x += y * z;
    y += z * x;
    z += x * y;
    x = x ^ (x >> 16u);
    y = y ^ (y >> 16u);
    z = z ^ (z >> 16u);
    x += y * z;
    y += z * x;
    return TileBits(x >> 22u, y >> 22u);
}

// The offset of the tile in cell (i, j), in tiles, 0 … 1: at the point x of the cell lies the tile's x + offset. None
// in cell (0, 0).
template <class T>
struct TileOffset {
    T x, y;
#ifdef __cplusplus
    TileOffset(T x_, T y_) : x(x_), y(y_) {}
#endif
};
template <class T>
inline TileOffset<T> tile_offset(uint key, uint i, uint j) {
    TileBits bits = tile_bits(key, i, j);
    if (i == 0u && j == 0u) bits = TileBits(0u, 0u);
    return TileOffset<T>(T(bits.x) * T(1.0 / kTileSteps), T(bits.y) * T(1.0 / kTileSteps));
}

// Along an axis: the weight of the tile of the point's own cell, and of the one beyond the nearer border. Their
// squares add up to 1. With the distance from the cell's middle the first changes by −next · rate, the second by own
// · rate [1/cell].
template <class T>
struct BlendWeights {
    T own, next, rate;
#ifdef __cplusplus
    BlendWeights(T own_, T next_, T rate_) : own(own_), next(next_), rate(rate_) {}
#endif
};

// `middle`: the distance from the middle of the point's own cell, in cells, 0 … ½. The weights are (cos θ, sin θ), θ from 0 to
// ½π over the whole ramp and level at its ends; θ − ¼π by the tangent of its half.
template <class T>
inline BlendWeights<T> blend_weights(T middle) {
    const T t = minimum(maximum((middle - T(0.5 - 0.5 * kBlendRamp)) * T(1.0 / kBlendRamp), T(0)), T(1));
    const T q = T(kEighthTurnTangent) * (T(2) * smooth_rise(t) - T(1));
    const T by = T(1) / (T(1) + q * q);
    const T cosine = (T(1) - q * q) * by * T(0.70710678118654752440);
    const T sine = T(2) * q * by * T(0.70710678118654752440);
    const T rate = T(24.0 * kEighthTurnTangent / kBlendRamp) * t * (T(1) - t) * by;
    // Where the ramp begins the next weight is lost in rounding, and its rate, which is larger, must not be left out.
    const T next = maximum(cosine + sine, T(1e-20));
    return BlendWeights<T>(select(t > T(0), cosine - sine, T(1)), select(t > T(0), next, T(0)), rate);
}
