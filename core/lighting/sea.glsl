// All light that a pixel of sea sends to the eye. The includer defines, besides what sky.glsl needs:
//   const bool kSun, kSky, kWater, kWhitecaps    the terms; those that are off are not compiled

struct SeaLight {
    vec3 sun_direction;
    vec3 sun_radiance;
    float sun_angular_radius;
    vec3 sun_irradiance;
    vec3 sky_irradiance;
    WaterLook water;
    FloorView floor;
};

struct SeaTerms {
    vec3 sun;
    vec3 sky;
    vec3 sea;
    vec3 foam;
};

// The slopes of foam. It lies on the waves as a blanket, by how thick it is: of what a pixel resolves below a metre (kCrestFootprint_m)
// opaque foam keeps this part, or the ripples below it comb it. The rest makes it rough, as where a pixel doesn't resolve it, so that
// as much light comes back from near and far. By eye.
const float kRipplesInFoam = 0.15f;

SlopeFrame frame_of_foam(vec3 normal, vec3 slope_variance, float opacity, vec3 to_eye, vec3 crest) {
    vec2 slope = vec2(-normal.x, -normal.y) / max(normal.z, 0.1f);
    vec2 hidden = (opacity * (1.0f - kRipplesInFoam)) * (slope - vec2(crest.x, crest.y));
    hidden /= max(sqrt(dot(hidden, hidden)), 1.0f);  // of a crest that folds
    vec2 shown = slope - hidden;
    return slope_frame(facing_normal(normalize(vec3(-shown.x, -shown.y, 1.0f)), to_eye),
                       slope_variance + vec3(hidden.x * hidden.x, hidden.y * hidden.y, hidden.x * hidden.y));
}

// to_eye, normal: unit vectors, world axes; the normal may face away. slope_variance: (σxx, σyy, σxy) of the
// unresolved waves, world axes. Each term is weighted by its share of the pixel (what opaque foam hides, and the rest for the others);
// their sum is the radiance.
SeaTerms sea_radiance(vec3 to_eye, vec3 normal, vec3 slope_variance, SeenFoam seen, SeenBody body, SeaLight light) {
    SlopeFrame frame = slope_frame(facing_normal(normal, to_eye), slope_variance);
    SeaTerms terms = SeaTerms(vec3(0.0f), vec3(0.0f), vec3(0.0f), vec3(0.0f));
    vec3 v = into_frame(frame, to_eye);
    float clear = 1.0f;
    if (kWhitecaps) {
        // Waves hide foam as they hide the water between: its share of what is seen is its share of the sea.
        clear = 1.0f - seen.opacity;
        SlopeFrame foam = frame;
        if (seen.opacity > 1.0e-3f && dot(body.crest, body.crest) > 0.0f)  // 0: nobody knows
            foam = frame_of_foam(normal, slope_variance, seen.opacity, to_eye, body.crest);
        terms.foam = seen.opacity * foam_radiance(to_eye, light.sun_direction, foam, light.sun_radiance,
                                                  light.sun_angular_radius, light.sky_irradiance, seen.white, seen.slope);
    }
    if (kSky) terms.sky = clear * sky_reflection(to_eye, frame);
    if (!kSun && !kWater) return terms;

    // What facets mirror onto the sea shows sun and water there; sky_seen_again() is the sky's part.
    float reflected = effective_fresnel(v, frame.variance);
    float again = kSecondReflection ? reflected * reflected_again(v, frame.variance) : 0.0f;
    vec3 level = grazing_view(v);
    if (kSun) {
        terms.sun = sun_seen_from(v, light.sun_direction, frame, light.sun_radiance, light.sun_angular_radius);
        if (again > 1.0e-5f) {
            terms.sun += again * sun_seen_again(level, light.sun_direction, frame,
                                                light.sun_radiance, light.sun_angular_radius);
        }
        terms.sun *= clear;
    }
    if (kWater) {
        float shown = 1.0f - reflected + again * (1.0f - effective_fresnel(level, frame.variance));
        vec3 up = light.water.has_body
                      ? body_radiance(to_eye, frame.normal, light.sun_direction, light.sun_irradiance,
                                      (kPi * square(light.sun_angular_radius)) * light.sun_radiance, light.sky_irradiance,
                                      light.water, light.floor, slope_variance, body)
                      : water_radiance(light.sun_direction, light.sun_irradiance, light.sky_irradiance,
                                       light.water.reflectance);
        terms.sea = clear * shown * up;
    }
    return terms;
}
