// The share of the sun's disc that is seen from a place: nothing hides it.
float sun_share(vec3 place) { return 1.0; }
