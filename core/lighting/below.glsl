// The light that an eye in the water sees: the sea's surface from below, and the water between. Of a body of water (water.glsl).
//
// Seen upside down the surface is a sea over air: z is turned round, slopes change their sign, and everything of slopes.glsl holds.

// A camera is in air, behind its front glass: of radiance in the water it sees that part, as in meniscus.h.
const float kBehindGlass = 1.0f / (kWaterIndex * kWaterIndex);

vec3 upside_down(vec3 direction) { return vec3(direction.x, direction.y, -direction.z); }

// ---- The water between

// Phase functions of Henyey and Greenstein, without what they have at 90°, which the light that comes back out of deep water
// (out_of_deep()) has already: of the rest of particles' light, 0.04 /sr at 50°, and of the same for a sky, whose light in the water fills a
// cone of 2.1 sr: what of it goes on in that cone is 0.38 /sr.
const float kSunAhead = 0.865f;
const float kSkyAhead = 0.45f;

float scattered_ahead(float cosine, float g) {
    if (!(cosine > 0.0f)) return 0.0f;
    float sum = 1.0f + g * g;
    float ahead = sum - 2.0f * g * min(cosine, 1.0f);
    return (1.0f - g * g) / (4.0f * kPi) * (inversesqrt(ahead * ahead * ahead) - inversesqrt(sum * sum * sum));
}

// A line of sight in the water.
struct WaterSight {
    float down;      // of its direction, −1 … 1
    float length_m;  // to its end: the surface, the floor, or nowhere
    float depth_m;   // of the eye, ≥ 0
    float end_m;     // depth of its end, ≥ 0
    bool to_surface;
    bool to_floor;
    float slant;     // 1/cosine in the water of the sun's light
    float to_sun;    // cosine of the angle to the sun as the water shows it
    float aside;     // how far it looks away from the sun's side: 0 straight down, and towards the sun
    float returned;  // of what comes up, the part that the surface sends down again
    float floor_m;
    float gathered;  // the sun's light where it ends on the floor over its mean there, less 1
    float shafts;    // the same of the water along it
    float shafts_m;  // how far below the surface these are, along the sun's rays
};

// Over the irradiance that enters at the surface, of sun and sky: radiance that the eye sees of water and floor. And what is left of
// the light at the sight's end.
struct WaterSeen {
    vec3 sun;
    vec3 sky;
    vec3 left;
};

// ∫ exp(−K z(s) − k s) ds along the sight, K the light's decay with depth z, down from the eye another one, and k the sight's own: from the end
// that sends more, so that no exponent is positive.
vec3 along_sight(vec3 decay, vec3 further_down, vec3 own, WaterSight sight) {
    vec3 first = decay * sight.depth_m;
    float deeper = sight.end_m - sight.depth_m;
    vec3 last = max(first + deeper * (deeper > 0.0f ? further_down : decay), vec3(0.0f)) + own * sight.length_m;
    vec3 change = max(abs(last - first), vec3(1.0e-4f));
    return sight.length_m * exp(-min(first, last)) * (1.0f - exp(-change)) / change;
}

// What a metre of water takes from the light of a shape in it: all but what is scattered nearly straight on.
vec3 fog_of_water(vec3 absorption, vec3 scattering, vec3 own) {
    return absorption + 2.0f * own + kScatteredAside * max(scattering - 2.0f * own, vec3(0.0f));
}

// The part of a shape's light that comes so far through the water.
vec3 let_through_water(float distance_m, WaterLook look) {
    vec3 shorter = exp(-distance_m * fog_of_water(look.absorption.shorter, look.scattering.shorter, kOwnShorter));
    vec3 longer = exp(-distance_m * fog_of_water(look.absorption.longer, look.scattering.longer, kOwnLonger));
    return clamp(colour_of(WaterBands(shorter, longer)), vec3(0.0f), vec3(1.0f));
}

