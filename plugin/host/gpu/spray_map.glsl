// The spray before the eye, for core/lighting/spray.glsl: its map and its uniforms.

uniform sampler2D spray_map;
uniform vec3 spray_azimuth; // column 0's, and columns per radian
uniform vec3 spray_rows;    // the first distance, the logarithm of the next over it, the eye's height
uniform bool spray_is_torn;
uniform vec3 spray_scales;  // of heights: scale, step; and the haze's extinction
uniform vec3 spray_forward; // mean cosines of two lobes
uniform float spray_top_m;
uniform vec3 spray_to_sun;
uniform vec3 spray_sun;
uniform vec3 spray_above;
uniform vec3 spray_below;
uniform vec3 spray_low_ahead;
uniform vec3 spray_low_beside;
uniform vec3 spray_low_behind;
uniform vec4 spray_threads_cell;
uniform vec4 spray_threads_wind;
uniform vec4 spray_threads_born;
uniform vec4 spray_threads_look; // names of two generations, extinction, a pixel's angle

vec4 spray_texel(int column, int row) { return texelFetch(spray_map, ivec2(column, row), 0); }
// Below the rows, as many.
float spray_lift(int column, int row) {
    return spray_is_torn ? texelFetch(spray_map, ivec2(column, row + textureSize(spray_map, 0).y / 2), 0).x : 0.0;
}
