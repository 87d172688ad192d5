// The points at rest that the pixels show, for sea_points_texture.glsl: their light is computed afterwards, once a pixel.
layout(location = 0) out vec4 first_out;
layout(location = 1) out vec4 second_out;
layout(location = 2) out vec4 third_out;

void main() {
    read_point();
    vec3 drawn = pixel_on_mesh();
    first_out = vec4(rest_m, drawn.x, drawn.y);
    second_out = vec4(drawn.z, point_distance_m(), mesh_variance_along(), 0.0);
    third_out = vec4(point_crest(), 0.0);
}
