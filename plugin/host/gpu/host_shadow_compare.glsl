// The same for a host whose textures don't compare: of the four texels round the place.
uniform sampler2D sun_blockers;

float shadow_seen(vec3 at) {
    vec2 texel = at.xy * vec2(textureSize(sun_blockers, 0)) - 0.5;
    ivec2 corner = ivec2(floor(texel));
    ivec2 last = textureSize(sun_blockers, 0) - 1;
    vec2 share = texel - floor(texel);
    vec4 seen;
    for (int i = 0; i < 4; ++i) {
        ivec2 of = clamp(corner + ivec2(i & 1, i >> 1), ivec2(0), last);
        seen[i] = texelFetch(sun_blockers, of, 0).x < at.z ? 0.0 : 1.0;
    }
    return mix(mix(seen.x, seen.y, share.x), mix(seen.z, seen.w, share.x), share.y);
}
