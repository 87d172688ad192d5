// Directions relative to the vertical of a place: turned as `up` is turned to z. On a round earth each place of the sea has
// its own zenith, sun and horizon (Bruneton et al. 2010, §6).
vec3 levelled(vec3 direction, vec3 up) {
    vec3 both = up + vec3(0.0f, 0.0f, 1.0f);
    float along = dot(up, direction);
    vec3 turned = direction - both * (dot(both, direction) / (1.0f + up.z));
    return turned + vec3(0.0f, 0.0f, 2.0f * along);
}
