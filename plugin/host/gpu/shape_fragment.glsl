// A surface that isn't flat at rest, for its waves' normals.
in vec3 shape_normal;

void read_shape() { rest_normal = shape_normal; }
