// Gusts at a point, as in core/evaluate/gusts.cpp. The rows of `gusts`: for each wave its cycles/m along x and y, its
// phase at the origin at the frame's time, and its amplitude; then for each wave its shortest length [m] and its
// direction; then, number after number, the terms of the threshold by level and by the resolved share of variance,
// and the strength. Fronts have rows of their own, three each: the origin from its middle [m] and the direction of its way; one over its
// half axes, within and without its edge; its wind and how far it reaches [m]. Then the weakest and the strongest wind of all, and the factor in
// the middle of what the threshold's terms know and one over half of that; and the exponent of foam and its most.
struct GustAnswer {
    float factor;              // on the slope variance that the pixel leaves unresolved
    float whitecap_threshold;
};

uniform vec2 gust_filter;  // n_min, 1/(n_max − n_min)

float gust_term(int i) { return gusts[2 * kGustWaves + i / 4][i % 4]; }

const int kFirstFront = kGustRows + kMaskRows + kVesselRows * kVessels;

// The wind of all fronts, times the sea's.
float fronts_wind(vec2 rest_m, float level) {
    float wind = 1.0;
    for (int i = 0; i < kFronts; ++i) {
        vec4 place = gusts[kFirstFront + 3 * i];
        vec4 size = gusts[kFirstFront + 3 * i + 1];
        vec4 of = gusts[kFirstFront + 3 * i + 2];
        vec2 from = place.xy + rest_m;
        if (!(dot(from, from) < of.y * of.y)) continue;
        wind *= front_wind(from.x, from.y, place.z, place.w, size.x, size.y, size.z, size.w, of.x, level);
    }
    vec4 all = gusts[kFronts > 0 ? kFirstFront + 3 * kFronts : 0];
    return clamp(wind, all.x, all.y);
}

// What that makes of the mean of foam.
float fronts_foam(vec2 rest_m) {
    vec4 all = gusts[kFronts > 0 ? kFirstFront + 3 * kFronts + 1 : 0];
    return min(pow(max(fronts_wind(rest_m, 0.0), 1e-6), all.x), all.y);
}

GustAnswer gusts_at(vec2 rest_m, vec3 pixel) {
    GustSum sum = GustSum(0.0, 0.0, 0.0);
    for (int i = 0; i < kGustWaves; ++i) {
        vec4 wave = gusts[i];
        vec4 reach = gusts[kGustWaves + i];
        float footprint_m =
            sqrt(length2_along(max(pixel.x, finest_m.y), pixel.y, pixel.z, reach.y, reach.z));
        float weight = footprint_weight(reach.x / max(footprint_m, 1e-6), gust_filter.x, gust_filter.y);
        sum = with_gust(sum, wave.w, dot(wave.xy, rest_m) + wave.z, weight);
    }
    float level = gust_level(sum.resolved);
    float factor = 1.0 + gust_term(kGustLevelTerms + kGustKeptTerms) * level, at = level;
    if (kFronts > 0) {
        vec4 all = gusts[kFronts > 0 ? kFirstFront + 3 * kFronts : 0];
        factor *= fronts_wind(rest_m, level);
        at = (factor - all.z) * all.w;
    }
    float of_level = 0.0;
    for (int n = kGustLevelTerms - 1; n >= 0; --n) of_level = of_level * at + gust_term(n);
    float of_kept = 0.0;
    for (int n = kGustKeptTerms - 1; n >= 0; --n) of_kept = of_kept * sum.kept + gust_term(kGustLevelTerms + n);
    return GustAnswer(factor, of_level + of_kept);
}