// At three wavelengths. Straight down from just below the surface the eye sees what water_back() has of a column; out_of_deep() is a mean over
// azimuths, at views of less than 17° down as if these were 17°. Between an eye and the surface, of which it sees the shape, light is lost
// by scattering as well. Constants by a Monte Carlo of deep water below a level surface (tests/bench/README.md, the water): 10 … 30 % of the
// radiance, up to twice where the eye looks up past the sun from 12 m.
WaterSeen seen_in_water(vec3 absorption, vec3 scattering, vec3 backscatter, vec3 own, vec3 floor_colour, WaterSight sight) {
    vec3 both = absorption + backscatter;
    vec3 u = backscatter / both;
    vec3 part = min(own / backscatter, vec3(1.0f));
    vec3 aside = kScatteredAside * max(scattering - 2.0f * own, vec3(0.0f));
    vec3 fog = fog_of_water(absorption, scattering, own);
    vec3 spread = 0.954f * both;
    vec3 way = sight.to_surface ? fog : spread;
    float down = clamp(sight.down, 0.3f, 1.0f);
    vec3 by_sun = both * sight.slant;
    vec3 by_sky = both * kSkySlant;
    vec3 of_sun = out_of_deep(u, part, sight.slant - 1.0f, 1.0f / down - 1.0f) * (way / spread) * (spread + down * by_sun);
    vec3 of_sky = out_of_deep(u, part, kSkySlant - 1.0f, 1.0f / down - 1.0f) * (way / spread) * (spread + down * by_sky);
    // Of an eye that looks down from far below the surface: light decays faster than a column's formula says, since it is scattered away
    // as well (Lee et al. 2005).
    vec3 lost = (2.4f * clamp(2.0f * sight.down, 0.0f, 1.0f)) * backscatter;
    of_sun *= exp(-0.46f * sight.aside);
    vec3 sun = of_sun * along_sight(by_sun + lost, by_sun, way, sight);
    vec3 sky = of_sky * along_sight(by_sky + lost, by_sky, way, sight);
    vec3 shafts = 1.0f + sight.shafts * left_gathered(scattering, own, sight.shafts_m);
    sun *= shafts;
    vec3 diffuse = (0.33f * kSkySlant) * u;
    if (sight.floor_m < kNoFloor_m) {
        vec3 reflected = 1.02f * sqrt(1.0f + 4.7f * u);
        vec3 depth = both * sight.floor_m;
        diffuse = diffuse * (1.0f - exp(-depth * (kSkySlant + 2.0f * 0.954f))) +
                  floor_colour * exp(-depth * (kSkySlant + 2.0f * reflected));
        // What the floor sends up is scattered into level views. Steeper ones have less of it, and those straight down none: there it is
        // what the floor itself loses so slowly.
        vec3 seen = (0.35f * (1.0f - abs(sight.down))) * aside * along_sight(vec3(0.0f), vec3(0.0f), fog, sight) *
                    exp(-both * reflected * max(sight.floor_m - sight.depth_m, 0.0f));
        vec3 direct = sight.to_floor ? exp(-both * reflected * sight.length_m) : vec3(0.0f);
        vec3 bare = floor_colour / kPi;
        vec3 spread_out = left_gathered(scattering, own, sight.floor_m * sight.slant);
        sun += bare * (seen + direct * (1.0f + sight.gathered * spread_out)) * exp(-by_sun * sight.floor_m);
        sky += bare * (seen + direct) * exp(-by_sky * sight.floor_m);
    }
    vec3 again = 1.0f / (1.0f - sight.returned * diffuse);
    sun = again * sun +
          shafts * aside * (sight.slant * scattered_ahead(sight.to_sun, kSunAhead)) * along_sight(by_sun + lost, by_sun, fog, sight);
    sky = again * sky + aside * (kSkySlant * scattered_ahead(-sight.down, kSkyAhead)) * along_sight(by_sky + lost, by_sky, fog, sight);
    return WaterSeen(sun, sky, sight.to_surface ? exp(-fog * sight.length_m) : vec3(0.0f));
}

