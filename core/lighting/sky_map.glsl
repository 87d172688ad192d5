// Lookups in the sky's map (sky_map.h). The includer defines, after special.glsl:
//   kSkyMapSize                                texels per side of the map, a float
//   vec3 sky_texel(ivec2 at)                   of the finest level, inside the map
//   vec3 sky_filtered(vec2 u, float level)     trilinear, from level 1 on

float sky_texels_in(float x) {
    return x > -1.0f ? min(x, kSkyMapSize) : -1.0f;  // false for a NaN
}

// The finest level as a quadratic B-spline whose coefficients are the texels: without kinks, and nowhere beyond its
// neighbours. That level has no ground: the sky is continued past the horizon.
vec3 sky_smooth(vec2 u) {
    vec2 x = (u * (0.5f / kSkyMapReach) + 0.5f) * kSkyMapSize - 0.5f;
    x = vec2(sky_texels_in(x.x), sky_texels_in(x.y));
    vec2 nearest = floor(x + 0.5f);
    vec2 t = x - nearest;
    ivec2 middle = ivec2(nearest);
    int last = int(kSkyMapSize) - 1;
    vec3 sum = vec3(0.0f);
    for (int j = -1; j <= 1; ++j)
        for (int i = -1; i <= 1; ++i) {
            float wx = i == 0 ? 0.75f - t.x * t.x : 0.5f * square(0.5f + float(i) * t.x);
            float wy = j == 0 ? 0.75f - t.y * t.y : 0.5f * square(0.5f + float(j) * t.y);
            sum += wx * wy * sky_texel(clamp(middle + ivec2(i, j), ivec2(0), ivec2(last)));
        }
    return sum;
}

// The map at a place, averaged as its level does. Sharper than level 1 it is smooth, and ends at the horizon, where
// the light from below begins (its corner's) within half a texel.
vec3 mapped_sky(vec2 u, float level) {
    if (level >= 1.0f) return sky_filtered(u, level);
    float texels = kSkyMapSize / (2.0f * kSkyMapReach);
    float ground = clamp((length(u) - 1.0f) * texels * 2.0f + 0.5f, 0.0f, 1.0f);
    vec3 sharp = ground < 1.0f ? sky_smooth(u) : vec3(0.0f);
    if (ground > 0.0f) sharp = mix(sharp, sky_texel(ivec2(0)), ground);
    return level > 0.0f ? mix(sharp, sky_filtered(u, 1.0f), level) : sharp;
}
