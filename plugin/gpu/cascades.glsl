// The cascades' fields at a point: the sums of evaluate() (core/evaluate), read from textures that SeaLayout
// describes. Needs the constants kCascades, kCellRungs, kPixelRungs, kChoppy, kCoverage and P, the spline's
// number of taps.

layout(std140) uniform SeaTables {
    // Indexed by rung · kCascades + cascade, cells before pixels. first.xy: the tile's first texel; .z: its
    // number of nodes N, 0 where the filter lets nothing through; .w: a multiple of N that makes node numbers
    // positive.
    ivec4 tile_first[(kCellRungs + kPixelRungs) * kTileCascades];
    ivec4 tile_origin[(kCellRungs + kPixelRungs) * kTileCascades];  // .xy: node at or below the origin
    vec4 tile_scale[(kCellRungs + kPixelRungs) * kTileCascades];    // .xy: fraction; .zw: nodes/m, split
    vec4 rungs[kCellRungs + kPixelRungs];  // .x: footprint [m]
    // Four vectors per rung of pixels: its hidden moments (xx, xy, yy, xxxx), (xxxy, xxyy, xyyy, yyyy), and
    // the same eight mixed with the next rung.
    vec4 hidden_rungs[4 * kPixelRungs];
};

uniform sampler2D cell_fields;     // Height, Dx, Dy
uniform sampler2D pixel_fields;    // ηx, ηy, Dxx, Dyy
uniform sampler2D pixel_fields_2;  // Dxy

// A point's place between the levels of filtering (rungs): weight 1 − t for the lower one, t for the next.
// See evaluate.cpp.
struct Rung {
    int lower;
    float t;
};

Rung rung_of(int first, int count, float footprint_m) {
    if (count == 1 || !(footprint_m > rungs[first].x)) return Rung(0, 0.0);
    float wanted = min(footprint_m, rungs[first + count - 1].x);
    int lower = 0;
    for (int i = 1; i < count - 1; ++i)
        if (wanted >= rungs[first + i].x) lower = i;
    float below = rungs[first + lower].x;
    return Rung(lower, (wanted - below) / (rungs[first + lower + 1].x - below));
}

struct Place {
    ivec2 texel;  // of the first tap
    vec2 rest;    // 0 … 1, from the node
};

Place place_in(int tile, SplitMetres x) {
    ivec4 first = tile_first[tile];
    vec4 scale = tile_scale[tile];
    vec2 coarse = x.coarse * scale.z;
    vec2 middle = x.middle * scale.z;
    vec2 rest = fract(coarse) + fract(middle) + (x.fine * scale.z + x.whole * scale.w) + scale.xy;
    vec2 carry = floor(rest);
    ivec2 node = ivec2(floor(coarse)) + ivec2(floor(middle)) + ivec2(carry) + tile_origin[tile].xy;
    ivec2 tap = node + (first.w - P / 2 + 1);
    return Place(first.xy + tap % first.z, rest - carry);
}

vec4 spline_sum(sampler2D fields, ivec2 texel, float wx[P], float wy[P]) {
    vec4 sum = vec4(0.0);
    for (int j = 0; j < P; ++j) {
        vec4 row = vec4(0.0);
        for (int i = 0; i < P; ++i) row += wx[i] * texelFetch(fields, texel + ivec2(i, j), 0);
        sum += wy[j] * row;
    }
    return sum;
}

// Height, Dx, Dy.
vec3 cell_cascades(SplitMetres x, float cell_m) {
    vec3 sum = vec3(0.0);
    Rung rung = rung_of(0, kCellRungs, cell_m);
    for (int r = 0; r < 2; ++r) {
        float share = r == 0 ? 1.0 - rung.t : rung.t;
        if (!(share > 0.0)) continue;
        for (int c = 0; c < kCascades; ++c) {
            int tile = (rung.lower + r) * kCascades + c;
            if (tile_first[tile].z == 0) continue;
            Place place = place_in(tile, x);
            float wx[P];
            float wy[P];
            bspline_weights(place.rest.x, wx);
            bspline_weights(place.rest.y, wy);
            vec4 value = spline_sum(cell_fields, place.texel, wx, wy);
            sum += share * (kChoppy ? vec3(value.x, value.y, value.z) : vec3(value.x, 0.0, 0.0));
        }
    }
    return sum;
}

struct PixelFields {
    float slope_x, slope_y, dxx, dyy, dxy;
};

PixelFields pixel_cascades(SplitMetres x, Rung rung) {
    vec4 sum = vec4(0.0);
    float dxy = 0.0;
    for (int r = 0; r < 2; ++r) {
        float share = r == 0 ? 1.0 - rung.t : rung.t;
        if (!(share > 0.0)) continue;
        for (int c = 0; c < kCascades; ++c) {
            int tile = (kCellRungs + rung.lower + r) * kCascades + c;
            if (tile_first[tile].z == 0) continue;
            Place place = place_in(tile, x);
            float wx[P];
            float wy[P];
            bspline_weights(place.rest.x, wx);
            bspline_weights(place.rest.y, wy);
            sum += share * spline_sum(pixel_fields, place.texel, wx, wy);
            if (kChoppy) dxy += share * spline_sum(pixel_fields_2, place.texel, wx, wy).x;
        }
    }
    if (!kChoppy) return PixelFields(sum.x, sum.y, 0.0, 0.0, 0.0);
    return PixelFields(sum.x, sum.y, sum.z, sum.w, dxy);
}

// The rung's hidden moments without the trains' part. May be negative by rounding.
PixelMoments hidden_of(Rung rung) {
    vec4 low = hidden_rungs[4 * rung.lower];
    vec4 high = hidden_rungs[4 * rung.lower + 1];
    if (rung.t > 0.0) {
        vec4 low_both = hidden_rungs[4 * rung.lower + 2];
        vec4 high_both = hidden_rungs[4 * rung.lower + 3];
        vec4 low_next = hidden_rungs[4 * rung.lower + 4];
        vec4 high_next = hidden_rungs[4 * rung.lower + 5];
        for (int i = 0; i < 4; ++i) {
            low[i] = blended_moment(low[i], low_both[i], low_next[i], rung.t);
            high[i] = blended_moment(high[i], high_both[i], high_next[i], rung.t);
        }
    }
    return PixelMoments(low.x, low.y, low.z, low.w, high.x, high.y, high.z, high.w);
}
