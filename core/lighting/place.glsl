// The light at each place of a round earth, where an eye sees so much of it that the sun isn't equally high over all of it
// (Bruneton et al. 2010, §6): sun and sky are those of the place's own sun. The includer has sea.glsl and air.glsl, whose
// table's last two rows go over the sun's elevation, at even steps of its third root, from the nadir's to the zenith's:
//   sun's radiance as seen from the sea (mean over the disc), and by how much the sine of the elevation of the disc's
//   visible centre is above that of its middle
//   sky's irradiance

struct PlaceView {
    vec3 to_sun;     // unit, from below the eye, to the middle of the disc
    float by_place;  // 0 … 1: how much of a place's distance counts; 0: everywhere light is as below the eye
};

vec4 place_lookup(int row, float elevation) {
    float last = float(3 * kAirColumns - 1);
    float x = elevation / 1.5707963f;
    x = 0.5f * last * (1.0f + sign(x) * pow(abs(x), 1.0f / 3.0f));
    int first = int(clamp(floor(x), 1.0f, last - 2.0f));
    vec4 weights = smooth_weights(clamp(x - float(first), 0.0f, 1.0f));
    row += kAirRows + kAirSkyRows;
    vec4 sum = weights.x * air_texel(first - 1, row) + weights.y * air_texel(first, row) +
               weights.z * air_texel(first + 1, row) + weights.w * air_texel(first + 2, row);
    return max(sum, vec4(0.0f));
}

// The light at a place as a multiple of that below the eye, at most `most`: sea_radiance_at() adds the rest.
vec3 place_share(vec3 here, vec3 there, float most) { return min(here / max(there, vec3(1.0e-20f)), vec3(most)); }

// sea_radiance() at a place with that vertical. to_eye and normal: relative to it. light: that below the eye, in the
// eye's axes. The sky's pattern is scaled; where the sky is much brighter than below the eye, the rest is uniform.
SeaTerms sea_radiance_at(vec3 up, vec3 to_eye, vec3 normal, vec3 slope_variance, SeenFoam seen, SeenBody body, SeaLight light,
                         PlaceView place) {
    float rise = light.sun_direction.z - place.to_sun.z;
    light.sun_direction = levelled(light.sun_direction, up);
    bool is_by_place = place.by_place > 0.0f && up.z < 1.0f;
    vec3 share = vec3(1.0f);
    vec3 more = vec3(0.0f);
    if (is_by_place) {
        float below = asin(clamp(place.to_sun.z, -1.0f, 1.0f));
        float here = asin(clamp(levelled(place.to_sun, up).z, -1.0f, 1.0f));
        here = mix(below, here, place.by_place);
        vec4 sun_below = place_lookup(0, below);
        vec4 sun_here = place_lookup(0, here);
        vec4 sky_below = place_lookup(1, below);
        vec4 sky_here = place_lookup(1, here);
        vec3 sun_before = vec3(sun_below.x, sun_below.y, sun_below.z);
        vec3 sun = vec3(sun_here.x, sun_here.y, sun_here.z);
        vec3 sky_before = vec3(sky_below.x, sky_below.y, sky_below.z);
        vec3 sky = vec3(sky_here.x, sky_here.y, sky_here.z);

        vec3 towards = light.sun_direction + vec3(0.0f, 0.0f, sun_here.w - rise);
        light.sun_direction = normalize(towards);
        light.sun_radiance = light.sun_radiance * place_share(sun, sun_before, 1.0f) + max(sun - sun_before, vec3(0.0f));
        light.sun_irradiance = light.sun_radiance * (kPi * square(light.sun_angular_radius) * max(light.sun_direction.z, 0.0f));
        float most = 8.0f;
        share = place_share(sky, sky_before, most);
        more = max(sky - most * sky_before, vec3(0.0f));
        light.sky_irradiance = light.sky_irradiance * share + more;
    }
    SeaTerms terms = sea_radiance(to_eye, normal, slope_variance, seen, body, light);
    if (kSky && is_by_place) {
        SlopeFrame frame = slope_frame(facing_normal(normal, to_eye), slope_variance);
        float clear = kWhitecaps ? 1.0f - seen.opacity : 1.0f;
        terms.sky = terms.sky * share +
                    more * (clear * shown_of_uniform_sky(into_frame(frame, to_eye), frame.variance) / kPi);
    }
    return terms;
}
