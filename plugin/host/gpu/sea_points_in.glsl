// What a pixel of the sea shows, from the vertices: the point at rest, and its footprint.
in vec2 rest_m;
in vec3 pixel_m;  // width and long axis, on the sea at rest
in vec3 from_eye_m;
in vec3 mesh_variance;  // of slopes: xx, yy, xy
in vec3 crest_shape;    // of long waves: slopes, height [m]

uniform float eye_height_m;  // above the grid's origin

void read_point() { keep_out_of_hulls(vec3(0.0, 0.0, eye_height_m) + from_eye_m); }
vec3 point_from_eye() { return from_eye_m; }
vec3 point_crest() { return crest_shape; }
float point_distance_m() { return length(from_eye_m); }
// Variance of the slopes that the mesh leaves unresolved, along the view.
float mesh_variance_along() {
    vec2 d = from_eye_m.xy;
    vec3 products = vec3(d.x * d.x, d.y * d.y, 2.0 * d.x * d.y);
    return dot(mesh_variance, products) / max(dot(d, d), 1.0e-12);
}

// On the triangle that is drawn.
vec3 pixel_on_mesh() {
    float tangent = length(view_right);
    if (!(tangent > 0.0)) return pixel_m;  // parallel rays
    vec3 ray = view_forward + view_right * (gl_FragCoord.x - view_centre.x) + view_up * (gl_FragCoord.y - view_centre.y);
    vec2 nearer = vec2(dFdx(gl_FragCoord.w), dFdy(gl_FragCoord.w)) / (gl_FragCoord.w * tangent);
    PixelFootprint drawn =
        footprint_on_mesh(PixelFootprint(pixel_m.x, pixel_m.y, pixel_m.z), view_right.x / tangent,
                          view_right.y / tangent, view_up.x / tangent, view_up.y / tangent, ray.x, ray.y, nearer.x, nearer.y);
    return vec3(drawn.width, drawn.axis_x, drawn.axis_y);
}
