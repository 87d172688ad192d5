// The same as sea_points_in.glsl, from the pictures that sea_points_fragment.glsl made.
uniform sampler2D first_points;
uniform sampler2D second_points;
uniform sampler2D third_points;

vec2 rest_m;
vec3 drawn_pixel_m;
float drawn_distance_m;
float drawn_mesh_variance;
vec3 drawn_crest;

void read_point() {
    vec4 first = texelFetch(first_points, ivec2(gl_FragCoord.xy), 0);
    vec4 second = texelFetch(second_points, ivec2(gl_FragCoord.xy), 0);
    rest_m = first.xy;
    drawn_pixel_m = vec3(first.z, first.w, second.x);
    drawn_distance_m = second.y;
    drawn_mesh_variance = second.z;
    drawn_crest = texelFetch(third_points, ivec2(gl_FragCoord.xy), 0).xyz;
}

vec3 point_from_eye() {
    return pixel_ray() * drawn_distance_m;
}

vec3 pixel_on_mesh() {
    return drawn_pixel_m;
}

vec3 point_crest() {
    return drawn_crest;
}

float point_distance_m() {
    return drawn_distance_m;
}

float mesh_variance_along() {
    return drawn_mesh_variance;
}
