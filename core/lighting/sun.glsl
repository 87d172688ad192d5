// The reflected sun: Bruneton et al. 2010, §5.1, with the disc's own width in place of their smallest
// variance.

// What the disc's width does to slopes: the half vector h spreads by (ρ/2)/2 in the plane of incidence and by
// (ρ/2)/2/(v·h) across it (ρ/2 is a uniform disc's standard deviation along any axis, and h turns half as
// fast as the light in the plane, dl/|v + l| across it). A small turn dh moves the slope ζ = −h_xy/h_z by
// −(dh_xy + ζ dh_z)/h_z.
vec3 disc_slope_variance(vec3 to_eye, vec3 to_sun, vec3 halfway, float angular_radius) {
    vec3 difference = to_sun - to_eye;
    float apart = length(difference);
    // Seen along the light itself any axis is in the plane: v·h is 1.
    vec3 other = abs(halfway.x) < 0.5f ? vec3(1.0f, 0.0f, 0.0f) : vec3(0.0f, 1.0f, 0.0f);
    vec3 inside = apart > 1.0e-3f ? difference / apart : normalize(cross(other, halfway));
    vec3 beside = cross(halfway, inside);
    float cosine = max(dot(to_eye, halfway), 1.0e-3f);
    vec2 slope = vec2(halfway.x, halfway.y) / -halfway.z;
    vec2 p = (vec2(inside.x, inside.y) + slope * inside.z) / halfway.z;
    vec2 q = (vec2(beside.x, beside.y) + slope * beside.z) / (halfway.z * cosine);
    return vec3(p.x * p.x + q.x * q.x, p.y * p.y + q.y * q.y, p.x * p.y + q.x * q.y) *
           square(0.25f * angular_radius);
}

// Density of the slopes that show some of the disc: a Gaussian blurred by a uniform disc. `share` is
// √(det of the disc's tensor / det of the sum's), `distance` ζᵀ(sum)⁻¹ζ. One family holds both ends,
//     1/(1 + exp(distance/δ)/(e^y − 1)) / (π δ y √det):
// y → 0, δ → 2 is the Gaussian, y → ∞, δ → 4/y the disc with its rim at distance 4. y(share) and δ(y) keep
// the integral 1 exactly, the variance that of the sum, and the centre that of a disc blurred isotropically,
// which is (1 − exp(−2 share/(1 − share)))/(4π share √det); y is a fit of that condition's solution, and 1/(1
// + y/4 + 0.0347 y²) in δ one of Debye's function. At the share's end the rim is a thirtieth of the radius
// wide: no jagged sun in a mirror.
float disc_density(float distance, float share, float root_of_determinant) {
    float e = min(share, 0.999f);
    float c = 1.3333333f + e * (0.7485f + e * (-0.4462f + e * (2.7252f + e * (-1.0427f - 1.5111f * e))));
    float y = e * e * c * inversesqrt(1.0f - e);
    float width = 2.0f / (0.5f * y + 1.0f / (1.0f + y * (0.25f + 0.0347f * y)));
    float mean = y < 0.01f ? 1.0f - 0.5f * y : (1.0f - exp(-y)) / y;
    return mean / (kPi * width * (mean * y + exp(min(distance / width - y, 80.0f))) * root_of_determinant);
}

// Eq. 15 (its h_z⁴ is right: Eq. 12 with h_z³). Never more than L F: no facet shows more than the sun itself.
// 0 for a sun at or below the horizon, growing to its full value while the disc rises.
vec3 sun_reflection(vec3 to_eye, vec3 to_sun, SlopeFrame frame, vec3 sun_radiance, float angular_radius) {
    vec3 v = into_frame(frame, to_eye);
    vec3 l = into_frame(frame, to_sun);
    vec3 h = v + l;
    float size = length(h);
    if (size < 1.0e-4f || h.z <= 1.0e-5f * size)
        return vec3(0.0f);  // no facet that is seen sends the sun here
    h = h / size;
    vec3 disc = disc_slope_variance(v, l, h, angular_radius);
    vec3 sum = frame.variance + disc;
    // √det of the disc's own: that of the two axes, times the slopes' area per solid angle, 1/h_z³. The sum's
    // determinant is put together from parts that are not negative: seen at grazing angles the disc is so
    // long an ellipse that its product of variances and the square of their correlation differ by less than
    // their rounding.
    float cosine = max(dot(v, h), 1.0e-3f);
    float disc_root = square(0.25f * angular_radius) / (cosine * h.z * h.z * h.z);
    float mixed = frame.variance.x * disc.y + frame.variance.y * disc.x - 2.0f * frame.variance.z * disc.z;
    float determinant = determinant_of(frame.variance) + square(disc_root) + max(mixed, 0.0f);
    float root = sqrt(determinant);
    float density =
        disc_density(slope_distance(vec2(h.x, h.y) / -h.z, sum, determinant), disc_root / root, root);
    // The disc's spread blurs the frame's horizon as well.
    float seen = visible_area(v, sum) + max(v.z, 0.0f) * smith_lambda(smith_argument(l, sum));
    float part = kPi * square(angular_radius) * density / (4.0f * square(square(h.z)) * max(seen, 1.0e-6f));
    float risen = smoothstep(0.0f, angular_radius, to_sun.z);
    return sun_radiance * (min(part, 1.0f) * risen * fresnel_exact(dot(v, h), kWaterIndex));
}
