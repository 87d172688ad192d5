// From radiance to a screen: a film's curve that leaves hues alone, and sRGB's encoding.
// One source for C++ and GLSL; needs nothing but the language.

// Film and eye alike answer to light by an S over its logarithm: xⁿ/(xⁿ + sⁿ) (Naka and Rushton 1966, of
// the retina). n = 1.25 gives middle grey the contrast of a print, 1.25 · (1 − 0.18) = 1.02 in logarithms,
// and s = 0.6055 leaves it where it is: 0.18 ↦ 0.18. Written so that neither end over- or underflows.
float film_curve(float x) {
    float contrast = 1.25f;
    float half_way = 0.6055f;
    float least = 1e-20f;  // x below has no power that a float holds
    return 1.0f / (1.0f + pow(half_way / max(x, least), contrast));
}

// IEC 61966-2-1, from linear 0 … 1.
float srgb_encoded(float linear) {
    if (linear <= 0.0031308f) return 12.92f * linear;
    return 1.055f * pow(linear, 1.0f / 2.4f) - 0.055f;
}

// What a screen shows of a radiance, 0 … 1, sRGB. exposure: radiance × exposure = 0.18 is middle grey.
//
// The curve answers to the strongest of the three colours, and the others keep their ratio to it: a curve for
// each of them would turn the orange of a low sun's glitter into yellow. What is bright goes to white along
// the straight line there, as film and eyes have it, by the cube of the curve: colours hold up to half its
// range.
vec3 display_colour(vec3 radiance, float exposure) {
    vec3 light = clamp(radiance * exposure, vec3(0.0f), vec3(1e30f));  // no ratio of infinities
    float strongest = max(max(light.x, light.y), light.z);
    if (!(strongest > 0.0f)) return vec3(0.0f);
    float shown = film_curve(strongest);
    vec3 colour = mix(light / strongest, vec3(1.0f), shown * shown * shown);
    vec3 linear = min(shown * colour, vec3(1.0f));
    return vec3(srgb_encoded(linear.x), srgb_encoded(linear.y), srgb_encoded(linear.z));
}
