// The light as display values (core/lighting/tone.glsl), into a host's picture of sRGB.
uniform float exposure;
uniform vec3 white_balance_red;
uniform vec3 white_balance_green;
uniform vec3 white_balance_blue;

layout(location = 0) out vec4 colour_out;

void write_terms(vec3 sun, vec3 sky, vec3 sea, vec3 foam, vec3 air, float is_sea) {
    vec3 light = sun + sky + sea + foam + air;
    vec3 balanced = light.x * white_balance_red + light.y * white_balance_green + light.z * white_balance_blue;
    colour_out = host_colour(vec4(display_colour(balanced, exposure), 1.0));
}
