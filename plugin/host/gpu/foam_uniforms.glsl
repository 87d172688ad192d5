// The pattern of foam (core/lighting/foam_structure.glsl) for the grid's origin.
uniform vec3 foam_pattern_cell;
uniform vec3 foam_pattern_rest;
uniform vec4 foam_pattern_axes;
uniform vec4 foam_pattern_look;
uniform vec2 foam_pattern_white;
