// What facets of the sea mirror, for core/lighting/sky.glsl: the sky, and nothing before it.
vec3 sky_lookup(vec2 u, float level) { return mapped_sky(u, level); }
void mirror_from(vec3 place) {}
