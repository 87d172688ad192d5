// A material's colour, by its picture where it has one.
in vec2 object_image_at;

uniform bool object_has_image;
uniform sampler2D object_image;

vec3 coat_colour(vec3 plain) {
    if (!object_has_image) return plain;
    // Pictures of a host may be of floats: as in an export, where NaN is black.
    vec3 colour = texture(object_image, object_image_at).xyz;
    return mix(vec3(0.0), min(colour, vec3(1.0)), greaterThanEqual(colour, vec3(0.0)));
}
