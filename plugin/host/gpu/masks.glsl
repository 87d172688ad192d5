// Calm and rough places at a point, as in core/evaluate/masks.cpp and prepared_query.cpp. The rows of `gusts` from kGustRows on, three for
// each mask: its middle from the origin [m] and the direction of its length; one over its half axes, within and without its edge; its gains
// of waves, ripples and foam, and how far it reaches [m]. Of a picture: its cells per metre and their counts, and −1 less its first row in
// mask_cells. Then what a slick hides of the slopes: xx, xy, yy.
uniform sampler2D mask_cells;  // shares of the masks of pictures, one's rows after another's

// As picture_share() in core/plan/masks.h.
MaskShare picture_share(vec2 at, vec4 size, int first_row) {
    vec2 place = at * size.xy + 0.5 * size.zw;
    MaskShare share = MaskShare(0.0, 0.0, 0.0);
    if (!(place.x > -1.0 && place.y > -1.0 && place.x < size.z + 1.0 && place.y < size.w + 1.0)) return share;
    vec2 cell = floor(place);
    MaskWeights along = mask_weights(place.x - cell.x - 0.5);
    MaskWeights across = mask_weights(place.y - cell.y - 0.5);
    vec3 weights = vec3(along.before, along.here, along.after), rates = vec3(along.before_rate, along.here_rate, along.after_rate);
    for (int j = 0; j < 3; ++j) {
        int y = int(cell.y) + j - 1;
        if (y < 0 || y >= int(size.w)) continue;
        vec3 shares = vec3(0.0);
        for (int i = 0; i < 3; ++i) {
            int x = int(cell.x) + i - 1;
            if (x >= 0 && x < int(size.z)) shares[i] = texelFetch(mask_cells, ivec2(x, first_row + y), 0).x;
        }
        float weight = j == 0 ? across.before : j == 1 ? across.here : across.after;
        float rate = j == 0 ? across.before_rate : j == 1 ? across.here_rate : across.after_rate;
        share.share += weight * dot(weights, shares);
        share.x += weight * dot(rates, shares);
        share.y += rate * dot(weights, shares);
    }
    return MaskShare(share.share, share.x * size.x, share.y * size.y);
}

MaskGains placed_masks(vec2 rest_m) {
    MaskGains all = MaskGains(1.0, 0.0, 0.0, 1.0, 1.0);
    for (int i = 0; i < kMasks; ++i) {
        vec4 place = gusts[kGustRows + 3 * i];
        vec4 size = gusts[kGustRows + 3 * i + 1];
        vec4 gains = gusts[kGustRows + 3 * i + 2];
        vec2 from = place.xy + rest_m;
        if (kMaskPictures && gains.w < 0.0) {
            MaskShare at = picture_share(vec2(dot(from, place.zw), from.y * place.z - from.x * place.w), size, int(-1.0 - gains.w));
            all = with_share(all, at, place.z, place.w, gains.x, gains.y, gains.z);
            continue;
        }
        if (!(dot(from, from) < gains.w * gains.w)) continue;
        all = with_mask(all, from.x, from.y, place.z, place.w, size.x, size.y, size.z, size.w, gains.x, gains.y, gains.z);
    }
    return all;
}

// With the strips behind vessels.
MaskGains masks_at(vec2 rest_m) {
    MaskGains all = placed_masks(rest_m);
    if (kStrips)
        for (int vessel = 0; vessel < kVessels; ++vessel) all.ripples *= 1.0 - wake_strip(vessel, rest_m, kSlick_m).calm;
    return all;
}

// What a slick leaves of waves is that of its own level.
Footprint calm_footprint(Footprint footprint, int level) {
    return Footprint(LevelBlend(level, 0.0), kSlick_m, footprint.along > kSlick_m ? footprint.along : 0.0, footprint.axis);
}
// How much of it is shown in a footprint of this level.
float calm_share(MaskGains masks, float level_m) { return level_m < kSlick_m ? 1.0 - masks.ripples : 0.0; }

