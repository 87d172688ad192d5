// The air before an eye: between it and the sea, where it takes light away and scatters light of the sun and the sky into the
// ray, and above the horizon, where it is the sky. The includer defines
//   const int kAirColumns, kAirRows        the table's size: three such pictures side by side, and below them
//   const int kAirSkyRows                  rows of the sky, and then the two of place.glsl
//   const int kAirHorizonRow               the row of the horizon's distance
//   vec4 air_texel(int column, int row)    the table (air.h)
//
// Rows are distances to places on the sea: the root of the distance from the nearest one, which is smooth for eyes at any
// height, up to the horizon. Beyond it, where crests and a flat sea may lie, rows are distances along the ray that grazes
// it, to the end of the air. Columns go round the circle from the sun's azimuth, at even steps.
//
// Rows of the sky are elevations above the horizon as this eye sees it, by the third root: fine at the horizon. They end at
// the zenith, and for an eye above the air where the air does.
//
// The table holds what varies slowly: the mean extinction from here to there, and the light that is scattered in over the
// share 1 − T of light that is lost. That is an average along the ray. Phase functions are left to the pixel.

struct AirView {
    vec2 azimuth;       // unit, horizontal: of column 0
    vec3 to_sun;        // unit, from below the eye: for the phase functions
    float nearest_m;    // of the sea
    float horizon_m;
    float farthest_m;
    float dip;          // of the horizon [rad]
    float sky_span;     // from there to the last row of the sky [rad]
};

// Rayleigh's, without the molecules' anisotropy [1/sr].
float air_phase(float cosine) { return 0.05968310f * (1.0f + cosine * cosine); }

// Henyey and Greenstein's lobe [1/sr].
float phase_lobe(float cosine, float g) {
    float bracket = 1.0f + g * g - 2.0f * g * cosine;
    return 0.07957747f * (1.0f - g * g) / (bracket * sqrt(bracket));
}

// Two lobes with a mean cosine of 0.73. The forward lobe makes the aureole.
float haze_phase(float cosine) { return 0.945f * phase_lobe(cosine, 0.80f) + 0.055f * phase_lobe(cosine, -0.45f); }

float air_row(float distance_m, AirView air) {
    float last = float(kAirHorizonRow);
    float span = max(air.horizon_m - air.nearest_m, 1.0e-6f * air.horizon_m);
    if (distance_m < air.horizon_m) return last * sqrt(clamp((distance_m - air.nearest_m) / span, 0.0f, 1.0f));
    float beyond = (distance_m - air.horizon_m) / max(air.farthest_m - air.horizon_m, 1.0f);
    return last + (float(kAirRows - 1) - last) * sqrt(clamp(beyond, 0.0f, 1.0f));
}

vec4 air_lookup(int layer, float column, float row) {
    int first = int(floor(column));
    float across = column - float(first);
    int left = first % kAirColumns + layer * kAirColumns;
    int right = (first + 1) % kAirColumns + layer * kAirColumns;
    int near_row = min(int(row), kAirRows - 2);
    return mix(mix(air_texel(left, near_row), air_texel(right, near_row), across),
               mix(air_texel(left, near_row + 1), air_texel(right, near_row + 1), across), row - float(near_row));
}

// Catmull and Rom's weights: smooth, and through the table's own values.
vec4 smooth_weights(float x) {
    return vec4(x * (x * (1.0f - 0.5f * x) - 0.5f), x * x * (1.5f * x - 2.5f) + 1.0f,
                x * (x * (2.0f - 1.5f * x) + 0.5f), x * x * (0.5f * x - 0.5f));
}

vec4 air_smooth_row(int layer, int first, vec4 weights, int row) {
    return weights.x * air_texel((first + kAirColumns - 1) % kAirColumns + layer * kAirColumns, row) +
           weights.y * air_texel(first % kAirColumns + layer * kAirColumns, row) +
           weights.z * air_texel((first + 1) % kAirColumns + layer * kAirColumns, row) +
           weights.w * air_texel((first + 2) % kAirColumns + layer * kAirColumns, row);
}

