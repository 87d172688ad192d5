// What foam looks like from near: a dense, rough roller where waves break, then lace, torn and bent, with round holes of many sizes
// that grow as bubbles burst and a film between its threads, drawn out along the wind. Pixels that don't resolve the pattern show the
// coverage.
//
// The pattern is a sum of layers. Each has the normal distribution with variance 1 at a random place, and they are
// independent, so that the sum with weights whose squares add up to 1 has it too. Foam is thick where the sum is high: it hides the part
// Φ((s − q √(1 + σ²))/σ) of a place, of softness σ, where q is the quantile of what it hides of the sea: so do its threads, which are
// crisp, and its film, which is soft. Of each layer a pixel
// resolves the weight w that its footprint lets through, together a sum s of variance v. The rest is normal with variance 1 − v, and
// adds that to σ². The mean over the sea is Φ(−q): at any distance, for any age, and for any strength of the pattern, which
// only scales w.
//
// Layers are fixed to the water at rest, on grids of integer cells whose sizes are halves of one another. Age moves weight
// from one to the next. kFoamCell_m (foam_structure.h) is the largest cell's size across the wind.
//
// The includer defines, besides:
//   float foam_image_texel(int x, int y)    of the artist's picture, where there is one

struct FoamPattern {
    vec3 cell;  // the largest cell that the origin of the points is in: along the wind, along it in streaks, across; whole, modulo 65536
    vec3 rest;  // 0 … 1, where in it
    vec4 axes;  // the wind's direction; cells per metre along it, and the same in streaks
    vec4 look;  // structure; streaks; the opacity of foam where waves break, and of what they leave
    vec2 white;  // what these reflect where they are opaque
    // The artist's picture (foam_image.h): texels a side, 0: none; tiles per metre; where in a tile the origin is, along the wind and
    // across it.
    vec4 image;
};

// What a pixel shows of foam: the share of the pixel that it hides, and what that reflects.
struct SeenFoam {
    float opacity;
    float white;
    float slope;  // of its relief, rising towards the sun
};

const float kFoamGrain = 0.03f;    // the part of the pattern's variance that is never resolved, which softens edges
const float kFaintFoam = 1.0e-3f;  // less coverage than this begins to lose its pattern, which nobody would see

SeenFoam no_foam() {
    return SeenFoam(0.0f, kWhiteFoam, 0.0f);
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

// A place on a layer's grid: the cell, and the place in it.
struct FoamCell {
    uint x;
    uint y;
    uint most;  // cells have numbers up to this, then from 0 again, so that there is no seam
    vec2 rest;
};

uint foam_hash(FoamCell at, int right, int up, uint layer) {
    uint x = (at.x + uint(right)) & at.most;
    uint y = (at.y + uint(up)) & at.most;
    uint h = (x * 0x9E3779B1u) ^ (y * 0x85EBCA77u + layer * 0xC2B2AE3Du);
    h = (h ^ (h >> 15u)) * 0x2C1B3C6Du;
    h = (h ^ (h >> 12u)) * 0x297A2D39u;
    return h ^ (h >> 15u);
}

// `halvings` from the largest cells, moved by some of its own. turned: by 45°, cells √2 times as small, so that layers don't show
// one grid.
FoamCell foam_cell(vec2 cell, vec2 rest, int halvings, vec2 moved, bool turned) {
    float finer = float(1 << halvings);
    vec2 place = rest * finer + moved;
    uint x = uint(cell.x) * uint(finer);
    uint y = uint(cell.y) * uint(finer);
    if (turned) {
        place = vec2(place.x + place.y, place.y - place.x);
        uint sum = x + y;
        y = y - x;
        x = sum;
    }
    vec2 low = floor(place);
    // Patterns repeat after 65536 of the largest cells, 2000 km.
    uint most = (65536u << uint(halvings)) - 1u;
    return FoamCell(x + uint(int(low.x)), y + uint(int(low.y)), most, place - low);
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
        uint h = foam_hash(at, x, y, layer);
        float bytes = float((h & 255u) + ((h >> 8u) & 255u) + ((h >> 16u) & 255u) + (h >> 24u));
        sum += weight * (bytes - 510.0f);
        squares += weight * weight;
    }
    return sum * inversesqrt(squares * 21845.0f);
}

