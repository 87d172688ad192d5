// A material's colour, by its picture where it has one.
in vec2 object_image_at;

uniform bool object_has_image;
uniform sampler2D object_image;

vec3 coat_colour(vec3 plain) { return object_has_image ? texture(object_image, object_image_at).xyz : plain; }
