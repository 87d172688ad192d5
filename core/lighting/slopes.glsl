// The distribution of facets' slopes, and their visibility: Ross, Dion, Potvin 2005 as in Bruneton et al.
// 2010, §4.
//
// Slopes are Gaussian in the tangent frame of the average normal (§5.1). That frame is the world's, rotated
// by the shortest way from the vertical to the normal. The full 2 × 2 tensor is transformed into it, so that
// no axis has to follow the wind. Directions below are in that frame, z along the normal.

struct SlopeFrame {
    vec3 x;
    vec3 y;
    vec3 normal;
    vec3 variance;  // (σxx, σyy, σxy) in the frame
};

// Bends a normal so that the eye can see it. A visible surface doesn't face away from the eye (§3.2). Seen
// from above it doesn't mirror the eye's ray downwards either: that ray would meet the next wave at a grazing
// angle and be reflected up. Both happen where a pixel's normal is finer than the crest beneath it, or where
// the crest has folded over. The first step is the paper's, n − 2(n·v)v. Alone it leaves a dark line along
// crests, so a second step bends the normal just far enough for the mirrored ray to reach the horizon.
//
// n + cv mirrors v to the horizon if v_z c² + 2 n_z c + 2 n_z (n·v) − v_z = 0. With n·v ≥ 0 exactly one root
// is positive if n mirrors v downwards; it is written without cancellation for either sign of n_z. n + cv
// then points up: its z is the square root of the discriminant. The bounds of 1e-6 keep c finite.
vec3 facing_normal(vec3 normal, vec3 to_eye) {
    vec3 seen = normal - 2.0f * min(dot(normal, to_eye), 0.0f) * to_eye;
    float below = to_eye.z - 2.0f * dot(seen, to_eye) * seen.z;  // minus the mirrored ray's height
    float bend = 0.0f;
    if (below > 0.0f && to_eye.z > 0.0f) {
        float root = sqrt(square(seen.z) + to_eye.z * below);
        bend = seen.z < 0.0f ? (root - seen.z) / max(to_eye.z, 1.0e-6f) : below / max(seen.z + root, 1.0e-6f);
    }
    return normalize(seen + bend * to_eye);
}

// The normal of a pixel that resolves finer waves than the mesh. The eye sees those of the mesh's waves that lean to
// it more often: they take more of the picture. Waves that only the normals have take equal parts of the mesh, also
// on the back that a crest would hide, and the sea seems to lean away: skies mirrored at grazing angles were 5 to 15
// % too bright. So normals lean to the eye as visible ones do. With w = (v·n)/(n_z |v_xy|), 0 for a surface seen
// edge-on, and the variance s of these slopes along the view, slopes that never face away (a Bessel-3 process) have
// the mean square w0² + 3 s, where all of them have w0² + s; and so has √(w² + 2 s), which is w′ here. Seen from
// above it is the mean of slopes weighted by the area that they show, w0 + s/w0.
//
// mesh_variance: of the slopes that the mesh leaves unresolved, along the view's horizontal direction; variance: of
// those that the pixel leaves unresolved, (σxx, σyy, σxy); both at rest. Where the pixel resolves no more than the
// mesh, the normal stays.
// The includer defines const bool kMeshMasking: without it normals stay.
vec3 visible_normal(vec3 normal, vec3 to_eye, vec3 variance, float mesh_variance) {
    if (!kMeshMasking) return normal;
    float across2 = max(to_eye.x * to_eye.x + to_eye.y * to_eye.y, 1.0e-12f);
    float hidden = (variance.x * to_eye.x * to_eye.x + variance.y * to_eye.y * to_eye.y +
                    2.0f * variance.z * to_eye.x * to_eye.y) / across2;
    float between = 2.0f * (mesh_variance - hidden);
    if (!(between > 0.0f) || !(normal.z > 0.0f)) return normal;
    float height = max(normal.z, 1.0e-6f);
    float facing = dot(normal, to_eye) / height;  // w |v_xy|
    float root = sqrt(facing * facing + between * across2);
    // (w′ − w)/|v_xy|, without cancellation.
    float lean = facing > 0.0f ? between / (root + facing) : (root - facing) / across2;
    return normalize(vec3(normal.x + height * lean * to_eye.x, normal.y + height * lean * to_eye.y, normal.z));
}

