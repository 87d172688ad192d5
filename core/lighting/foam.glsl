// Whitecaps: Dupuy and Bruneton 2012, with what they leave to future work: foam is rough, hides behind waves,
// and is not one grey.

// Foam's own bumps, beyond the waves': slope variance along either axis.
const float kFoamSlopeVariance = 0.1f;

vec3 foam_variance(vec3 variance) {
    return variance + vec3(kFoamSlopeVariance, kFoamSlopeVariance, 0.0f);
}

// The share of the visible surface that is foam: of all foam and all clear facets the eye sees the projected
// areas, and waves hide both alike. At grazing angles foam, being rougher, shows more of itself. 0, 1 and
// straight down: coverage.
float visible_coverage(float coverage, vec3 to_eye, vec3 variance) {
    float w = clamp(coverage, 0.0f, 1.0f);
    float foam = w * visible_area(to_eye, foam_variance(variance));
    float clear = (1.0f - w) * visible_area(to_eye, variance);
    return foam / (foam + clear);
}

// Reflectance of what counts as covered. Dense foam is white, 0.55; averaged over its life 0.4 of that
// (Koepke 1984: 0.22, which goes with Monahan's coverage), because most of it is thin: bubbles over water
// that show the water's own colour, brightened. It doesn't rise with the coverage of a pixel, though thick
// foam is whiter: of a larger pixel the mean would then be another, and foam would darken with distance.
vec3 foam_reflectance(vec3 water_reflectance) {
    float dense = 0.4f;
    return vec3(0.55f * dense) + (1.0f - dense) * water_reflectance;
}

// Diffuse facets of Gaussian slopes: the sun on those that the eye sees (their mean slope is towards the
// eye), as far as no wave shades them; the sky on their mean tilt.
vec3 foam_radiance(vec3 to_eye, vec3 to_sun, SlopeFrame frame, vec3 sun_radiance, float sun_angular_radius,
                   vec3 sky_irradiance, vec3 reflectance) {
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
    // E max(l_z − l_xy·ζ, 0) for ζ normal with the visible slopes' mean and variance: l·f/f_z.
    float lit = (l.z - mean.x * l.x - mean.y * l.y) / spread;
    float a = min(abs(lit) * 0.70710678f, 1.0e3f);
    float tail = spread * 0.39894228f * exp(-a * a) * erfcx_remainder(a);
    float facing = max(lit, 0.0f) * spread + tail;
    float up =
        inversesqrt(1.0f + dot(mean, mean) + dot(seen.across, seen.across) + dot(seen.along, seen.along));
    float risen = smoothstep(0.0f, sun_angular_radius, to_sun.z);
    vec3 sun =
        sun_radiance * (kPi * square(sun_angular_radius) * risen * facing * up * unblocked(v, l, variance));
    return reflectance / kPi * (sun + sky_irradiance * (0.5f + 0.5f * up));
}
