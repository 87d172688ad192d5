// Light scattered back out of the water: Bruneton et al. 2010, Eq. 28, with the transmission at the surface,
// as L_sea.

// The radiance just above the surface, before the factor (1 − F̄) of transmission outwards. Sunlight enters
// through a level sea (exact Fresnel term), skylight with the factor 1 − kDiffuseFresnel. The water sends the
// share `reflectance` of the downward light back up, isotropically. The underside of the surface reflects
// 0.48 of that down again (mostly total reflection), and so on. Leaving the water divides radiance by n².
vec3 water_radiance(vec3 to_sun, vec3 sun_irradiance, vec3 sky_irradiance, vec3 reflectance) {
    vec3 down =
        sun_irradiance * (1.0f - fresnel_exact(to_sun.z, kWaterIndex)) + sky_irradiance * (1.0f - kDiffuseFresnel);
    vec3 up = reflectance * down / (1.0f - 0.48f * reflectance);
    return up / (kPi * kWaterIndex * kWaterIndex);
}