// Transforms the covariance of world slopes into the plane of slope s. To first order a slope deviation δ
// becomes δ/(1 + s²) along s and δ/√(1 + s²) across it, that is n_z (1 − n_xy n_xyᵀ/(1 + n_z)) δ. Variances
// are at least (1e-5)², with σ a hundredth of the sun disc's own spread, and the correlation at most 1 −
// 1e-4: the density needs a determinant.
SlopeFrame slope_frame(vec3 normal, vec3 slope_variance) {
    float up = normal.z < 0.0f ? -1.0f : 1.0f;
    float height = abs(normal.z);
    float q = 1.0f / (1.0f + height);
    float xx = 1.0f - normal.x * normal.x * q;
    float xy = -normal.x * normal.y * q;
    float yy = 1.0f - normal.y * normal.y * q;
    vec3 s = slope_variance * (height * height);
    float vx = s.x * xx * xx + s.y * xy * xy + 2.0f * s.z * xx * xy;
    float vy = s.x * xy * xy + s.y * yy * yy + 2.0f * s.z * xy * yy;
    float vxy = s.x * xx * xy + s.y * xy * yy + s.z * (xx * yy + xy * xy);
    vx = max(vx, 1.0e-10f);
    vy = max(vy, 1.0e-10f);
    float most = 0.9999f * sqrt(vx * vy);
    return SlopeFrame(vec3(xx, xy, -up * normal.x), vec3(xy, yy, -up * normal.y), normal,
                      vec3(vx, vy, clamp(vxy, -most, most)));
}

vec3 into_frame(SlopeFrame frame, vec3 direction) {
    return vec3(dot(frame.x, direction), dot(frame.y, direction), dot(frame.normal, direction));
}

vec3 out_of_frame(SlopeFrame frame, vec3 direction) {
    return frame.x * direction.x + frame.y * direction.y + frame.normal * direction.z;
}

float determinant_of(vec3 variance) {
    return variance.x * variance.y - variance.z * variance.z;
}

// ζᵀ S⁻¹ ζ. The density p(ζ) of Eq. 7, for arbitrary axes, is exp(−½ ζᵀ S⁻¹ ζ)/(2π √det S).
float slope_distance(vec2 slope, vec3 variance, float determinant) {
    float sum = variance.y * slope.x * slope.x - 2.0f * variance.z * slope.x * slope.y +
                variance.x * slope.y * slope.y;
    return max(sum, 0.0f) / determinant;
}

float slope_density(vec2 slope, vec3 variance) {
    float determinant = determinant_of(variance);
    return exp(-0.5f * slope_distance(slope, variance, determinant)) / (2.0f * kPi * sqrt(determinant));
}

// Slope variance along a direction, times the direction's sin²θ.
float variance_towards(vec3 direction, vec3 variance) {
    return variance.x * direction.x * direction.x + variance.y * direction.y * direction.y +
           2.0f * variance.z * direction.x * direction.y;
}

// a = 1/(√2 σ_d tanθ) (Eq. 9; both versions of the paper print tanθ for tan²θ inside the root, with which Eq.
// 11 would be 2.56 at 88°). 0 at and below the frame's horizon; limited to 1e6, where exp(−a²) is 0 anyway.
float smith_argument(vec3 direction, vec3 variance) {
    float along = max(variance_towards(direction, variance), 1.0e-20f);
    return clamp(direction.z * inversesqrt(2.0f * along), 0.0f, 1.0e6f);
}

// Λ (Eq. 8) without its cancellation: exp(−a²)(1 − √π a erfcx(a))/(2√π a). Infinite at grazing, limited to
// 1e8.
float smith_lambda(float a) {
    return exp(-a * a) * erfcx_remainder(a) / (2.0f * sqrt(kPi) * max(a, 2.8e-9f));
}

// cosθ (1 + Λ): the facets' area projected towards the eye, per area of the plane; Eq. 10's normalisation.
// Finite at grazing, where it is σ_d/√(2π).
float visible_area(vec3 direction, vec3 variance) {
    float a = smith_argument(direction, variance);
    float along = max(variance_towards(direction, variance), 1.0e-20f);
    return max(direction.z, 0.0f) + sqrt(along / (2.0f * kPi)) * exp(-a * a) * erfcx_remainder(a);
}

// Masking in two ways, mixed.
//
// Smith's takes the slopes of different facets for independent: a facet is seen if it faces the eye, w = v·f/f_z
// ≥ 0, with the same probability 1/(1 + Λ) at any w. But a facet lies on larger waves, whose slope decides
// whether it is hidden. Nested masking takes all scales: the slope goes from that of the mean surface to the
// facet's by independent steps, wave by wave, and is seen if the sum faces the eye at each step. In the limit of
// many steps it is a Brownian bridge that must not cross 0: seen with the probability 1 − exp(−2 w v_z/(σ_v
// sinθ)²). Both densities of visible slopes integrate to 1, since w is a martingale that stops at 0.
//
// A sea with a horizon test lies between the two: the nested part is larger the more scales there are, the higher
// the eye, and the sharper the crests. Gaussian profiles, 0.5° … 15° above the horizon: 0.05 … 0.6 for waves over
// 2.5 octaves, 0.35 … 0.75 over 6.6. kNested is fitted to the far field of the mirrors of Fig. 10 (tests/bench/README.md), 7 octaves with
// choppiness. Smith's alone shows a quarter too little sun there.
//
// Light reaches a facet by the same two ways. Smith's hides from the eye and the sun by the same heights,
// 1/(1 + Λv + Λl); the bridges are independent. The result is symmetric in both directions.
struct MaskedView {
    float height;  // v_z, ≥ 0
    float along;   // σ_v² sin²θ
    float area;    // Eq. 10's normalisation
};

