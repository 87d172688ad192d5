// Vessels' wakes at a point, as in core/evaluate/prepared_query.cpp and core/effects/sea_at_time.cpp. A vessel's waves are those of a cascade
// behind the sea's, within one tile. Its rows of `gusts`, behind those of masks: the origin from the tile's middle, half the tile's side [m], and
// blocks per metre; then the block that the middle is in, of kSlopeBlocks.

// kWakeTableRows rows for each vessel, places from its tile's middle [m]. First: its hull and the age at which its wake ends; the number of points, and how far it reaches from them; a box
// round the strip; a box round each kWakeBox steps of it. Second, two texels for each point from the bow on: place, way [m] and age [s]; strength. Then what each
// level of pixels hides of the slopes, a block a texel, levels side by side: xx, xy, yy.
uniform sampler2D wake_table;

const ivec2 kWakes = ivec2(kCascades - kVessels, kCascades);

vec3 wake_cell(vec2 rest_m, Footprint footprint) { return cell_cascades(kWakes, rest_m, footprint); }

PixelFields with_wakes(PixelFields f, vec2 rest_m, Footprint footprint) {
    PixelFields w = pixel_cascades(kWakes, rest_m, footprint);
    return PixelFields(f.slope_x + w.slope_x, f.slope_y + w.slope_y, f.dxx + w.dxx, f.dyy + w.dyy, f.dxy + w.dxy, f.dyx + w.dyx, f.values);
}

vec3 hidden_in_blocks(int vessel, int level, vec2 rest_m) {
    int row = kGustRows + kMaskRows + kVesselRows * vessel;
    vec2 at = from_tile(vessel, rest_m) * gusts[row].w + gusts[row + 1].xy;
    vec2 whole = floor(at);
    vec2 to = at - whole;
    vec3 sum = vec3(0.0);
    for (int corner = 0; corner < 4; ++corner) {
        ivec2 next = ivec2(corner & 1, corner >> 1);
        ivec2 block = (ivec2(whole) + next) & (kSlopeBlocks - 1);
        vec2 weight = mix(1.0 - to, to, vec2(next));
        sum += weight.x * weight.y *
               texelFetch(wake_table, ivec2(kSlopeBlocks * level + block.x, kWakeTableRows * vessel + 2 + block.y), 0).xyz;
    }
    return sum;
}

// Between levels waves that the finer one shows whole and the coarser one not at all have (1 − t)² of their variance.
PixelMoments with_hidden_wakes(PixelMoments hidden, vec2 rest_m, Footprint footprint) {
    float t = footprint.blend.t;
    for (int vessel = 0; vessel < kVessels; ++vessel) {
        if (!is_in_tile(vessel, rest_m)) continue;
        vec3 sum = hidden_in_blocks(vessel, footprint.blend.lower, rest_m);
        if (t > 0.0) sum += t * (2.0 - t) * (hidden_in_blocks(vessel, footprint.blend.lower + 1, rest_m) - sum);
        float xx = max(sum.x, 0.0), yy = max(sum.z, 0.0), most = sqrt(xx * yy);
        hidden.xx += xx;
        hidden.xy += clamp(sum.y, -most, most);
        hidden.yy += yy;
    }
    return possible_moments(hidden);
}

bool is_in_box(vec4 box, vec2 place_m) {
    return place_m.x >= box.x && place_m.y >= box.y && place_m.x <= box.z && place_m.y <= box.w;
}

// The turbulent wake behind a vessel, through a pixel of this footprint.
WakeWater wake_strip(int vessel, vec2 rest_m, float footprint_m) {
    WakeWater none = WakeWater(0.0, 0.0, 0.0);
    vec2 place_m = from_tile(vessel, rest_m);
    int row = kWakeTableRows * vessel;
    if (!is_in_box(texelFetch(wake_table, ivec2(2, row), 0), place_m)) return none;
    vec4 hull = texelFetch(wake_table, ivec2(0, row), 0);
    vec4 points = texelFetch(wake_table, ivec2(1, row), 0);
    int last = int(points.x) - 1;
    float nearest = points.y * points.y;
    float share = 0.0;
    int of = -1;
    for (int first = 0; first < last; first += kWakeBox) {
        if (!is_in_box(texelFetch(wake_table, ivec2(3 + first / kWakeBox, row), 0), place_m)) continue;
        vec2 from = texelFetch(wake_table, ivec2(2 * first, row + 1), 0).xy;
        for (int i = first; i < min(first + kWakeBox, last); ++i) {
            vec2 end = texelFetch(wake_table, ivec2(2 * i + 2, row + 1), 0).xy;
            vec2 along = end - from;
            vec2 to = place_m - from;
            float length2 = dot(along, along);
            float t = length2 > 0.0 ? clamp(dot(to, along) / length2, 0.0, 1.0) : 0.0;
            vec2 off = to - t * along;
            if (dot(off, off) < nearest) {
                nearest = dot(off, off);
                share = t;
                of = i;
            }
            from = end;
        }
    }
    if (of < 0) return none;
    vec4 a = texelFetch(wake_table, ivec2(2 * of, row + 1), 0);
    vec4 b = texelFetch(wake_table, ivec2(2 * of + 2, row + 1), 0);
    float strength_a = texelFetch(wake_table, ivec2(2 * of + 1, row + 1), 0).x;
    float strength_b = texelFetch(wake_table, ivec2(2 * of + 3, row + 1), 0).x;
    return wake_water(WakeHull(hull.x, hull.y, hull.z, hull.w),
                      WakePlace(sqrt(nearest), mix(a.z, b.z, share), mix(a.w, b.w, share), mix(strength_a, strength_b, share)), min(footprint_m, kWakeWidest * points.y));
}
