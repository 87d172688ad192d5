// The floor that is seen through the water: how deep it lies where the eye looks, what it reflects there, and how the waves above
// gather the sun's light on it (floor.h). The includer defines
//   float floor_value(int i)    of the floor's maps
// All places are relative to the eye, in level axes.

struct FloorView {
    bool is_seen;     // there are places from which to look; otherwise the floor is level and evenly lit
    float z_m;        // of a floor without a map
    float curvature_per_m;  // of the earth
    float pixel;      // tangent that a pixel of the eye's covers
    float lowest_m;   // nowhere is it lower
    vec4 depths;      // its map: corner, columns and rows (0: none)
    vec4 depths_per_m;  // columns and rows per metre; the height of the sea at rest; first value
    vec4 colours;     // picture, repeated: where in it the eye is, times its texels; texels per metre; texels a side (0: none)
    float colours_first;
    vec4 light;       // map of the sun's light on it: corner; texels per metre; texels a side (0: none)
    vec4 coarse;      // the same at kFloorLightStep of these texels: corner; first value of both; how much of it counts
    vec4 shafts;      // map of the sun's light on a level plane in the water: corner; texels per metre; how deep the plane lies
    vec3 shafts_look;  // its first value; texels a side (0: none); how much of it counts
};

struct SeenFloor {
    float depth_m;  // below the place of the surface through which it is seen
    vec3 colour;    // times water.floor_colour
    float light;    // times the sun's light on it
};

const float kFloorLightStep = 4.0f;  // texels of the coarser map over those of the finer
// Over which a map gives way to what is around it: of the floor's light, whose end is seen where waves gather much, a part of its side; of the
// shafts', texels.
const float kFloorLightEdge = 0.25f;
const float kShaftsEdge = 16.0f;
const float kLeastFloor_m = 0.01f;    // a trough touches the floor
const int kFloorSteps = 8;            // towards a mapped floor, and as many back: to a millimetre over a slope of 5 (floor_test.cpp)
const float kFarFloor_m = 3.0e4f;     // how far a parabola stands for the earth, to a centimetre

// Between four texels of a map of that many columns; place in texels, whose middles are at halves.
float floor_between(vec2 place, int columns, int rows, int first) {
    vec2 at = place - 0.5f;
    vec2 low = floor(at);
    vec2 t = at - low;
    int x0 = clamp(int(low.x), 0, columns - 1);
    int x1 = clamp(int(low.x) + 1, 0, columns - 1);
    int y0 = first + columns * clamp(int(low.y), 0, rows - 1);
    int y1 = first + columns * clamp(int(low.y) + 1, 0, rows - 1);
    return mix(mix(floor_value(y0 + x0), floor_value(y0 + x1), t.x), mix(floor_value(y1 + x0), floor_value(y1 + x1), t.x), t.y);
}

// Height of the floor at a place, from the eye. Beyond the map it goes from its nearest edge to the level floor, within a quarter of its size.
float floor_height(vec2 place, FloorView of) {
    if (!(of.depths.z > 0.0f)) return of.z_m;
    vec2 size = vec2(of.depths.z, of.depths.w);
    vec2 at = (place - vec2(of.depths.x, of.depths.y)) * vec2(of.depths_per_m.x, of.depths_per_m.y);
    vec2 nearest = clamp(at, vec2(0.0f), size);
    vec2 beyond = 4.0f * (at - nearest) / size;
    float mapped = of.depths_per_m.z - floor_between(nearest, int(size.x), int(size.y), int(of.depths_per_m.w));
    return mix(mapped, of.z_m, smoothstep(0.0f, 1.0f, length(beyond)));
}

// How much a map of n × n texels counts at a place in it: all, and nothing from its edge on.
float floor_light_share(vec2 at, float n, float edge) {
    vec2 inside = min(at, vec2(n) - at) - 1.0f;
    return smoothstep(0.0f, edge, min(inside.x, inside.y));
}

// The sun's light on the floor over what a level sea lets fall there. width_m: over which it is seen as one. Maps are of texels
// that are as wide: between them, and beyond the coarser one, it is even.
float floor_light(vec2 place, float width_m, FloorView of) {
    if (!(of.light.w > 0.0f)) return 1.0f;
    float n = of.light.w;
    int side = int(n);
    int first = int(of.coarse.z);
    float octaves = 0.5f * log2(max(width_m * of.light.z, 1.0f));  // in steps of the maps
    float light = 1.0f;
    vec2 at = (place - vec2(of.coarse.x, of.coarse.y)) * (of.light.z / kFloorLightStep);
    float share = floor_light_share(at, n, kFloorLightEdge * n) * clamp(2.0f - octaves, 0.0f, 1.0f);
    if (share > 0.0f) light = mix(1.0f, floor_between(at, side, side, first + side * side), share);
    at = (place - vec2(of.light.x, of.light.y)) * of.light.z;
    share = floor_light_share(at, n, kFloorLightEdge * n) * clamp(1.0f - octaves, 0.0f, 1.0f);
    if (share > 0.0f) light = mix(light, floor_between(at, side, side, first), share);
    return max(1.0f + of.coarse.w * (light - 1.0f), 0.0f);
}

