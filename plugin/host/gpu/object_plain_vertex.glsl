// Without pictures, see object_image_vertex.glsl.
void place_image() {}
