// The spray before an eye: droplets over breaking crests, which take light away from a ray and scatter light of the sun, the sky
// and the sea into it (Darles et al. 2007, §4.2). Needs air.glsl before it. The includer defines
//   vec4 spray_texel(int column, int row)   the map (spray.h): the surface's height [m], and the extinctions there [1/m]
//   float spray_lift(int column, int row)   how far up ribbons stay, in steps
//
// Rows of the map are circles round the eye's nadir in geometric progression, columns are azimuths: a ray stays between two columns.
// From row to row both its height above the surface and the extinction there are taken as linear, and extinction falls with that
// height z as exp(−z/scale): the integral is known. Torn spray is ribbons, linear between some
// heights, and haze of the same extinction everywhere, which falls off like that. Where the map has the ray below the surface, z counts as 0. Transmittances of
// pieces multiply (the paper adds them).
//
// Droplets absorb nothing. They are much larger than light's wavelengths: all colours alike, and most goes on nearly straight.
// One scattering is followed, with light that is as in the open: what comes from all sides is scattered to all sides, so that
// under the same light from everywhere spray isn't seen. The sun is dimmed by the spray above a place, as if that were as thick all
// round; what it loses comes from all sides.
//
// Ribbons are spindrift: threads that a noise in space cuts out of what the map says, which has no detail of less than some metres. A
// generation of the noise is born unsheared, 24 times as long as it is high, and the wind shears it, by u(z) t over what is old, as long as
// it lives; two generations at a time take turns. Where spray is as thick as over what breaks whole most of it stays as it is; what is
// thinner is that much fewer threads. So edges fall apart, and don't fade. The mean is the map's everywhere.

struct SprayThreads {
    vec4 cell;        // of the eye's nadir: whole cells along the wind and across it, modulo 65536; 0 … 1, where in it
    vec4 wind;        // towards where; the friction velocity over Kármán's constant [m/s]; one over the roughness [1/m]
    vec4 born;        // of both generations: how long ago [s]; weights whose squares add up to 1
    vec2 names;       // of both: whole, less than 2^24
    float per_m;      // extinction over what breaks whole; 0: there are no threads
    float pixel_rad;  // what a pixel sees
};

struct SprayView {
    int columns;
    int rows;
    vec2 azimuth;           // unit, horizontal: of column 0
    float columns_per_rad;  // counter-clockwise
    float first_m;          // row 0's distance from the nadir
    float row_step;         // the logarithm of the next row's over it
    bool is_torn;
    float scale_m;          // of the haze, or of all spray
    float step_m;           // of the ribbons' heights
    float haze_per_m;       // extinction at the surface
    vec2 forward;           // mean cosines of the two lobes that the light of the sun is scattered into, half each
    float eye_m;            // heights: of the eye,
    float top_m;            // and of the highest place in the map
    vec3 to_sun;
    vec3 sun;               // irradiance, on a plane across it
    vec3 above;             // mean radiance: of the sky,
    vec3 below;             // and of the sea
    vec3 low_ahead;         // radiance of the low sky: below the sun,
    vec3 low_beside;        // a quarter round,
    vec3 low_behind;        // and opposite
    SprayThreads threads;
};

struct SprayPath {
    float transmittance;
    vec3 scattered;  // radiance
};

const float kSprayEndless_m = 1.0e30f;  // the distance where a ray meets nothing
// The mean cosine of what spheres of water much larger than the wavelength scatter (Hansen and Travis 1974: 0.85). Its square is the
// share that counts as not scattered in what dims the sun (Joseph, Wiscombe and Weinman 1976).
const float kSprayForward = 0.85f;
const float kSprayHigh = 12.0f;     // scale heights above which there is none to speak of: 6e-6
const float kSprayLowSun = 0.1f;    // the sine of the lowest elevation that counts: farther off there are other crests
// The largest threads at birth, and how far apart places along a ray are where they count [m].
const float kThreadHigh_m = 1.0f;
const float kThreadStep_m = 0.8f;
const float kThreadLip_m = 0.7f;  // the lips that threads come from shelter what is lower

// A place along the ray.
struct SprayPoint {
    float extinction;  // at the surface there [1/m]
    float z;           // above it, in scale heights
    float thinner;     // exp(−z), 1 below it
};

SprayPoint spray_point(float extinction, float z) { return SprayPoint(extinction, z, exp(-max(z, 0.0f))); }

struct SprayPlace {
    SprayPoint point;  // of haze, or of all spray
    vec3 torn;         // the ribbons' extinctions at three heights
    float steps;       // the height above where ribbons begin
    float lift;        // how far that is above the surface, in steps
};

