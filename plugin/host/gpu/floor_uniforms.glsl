// The floor's maps (core/lighting/floor.glsl), seen from the eye.
uniform sampler2D floor_maps;
uniform vec4 floor_level;  // is_seen, z_m, curvature_per_m and pixel of FloorView
uniform float floor_lowest_m;
uniform vec4 floor_depths;
uniform vec4 floor_depths_per_m;
uniform vec4 floor_colours;
uniform float floor_colours_first;
uniform vec4 floor_light_maps;
uniform vec4 floor_coarse;
uniform vec4 floor_shafts;
uniform vec3 floor_shafts_look;

float floor_value(int i) {
    return kFloorMaps ? texelFetch(floor_maps, ivec2(i % kFloorColumns, i / kFloorColumns), 0).x : 0.0;
}
