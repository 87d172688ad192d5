// A pixel of the sea: the query at the point at rest that it shows, and the light from there.

void main() {
    read_point();
    if (kWireframe) {
        write_terms(vec3(0.0), vec3(0.0), vec3(1.0), vec3(0.0), 1.0);
        return;
    }
    PixelAnswer answer = query_pixel(rest_m, pixel_on_mesh());
    if (kFalseColour != 0) {
        write_terms(vec3(0.0), vec3(0.0), false_colour(answer), vec3(0.0), 1.0);
        return;
    }
    SeaTerms terms = sea_radiance(-pixel_ray(), answer.normal,
                                  vec3(answer.hidden.xx, answer.hidden.yy, answer.hidden.xy), answer.coverage,
                                  SeaLight(sun_direction, sun_radiance, sun_angular_radius, sun_irradiance,
                                           sky_irradiance, water_reflectance));
    write_terms(terms.sun, terms.sky, terms.sea, terms.foam, 1.0);
}