// direction: of sight, unit, level axes; height_m: of the eye above the sea at rest; surface_m: how far the surface is, negative where the
// sight doesn't end there.
WaterSight water_sight(vec3 direction, float height_m, float surface_m, vec3 to_sun, WaterLook look) {
    WaterSight sight;
    sight.down = -direction.z;
    sight.depth_m = max(-height_m, 0.0f);
    sight.to_surface = surface_m >= 0.0f;
    float floor_m = sight.down > 0.0f ? max(look.floor_m + height_m, 0.0f) / max(sight.down, 1.0e-6f) : kNoFloor_m;
    sight.to_floor = !sight.to_surface && look.floor_m < kNoFloor_m && floor_m < kNoFloor_m;
    sight.length_m = sight.to_surface ? surface_m : min(floor_m, kNoFloor_m);
    sight.end_m = sight.to_surface ? 0.0f : max(sight.depth_m + sight.down * sight.length_m, 0.0f);
    float cosine = refracted_cosine(to_sun.z);
    sight.slant = 1.0f / cosine;
    sight.to_sun = (to_sun.x * direction.x + to_sun.y * direction.y) / kWaterIndex + cosine * direction.z;
    float across = sqrt(max((1.0f - square(sight.down)) * (1.0f - square(cosine)), 0.0f));
    float level = sight.down > 0.0f ? 1.0f - square(sight.down) : 1.0f;
    sight.aside = max(across - (sight.to_sun - cosine * direction.z), 0.0f) * level * sqrt(max(level, 0.0f));
    sight.returned = 1.0f - entering_from_sky(look.waves) / square(kWaterIndex);
    sight.floor_m = look.floor_m;
    sight.gathered = 0.0f;
    sight.shafts = 0.0f;
    sight.shafts_m = 0.0f;
    return sight;
}

const int kShaftPlaces = 64;       // along a sight
const float kShaftWidth = 0.6f;    // over which one sees the light, over its part of the sight: levels of the map mix a little more

// The decay per metre along a sight of what the sun's light sends to the eye, at the clearest of three wavelengths: of its absorption and of that.
vec2 clearest(vec3 absorption, vec3 scattering, vec3 backscatter, vec3 own, WaterSight sight, vec2 than) {
    vec3 along = absorption + 2.0f * own + kScatteredAside * max(scattering - 2.0f * own, vec3(0.0f)) +
                 (sight.down * sight.slant) * (absorption + backscatter);
    for (int i = 0; i < 3; ++i)
        if (absorption[i] < than.x) than = vec2(absorption[i], along[i]);
    return than;
}

