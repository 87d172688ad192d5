// Bubbles of clean air, larger ones first gone: their cross-section over the volume as a part of what it was, by the age of the foam
// above them. Deane and Stokes' sizes (2002), by the speeds at which they rise out of clouds of that depth; the decay at the end is a guess.
float bubbles_left(float age_s, float depth_m) {
    float risen = age_s / (4.0f * max(depth_m, 1.0e-3f));
    return (0.82f * exp(-risen) + 0.18f * pow(1.0f + risen, -0.75f)) * exp(-0.01f * age_s);
}
