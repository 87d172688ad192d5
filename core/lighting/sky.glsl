// The reflected sky: Bruneton et al. 2010, §5.2. The includer defines:
//   const int kSkyLookups          1 (over an ellipse), 9, or 0 for the integral
//   const bool kExactFresnel
//   const bool kSecondReflection
//   const float kSkyMapSize        texels per side of the map
//   vec3 sky_lookup(vec2 u, float level)    the map, trilinear; u = r_xy/(1 + r_z), level 0 the finest

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
    float sigma_v = sqrt(max(variance_towards(v, variance), 0.0f) / max(sine2, 1.0e-12f));
    if (!kExactFresnel) return fresnel_effective_paper(v.z, sigma_v);
    return fresnel_effective_exact(v.z, sigma_v, max(variance.x + variance.y - square(sigma_v), 0.0f));
}

// Fresnel's term of one facet, the one that the effective term averages.
float facet_fresnel(float cosine) {
    if (kExactFresnel) return fresnel_exact(cosine, kWaterIndex);
    return fresnel_schlick(cosine);
}

// The slopes' Gaussian in the map, to first order: an ellipse. `along` is the variance along its long axis, a unit
// vector; `across` that across it.
struct SkyEllipse {
    vec2 axis;
    float along;
    float across;
};

// The principal axes of the covariance J S Jᵀ, J = ∂u/∂ζ.
SkyEllipse sky_ellipse(PlaceChange change, vec3 variance) {
    vec2 x = change.by_x * variance.x + change.by_y * variance.z;
    vec2 y = change.by_x * variance.z + change.by_y * variance.y;
    float xx = change.by_x.x * x.x + change.by_y.x * y.x;
    float yy = change.by_x.y * x.y + change.by_y.y * y.y;
    float xy = change.by_x.x * x.y + change.by_y.x * y.y;
    float mean = 0.5f * (xx + yy);
    float half_difference = 0.5f * (xx - yy);
    float away = sqrt(square(half_difference) + square(xy));  // of both variances from their mean
    // The axis is turned by half the angle of (half_difference, xy).
    float longer = sqrt(max(away + abs(half_difference), 1.0e-20f));
    float shorter = xy / longer;
    vec2 axis = half_difference > 0.0f ? vec2(longer, shorter) : vec2(shorter, longer);
    return SkyEllipse(normalize(axis), mean + away, mean - away);
}

// Eq. 22 over the ellipse of Eq. 27: one anisotropic lookup around the average normal's reflection. A uniform ellipse with
// semi-axes 2σ ∂u/∂ζ has the variance of the slopes' Gaussian, and the Gaussian is what is filtered with here: five
// trilinear probes along the long axis, each as wide as the short one. Texture units do it so as well, but each driver in its
// own way, and the finest level is no texture's (sky_map.glsl). These are the same in C++, from a texture and from an atlas.
//
// The step function H(r_z) of Eq. 22 is kept: the probes divide the part of the axis that is above the horizon, so that none
// of them jumps across it. The paper drops H, since texture units don't have it; at grazing angles half of the ellipse is then
// below the horizon, where no visible facet mirrors anything.
//
// Without a horizon the probes are a standard deviation apart. A probe has at least 1/32 of the variance along the axis, so
// the ellipse is 1 : 5.7 at most. More blurs the horizon; with less, the sun's aureole falls between two probes. Errors against
// the integral, also of an isotropic filter and without H: tests/bench/README.md.
vec3 sky_at_mean_normal(vec3 to_eye, SlopeFrame frame) {
    vec3 r = 2.0f * dot(to_eye, frame.normal) * frame.normal - to_eye;
    vec2 u = sky_place(r);
    SkyEllipse ellipse = sky_ellipse(place_changes(to_eye, frame), frame.variance);
    float blur = max(ellipse.across, 0.03125f * ellipse.along);
    float level = sky_level(blur);
    float spread = sqrt(max(ellipse.along - blur, 1.0e-20f));

    // The axis meets the horizon, |u| = 1, at ±chord from the middle between. The part begins at u even where u is below
    // the horizon, as seen by an eye in the water.
    float past_middle = dot(u, ellipse.axis);
    float chord = sqrt(max(square(past_middle) + 1.0f - dot(u, u), 0.0f));
    float first = clamp((-chord - past_middle) / spread, -2.5f, 0.0f);
    float last = clamp((chord - past_middle) / spread, 0.0f, 2.5f);
    float apart = (last - first) / 5.0f;
    vec3 sum = vec3(0.0f);
    float total = 0.0f;
    for (int i = 0; i < 5; ++i) {
        float x = first + apart * (float(i) + 0.5f);
        float part = exp(-0.5f * x * x);
        sum += part * sky_lookup(u + (spread * x) * ellipse.axis, level);
        total += part;
    }
    return sum / total;
}