// Round holes of random sizes: the distance from the nearest hole's middle, over its radius. Made normal, variance 1, least in the
// holes: a fit to its distribution at random places, within 0.005 of it.
float foam_holes(FoamCell at, uint layer) {
    float nearest = 9.0f;
    for (int i = 0; i < 9; ++i) {
        int x = i % 3 - 1;
        int y = i / 3 - 1;
        uint h = foam_hash(at, x, y, layer);
        // 0.66: no farther from their cells' middles than lets nine cells hold all that is nearer than `farthest`.
        float dx = float(x) + 0.5f + 0.66f * (float(h & 1023u) / 1024.0f - 0.5f) - at.rest.x;
        float dy = float(y) + 0.5f + 0.66f * (float((h >> 10u) & 1023u) / 1024.0f - 0.5f) - at.rest.y;
        float radius = 0.45f + 0.55f * (float(h >> 20u) / 4096.0f);
        nearest = min(nearest, (dx * dx + dy * dy) / (radius * radius));
    }
    float farthest = 1.17f;
    float s = min(sqrt(nearest), farthest);
    return -3.041654f + s * (11.212288f + s * (-23.509151f + s * (36.653262f + s * (-27.733232f + s * 8.195414f))));
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

// A level of the artist's picture at a place in its tile, between its texels.
float foam_image_at(int side, vec2 place, int level) {
    int texels = side >> level;
    vec2 at = place * float(texels) - 0.5f;
    vec2 low = floor(at);
    vec2 t = at - low;
    int row = 2 * side - 2 * texels;
    int x0 = int(low.x) & (texels - 1);
    int x1 = (x0 + 1) & (texels - 1);
    int y0 = int(low.y) & (texels - 1);
    int y1 = row + ((y0 + 1) & (texels - 1));
    y0 += row;
    return mix(mix(foam_image_texel(x0, y0), foam_image_texel(x1, y0), t.x), mix(foam_image_texel(x0, y1), foam_image_texel(x1, y1), t.x),
               t.y);
}

// The artist's picture. clouds: of variance 1, some tiles large, so that no two tiles show the same foam.
FoamNoise foam_image_noise(FoamPattern pattern, float along, float across, float footprint_m, float clouds) {
    const float kClouds = 0.15f;
    int side = int(pattern.image.x);
    vec2 place = vec2(pattern.image.z, pattern.image.w) + pattern.image.y * vec2(along, across);
    place -= floor(place);
    float most = log2(pattern.image.x);
    float finest = clamp(log2(max(footprint_m * pattern.image.y * pattern.image.x, 1.0f)), 0.0f, most);
    int level = min(int(finest), int(most + 0.5f) - 1);
    float t = finest - float(level);
    // What a coarser level shows is a part of what the finer one does: of their blend the variance is that part's, and of the rest's
    // the finer one's share, squared.
    float shown = mix(foam_image_at(side, place, level), foam_image_at(side, place, level + 1), t);
    float variance =
        mix(foam_image_texel(level + 1, 2 * side - 1), foam_image_texel(level, 2 * side - 1), (1.0f - t) * (1.0f - t));
    float through = foam_weight(float(kFoamCell_m), footprint_m);
    float picture = 1.0f - kFoamGrain - kClouds;
    return FoamNoise(sqrt(picture) * shown + sqrt(kClouds) * through * clouds, picture * variance + kClouds * through * through);
}

// Where in the pattern a point is.
struct PatternPlace {
    vec2 wind_m;  // along the wind and across it, from the origin that the pattern was made for
    vec3 cell;    // as FoamPattern's
    vec3 rest;
};

// rest_m: relative to that origin.
PatternPlace pattern_place(FoamPattern pattern, vec2 rest_m) {
    float along = pattern.axes.x * rest_m.x + pattern.axes.y * rest_m.y;
    float across = pattern.axes.x * rest_m.y - pattern.axes.y * rest_m.x;
    vec3 place = pattern.rest + vec3(pattern.axes.z * along, pattern.axes.w * along, across / float(kFoamCell_m));
    vec3 whole = floor(place);
    vec3 cell = pattern.cell + whole;
    return PatternPlace(vec2(along, across), cell - 65536.0f * floor(cell / 65536.0f), place - whole);
}

// footprint_m: on the water at rest.
FoamNoise foam_noise(FoamPattern pattern, vec2 rest_m, float footprint_m, float age_s) {
    PatternPlace at = pattern_place(pattern, rest_m);
    vec2 cells = vec2(at.cell.x, at.cell.z);
    vec2 rest = vec2(at.rest.x, at.rest.z);

    if (pattern.image.x > 0.0f)
        return foam_image_noise(pattern, at.wind_m.x, at.wind_m.y, footprint_m,
                                foam_clouds(foam_cell(cells, rest, 0, vec2(0.0f), false), 70u));

    float old = age_s / (age_s + 3.0f);
    float young = exp(-age_s / 1.2f);
    float streaks = min(pattern.look.y * (0.1f + 0.85f * old), 0.65f);
    // What breaks is thick: its edges are torn, and holes come with age.
    float bubbles = 0.11f - 0.07f * young;
    float lace = (0.6f - 0.43f * young) * (1.0f - kFoamGrain - bubbles - streaks);
    float clouds = 1.0f - kFoamGrain - streaks - bubbles - lace;

    FoamNoise noise = FoamNoise(0.0f, 0.0f);
    // What turbulence bends, in metres: lace; and patches, whose edges would else be as straight as the grid's cells are long.
    vec2 bent = vec2(0.0f);
    vec2 ragged = vec2(0.0f);
    if (foam_weight(8.0f, footprint_m) > 0.0f) {
        ivec3 halvings = ivec3(4, 6, 7);  // 2, 1/2 and 1/4 m
        vec3 reach_m = vec3(0.34f, 0.1f, 0.045f);
        vec3 ragged_m = vec3(0.4f, 0.24f, 0.11f);
        for (int k = 0; k < 3; ++k) {
            FoamCell cell = foam_cell(cells, rest, halvings[k], vec2(0.0f), false);
            vec2 by = vec2(foam_clouds(cell, uint(101 + 2 * k)), foam_clouds(cell, uint(102 + 2 * k)));
            bent += reach_m[k] * by;
            ragged += ragged_m[k] * by;
        }
    }
    // Holes of one size, and smaller ones between. The largest begin at 1/4 m, and grow by 0.8 octaves for each doubling of
    // 1 s + age.
    float octave = min(1.2f + 0.8f * log2(1.0f + age_s), 5.0f);
    float all = 0.0f;
    float lace_shown = 0.0f;
    float lace_variance = 0.0f;
    for (int k = max(int(floor(octave)) - 4, -2); k <= int(floor(octave)) + 1; ++k) {
        float finer = octave - float(k);
        float weight = max(1.0f - abs(finer), 0.0f) + 0.6f * max(1.0f - abs(finer - 1.0f), 0.0f) +
                       0.42f * max(1.0f - abs(finer - 2.0f), 0.0f) + 0.3f * max(1.0f - abs(finer - 3.0f), 0.0f) +
                       0.25f * max(1.0f - abs(finer - 4.0f), 0.0f);
        all += weight * weight;
        float size_m = 0.03125f * float(1 << (k + 2));
        float through = weight * foam_weight(size_m, footprint_m);
        if (through > 0.0f) {
            lace_shown += through * foam_holes(foam_cell(cells, rest, 8 - k, bent / size_m, (k & 1) == 1), uint(k));
            lace_variance += through * through;
        }
    }
    noise.shown += sqrt(lace / all) * lace_shown;
    noise.variance += lace / all * lace_variance;

    // Bubbles from 1/16 m down, so that right before the lens edges are those of bubbles and not of a soft picture.
    vec3 of_bubbles = bubbles * vec3(0.45f, 0.32f, 0.23f);
    for (int k = 0; k < 3; ++k) {
        float size_m = 0.0625f / float(1 << k);
        float fine = foam_weight(size_m, footprint_m);
        if (fine > 0.0f) {
            noise.shown += sqrt(of_bubbles[k]) * fine *
                           foam_holes(foam_cell(cells, rest, 9 + k, 0.5f * bent / size_m, k != 1), uint(60 + k));
            noise.variance += of_bubbles[k] * fine * fine;
        }
    }
    // Patches down to the roller's own ragged edge.
    ivec4 halvings = ivec4(3, 5, 6, 8);  // 4, 1, 1/2 and 1/8 m
    vec4 parts = clouds * mix(vec4(0.35f, 0.3f, 0.2f, 0.15f), vec4(0.25f, 0.43f, 0.22f, 0.1f), young);
    for (int k = 0; k < 4; ++k) {
        float size_m = float(kFoamCell_m) / float(1 << halvings[k]);
        float part = parts[k];
        float through = foam_weight(size_m, footprint_m);
        if (part * through > 0.0f) {
            noise.shown += sqrt(part) * through * foam_clouds(foam_cell(cells, rest, halvings[k], ragged / size_m, (k & 1) == 1), uint(54 + k));
            noise.variance += part * through * through;
        }
    }
    // Langmuir's cells, of all sizes (a few metres to a hundred between rows, Leibovich 1983): they meander, and rows of several sizes
    // meet at sharp angles, since smaller ones are moved less.
    if (streaks > 0.0f && foam_weight(32.0f, footprint_m) > 0.0f) {
        float meander_m = 5.0f * foam_clouds(foam_cell(cells, rest, 0, vec2(0.0f), false), 90u);
        for (int k = 0; k < 3; ++k) {
            float size_m = k == 0 ? 32.0f : k == 1 ? 8.0f : 2.0f;
            float part = (k == 1 ? 0.4f : 0.3f) * streaks;
            float through = foam_weight(size_m, footprint_m);
            if (part * through > 0.0f) {
                float aside_m = bent.y + (k == 2 ? 0.5f : 1.0f) * meander_m;
                FoamCell cell = foam_cell(vec2(at.cell.y, at.cell.z), vec2(at.rest.y, at.rest.z), 2 * k, vec2(0.0f, aside_m / size_m), false);
                noise.shown += sqrt(part) * through * foam_clouds(cell, uint(50 + k));
                noise.variance += part * through * through;
            }
        }
    }
    return noise;
}

// What a pixel hides of the sea, of which a layer of foam hides the share `mean`: where the pattern is high it is thick, and no place
// has an edge. Thickness is spread by `softness`, as by a normal variable of its own, so that the mean over the sea is Φ(−q),
// whatever a pixel resolves.
float foam_layer(FoamNoise noise, float mean, float softness) {
    float soft = softness * softness;
    float level = foam_quantile(mean) * sqrt(1.0f + soft);
    return normal_below((noise.shown - level) * inversesqrt(1.0f - noise.variance + soft));
}

// Foam is threads and a film between and around them, through which one sees the water. The film hides at most `thin` of a place, and is
// there on nearly twice what foam hides of the sea, mean · (2 − mean): the threads hide the rest, so that both together hide `mean`.
// thin < ½: both grow with the mean everywhere. What is young is dense, and ends in lace; with age the film takes over.
const float kThreadSoftness = 0.25f;
const float kYoungSoftness = 0.48f;  // full of air: its edges are lace, no cut
const float kFilmSoftness = 0.8f;
const float kYoungThin = 0.1f;
const float kThinner = 0.32f;  // with age

float foam_thin(float age_s) {
    return kYoungThin + kThinner * age_s / (age_s + 3.0f);
}

float foam_opacity_in(FoamNoise noise, float mean, float thin) {
    float film = mean * (2.0f - mean);
    float threads = (mean - thin * film) / (1.0f - thin);
    float young = 1.0f - (thin - kYoungThin) * (1.0f / kThinner);
    float softness = mix(kThreadSoftness, kYoungSoftness, young * young * young);
    return thin * foam_layer(noise, film, kFilmSoftness) + (1.0f - thin) * foam_layer(noise, threads, softness);
}

// Bubbles lie in heaps: thin foam, and hollows, reflect that much less than the mean. So much light the upper part of the pattern has
// in addition that the mean over the sea of what foam reflects is `white`. No foam reflects more than 0.95.
const float kHollows = 0.75f;
const float kHeaps = 0.7f;  // the part of what is hidden that heaps hide

SeenFoam foam_in(FoamNoise noise, float mean, float white, float thin) {
    if (!(mean > 0.0f)) return SeenFoam(0.0f, white, 0.0f);
    float opacity = foam_opacity_in(noise, mean, thin);
    float hollows = clamp((0.95f / max(white, 1.0e-3f) - 1.0f) * (kHeaps / (1.0f - kHeaps)), 0.0f, kHollows);
    float heaps = foam_opacity_in(noise, kHeaps * mean, thin) / (kHeaps * max(opacity, 1.0e-12f));
    return SeenFoam(opacity, white * (1.0f + hollows * (min(heaps, 1.0f / kHeaps) - 1.0f)), 0.0f);
}

// Where pixels are too large for heaps and relief foam isn't of one tone: patches of all sizes are thicker or thinner, and lean to the sun
// or from it. Of those some times as large as the pixel, up to the largest cells, the tone is even over −1 … 1: its mean is 0.
const float kTonePixels = 5.0f;
const float kTone = 0.4f;

float foam_tone(FoamPattern pattern, vec2 rest_m, float footprint_m) {
    float octave = log2(float(kFoamCell_m) / (kTonePixels * footprint_m));
    float fade = smoothstep(0.2f, 0.8f, footprint_m) * smoothstep(-1.5f, 0.0f, octave);
    if (!(fade > 0.0f)) return 0.0f;
    PatternPlace at = pattern_place(pattern, rest_m);
    octave = clamp(octave, 0.0f, 7.0f);
    int coarse = min(int(octave), 6);
    float t = octave - float(coarse);
    float sum = 0.0f;
    for (int k = coarse; k < coarse + 2; ++k)
        sum += (k == coarse ? 1.0f - t : t) *
               foam_clouds(foam_cell(vec2(at.cell.x, at.cell.z), vec2(at.rest.x, at.rest.z), k, vec2(0.0f), k % 2 == 1), uint(80 + k));
    return fade * (2.0f * normal_below(sum * inversesqrt((1.0f - t) * (1.0f - t) + t * t)) - 1.0f);
}

// The relief of what breaks: lumps of all sizes on one another, each octave as steep as the others, so that it is shaded softly and a
// nearer view shows finer lumps. It is no part of what foam hides: thick foam has it without a hole. Its facets are as steep as their own
// roughness has it (kFoamSlopeVariance), no steeper.
const float kLumpRelief = 0.09f;  // a lump's height over its breadth
const float kSteepestRelief = 0.6f;
const float kLumpTone = 0.2f;  // hollows between lumps see less of the sky, and lumps more

// x: the slope, rising towards the sun (a unit vector or none); y: the height in deviations of what a pixel resolves of it, and 0
// where it resolves nothing.
vec2 foam_lumps(FoamPattern pattern, vec2 rest_m, float footprint_m, vec2 to_sun) {
    PatternPlace here = pattern_place(pattern, rest_m);
    float slope = 0.0f;
    float height = 0.0f;
    float all = 0.0f;
    for (int k = 5; k < 10; ++k) {  // 1 … 1/16 m
        float size_m = float(kFoamCell_m) / float(1 << k);
        float through = foam_weight(size_m, footprint_m);
        if (!(through > 0.0f)) return vec2(slope, height * inversesqrt(max(all, 1.0f)));
        PatternPlace ahead = pattern_place(pattern, rest_m + 0.25f * size_m * to_sun);
        bool turned = k % 2 == 1;
        uint layer = uint(110 + k);
        float at = foam_clouds(foam_cell(vec2(here.cell.x, here.cell.z), vec2(here.rest.x, here.rest.z), k, vec2(0.0f), turned), layer);
        float then = foam_clouds(foam_cell(vec2(ahead.cell.x, ahead.cell.z), vec2(ahead.rest.x, ahead.rest.z), k, vec2(0.0f), turned), layer);
        slope += through * (4.0f * kLumpRelief) * (then - at);
        height += through * at;
        all += through * through;
    }
    return vec2(slope, height * inversesqrt(max(all, 1.0f)));
}

// pixel_m: width and long axis on the water at rest. coverage: of the pixel, of all foam; breaking: of that where waves break now;
// age_s: since the rest broke, on average. sun: its direction, in the axes of rest_m.
SeenFoam seen_foam(FoamPattern pattern, vec2 rest_m, vec3 pixel_m, float coverage, float breaking, float age_s, vec3 sun) {
    float c = clamp(coverage, 0.0f, 1.0f);
    float fresh = clamp(breaking / max(c, 1.0e-12f), 0.0f, 1.0f);
    float opacity_fresh = fresh * pattern.look.z;
    float opacity_old = (1.0f - fresh) * pattern.look.w;
    float mean = opacity_fresh + opacity_old;
    float white = mean > 0.0f ? (opacity_fresh * pattern.white.x + opacity_old * pattern.white.y) / mean : kWhiteFoam;
    float strength = pattern.look.x * smoothstep(0.1f * kFaintFoam, kFaintFoam, c);
    if (!(strength > 0.0f)) return SeenFoam(c * mean, white, 0.0f);
    float footprint_m = foam_footprint(pixel_m);
    float since_s = (1.0f - fresh) * age_s;
    FoamNoise noise = foam_noise(pattern, rest_m, footprint_m, since_s);
    white *= 1.0f + clamp(0.95f / max(white, 1.0e-3f) - 1.0f, 0.0f, kTone * strength) * foam_tone(pattern, rest_m, footprint_m);
    if (!(noise.variance > 0.0f)) return SeenFoam(c * mean, white, 0.0f);
    noise = FoamNoise(strength * noise.shown, strength * strength * noise.variance);
    float relief = exp(-since_s / 1.2f);
    vec2 lumps = vec2(0.0f);
    if (relief * c > 1.0e-3f) {
        lumps = foam_lumps(pattern, rest_m, footprint_m, vec2(sun.x, sun.y) / max(sqrt(sun.x * sun.x + sun.y * sun.y), 1.0e-6f));
        white *= 1.0f + clamp(0.95f / max(white, 1.0e-3f) - 1.0f, 0.0f, kLumpTone * relief * strength) *
                            (2.0f * normal_below(lumps.y) - 1.0f);
    }
    SeenFoam seen = foam_in(noise, c * mean, white, foam_thin(since_s));
    // Where pixels are too large for lumps their slopes are lost. Foam is as high as bubbles are thrown up: what is old lies flat.
    if (relief * seen.opacity > 1.0e-3f) {
        float slope = strength * relief * lumps.x;
        seen.slope = kSteepestRelief * slope / sqrt(kSteepestRelief * kSteepestRelief + slope * slope);
    }
    return seen;
}
