// The ray through a pixel, as in View::direction(). Row 0 of the framebuffer is the bottom of the picture.

uniform vec3 view_forward;
uniform vec3 view_right;  // times the tangent that a pixel covers
uniform vec3 view_up;
uniform vec2 view_centre;  // [px]
uniform float view_pixel_tangent;

vec3 pixel_ray() {
    return normalize(view_forward + view_right * (gl_FragCoord.x - view_centre.x) +
                     view_up * (gl_FragCoord.y - view_centre.y));
}
