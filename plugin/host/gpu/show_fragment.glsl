// Shows the picture on a screen: the sum of its terms, through core/lighting/tone.glsl.
uniform sampler2D sea_picture;
uniform sampler2D sun_picture;
uniform sampler2D sky_picture;
uniform sampler2D foam_picture;
uniform sampler2D air_picture;
uniform vec2 picture_from_window;  // picture pixels per viewport pixel
uniform vec2 window_first;
uniform float exposure;
uniform mat3 white_balance;
uniform sampler2D dither;  // the beginning of dither() in core/lighting/tone.h, repeated

out vec4 colour_out;

void main() {
    ivec2 at = clamp(ivec2((gl_FragCoord.xy - window_first) * picture_from_window), ivec2(0),
                     textureSize(sea_picture, 0) - 1);
    vec4 radiance = texelFetch(sea_picture, at, 0);
    if (kLayers)
        radiance += texelFetch(sun_picture, at, 0) + texelFetch(sky_picture, at, 0) +
                    texelFetch(foam_picture, at, 0) + texelFetch(air_picture, at, 0);
    if (kPlain) {
        colour_out = vec4(radiance.xyz, 1.0);
        return;
    }
    // As display_bytes(), for a framebuffer of 8 bits, which rounds to the nearest.
    vec4 noise = texelFetch(dither, ivec2(gl_FragCoord.xy - window_first) % textureSize(dither, 0), 0);
    colour_out = vec4(display_colour(white_balance * radiance.xyz, exposure) + (noise.xyz - 0.5) / 255.0, 1.0);
}