MaskedView masked_view(vec3 to_eye, vec3 variance) {
    return MaskedView(max(to_eye.z, 0.0f), max(variance_towards(to_eye, variance), 1.0e-20f),
                      max(visible_area(to_eye, variance), 1.0e-6f));
}

// What nested masking leaves of a facet with w = `facing`, per its projected area and that of the plane.
float nested_part(MaskedView view, float facing) {
    float doubled = 2.0f * max(facing, 0.0f) / view.along;
    return doubled * decay_mean(doubled * view.height);
}

// The visible part of a facet, by both ways. Its mean over all slopes, times w, is 1.
float visible_of(MaskedView view, float nested) {
    return mix(1.0f / view.area, nested, kNested);
}
float visible_part(MaskedView view, float facing) {
    return visible_of(view, nested_part(view, facing));
}

// The same of what is seen and lit. `lit` is l·f/f_z, for a mirror equal to `facing`. 0 at and below the frame's
// horizon. Beyond a = 4.5 Λ is below 1e-9.
float lit_of(MaskedView view, float nested, float lit, vec3 to_light, vec3 variance) {
    if (!(to_light.z > 0.0f)) return 0.0f;
    float a = smith_argument(to_light, variance);
    float smith = view.area + (a < 4.5f ? view.height * smith_lambda(a) : 0.0f);
    float along = max(variance_towards(to_light, variance), 1.0e-20f);
    float reached = 1.0f - exp(-2.0f * max(lit, 0.0f) * to_light.z / along);
    return mix(1.0f / smith, nested * reached, kNested);
}
float lit_part(MaskedView view, float facing, float lit, vec3 to_light, vec3 variance) {
    return lit_of(view, nested_part(view, facing), lit, to_light, variance);
}

// Eq. 10 with both ways of masking: the density of visible slopes. Its integral is 1 (Eq. 11).
float visible_slope_density(vec2 slope, vec3 to_eye, vec3 variance) {
    float facing = to_eye.z - to_eye.x * slope.x - to_eye.y * slope.y;  // v·f/f_z
    return slope_density(slope, variance) * max(facing, 0.0f) * visible_part(masked_view(to_eye, variance), facing);
}

// Visible slopes are ζ = −along x + across y, with y standard normal and x with visible_moments(): visibility
// favours facets that face the eye, and leaves the distribution across the line of sight unchanged.
struct VisibleSlopes {
    vec2 along;
    vec2 across;
    float tilt;  // k = cosθ_v/(σ_v sinθ_v)
    VisibleMoments x;
};

VisibleSlopes visible_slopes(vec3 to_eye, vec3 variance) {
    float sine = sqrt(to_eye.x * to_eye.x + to_eye.y * to_eye.y);
    vec2 towards = sine > 1.0e-6f ? vec2(to_eye.x, to_eye.y) / sine : vec2(1.0f, 0.0f);
    vec2 turned = vec2(variance.x * towards.x + variance.z * towards.y,
                       variance.z * towards.x + variance.y * towards.y);
    float sigma = sqrt(max(dot(towards, turned), 1.0e-20f));
    float k = 1.4142136f * smith_argument(to_eye, variance);
    vec2 across = vec2(-towards.y, towards.x) * (sqrt(max(determinant_of(variance), 0.0f)) / sigma);
    return VisibleSlopes(turned / sigma, across, k, visible_moments(k));
}

// Visible facets lean towards the eye on average.
vec2 mean_visible_slope(VisibleSlopes seen) {
    return -seen.x.first * seen.along;
}

// Of the reflected light the part that meets the sea again; v in the frame. κ is the slope that mirrors the eye's
// ray along the plane, tan(½ elevation), in deviations along the line of sight.
//
// A fit to the integral of each facet's reflectance times visible_part() − lit_part(), over that of its reflectance
// times visible_part(): five coefficients, for θ 0 … 90°, σ_v 0.005 … 0.4 and half to twice as much across.
// The error times F̄, its share of the light, is at most 0.014; rms 0.005.
float reflected_again(vec3 v, vec3 variance) {
    float sine = sqrt(v.x * v.x + v.y * v.y);
    vec3 towards = sine > 1.0e-6f ? v / sine : vec3(1.0f, 0.0f, 0.0f);
    float sigma = sqrt(max(variance_towards(towards, variance), 1.0e-12f));
    float across = sqrt(max(determinant_of(variance), 0.0f)) / sigma;
    float kappa = max(v.z, 0.0f) / ((1.0f + sine) * sigma);
    float power = 4.513f * sqrt(kappa) + kappa * (1.05f * across - 2.903f) + 3.531f * sigma - 4.119f;
    return exp(clamp(power, -80.0f, -0.5f));
}
