// The uniforms of sky and sun, for the files of core/lighting.
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
