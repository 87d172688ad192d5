// The light of a body that stands in the light of the sea: a diffuse surface under a clear, rough varnish, and its glow. After
// special.glsl and fresnel.glsl.

struct ObjectLook {
    vec3 colour;      // of the diffuse reflection
    float roughness;  // the square root of GGX's α
    vec3 glow;        // radiance that it gives
};

// The light round a place without the sun's disc. The irradiance by the normal n is
// flat + n·(x, y, z) + xy nₓn_y + yz n_yn_z + zz (3 n_z² − 1) + xz nₓn_z + xx_yy (nₓ² − n_y²):
// spherical harmonics to the second degree, which hold 99 % of any diffuse irradiance (Ramamoorthi and Hanrahan 2001).
struct ObjectSurroundings {
    vec3 flat_part;
    vec3 x;
    vec3 y;
    vec3 z;
    vec3 xy;
    vec3 yz;
    vec3 zz;
    vec3 xz;
    vec3 xx_yy;
    vec3 water;  // radiance that comes out of the sea, with its foam
};

// A perfect mirror would show the sun's disc as a point.
const float kLeastAlpha = 0.02f;
const float kVarnishStraight = 0.04f;  // reflectance straight on, of an index of 1.5

float varnish_fresnel(float cosine) {
    float x = 1.0f - clamp(cosine, 0.0f, 1.0f);
    return kVarnishStraight + (1.0f - kVarnishStraight) * (square(square(x)) * x);
}

vec3 object_irradiance(vec3 n, ObjectSurroundings light) {
    vec3 sum = light.flat_part + light.x * n.x + light.y * n.y + light.z * n.z + light.xy * (n.x * n.y) + light.yz * (n.y * n.z) +
               light.zz * (3.0f * n.z * n.z - 1.0f) + light.xz * (n.x * n.z) + light.xx_yy * (n.x * n.x - n.y * n.y);
    return max(sum, vec3(0.0f));  // a few harmonics of a strong light ring below 0
}

// GGX's α.
float varnish_alpha(float roughness) {
    return max(square(roughness), kLeastAlpha);
}

// Smith's masking for GGX, of one direction.
float varnish_visible(float cosine, float alpha) {
    return 2.0f * cosine / (cosine + sqrt(square(alpha) + (1.0f - square(alpha)) * square(cosine)));
}

// What the varnish reflects of uniform light to an eye: the lobe of object_of_sun() over all directions. A fit to its integral at 24
// roughnesses and 33 cosines, least squares reweighted until the largest error was smallest: 0.007.
float varnish_reflectance(float cosine, float roughness) {
    float c = clamp(cosine, 0.0f, 1.0f);
    float r = sqrt(varnish_alpha(roughness));
    float q = c * inversesqrt(square(c) + 9.0f * square(square(r)));  // 0 along the surface, 1 where the lobe is narrower than the view is high
    float flat_part = 0.8542f + r * (-3.2115f + r * (4.053f - 1.6422f * r));
    float first = -1.313f + r * (4.5664f + r * (-4.488f + 0.9848f * r));
    float second = 0.4369f + r * (-0.7698f + r * (-1.0973f + 1.7449f * r));
    float x = 1.0f - c;
    return flat_part + q * (first + q * second) +
           square(square(x)) * x * (0.259f - 0.2754f * r + q * (0.9046f - 1.0367f * r));
}

// Its mean over a hemisphere, by the cosine; the fit errs by 0.0013.
float varnish_mean_reflectance(float roughness) {
    float r = sqrt(varnish_alpha(roughness));
    return 0.0951f + r * (-0.0544f + r * (-0.0944f + 0.0715f * r));
}

// Of the sun with the mean radiance of its disc, and its irradiance on a plane across its light. The lobe is that of Walter et al. 2007. What
// it doesn't send back enters the surface, on its way in and on its way out: so no light is lost, and eye and sun may be exchanged
// (Kelemen and Szirmay-Kalos 2001, Eq. 5).
vec3 object_of_sun(vec3 to_eye, vec3 to_sun, vec3 normal, ObjectLook look, vec3 sun, vec3 beam) {
    float lit = dot(normal, to_sun);
    if (!(lit > 0.0f)) return vec3(0.0f);
    float seen = max(dot(normal, to_eye), 1.0e-3f);
    float alpha = varnish_alpha(look.roughness);
    vec3 facet = normalize(to_eye + to_sun);
    float density = square(alpha) / (kPi * max(square(1.0f + square(dot(facet, normal)) * (square(alpha) - 1.0f)), 1.0e-9f));
    float gloss = density * varnish_fresnel(dot(facet, to_eye)) * varnish_visible(lit, alpha) * varnish_visible(seen, alpha) /
                  (4.0f * seen);
    float diffuse = (1.0f - varnish_reflectance(seen, look.roughness)) * (1.0f - varnish_reflectance(lit, look.roughness)) /
                    (1.0f - varnish_mean_reflectance(look.roughness));
    // No more than the disc's radiance: along the surface the lobe has no bound.
    return look.colour * (diffuse * lit / kPi) * beam + min(gloss * beam, sun);
}

// Light from all round: `irradiance` on the surface, `mirrored` the mean radiance in the varnish's lobe. cosine: of the view to the normal.
vec3 object_of_surroundings(float cosine, ObjectLook look, vec3 irradiance, vec3 mirrored) {
    float reflected = varnish_reflectance(cosine, look.roughness);
    return look.colour * ((1.0f - reflected) / kPi) * irradiance + reflected * mirrored;
}

// In the water, where there is no varnish to see: radiance to any eye there. to_sun: as the water shows it. sun, sky: what enters of the sun's
// irradiance on the level sea and what falls on it of the sky's, each times what water leaves of it down to there. Of the sky's 0.93 enters;
// what comes of it from the side and from below is by eye.
vec3 object_in_water(vec3 normal, vec3 to_sun, vec3 sun, vec3 sky, ObjectLook look) {
    vec3 light = ((0.6f + 0.4f * normal.z) * 0.93f) * sky + (max(dot(normal, to_sun), 0.0f) / to_sun.z) * sun;
    return look.colour * light / kPi + look.glow;
}

// The mean radiance in the lobe round a mirrored ray: `sky` where that, or its mirror image on the sea, meets the sky.
vec3 object_mirrors(vec3 ray, float roughness, vec3 sky, ObjectSurroundings light) {
    vec3 sea = fresnel_exact(abs(ray.z), kWaterIndex) * sky + light.water;
    float width = max(square(roughness), 1.0e-3f);  // of the horizon in the lobe
    return mix(sea, sky, clamp(0.5f + 0.5f * ray.z / width, 0.0f, 1.0f));
}