// Shafts of light: what the waves gather of the sun's light, over its mean, along a sight from a place relative to the eye. The map on its
// plane is followed along the sun's rays. A pattern grows with depth as long as the waves focus, and below that the sun's disc and
// slopes that aren't resolved blur it as much. Its places send as much to the eye each, at the clearest of wavelengths, and each is as wide as
// its part of the sight crosses the rays. So what is too fine for them is even, and nothing flickers.
WaterSight shafts_along(vec3 from, vec3 direction, vec3 to_sun, WaterLook look, FloorView of, WaterSight sight) {
    vec2 clear = clearest(look.absorption.shorter, look.scattering.shorter, look.backscatter.shorter, kOwnShorter, sight, vec2(1.0e9f, 0.0f));
    clear = clearest(look.absorption.longer, look.scattering.longer, look.backscatter.longer, kOwnLonger, sight, clear);
    float decay = clear.y;
    float length_m = sight.down < 0.0f ? min(sight.length_m, sight.depth_m / max(-sight.down, 1.0e-6f)) : sight.length_m;
    float all = decay * length_m;
    bool is_even = abs(all) < 1.0e-3f;
    float lost = is_even ? 0.0f : 1.0f - exp(-clamp(all, -60.0f, 60.0f));
    vec2 back = vec2(to_sun.x, to_sun.y) * (sight.slant / kWaterIndex);
    vec2 level = vec2(direction.x, direction.y);
    vec2 crossing = level + sight.down * back;
    float across = sqrt(crossing.x * crossing.x + crossing.y * crossing.y);
    float sum = 0.0f;
    float deep = 0.0f;
    for (int i = 0; i < kShaftPlaces; ++i) {
        float part = (float(i) + 0.5f) / float(kShaftPlaces);
        float left = 1.0f - part * lost;
        float s = is_even ? part * length_m : -log(max(left, 1.0e-20f)) / decay;
        float step_m = is_even ? length_m / float(kShaftPlaces) : lost / (decay * left * float(kShaftPlaces));
        float depth = max(sight.depth_m + s * sight.down, 0.0f);
        vec2 place = vec2(from.x, from.y) + s * level - (of.shafts.w - depth) * back;
        float wide = sqrt(square(kShaftWidth * step_m * across) + square(of.pixel * s));
        float grown = 2.0f * depth * of.shafts.w / (depth * depth + of.shafts.w * of.shafts.w);
        sum += grown * (shaft_light(place, wide, of) - 1.0f);
        deep += depth;
    }
    sight.shafts = max(of.shafts_look.z * sum / float(kShaftPlaces), -1.0f);
    sight.shafts_m = deep / float(kShaftPlaces) * sight.slant;
    return sight;
}

struct WaterBetween {
    vec3 light;
    vec3 left;  // part of what is behind
};

// Of a sight as water_sight() has it, from a place relative to the eye; blur: the width of what is seen as one a unit of
// distance, beside a pixel.
WaterBetween water_between(vec3 from, vec3 direction, float height_m, float surface_m, float blur, SeaLight light) {
    WaterLook look = light.water;
    WaterBands bare = look.floor_colour;
    float gathered = 0.0f;
    if (surface_m < 0.0f && direction.z < 0.0f && look.floor_m < kNoFloor_m && is_floor_near(from, light.floor)) {
        float down = max(-direction.z, 0.02f);
        float wide = sqrt(square(light.floor.pixel) + square(blur)) * inversesqrt(down) / down;
        SeenFloor there = seen_floor(from, vec2(direction.x, direction.y) / down, wide, light.floor.pixel * length(from), light.floor);
        look.floor_m = max(there.depth_m - height_m, kLeastFloor_m);
        gathered = there.light - 1.0f;
        if (light.floor.colours.w > 0.0f) {
            WaterBands picture = bands_of(there.colour);
            bare = WaterBands(bare.shorter * picture.shorter, bare.longer * picture.longer);
        }
    }
    WaterSight sight = water_sight(direction, height_m, surface_m, light.sun_direction, look);
    sight.gathered = gathered;
    // Mirrored and mixed sights see none.
    if (light.floor.is_seen && light.floor.shafts_look.y > 0.0f && blur == 0.0f)
        sight = shafts_along(from, direction, light.sun_direction, look, light.floor, sight);
    WaterSeen shorter = seen_in_water(look.absorption.shorter, look.scattering.shorter, look.backscatter.shorter, kOwnShorter,
                                      bare.shorter, sight);
    WaterSeen longer = seen_in_water(look.absorption.longer, look.scattering.longer, look.backscatter.longer, kOwnLonger,
                                     bare.longer, sight);
    float in_sun = entering(vec3(light.sun_direction.x, light.sun_direction.y, max(light.sun_direction.z, 0.0f)), look.waves);
    vec3 of_sun = light.sun_irradiance * in_sun * colour_of(WaterBands(shorter.sun, longer.sun));
    vec3 of_sky = light.sky_irradiance * entering_from_sky(look.waves) * colour_of(WaterBands(shorter.sky, longer.sky));
    return WaterBetween(max(of_sun, vec3(0.0f)) + max(of_sky, vec3(0.0f)),
                        clamp(colour_of(WaterBands(shorter.left, longer.left)), vec3(0.0f), vec3(1.0f)));
}

