// The background where there is no surface of the sea: the sky and the sun's disc (core/lighting/background.glsl), or water.
const float kEndless_m = 1.0e30;

void main() {
    if (kWireframe || kFalseColour != 0) {
        write_terms(vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), 0.0);
        return;
    }
    vec3 direction = pixel_ray();
    if (kFromBelow) {  // water without a surface
        vec3 sea = kWater ? water_between(vec3(0.0), direction, view_height_m, -1.0, 0.0, sea_light()).light
                          : vec3(0.0);
        write_terms(vec3(0.0), vec3(0.0), kBehindGlass * sea, vec3(0.0), vec3(0.0), 1.0);
        return;
    }
    vec3 sky = vec3(0.0);
    if (kSky && kAirSky)
        sky += air_sky(direction, AirView(air_azimuth, air_to_sun, air_reach_m.x, air_reach_m.y, air_reach_m.z,
                                          air_sky_rows.x, air_sky_rows.y));
    else if (kSky)
        sky += sky_smooth(background_place(direction));
    if (kSun) {
        float width = pixel_angle(view_pixel_tangent, dot(direction, view_forward));
        float share = sun_disc(direction, sun_centre, sun_angular_radius, width);
        if (share > 0.0 && sun_radiance != vec3(0.0))
            sky += share * disc_radiance(direction, sun_centre, sun_angular_radius, sun_low, sun_middle, sun_high);
    }
    vec4 spray = seen_spray(-direction, kEndless_m, false);
    write_terms(vec3(0.0), sky * spray.w, vec3(0.0), vec3(0.0), vec3(spray.x, spray.y, spray.z), 0.0);
}
