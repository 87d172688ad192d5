// The light as display values (core/lighting/tone.glsl), into a host's picture of sRGB.
uniform float exposure;

layout(location = 0) out vec4 colour_out;

void write_terms(vec3 sun, vec3 sky, vec3 sea, vec3 foam, vec3 air, float is_sea) {
    colour_out = host_colour(vec4(display_colour(sun + sky + sea + foam + air, exposure), 1.0));
}
