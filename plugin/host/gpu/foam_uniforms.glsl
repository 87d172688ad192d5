// The pattern of foam (core/lighting/foam_structure.glsl) for the grid's origin, and the artist's picture of it.
uniform vec3 foam_pattern_cell;
uniform vec3 foam_pattern_rest;
uniform vec4 foam_pattern_axes;
uniform vec4 foam_pattern_look;
uniform vec2 foam_pattern_white;
uniform vec4 foam_pattern_image;
uniform sampler2D foam_image;

float foam_image_texel(int x, int y) { return texelFetch(foam_image, ivec2(x, y), 0).x; }
