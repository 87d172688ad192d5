// The reflected sun: Bruneton et al. 2010, §5.1, with the disc's angular width in place of the paper's lower
// bound on the variance.

// The slope variance that the disc's width adds. A uniform disc of radius ρ has the standard deviation ρ/2
// along any axis. The half vector h follows the light at half its rate in the plane of incidence, and at 1/|v
// + l| across it. So h spreads by (ρ/2)/2 in the plane and by (ρ/2)/2/(v·h) across. A small change dh changes
// the slope ζ = −h_xy/h_z by −(dh_xy + ζ dh_z)/h_z.
vec3 disc_slope_variance(vec3 to_eye, vec3 to_sun, vec3 halfway, float angular_radius) {
    vec3 difference = to_sun - to_eye;
    float apart = length(difference);
    // If v and l coincide, any axis is in the plane: v·h is 1.
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

// The density of slopes that mirror part of the disc: a Gaussian convolved with a uniform disc. `share` is
// √(det of the disc's covariance / det of the sum's), `distance` is ζᵀ(sum)⁻¹ζ. One family contains both
// limits,
//     1/(1 + exp(distance/δ)/(e^y − 1)) / (π δ y √det):
// y → 0, δ → 2 is the Gaussian; y → ∞, δ → 4/y is the disc with its rim at distance 4. y(share) and δ(y) keep
// three things: the integral, exactly 1; the variance, that of the sum; and the value at the centre, that of
// an isotropic convolution, (1 − exp(−2 share/(1 − share)))/(4π share √det). y is a fit to the solution of
// that condition, and 1/(1 + y/4 + 0.0347 y²) in δ is a fit of Debye's function. Where share reaches its
// limit the rim is still a thirtieth of the radius wide, so that a mirrored sun isn't jagged.
float disc_density(float distance, float share, float root_of_determinant) {
    float e = min(share, 0.999f);
    float c = 1.3333333f + e * (0.7485f + e * (-0.4462f + e * (2.7252f + e * (-1.0427f - 1.5111f * e))));
    float y = e * e * c * inversesqrt(1.0f - e);
    float width = 2.0f / (0.5f * y + 1.0f / (1.0f + y * (0.25f + 0.0347f * y)));
    float mean = y < 0.01f ? 1.0f - 0.5f * y : (1.0f - exp(-y)) / y;
    return mean / (kPi * width * (mean * y + exp(min(distance / width - y, 80.0f))) * root_of_determinant);
}

// Eq. 15 (its h_z⁴ is right: Eq. 12 with h_z³). At most L F: no facet is brighter than the sun itself. 0 for
// a sun at or below the horizon, rising to its full value while the disc rises.
vec3 sun_reflection(vec3 to_eye, vec3 to_sun, SlopeFrame frame, vec3 sun_radiance, float angular_radius) {
    vec3 v = into_frame(frame, to_eye);
    vec3 l = into_frame(frame, to_sun);
    vec3 h = v + l;
    float size = length(h);
    if (size < 1.0e-4f || h.z <= 1.0e-5f * size)
        return vec3(0.0f);  // no visible facet mirrors the sun
    h = h / size;
    vec3 disc = disc_slope_variance(v, l, h, angular_radius);
    vec3 sum = frame.variance + disc;
    // √det of the disc's covariance: from its two axes, times 1/h_z³, the slopes' area per solid angle. The
    // sum's determinant is built from non-negative parts. At grazing angles the disc's ellipse is so long
    // that the product of its variances and its squared covariance differ by less than their rounding.
    float cosine = max(dot(v, h), 1.0e-3f);
    float disc_root = square(0.25f * angular_radius) / (cosine * h.z * h.z * h.z);
    float mixed = frame.variance.x * disc.y + frame.variance.y * disc.x - 2.0f * frame.variance.z * disc.z;
    float determinant = determinant_of(frame.variance) + square(disc_root) + max(mixed, 0.0f);
    float root = sqrt(determinant);
    float density =
        disc_density(slope_distance(vec2(h.x, h.y) / -h.z, sum, determinant), disc_root / root, root);
    // The disc's spread blurs the horizon of the frame, too.
    float facing = cosine / h.z;
    float lit = lit_part(masked_view(v, sum), facing, facing, l, sum);
    float part = kPi * square(angular_radius) * density * lit / (4.0f * square(square(h.z)));
    float risen = smoothstep(0.0f, angular_radius, to_sun.z);
    return sun_radiance * (min(part, 1.0f) * risen * fresnel_exact(dot(v, h), kWaterIndex));
}
