// Waves that feel a coast's floor at a point, as AddCoastTrains() (core/evaluate/coast-inl.h) has them, and the foam of surf, coast_foam()
// (core/waves/coast.cpp).
//
// Rows of `gusts` from kCoastRow on: where the origin is in its cell, 0 … 1, and cells per metre; the number of cells, how far beyond the map
// gains fade [m], and the wavenumber of the highest waves [rad/m]; n_min and 1/(n_max − n_min) of the filter, how many trains feel the floor, and how
// many of their pictures lie side by side; the cell that the origin is in.
//
// Of trains on a coast, train_table's rows 1 and 2 are: 1: height [m]; how far the train moves water to the side, over height times wavenumber [m],
// for displacement and for waves that break; one over how far beyond the map its phase fades [1/m]; 2: kx, ky [rad/m] where it comes from.
// The wavelength in row 3 is the longest that deeper water makes it.
uniform sampler2D coast_cells;   // a texel a cell: the share that breaks, the heights' deviation [m], the gain of trains too short to feel the floor
uniform sampler2D coast_trains;  // of each train that feels it a picture of the cells: phase [cycles], gain

// A place on the map: the cell that it is in, where in it, 0 … 1, and how far beyond the map it is [m]. Cells are counted from the origin's: as numbers
// of single precision places near it are exact.
struct CoastPlace {
    ivec2 cell;
    vec2 within, beyond_m;
};

CoastPlace coast_place(vec2 rest_m) {
    vec4 from = gusts[kCoastRow];
    vec2 at = from.xy + rest_m * from.zw, whole = floor(at), within = at - whole;
    vec2 cell = whole + gusts[kCoastRow + 3].xy, last = gusts[kCoastRow + 1].xy - 1.0, beyond = vec2(0.0);
    for (int axis = 0; axis < 2; ++axis) {
        if (cell[axis] >= 0.0 && cell[axis] <= last[axis]) continue;
        bool is_before = !(cell[axis] > 0.0);
        beyond[axis] = is_before ? cell[axis] + within[axis] : cell[axis] - last[axis] - 1.0 + within[axis];
        cell[axis] = is_before ? 0.0 : last[axis];
        within[axis] = is_before ? 0.0 : 1.0;
    }
    return CoastPlace(ivec2(cell), within, beyond / from.zw);
}

// What is left of a map's part at so many times the distance over which it fades, and its derivative.
vec2 coast_fade(float t) {
    return t < 1.0 ? vec2(1.0 - t * t * (3.0 - 2.0 * t), -6.0 * t * (1.0 - t)) : vec2(0.0);
}

// The nine cells round a place: quadratic B-splines of values, and how they change [1/m].
struct CoastTaps {
    ivec3 columns, rows;
    vec3 along, across, along_rate, across_rate;
    float beyond_m;
    vec2 outwards;
    vec3 left;  // of the map's gains, and how it changes
};

CoastTaps coast_taps(vec2 rest_m) {
    CoastPlace place = coast_place(rest_m);
    ivec2 count = ivec2(gusts[kCoastRow + 1].xy);
    vec2 per_m = gusts[kCoastRow].zw;
    ivec2 own = place.cell, before = max(own - 1, 0), after = min(own + 1, count - 1);
    MaskWeights x = mask_weights(place.within.x - 0.5), y = mask_weights(place.within.y - 0.5);
    float far_m = length(place.beyond_m), fade_m = gusts[kCoastRow + 1].z;
    vec2 outwards = far_m > 0.0 ? place.beyond_m / far_m : vec2(0.0), fade = coast_fade(far_m / fade_m);
    return CoastTaps(ivec3(before.x, own.x, after.x), ivec3(before.y, own.y, after.y), vec3(x.before, x.here, x.after),
                     vec3(y.before, y.here, y.after), per_m.x * vec3(x.before_rate, x.here_rate, x.after_rate),
                     per_m.y * vec3(y.before_rate, y.here_rate, y.after_rate), far_m, outwards,
                     vec3(fade.x, fade.y / fade_m * outwards));
}

// A train as it is there: what the floor adds to its phase [cycles], its wavevector [rad/m], its height [m] and how that changes.
struct LocalTrain {
    float cycles;
    vec2 k;
    float height_m;
    vec2 height_rate;
};

// Of trains too short to feel the floor: their gain, and how it changes.
vec3 coast_others(CoastTaps taps) {
    vec3 gain = vec3(0.0);
    for (int j = 0; j < 3; ++j)
        for (int i = 0; i < 3; ++i) {
            float own = texelFetch(coast_cells, ivec2(taps.columns[i], taps.rows[j]), 0).z;
            gain += own * vec3(taps.along[i] * taps.across[j], taps.along_rate[i] * taps.across[j], taps.along[i] * taps.across_rate[j]);
        }
    return vec3(1.0, 0.0, 0.0) + taps.left.x * (gain - vec3(1.0, 0.0, 0.0)) + (gain.x - 1.0) * vec3(0.0, taps.left.yz);
}

