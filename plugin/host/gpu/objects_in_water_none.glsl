// No objects are seen in the water.
vec3 see_into_water(vec3 sea, vec3 place, vec3 to_eye, vec3 normal, float clear, WaterLook look) { return sea; }
