// No spray: what it adds, and what it leaves of what lies behind.
vec4 seen_spray(vec3 to_eye, float distance_m, bool on_sea) { return vec4(0.0, 0.0, 0.0, 1.0); }
