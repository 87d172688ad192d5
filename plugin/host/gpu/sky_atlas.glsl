// The sky's map for hosts whose textures have no mip levels: all levels side by side (sky_atlas.h), filtered
// here, step by step as SkyMap::trilinear(); for core/lighting/sky_map.glsl.

uniform sampler2D sky_map;

vec3 sky_bilinear(vec2 u, int level) {
    int whole = int(kSkyMapSize);
    int size = whole >> level;
    ivec2 first = level == 0 ? ivec2(0) : ivec2(whole, whole - 2 * size);
    vec2 x = clamp((u * (0.5 / kSkyMapReach) + 0.5) * float(size) - 0.5, vec2(-1.0), vec2(float(size)));
    vec2 below = floor(x);
    vec2 share = x - below;
    ivec2 low = first + clamp(ivec2(below), 0, size - 1);
    ivec2 high = first + clamp(ivec2(below) + 1, 0, size - 1);
    vec4 near_row = mix(texelFetch(sky_map, low, 0), texelFetch(sky_map, ivec2(high.x, low.y), 0), share.x);
    vec4 far_row = mix(texelFetch(sky_map, ivec2(low.x, high.y), 0), texelFetch(sky_map, high, 0), share.x);
    vec4 texel = mix(near_row, far_row, share.y);
    return vec3(texel.x, texel.y, texel.z);
}

vec3 sky_texel(ivec2 at) {
    vec4 texel = texelFetch(sky_map, at, 0);
    return vec3(texel.x, texel.y, texel.z);
}

vec3 sky_filtered(vec2 u, float level) {
    float coarsest = log2(kSkyMapSize);
    float held = clamp(level, 0.0, coarsest);
    float fine = floor(held);
    return mix(sky_bilinear(u, int(fine)), sky_bilinear(u, int(min(fine + 1.0, coarsest))), held - fine);
}
