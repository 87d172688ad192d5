// The points at rest that the pixels show, for sea_points_texture.glsl: their light is computed afterwards, once a pixel.
in vec2 rest_m;
in vec3 pixel_m;

layout(location = 0) out vec4 first_out;
layout(location = 1) out vec4 second_out;

void main() {
    first_out = vec4(rest_m, pixel_m.x, pixel_m.y);
    second_out = vec4(pixel_m.z, 0.0, 0.0, 0.0);
}
