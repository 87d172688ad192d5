// The background where a picture shows no sea: the sun's disc in front of the sky,
//     sky_lookup(background_place(place of the direction in the map, kSkyMapSize), 0.0f)
//         + sun_radiance · sun_disc(…).
// Compiled as C++ and as GLSL; needs special.glsl before it.

// The place in the map where the background is looked up: the direction's own, except in a band along the
// horizon, which takes the sky just above. Texels there mix radiance above and below the horizon. That is
// right for reflections, but would show as a dark, jagged line. A lookup reaches 1½ texels to each side.
vec2 background_place(vec2 u, float map_size) {
    float texel = 2.0f * kSkyMapReach / map_size;
    float radius = length(u);
    if (radius < 0.5f) return u;  // far from the horizon |u| = 1 in any map fine enough to have one
    vec2 outwards = u / radius;
    float seam = 1.5f * texel * (abs(outwards.x) + abs(outwards.y));
    if (abs(radius - 1.0f) > seam) return u;
    return outwards * max(1.0f - seam, 0.5f);
}

// The angle [rad] subtended by the side of a square that is as large as the pixel. Pixels shrink towards the
// edges of a wide picture: their solid angle is t² cos³θ, where t is the tangent that a pixel covers and θ
// the angle from the axis.
float pixel_angle(float pixel_tangent, float cos_off_axis) {
    float c = max(cos_off_axis, 0.0f);
    return pixel_tangent * c * sqrt(c);
}

// The fraction 0 … 1 of a pixel around `direction` that the disc covers, with an edge as soft as a pixel is
// wide. Both directions are unit vectors; pixel_angle > 0. Summed over the pixels it gives the disc's solid
// angle at any pixel size. To that end the factors undo the soft edge's contribution to the squared radius:
// a² becomes a² + w²/12 if the pixel's width w is at most the disc's, and (a + w/2)³/(3w) if it is larger.
float sun_disc(vec3 direction, vec3 sun_direction, float sun_angular_radius, float width) {
    // The chord, since the cosine of a small angle has no precision; 3e-6 too short at the sun's edge.
    float angle = length(direction - sun_direction);
    float a = sun_angular_radius;
    float outer = a + 0.5f * width;
    float share = clamp((outer - angle) / width, 0.0f, 1.0f);
    if (width < 2.0f * a) return share * (a * a / (a * a + width * width / 12.0f));
    return share * (3.0f * a * a * width / (outer * outer * outer));
}
