// Light that comes back out of the water: Bruneton et al. 2010, Eq. 28, with the way in and out that L_sea
// has.

// Radiance just above the surface before the (1 − F̄) of the way out. The sun comes in through a level sea
// (exact Fresnel term), the sky with 1 − kDiffuseFresnel. The water sends
// `reflectance` of what goes down back up, evenly in all directions; 0.48 of that is turned back by the
// surface's underside (diffuse, mostly totally reflected), and goes round again. Out of the water radiance
// spreads by n².
vec3 water_radiance(vec3 to_sun, vec3 sun_irradiance, vec3 sky_irradiance, vec3 reflectance) {
    vec3 down =
        sun_irradiance * (1.0f - fresnel_exact(to_sun.z, kWaterIndex)) + sky_irradiance * (1.0f - kDiffuseFresnel);
    vec3 up = reflectance * down / (1.0f - 0.48f * reflectance);
    return up / (kPi * kWaterIndex * kWaterIndex);
}
