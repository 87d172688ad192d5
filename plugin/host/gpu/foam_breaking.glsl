// Foam that isn't persistent: where waves break, and nowhere else.
AllFoam all_foam(vec2 rest_m, vec3 pixel, float breaking) {
    return AllFoam(breaking, breaking, 0.0, -1.0);
}