// In `count` rows from `begin` on; `row` counts from there.
vec4 air_smooth_lookup(int layer, float column, float row, int begin, int count) {
    int first = int(floor(column));
    vec4 across = smooth_weights(column - float(first));
    int low = min(int(row), count - 2);
    vec4 up = smooth_weights(row - float(low));
    vec4 below = air_smooth_row(layer, first, across, begin + max(low - 1, 0));
    vec4 at = air_smooth_row(layer, first, across, begin + low);
    vec4 next = air_smooth_row(layer, first, across, begin + low + 1);
    // Beyond the first and the last row the curve goes on straight.
    if (low == 0) below = 2.0f * at - next;
    vec4 above = low + 2 < count ? air_smooth_row(layer, first, across, begin + low + 2) : 2.0f * next - at;
    return up.x * below + up.y * at + up.z * next + up.w * above;
}

vec3 air_sky_lookup(int layer, float column, float row) {
    vec4 light = air_smooth_lookup(layer, column, row, kAirRows, kAirSkyRows);
    return vec3(light.x, light.y, light.z);
}

// Light that is scattered more than once is complete, and brightest towards the sun: smooth. The horizon is an edge.
vec4 air_more_lookup(float column, float row) {
    float last = float(kAirHorizonRow);
    if (row < last) return air_smooth_lookup(2, column, row, 0, kAirHorizonRow + 1);
    return air_smooth_lookup(2, column, row - last, kAirHorizonRow, kAirRows - kAirHorizonRow);
}

// The column of a direction; to_eye is the opposite one.
float air_column(vec3 to_eye, AirView air) {
    float along = -(to_eye.x * air.azimuth.x + to_eye.y * air.azimuth.y);
    float across = to_eye.x * air.azimuth.y - to_eye.y * air.azimuth.x;
    float turn = along * along + across * across > 0.0f ? atan(across, along) : 0.0f;
    return (turn < 0.0f ? turn + 6.2831853f : turn) * (float(kAirColumns) / 6.2831853f);
}

struct AirPath {
    vec3 transmittance;
    vec3 scattered;  // radiance
};

// to_eye: unit, from the place towards the eye.
AirPath air_path(vec3 to_eye, float distance_m, AirView air) {
    float column = air_column(to_eye, air);
    float row = air_row(distance_m, air);
    vec4 by_air = air_lookup(0, column, row);
    vec4 by_haze = air_lookup(1, column, row);
    vec4 more = air_more_lookup(column, row);
    vec3 thickness = vec3(by_air.w, by_haze.w, more.w) * min(distance_m, air.farthest_m);
    vec3 left = exp(-thickness);
    // 1 − exp(−x) has no digits where x is small.
    vec3 lost = mix(1.0f - left, thickness * (1.0f - 0.5f * thickness), lessThan(thickness, vec3(1.0e-3f)));
    float cosine = -dot(to_eye, air.to_sun);
    vec3 light = vec3(by_air.x, by_air.y, by_air.z) * air_phase(cosine) +
                 vec3(by_haze.x, by_haze.y, by_haze.z) * haze_phase(cosine) + vec3(more.x, more.y, more.z);
    return AirPath(left, max(light, 0.0f) * lost);
}

// The sky in a direction (unit) above the horizon; below it, that of the horizon.
vec3 air_sky(vec3 direction, AirView air) {
    float elevation = atan(direction.z, length(vec2(direction.x, direction.y)));
    float part = clamp((elevation + air.dip) / air.sky_span, 0.0f, 1.0f);
    float row = pow(part, 1.0f / 3.0f) * float(kAirSkyRows - 1);
    float column = air_column(-direction, air);
    float cosine = dot(direction, air.to_sun);
    vec3 light = air_sky_lookup(0, column, row) * air_phase(cosine) + air_sky_lookup(1, column, row) * haze_phase(cosine) +
                 air_sky_lookup(2, column, row);
    return max(light, 0.0f);
}
