// What foam looks like from near: dense where waves break, then a net of filaments whose holes grow as bubbles burst,
// drawn out along the wind. Pixels that don't resolve the pattern show the coverage.
//
// The pattern is a sum of layers. Each has the normal distribution with variance 1 at a random place, and they are
// independent, so that the sum with weights whose squares add up to 1 has it too. Foam lies where the sum is above
// the quantile q of the coverage c. Of each layer a pixel resolves the weight w that its footprint lets through,
// together a sum s of variance v. The rest is normal with variance 1 − v, so that the pixel's share of foam is Φ((s −
// q)/√(1 − v)). Its mean over the sea is Φ(−q) = c: at any distance, for any age, and for any strength of the
// pattern, which only scales w.
//
// Layers are fixed to the water at rest, on grids of integer cells whose sizes are halves of one another. Age moves weight
// from one to the next. kFoamCell_m (foam_structure.h) is the largest cell's size across the wind.

struct FoamPattern {
    vec3 cell;  // the largest cell that the origin of the points is in: along the wind, along it in streaks, across; whole, modulo 65536
    vec3 rest;  // 0 … 1, where in it
    vec4 axes;  // the wind's direction; cells per metre along it, and the same in streaks
    vec4 look;  // structure; streaks; the share of dense foam where waves break, and in what they leave
};

// What a pixel shows of foam: its share of the pixel, and what part of that is dense.
struct SeenFoam {
    float share;
    float dense;
};

const float kFoamGrain = 0.1f;     // the part of the pattern's variance that is never resolved, which softens edges
const float kThinFoam = 0.15f;     // dense foam in what looks thin
const float kFaintFoam = 1.0e-3f;  // less coverage than this begins to lose its pattern, which nobody would see

// Coverage without a pattern, of all ages.
SeenFoam plain_foam(float coverage) {
    return SeenFoam(coverage, kDenseFoam);
}

// The z that a normal variable exceeds with the chance p, 0 < p ≤ 0.5; p's relative error is 6e-6. Fitted in √(−2 ln p), which z
// approaches.
float upper_quantile(float p) {
    float t = sqrt(-2.0f * log(p));
    return (-2.8592809f + t * (-2.0491888f + t * (2.665461f + t * 0.96612375f))) /
           (1.0f + t * (2.7624817f + t * 0.96361591f));
}

float foam_quantile(float coverage) {
    float c = clamp(coverage, 1.0e-6f, 0.999999f);
    return c > 0.5f ? -upper_quantile(1.0f - c) : upper_quantile(c);
}

// Φ.
float normal_below(float z) {
    float a = 0.70710678f * abs(z);
    float outside = 0.5f * exp(-a * a) * erfcx(a);
    return z > 0.0f ? 1.0f - outside : outside;
}

uint foam_hash(uint x, uint y, uint layer) {
    uint h = (x * 0x9E3779B1u) ^ (y * 0x85EBCA77u + layer * 0xC2B2AE3Du);
    h = (h ^ (h >> 15u)) * 0x2C1B3C6Du;
    h = (h ^ (h >> 12u)) * 0x297A2D39u;
    return h ^ (h >> 15u);
}

// A place on a layer's grid: the cell, and the place in it.
struct FoamCell {
    uint x;
    uint y;
    vec2 rest;
};

// `halvings` from the largest cells, moved by some of its own.
FoamCell foam_cell(vec2 cell, vec2 rest, int halvings, vec2 moved) {
    float finer = float(1 << halvings);
    vec2 place = rest * finer + moved;
    vec2 low = floor(place);
    // Patterns repeat after 65536 of the largest cells, 2000 km.
    uint most = (65536u << uint(halvings)) - 1u;
    return FoamCell((uint(cell.x) * uint(finer) + uint(int(low.x))) & most,
                    (uint(cell.y) * uint(finer) + uint(int(low.y))) & most, place - low);
}

