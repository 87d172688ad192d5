// What earlier breaking has left: FoamHistory::add() (core/effects/foam_history.h), read from the textures that PackedFoam
// describes. Needs the constants kFoamLevels, kFoamTileCells and kFoamTilesAcross.

uniform sampler2D foam_nodes;  // residual foam, that times its age [s], and bubbles that are left
uniform sampler2D foam_pages;  // which tile of foam_nodes; -1: none
// A row for each level. First column: .xy: the origin in the level's cells from its first tile's first node; .z: cells per metre.
// Second: .xy: its tiles across and along; .z: their first row in foam_pages. After the last level, (foam, foam times its age)
// beyond it, the finest level's cells per metre, and bubbles beyond it; negative: there are none. And FoamPlan's past_m and breaking_m.
uniform sampler2D foam_levels;

// Changes nothing and returns false where the tile isn't there.
bool foam_of_level(int level, vec2 rest_m, inout vec3 foam) {
    vec4 at = texelFetch(foam_levels, ivec2(0, level), 0);
    vec4 box = texelFetch(foam_levels, ivec2(1, level), 0);
    vec2 place = at.xy + at.z * rest_m;
    vec2 node = floor(place);
    vec2 tile = floor(node / float(kFoamTileCells));
    if (!(tile.x >= 0.0 && tile.y >= 0.0 && tile.x < box.x && tile.y < box.y)) return false;
    int page = int(texelFetch(foam_pages, ivec2(tile) + ivec2(0, int(box.z)), 0).x);
    if (page < 0) return false;
    ivec2 texel = ivec2(page % kFoamTilesAcross, page / kFoamTilesAcross) * (kFoamTileCells + 1) +
                  ivec2(node - float(kFoamTileCells) * tile);
    vec2 to = place - node;
    vec3 low = mix(texelFetch(foam_nodes, texel, 0).xyz, texelFetch(foam_nodes, texel + ivec2(1, 0), 0).xyz, to.x);
    vec3 high = mix(texelFetch(foam_nodes, texel + ivec2(0, 1), 0).xyz, texelFetch(foam_nodes, texel + ivec2(1, 1), 0).xyz, to.x);
    foam = mix(low, high, to.y);
    return true;
}

// Residual foam, that times its age, and bubbles, by the rule of foam_level_blend().
vec3 foam_left(vec2 rest_m, float footprint) {
    vec4 sea = texelFetch(foam_levels, ivec2(0, kFoamLevels), 0);
    float cells = 2.0 * footprint * sea.z;
    int level = 0;
    for (; level < kFoamLevels && cells >= 2.0; ++level) cells *= 0.5;
    float t = level < kFoamLevels ? max(cells - 1.0, 0.0) : 0.0;
    vec3 mean = sea.xyw;
    if (kMasks > 0) {  // beyond all tiles
        MaskGains gains = placed_masks(rest_m);
        mean *= gains.foam * masked_breaking(gains.waves, texelFetch(foam_levels, ivec2(1, kFoamLevels), 0).z);
    }
    if (kFronts > 0) mean *= fronts_foam(rest_m, footprint);
    vec3 sum = vec3(0.0);
    for (int k = 0; k < 2; ++k) {
        float share = k == 0 ? 1.0 - t : t;
        if (!(share > 0.0)) continue;
        vec3 foam = mean;
        // Where a tile isn't there yet, coarser ones may be.
        for (int i = level + k; i < kFoamLevels; ++i)
            if (foam_of_level(i, rest_m, foam)) break;
        sum += share * foam;
    }
    return sum;
}

AllFoam all_foam(vec2 rest_m, vec3 pixel, float breaking) {
    float along = length(pixel.yz);
    float footprint = along > pixel.x ? sqrt(pixel.x * along) : pixel.x;
    vec3 left = foam_left(rest_m, footprint);
    vec2 past_and_breaking = texelFetch(foam_levels, ivec2(1, kFoamLevels), 0).xy;
    bool has_bubbles = texelFetch(foam_levels, ivec2(0, kFoamLevels), 0).w >= 0.0;
    float residual = residual_foam(left.x, breaking, share_under_breaking(max(pixel.x, along), past_and_breaking.x, past_and_breaking.y));
    return AllFoam(breaking + residual, breaking, left.x > 0.0 ? left.y / left.x : 0.0, has_bubbles ? left.z : -1.0);
}