// The light of the shafts' map at a place of its plane, as floor_light(), seen over that width. Levels follow one another, each half as fine:
// the two beside the width are mixed, and beyond the map light is even.
float shaft_light(vec2 place, float width_m, FloorView of) {
    int side = int(of.shafts_look.y);
    int first = int(of.shafts_look.x);
    vec2 at = (place - vec2(of.shafts.x, of.shafts.y)) * of.shafts.z;
    float share = floor_light_share(at, of.shafts_look.y, kShaftsEdge);
    if (!(share > 0.0f)) return 1.0f;
    float level = log2(max(width_m * of.shafts.z, 1.0f));
    while (level >= 1.0f && side > 1) {
        first += side * side;
        side /= 2;
        at *= 0.5f;
        level -= 1.0f;
    }
    float light = floor_between(at, side, side, first);
    if (side > 1) light = mix(light, floor_between(0.5f * at, side / 2, side / 2, first + side * side), clamp(level, 0.0f, 1.0f));
    return mix(1.0f, light, share);
}

// The picture's colour at a place, where a pixel is that wide: of its levels, each half as fine, the two beside it. Levels follow one
// another, a texel's red, green and blue a plane each.
vec3 floor_colour_level(vec2 at, int side, int first) {
    vec2 low = floor(at - 0.5f);
    vec2 t = at - 0.5f - low;
    int most = side - 1;  // sides are powers of two
    int x0 = int(low.x) & most;
    int x1 = (int(low.x) + 1) & most;
    int y0 = (int(low.y) & most) * side;
    int y1 = ((int(low.y) + 1) & most) * side;
    vec3 colour = vec3(0.0f);
    for (int i = 0; i < 3; ++i) {
        int plane = first + i * side * side;
        colour[i] = mix(mix(floor_value(plane + y0 + x0), floor_value(plane + y0 + x1), t.x),
                        mix(floor_value(plane + y1 + x0), floor_value(plane + y1 + x1), t.x), t.y);
    }
    return colour;
}

vec3 floor_colour(vec2 place, float width_m, FloorView of) {
    if (!(of.colours.w > 0.0f)) return vec3(1.0f);
    int side = int(of.colours.w);
    int first = int(of.colours_first);
    vec2 at = vec2(of.colours.x, of.colours.y) + place * of.colours.z;
    float level = log2(max(width_m * of.colours.z, 1.0f));
    while (level >= 1.0f && side > 1) {
        first += 3 * side * side;
        side /= 2;
        at *= 0.5f;
        level -= 1.0f;
    }
    vec3 colour = floor_colour_level(at, side, first);
    if (side > 1) colour = mix(colour, floor_colour_level(0.5f * at, side / 2, first + 3 * side * side), clamp(level, 0.0f, 1.0f));
    return colour;
}

// As wide as what a pixel mixes of the floor: its width and long axis on the surface. Half the long axis is more than a square's side where it
// is long, and shows less than is there rather than flicker.
float pixel_over(vec3 pixel) {
    return max(pixel.x, 0.5f * sqrt(pixel.y * pixel.y + pixel.z * pixel.z));
}

bool is_floor_near(vec3 surface, FloorView of) {
    return of.is_seen && surface.x * surface.x + surface.y * surface.y < kFarFloor_m * kFarFloor_m;
}

// Along a ray in the water from a place of the surface, down by 1 a unit: `along` is its way across by then. blur: over a depth of 1, the
// width of what unresolved waves mix; pixel_m: a pixel's width on the surface.
SeenFloor seen_floor(vec3 surface, vec2 along, float blur, float pixel_m, FloorView of) {
    vec2 from = vec2(surface.x, surface.y);
    float height = surface.z + 0.5f * of.curvature_per_m * dot(from, from);
    float depth = max(height - floor_height(from, of), kLeastFloor_m);
    if (of.depths.z > 0.0f) {
        // How far the ray is above the floor where it is so deep: the first of some depths at which it is below, and from there back by straight
        // lines, where the end that stays counts half (Illinois).
        float most = max(height - of.lowest_m, 2.0f * kLeastFloor_m);
        float least = 0.0f;
        float above = depth;
        float below = -1.0e-6f;
        float deepest = most;
        for (int i = 1; i <= kFloorSteps; ++i) {
            depth = deepest * (float(i * i) / float(kFloorSteps * kFloorSteps));
            float there = height - depth - floor_height(from + depth * along, of);
            if (there <= 0.0f || i == kFloorSteps) {
                most = depth;
                below = min(there, -1.0e-6f);
                break;
            }
            least = depth;
            above = there;
        }
        for (int i = 0; i < kFloorSteps; ++i) {
            depth = (least * below - most * above) / (below - above);
            float there = height - depth - floor_height(from + depth * along, of);
            if (there > 0.0f) {
                least = depth;
                above = there;
                below *= 0.5f;
            } else {
                most = depth;
                below = min(there, -1.0e-6f);
                above *= 0.5f;
            }
        }
        depth = max(depth, kLeastFloor_m);
    }
    vec2 place = from + depth * along;
    float width = sqrt(pixel_m * pixel_m + blur * blur * depth * depth);
    return SeenFloor(depth, floor_colour(place, width, of), floor_light(place, width, of));
}
