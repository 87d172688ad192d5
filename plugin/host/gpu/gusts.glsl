// Gusts at a point, as in core/evaluate/gusts.cpp. The rows of `gusts`: for each wave its cycles/m along x and y, its
// phase at the origin at the frame's time, and its amplitude; then for each wave its shortest length [m] and its
// direction; then, number after number, the terms of the threshold by level and by the resolved share of variance,
// and the strength. Fronts have rows of their own, two each: the origin from its middle [m] and the direction of its way; the half axes of its
// ellipse, its edge [m] and its wind. Then the weakest and the strongest wind of all, and the highest threshold; and, first for winds
// above 1 and then for those below, the bends of what they add (Gusts::Bend).
struct GustAnswer {
    float factor;              // on the slope variance that the pixel leaves unresolved
    float whitecap_threshold;
};

uniform vec2 gust_filter;  // n_min, 1/(n_max − n_min)

float gust_term(int i) { return gusts[2 * kGustWaves + i / 4][i % 4]; }

const int kFirstFront = kGustRows + kMaskRows + kVesselRows * kVessels;

// The wind of all fronts, times the sea's.
float fronts_wind(vec2 rest_m, vec3 pixel, float level) {
    float wind = 1.0;
    float width = max(pixel.x, finest_m.y);
    float beyond = 0.5 * max(width, length(pixel.yz));
    for (int i = 0; i < kFronts; ++i) {
        vec4 place = gusts[kFirstFront + 2 * i];
        vec4 of = gusts[kFirstFront + 2 * i + 1];
        vec2 from = place.xy + rest_m;
        float reach = max(of.x, of.y) + of.z + beyond;
        if (!(dot(from, from) < reach * reach)) continue;
        float along = sqrt(length2_along(width, pixel.y, pixel.z, place.z, place.w));
        float across = sqrt(length2_along(width, pixel.y, pixel.z, -place.w, place.z));
        wind *= front_wind(from.x, from.y, place.z, place.w, of.x, of.y, of.z, along, across, of.w, level);
    }
    vec4 all = gusts[kFronts > 0 ? kFirstFront + 2 * kFronts : 0];
    return clamp(wind, all.x, all.y);
}

// What a wind of them adds to the threshold, where the pattern isn't seen and more where it is, and to what foam is of the mean.
vec3 front_adds(float wind) {
    vec3 sum = vec3(0.0);
    int first = kFirstFront + 2 * kFronts + 1 + (wind < 1.0 ? kFrontBends : 0);
    for (int i = 0; i < kFrontBends; ++i) {
        vec4 bend = gusts[kFronts > 0 ? first + i : 0];
        sum += max(abs(wind - 1.0) - abs(bend.x - 1.0), 0.0) * bend.yzw;
    }
    return sum;
}

// What that makes of the mean of foam.
float fronts_foam(vec2 rest_m, float footprint) {
    return max(1.0 + front_adds(fronts_wind(rest_m, vec3(footprint, 0.0, 0.0), 0.0)).z, 0.0);
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
    float factor = 1.0 + gust_term(kGustLevelTerms + kGustKeptTerms) * level;
    float of_level = 0.0;
    for (int n = kGustLevelTerms - 1; n >= 0; --n) of_level = of_level * level + gust_term(n);
    float of_kept = 0.0;
    for (int n = kGustKeptTerms - 1; n >= 0; --n) of_kept = of_kept * sum.kept + gust_term(kGustLevelTerms + n);
    float threshold = of_level + of_kept;
    if (kFronts > 0) {
        float wind = fronts_wind(rest_m, pixel, level);
        factor *= wind;
        if (wind != 1.0) {
            vec3 adds = front_adds(wind);
            float most = gusts[kFronts > 0 ? kFirstFront + 2 * kFronts : 0].z;
            threshold = min(threshold + (adds.x + adds.y * patchy_share(sum.kept)), max(threshold, most));
        }
    }
    return GustAnswer(factor, threshold);
}
