// The sky's map as a texture with mip levels, which the driver filters, for core/lighting/sky_map.glsl.

uniform sampler2D sky_map;

vec3 sky_texel(ivec2 at) {
    vec4 texel = texelFetch(sky_map, at, 0);
    return vec3(texel.x, texel.y, texel.z);
}

vec3 sky_filtered(vec2 u, float level) {
    vec4 texel = textureLod(sky_map, u * (0.5 / kSkyMapReach) + 0.5, level);
    return vec3(texel.x, texel.y, texel.z);
}
