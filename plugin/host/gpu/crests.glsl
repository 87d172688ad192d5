// The shape of long waves at a vertex, for the light in the water: their slopes and height [m]; 0 where they don't shape it.
uniform vec4 water_body_look;

vec3 crest_at(vec2 rest_m, vec3 cell) {
    if (kShaped || !(water_body_look.z > 0.0)) return vec3(0.0);
    vec3 footprint = vec3(max(cell.x, kCrestFootprint_m), cell.y, cell.z);
    vec3 normal = query_pixel(rest_m, footprint).normal;
    return vec3(-normal.xy / max(normal.z, 0.1), query_cell(rest_m, footprint).x);
}
