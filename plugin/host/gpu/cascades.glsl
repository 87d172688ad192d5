// The cascades' fields at a point: the sums of evaluate() (core/evaluate), read from textures that SeaLayout
// describes. Needs the constants kCascades, kVessels (whose cascades come last), kCellLevels, kPixelLevels, kBreakingLevels, kChoppy, kCoverage, kRandomTiling and P, the
// spline's number of taps.

layout(std140) uniform SeaTables {
    // Indexed by level · kCascades + cascade, levels of footprints: of cells, then of pixels, then
    // of the waves that break. first.xy: the tile's first texel; .z: its number of nodes N, 0 where the filter lets
    // nothing through; .w: a multiple of N that makes node numbers positive.
    ivec4 tile_first[(kCellLevels + kPixelLevels + kBreakingLevels) * kTileCascades];
    ivec4 tile_origin[(kCellLevels + kPixelLevels + kBreakingLevels) * kTileCascades];  // .xy: node at or below the origin; .zw: which tile that is in, modulo 2³²
    vec4 tile_scale[(kCellLevels + kPixelLevels + kBreakingLevels) * kTileCascades];    // .xy: fraction; .zw: nodes/m, split
    vec4 levels[kCellLevels + kPixelLevels];  // .x: footprint [m]; .yz with masks, of pixels: what it leaves of m0 [m²], alone and mixed with the next
    // Four vectors per level of pixels: its unresolved moments (xx, xy, yy, xxxx), (xxxy, xxyy, xyyy, yyyy), and the
    // same eight mixed with the next level.
    vec4 unresolved_levels[4 * kPixelLevels];
    vec4 cascades[kTileCascades];  // .x: the largest round footprint that lets all of it pass whole [m]; .y: the key of its random tiling; .z: tiles per metre
    vec4 gusts[kGustRows + kMaskRows + kVesselRows * kVessels + kFrontRows + kCoastRows];  // gusts.glsl; then masks.glsl; then wakes.glsl; then fronts; then coast.glsl
};

// The cascades of the sea, first and end.
const ivec2 kSea = ivec2(0, kCascades - kVessels);

// A place from the middle of a vessel's tile, beyond which there are none of its waves.
vec2 from_tile(int vessel, vec2 rest_m) { return gusts[kGustRows + kMaskRows + kVesselRows * vessel].xy + rest_m; }
bool is_in_tile(int vessel, vec2 rest_m) {
    vec2 from_m = abs(from_tile(vessel, rest_m));
    return max(from_m.x, from_m.y) < gusts[kGustRows + kMaskRows + kVesselRows * vessel].z;
}

uniform vec2 finest_m;             // the finest footprints of cells and pixels; trains and gusts are filtered no finer
uniform sampler2D cell_fields;     // Height, Dx, Dy
uniform sampler2D pixel_fields;    // ηx, ηy, Dxx, Dyy
uniform sampler2D pixel_fields_2;  // Dxy; where tiles blend also Height, Dx, Dy
// What ellipses leave unresolved beyond round footprints (core/waves/ellipse_moments.h): a row for each width; two
// texels for each direction, the directions of a ratio side by side.
uniform sampler2D ellipse_table;

// A point's place between the levels of filtering: weight 1 − t for the lower one, t for the next. See evaluate.cpp.
struct LevelBlend {
    int lower;
    float t;
};

LevelBlend level_blend_of(int first, int count, float footprint_m) {
    if (count == 1 || !(footprint_m > levels[first].x)) return LevelBlend(0, 0.0);
    float wanted = min(footprint_m, levels[first + count - 1].x);
    int lower = 0;
    for (int i = 1; i < count - 1; ++i)
        if (wanted >= levels[first + i].x) lower = i;
    float below = levels[first + lower].x;
    return LevelBlend(lower, (wanted - below) / (levels[first + lower + 1].x - below));
}

struct Place {
    ivec2 texel;  // of the first tap
    vec2 rest;    // 0 … 1, from the node
};

// A point among a tile's nodes, counted from the tile that the origin is in.
struct Node {
    ivec2 node;  // at or below
    vec2 rest;   // 0 … 1, from there
};

