// Fresnel reflectance: of one facet, and averaged over the visible facets.

// Schlick's approximation (Bruneton et al. 2010, Eq. 14; one version of the paper prints the power 2).
float fresnel_schlick(float cosine) {
    float x = 1.0f - clamp(cosine, 0.0f, 1.0f);
    return 0.02f + 0.98f * square(square(x)) * x;
}

// Unpolarised Fresnel reflectance (Hu et al. 2006, Eq. 2). `index` is relative: n beyond the surface over n
// on the side of the light. Below 1 there may be total reflection (g² < 0): returns 1.
float fresnel_exact(float cosine, float index) {
    float c = clamp(cosine, 0.0f, 1.0f);
    float g2 = index * index + c * c - 1.0f;
    if (g2 < 0.0f) return 1.0f;
    float g = sqrt(g2);
    float across = square((g - c) / (g + c));
    float along = square((c * (g + c) - 1.0f) / (c * (g - c) + 1.0f));
    return 0.5f * across * (1.0f + along);
}

// Reflectance of a level sea under uniform diffuse light: ∫ F(θ) sin 2θ dθ over 0 … π/2 of the exact term.
const float kDiffuseFresnel = 0.06751f;

// Bruneton et al. 2010, Eq. 26: the mean of Schlick's term over the visible facets. sigma_v² is the slope
// variance in the direction of the eye.
float fresnel_effective_paper(float cosine, float sigma_v) {
    float x = 1.0f - clamp(cosine, 0.0f, 1.0f);
    return 0.02f + 0.98f * pow(x, 5.0f * exp(-2.69f * sigma_v)) / (1.0f + 22.7f * sigma_v * sqrt(sigma_v));
}

// The mean of the exact term over the visible facets: the integral of Eq. 24 with the density of slopes.glsl and
// Hu's term. (Eq. 26, made for Smith's masking and Schlick's term, differs from it by up to 0.153 for σ ≤ 0.5, and
// from the mean of Schlick's by 0.105, both at 89.9° on a calm sea.)
//
// The fit evaluates the exact term at one effective cosine. It starts from w, the mean of v·f/f_z over the
// visible facets (cosθ for a flat mirror), and lowers it for the facets' tilt, by their variances along and across
// the line of sight, and, because the term is convex, for the relative variance V of w.
//
// The five coefficients minimise the largest |error|/(F̄ + 0.5) for θ 0 … 90°, σ_v 0.005 … 0.5 and σ across
// 0.01 … 0.5 (20 × 14 × 6 integrals with uncorrelated slopes). The largest error there is 0.004; it is 0.02 for
// slopes with a correlation of 0.7.
float fresnel_effective_exact(float cosine, float sigma_v, float across2) {
    float c = clamp(cosine, 0.0f, 1.0f);
    float tau = max(sigma_v * sqrt(1.0f - c * c), 1.0e-6f);
    VisibleMoments moments = visible_moments(min(c / tau, 1.0e3f));
    float mean = c + tau * moments.first;
    float spread = max(1.0f + moments.second - square(moments.first), 0.0f) * square(tau / mean);
    float tilt = 1.0f + 2.4284f * square(sigma_v) + 0.8712f * across2;
    float convex = 1.0f + mean * spread * (3.3539f - mean * (1.9f + 0.257f * mean));
    return fresnel_exact(mean * inversesqrt(tilt) / convex, kWaterIndex);
}
