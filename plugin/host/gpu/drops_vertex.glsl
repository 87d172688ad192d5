// The spray's large drops (plugin/render/seen_drops.h): a square round each disc.

layout(location = 0) in vec4 disc_in;   // middle, from the picture's top left corner, and radius [px]; its thickness
layout(location = 1) in vec4 light_in;  // where it hides all; and its distance from the eye [m]
layout(location = 2) in float depth_in; // half of how deep it is [m]

uniform vec2 picture_size;

flat out vec4 disc;
flat out vec4 light;
flat out float depth_m;

void main() {
    disc = disc_in;
    light = light_in;
    depth_m = depth_in;
    vec2 corner = vec2(gl_VertexID % 2 == 0 ? -1.0 : 1.0, gl_VertexID < 2 ? -1.0 : 1.0);
    vec2 at = (disc_in.xy + disc_in.z * corner) / picture_size;
    gl_Position = vec4(2.0 * at.x - 1.0, 1.0 - 2.0 * at.y, 0.0, 1.0);
}
