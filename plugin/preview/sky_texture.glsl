// The uniforms of sky and sun, for the files of core/lighting.

uniform sampler2D sky_map;
uniform vec3 sun_direction;
uniform vec3 sun_radiance;
uniform float sun_angular_radius;
uniform vec3 sun_irradiance;
uniform vec3 sky_irradiance;
uniform vec3 water_reflectance;

vec3 sky_lookup(vec2 u, float level) {
    vec4 texel = textureLod(sky_map, u * (0.5 / kSkyMapReach) + 0.5, level);
    return vec3(texel.x, texel.y, texel.z);
}
