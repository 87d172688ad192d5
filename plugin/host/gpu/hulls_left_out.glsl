// Of water in a hull, for a host that has drawn what lies behind. After hulls.glsl.
void keep_out_of_hulls(vec3 place) {
    if (is_in_hull(place)) discard;
}
