// Objects in the water, for an eye in the air that sees them through its surface as one mean facet. By a picture of what of them is in the
// water, from where they see the eye through a level surface: the refracted rays of all pixels run nearly as its own do, so that few steps
// find what a ray meets.
uniform sampler2D objects_in_water;  // what they send through the water, and coverage
uniform sampler2D objects_in_water_depth;
uniform mat4 in_water_from_grid;
uniform vec3 in_water_ahead;     // .z over (.x + .y × depth) is how far ahead a texel's place is; .z = 0: none is in the water

// By eye: what is thinner along the ray than a twelfth of its way through the boxes may be missed; then its place is found to a sixteenth of a step.
const int kStepsInWater = 12;
const int kFinerSteps = 4;
const float kLeastCosine = 0.02;  // of a view along the surface, as pelagic render has it

// Through how much of the objects' boxes a ray goes: from .x to .y.
vec2 way_in_boxes(vec3 from, vec3 towards) {
    vec2 way = vec2(1.0e30, -1.0);
    for (int i = 0; i < object_count; ++i) {
        vec3 o = (object_boxes[i] * vec4(from, 1.0)).xyz;
        vec3 d = mat3(object_boxes[i]) * towards;
        d = mix(d, vec3(1.0e-9), lessThan(abs(d), vec3(1.0e-9)));
        vec3 one = (-1.0 - o) / d;
        vec3 other = (1.0 - o) / d;
        vec3 first = min(one, other);
        vec3 last = max(one, other);
        float enters = max(max(first.x, first.y), max(first.z, 0.0));
        float leaves = min(min(last.x, last.y), last.z);
        if (leaves > enters) way = vec2(min(way.x, enters), max(way.y, leaves));
    }
    return way;
}

// How far behind what the picture shows there a place lies; negative: before it.
float behind_in_water(vec3 place) {
    vec4 at = in_water_from_grid * vec4(place, 1.0);
    if (!(at.w > 0.0)) return -1.0e30;
    float depth = textureLod(objects_in_water_depth, 0.5 * at.xy / at.w + 0.5, 0.0).x;
    float nearness = in_water_ahead.x + in_water_ahead.y * depth;
    return nearness > 0.0 ? at.w - in_water_ahead.z / nearness : -1.0e30;
}

// The light of the sea's water with the objects in it, from `sea`; clear: the part of the pixel that isn't foam.
vec3 see_into_water(vec3 sea, vec3 place, vec3 to_eye, vec3 normal, float clear, WaterLook look) {
    float cosine = dot(normal, to_eye);
    if (!(in_water_ahead.z > 0.0) || !look.has_body || !(cosine > kLeastCosine)) return sea;
    vec3 towards = refract(-to_eye, normal, 1.0 / kWaterIndex);
    vec2 way = way_in_boxes(place, towards);
    if (!(way.y > way.x)) return sea;
    float step_m = (way.y - way.x) / float(kStepsInWater);
    float before = way.x;
    float behind = -1.0;
    for (int i = 0; i <= kStepsInWater; ++i) {
        float at = way.x + step_m * float(i);
        if (behind_in_water(place + at * towards) >= 0.0) {
            behind = at;
            break;
        }
        before = at;
    }
    if (behind < 0.0) return sea;
    for (int i = 0; i < kFinerSteps; ++i) {
        float middle = 0.5 * (before + behind);
        if (behind_in_water(place + middle * towards) >= 0.0)
            behind = middle;
        else
            before = middle;
    }
    vec4 at = in_water_from_grid * vec4(place + behind * towards, 1.0);
    vec4 seen = textureLod(objects_in_water, 0.5 * at.xy / at.w + 0.5, 0.0);
    vec3 left = let_through_water(behind, look);
    return sea * (1.0 - seen.w * left) + (clear * (1.0 - fresnel_exact(cosine, kWaterIndex)) * kBehindGlass) * left * seen.xyz;
}
