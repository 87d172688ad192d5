// Calm and rough places (core/plan/masks.h), for plain numbers and for GLSL: see core/base/number.h. After filter.inl, of which it
// is made.

// A mask's share at a place: 1 within its ellipse, 0 beyond its edge, smooth between; and how it changes with the place [1/m].
template <class T>
struct MaskShare {
    T share, x, y;
};

// u, v: from the middle, along the ellipse and across [m]; per metre: one over the half axes of the ellipse (inner) and of the one
// round its edge (outer). Along each ray from the middle the edge goes from q₁ = 1 to q₂ = 1.
template <class T>
inline MaskShare<T> mask_share(T u, T v, T inner_u, T inner_v, T outer_u, T outer_v) {
    const T u1 = u * inner_u, v1 = v * inner_v, u2 = u * outer_u, v2 = v * outer_v;
    const T q1 = maximum(square_root(u1 * u1 + v1 * v1), T(1e-6)),
            q2 = maximum(square_root(u2 * u2 + v2 * v2), T(1e-6));
    const T between = maximum(q1 - q2, T(1e-6));
    const T t = minimum(maximum((q1 - T(1)) * q2 / between, T(0)), T(1));
    const T u1_rate = u1 * inner_u / q1, v1_rate = v1 * inner_v / q1, u2_rate = u2 * outer_u / q2,
            v2_rate = v2 * outer_v / q2;
    const T rate = T(-6) * t * (T(1) - t) / between;
    return MaskShare<T>(T(1) - smooth_rise(t),
                        rate * (u1_rate * q2 + (q1 - T(1)) * u2_rate - t * (u1_rate - u2_rate)),
                        rate * (v1_rate * q2 + (q1 - T(1)) * v2_rate - t * (v1_rate - v2_rate)));
}

// The share of a gust's front (core/plan/gusts.h): the level of gusts, −1 … 1, takes the edge nearer or farther, and beyond and within it
// nothing. Its strength, 4, is by eye: half of the edge is patches that hold or don't.
template <class T>
inline T ragged_share(T share, T level) {
    return smooth_rise(minimum(maximum(share + T(4) * level * share * (T(1) - share), T(0)), T(1)));
}

// The wind of a front, times the sea's. The place: from its middle; half_u, half_v: the half axes of its ellipse; length_u, length_v: of a
// footprint, along and across [m]. The footprint takes the edge by half of its length farther out and as far in, and leaves of what is
// smaller than itself as much as its area.
template <class T>
inline T front_wind(T x, T y, T along_x, T along_y, T half_u, T half_v, T edge, T length_u, T length_v,
                    T wind, T level) {
    T inner_u = maximum(half_u - T(0.5) * length_u, T(0.01) * half_u),
      inner_v = maximum(half_v - T(0.5) * length_v, T(0.01) * half_v);
    T outer_u = half_u + edge + T(0.5) * length_u, outer_v = half_v + edge + T(0.5) * length_v;
    T left = (T(2) * half_u + edge) * (T(2) * half_v + edge) / ((inner_u + outer_u) * (inner_v + outer_v));
    MaskShare<T> at = mask_share(x * along_x + y * along_y, y * along_x - x * along_y, T(1) / inner_u,
                                 T(1) / inner_v, T(1) / outer_u, T(1) / outer_v);
    return T(1) + (wind - T(1)) * minimum(left, T(1)) * ragged_share(at.share, level);
}

// Quadratic B-splines of the three cells round a place, which add up to 1, and how they change from one cell to the next. From the middle
// of the cell that it is in, −½ … ½ cells.
template <class T>
struct MaskWeights {
    T before, here, after, before_rate, here_rate, after_rate;
};

template <class T>
inline MaskWeights<T> mask_weights(T from) {
    return MaskWeights<T>(T(0.5) * (T(0.5) - from) * (T(0.5) - from), T(0.75) - from * from,
                          T(0.5) * (T(0.5) + from) * (T(0.5) + from), from - T(0.5), T(-2) * from,
                          from + T(0.5));
}

// The gains of all masks at a place, and how that of the waves changes with it [1/m].
template <class T>
struct MaskGains {
    T waves, x, y, ripples, foam;
};

// With one more, which lies along (along_x, along_y), and its share there, which changes along it and across.
template <class T>
inline MaskGains<T> with_share(MaskGains<T> all, MaskShare<T> at, T along_x, T along_y, T waves, T ripples,
                               T foam) {
    const T more = waves - T(1), own = T(1) + more * at.share;
    return MaskGains<T>(all.waves * own, all.x * own + all.waves * more * (at.x * along_x - at.y * along_y),
                        all.y * own + all.waves * more * (at.x * along_y + at.y * along_x),
                        all.ripples * (T(1) + (ripples - T(1)) * at.share),
                        all.foam * (T(1) + (foam - T(1)) * at.share));
}

// The same of an ellipse. The place: from its middle [m].
template <class T>
inline MaskGains<T> with_mask(MaskGains<T> all, T x, T y, T along_x, T along_y, T inner_u, T inner_v,
                              T outer_u, T outer_v, T waves, T ripples, T foam) {
    return with_share(
        all,
        mask_share(x * along_x + y * along_y, y * along_x - x * along_y, inner_u, inner_v, outer_u, outer_v),
        along_x, along_y, waves, ripples, foam);
}

// Of the sea's breaking, what breaks where waves are m times as high: Φ(y/m) over Φ(y) by Mills' ratio, y < 0 being the deviate of the
// sea's share that breaks. Within a tenth for y below −2 and m below 1.5.
template <class T>
inline T masked_breaking(T m, T y) {
    const T gain = maximum(m, T(1e-3));
    return gain * exponential(minimum(T(0.5) * y * y * (T(1) - T(1) / (gain * gain)), T(8)));
}

// Where the waves are m times as high: derivatives of m f, of which f and its derivatives are given.
template <class T>
inline T masked_slope(T slope, T value, T gain, T gain_rate) {
    return gain * slope + value * gain_rate;
}

// A variance of slopes that a pixel hides: `hidden` all, `calmed` without ripples where a slick leaves none, `kept` what it leaves of
// their amplitude.
template <class T>
inline T hidden_with_ripples(T hidden, T calmed, T kept) {
    return kept * kept * hidden + (T(1) - kept * kept) * calmed;
}
