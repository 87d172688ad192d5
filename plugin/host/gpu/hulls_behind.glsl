// Of water in a hull: all else is before it, but the sky. After hulls.glsl.
uniform float behind_all;  // as far as depth goes, but for the sky's

void keep_out_of_hulls(vec3 place) { gl_FragDepth = is_in_hull(place) ? behind_all : gl_FragCoord.z; }
