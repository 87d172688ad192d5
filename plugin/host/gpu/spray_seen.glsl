// What the spray adds, and what it leaves of what lies behind.
vec4 seen_spray(vec3 to_eye, float distance_m, bool on_sea) {
    ivec2 size = textureSize(spray_map, 0);
    SprayPath path = spray_path(to_eye, distance_m, on_sea,
                                SprayView(size.x, spray_is_torn ? size.y / 2 : size.y, vec2(spray_azimuth.x, spray_azimuth.y), spray_azimuth.z,
                                          spray_rows.x, spray_rows.y, spray_is_torn, spray_scales.x, spray_scales.y,
                                          spray_scales.z, vec2(spray_forward.x, spray_forward.y), spray_rows.z, spray_top_m,
                                          spray_to_sun, spray_sun, spray_above, spray_below,
                                          spray_low_ahead, spray_low_beside, spray_low_behind,
                                          SprayThreads(spray_threads_cell, spray_threads_wind, spray_threads_born,
                                                       vec2(spray_threads_look.x, spray_threads_look.y), spray_threads_look.z, spray_threads_look.w)));
    return vec4(path.scattered, path.transmittance);
}