LocalTrain local_train(int train, CoastTaps taps, vec3 others) {
    vec4 numbers = texelFetch(train_table, ivec2(train, 1), 0);
    vec2 k = texelFetch(train_table, ivec2(train, 2), 0).xy;
    ivec2 pictures = ivec2(gusts[kCoastRow + 2].zw);
    if (train >= pictures.x) return LocalTrain(0.0, k, numbers.x * others.x, numbers.x * others.yz);
    float t = taps.beyond_m * numbers.w;
    if (t >= 1.0) return LocalTrain(0.0, k, numbers.x, vec2(0.0));
    ivec2 count = ivec2(gusts[kCoastRow + 1].xy), first = count * ivec2(train % pictures.y, train / pictures.y);
    vec2 all = vec2(0.0), x_rate = vec2(0.0), y_rate = vec2(0.0);
    for (int j = 0; j < 3; ++j) {
        vec2 sum = vec2(0.0), rate = vec2(0.0);
        for (int i = 0; i < 3; ++i) {
            vec2 cell = texelFetch(coast_trains, first + ivec2(taps.columns[i], taps.rows[j]), 0).xy;
            sum += taps.along[i] * cell;
            rate += taps.along_rate[i] * cell;
        }
        all += taps.across[j] * sum;
        x_rate += taps.across[j] * rate;
        y_rate += taps.across_rate[j] * sum;
    }
    float cycles = all.x, gain = all.y;
    vec2 cycles_rate = vec2(x_rate.x, y_rate.x), gain_rate = vec2(x_rate.y, y_rate.y);
    if (taps.beyond_m > 0.0) {
        vec2 fade = coast_fade(t);
        cycles_rate = fade.x * cycles_rate + cycles * fade.y * numbers.w * taps.outwards;
        cycles *= fade.x;
        gain_rate = taps.left.x * gain_rate + (gain - 1.0) * taps.left.yz;
        gain = 1.0 + taps.left.x * (gain - 1.0);
    }
    return LocalTrain(cycles, k + 6.28318530717958647692 * cycles_rate, numbers.x * gain, numbers.x * gain_rate);
}

// How much of such waves a footprint shows: of width and stretch.
float local_weight(vec3 footprint, float k, vec2 unit) {
    float stretch = dot(footprint.yz, unit), along = sqrt(stretch * stretch + footprint.x * footprint.x);
    return footprint_weight(6.28318530717958647692 / (k * max(along, 1e-6)), train_filter.x, train_filter.y);
}

// As cell_trains() and pixel_trains().
vec3 coast_cell_trains(vec2 rest_m, vec3 footprint) {
    CoastTaps taps = coast_taps(rest_m);
    vec3 others = coast_others(taps);
    SplitMetres x = split_metres(rest_m);
    vec3 sum = vec3(0.0);
    int end = trains_above(footprint.x, train_filter.w);
    for (int i = 0; i < end; ++i) {
        LocalTrain at = local_train(i, taps, others);
        float k = sqrt(dot(at.k, at.k) + 1e-20);
        vec2 unit = at.k / k, wave = local_weight(footprint, k, unit) * sine_cosine(train_phase(i, x) - at.cycles);
        float sideways = min(texelFetch(train_table, ivec2(i, 1), 0).y * k * at.height_m, 1.0 / k);
        sum += vec3(at.height_m * wave.y, sideways * wave.x * unit);
    }
    return sum;
}

// (Dxx, Dyy, Dxy, Dyx). sideways: how far water goes, and how that changes.
vec4 local_gradient(vec2 unit, float k, float sideways, vec2 rate, vec2 wave) {
    float c = wave.y * k * sideways;
    return vec4(unit.x * rate.x * wave.x - unit.x * unit.x * c, unit.y * rate.y * wave.x - unit.y * unit.y * c,
                unit.x * rate.y * wave.x - unit.x * unit.y * c, unit.y * rate.x * wave.x - unit.x * unit.y * c);
}