Node node_in(int tile, SplitMetres x) {
    vec4 scale = tile_scale[tile];
    vec2 coarse = x.coarse * scale.z;
    vec2 middle = x.middle * scale.z;
    vec2 rest = fract(coarse) + fract(middle) + (x.fine * scale.z + x.whole * scale.w) + scale.xy;
    vec2 carry = floor(rest);
    ivec2 node = ivec2(floor(coarse)) + ivec2(floor(middle)) + ivec2(carry) + tile_origin[tile].xy;
    return Node(node, rest - carry);
}

Place place_of(int tile, Node at) {
    ivec4 first = tile_first[tile];
    ivec2 tap = at.node + (first.w - P / 2 + 1);
    return Place(first.xy + tap % first.z, at.rest);
}

vec4 spline_sum(sampler2D fields, ivec2 texel, float wx[P], float wy[P]) {
    vec4 sum = vec4(0.0);
    for (int j = 0; j < P; ++j) {
        vec4 row = vec4(0.0);
        for (int i = 0; i < P; ++i) row += wx[i] * texelFetch(fields, texel + ivec2(i, j), 0);
        sum += wy[j] * row;
    }
    return sum;
}

// A footprint kept within the levels, as in core/evaluate/footprints.h: width and long axis [m] given.
struct Footprint {
    LevelBlend blend;
    float width;
    float along;  // its length; 0: round
    vec2 axis;    // unit vector
};

Footprint footprint_of(int first, int count, vec3 given) {
    float whole = length(given.yz);
    float along = min(whole, levels[first + count - 1].x);
    float own = max(given.x, levels[first].x);
    if (count == 1 || !(along > own))
        return Footprint(level_blend_of(first, count, given.x), given.x, 0.0, vec2(1.0, 0.0));
    float width = max(own, along / kLongestEllipse);
    return Footprint(level_blend_of(first, count, width), width, along, given.yz / whole);
}

Taps taps_in(int cascade, Footprint footprint) {
    if (footprint.along == 0.0) return Taps(0.0, 0.5);
    return taps_of(max(footprint.width, cascades[cascade].x), footprint.along);
}

int last_tap(Taps taps) { return int(ceil(taps.reach - 0.5)); }

// The point's share in a tile. Both levels of a point have the same tile where they let all waves pass whole: it is
// then read once, with the lower level. r: 0 for the lower level, 1 for the next.
float share_in(int tile, int r, float t) {
    if (!(t > 0.0)) return r == 0 ? 1.0 : 0.0;
    bool both = tile_first[tile] == tile_first[r == 0 ? tile + kCascades : tile - kCascades];
    if (r == 0) return both ? 1.0 : 1.0 - t;
    return both ? 0.0 : t;
}

// The sums over all cascades, levels and taps of the fields in these textures; `second` only if it is wanted.
struct FieldSums {
    vec4 first;
    float second;
    float turn;  // Dyx − Dxy, where tiles blend
    vec3 values;  // with masks: Height, Dx, Dy
};

// The tiles that a point reads along an axis, as in core/evaluate/random_tiling.h: the cell that it lies in, and the side on
// which the other tile's cell lies.
struct TilingAxis {
    int cell;
    int side;
    BlendWeights weights;  // rate [1/m]
};

TilingAxis tiling_axis(int tile, int node, float rest, float cells_per_m) {
    ivec4 first = tile_first[tile];
    // Made positive, as node numbers are.
    int cell = (2 * (node + first.w) + first.z) / (2 * first.z) - first.w / first.z;
    float from_middle = (float(node - cell * first.z) + rest) / float(first.z);
    BlendWeights weights = blend_weights(abs(from_middle));
    weights.rate *= cells_per_m * (from_middle < 0.0 ? -1.0 : 1.0);
    return TilingAxis(cell, from_middle < 0.0 ? -1 : 1, weights);
}

