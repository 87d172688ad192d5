// Constants, the sky map's projection and special functions of the sea's lighting.
//
// These files (special, fresnel, slopes, sun, sky, water, foam, sea: in this order) are the same text for C++
// and for GLSL: plain functions over floats and vectors. C++ takes them in inside a struct after `using
// namespace glm` (lighting.cpp), the preview puts them behind its #version line.

const float kPi = 3.14159265f;
const float kWaterIndex = 1.34f;  // sea water's index of refraction for visible light (Hu et al. 2006)

const float kSkyMapReach = 1.25f;  // the map holds |u_x|, |u_y| up to this; C++'s kSkyMapExtent

// Where a direction lies. r_z → −1 is the projection's pole: any place beyond the map's edge will do there.
vec2 sky_place(vec3 direction) {
    return vec2(direction.x, direction.y) / max(1.0f + direction.z, 1.0e-4f);
}

// exp(a²) erfc(a) for a ≥ 0, to 1e-6 relative. The factor (1 + 2a) takes out the decay; what is left is a
// polynomial in s = (a − 2)/(a + 2), which has the whole half-line in −1 … 1: least squares in Chebyshev's
// basis, reweighted until the largest relative error was least (4e-7).
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

// 1 − √π a exp(a²) erfc(a) for a ≥ 0, to 1e-6 relative: 1 at 0, 1/(2a²) far out, where the difference itself
// would cancel. A polynomial of its own, found as erfcx's was, after (1 + 1.5a)².
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

// Moments of the density (k + x)₊ φ(x)/(kΦ(k) + φ(k)), φ the normal density and Φ its integral, k ≥ 0: what a
// line of sight makes of normal slopes (slopes.glsl). The mean is `first`, the second moment 1 + `second`.
struct RampMoments {
    float first;   // Φ(k)/(kΦ(k) + φ(k))
    float second;  // φ(k)/(kΦ(k) + φ(k))
};

RampMoments ramp_moments(float k) {
    float a = 0.70710678f * k;
    float bell = exp(-a * a);
    float whole = k + 0.39894228f * bell * erfcx_remainder(a);  // kΦ + φ without a cancellation
    return RampMoments((1.0f - 0.5f * bell * erfcx(a)) / whole, 0.39894228f * bell / whole);
}