// ---- The surface from below: directions in the frame of the sea upside down

// The mean over facets whose angle of incidence has this deviation [rad] of what a facet lets through: nothing beyond the critical
// angle, and below it what it does at the mean of those angles.
float let_through(float cosine, float deviation) {
    float sine = 1.0f / kWaterIndex;  // of the critical angle
    float critical = sqrt(1.0f - sine * sine);
    float c = clamp(cosine, 0.0f, 1.0f);
    float s = max(deviation, 1.0e-4f);
    // The sine of what the angle lacks serves as well as the angle.
    float z = min((sine * c - critical * sqrt(1.0f - c * c)) / s, 5.0f);
    if (z < -5.0f) return 0.0f;
    float below = 1.0f / (1.0f + exp(-z * (1.5958f + 0.07133f * z * z)));  // of a normal distribution, to 2e-4
    float inside = max(c, critical * cos(0.6f * s) + sine * sin(0.6f * s));
    return below * (1.0f - fresnel_exact(inside, 1.0f / kWaterIndex));
}

struct SkyFromBelow {
    vec3 sky;        // its light through the surface
    float through;   // the part of a uniform sky's, over n²
};

// What the visible facets show of the sky, by the nine of sky_of_nine(), each with its own refracted ray. A ray that meets the sea
// again sees it at so flat an angle that it mirrors the sky at the horizon: that is what it gets.
SkyFromBelow sky_from_below(vec3 v, SlopeFrame frame) {
    VisibleSlopes seen = visible_slopes(v, frame.variance);
    float first = max(-seen.tilt, -3.0f);
    float step_along = (3.0f - first) / 9.0f;
    float along2 = dot(seen.along, seen.along);
    float across2 = dot(seen.across, seen.across);
    float deviation = sqrt(0.16f * square(step_along) * along2 + 0.1f * across2);
    float blur = min(0.45f * step_along * sqrt(along2 * across2), 0.5f * max(along2, across2));
    MaskedView view = masked_view(v, frame.variance);
    vec3 sum = vec3(0.0f);
    float through = 0.0f;
    float total = 0.0f;
    float turn = 0.0f;
    for (int i = 0; i < 9; ++i) {
        float x = first + step_along * (float(i) + 0.5f);
        float facing = view.height + sqrt(view.along) * x;
        vec2 slope = seen.across * (1.2247f * turn) - seen.along * x;
        vec3 f = normalize(vec3(-slope.x, -slope.y, 1.0f));
        float cosine = clamp(dot(v, f), 0.0f, 1.0f);
        float part = max(facing, 0.0f) * exp(-0.5f * x * x) * visible_part(view, facing);
        float let = let_through(cosine, deviation * f.z * f.z);
        total += part;
        through += part * let;
        if (kSky && let > 0.0f) {
            float beyond = sqrt(max(1.0f - square(kWaterIndex) * (1.0f - cosine * cosine), 0.0f));
            vec3 ray = upside_down(out_of_frame(frame, (kWaterIndex * cosine - beyond) * f - kWaterIndex * v));
            ray = normalize(vec3(ray.x, ray.y, max(ray.z, 1.0e-3f)));
            // Stereographic: directions change as places in the map, over 1 + z.
            float change = (kWaterIndex * cosine / max(beyond, 0.25f) - 1.0f) / (1.0f + ray.z);
            sum += part * let * sky_lookup(sky_place(ray), sky_level(blur * square(change)));
        }
        turn = turn > 0.5f ? -1.0f : (turn < -0.5f ? 0.0f : 1.0f);
    }
    total = max(total, 1.0e-20f);
    return SkyFromBelow(square(kWaterIndex) * sum / total, through / total);
}

