// The reflected sky: Bruneton et al. 2010, §5.2. The includer defines:
//   const int kSkyLookups          1, 9, or 0 for the integral
//   const bool kExactFresnel
//   const float kSkyMapSize        texels per side of the map
//   vec3 sky_lookup(vec2 u, float level)    the map, trilinear; u = r_xy/(1 + r_z), level 0 the finest

// The light that a ray reflected downwards meets: the map's value below the horizon (§6), stored in its
// corner.
vec3 light_from_below() {
    return sky_lookup(vec2(kSkyMapReach, kSkyMapReach), 0.0f);
}

// The mip level whose trilinear lookup has this variance in u. (A lookup averages a square and interpolates
// with a tent: a variance of a quarter of a squared texel.)
float sky_level(float variance) {
    float texels = kSkyMapSize / (2.0f * kSkyMapReach);
    return max(0.5f * log2(max(4.0f * variance, 1.0e-12f) * texels * texels), 0.0f);
}

// Derivatives of u with respect to the facet's slope, at slope (0, 0).
struct PlaceChange {
    vec2 by_x;
    vec2 by_y;
};

// r = 2(v·f)f − v, df = −t dζ: dr = −2(v·t) n − 2(v·n) t; du = (dr_xy − u dr_z)/(1 + r_z).
vec2 place_change(vec3 to_eye, vec3 normal, vec3 tangent, vec2 u, float height) {
    vec3 turn = -2.0f * (dot(to_eye, tangent) * normal + dot(to_eye, normal) * tangent);
    return (vec2(turn.x, turn.y) - u * turn.z) / max(1.0f + height, 1.0e-4f);
}

PlaceChange place_changes(vec3 to_eye, SlopeFrame frame) {
    vec3 r = 2.0f * dot(to_eye, frame.normal) * frame.normal - to_eye;
    vec2 u = sky_place(r);
    return PlaceChange(place_change(to_eye, frame.normal, frame.x, u, r.z),
                       place_change(to_eye, frame.normal, frame.y, u, r.z));
}

// The effective Fresnel term for a given slope variance; v in the frame.
float effective_fresnel(vec3 v, vec3 variance) {
    float sine2 = v.x * v.x + v.y * v.y;
    float sigma_v = sqrt(variance_towards(v, variance) / max(sine2, 1.0e-12f));
    if (!kExactFresnel) return fresnel_effective_paper(v.z, sigma_v);
    VisibleSlopes seen = visible_slopes(v, variance);
    return fresnel_effective_exact(v.z, sigma_v, dot(seen.along, seen.along), dot(seen.across, seen.across));
}

// Fresnel's term of one facet, the one that the effective term averages.
float facet_fresnel(float cosine) {
    if (kExactFresnel) return fresnel_exact(cosine, kWaterIndex);
    return fresnel_schlick(cosine);
}

// Eq. 27: one lookup at the average normal's reflection. Trilinear filters are isotropic, so the filter has
// the ellipse's area.
vec3 sky_at_mean_normal(vec3 to_eye, SlopeFrame frame) {
    vec3 r = 2.0f * dot(to_eye, frame.normal) * frame.normal - to_eye;
    PlaceChange change = place_changes(to_eye, frame);
    float area = abs(change.by_x.x * change.by_y.y - change.by_x.y * change.by_y.x);
    return sky_lookup(sky_place(r), sky_level(area * sqrt(determinant_of(frame.variance))));
}

// The reflection of one facet: the sky where no wave blocks it, otherwise the light from below.
vec3 facet_reflection(vec2 slope, vec3 v, SlopeFrame frame, float level, vec3 below) {
    vec3 f = normalize(vec3(-slope.x, -slope.y, 1.0f));
    vec3 r = 2.0f * dot(v, f) * f - v;
    float open = unblocked(v, r, frame.variance);
    return mix(below, sky_lookup(sky_place(out_of_frame(frame, r)), level), open);
}

float facet_cosine(vec2 slope, vec3 v) {
    vec3 f = normalize(vec3(-slope.x, -slope.y, 1.0f));
    return max(dot(v, f), 0.0f);
}

