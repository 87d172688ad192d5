// Whitecaps: Dupuy and Bruneton 2012, extended by what they leave to future work: foam is rough, is hidden by
// waves, and has more than one shade.

// Slope variance of the foam's own roughness, along either axis, added to that of the waves.
const float kFoamSlopeVariance = 0.1f;

vec3 foam_variance(vec3 variance) {
    return variance + vec3(kFoamSlopeVariance, kFoamSlopeVariance, 0.0f);
}

// Dense foam reflects 0.55 (Whitlock, Bartlett and Gurganus 1982). Averaged over its lifetime foam has 0.4 of that (0.22, Koepke 1984,
// ± 0.11, consistent with Monahan's coverage), since most of it is thin: bubbles so far apart that between them the water mirrors
// and shines as it does without. So foam is opaque in that part of its area, its opacity, and the rest is water. Opacity must not
// depend on a pixel's coverage: means over larger pixels would differ, and foam would darken with distance (foam_structure.glsl
// says what it is).
const float kWhiteFoam = 0.55f;
const float kFoamOpacity = 0.4f;

// Light that is sent to and fro between bubbles goes through their water, which takes the red: what foam loses grows as the root of the
// water's absorption (Kokhanovsky 2004), and at 850 nm it is 0.4 (Frouin, Schwindling and Deschamps 1996). So at 610 nm foam
// reflects 0.94 of what it does in green and blue. Without it foam in the sun, whose light with the sky's is pinker than a radiator's of
// the same warmth, was lavender.
const vec3 kFoamColour = vec3(0.94f, 1.0f, 1.0f);

// Diffuse facets with Gaussian slopes. Sunlight falls on the facets that the eye sees (their mean slope leans
// towards the eye) as far as no wave shades them; skylight falls on their mean tilt. slope: of the foam's own relief, where a pixel
// resolves it, rising towards the sun. reflectance: in green and blue.
vec3 foam_radiance(vec3 to_eye, vec3 to_sun, SlopeFrame frame, vec3 sun_radiance, float sun_angular_radius,
                   vec3 sky_irradiance, float reflectance, float slope) {
    vec3 variance = foam_variance(frame.variance);
    vec3 v = into_frame(frame, to_eye);
    vec3 l = into_frame(frame, to_sun);
    VisibleSlopes seen = visible_slopes(v, variance);
    vec2 mean = mean_visible_slope(seen);
    float across_sun = seen.across.x * l.x + seen.across.y * l.y;
    float along_sun = seen.along.x * l.x + seen.along.y * l.y;
    float spread =
        sqrt(square(across_sun) + square(along_sun) * max(1.0f + seen.x.second - square(seen.x.first), 0.0f) +
             1.0e-12f);
    // The mean of l·f/f_z: E max(l_z − l_xy·ζ, 0) for normal ζ with the mean and variance of the visible
    // slopes.
    float lit = (l.z - mean.x * l.x - mean.y * l.y - slope * sqrt(l.x * l.x + l.y * l.y)) / spread;
    float a = min(abs(lit) * 0.70710678f, 1.0e3f);
    float tail = spread * 0.39894228f * exp(-a * a) * erfcx_remainder(a);
    float facing = max(lit, 0.0f) * spread + tail;
    float up =
        inversesqrt(1.0f + dot(mean, mean) + dot(seen.across, seen.across) + dot(seen.along, seen.along));
    MaskedView view = masked_view(v, variance);
    float towards = v.z - mean.x * v.x - mean.y * v.y;
    float nested = nested_part(view, towards);
    float open = lit_of(view, nested, facing, l, variance) / visible_of(view, nested);
    vec3 sun = sun_radiance * (kPi * square(sun_angular_radius) * facing * up * open);
    return reflectance / kPi * kFoamColour * (sun + sky_irradiance * (0.5f + 0.5f * up));
}
