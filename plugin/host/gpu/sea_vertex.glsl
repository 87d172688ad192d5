// The sea's geometry: points of the projected grid, displaced by the waves that their cells resolve.

layout(location = 0) in vec2 rest_in;  // [m], relative to the grid's origin
layout(location = 1) in vec3 cell_in;   // footprints: width and long axis [m]
layout(location = 2) in vec3 pixel_in;

uniform float eye_height_m;     // above the grid's origin
uniform float curvature_per_m;  // of the earth, 0: flat
uniform mat4 clip_from_grid;
uniform vec2 depth_of_distance;  // z = .x w + .y

out vec2 rest_m;
out vec3 pixel_m;
out vec3 from_eye_m;
out vec3 mesh_variance;
out vec3 crest_shape;

void main() {
    vec3 displacement = query_cell(rest_in, cell_in);
    rest_m = rest_in;
    pixel_m = pixel_in;
    mesh_variance = query_mesh_variance(rest_in, cell_in);
    crest_shape = crest_at(rest_in, cell_in);
    write_shape();
    EarthPoint at = on_earth(rest_in.x + displacement.y, rest_in.y + displacement.z, displacement.x + shape_height_m(),
                             curvature_per_m);
    vec3 place = vec3(at.x, at.y, at.z);
    from_eye_m = place - vec3(0.0, 0.0, eye_height_m);
    vec4 clip = clip_from_grid * vec4(place, 1.0);
    gl_Position = vec4(clip.x, clip.y, depth_of_distance.x * clip.w + depth_of_distance.y, clip.w);
}
