// A place of an object: core/lighting/object.glsl, through the air and the spray.
in vec3 object_place;
in vec3 object_normal;
flat in float object_material;

uniform vec3 object_eye;
uniform vec3 object_colour;
uniform float object_glow;  // radiance of a material that glows wholly
uniform bool object_holdout;
uniform float object_water_m;          // above this is what the sea mirrors, below it what one sees in the water
uniform sampler2D object_materials;    // two texels each: colour and roughness, glow
uniform float shadow_texel_m;
uniform vec3 object_flat_part;
uniform vec3 object_x;
uniform vec3 object_y;
uniform vec3 object_z;
uniform vec3 object_xy;
uniform vec3 object_yz;
uniform vec3 object_zz;
uniform vec3 object_xz;
uniform vec3 object_xx_yy;
uniform vec3 object_water;

void main() {
    float depth_m = object_water_m - object_place.z;
    if ((kMirrored && depth_m > 0.0) || (kInWater && depth_m < 0.0)) discard;
    vec3 from_eye = object_place - object_eye;
    float distance_m = length(from_eye);
    vec3 to_eye = -from_eye / distance_m;
    // Both sides of a triangle are its outside, whichever way it was wound.
    vec3 geometric = normalize(cross(dFdx(from_eye), dFdy(from_eye)));
    if (dot(geometric, to_eye) < 0.0) geometric = -geometric;
    vec3 normal = normalize(object_normal);
    if (dot(normal, geometric) < 0.0) normal = -normal;
    bool is_seen = !kMirrored && !kInWater;
    if (kWireframe || kFalseColour != 0 || (is_seen && object_holdout)) {
        write_terms(vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), is_seen ? kIsObject : 1.0);
        return;
    }
    vec4 coat = texelFetch(object_materials, ivec2(0, int(object_material)), 0);
    vec4 glow = texelFetch(object_materials, ivec2(1, int(object_material)), 0);
    ObjectLook look = ObjectLook(object_colour * coat_colour(coat.xyz), coat.w, object_glow * glow.xyz);
    ObjectSurroundings surroundings = ObjectSurroundings(object_flat_part, object_x, object_y, object_z, object_xy, object_yz,
                                                         object_zz, object_xz, object_xx_yy, object_water);
    if (kInWater) {
        // As LitObjects::radiance_in_water(), but for shadows: what hides the sun's ray above the water, and no other part of it.
        SeaLight from = sea_light();
        vec3 to_sun = vec3(sun_direction.xy / kWaterIndex, refracted_cosine(sun_direction.z));
        vec3 sun = vec3(0.0);
        if (kSun && sun_direction.z > 0.0 && dot(normal, to_sun) > 0.0)
            sun = sun_share(object_place + (depth_m / to_sun.z) * to_sun + shadow_texel_m * geometric) *
                  entering(sun_direction, from.water.waves) * sun_irradiance * let_through_water(depth_m / to_sun.z, from.water);
        vec3 sky = vec3(0.0);
        if (kSky) sky = sky_irradiance * let_through_water(kSkySlant * depth_m, from.water);
        write_terms(vec3(0.0), object_in_water(normal, to_sun, sun, sky, look), vec3(0.0), vec3(0.0), vec3(0.0), 1.0);
        return;
    }
    vec3 light = look.glow;
    if (kSun && sun_direction.z > 0.0 && dot(geometric, sun_direction) > 0.0)
        light += sun_share(object_place + shadow_texel_m * geometric) *
                 object_of_sun(to_eye, sun_direction, normal, look, sun_radiance, (kPi * square(sun_angular_radius)) * sun_radiance);
    float cosine = max(dot(normal, to_eye), 1.0e-3);
    vec3 ray = 2.0 * cosine * normal - to_eye;
    vec3 upwards = vec3(ray.x, ray.y, abs(ray.z));
    vec3 sky = vec3(0.0);
    if (kSky) sky = mapped_sky(sky_place(upwards), sky_level(square(square(look.roughness) / (1.0 + upwards.z))));
    light += object_of_surroundings(cosine, look, object_irradiance(normal, surroundings),
                                    object_mirrors(ray, look.roughness, sky, surroundings));
    if (kMirrored) {
        write_terms(vec3(0.0), light, vec3(0.0), vec3(0.0), vec3(0.0), 1.0);
        return;
    }
    AirPath path = AirPath(vec3(1.0), vec3(0.0));
    if (kAir)
        path = air_path(to_eye, distance_m,
                        AirView(air_azimuth, air_to_sun, air_reach_m.x, air_reach_m.y, air_reach_m.z, air_sky_rows.x, air_sky_rows.y));
    vec4 spray = seen_spray(to_eye, distance_m, false);
    write_terms(vec3(0.0), light * path.transmittance * spray.w, vec3(0.0), vec3(0.0),
                path.scattered * spray.w + vec3(spray.x, spray.y, spray.z), kIsObject);
}
