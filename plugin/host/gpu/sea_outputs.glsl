// The render targets: each term separately, or their sum. alpha is 1 where there is sea.
layout(location = 0) out vec4 sea_out;
layout(location = 1) out vec4 sun_out;
layout(location = 2) out vec4 sky_out;
layout(location = 3) out vec4 foam_out;
layout(location = 4) out vec4 air_out;

void write_terms(vec3 sun, vec3 sky, vec3 sea, vec3 foam, vec3 air, float is_sea) {
    if (kLayers) {
        sea_out = vec4(sea, is_sea);
        sun_out = vec4(sun, 1.0);
        sky_out = vec4(sky, 1.0);
        foam_out = vec4(foam, 1.0);
        air_out = vec4(air, 1.0);
    } else {
        sea_out = vec4(sun + sky + sea + foam + air, is_sea);
    }
}

// Something before all that, by blending: it hides such a share of each term, and adds light to the air's.
void write_before(vec3 air, float hidden) {
    if (kLayers) {
        sea_out = vec4(vec3(0.0), hidden);
        sun_out = sea_out;
        sky_out = sea_out;
        foam_out = sea_out;
        air_out = vec4(air, hidden);
    } else {
        sea_out = vec4(air, hidden);
    }
}
