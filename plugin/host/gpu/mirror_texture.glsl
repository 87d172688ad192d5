// The objects' mirror image as a texture with mip levels, which the driver filters, for sky_with_objects.glsl.
uniform sampler2D mirrored_objects;  // radiance times coverage, and coverage

vec4 mirrored_seen(vec2 at, float level) { return textureLod(mirrored_objects, at, level); }
