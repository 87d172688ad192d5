// The sky's map as a texture with mip levels, which the driver filters.

uniform sampler2D sky_map;

vec3 sky_lookup(vec2 u, float level) {
    vec4 texel = textureLod(sky_map, u * (0.5 / kSkyMapReach) + 0.5, level);
    return vec3(texel.x, texel.y, texel.z);
}
