// The air before the eye, for core/lighting/air.glsl: its table and its uniforms.

uniform sampler2D air_table;
uniform vec2 air_azimuth;
uniform vec3 air_to_sun;
uniform float air_by_place;
uniform vec3 air_reach_m;  // the nearest place on the sea, the horizon, the end of the air
uniform vec2 air_sky_rows; // the horizon's dip, and how far up the sky's rows go [rad]

vec4 air_texel(int column, int row) { return texelFetch(air_table, ivec2(column, row), 0); }