// Adds a cascade's blended tiles at a point: `weight` times the fields, and with both textures the gradient of the
// blending weights in the derivatives.
FieldSums add_tiles(sampler2D first, sampler2D second, bool both, int tile, int cascade, Node at, float weight,
                     FieldSums sums) {
    TilingAxis x = tiling_axis(tile, at.node.x, at.rest.x, cascades[cascade].z);
    TilingAxis y = tiling_axis(tile, at.node.y, at.rest.y, cascades[cascade].z);
    float nodes = float(tile_first[tile].z);
    int columns = x.weights.next > 0.0 ? 2 : 1;
    int rows = y.weights.next > 0.0 ? 2 : 1;
    for (int copy = 0; copy < columns * rows; ++copy) {
        bool next_x = copy % columns == 1;
        bool next_y = copy / columns == 1;
        float weight_x = next_x ? x.weights.next : x.weights.own;
        float weight_y = next_y ? y.weights.next : y.weights.own;
        ivec2 cell = tile_origin[tile].zw + ivec2(x.cell + (next_x ? x.side : 0), y.cell + (next_y ? y.side : 0));
        TileOffset offset = tile_offset(uint(cascades[cascade].y), uint(cell.x), uint(cell.y));
        vec2 moved = nodes * vec2(offset.x, offset.y);
        vec2 whole = floor(moved);
        vec2 rest = at.rest + (moved - whole);
        vec2 carry = floor(rest);
        Place place = place_of(tile, Node(at.node + ivec2(whole + carry), rest - carry));
        float wx[P];
        float wy[P];
        bspline_weights(place.rest.x, wx);
        bspline_weights(place.rest.y, wy);
        float own = weight * weight_x * weight_y;
        sums.first += own * spline_sum(first, place.texel, wx, wy);
        if (!both) continue;
        vec4 beside = spline_sum(second, place.texel, wx, wy);
        float along_x = weight * (next_x ? x.weights.own : -x.weights.next) * x.weights.rate * weight_y;
        float along_y = weight * (next_y ? y.weights.own : -y.weights.next) * y.weights.rate * weight_x;
        sums.first += vec4(along_x * beside.y, along_y * beside.y, along_x * beside.z, along_y * beside.w);
        if (kMasks > 0) sums.values += own * beside.yzw;
        sums.second += own * beside.x + along_y * beside.z;
        sums.turn += along_x * beside.w - along_y * beside.z;
    }
    return sums;
}

// Of the cascades `which`: of the sea or of vessels.
FieldSums cascade_sums(ivec2 which, sampler2D first, sampler2D second, bool both, int first_level, vec2 rest_m, Footprint footprint) {
    FieldSums sums = FieldSums(vec4(0.0), 0.0, 0.0, vec3(0.0));
    for (int c = which.x; c < which.y; ++c) {
        if (kVessels > 0 && c >= kSea.y && !is_in_tile(c - kSea.y, rest_m)) continue;
        Taps taps = taps_in(c, footprint);
        int last = last_tap(taps);
        for (int r = 0; r < 2; ++r) {
            if (r == 1 && !(footprint.blend.t > 0.0)) continue;  // there may be no next level
            int tile = (first_level + footprint.blend.lower + r) * kCascades + c;
            if (tile_first[tile].z == 0) continue;
            float share = share_in(tile, r, footprint.blend.t);
            if (!(share > 0.0)) continue;
            for (int j = -last; j <= last; ++j) {
                Node at = node_in(tile, split_metres(rest_m + float(j) * taps.spacing_m * footprint.axis));
                float weight = share * tap_weight(taps.reach, float(j));
                if (kRandomTiling && c < kSea.y) {
                    sums = add_tiles(first, second, both, tile, c, at, weight, sums);
                    continue;
                }
                Place place = place_of(tile, at);
                float wx[P];
                float wy[P];
                bspline_weights(place.rest.x, wx);
                bspline_weights(place.rest.y, wy);
                sums.first += weight * spline_sum(first, place.texel, wx, wy);
                if (!both) continue;
                vec4 beside = spline_sum(second, place.texel, wx, wy);
                sums.second += weight * beside.x;
                if (kMasks > 0) sums.values += weight * beside.yzw;
            }
        }
    }
    return sums;
}

// Height, Dx, Dy.
vec3 cell_cascades(ivec2 which, vec2 rest_m, Footprint footprint) {
    vec4 sum = cascade_sums(which, cell_fields, pixel_fields_2, false, 0, rest_m, footprint).first;
    return kChoppy ? sum.xyz : vec3(sum.x, 0.0, 0.0);
}

struct PixelFields {
    float slope_x, slope_y, dxx, dyy, dxy, dyx;
    vec3 values;  // with masks: Height, Dx, Dy
};

