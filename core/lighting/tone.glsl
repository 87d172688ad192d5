// From radiance to display values: a filmic curve that preserves hue, and the sRGB encoding. Compiled as C++
// and as GLSL; needs no other file.

// Film and eye respond to light by a sigmoid in its logarithm: xⁿ/(xⁿ + sⁿ) (Naka and Rushton 1966, for the
// retina). n = 1.25 gives middle grey the contrast of a print, 1.25 · (1 − 0.18) = 1.02 in logarithms; s =
// 0.6055 maps 0.18 to 0.18. Written so that neither end overflows or underflows.
float film_curve(float x) {
    float contrast = 1.25f;
    float half_way = 0.6055f;
    float least = 1e-20f;  // the power of a smaller x isn't representable
    return 1.0f / (1.0f + pow(half_way / max(x, least), contrast));
}

// IEC 61966-2-1, for linear values 0 … 1.
float srgb_encoded(float linear) {
    if (linear <= 0.0031308f) return 12.92f * linear;
    return 1.055f * pow(linear, 1.0f / 2.4f) - 0.055f;
}

// The sRGB display value, 0 … 1, of a radiance. exposure: radiance × exposure = 0.18 is middle grey.
//
// The curve is applied to the largest component, and the others keep their ratio to it: a curve per component
// would turn the orange of a low sun's glitter into yellow. Bright colours desaturate linearly towards white,
// as on film and in the eye, by the cube of the curve: colours hold up to half its range.
vec3 display_colour(vec3 radiance, float exposure) {
    vec3 light = clamp(radiance * exposure, vec3(0.0f), vec3(1e30f));  // no ratios of infinities
    float strongest = max(max(light.x, light.y), light.z);
    if (!(strongest > 0.0f)) return vec3(0.0f);
    float shown = film_curve(strongest);
    vec3 colour = mix(light / strongest, vec3(1.0f), shown * shown * shown);
    vec3 linear = min(shown * colour, vec3(1.0f));
    return vec3(srgb_encoded(linear.x), srgb_encoded(linear.y), srgb_encoded(linear.z));
}
