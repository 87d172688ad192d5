// The share of the sun's disc that no object hides from a place, by a map of the objects' depth towards the sun. The shadow's edge is as
// wide as the disc makes it behind what hides it there: the mean of what does (Fernando 2005).
// shadow_compare.glsl has the map.
uniform mat4 shadow_from_grid;   // to 0 … 1
uniform vec4 shadow_reach;       // across, upwards, and into depth [m]; the tangent of the disc's radius
uniform float shadow_off;        // of depth

const int kShadowProbes = 16;

// Evenly over a unit disc (Vogel 1979).
vec2 shadow_probe(int i) {
    float turn = 2.3999632 * float(i);
    return sqrt((float(i) + 0.5) / float(kShadowProbes)) * vec2(cos(turn), sin(turn));
}

float sun_share(vec3 place) {
    vec3 at = (shadow_from_grid * vec4(place, 1.0)).xyz;
    vec2 unit = 1.0 / shadow_reach.xy;
    float behind_m = at.z * shadow_reach.z;
    vec2 farthest = shadow_reach.w * max(behind_m, 0.0) * unit;
    if (!(at.z > 0.0) || any(lessThan(at.xy, -farthest)) || any(greaterThan(at.xy, 1.0 + farthest))) return 1.0;
    vec2 texel = 1.0 / vec2(textureSize(sun_blockers, 0));
    float depth = min(at.z - shadow_off, 0.99999);
    float sum = 0.0;
    float hidden = 0.0;
    for (int i = 0; i < kShadowProbes; ++i) {
        float there = textureLod(sun_blockers, at.xy + shadow_probe(i) * max(farthest, texel), 0.0).x;
        if (there < depth) {
            sum += there;
            hidden += 1.0;
        }
    }
    if (hidden == 0.0) return 1.0;
    vec2 edge = max(shadow_reach.w * (behind_m - sum / hidden * shadow_reach.z) * unit, texel);
    float seen = 0.0;
    for (int i = 0; i < kShadowProbes; ++i)
        seen += shadow_seen(vec3(at.xy + shadow_probe(i) * edge, depth));
    return seen / float(kShadowProbes);
}
