// What sea_fragment.glsl begins with: the point at rest that the pixel shows, and its footprint, from the vertices.
in vec2 rest_m;
in vec3 pixel_m;  // width and long axis

void read_point() {}