// z: in scale heights.
SprayPlace spray_place(vec4 texel, float lift, float z, SprayView spray) {
    if (!spray.is_torn) return SprayPlace(spray_point(texel.y, z), vec3(0.0f), 0.0f, 0.0f);
    return SprayPlace(spray_point(spray.haze_per_m, z), vec3(texel.y, texel.z, texel.w),
                      z * spray.scale_m / spray.step_m - lift, lift);
}

// Below the surface ribbons are as at it, and none where they stay up.
float torn_under(vec3 torn, float lift) { return torn.x * max(1.0f - 4.0f * lift, 0.0f); }

// The ribbons' extinction at a height above where they begin, in steps. Below that they fade over half their lift.
float torn_at(vec3 torn, float z, float lift) {
    if (z < -lift) return torn_under(torn, lift);
    if (z < 0.0f) return torn.x * max(1.0f + z / max(0.5f * lift, 1.0e-6f), 0.0f);
    if (z < 1.0f) return mix(torn.x, torn.y, z);
    if (z < 2.5f) return mix(torn.y, torn.z, (z - 1.0f) * (1.0f / 1.5f));
    return torn.z * max((5.0f - z) * 0.4f, 0.0f);
}

// Its integral from there up.
float torn_below(vec3 torn, float z, float lift) {
    float foot = 0.5f * lift;
    float under = min(-min(z, 0.0f), foot);
    float a = clamp(z, 0.0f, 1.0f);
    float b = clamp(z - 1.0f, 0.0f, 1.5f);
    float c = clamp(z - 2.5f, 0.0f, 2.5f);
    return min(z + lift, 0.0f) * torn_under(torn, lift) - torn.x * under * (1.0f - 0.5f * under / max(foot, 1.0e-6f)) +
           a * (torn.x + (torn.y - torn.x) * 0.5f * a) + b * (torn.y + (torn.z - torn.y) * b * (1.0f / 3.0f)) +
           c * torn.z * (1.0f - 0.2f * c);
}

// Straight up from there.
float spray_column(SprayPlace at, SprayView spray) {
    float column = at.point.extinction * at.point.thinner * spray.scale_m;
    if (!spray.is_torn || at.steps >= 5.0f) return column;
    return column + spray.step_m * (torn_below(at.torn, 5.0f, at.lift) - torn_below(at.torn, max(at.steps, -at.lift), at.lift));
}

// The mean of the extinction between two places above the surface. The first integral of exp(−z), by the height's own difference, has no
// digits where that is small.
float spray_over(SprayPoint a, SprayPoint b) {
    bool rises = a.z <= b.z;
    float low = rises ? a.extinction : b.extinction;
    float more = (rises ? b.extinction : a.extinction) - low;
    float dense = max(a.thinner, b.thinner);
    float thin = min(a.thinner, b.thinner);
    float x = abs(b.z - a.z);
    if (x < 0.25f) {
        float first = 1.0f - x * (0.5f - x * (1.0f / 6.0f - x * (1.0f / 24.0f - x * (1.0f / 120.0f))));
        float second = 0.5f - x * (1.0f / 3.0f - x * (0.125f - x * (1.0f / 30.0f - x * (1.0f / 144.0f))));
        return dense * (low * first + more * second);
    }
    float first = (dense - thin) / x;
    return low * first + more * ((first - thin) / x);
}

float spray_mean(SprayPoint a, SprayPoint b) {
    if (a.z >= 0.0f && b.z >= 0.0f) return spray_over(a, b);
    if (a.z <= 0.0f && b.z <= 0.0f) return 0.5f * (a.extinction + b.extinction);
    float part = a.z / (a.z - b.z);
    SprayPoint surface = SprayPoint(mix(a.extinction, b.extinction, part), 0.0f, 1.0f);
    float before = a.z > 0.0f ? spray_over(a, surface) : 0.5f * (a.extinction + surface.extinction);
    float behind = b.z > 0.0f ? spray_over(surface, b) : 0.5f * (b.extinction + surface.extinction);
    return mix(behind, before, part);
}

