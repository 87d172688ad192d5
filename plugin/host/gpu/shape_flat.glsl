// The surface at rest: flat. In vertex and fragment shaders; shape_vertex.glsl and shape_fragment.glsl are of others.
float shape_height_m() { return 0.0; }
void write_shape() {}
void read_shape() {}
