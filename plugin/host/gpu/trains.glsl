// The trochoid trains at a point, as in evaluate() (core/evaluate/trains-inl.h), from tables that SeaLayout
// makes. Only the trains that pass the footprint's filter are read.
//
// Texels of train i, in column i: 0: kx, ky [cycles/m], each as (high, low); 1: amplitudes of ηx, ηy, Dxx, Dyy; 2: of
// Dxy, Height, Dx, Dy; 3: wavelength [m], and the weight with which its displacement gradient counts at best in
// breaking; 4, 5: its moments; 6, 7: the summed moments of trains i … last.
uniform sampler2D train_table;
uniform sampler2D train_cycles;  // phases at the origin, at the frame's time
uniform int train_count;
uniform vec4 train_filter;  // n_min, 1/(n_max − n_min), and footprints in wavelengths: a train passes
                            // fully up to 1/n_max and not at all from 1/n_min on

// The number of trains that are longer than footprint_m / share. Trains are sorted, longest first.
int trains_above(float footprint_m, float share) {
    int low = 0;
    int high = train_count;
    while (low < high) {
        int middle = (low + high) / 2;
        if (footprint_m < texelFetch(train_table, ivec2(middle, 3), 0).x * share) low = middle + 1;
        else high = middle;
    }
    return low;
}

float train_weight(float wavelength_m, float footprint_m) {
    return footprint_weight(wavelength_m / footprint_m, train_filter.x, train_filter.y);
}

vec2 sine_cosine(float cycles) {
    float angle = 6.28318530717958647692 * (cycles - floor(cycles + 0.5));
    return vec2(sin(angle), cos(angle));
}

float train_phase(int i, SplitMetres x) {
    return texelFetch(train_cycles, ivec2(i, 0), 0).x - split_cycles(x, texelFetch(train_table, ivec2(i, 0), 0));
}

vec2 train_sine_cosine(int i, SplitMetres x) { return sine_cosine(train_phase(i, x)); }

// How long an ellipse is along a train's way.
float footprint_along(int i, vec3 footprint) {
    vec4 k = texelFetch(train_table, ivec2(i, 0), 0);
    float stretch = dot(footprint.yz, vec2(k.x + k.y, k.z + k.w)) * texelFetch(train_table, ivec2(i, 3), 0).x;
    return stretch == 0.0 ? footprint.x : sqrt(footprint.x * footprint.x + stretch * stretch);
}

// Height, Dx, Dy. footprint: width and stretch (core/evaluate/trains.h).
vec3 cell_trains(SplitMetres x, vec3 footprint) {
    vec3 sum = vec3(0.0);
    int full = trains_above(length(footprint), train_filter.z);
    int end = trains_above(footprint.x, train_filter.w);
    for (int i = 0; i < end; ++i) {
        vec2 wave = train_sine_cosine(i, x);
        if (i >= full) wave *= train_weight(texelFetch(train_table, ivec2(i, 3), 0).x, footprint_along(i, footprint));
        vec4 amplitude = texelFetch(train_table, ivec2(i, 2), 0);
        sum += vec3(amplitude.y * wave.y, amplitude.z * wave.x, amplitude.w * wave.x);
    }
    return sum;
}

// Adds the trains' part to the cascades' resolved fields and unresolved moments.
struct TrainSums {
    PixelFields fields;
    vec4 breaking;  // displacement gradient of the waves that break
    PixelMoments unresolved;
};

TrainSums pixel_trains(SplitMetres x, vec3 footprint, TrainSums sums) {
    int full = trains_above(length(footprint), train_filter.z);
    int end = trains_above(footprint.x, train_filter.w);
    vec4 low = texelFetch(train_table, ivec2(end, 6), 0);
    vec4 high = texelFetch(train_table, ivec2(end, 7), 0);
    vec4 first = vec4(0.0);
    float dxy = 0.0;
    vec3 breaking = vec3(0.0);
    vec3 values = vec3(0.0);
    for (int i = 0; i < end; ++i) {
        vec2 wave = train_sine_cosine(i, x);
        vec4 train = texelFetch(train_table, ivec2(i, 3), 0);
        float most = train.y * wave.y;
        if (i >= full) {
            float w = train_weight(train.x, footprint_along(i, footprint));
            most = min(w, train.y) * wave.y;
            wave *= w;
            float part = unresolved_part(w);
            float gradient_part = unresolved_part(train.y > w ? w / train.y : 1.0);
            low += vec4(part, part, part, gradient_part) * texelFetch(train_table, ivec2(i, 4), 0);
            high += gradient_part * texelFetch(train_table, ivec2(i, 5), 0);
        }
        vec4 amplitude = texelFetch(train_table, ivec2(i, 1), 0);
        vec4 more = texelFetch(train_table, ivec2(i, 2), 0);
        float across = more.x;
        if (kMasks > 0) values += vec3(more.y * wave.y, more.z * wave.x, more.w * wave.x);
        first += amplitude * vec4(wave.x, wave.x, wave.y, wave.y);
        dxy += across * wave.y;
        breaking += vec3(amplitude.zw, across) * most;
    }
    if (!kChoppy) {  // the displacement gradient serves breaking alone
        first.zw = vec2(0.0);
        dxy = 0.0;
    }
    PixelFields f = sums.fields;
    PixelMoments m = sums.unresolved;
    return TrainSums(PixelFields(f.slope_x + first.x, f.slope_y + first.y, f.dxx + first.z, f.dyy + first.w,
                                 f.dxy + dxy, f.dyx + dxy, f.values + (kChoppy ? values : vec3(values.x, 0.0, 0.0))),
                     sums.breaking + vec4(breaking, breaking.z),
                     PixelMoments(m.xx + low.x, m.xy + low.y, m.yy + low.z, m.xxxx + low.w, m.xxxy + high.x,
                                  m.xxyy + high.y, m.xyyy + high.z, m.yyyy + high.w));
}