// The best quality in real time: nine lookups over the visible slopes. Near grazing the mean and variance of
// visible slopes differ from those of all slopes, because facets that face the eye count more. Along the line
// of sight the nine form a midpoint rule, since Fresnel's term, the horizon and the sky's gradient vary
// there. Across it they alternate between 0 and ±√1.5 σ, which has the right variance. Each lookup has its
// own Fresnel weight, because near the horizon reflective facets see bright sky; the weights' sum is the
// effective term.
vec3 sky_of_nine(vec3 to_eye, SlopeFrame frame) {
    vec3 v = into_frame(frame, to_eye);
    VisibleSlopes seen = visible_slopes(v, frame.variance);
    float first = max(-seen.tilt, -3.0f);
    float step_along = (3.0f - first) / 9.0f;

    // Each lookup's blur reaches about halfway to the next: measured to be best for smooth and cloudy skies.
    PlaceChange change = place_changes(to_eye, frame);
    vec2 along = change.by_x * seen.along.x + change.by_y * seen.along.y;
    vec2 across = change.by_x * seen.across.x + change.by_y * seen.across.y;
    float level = sky_level(0.2f * min(dot(along, along) * square(step_along), dot(across, across)));

    vec3 below = light_from_below();
    vec3 sum = vec3(0.0f);
    float total = 0.0f;
    float turn = 0.0f;
    for (int i = 0; i < 9; ++i) {
        float x = first + step_along * (float(i) + 0.5f);
        vec2 slope = seen.across * turn - seen.along * x;
        float part = (seen.tilt + x) * exp(-0.5f * x * x);
        total += part;
        sum += part * facet_fresnel(facet_cosine(slope, v)) * facet_reflection(slope, v, frame, level, below);
        turn = turn > 0.5f ? -1.2247449f : (turn < -0.5f ? 0.0f : 1.2247449f);
    }
    return sum / total;
}

// Eq. 20 in full: every facet with its visibility and Fresnel term. A midpoint rule over the visible slopes,
// ±4 σ across, and along from the steepest visible facet to 4.5 σ. Dividing by the weights' sum normalises as
// Eq. 11.
vec3 sky_integral(vec3 to_eye, SlopeFrame frame) {
    vec3 v = into_frame(frame, to_eye);
    VisibleSlopes seen = visible_slopes(v, frame.variance);
    float k = min(seen.tilt, 1.0e3f);
    float first = max(-k, -4.5f);
    float step_along = (4.5f - first) / 32.0f;
    float step_across = 8.0f / 16.0f;
    PlaceChange change = place_changes(to_eye, frame);
    vec2 along = change.by_x * seen.along.x + change.by_y * seen.along.y;
    vec2 across = change.by_x * seen.across.x + change.by_y * seen.across.y;
    float level = sky_level(
        min(dot(along, along) * square(step_along), dot(across, across) * square(step_across)) / 12.0f);
    vec3 below = light_from_below();
    vec3 sum = vec3(0.0f);
    float total = 0.0f;
    for (int i = 0; i < 32; ++i) {
        float x = first + step_along * (float(i) + 0.5f);
        float weight = (k + x) * exp(-0.5f * x * x);
        for (int j = 0; j < 16; ++j) {
            float y = -4.0f + step_across * (float(j) + 0.5f);
            vec2 slope = seen.across * y - seen.along * x;
            float part = weight * exp(-0.5f * y * y);
            total += part;
            sum += part * fresnel_exact(facet_cosine(slope, v), kWaterIndex) *
                   facet_reflection(slope, v, frame, level, below);
        }
    }
    return sum / total;
}

vec3 sky_reflection(vec3 to_eye, SlopeFrame frame) {
    if (kSkyLookups == 0) return sky_integral(to_eye, frame);
    if (kSkyLookups == 9) return sky_of_nine(to_eye, frame);
    return effective_fresnel(into_frame(frame, to_eye), frame.variance) * sky_at_mean_normal(to_eye, frame);
}