// Normal, variance 1: sums of four bytes at the corners of cells, and their smooth mean between, scaled to keep the variance. cell: of
// the origin of the place, by numbers up to `most`.
float spray_clouds(vec3 place, uint cell_x, uint cell_y, uint most, uint layer) {
    vec3 low = floor(place);
    vec3 t = place - low;
    t = t * t * (3.0f - 2.0f * t);
    uint x = cell_x + uint(int(low.x));
    uint y = cell_y + uint(int(low.y));
    uint z = uint(int(low.z)) * 0x27D4EB2Fu + layer * 0xC2B2AE3Du;
    float sum = 0.0f;
    float squares = 0.0f;
    for (int corner = 0; corner < 8; ++corner) {
        uint right = uint(corner & 1);
        uint beside = uint((corner >> 1) & 1);
        uint up = uint(corner >> 2);
        uint h = (((x + right) & most) * 0x9E3779B1u) ^ (((y + beside) & most) * 0x85EBCA77u + z + up * 0x27D4EB2Fu);
        h = (h ^ (h >> 15u)) * 0x2C1B3C6Du;
        h = (h ^ (h >> 12u)) * 0x297A2D39u;
        h ^= h >> 15u;
        float weight = (right == 1u ? t.x : 1.0f - t.x) * (beside == 1u ? t.y : 1.0f - t.y) * (up == 1u ? t.z : 1.0f - t.z);
        float bytes = float((h & 255u) + ((h >> 8u) & 255u) + ((h >> 16u) & 255u) + (h >> 24u));
        sum += weight * (bytes - 510.0f);
        squares += weight * weight;
    }
    return sum * inversesqrt(squares * 21845.0f);
}

// What spray has at a place over what the map says there, 1 on average over generations. place_m: from the eye's nadir; height_m: above where ribbons begin;
// extinction: the map's; pixel_m: what the pixel sees there.
float spray_thread(vec2 place_m, float height_m, float extinction, float pixel_m, SprayThreads threads) {
    vec4 shares = vec4(0.56f, 0.56f, 0.46f, 0.4f);  // of octaves, squares' sum 1
    vec4 seen = shares * vec4(smoothstep(1.0f, 3.0f, kThreadHigh_m / pixel_m), smoothstep(1.0f, 3.0f, 0.5f * kThreadHigh_m / pixel_m),
                              smoothstep(1.0f, 3.0f, 0.25f * kThreadHigh_m / pixel_m), smoothstep(1.0f, 3.0f, 0.125f * kThreadHigh_m / pixel_m));
    float variance = dot(seen, seen);
    if (!(variance > 1.0e-4f) || !(threads.per_m > 0.0f)) return 1.0f;
    vec2 wind = vec2(threads.wind.x, threads.wind.y);
    float along_m = dot(place_m, wind);
    float across_m = place_m.y * wind.x - place_m.x * wind.y;
    float speed = threads.wind.z * log(1.0f + max(height_m + kThreadLip_m, 0.1f) * threads.wind.w);
    float sum = 0.0f;
    for (int generation = 0; generation < 2; ++generation) {
        float age_s = generation == 0 ? threads.born.x : threads.born.y;
        float weight = generation == 0 ? threads.born.z : threads.born.w;
        uint name = uint(generation == 0 ? threads.names.x : threads.names.y);
        vec3 place = vec3(threads.cell.z + (along_m - speed * age_s) / float(kThreadLong_m), threads.cell.w + across_m / float(kThreadBroad_m), height_m / kThreadHigh_m);
        vec3 bent = vec3(0.0f);
        for (int k = 0; k < 4; ++k) {
            if (!(seen[k] > 0.0f)) break;
            float finer = float(1 << k);
            // Larger ones bend smaller ones: they meander.
            float cloud = spray_clouds(finer * (place + bent) + float(3 * k + generation) * vec3(0.37f, 0.618f, 0.29f), uint(threads.cell.x) << uint(k), uint(threads.cell.y) << uint(k),
                                       (65536u << uint(k)) - 1u, 4u * name + uint(k));
            sum += weight * seen[k] * cloud;
            bent += vec3(0.03f, 0.2f, 0.15f) * (cloud / finer);
        }
    }
    sum *= inversesqrt(variance);
    // Its rank, even over 0 … 1: the normal distribution within 2e-4.
    float rank = 1.0f / (1.0f + exp(-sum * (1.5976f + 0.070566f * sum * sum)));
    float part = clamp(extinction / (extinction + threads.per_m), 0.1f, 0.85f);
    float soft = 0.8f * min(part, 1.0f - part);
    float thread = smoothstep(1.0f - part - soft, 1.0f - part + soft, rank) / part;
    return mix(1.0f, thread, sqrt(variance));
}

