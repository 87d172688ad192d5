// A colour map instead of the light: 0 … 1 as hues from blue through green to red.
vec3 hue_of(float x) {
    float h = clamp(x, 0.0, 1.0) * 4.0;
    return clamp(vec3(h - 2.0, 2.0 - abs(h - 2.0), 2.0 - h), 0.0, 1.0);
}

vec3 false_colour(PixelAnswer answer) {
    if (kFalseColour == 1) return hue_of(answer.level / max(float(kPixelLevels - 1), 1.0));
    // Cox and Munk's sea has a mean square slope of 0.05 at 10 m/s. The scale ends at twice that.
    if (kFalseColour == 2) return vec3((answer.slope_variance.x + answer.slope_variance.y) / 0.1);
    return vec3(answer.coverage);
}