// What a ray that a facet mirrors onto the sea meets there: the sea seen along its mean plane, in the same
// azimuth, since such rays are nearly level. Here its reflection of the sky: F̄ of that view, and one lookup where
// the facets mirror it that are seen so. Their slope towards the ray is 1.2 σ on average, weighted by Fresnel's
// term; reflections are twice as high, and spread by twice the slopes' deviation there, 0.6 σ, and, across, by
// twice σ times the cosine of incidence, 1.4 σ_v.
vec3 grazing_view(vec3 v) {
    float sine = sqrt(v.x * v.x + v.y * v.y);
    return sine > 1.0e-6f ? vec3(v.x / sine, v.y / sine, 0.0f) : vec3(1.0f, 0.0f, 0.0f);
}

vec3 sky_seen_again(vec3 v, SlopeFrame frame) {
    vec3 grazing = grazing_view(v);
    float variance = max(variance_towards(grazing, frame.variance), 0.0f);
    float slope = 1.2f * sqrt(variance);
    float upright = 1.0f / (1.0f + square(slope));
    vec3 r = grazing * (upright * (square(slope) - 1.0f)) + vec3(0.0f, 0.0f, 2.0f * slope * upright);
    float level = sky_level(3.4f * variance * sqrt(frame.variance.x + frame.variance.y - min(variance, frame.variance.x + frame.variance.y)));
    return effective_fresnel(grazing, frame.variance) * sky_lookup(sky_place(out_of_frame(frame, r)), level);
}

// What one visible facet mirrors, per its projected area and that of the plane: of the sky, and of the sea again.
struct FacetLight {
    float visible;
    vec3 sky;
    float again;
};

FacetLight facet_light(vec2 slope, float facing, float nested, vec3 v, SlopeFrame frame, MaskedView view, float level) {
    vec3 f = normalize(vec3(-slope.x, -slope.y, 1.0f));
    float cosine = max(dot(v, f), 0.0f);
    vec3 r = 2.0f * cosine * f - v;
    float reflected = facet_fresnel(cosine);
    float visible = visible_of(view, nested);
    float lit = min(lit_of(view, nested, facing, r, frame.variance), visible);
    return FacetLight(visible, reflected * lit * sky_lookup(sky_place(out_of_frame(frame, r)), level),
                      reflected * (visible - lit));
}

