// The objects' mirror image for hosts whose textures have no mip levels: level 0 of w × h texels begins at (0, 0), level k, of max(w >> k, 1) ×
// max(h >> k, 1), at (w, 0) and as much more as it is large, in a picture of 2 w × h. Filtered here as the driver filters mirror_texture.glsl's,
// with nothing beyond the edges; for sky_with_objects.glsl.
uniform sampler2D mirrored_objects;  // radiance times coverage, and coverage

vec4 mirrored_bilinear(vec2 at, int level) {
    ivec2 whole = textureSize(mirrored_objects, 0) / ivec2(2, 1);
    ivec2 size = max(whole >> level, ivec2(1));
    ivec2 first = level == 0 ? ivec2(0) : ivec2(whole.x, 0) + size;
    vec2 x = clamp(at * vec2(size) - 0.5, vec2(-1.0), vec2(size));
    ivec2 low = ivec2(floor(x));
    vec2 share = x - vec2(low);
    vec4 sum = vec4(0.0);
    for (int i = 0; i < 4; ++i) {
        ivec2 corner = ivec2(i & 1, i >> 1);
        ivec2 texel = low + corner;
        if (any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, size))) continue;
        vec2 weights = mix(1.0 - share, share, vec2(corner));
        sum += weights.x * weights.y * texelFetch(mirrored_objects, first + texel, 0);
    }
    return sum;
}

vec4 mirrored_seen(vec2 at, float level) {
    ivec2 whole = textureSize(mirrored_objects, 0) / ivec2(2, 1);
    float held = clamp(level, 0.0, log2(float(max(whole.x, whole.y))));
    int fine = int(held);
    vec4 seen = mirrored_bilinear(at, fine);
    float share = held - float(fine);
    return share > 0.0 ? mix(seen, mirrored_bilinear(at, fine + 1), share) : seen;
}
