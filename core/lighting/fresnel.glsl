// How much the surface reflects: Fresnel's term for one facet, and averaged over the facets that the eye
// sees.

// Schlick's approximation (Bruneton et al. 2010, Eq. 14; one version of the paper prints the power 2).
float fresnel_schlick(float cosine) {
    float x = 1.0f - clamp(cosine, 0.0f, 1.0f);
    return 0.02f + 0.98f * square(square(x)) * x;
}

// The unpolarised term itself (Hu et al. 2006, Eq. 2), for light that meets water of this index of
// refraction, relative to where it comes from; below 1 it may be reflected totally: 1 where g² < 0.
float fresnel_exact(float cosine, float index) {
    float c = clamp(cosine, 0.0f, 1.0f);
    float g2 = index * index + c * c - 1.0f;
    if (g2 < 0.0f) return 1.0f;
    float g = sqrt(g2);
    float across = square((g - c) / (g + c));
    float along = square((c * (g + c) - 1.0f) / (c * (g - c) + 1.0f));
    return 0.5f * across * (1.0f + along);
}

// The exact term averaged over a uniform sky, ∫ F(θ) sin 2θ dθ over 0 … π/2: of diffuse light, what a level sea
// sends back.
const float kDiffuseFresnel = 0.06751f;

// Bruneton et al. 2010, Eq. 26: the average of Schlick's term over the visible facets; sigma_v is the root of
// the slope variance in the direction of the eye.
float fresnel_effective_paper(float cosine, float sigma_v) {
    float x = 1.0f - clamp(cosine, 0.0f, 1.0f);
    return 0.02f + 0.98f * pow(x, 5.0f * exp(-2.69f * sigma_v)) / (1.0f + 22.7f * sigma_v * sqrt(sigma_v));
}

// The average of the exact term over the visible facets: Eq. 24's integral with q_vn^e and Hu's term, which
// Eq. 26 misses by up to 0.11. The term itself at the cosine that stands for all of them: their mean of
// v·f/f_z, w, brought down by the facets' own tilt and, because the term is convex, by w's relative variance
// V; for a level mirror it is cosθ. Tilt comes from the slopes that change w (along2, σ_v² where slopes along
// and across are not correlated) and from those that don't (across2): |along|² and |across|² of slopes.glsl's
// VisibleSlopes. The six numbers minimise the largest |error|/(F̄ + 0.5) over θ 0 … 90°, σ_v 0.005 … 0.5, σ
// across it 0 … 0.5 (22 × 15 × 7 integrals, slopes along and across independent, random search); the largest
// error itself is 0.004 there, and 0.012 where slopes are correlated by 0.7.
float fresnel_effective_exact(float cosine, float sigma_v, float along2, float across2) {
    float c = clamp(cosine, 0.0f, 1.0f);
    float tau = max(sigma_v * sqrt(1.0f - c * c), 1.0e-6f);
    RampMoments moments = ramp_moments(min(c / tau, 1.0e3f));
    float mean = c + tau * moments.first;
    float spread = max(1.0f + moments.second - square(moments.first), 0.0f) * square(tau / mean);
    float tilt = 1.0f + 1.2762f * along2 + 0.7902f * across2;
    float convex = 1.0f + mean * spread * (3.8696f - mean * (1.0257f + 0.2706f * mean) - 2.1919f * spread);
    return fresnel_exact(mean * inversesqrt(tilt) / convex, kWaterIndex);
}