TrainSums coast_pixel_trains(vec2 rest_m, vec3 footprint, TrainSums sums) {
    CoastTaps taps = coast_taps(rest_m);
    vec3 others = coast_others(taps);
    SplitMetres x = split_metres(rest_m);
    int shown = trains_above(footprint.x, train_filter.w), end = max(shown, int(gusts[kCoastRow + 2].z));
    float gain2 = others.x * others.x;
    PixelMoments m = sums.unresolved;
    vec4 low = gain2 * (vec4(m.xx, m.xy, m.yy, m.xxxx) + texelFetch(train_table, ivec2(end, 6), 0));
    vec4 high = gain2 * (vec4(m.xxxy, m.xxyy, m.xyyy, m.yyyy) + texelFetch(train_table, ivec2(end, 7), 0));
    vec2 slope = vec2(0.0);
    vec4 gradient = vec4(0.0);
    vec3 values = vec3(0.0);
    for (int i = 0; i < end; ++i) {
        LocalTrain at = local_train(i, taps, others);
        float k = sqrt(dot(at.k, at.k) + 1e-20), w = 0.0;
        vec2 unit = at.k / k, wave = vec2(0.0);
        if (i < shown) {
            w = local_weight(footprint, k, unit);
            wave = sine_cosine(train_phase(i, x) - at.cycles);
        }
        vec4 numbers = texelFetch(train_table, ivec2(i, 1), 0);
        float of_breaking = numbers.z * k * at.height_m, of_waves = numbers.y * k * at.height_m;
        float wide = min(of_breaking, 1.0 / k);
        // Where it is limited it hardly changes.
        vec2 wide_rate = of_breaking > 1.0 / k ? vec2(0.0) : numbers.z * k * at.height_rate;
        float most = texelFetch(train_table, ivec2(i, 3), 0).y, seen = min(w, most);
        slope += w * (at.height_m * wave.x * at.k + wave.y * at.height_rate);
        values += w * vec3(at.height_m * wave.y, min(of_waves, 1.0 / k) * wave.x * unit);
        vec4 own = local_gradient(unit, k, wide, wide_rate, wave);
        gradient += w * own;
        sums.breaking += seen * own;
        float part = 0.5 * unresolved_part(w), kh = k * wide;
        low.xyz += part * (at.height_m * at.height_m * vec3(at.k.x * at.k.x, at.k.x * at.k.y, at.k.y * at.k.y) +
                           vec3(at.height_rate.x * at.height_rate.x, at.height_rate.x * at.height_rate.y, at.height_rate.y * at.height_rate.y));
        // What isn't resolved at best counts with the waves outside.
        float pressed = 0.5 * (most * most - seen * seen) * kh * kh;
        vec3 square = vec3(unit.x * unit.x, unit.x * unit.y, unit.y * unit.y);
        low.w += pressed * square.x * square.x;
        high += pressed * vec4(square.x * square.y, square.x * square.z, square.y * square.z, square.z * square.z);
    }
    if (!kChoppy) {
        gradient = vec4(0.0);
        values.yz = vec2(0.0);
    }
    PixelFields f = sums.fields;
    return TrainSums(PixelFields(f.slope_x + slope.x, f.slope_y + slope.y, f.dxx + gradient.x, f.dyy + gradient.y, f.dxy + gradient.z,
                                 f.dyx + gradient.w, f.values + values),
                     sums.breaking, PixelMoments(low.x, low.y, low.z, low.w, high.x, high.y, high.z, high.w));
}

// On the highest crests, over kRoller of the share of waves that break.
float surf_foam(vec2 rest_m, float height_m, float footprint_m) {
    vec4 map = gusts[kCoastRow + 1];
    CoastPlace place = coast_place(rest_m);
    float left = coast_fade(length(place.beyond_m) / map.z).x;
    // From the middle of one cell to the next.
    vec2 half_on = place.within - 0.5, back = vec2(lessThan(half_on, vec2(0.0)));
    ivec2 lower = place.cell - ivec2(back), first = max(lower, 0), last = min(lower + 1, ivec2(map.xy) - 1);
    vec2 t = half_on + back;
    vec4 here = mix(mix(texelFetch(coast_cells, first, 0), texelFetch(coast_cells, ivec2(last.x, first.y), 0), t.x),
                    mix(texelFetch(coast_cells, ivec2(first.x, last.y), 0), texelFetch(coast_cells, last, 0), t.x), t.y);
    float share = left * kRoller * here.x;
    if (!(share > kLeastSurf && here.y > 0.0)) return 0.0;
    // quick_deviate(); the share is no more than kRoller.
    float deviate = max(log(share / (1.0 - share)) / kLogistic, kLeastDeviate);
    float crest = 0.5 * complementary_error(-kSurfSharpness * (height_m / here.y + deviate) * 0.70710678118654752440);
    vec4 filter_by = gusts[kCoastRow + 2];
    float shown = footprint_weight(6.28318530717958647692 / (map.w * max(footprint_m, 1e-6)), filter_by.x, filter_by.y);
    return mix(share, crest, shown);
}
