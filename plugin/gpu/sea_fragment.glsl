// A pixel of the sea: the query at the point at rest that it shows, and the light from there.

in vec2 rest_m;
in vec3 pixel_m;  // width and long axis, on the sea at rest

// On the triangle that is drawn.
vec3 pixel_on_mesh() {
    float tangent = length(view_right);
    if (!(tangent > 0.0)) return pixel_m;  // parallel rays
    vec3 ray = view_forward + view_right * (gl_FragCoord.x - view_centre.x) + view_up * (gl_FragCoord.y - view_centre.y);
    vec2 nearer = vec2(dFdx(gl_FragCoord.w), dFdy(gl_FragCoord.w)) / (gl_FragCoord.w * tangent);
    PixelFootprint drawn =
        footprint_on_mesh(PixelFootprint(pixel_m.x, pixel_m.y, pixel_m.z), view_right.x / tangent,
                          view_right.y / tangent, view_up.x / tangent, view_up.y / tangent, ray.x, ray.y, nearer.x, nearer.y);
    return vec3(drawn.width, drawn.axis_x, drawn.axis_y);
}

void main() {
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
