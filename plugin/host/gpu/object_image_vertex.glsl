// Where a corner is in its material's picture.
layout(location = 3) in vec2 image_at_in;

out vec2 object_image_at;

void place_image() { object_image_at = image_at_in; }
