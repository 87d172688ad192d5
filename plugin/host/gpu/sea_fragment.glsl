// A pixel of the sea: the query at the point at rest that it shows, and the light from there.

uniform float curvature_per_m;

void main() {
    read_point();
    read_shape();
    if (kWireframe) {
        write_terms(vec3(0.0), vec3(0.0), vec3(1.0), vec3(0.0), vec3(0.0), 1.0);
        return;
    }
    vec3 pixel = pixel_on_mesh();
    vec3 place = vec3(0.0, 0.0, view_height_m) + point_from_eye();
    PixelAnswer answer = query_pixel(rest_m, pixel);
    AllFoam all = AllFoam(0.0, 0.0, 0.0, -1.0);
    if (kCoverage) all = with_hulls(with_strips(all_foam(rest_m, pixel, answer.coverage), rest_m, pixel.x), place, pixel.x);
    answer.coverage = all.coverage;
    if (kFalseColour != 0) {
        write_terms(vec3(0.0), vec3(0.0), false_colour(answer), vec3(0.0), vec3(0.0), 1.0);
        return;
    }
    EarthPoint vertical = earth_up(rest_m.x, rest_m.y, curvature_per_m);
    vec3 up = vec3(vertical.x, vertical.y, vertical.z);
    vec3 to_eye = levelled(-pixel_ray(), up);
    SeenFoam foam = no_foam();
    if (kWhitecaps)
        foam = seen_foam(FoamPattern(foam_pattern_cell, foam_pattern_rest, foam_pattern_axes, foam_pattern_look, foam_pattern_white,
                                     foam_pattern_image),
                         rest_m, pixel, all.coverage, all.breaking, all.age_s, sun_direction);
    SeenBody body = SeenBody(pixel_ray() * point_distance_m(), pixel_over(pixel), point_crest(), 0.0, 0.0, 0.0);
    if (kWhitecaps && water_bubbles.x > 0.0) {
        float covered = clamp(all.coverage, 0.0, 1.0);
        float fresh = min(covered, max(all.breaking, 0.0));
        bool is_sum = all.bubbles >= 0.0;
        body = SeenBody(body.from_eye, body.pixel_m, body.crest, is_sum ? min(fresh + all.bubbles, 1.0) : fresh, is_sum ? 0.0 : covered - fresh,
                        all.age_s);
    }
    if (kFromBelow) {
        vec3 normal = visible_normal(vec3(-answer.normal.x, -answer.normal.y, answer.normal.z), upside_down(to_eye),
                                     answer.slope_variance_at_rest, mesh_variance_along());
        SeaTerms below = sea_from_below(to_eye, vec3(-normal.x, -normal.y, normal.z), answer.slope_variance, foam, body,
                                        view_height_m, point_distance_m(), sea_light());
        write_terms(kBehindGlass * below.sun, kBehindGlass * below.sky, kBehindGlass * below.sea, kBehindGlass * below.foam, vec3(0.0), 1.0);
        return;
    }
    SeaLight light = sea_light();
    float sun = sun_share(place);
    light.sun_radiance *= sun;
    light.sun_irradiance *= sun;
    mirror_from(place);
    SeaTerms terms =
        sea_radiance_at(up, to_eye, visible_normal(answer.normal, to_eye, answer.slope_variance_at_rest, mesh_variance_along()),
                        answer.slope_variance, foam, body, light, PlaceView(air_to_sun, air_by_place));
    if (kWater) terms.sea = see_into_water(terms.sea, place, -pixel_ray(), answer.normal, 1.0 - foam.opacity, light.water);
    AirPath path = AirPath(vec3(1.0), vec3(0.0));
    if (kAir)
        path = air_path(-pixel_ray(), point_distance_m(),
                        AirView(air_azimuth, air_to_sun, air_reach_m.x, air_reach_m.y, air_reach_m.z, air_sky_rows.x, air_sky_rows.y));
    vec4 spray = seen_spray(-pixel_ray(), point_distance_m(), true);
    vec3 left = path.transmittance * spray.w;
    write_terms(terms.sun * left, terms.sky * left, terms.sea * left, terms.foam * left,
                path.scattered * spray.w + vec3(spray.x, spray.y, spray.z), 1.0);
}
