// From radiance to display values: a filmic curve that preserves hue, and the sRGB encoding. Compiled as C++
// and as GLSL; needs no other file.

// Film and eye respond to light by a sigmoid in its logarithm: xⁿ/(xⁿ + sⁿ) (Naka and Rushton 1966, for the
// retina). n = 1.6 gives middle grey the contrast of a camera's picture, 1.6 · (1 − 0.18) = 1.3 in logarithms: at that of the
// light itself, as with 1.25, a sea in the sun looked veiled beside photographs, its whites grey. s = 0.4644 maps 0.18
// to 0.18. Written so that neither end overflows or underflows.
float film_curve(float x) {
    float contrast = 1.6f;
    float half_way = 0.4644f;
    float least = 1e-20f;  // the power of a smaller x isn't representable
    return 1.0f / (1.0f + pow(half_way / max(x, least), contrast));
}

// The toe: what is left of light of this luminance. By day the darks of a sea are only one to three stops below middle grey, and the curve
// goes by the strongest component, a sea's blue, where it is still flat: shadows were grey. Luminances between black and middle grey are
// lowered, most at a third of it, which makes the first stop's contrast 1.8 (1.4 without) and the second's 1.6; what is much darker is
// hardly lowered, so that dusk and night keep their tones. Middle grey and all that is brighter stay.
float toe(float luminance) {
    float lowered = 0.2f;
    float part = clamp(luminance / 0.18f, 0.0f, 1.0f);
    return 1.0f - lowered * 6.75f * part * (1.0f - part) * (1.0f - part);  // p(1 − p)² is 1/6.75 at most
}

// IEC 61966-2-1, for linear values 0 … 1.
float srgb_encoded(float linear) {
    if (linear <= 0.0031308f) return 12.92f * linear;
    return 1.055f * pow(linear, 1.0f / 2.4f) - 0.055f;
}

// Oklab (Ottosson 2020, "A perceptual color space for image processing"): from linear sRGB to lightness and two opponent colours,
// and back. A colour that goes to white along a straight line there keeps the hue that one sees; in linear light orange turns pink
// on the way.
vec3 oklab_of(vec3 colour) {
    vec3 cones = vec3(dot(vec3(0.4122214708f, 0.5363325363f, 0.0514459929f), colour),
                      dot(vec3(0.2119034982f, 0.6806995451f, 0.1073969566f), colour),
                      dot(vec3(0.0883024619f, 0.2817188376f, 0.6299787005f), colour));
    vec3 felt = pow(cones, vec3(1.0f / 3.0f));
    felt -= (felt * felt * felt - cones) / (3.0f * felt * felt);  // drivers' powers have few digits
    return vec3(dot(vec3(0.2104542553f, 0.7936177850f, -0.0040720468f), felt),
                dot(vec3(1.9779984951f, -2.4285922050f, 0.4505937099f), felt),
                dot(vec3(0.0259040371f, 0.7827717662f, -0.8086757660f), felt));
}

vec3 colour_of_oklab(vec3 lab) {
    vec3 felt = vec3(dot(vec3(1.0f, 0.3963377774f, 0.2158037573f), lab), dot(vec3(1.0f, -0.1055613458f, -0.0638541728f), lab),
                     dot(vec3(1.0f, -0.0894841775f, -1.2914855480f), lab));
    vec3 cones = felt * felt * felt;
    return vec3(dot(vec3(4.0767416621f, -3.3077115913f, 0.2309699292f), cones),
                dot(vec3(-1.2684380046f, 2.6097574011f, -0.3413193965f), cones),
                dot(vec3(-0.0041960863f, -0.7034186147f, 1.7076147010f), cones));
}

// How much paler a colour is shown whose weakest component is that part of its strongest: filters of sensors and layers of film overlap, and
// no photograph has light without some of each component (the reference gamut compression of ACES 1.3 is for the same). Light through metres
// of clear water has no red, and would be neon. None from a quarter on, by eye.
float paler(float weakest) {
    float lack = max(1.0f - 4.0f * weakest, 0.0f);
    return 0.15f * lack * lack;
}

// The sRGB display value, 0 … 1, of a radiance. exposure: radiance × exposure = 0.18 is middle grey.
//
// The curve is applied to the largest component, and the others keep their ratio to it: a curve per component would turn the orange
// of a low sun's glitter into yellow. Very bright colours go to white, as on film and in the eye, by the 48th power of the curve:
// a low sun's light keeps two thirds of its saturation two stops above white paper, and the sun's disc is white.
vec3 display_colour(vec3 radiance, float exposure) {
    vec3 light = clamp(radiance * exposure, vec3(0.0f), vec3(1e30f));  // no ratios of infinities
    light *= toe(dot(vec3(0.2126f, 0.7152f, 0.0722f), light));
    float strongest = max(max(light.x, light.y), light.z);
    if (!(strongest > 0.0f)) return vec3(0.0f);
    float shown = film_curve(strongest);
    float fourth = (shown * shown) * (shown * shown);
    float sixteenth = (fourth * fourth) * (fourth * fourth);
    float white = sixteenth * sixteenth * sixteenth;
    vec3 colour = light / strongest;
    float pale = paler(min(min(colour.x, colour.y), colour.z));
    // Where nothing is to be changed rounding shouldn't change anything.
    if (max(white, pale) > 1e-5f) {
        vec3 lab = oklab_of(colour);
        lab = vec3(lab.x, (1.0f - pale) * lab.y, (1.0f - pale) * lab.z);
        colour = colour_of_oklab(mix(lab, vec3(1.0f, 0.0f, 0.0f), white));
    }
    vec3 linear = shown * clamp(colour, vec3(0.0f), vec3(1.0f));
    return vec3(srgb_encoded(linear.x), srgb_encoded(linear.y), srgb_encoded(linear.z));
}
