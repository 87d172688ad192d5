// The sea's geometry for a host that has its own projection and draws its own objects by depth.

in vec2 rest_in;  // [m], relative to the grid's origin
in vec3 cell_in;   // footprints: width and long axis [m]
in vec3 pixel_in;

uniform float eye_height_m;     // above the grid's origin
uniform float curvature_per_m;  // of the earth, 0: flat
uniform mat4 clip_from_grid;  // the host's

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
    EarthPoint at = on_earth(rest_in.x + displacement.y, rest_in.y + displacement.z, displacement.x, curvature_per_m);
    vec3 place = vec3(at.x, at.y, at.z);
    from_eye_m = place - vec3(0.0, 0.0, eye_height_m);
    vec4 clip = clip_from_grid * vec4(place, 1.0);
    // Beyond the host's far plane the sea goes on, as far away as a depth buffer of 24 bits can tell from
    // nothing. Rows come nearest first, so that there, too, the nearer one is shown.
    gl_Position = vec4(clip.x, clip.y, min(clip.z, 0.99999976 * clip.w), clip.w);
}
