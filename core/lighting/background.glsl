// What lies behind the sea: the sun's own disc before the sky. A picture shows, where there is no sea,
//     sky_lookup(background_place(place of the direction in the map, kSkyMapSize), 0.0f)
//         + sun_radiance · sun_disc(…).
// One source for C++ and GLSL; special.glsl comes before it.

// Where the sky behind the sea is looked up: at the place itself, but for a seam along the horizon, on both
// sides, which takes the sky just above. There the map's texels hold what lies above and below the horizon,
// which is right for a reflection and a dark saw to look at. A lookup mixes what is up to 1½ texels off, each
// way.
vec2 background_place(vec2 u, float map_size) {
    float texel = 2.0f * kSkyMapReach / map_size;
    float radius = length(u);
    if (radius < 0.5f) return u;  // not near the horizon, |u| = 1, in any map that has one
    vec2 outwards = u / radius;
    float seam = 1.5f * texel * (abs(outwards.x) + abs(outwards.y));
    if (abs(radius - 1.0f) > seam) return u;
    return outwards * max(1.0f - seam, 0.5f);
}

// The angle that a pixel's side subtends [rad], of a square as large as the pixel, which shrinks towards the
// edges of a wide picture: its solid angle is t² cos³θ, t the tangent that a pixel covers, θ from the axis.
float pixel_angle(float pixel_tangent, float cos_off_axis) {
    float c = max(cos_off_axis, 0.0f);
    return pixel_tangent * c * sqrt(c);
}

// The disc's share of the pixel round `direction`, 0 … 1: a disc whose edge is smooth over a pixel's width.
// Both directions unit, pixel_angle > 0. Summed over the pixels it has the disc's own solid angle, whatever
// their size: the smooth edge adds a² ↦ a² + w²/12 to the squared radius a² where the pixel's width w is at
// most the disc's, and a² ↦ (a + w/2)³/(3w) where it is wider, which the factors take back.
float sun_disc(vec3 direction, vec3 sun_direction, float sun_angular_radius, float width) {
    // The chord: exact where the cosine of a small angle has no digits left; 3e-6 short at the sun's edge.
    float angle = length(direction - sun_direction);
    float a = sun_angular_radius;
    float outer = a + 0.5f * width;
    float share = clamp((outer - angle) / width, 0.0f, 1.0f);
    if (width < 2.0f * a) return share * (a * a / (a * a + width * width / 12.0f));
    return share * (3.0f * a * a * width / (outer * outer * outer));
}
