// Without pictures, see object_image_fragment.glsl.
vec3 coat_colour(vec3 plain) { return plain; }
