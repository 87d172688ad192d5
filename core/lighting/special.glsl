// Constants, the sky map's projection and special functions of the sea's lighting.
//
// These files (special, fresnel, slopes, sun, sky, water, foam, sea, in this order) are the same text for C++
// and for GLSL: plain functions over floats and vectors. C++ includes them inside a struct after `using
// namespace glm` (lighting.cpp); the preview appends them to its #version line.

const float kPi = 3.14159265f;
const float kWaterIndex = 1.34f;  // sea water's index of refraction for visible light: 1.336 … 1.350 (Quan & Fry 1995)

// The part of masking that is nested (slopes.glsl); the rest is Smith's.
const float kNested = 0.75f;

const float kSkyMapReach = 1.25f;  // the map covers |u_x|, |u_y| up to this; kSkyMapExtent in C++

// The place of a direction in the map. r_z → −1 is the projection's pole; any place beyond the map's edge
// serves.
vec2 sky_place(vec3 direction) {
    return vec2(direction.x, direction.y) / max(1.0f + direction.z, 1.0e-4f);
}

// exp(a²) erfc(a) for a ≥ 0, with a relative error of 1e-6. The factor (1 + 2a) removes the decay. The rest
// is a polynomial in s = (a − 2)/(a + 2), which maps the half-line to −1 … 1: least squares in the Chebyshev
// basis, reweighted until the largest relative error was smallest (4e-7).
float erfcx(float a) {
    float s = (a - 2.0f) / (a + 2.0f);
    float p = -0.00016978146f;
    p = p * s - 0.00099289079f;
    p = p * s + 0.00101102726f;
    p = p * s + 0.00833591912f;
    p = p * s - 0.00791773573f;
    p = p * s - 0.05408553034f;
    p = p * s + 0.16402855515f;
    p = p * s - 0.16604691744f;
    p = p * s - 0.09276250005f;
    p = p * s + 1.27697873116f;
    return p / (1.0f + 2.0f * a);
}

// 1 − √π a exp(a²) erfc(a) for a ≥ 0, with a relative error of 1e-6: 1 at 0, 1/(2a²) for large a, where the
// difference itself would cancel. Fitted like erfcx, with the factor (1 + 1.5a)².
float erfcx_remainder(float a) {
    float s = (a - 2.0f) / (a + 2.0f);
    float p = -0.00368287414f;
    p = p * s - 0.00185431645f;
    p = p * s + 0.02471705340f;
    p = p * s + 0.01193421986f;
    p = p * s - 0.11800567061f;
    p = p * s + 0.03288529441f;
    p = p * s + 0.35843750834f;
    p = p * s - 0.49479961395f;
    p = p * s - 0.19896654785f;
    p = p * s + 1.51433420181f;
    float q = 1.0f + 1.5f * a;
    return p / (q * q);
}

float square(float x) {
    return x * x;
}

// (1 − exp(−x))/x for x ≥ 0, without its cancellation.
float decay_mean(float x) {
    return x < 0.05f ? 1.0f - x * (0.5f - x * (0.16666667f - x * 0.041666667f)) : (1.0f - exp(-x)) / x;
}

// What the eye sees of normal slopes x (slopes.glsl), k ≥ 0, with the normal density φ and its integral Φ. The
// mean is `first`, the second moment is 1 + `second`.
//
// Smith's part has the density (k + x)₊ φ(x)/whole, the nested part (k + x)/k (φ(x) − φ(x + 2k))₊: the noncentral
// χ distribution of three degrees of freedom.
struct VisibleMoments {
    float whole;  // kΦ + φ
    float first;
    float second;
};

VisibleMoments visible_moments(float k) {
    float a = 0.70710678f * k;
    float bell = exp(-a * a);
    float outside = bell * erfcx(a);  // 2Φ(−k)
    float whole = k + 0.39894228f * bell * erfcx_remainder(a);  // without cancellation
    float k2 = k * k;
    float slope = k < 0.5f ? 0.79788456f * (1.0f - k2 * (1.0f / 6.0f - k2 * (0.025f - k2 * (1.0f / 336.0f))))
                           : (1.0f - outside) / k;  // (2Φ(k) − 1)/k
    float nested = slope - k * outside + 0.79788456f * bell;
    return VisibleMoments(whole, mix((1.0f - 0.5f * outside) / whole, nested, kNested),
                          mix(0.39894228f * bell / whole, 2.0f - 2.0f * k * nested, kNested));
}
