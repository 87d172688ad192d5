// A pixel of the sea: the query at the point at rest that it shows, and the light from there.

in vec2 rest_m;
in float pixel_m;
in vec3 tilt;

void main() {
    if (kWireframe) {
        write_terms(vec3(0.0), vec3(0.0), vec3(1.0), vec3(0.0), 1.0);
        return;
    }
    vec3 n = tilt / max(length(tilt), 1e-9);
    vec3 v = -pixel_ray();
    PixelAxis axis = pixel_axis(pixel_m, n.x, n.y, n.z, v.x, v.y, v.z);
    PixelAnswer answer = query_pixel(rest_m, vec3(pixel_m, axis.x_m, axis.y_m));
    if (kFalseColour != 0) {
        write_terms(vec3(0.0), vec3(0.0), false_colour(answer), vec3(0.0), 1.0);
        return;
    }
    SeaTerms terms = sea_radiance(v, answer.normal,
                                  vec3(answer.hidden.xx, answer.hidden.yy, answer.hidden.xy), answer.coverage,
                                  SeaLight(sun_direction, sun_radiance, sun_angular_radius, sun_irradiance,
                                           sky_irradiance, water_reflectance));
    write_terms(terms.sun, terms.sky, terms.sea, terms.foam, 1.0);
}