// Normal, variance 1: values at a grid's corners, each a sum of four bytes, and their smooth mean between, scaled to keep the variance.
float foam_clouds(FoamCell at, uint layer) {
    vec2 t = at.rest * at.rest * (3.0f - 2.0f * at.rest);
    float sum = 0.0f;
    float squares = 0.0f;
    for (int corner = 0; corner < 4; ++corner) {
        int x = corner & 1;
        int y = corner >> 1;
        float weight = (x == 1 ? t.x : 1.0f - t.x) * (y == 1 ? t.y : 1.0f - t.y);
        uint h = foam_hash(at.x + uint(x), at.y + uint(y), layer);
        float bytes = float((h & 255u) + ((h >> 8u) & 255u) + ((h >> 16u) & 255u) + (h >> 24u));
        sum += weight * (bytes - 510.0f);
        squares += weight * weight;
    }
    return sum * inversesqrt(squares * 21845.0f);
}

// Worley's cells: how much farther away the second nearest of random points is than the nearest one, 0 on the net between
// them. Made normal, variance 1, largest on the net: a fit to its distribution at random places, within 0.0013 of it.
float foam_net(FoamCell at, uint layer) {
    float first = 9.0f;
    float second = 9.0f;
    for (int i = 0; i < 9; ++i) {
        int x = i % 3 - 1;
        int y = i / 3 - 1;
        uint h = foam_hash(at.x + uint(x), at.y + uint(y), layer);
        // 0.84: no farther from their cells' middles than lets nine cells hold both points.
        float dx = float(x) + 0.5f + 0.84f * (float(h & 65535u) / 65536.0f - 0.5f) - at.rest.x;
        float dy = float(y) + 0.5f + 0.84f * (float(h >> 16u) / 65536.0f - 0.5f) - at.rest.y;
        float d = dx * dx + dy * dy;
        second = min(second, max(first, d));
        first = min(first, d);
    }
    float s = sqrt(max(sqrt(second) - sqrt(first), 0.0f));
    return 3.114043f +
           s * (-14.373566f + s * (39.047683f + s * (-73.364101f + s * (68.69483f - s * 26.567438f))));
}

// How coarse a pattern a pixel sees, from its width and long axis: between the two, since layers aren't filtered along one alone.
float foam_footprint(vec3 pixel_m) {
    float along = sqrt(pixel_m.y * pixel_m.y + pixel_m.z * pixel_m.z);
    return sqrt(pixel_m.x * max(along, pixel_m.x));
}

// What a footprint lets through of a layer.
float foam_weight(float size_m, float footprint_m) {
    return smoothstep(1.25f, 4.0f, size_m / max(footprint_m, 1.0e-6f));
}

struct FoamNoise {
    float shown;
    float variance;  // of what is resolved
};

