// What facets of the sea mirror, for core/lighting/sky.glsl: the sky, and the objects before it, from a picture of them as the eye's
// mirror image sees them. Of a facet that leans the ray leaves the plane that such a picture is of: so it is followed as far as it goes
// to an object's box, and the picture shows what lies there. mirror_texture.glsl has the picture.
uniform mat4 mirrored_from_grid;
uniform float mirrored_texels;       // a tangent of 1
uniform int object_count;
uniform mat4 object_boxes[kObjectBoxes];  // from the grid to a cube, −1 … 1

vec3 mirrors_at;

void mirror_from(vec3 place) { mirrors_at = place; }

// To the nearest box that the ray meets, or to where it comes nearest to one.
float way_to_object(vec3 from, vec3 towards) {
    float way = 0.0;
    float least = 1.0e30;
    for (int i = 0; i < object_count; ++i) {
        vec3 o = (object_boxes[i] * vec4(from, 1.0)).xyz;
        vec3 d = mat3(object_boxes[i]) * towards;
        vec3 safe = mix(d, vec3(1.0e-9), lessThan(abs(d), vec3(1.0e-9)));
        vec3 one = (-1.0 - o) / safe;
        vec3 other = (1.0 - o) / safe;
        vec3 first = min(one, other);
        vec3 last = max(one, other);
        float enters = max(max(first.x, first.y), max(first.z, 0.0));
        if (min(min(last.x, last.y), last.z) >= enters) {
            if (least > 0.0 || enters < way) way = enters;
            least = 0.0;
            continue;
        }
        float along = max(-dot(o, d) / dot(d, d), 0.0);
        float miss = length(max(abs(o + along * d) - 1.0, vec3(0.0)));
        if (miss < least) {
            way = along;
            least = miss;
        }
    }
    return way;
}

vec3 sky_lookup(vec2 u, float level) {
    vec3 sky = mapped_sky(u, level);
    float across2 = dot(u, u);
    vec3 towards = vec3(2.0 * u, 1.0 - across2) / (1.0 + across2);
    float way = way_to_object(mirrors_at, towards);
    vec4 at = mirrored_from_grid * vec4(mirrors_at + way * towards, 1.0);
    if (!(at.w > 0.0)) return sky;
    // sky_level()'s inverse: the deviation of what the level stands for, as an angle.
    float spread = level > 0.0 ? exp2(level) * (kSkyMapReach / kSkyMapSize) * (1.0 + towards.z) : 0.0;
    float blur = spread * way * mirrored_texels / at.w;
    vec4 seen = mirrored_seen(0.5 * at.xy / at.w + 0.5, log2(max(2.0 * blur, 1.0)));
    return seen.xyz + (1.0 - seen.w) * sky;
}