// The mean of ribbons and haze between two places. from, to: from the eye's nadir. Threads count at some places between.
float spray_mean_of(SprayPlace a, SprayPlace b, vec2 from_m, vec2 to_m, SprayView spray) {
    float mean = spray_mean(a.point, b.point);
    if (!spray.is_torn) return mean;
    // The ribbons are taken as half those of either place. A ray that hardly rises stays at its height.
    vec3 torn = 0.5f * (a.torn + b.torn);
    float lift = 0.5f * (a.lift + b.lift);
    float low = min(a.steps, b.steps);
    if (low >= 5.0f) return mean;
    float high = max(a.steps, b.steps);
    float ribbons = torn_under(torn, lift);
    if (high > -lift) {
        float wider = max(0.005f - 0.5f * (high - low), 0.0f);
        low -= wider;
        high += wider;
        ribbons = max((torn_below(torn, high, lift) - torn_below(torn, low, lift)) / (high - low), 0.0f);
    }
    float length_m = length(to_m - from_m);
    if (!(spray.threads.per_m > 0.0f) || ribbons * length_m < 1.0e-3f) return mean + ribbons;
    int count = clamp(int(length_m / kThreadStep_m) + 1, 1, 4);
    float all = 0.0f;
    float threads = 0.0f;
    for (int i = 0; i < count; ++i) {
        float part = (float(i) + 0.5f) / float(count);
        vec2 place_m = mix(from_m, to_m, part);
        float steps = mix(a.steps, b.steps, part);
        float here = torn_at(mix(a.torn, b.torn, part), steps, mix(a.lift, b.lift, part));
        if (!(here > 0.0f)) continue;
        all += here;
        threads += here * spray_thread(place_m, steps * spray.step_m, here, spray.threads.pixel_rad * length(vec3(place_m, spray.eye_m)), spray.threads);
    }
    return mean + (all > 0.0f ? ribbons * (threads / all) : ribbons);
}

// The light along a ray that is the same at all its places.
struct SprayLight {
    vec3 around;  // from all sides but the sun
    vec3 sun;     // irradiance, on a plane across it
    float phase;  // the part of it that goes on towards the eye, by solid angle
    float high;   // the sine of its elevation
};

SprayLight spray_light_along(vec3 ray, SprayView spray) {
    float cosine = dot(ray, spray.to_sun);
    float phase = 0.5f * (phase_lobe(cosine, spray.forward.x) + phase_lobe(cosine, spray.forward.y));
    // Of light from all sides most comes from ahead, and along the sea from the low sky there.
    vec3 sky = spray.above;
    if (spray.is_torn) {
        float across = length(vec2(ray.x, ray.y));
        float turned = (ray.x * spray.to_sun.x + ray.y * spray.to_sun.y) /
                       max(across * length(vec2(spray.to_sun.x, spray.to_sun.y)), 1.0e-6f);
        // By halves: a parabola through all three would take the sun's bright yellow away from what is opposite, and leave mauve.
        vec3 low = mix(spray.low_beside, turned > 0.0f ? spray.low_ahead : spray.low_behind, turned * turned);
        sky = mix(sky, low, kSprayForward * across * across);
    }
    return SprayLight(mix(spray.below, sky, 0.5f + 0.5f * kSprayForward * ray.z), spray.sun, phase,
                      max(spray.to_sun.z, kSprayLowSun));
}

// What of it is scattered into the ray below so thick a column, over the extinction.
vec3 spray_source(SprayLight light, float column) {
    float left = exp(-(1.0f - kSprayForward * kSprayForward) * column / light.high);
    return light.around + light.sun * (left * light.phase + (1.0f - left) * 0.07957747f);
}

SprayPath spray_behind(SprayPath path, SprayLight light, float thickness, float column) {
    float left = exp(-thickness);
    float lost = thickness < 1.0e-3f ? thickness * (1.0f - 0.5f * thickness) : 1.0f - left;
    return SprayPath(path.transmittance * left,
                     path.scattered + path.transmittance * lost * spray_source(light, column));
}

vec4 spray_between(float column, int row) {
    int left = int(column);
    return mix(spray_texel(left, row), spray_texel(left + 1, row), column - float(left));
}
float spray_lift_between(float column, int row) {
    int left = int(column);
    return mix(spray_lift(left, row), spray_lift(left + 1, row), column - float(left));
}

