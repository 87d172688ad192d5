// The uniforms of sky, sun and water, for the files of core/lighting.
uniform vec3 sun_direction;
uniform vec3 sun_radiance;
uniform float sun_angular_radius;
uniform vec3 sun_irradiance;
uniform vec3 sun_centre;
uniform vec3 sun_low;
uniform vec3 sun_middle;
uniform vec3 sun_high;
uniform vec3 sky_irradiance;
uniform vec3 water_reflectance;
uniform vec3 water_absorption_shorter;
uniform vec3 water_absorption_longer;
uniform vec3 water_backscatter_shorter;
uniform vec3 water_backscatter_longer;
uniform vec3 water_scattering_shorter;
uniform vec3 water_scattering_longer;
uniform vec3 water_floor_shorter;
uniform vec3 water_floor_longer;
uniform vec3 water_waves;
uniform vec4 water_body_look;  // has_body, floor_m, crest_light, crest_per_m of WaterLook
uniform vec2 water_bubbles;    // bubbles, bubbles_m
uniform float view_height_m;   // above the sea at rest, of an eye in the water
