// A point's distance in periods: the product of metres and periods per metre. Its fraction stays exact some
// hundred kilometres from the origin, where single precision would lose a short wave within a few.
//
// Both factors are split into parts of 12 bits, whose products are exact in single precision: metres here,
// periods per metre on the CPU (split_number() in sea_layout.h).

struct SplitMetres {
    vec2 coarse;  // multiples of 64 m
    vec2 middle;  // of 1/64 m, within ±32 m
    vec2 fine;    // the rest
    vec2 whole;   // their sum
};

SplitMetres split_metres(vec2 x) {
    vec2 coarse = floor(x * (1.0 / 64.0) + 0.5) * 64.0;
    vec2 middle = floor((x - coarse) * 64.0 + 0.5) * (1.0 / 64.0);
    return SplitMetres(coarse, middle, (x - coarse) - middle, x);
}

// The fraction of Σ x_i k_i, up to whole periods. k = (high, low) of each axis.
float split_cycles(SplitMetres x, vec4 k) {
    vec2 high = vec2(k.x, k.z);
    vec2 low = vec2(k.y, k.w);
    vec2 cycles = fract(x.coarse * high) + fract(x.middle * high) + (x.fine * high + x.whole * low);
    return cycles.x + cycles.y;
}