// rest_m: relative to the origin that the pattern was made for. footprint_m: on the water at rest.
FoamNoise foam_noise(FoamPattern pattern, vec2 rest_m, float footprint_m, float age_s) {
    float along = pattern.axes.x * rest_m.x + pattern.axes.y * rest_m.y;
    float across = pattern.axes.x * rest_m.y - pattern.axes.y * rest_m.x;
    vec3 place = pattern.rest + vec3(pattern.axes.z * along, pattern.axes.w * along, across / float(kFoamCell_m));
    vec3 whole = floor(place);
    place -= whole;
    vec3 cell = pattern.cell + whole;
    cell -= 65536.0f * floor(cell / 65536.0f);
    vec2 cells = vec2(cell.x, cell.z);
    vec2 rest = vec2(place.x, place.z);

    float old = age_s / (age_s + 3.0f);
    float streaks = pattern.look.y * (0.15f + 0.35f * old);
    float bubbles = 0.06f;
    float nets = 1.0f - kFoamGrain - streaks - bubbles - 0.15f;
    float clouds = 0.15f;

    FoamNoise noise = FoamNoise(0.0f, 0.0f);
    // Bends the nets, in metres.
    vec2 bent = vec2(0.0f);
    float shown = foam_weight(4.0f, footprint_m);
    if (shown > 0.0f) {
        FoamCell slow = foam_cell(cells, rest, 4, vec2(0.0f));
        FoamCell fast = foam_cell(cells, rest, 6, vec2(0.0f));
        bent = 0.25f * vec2(foam_clouds(slow, 101u), foam_clouds(slow, 102u)) +
               0.06f * vec2(foam_clouds(fast, 103u), foam_clouds(fast, 104u));
    }
    // A net, and one with cells half as large at 0.55 of its weight. Cells begin at 1/4 and 1/8 m, and grow by 0.75
    // octaves for each doubling of 1 s + age.
    float octave = 1.0f + 0.75f * log2(1.0f + age_s);
    octave = min(octave, 5.0f);
    float all = 0.0f;
    float nets_shown = 0.0f;
    float nets_variance = 0.0f;
    for (int k = max(int(floor(octave)) - 1, 0); k <= int(floor(octave)) + 1; ++k) {
        float from = float(k) - octave;
        float weight = max(1.0f - abs(from), 0.0f) + 0.55f * max(1.0f - abs(from + 1.0f), 0.0f);
        all += weight * weight;
        float size_m = 0.125f * float(1 << k);
        float through = weight * foam_weight(size_m, footprint_m);
        if (through > 0.0f) {
            nets_shown += through * foam_net(foam_cell(cells, rest, 8 - k, bent / size_m), uint(k));
            nets_variance += through * through;
        }
    }
    noise.shown += sqrt(nets / all) * nets_shown;
    noise.variance += nets / all * nets_variance;

    float fine = foam_weight(1.0f / 16.0f, footprint_m);
    if (fine > 0.0f) {
        noise.shown += sqrt(bubbles) * fine * foam_clouds(foam_cell(cells, rest, 9, vec2(0.0f)), 60u);
        noise.variance += bubbles * fine * fine;
    }
    // Patches and streaks: a fifth of their variance in the finer ones.
    vec2 streak_cells = vec2(cell.y, cell.z);
    vec2 streak_rest = vec2(place.y, place.z);
    for (int k = 0; k < 4; ++k) {
        bool is_streak = k < 2;
        int halvings = k % 2 == 0 ? 3 : 5;
        float size_m = k % 2 == 0 ? 4.0f : 1.0f;
        float part = (is_streak ? streaks : clouds) * (k % 2 == 0 ? 0.6f : 0.4f);
        float through = foam_weight(size_m, footprint_m);
        if (part * through > 0.0f) {
            FoamCell at = foam_cell(is_streak ? streak_cells : cells, is_streak ? streak_rest : rest, halvings,
                                    vec2(0.0f, bent.y / size_m));
            noise.shown += sqrt(part) * through * foam_clouds(at, uint(50 + k));
            noise.variance += part * through * through;
        }
    }
    return noise;
}

// The share of a pixel where the pattern is above the quantile of the coverage.
float foam_above(FoamNoise noise, float coverage) {
    return normal_below((noise.shown - foam_quantile(coverage)) * inversesqrt(1.0f - noise.variance));
}

// What a pixel sees of a pattern whose foam has that dense part. Dense foam lies in the middle of the pattern's foam, thin foam
// at its edges: the mean of both stays.
SeenFoam foam_seen_in(FoamNoise noise, float coverage, float dense) {
    float share = foam_above(noise, coverage);
    float cores = clamp((dense - kThinFoam) / (1.0f - kThinFoam), 0.0f, 1.0f);
    float edge = min(kThinFoam, dense);
    float core = min(foam_above(noise, cores * coverage), share);
    return SeenFoam(share, share > 0.0f ? (core + edge * (share - core)) / share : dense);
}

// pixel_m: width and long axis on the water at rest. coverage: of the pixel, of all foam; breaking: of that where waves break now;
// age_s: since the rest broke, on average.
SeenFoam seen_foam(FoamPattern pattern, vec2 rest_m, vec3 pixel_m, float coverage, float breaking, float age_s) {
    float c = clamp(coverage, 0.0f, 1.0f);
    float fresh = clamp(breaking / max(c, 1.0e-12f), 0.0f, 1.0f);
    float dense = pattern.look.w + fresh * (pattern.look.z - pattern.look.w);
    float strength = pattern.look.x * smoothstep(0.1f * kFaintFoam, kFaintFoam, c);
    if (!(strength > 0.0f)) return SeenFoam(c, dense);
    FoamNoise noise = foam_noise(pattern, rest_m, foam_footprint(pixel_m), (1.0f - fresh) * age_s);
    if (!(noise.variance > 0.0f)) return SeenFoam(c, dense);
    return foam_seen_in(FoamNoise(strength * noise.shown, strength * strength * noise.variance), c, dense);
}
