// An object's mesh, for an eye or for its mirror image.
layout(location = 0) in vec3 place_in;
layout(location = 1) in vec3 normal_in;
layout(location = 2) in float material_in;

uniform mat4 clip_from_object;
uniform mat4 grid_from_object;
uniform vec2 depth_of_distance;  // z = .x w + .y

out vec3 object_place;
out vec3 object_normal;
flat out float object_material;

void main() {
    object_place = (grid_from_object * vec4(place_in, 1.0)).xyz;
    // As areas turn: right for a scale that differs by axes, too.
    mat3 axes = mat3(grid_from_object);
    object_normal = normal_in.x * cross(axes[1], axes[2]) + normal_in.y * cross(axes[2], axes[0]) + normal_in.z * cross(axes[0], axes[1]);
    object_material = material_in;
    place_image();
    vec4 clip = clip_from_object * vec4(place_in, 1.0);
    gl_Position = vec4(clip.x, clip.y, depth_of_distance.x * clip.w + depth_of_distance.y, clip.w);
}
