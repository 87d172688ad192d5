// Gusts at a point, as in core/evaluate/gusts.cpp. The rows of `gusts`: for each wave its cycles/m along x and y, its
// phase at the origin at the frame's time, and its amplitude; then for each wave its shortest length [m] and its
// direction; then, number after number, the terms of the threshold by level and by the resolved share of variance,
// and the strength.
struct GustAnswer {
    float factor;              // on the slope variance that the pixel leaves unresolved
    float whitecap_threshold;
};

uniform vec2 gust_filter;  // n_min, 1/(n_max − n_min)

float gust_term(int i) { return gusts[2 * kGustWaves + i / 4][i % 4]; }

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
    float of_level = 0.0;
    for (int n = kGustLevelTerms - 1; n >= 0; --n) of_level = of_level * level + gust_term(n);
    float of_kept = 0.0;
    for (int n = kGustKeptTerms - 1; n >= 0; --n) of_kept = of_kept * sum.kept + gust_term(kGustLevelTerms + n);
    return GustAnswer(1.0 + gust_term(kGustLevelTerms + kGustKeptTerms) * level, of_level + of_kept);
}
