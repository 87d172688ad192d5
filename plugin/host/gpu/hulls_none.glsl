// Without hulls, see hulls.glsl.
void keep_out_of_hulls(vec3 place) {}
AllFoam with_hulls(AllFoam all, vec3 place, float cell_m) { return all; }
