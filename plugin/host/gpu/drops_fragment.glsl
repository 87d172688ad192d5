// A place of a drop's disc, before the sea that is drawn there already.

uniform sampler2D sea_depth;
uniform vec3 nearness_of_depth;  // the near plane over the distance ahead is .x + .y depth; that plane's [m]
uniform vec2 picture_size;

flat in vec4 disc;
flat in vec4 light;
flat in float depth_m;

void main() {
    vec2 place = vec2(gl_FragCoord.x, picture_size.y - gl_FragCoord.y);
    float nearness = nearness_of_depth.x + nearness_of_depth.y * texelFetch(sea_depth, ivec2(gl_FragCoord.xy), 0).x;
    float before = 1.0e30;  // no sea
    if (nearness > 0.0)
        before = (nearness_of_depth.z / (nearness * dot(pixel_ray(), view_forward)) - light.w) / depth_m;
    float hidden = spray_drop_hides((place - disc.xy) / disc.z, disc.w, before);
    write_before(hidden * light.xyz, hidden);
}
