// What the uniforms of light_uniforms.glsl say, for the functions of core/lighting.

SeaLight sea_light() {
    WaterLook water = WaterLook(water_reflectance, water_body_look.x > 0.0,
                                WaterBands(water_absorption_shorter, water_absorption_longer),
                                WaterBands(water_backscatter_shorter, water_backscatter_longer),
                                WaterBands(water_scattering_shorter, water_scattering_longer),
                                WaterBands(water_floor_shorter, water_floor_longer), water_body_look.y, water_waves,
                                water_body_look.z, water_body_look.w, water_bubbles.x, water_bubbles.y);
    return SeaLight(sun_direction, sun_radiance, sun_angular_radius, sun_irradiance, sky_irradiance, water,
                    FloorView(kFloorMaps && floor_level.x > 0.0, floor_level.y, floor_level.z, floor_level.w, floor_lowest_m, floor_depths, floor_depths_per_m,
                              floor_colours, floor_colours_first, floor_light_maps, floor_coarse, floor_shafts, floor_shafts_look));
}
