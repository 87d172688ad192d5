// A parcel of the spray's large drops (core/effects/spray_drops.h) as a soft disc in a picture. Its profile, (1 - r^2)^2, adds up over
// pixels to its integral where the disc is no narrower than some pixels.

// How much of the light from behind it a place loses. beside: of the disc's middle, in radii. thickness: the optical thickness, as
// if spread evenly over the disc. before: by how much it is nearer than the sea there, in halves of its depth: the sea cuts it softly.
float spray_drop_hides(vec2 beside, float thickness, float before) {
    float inner = 1.0f - dot(beside, beside);
    float share = clamp(0.5f + 0.5f * before, 0.0f, 1.0f);
    if (!(inner > 0.0f) || !(share > 0.0f)) return 0.0f;
    float there = 3.0f * thickness * inner * inner;
    // 1 - exp() has no digits of a thin one's.
    return (there < 1.0e-3f ? there * (1.0f - 0.5f * there) : 1.0f - exp(-there)) * share;
}