// to_eye: unit, from the place towards the eye. on_sea: the place is on the surface, wherever the map has that.
SprayPath spray_path(vec3 to_eye, float distance_m, bool on_sea, SprayView spray) {
    vec3 ray = -to_eye;
    float across = max(length(vec2(ray.x, ray.y)), 1.0e-6f);
    float slope = ray.z / across;
    vec2 ahead = vec2(ray.x, ray.y) / across;
    float along_first = ray.x * spray.azimuth.x + ray.y * spray.azimuth.y;
    float beside_first = ray.y * spray.azimuth.x - ray.x * spray.azimuth.y;
    float turn = along_first * along_first + beside_first * beside_first > 0.0f ? atan(beside_first, along_first) : 0.0f;
    // A column's own direction may be rounded to the last one's.
    if (turn < -0.5f / spray.columns_per_rad) turn += 6.2831853f;
    float column = clamp(turn * spray.columns_per_rad, 0.0f, float(spray.columns) - 1.001f);

    // Where the ray ends: behind this row, at this part of the way to the next.
    bool is_endless = distance_m >= kSprayEndless_m;
    int last = spray.rows - 1;
    float end_m = is_endless ? 0.0f : distance_m * across;
    int end = last;
    if (!is_endless)
        end = end_m < spray.first_m ? -1 : min(int(log(end_m / spray.first_m) / spray.row_step), last);
    float ratio = exp(spray.row_step);
    // The eye itself counts as a row before the first.
    int row = -1;
    float high_m = spray.top_m + kSprayHigh * spray.scale_m;
    if (slope < 0.0f && spray.eye_m > high_m) {
        float from_m = (high_m - spray.eye_m) / slope;
        if (from_m > spray.first_m) row = min(int(log(from_m / spray.first_m) / spray.row_step), end);
    }
    float at_m = row < 0 ? 0.0f : spray.first_m * exp(spray.row_step * float(row));
    vec4 here = spray_between(column, max(row, 0));
    float lift = spray_lift_between(column, max(row, 0));
    // The map's cells don't resolve all waves. A ray that ends on the surface ends at height 0. The row before its end
    // is moved by the same height, and the one before that the more, the nearer the end is to the last row.
    vec4 ends = vec4(0.0f);
    float ends_lift = 0.0f;
    float ends_z = 0.0f;
    float astray = 0.0f;
    float astray_before = 0.0f;
    if (!is_endless) {
        vec4 before = spray_between(column, max(end, 0));
        vec4 behind = spray_between(column, min(end + 1, last));
        float before_m = spray.first_m * exp(spray.row_step * float(max(end, 0)));
        float part = end < 0 ? 0.0f : clamp((end_m - before_m) / (before_m * (ratio - 1.0f)), 0.0f, 1.0f);
        ends = mix(before, behind, part);
        ends_lift = mix(spray_lift_between(column, max(end, 0)), spray_lift_between(column, min(end + 1, last)), part);
        ends_z = (spray.eye_m + slope * end_m - ends.x) / spray.scale_m;
        if (on_sea) {
            astray = end < last ? ends_z : 0.0f;
            astray_before = astray * (1.0f - part);
            ends_z = 0.0f;
        }
    }
    float off = row < 0 || row < end - 1 ? 0.0f : row == end ? astray : astray_before;
    SprayPlace a = spray_place(here, lift, (spray.eye_m + slope * at_m - here.x) / spray.scale_m - off, spray);
    SprayLight light = spray_light_along(ray, spray);
    SprayPath path = SprayPath(1.0f, vec3(0.0f));
    float above = spray_column(a, spray);
    float rise_per_m = slope * across / spray.scale_m;
    bool has_left = false;
    while (row < end) {
        ++row;
        float next_m = row == 0 ? spray.first_m : at_m * ratio;
        here = spray_between(column, row);
        lift = spray_lift_between(column, row);
        off = row < end - 1 ? 0.0f : row == end ? astray : astray_before;
        SprayPlace b = spray_place(here, lift, (spray.eye_m + slope * next_m - here.x) / spray.scale_m - off, spray);
        float length_m = (next_m - at_m) / across;
        float next_above = spray_column(b, spray);
        path = spray_behind(path, light, spray_mean_of(a, b, at_m * ahead, next_m * ahead, spray) * length_m,
                            0.5f * (above + next_above));
        rise_per_m = (b.point.z - a.point.z) / length_m;
        at_m = next_m;
        a = b;
        above = next_above;
        has_left = slope > 0.0f && spray.eye_m + slope * at_m > high_m;
        if (has_left) break;
    }
    if (has_left) return path;
    if (!is_endless) {
        SprayPlace b = spray_place(ends, ends_lift, ends_z, spray);
        return spray_behind(path, light, spray_mean_of(a, b, at_m * ahead, end_m * ahead, spray) * max((end_m - at_m) / across, 0.0f),
                            0.5f * (above + spray_column(b, spray)));
    }
    // Beyond the last row the ray goes on rising over a sea like that there.
    return spray_behind(path, light, above / (max(rise_per_m, 1.0e-6f) * spray.scale_m), 0.5f * above);
}
