// An object's mesh as the sun sees it: depth alone.
layout(location = 0) in vec3 place_in;

uniform mat4 clip_from_object;

void main() { gl_Position = clip_from_object * vec4(place_in, 1.0); }