// The sun through the surface, as sun_seen_from() has its mirror image (sun.glsl): the facet that refracts the sun's ray l to the eye has
// the normal n v + l (Walter et al. 2007), v·f/f_z faces the eye and −l·f/f_z the sun. At most n² (1 − F) of the disc's own radiance.
vec3 sun_from_below(vec3 v, vec3 to_sun, SlopeFrame frame, vec3 sun_radiance, float angular_radius) {
    vec3 l = into_frame(frame, upside_down(to_sun));
    vec3 h = kWaterIndex * v + l;
    if (to_sun.z <= 0.0f || h.z <= 1.0e-5f || l.z >= 0.0f) return vec3(0.0f);
    vec2 spread = disc_spread(to_sun.z, angular_radius);
    float level = length(vec2(to_sun.x, to_sun.y));
    vec3 side = level > 1.0e-3f ? vec3(-to_sun.y, to_sun.x, 0.0f) / level : vec3(1.0f, 0.0f, 0.0f);
    vec3 of_side = spread.x * into_frame(frame, upside_down(side));
    vec3 of_rise = spread.y * into_frame(frame, upside_down(normalize(cross(to_sun, side))));

    SunFacets seen = sun_facets(h, l, frame, of_side, of_rise);
    vec3 point = normalize(seen.point);
    vec3 normal = kWaterIndex * v + point;
    float upright = max(normal.z, 0.1f * h.z);
    float facing = max(dot(v, normal), 0.0f) / upright;
    float facing_sun = max(-dot(point, normal), 0.0f) / upright;
    float cosine = dot(v, normal) / max(length(normal), 1.0e-6f);
    vec3 blurred = frame.variance + vec3(square(spread.y), square(spread.y), 0.0f);
    float lit = lit_part(masked_view(v, frame.variance), facing, facing_sun, upside_down(l), blurred);
    float part = kPi * square(angular_radius) * facing * facing_sun * seen.density * lit;
    float most = square(0.5f * angular_radius) / (spread.x * spread.y);
    return sun_radiance * (min(part, most) * square(kWaterIndex) * (1.0f - fresnel_exact(cosine, 1.0f / kWaterIndex)));
}

// 1 − exp(−x), with all digits where that is little.
float lost_by(float x) { return x < 0.1f ? x * (1.0f - 0.5f * x * (1.0f - x / 3.0f * (1.0f - 0.25f * x))) : 1.0f - exp(-x); }

// What a cloud of bubbles makes of light that falls on it at that cosine: it sends a part back, lets a part through as it was, and spreads the
// rest about the way on. No bubble absorbs. bubbles: b_g L.
struct BubbleVeil {
    float back;
    float sharp;
    float spread;
};

BubbleVeil bubble_veil(float bubbles, float cosine) {
    float back = bubbles_add(bubbles, vec3(0.0f)).x;
    float lost = max(lost_by(bubbles / max(cosine, 0.05f)), back);
    return BubbleVeil(back, 1.0f - lost, lost - back);
}

// Clean bubbles' phase function [1/sr], by the cosine to the way on: Henyey and Greenstein's of g = 0.655 (geometric half alone), of g^n after n scatterings.
float ahead_of_bubbles(float cosine, float bubbles, float of_sun) {
    float g = pow(0.655f, max(bubbles / of_sun, 1.0f));
    float sum = max(1.0f + g * g - 2.0f * g * cosine, 1.0e-4f);
    return (1.0f - g * g) / (4.0f * kPi) * inversesqrt(sum * sum * sum);
}

// Of the light on foam the part that comes out below: half of what it doesn't reflect, since bubbles hang under it; by eye.
const float kFoamLetsThrough = 0.5f;

