// The background where a picture shows no sea: the sun's disc in front of the sky,
//     sky_smooth(background_place(direction)) + disc_radiance(…) · sun_disc(…).
// Compiled as C++ and as GLSL; needs special.glsl and sky_map.glsl before it.

// The place in the map where the background is looked up: the direction's own, and below the horizon the horizon's.
vec2 background_place(vec3 direction) {
    if (direction.z >= 0.0f) return sky_place(direction);
    vec2 across = vec2(direction.x, direction.y);
    return across / max(length(across), 1.0e-6f);
}

// The disc's radiance at a direction, from that at the lowest place of it that isn't below the horizon, at the highest,
// and in the middle between them: the air takes more from what is lower. Optical thickness is as good as quadratic
// over the disc.
vec3 disc_radiance(vec3 direction, vec3 sun_centre, float sun_angular_radius, vec3 low, vec3 middle, vec3 high) {
    // Heights instead of elevations, whose cosines are alike.
    float radius = sun_angular_radius * max(length(vec2(sun_centre.x, sun_centre.y)), 1.0e-3f);
    float lowest = max(sun_centre.z - radius, 0.0f);
    float half_range = max(0.5f * (sun_centre.z + radius - lowest), 1.0e-6f);
    float x = clamp((direction.z - lowest) / half_range - 1.0f, -1.0f, 1.0f);
    vec3 least = vec3(max(1.0e-6f * max(max(high.x, high.y), high.z), 1.0e-30f));  // logarithms are finite
    vec3 a = log(max(low, least));
    vec3 b = log(max(middle, least));
    vec3 c = log(max(high, least));
    return exp(b + x * (0.5f * (c - a) + x * (0.5f * (a + c) - b)));
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
