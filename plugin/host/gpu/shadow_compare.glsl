// For sun_shadow.glsl: whether the sun sees a place of the map, between its texels too.
uniform sampler2DShadow sun_shadow;
uniform sampler2D sun_blockers;  // the same map

float shadow_seen(vec3 at) { return textureLod(sun_shadow, at, 0.0); }