// All that a pixel of the surface sends to an eye below it. As sea_radiance(), with the world's axes; distance_m: of the eye, which is
// at height_m above the sea at rest. Foam hides sky, sun and mirrored water, and is lit from both sides. Bubbles hang under it all as one
// thin layer, lit by what comes through the surface there.
SeaTerms sea_from_below(vec3 to_eye, vec3 normal, vec3 slope_variance, SeenFoam seen, SeenBody body, float height_m, float distance_m,
                        SeaLight light) {
    vec3 eye = upside_down(to_eye);
    SlopeFrame frame = slope_frame(facing_normal(vec3(-normal.x, -normal.y, normal.z), eye), slope_variance);
    vec3 v = into_frame(frame, eye);
    SeaTerms terms = SeaTerms(vec3(0.0f), vec3(0.0f), vec3(0.0f), vec3(0.0f));
    float clear = kWhitecaps ? 1.0f - seen.opacity : 1.0f;
    SkyFromBelow sky = sky_from_below(v, frame);
    terms.sky = clear * sky.sky;
    if (kSun) terms.sun = clear * sun_from_below(v, light.sun_direction, frame, light.sun_radiance, light.sun_angular_radius);
    WaterBetween between = water_between(vec3(0.0f), -to_eye, height_m, distance_m, 0.0f, light);
    if (kWater) {
        vec2 mean = mean_visible_slope(visible_slopes(v, frame.variance));
        vec3 f = normalize(vec3(-mean.x, -mean.y, 1.0f));
        vec3 mirrored = upside_down(out_of_frame(frame, 2.0f * dot(v, f) * f - v));
        mirrored = normalize(vec3(mirrored.x, mirrored.y, min(mirrored.z, -1.0e-3f)));
        // A facet's tilt turns the ray by twice as much.
        float mixed = 2.0f * sqrt(6.0f * max(slope_variance.x + slope_variance.y, 0.0f));
        terms.sea = clear * (1.0f - sky.through) * water_between(-distance_m * to_eye, mirrored, 0.0f, -1.0f, mixed, light).light;
    }
    if (kWhitecaps) {
        vec3 above = (light.sun_irradiance + light.sky_irradiance) / kPi;
        vec3 below = water_between(-distance_m * to_eye, vec3(0.0f, 0.0f, -1.0f), 0.0f, -1.0f, 1.0f, light).light;
        terms.foam = seen.opacity * kFoamColour * (kFoamLetsThrough * (1.0f - seen.white) * above + seen.white * below);
        float bubbles = bubbles_below(light.water, body);
        if (bubbles > 0.0f) {
            // Those between the surface and the eye.
            bubbles *= lost_by(distance_m * max(-to_eye.z, 0.0f) / light.water.bubbles_m);
            BubbleVeil veil = bubble_veil(bubbles, max(-to_eye.z, 0.0f));
            float in_sky = entering_from_sky(light.water.waves);
            float of_sun = refracted_cosine(light.sun_direction.z);
            float to_sun = water_sight(-to_eye, height_m, distance_m, light.sun_direction, light.water).to_sun;
            vec3 sun = light.sun_irradiance *
                       (entering(vec3(light.sun_direction.x, light.sun_direction.y, max(light.sun_direction.z, 0.0f)), light.water.waves) *
                        ahead_of_bubbles(to_sun, bubbles, of_sun) / of_sun);
            vec3 sky_light = light.sky_irradiance * (in_sky / kPi) + (1.0f - in_sky / square(kWaterIndex)) * below;
            vec3 hung = veil.spread * (clear * (sun + sky_light) + terms.foam) + veil.back * below;
            terms.sun *= veil.sharp;
            terms.sky *= veil.sharp;
            terms.sea *= veil.sharp;
            terms.foam *= veil.sharp;
            if (kWater) terms.sea += hung;
        }
    }
    terms.sun *= between.left;
    terms.sky *= between.left;
    terms.sea *= between.left;
    terms.foam *= between.left;
    if (kWater) terms.sea += between.light;
    return terms;
}