vec3 calm_cell(vec2 rest_m, Footprint footprint, MaskGains masks, vec3 sum) {
    float share = calm_share(masks, levels[footprint.blend.lower].x);
    if (!(share > 0.0)) return sum;
    return sum + share * (cell_cascades(kSea, rest_m, calm_footprint(footprint, kCalmCell)) - sum);
}

PixelFields calm_pixel(vec2 rest_m, Footprint footprint, MaskGains masks, PixelFields f) {
    float share = calm_share(masks, levels[kCellLevels + footprint.blend.lower].x);
    if (!(share > 0.0)) return f;
    PixelFields calm = pixel_cascades(kSea, rest_m, calm_footprint(footprint, kCalmPixel));
    return PixelFields(mix(f.slope_x, calm.slope_x, share), mix(f.slope_y, calm.slope_y, share), mix(f.dxx, calm.dxx, share),
                       mix(f.dyy, calm.dyy, share), mix(f.dxy, calm.dxy, share), mix(f.dyx, calm.dyx, share), f.values);
}

// Dxx, Dyy, Dxy, Dyx.
vec4 masked_gradient(vec4 gradient, vec2 values, MaskGains masks) {
    return vec4(masked_slope(gradient.x, values.x, masks.waves, masks.x), masked_slope(gradient.y, values.y, masks.waves, masks.y),
                masked_slope(gradient.z, values.x, masks.waves, masks.y), masked_slope(gradient.w, values.y, masks.waves, masks.x));
}

PixelFields masked_fields(PixelFields f, MaskGains masks) {
    vec4 d = masked_gradient(vec4(f.dxx, f.dyy, f.dxy, f.dyx), f.values.yz, masks);
    return PixelFields(masked_slope(f.slope_x, f.values.x, masks.waves, masks.x), masked_slope(f.slope_y, f.values.x, masks.waves, masks.y),
                       d.x, d.y, d.z, d.w, masks.waves * f.values);
}

PixelMoments masked_moments(PixelMoments hidden, Footprint footprint, MaskGains masks) {
    LevelBlend blend = footprint.blend;
    vec3 slopes = vec3(hidden.xx, hidden.xy, hidden.yy);
    if (masks.ripples != 1.0) {
        // What is hidden besides a slick's waves: by coarse pixels and grids, or by the ellipse as long as a slick is wide.
        vec3 left = slopes - gusts[kMasked ? kGustRows + 3 * kMasks : 0].xyz;
        PixelMoments possible = possible_moments(PixelMoments(left.x, left.y, left.z, 0.0, 0.0, 0.0, 0.0, 0.0));
        vec3 calmed = vec3(possible.xx, possible.xy, possible.yy);
        if (kCalmPixel >= 0 && levels[kCellLevels + blend.lower].x < kSlick_m) {
            vec3 beside = ellipse_unresolved(calm_footprint(footprint, kCalmPixel)).low.xyz;
            if (beside.x + beside.z > calmed.x + calmed.z) calmed = beside;
        }
        for (int i = 0; i < 3; ++i) slopes[i] = hidden_with_ripples(slopes[i], calmed[i], masks.ripples);
    }
    float gain = masks.waves * masks.waves;
    vec4 here = levels[kCellLevels + blend.lower];
    float m0 = here.y;
    if (blend.t > 0.0) m0 = blended_moment(here.y, here.z, levels[kCellLevels + blend.lower + 1].y, blend.t);
    slopes = gain * slopes + max(m0, 0.0) * vec3(masks.x * masks.x, masks.x * masks.y, masks.y * masks.y);
    return PixelMoments(slopes.x, slopes.y, slopes.z, gain * hidden.xxxx, gain * hidden.xxxy, gain * hidden.xxyy, gain * hidden.xyyy,
                        gain * hidden.yyyy);
}
