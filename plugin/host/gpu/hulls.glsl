// The hulls that keep water out (core/scene/hull.h), by the same nodes as on the CPU. hull_maps has them, kHullColumns in a row; hull_places, row by row:
// how many hulls there are, kHullTexels for each, and the water along them. Of a hull: three rows from the grid to columns, rows and levels; how many
// columns and rows, where its nodes begin, and how large it is in the world; its foam's strength and width [m], where its water begins, and columns of that;
// where these begin, how many there are a column of nodes, and rows of them.
uniform sampler2D hull_maps;
uniform sampler2D hull_places;

const float kNoHull = 1.0e30;

vec4 hull_texel(int at) { return texelFetch(hull_places, ivec2(at % kHullPlaceColumns, at / kHullPlaceColumns), 0); }

int hull_count() { return int(hull_texel(0).x); }

vec3 hull_nodes_at(int hull, vec3 place) {
    vec4 at = vec4(place, 1.0);
    int first = 1 + kHullTexels * hull;
    return vec3(dot(hull_texel(first), at), dot(hull_texel(first + 1), at), dot(hull_texel(first + 2), at));
}

// Hull::distance_m(), of `of` the hull's fourth texel, in the world.
float hull_distance_m(vec3 at, vec4 of) {
    ivec2 columns = ivec2(of.xy);
    if (!(at.z >= 0.0 && at.z <= float(kHullLevels) && at.x >= 0.0 && at.y >= 0.0 && at.x <= of.x - 1.0 && at.y <= of.y - 1.0)) return kNoHull;
    ivec2 node = min(ivec2(at.xy), columns - 2);
    float level = clamp(at.z - 0.5, 0.0, float(kHullLevels) - 1.0);
    int low = min(int(level), kHullLevels - 2);
    vec3 t = vec3(at.xy - vec2(node), level - float(low));
    float sum = 0.0;
    for (int i = 0; i < 8; ++i) {
        ivec3 corner = ivec3(i & 1, (i >> 1) & 1, i >> 2);
        int index = ((low + corner.z) * columns.y + node.y + corner.y) * columns.x + node.x + corner.x;
        vec3 weights = mix(1.0 - t, t, vec3(corner));
        sum += weights.x * weights.y * weights.z * texelFetch(hull_maps, ivec2(index % kHullColumns, index / kHullColumns + int(of.z)), 0).x;
    }
    return of.w * sum;
}

// Whether a place of the sea is in one.
bool is_in_hull(vec3 place) {
    for (int hull = 0; hull < hull_count(); ++hull)
        if (hull_distance_m(hull_nodes_at(hull, place), hull_texel(4 + kHullTexels * hull)) < 0.0) return true;
    return false;
}

vec3 hull_water_mps(int first, ivec2 count, vec2 at) {
    at = clamp(at, vec2(0.0), vec2(count - 1));
    ivec2 node = min(ivec2(at), count - 2);
    vec2 t = at - vec2(node);
    int low = first + node.y * count.x + node.x;
    return mix(mix(hull_texel(low).xyz, hull_texel(low + 1).xyz, t.x),
               mix(hull_texel(low + count.x).xyz, hull_texel(low + count.x + 1).xyz, t.x), t.y);
}

// The coverage of the foam along hulls, as Hulls::meet() has it; cell_m: the pixel's width on the water.
float hulls_foam(vec3 place, float cell_m) {
    float without = 1.0;
    for (int hull = 0; hull < hull_count(); ++hull) {
        int first = 1 + kHullTexels * hull;
        vec4 foam = hull_texel(first + 4);
        if (!(foam.x > 0.0)) continue;
        vec3 at = hull_nodes_at(hull, place);
        vec4 of = hull_texel(first + 3);
        float distance_m = hull_distance_m(at, of);
        if (!(distance_m < kNoHull) || distance_m < -2.0 * cell_m - foam.y) continue;
        vec4 right = vec4(hull_distance_m(at + vec3(0.5, 0.0, 0.0), of), hull_distance_m(at - vec3(0.5, 0.0, 0.0), of),
                          hull_distance_m(at + vec3(0.0, 0.5, 0.0), of), hull_distance_m(at - vec3(0.0, 0.5, 0.0), of));
        vec2 outward = right.xz - right.yw;
        if (any(equal(right, vec4(kNoHull))) || dot(outward, outward) == 0.0) continue;
        vec3 normal = normalize(outward.x * hull_texel(first).xyz + outward.y * hull_texel(first + 1).xyz);
        vec4 lattice = hull_texel(first + 5);
        float speed = abs(dot(normal, hull_water_mps(int(foam.z), ivec2(foam.w, lattice.w), (at.xy - lattice.xy) * lattice.z)));
        float width = max(foam.y, cell_m);
        float share = clamp(distance_m / width, 0.0, 1.0);
        without *= 1.0 - foam.x * (foam.y / width) * (1.0 - share * share * (3.0 - 2.0 * share)) * min(speed / kHullFull_mps, 1.0);
    }
    return 1.0 - without;
}

// It breaks now, of age 0.
AllFoam with_hulls(AllFoam all, vec3 place, float cell_m) {
    float foam = hulls_foam(place, cell_m);
    if (!(foam > 0.0)) return all;
    float before = all.coverage;
    all.coverage = 1.0 - (1.0 - before) * (1.0 - foam);
    all.age_s *= before / all.coverage;
    all.breaking = 1.0 - (1.0 - all.breaking) * (1.0 - foam);
    return all;
}