// The best quality in real time: nine lookups over the visible slopes. Near grazing the mean and variance of
// visible slopes differ from those of all slopes, because facets that face the eye count more. Along the line
// of sight the nine form a midpoint rule over ±3 σ (97.3 % of the variance), since Fresnel's term, the horizon and the
// sky's gradient vary there. Across it they alternate between the middle and either side. Each lookup has its own
// Fresnel weight, because near the horizon reflective facets see bright sky; the weights' sum is the effective term.
//
// Each lookup is blurred by 0.45 of the area that it stands for in the map, so that none of the sun's aureole falls
// between them, but by no more than half the smaller variance, since the map's filters are round. What the blur adds to
// the variance along and across, the lookups' own spread lacks. Both numbers gave the smallest error against the
// integral, of 0.2 … 0.9 and 0.3 … 0.9, over daylight of turbidities 2 … 6 and suns at 8 … 70°, views from 10 to 87° and
// σ of 0.05 … 0.22: 4.3 % rms towards the sun, 2.3 % elsewhere (7.2 and 4.6 % with little blur and all the spread).
vec3 sky_of_nine(vec3 to_eye, SlopeFrame frame) {
    vec3 v = into_frame(frame, to_eye);
    VisibleSlopes seen = visible_slopes(v, frame.variance);
    PlaceChange change = place_changes(to_eye, frame);
    vec2 along = change.by_x * seen.along.x + change.by_y * seen.along.y;
    vec2 across = change.by_x * seen.across.x + change.by_y * seen.across.y;
    float along2 = max(dot(along, along), 1.0e-20f);
    float across2 = max(dot(across, across), 1.0e-20f);
    float step_along = (3.0f - max(-seen.tilt, -3.0f)) / 9.0f;
    float blur = min(0.45f * step_along * sqrt(along2 * across2), 0.5f * min(along2, across2));
    float level = sky_level(blur);
    float narrowed = sqrt((1.0f - blur / along2) / 0.973f);
    float side = sqrt(1.5f * (1.0f - blur / across2));
    float first = max(-seen.tilt, -3.0f * narrowed);
    step_along = (3.0f * narrowed - first) / 9.0f;

    MaskedView view = masked_view(v, frame.variance);
    vec3 sum = vec3(0.0f);
    float again = 0.0f;
    float total = 0.0f;
    float turn = 0.0f;
    for (int i = 0; i < 9; ++i) {
        float x = first + step_along * (float(i) + 0.5f);
        float facing = view.height + sqrt(view.along) * x;
        float part = facing * exp(-0.5f * square(x / narrowed));
        FacetLight light = facet_light(seen.across * (side * turn) - seen.along * x, facing, nested_part(view, facing),
                                       v, frame, view, level);
        total += part * light.visible;
        sum += part * light.sky;
        again += part * light.again;
        turn = turn > 0.5f ? -1.0f : (turn < -0.5f ? 0.0f : 1.0f);
    }
    if (kSecondReflection) sum += again * sky_seen_again(v, frame);
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
    MaskedView view = masked_view(v, frame.variance);
    vec3 sum = vec3(0.0f);
    float again = 0.0f;
    float total = 0.0f;
    for (int i = 0; i < 32; ++i) {
        float x = first + step_along * (float(i) + 0.5f);
        float facing = view.height + sqrt(view.along) * x;
        float nested = nested_part(view, facing);
        float weight = facing * exp(-0.5f * x * x);
        for (int j = 0; j < 16; ++j) {
            float y = -4.0f + step_across * (float(j) + 0.5f);
            float part = weight * exp(-0.5f * y * y);
            FacetLight light = facet_light(seen.across * y - seen.along * x, facing, nested, v, frame, view, level);
            total += part * light.visible;
            sum += part * light.sky;
            again += part * light.again;
        }
    }
    if (kSecondReflection) sum += again * sky_seen_again(v, frame);
    return sum / total;
}

// What the sea shows of a uniform sky of radiance 1, by one and two reflections. The rest of it is the water's.
float shown_of_uniform_sky(vec3 v, vec3 variance) {
    float reflected = effective_fresnel(v, variance);
    float lost = kSecondReflection ? 1.0f - effective_fresnel(grazing_view(v), variance) : 1.0f;
    return reflected * (1.0f - reflected_again(v, variance) * lost);
}

vec3 sky_reflection(vec3 to_eye, SlopeFrame frame) {
    if (kSkyLookups == 0) return sky_integral(to_eye, frame);
    if (kSkyLookups == 9) return sky_of_nine(to_eye, frame);
    return shown_of_uniform_sky(into_frame(frame, to_eye), frame.variance) * sky_at_mean_normal(to_eye, frame);
}
