// The spray before the eye, for core/lighting/spray.glsl: its map and its uniforms.

uniform sampler2D spray_map;
uniform vec3 spray_azimuth; // column 0's, and columns per radian
uniform vec4 spray_rows;    // the first distance, the logarithm of the next over it, the scale of the profile, the eye's height
uniform float spray_top_m;
uniform vec3 spray_to_sun;
uniform vec3 spray_sun;
uniform vec3 spray_above;
uniform vec3 spray_below;

vec2 spray_texel(int column, int row) {
    vec4 texel = texelFetch(spray_map, ivec2(column, row), 0);
    return vec2(texel.x, texel.y);
}
