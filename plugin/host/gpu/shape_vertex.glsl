// A surface that isn't flat at rest.
layout(location = 3) in vec4 shape_in;  // its unit normal, and its height [m]

out vec3 shape_normal;

float shape_height_m() { return shape_in.w; }
void write_shape() { shape_normal = shape_in.xyz; }
