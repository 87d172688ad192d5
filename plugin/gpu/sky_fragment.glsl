// The background where there is no sea: the sky and the sun's disc (core/lighting/background.glsl).
void main() {
    if (kWireframe || kFalseColour != 0) {
        write_terms(vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), 0.0);
        return;
    }
    vec3 direction = pixel_ray();
    vec3 sky = vec3(0.0);
    if (kSky) sky += sky_smooth(background_place(direction));
    if (kSun) {
        float width = pixel_angle(view_pixel_tangent, dot(direction, view_forward));
        float share = sun_disc(direction, sun_centre, sun_angular_radius, width);
        if (share > 0.0 && sun_radiance != vec3(0.0))
            sky += share * disc_radiance(direction, sun_centre, sun_angular_radius, sun_low, sun_middle, sun_high);
    }
    write_terms(vec3(0.0), sky, vec3(0.0), vec3(0.0), 0.0);
}
