// The sea's geometry: points of the projected grid, displaced by the waves that their cells resolve.

layout(location = 0) in vec2 rest_in;  // [m], relative to the grid's origin
layout(location = 1) in vec3 cell_in;   // footprints: width and long axis [m]
layout(location = 2) in vec3 pixel_in;

uniform mat4 clip_from_grid;
uniform vec2 depth_of_distance;  // z = .x w + .y

out vec2 rest_m;
out vec3 pixel_m;

void main() {
    vec3 displacement = query_cell(rest_in, cell_in);
    rest_m = rest_in;
    pixel_m = pixel_in;
    vec4 clip = clip_from_grid *
                vec4(rest_in.x + displacement.y, rest_in.y + displacement.z, displacement.x, 1.0);
    gl_Position = vec4(clip.x, clip.y, depth_of_distance.x * clip.w + depth_of_distance.y, clip.w);
}