PixelFields pixel_cascades(ivec2 which, vec2 rest_m, Footprint footprint) {
    FieldSums sums = cascade_sums(which, pixel_fields, pixel_fields_2, kChoppy || kRandomTiling || kMasks > 0, kCellLevels, rest_m, footprint);
    vec4 sum = sums.first;
    if (!kChoppy) return PixelFields(sum.x, sum.y, 0.0, 0.0, 0.0, 0.0, vec3(sums.values.x, 0.0, 0.0));
    return PixelFields(sum.x, sum.y, sum.z, sum.w, sums.second, sums.second + sums.turn, sums.values);
}

uniform float breaking_footprint_m;

// Whether the displacement gradient of the waves that break isn't that of the pixel's normals.
bool breaks_apart(Footprint footprint) {
    return kBreakingLevels > 0 &&
           (!kChoppy || kTrains || levels[kCellLevels + footprint.blend.lower].x < breaking_footprint_m);
}

struct BreakingFields {
    vec4 gradient;  // Dxx, Dyy, Dxy, Dyx
    vec2 values;    // with masks: Dx, Dy
};

BreakingFields breaking_cascades(ivec2 which, vec2 rest_m, Footprint pixel) {
    Footprint footprint = pixel;
    footprint.width = max(pixel.width, breaking_footprint_m);
    if (!(footprint.along > footprint.width)) footprint.along = 0.0;
    FieldSums sums = cascade_sums(which, pixel_fields, pixel_fields_2, true, kCellLevels + kPixelLevels, rest_m, footprint);
    return BreakingFields(vec4(sums.first.zw, sums.second, sums.second + sums.turn), kChoppy ? sums.values.yz : vec2(0.0));
}

// What an ellipse leaves unresolved beyond a round footprint of its width: (xx, xy, yy, xxxx), (xxxy, xxyy, xyyy,
// yyyy).
struct EllipseUnresolved {
    vec4 low, high;
};

EllipseUnresolved ellipse_unresolved(Footprint footprint) {
    EllipseUnresolved sum = EllipseUnresolved(vec4(0.0), vec4(0.0));
    if (footprint.along == 0.0 || kCascades == 0) return sum;
    float w = (float(footprint.blend.lower) + footprint.blend.t) * float(kNodesALevel);
    float r = log2(footprint.along / footprint.width) * float(kNodesAnOctave);
    float turn = atan(footprint.axis.y, footprint.axis.x) / 3.14159265358979323846;
    float d = (turn - floor(turn)) * float(kDirections);
    ivec3 node = ivec3(min(int(w), textureSize(ellipse_table, 0).y - 2), clamp(int(r), 0, kRatios - 2),
                       min(int(d), kDirections - 1));
    vec3 share = vec3(w, r, d) - vec3(node);
    for (int corner = 0; corner < 8; ++corner) {
        ivec3 next = ivec3(corner & 1, (corner >> 1) & 1, corner >> 2);
        vec3 each = mix(1.0 - share, share, vec3(next));
        int column = 2 * ((node.y + next.y) * kDirections + (node.z + next.z) % kDirections);
        float of = each.x * each.y * each.z;
        sum.low += of * texelFetch(ellipse_table, ivec2(column, node.x + next.x), 0);
        sum.high += of * texelFetch(ellipse_table, ivec2(column + 1, node.x + next.x), 0);
    }
    return sum;
}

// The level's unresolved moments without the trains' part. May be negative by rounding.
PixelMoments unresolved_of(Footprint footprint) {
    LevelBlend blend = footprint.blend;
    vec4 low = unresolved_levels[4 * blend.lower];
    vec4 high = unresolved_levels[4 * blend.lower + 1];
    if (blend.t > 0.0) {
        vec4 low_both = unresolved_levels[4 * blend.lower + 2];
        vec4 high_both = unresolved_levels[4 * blend.lower + 3];
        vec4 low_next = unresolved_levels[4 * blend.lower + 4];
        vec4 high_next = unresolved_levels[4 * blend.lower + 5];
        for (int i = 0; i < 4; ++i) {
            low[i] = blended_moment(low[i], low_both[i], low_next[i], blend.t);
            high[i] = blended_moment(high[i], high_both[i], high_next[i], blend.t);
        }
    }
    EllipseUnresolved beside = ellipse_unresolved(footprint);
    low += beside.low;
    high += beside.high;
    return PixelMoments(low.x, low.y, low.z, low.w, high.x, high.y, high.z, high.w);
}
