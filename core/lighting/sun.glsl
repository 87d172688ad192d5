// The reflected sun: Bruneton et al. 2010, §5.1, with the disc's angular width in place of the paper's lower
// bound on the variance.

// Standard deviations [rad], across and upwards, of the disc's visible part, given the height (sine of elevation) of
// that part's centre. Of the whole disc both are ρ/2. What a set disc shows is lower than wide: of half of it the
// centre is 0.42 ρ high and the deviation 0.26 ρ; of a thin segment 0.65 of the centre's height, and √(ρ height)
// across. 5 % of each.
vec2 disc_spread(float height, float angular_radius) {
    float h = max(height, 1.0e-4f * angular_radius);
    return min(vec2(sqrt(angular_radius * h), 0.625f * h), vec2(0.5f * angular_radius));
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

// The half vector's horizontal part, and how it varies.
struct HalfVector {
    vec3 covariance;  // (xx, yy, xy)
    float root;       // of its determinant
    float disc_root;  // of the determinant of the disc's part in it
    vec2 by_side;     // its change over a deviation of the disc, across and upwards
    vec2 by_rise;
};

// of_side, of_rise: the disc's axes in the frame, as long as its deviations; slope: of the facets that matter.
//
// A facet of slope s mirrors the disc's point l + δ to the eye if (h + δ)_xy + s (h + δ)_z = 0, with h = v + l as it
// is, not of unit length. So h_xy is the sum of −s h_z, of −(δ_xy + s δ_z), and of −(s − slope) δ_z.
// Divided by h_z these would be slopes (Eq. 15), and at the horizon, where h_z is no larger than δ_z, infinite.
//
// The determinant is built from non-negative parts. At grazing angles the disc's ellipse is so long that the product
// of its variances and its squared covariance differ by less than their rounding.
HalfVector half_vector(vec3 h, vec3 variance, vec3 of_side, vec3 of_rise, vec2 slope) {
    vec2 a = vec2(of_side.x, of_side.y) + slope * of_side.z;
    vec2 b = vec2(of_rise.x, of_rise.y) + slope * of_rise.z;
    vec3 disc = vec3(a.x * a.x + b.x * b.x, a.y * a.y + b.y * b.y, a.x * a.y + b.x * b.y);
    vec3 waves = variance * (square(h.z) + square(of_side.z) + square(of_rise.z));
    float disc_root = abs(a.x * b.y - a.y * b.x);
    float mixed = waves.x * disc.y + waves.y * disc.x - 2.0f * waves.z * disc.z;
    return HalfVector(waves + disc, sqrt(determinant_of(waves) + square(disc_root) + max(mixed, 0.0f)), disc_root, a,
                      b);
}

// C⁻¹ h_xy: what the regression of anything on the half vector's horizontal part needs.
vec2 pull_of(vec3 h, HalfVector of) {
    vec3 c = of.covariance;
    return vec2(c.y * h.x - c.z * h.y, c.x * h.y - c.z * h.x) / square(of.root);
}

// The facets that send some of the sun's disc to the eye: the density of such slopes, and the point of the disc that they send in the mean. h: along
// the normal of those that send its middle; l: to the sun, or with its light; of_side, of_rise: a deviation of the disc across and upwards.
struct SunFacets {
    float density;
    vec3 point;
};

SunFacets sun_facets(vec3 h, vec3 l, SlopeFrame frame, vec3 of_side, vec3 of_rise) {
    // Their mean slope, first as if that were about 0.
    vec2 pull = pull_of(h, half_vector(h, frame.variance, of_side, of_rise, vec2(0.0f)));
    vec2 slope = -h.z * vec2(frame.variance.x * pull.x + frame.variance.z * pull.y,
                             frame.variance.z * pull.x + frame.variance.y * pull.y);
    // No farther than 5 deviations of the waves: there is nothing to be seen, and the disc in such slopes is wide.
    slope *= min(1.0f, 5.0f * inversesqrt(max(-h.z * dot(slope, pull), 1.0e-12f)));
    HalfVector half_way = half_vector(h, frame.variance, of_side, of_rise, slope);
    float distance = slope_distance(vec2(h.x, h.y), half_way.covariance, square(half_way.root));
    float density = disc_density(distance, half_way.disc_root / half_way.root, half_way.root);
    // The disc's rim is two deviations away.
    pull = pull_of(h, half_way);
    return SunFacets(density, l - clamp(dot(half_way.by_side, pull), -2.0f, 2.0f) * of_side -
                                  clamp(dot(half_way.by_rise, pull), -2.0f, 2.0f) * of_rise);
}

// Eq. 15, with the disc in place of a point: π ρ² L F w² N(h_xy), w = v·f/f_z and N the density of the half vector's
// horizontal part; without the disc's part in N that is Eq. 15, whose h_z⁴ is right (Eq. 12 with h_z³).
//
// sun_radiance is the mean over the whole disc, to_sun the centre of what is visible of it (core/lighting/sky.h). At
// most the visible part's own radiance times F: no facet is brighter than the sun itself. 0 for a sun at or below
// the horizon.
//
// v: to the eye, in the frame.
vec3 sun_seen_from(vec3 v, vec3 to_sun, SlopeFrame frame, vec3 sun_radiance, float angular_radius) {
    vec3 l = into_frame(frame, to_sun);
    vec3 h = v + l;
    if (to_sun.z <= 0.0f || h.z <= 1.0e-5f) return vec3(0.0f);  // no visible facet mirrors the sun
    vec2 spread = disc_spread(to_sun.z, angular_radius);
    float across = length(vec2(to_sun.x, to_sun.y));
    vec3 side = across > 1.0e-3f ? vec3(-to_sun.y, to_sun.x, 0.0f) / across : vec3(1.0f, 0.0f, 0.0f);
    vec3 of_side = spread.x * into_frame(frame, side);
    vec3 of_rise = spread.y * into_frame(frame, normalize(cross(to_sun, side)));

    SunFacets seen = sun_facets(h, l, frame, of_side, of_rise);
    vec3 mirroring = v + normalize(seen.point);
    float size = length(mirroring);
    float facing = 0.5f * square(size) / max(mirroring.z, 0.1f * h.z);  // w
    float cosine = dot(v, mirroring) / max(size, 1.0e-6f);
    // The disc's height blurs the horizon of the frame, too.
    vec3 blurred = frame.variance + vec3(square(spread.y), square(spread.y), 0.0f);
    float lit = lit_part(masked_view(v, frame.variance), facing, facing, l, blurred);
    float part = kPi * square(angular_radius) * square(facing) * seen.density * lit;
    float most = square(0.5f * angular_radius) / (spread.x * spread.y);  // the whole disc's share of what is visible
    return sun_radiance * (min(part, most) * fresnel_exact(cosine, kWaterIndex));
}

vec3 sun_reflection(vec3 to_eye, vec3 to_sun, SlopeFrame frame, vec3 sun_radiance, float angular_radius) {
    return sun_seen_from(into_frame(frame, to_eye), to_sun, frame, sun_radiance, angular_radius);
}

// Eq. 15 as printed: the sun a point, Schlick's Fresnel term, Smith's masking. Pictures have sun_reflection(); this one is to
// compare with (tests/core/lighting/sun_test.cpp). v, l: to the eye and the sun, in the frame; a flat sea has no glint here.
vec3 sun_reflection_paper(vec3 v, vec3 l, vec3 variance, vec3 sun_radiance, float angular_radius) {
    if (v.z <= 0.0f || l.z <= 0.0f) return vec3(0.0f);
    vec3 h = normalize(v + l);
    float density = slope_density(vec2(h.x, h.y) / -h.z, variance);
    float masking = 1.0f + smith_lambda(smith_argument(v, variance)) + smith_lambda(smith_argument(l, variance));
    float solid_angle = kPi * square(angular_radius);
    return sun_radiance * (solid_angle * density * fresnel_schlick(dot(v, h)) / (4.0f * square(square(h.z)) * v.z * masking));
}

// The same for the second reflection, which adds a twentieth: the disc is a Gaussian in the slopes.
vec3 sun_seen_again(vec3 v, vec3 to_sun, SlopeFrame frame, vec3 sun_radiance, float angular_radius) {
    vec3 l = into_frame(frame, to_sun);
    vec3 h = v + l;
    if (to_sun.z <= 0.0f || h.z <= 1.0e-2f) return vec3(0.0f);
    float blur = square(0.25f * angular_radius / h.z);
    vec3 variance = frame.variance + vec3(blur, blur, 0.0f);
    float facing = 0.5f * dot(h, h) / h.z;
    float density = slope_density(vec2(h.x, h.y) / -h.z, variance) * square(facing / h.z);
    float part = kPi * square(angular_radius) * density * lit_part(masked_view(v, variance), facing, facing, l, variance);
    return sun_radiance * (min(part, 1.0f) * fresnel_exact(0.5f * length(h), kWaterIndex));
}
