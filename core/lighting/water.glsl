// Light scattered back out of the water, as L_sea of Bruneton et al. 2010, Eq. 28, with the transmission at the surface.

// ---- Of one constant, without a body

// The radiance just above the surface, before the factor (1 − F̄) of transmission outwards. Sunlight enters
// through a level sea (exact Fresnel term), skylight with the factor 1 − kDiffuseFresnel. The water sends the
// share `reflectance` of the downward light back up, isotropically. The underside of the surface reflects
// 0.48 of that down again (mostly total reflection), and so on. Leaving the water divides radiance by n².
vec3 water_radiance(vec3 to_sun, vec3 sun_irradiance, vec3 sky_irradiance, vec3 reflectance) {
    vec3 down =
        sun_irradiance * (1.0f - fresnel_exact(to_sun.z, kWaterIndex)) + sky_irradiance * (1.0f - kDiffuseFresnel);
    vec3 up = reflectance * down / (1.0f - 0.48f * reflectance);
    return up / (kPi * kWaterIndex * kWaterIndex);
}

// ---- Of a body: core/lighting/water.h says what is in it

// Three wavelengths each: 440, 480, 520 nm, and 555, 590, 630 nm.
struct WaterBands {
    vec3 shorter;
    vec3 longer;
};

struct WaterLook {
    vec3 reflectance;  // without a body: diffuse, just below the surface
    bool has_body;
    WaterBands absorption;      // a [1/m]
    WaterBands backscatter;     // b_b [1/m]
    WaterBands scattering;      // b [1/m]
    WaterBands floor_colour;    // reflectance of the floor, diffuse
    float floor_m;              // how deep it lies; kNoFloor_m and more: there is none
    vec3 waves;                 // slope variances (xx, yy, xy) of all waves
    float crest_light;          // times what waves' shape does to the sun's light in the water; 0: it is as level water's
    float crest_per_m;          // wavenumber of the waves that have crests [1/m], 0: none
    float bubbles;              // times the backscatter of bubbles; 0: none
    float bubbles_m;            // their depth, e-folding
};

// What a place of the sea has, beside its shape and its foam.
struct SeenBody {
    vec3 from_eye;  // [m]
    float pixel_m;  // as wide as a pixel there
    vec3 crest;   // of the long waves: slopes and height [m]
    float fresh;  // coverage of what breaks now; where one knows the bubbles that earlier breaking has left, with these, of 1 where all breaks
    float old;    // where one doesn't: coverage of what it has left of foam
    float age_s;  // of the latter
};

SeenBody no_crest_nor_bubbles() {
    return SeenBody(vec3(0.0f), 0.0f, vec3(0.0f), 0.0f, 0.0f, 0.0f);
}

const float kNoFloor_m = 1.0e6f;

// Rec. 709 of a spectrum at the six wavelengths, of which white is 1 everywhere: a fit to the observer's integral over spectra that
// water makes (transmittances of 105 waters over paths to 25 m), to 0.006. Blues outside the gamut have a negative red.
vec3 colour_of(WaterBands of) {
    return vec3(dot(vec3(0.1158f, -0.2020f, -0.1900f), of.shorter) + dot(vec3(0.1239f, 0.3314f, 0.8208f), of.longer),
                dot(vec3(-0.1265f, 0.1778f, 0.3372f), of.shorter) + dot(vec3(0.5619f, 0.1017f, -0.0521f), of.longer),
                dot(vec3(0.8196f, 0.2605f, 0.0272f), of.shorter) + dot(vec3(-0.0372f, -0.0654f, -0.0047f), of.longer));
}

// What red, green and blue of 1 are at these wavelengths: three smooth functions of which colour_of() gives the colour back, and whose sum is 1.
WaterBands bands_of(vec3 colour) {
    float r = colour.x;
    float g = colour.y;
    float b = colour.z;
    return WaterBands(clamp(r * vec3(0.0516f, 0.0290f, -0.0388f) + g * vec3(-0.0255f, 0.2116f, 0.9227f) + b * vec3(0.9739f, 0.7594f, 0.1161f),
                            vec3(0.0f), vec3(1.0f)),
                      clamp(r * vec3(-0.0117f, 0.6852f, 0.9342f) + g * vec3(1.1012f, 0.2819f, -0.0108f) + b * vec3(-0.0895f, 0.0329f, 0.0766f),
                            vec3(0.0f), vec3(1.0f)));
}

// Of what falls on a rough sea from a direction (in its level frame) the part that enters: by reciprocity what an eye there wouldn't
// see mirrored under a uniform sky.
float entering(vec3 direction, vec3 variance) {
    return 1.0f - shown_of_uniform_sky(direction, variance);
}

// The same of a uniform sky: a fit to its integral for slope variances up to 0.12, to 3e-4.
float entering_from_sky(vec3 variance) {
    return 1.0f - 0.0674f / (1.0f + 2.90f * pow(max(variance.x + variance.y, 0.0f), 0.82f));
}

// Cosine in the water of a direction through a level surface.
float refracted_cosine(float cosine) {
    return sqrt(1.0f - (1.0f - square(clamp(cosine, 0.0f, 1.0f))) / square(kWaterIndex));
}

// How the light goes through the water.
struct WaterWay {
    float sun;        // 1/cosine below the surface: of the sun's light on its way down, and of what the eye sees
    float eye;
    float returned;   // of what comes up, the part that the surface sends down again
    float crest_m;    // through a crest, and the wavenumber of waves that have such
    float crest_per_m;
    float bubbles;    // ¾ of their cross-section over the volume: b_g L [-], times the coverage of the foam over them
    float bubbles_m;
    float floor_m;
    vec3 gathered;  // the sun's light on the floor over its mean, less 1
};

// Upward radiance just below the surface over the irradiance that enters there: of the sun, of the sky, of the sun through a crest, and
// the part of the sun's that entered so near that waves' shape shows.
struct WaterBack {
    vec3 sun;
    vec3 sky;
    vec3 crest;
    vec3 near;
};

// 1/cosine that stands for all light of a uniform sky below the surface. Its mean there is 2n²(1 − √(1 − 1/n²)) = 1.20; slanted light is
// lost first, so that less serves a column better.
const float kSkySlant = 1.17f;

// What bubbles of that b_g L add to a reflectance, t/(1 + 0.7 t) of what is left of 1. dim: 1.1 κ/µ L, light that is lost among them. A fit of
// clean bubbles (g = 0.655) in an exponential profile, for b_g L of 0.02 … 9, which no bench of ours judges: beyond, all comes back.
vec3 bubbles_add(float bubbles, vec3 dim) {
    vec3 t = 0.17f * bubbles / (1.0f + 4.0f * dim);
    return min(t / (1.0f + 0.7f * t), vec3(1.0f));
}

// Backscatter of sea water itself at the six wavelengths [1/m] (Morel 1974).
const vec3 kOwnShorter = vec3(2.501e-3f, 1.718e-3f, 1.216e-3f);
const vec3 kOwnLonger = vec3(9.17e-4f, 7.04e-4f, 5.31e-4f);

// Radiance out of deep water, by 1/cosine of both ways less 1. Water itself scatters as much back as on, particles mostly on: the part
// of the backscatter that is water's own weighs the two. The same if sun and eye change places. Fitted to a Monte Carlo
// (tests/bench/README.md, the water), rms 2 %.
vec3 out_of_deep(vec3 u, vec3 own, float sun, float eye) {
    vec3 particles = (0.072f + 0.21f * u) * (1.0f + 0.418f * (sun + eye) + 2.26f * sun * eye);
    vec3 water = (0.113f + 0.017f * u) * (1.0f - 0.207f * (sun + eye) + 1.1f * sun * eye);
    return u * mix(particles, water, own);
}

// Of scattered light the part that an eye still takes for light that wasn't: particles send 0.47 of theirs within 6° on.
const float kScatteredAside = 0.53f;

// What is left of a pattern of light after so long a way: all but what is scattered aside. own: backscatter of sea water itself.
vec3 left_gathered(vec3 scattering, vec3 own, float way_m) {
    return exp((-kScatteredAside * way_m) * max(scattering - 2.0f * own, vec3(0.0f)));
}

// At three wavelengths. own: of the backscatter that of sea water itself. A column: Lee et al. 1998 and 1999, with constants of the same
// Monte Carlo; the floor reflects diffusely.
WaterBack water_back(vec3 absorption, vec3 backscatter, vec3 own, vec3 floor_colour, WaterWay way) {
    vec3 both = absorption + backscatter;
    vec3 u = backscatter / both;
    vec3 part = min(own / backscatter, vec3(1.0f));
    vec3 sun = out_of_deep(u, part, way.sun - 1.0f, way.eye - 1.0f);
    vec3 sky = out_of_deep(u, part, kSkySlant - 1.0f, way.eye - 1.0f);
    vec3 diffuse = (0.33f * kSkySlant) * u;
    if (way.floor_m < kNoFloor_m) {
        vec3 depth = both * way.floor_m;
        float scattered = 0.954f;
        vec3 reflected = 1.02f * sqrt(1.0f + 4.7f * u);
        vec3 bare = floor_colour / kPi;
        sun = sun * (1.0f - exp(-depth * (way.sun + way.eye * scattered))) +
              bare * (1.0f + way.gathered) * exp(-depth * (way.sun + way.eye * reflected));
        sky = sky * (1.0f - exp(-depth * (kSkySlant + way.eye * scattered))) +
              bare * exp(-depth * (kSkySlant + way.eye * reflected));
        // Up and down again it goes at all angles.
        diffuse = diffuse * (1.0f - exp(-depth * (kSkySlant + 2.0f * scattered))) +
                  floor_colour * exp(-depth * (kSkySlant + 2.0f * reflected));
    }
    if (way.bubbles > 0.0f) {
        vec3 dim = (1.1f * way.sun * way.bubbles_m) * both;
        vec3 more = (1.0f - diffuse) * bubbles_add(way.bubbles, dim);
        sun += more / kPi;
        sky += more / kPi;
        diffuse += more;
    }
    vec3 again = 1.0f / (1.0f - way.returned * diffuse);
    sun *= again;
    return WaterBack(sun, sky * again, sun * exp(-way.crest_m * (0.4f * absorption + 0.9f * backscatter)),
                     sun * (both / (both + 0.75f * way.crest_per_m)));
}

// Sunlight that enters a wave with crests, over its irradiance across the sun's beam: at the place itself, which is what comes back where
// light goes less far than waves are long, and on a crest's other side, for the eye that looks through it towards a low sun: how
// much of such a face the place is, and how far that light goes in the crest. Fitted to a Monte Carlo of steep waves in two dimensions
// (tests/bench/README.md, the water).
struct CrestLight {
    float here;
    float through;
    float share;
    float way_m;
};

CrestLight light_at_crest(vec3 to_eye, vec3 to_sun, vec3 crest, float per_m, vec3 variance) {
    float level = sqrt(to_sun.x * to_sun.x + to_sun.y * to_sun.y);
    if (!(level > 1.0e-3f)) level = 1.0e-3f;
    vec2 ahead = vec2(to_sun.x, to_sun.y) / level;
    float slope = crest.x * ahead.x + crest.y * ahead.y;
    float height = per_m * crest.z;
    float steepness = max(sqrt(slope * slope + height * height), 1.0e-4f);
    float phase = abs(atan(abs(slope), height + 1.0e-6f));  // from the crest, as of a sine; a slope of −0 has −π in a trough
    float behind = 0.5f * steepness;                   // slope of the face that the sun enters
    float there = (behind * level + to_sun.z) * inversesqrt(1.0f + behind * behind);
    float here = (to_sun.z - slope * level) * inversesqrt(1.0f + crest.x * crest.x + crest.y * crest.y);
    float lit = 0.0f;
    if (here > 0.0f) {
        float across = sqrt(max(1.0f - here * here, 0.0f));
        lit = here * entering(vec3(ahead * across, here), variance);
    }
    float towards = max(-(to_eye.x * ahead.x + to_eye.y * ahead.y), 0.0f);
    // Waves less steep than some 0.1 have no crests to look through; faces that lean from the eye show none: both by eye.
    float share = smoothstep(0.0f, 0.15f, steepness) * towards * smoothstep(-0.5f, 0.5f, slope / steepness);
    return CrestLight(lit, 1.25f * (1.0f - fresnel_exact(there, kWaterIndex)) * there, share, 2.0f * phase / per_m);
}

// ¾ of the bubbles' cross-section over the volume at the surface [1/m], by the age of the foam above them. Clouds begin with a void fraction
// of 3e-3, which is known to an order of magnitude (1e-3 … 1e-2): more makes storms milk.
float bubbles_per_m(float age_s, float depth_m) {
    return 3.75f * bubbles_left(age_s, depth_m);
}

// Below such a place: WaterWay::bubbles.
float bubbles_below(WaterLook look, SeenBody seen) {
    return look.bubbles * look.bubbles_m *
           (seen.fresh * bubbles_per_m(0.0f, look.bubbles_m) + seen.old * bubbles_per_m(seen.age_s, look.bubbles_m));
}

// The radiance just above the surface, before the factor (1 − F̄) of transmission outwards: level axes, the normal facing the eye.
// sun_beam: the sun's irradiance across its beam. hidden: slope variances of unresolved waves.
vec3 body_radiance(vec3 to_eye, vec3 normal, vec3 to_sun, vec3 sun_irradiance, vec3 sun_beam, vec3 sky_irradiance, WaterLook look,
                   FloorView of_floor, vec3 hidden, SeenBody seen) {
    WaterWay way;
    float in_sky = entering_from_sky(look.waves);
    way.returned = 1.0f - in_sky / square(kWaterIndex);
    way.sun = 1.0f / refracted_cosine(to_sun.z);
    // Snell's ray through the facet, which is never less steep than a level one's.
    float facing = clamp(dot(normal, to_eye), 0.0f, 1.0f);
    float below = refracted_cosine(facing);
    vec3 up_ray = to_eye / kWaterIndex + (below - facing / kWaterIndex) * normal;
    float down = clamp(up_ray.z, 0.3f, 1.0f);
    way.eye = 1.0f / down;
    way.floor_m = look.floor_m;
    way.gathered = vec3(0.0f);
    vec3 gathered = vec3(0.0f);
    WaterBands bare = look.floor_colour;
    if (look.floor_m < kNoFloor_m && is_floor_near(seen.from_eye, of_floor)) {
        // A facet's tilt moves the ray by (1 − 1/n) of it; a normal distribution of variance v is as wide as a box of √(12 v).
        float blur = (1.0f - 1.0f / kWaterIndex) * sqrt(6.0f * max(hidden.x + hidden.y, 0.0f));
        SeenFloor there = seen_floor(seen.from_eye, vec2(up_ray.x, up_ray.y) / -down, blur, seen.pixel_m, of_floor);
        way.floor_m = there.depth_m;
        way.gathered = (there.light - 1.0f) * left_gathered(look.scattering.shorter, kOwnShorter, way.floor_m * way.sun);
        gathered = (there.light - 1.0f) * left_gathered(look.scattering.longer, kOwnLonger, way.floor_m * way.sun);
        if (of_floor.colours.w > 0.0f) {
            WaterBands picture = bands_of(there.colour);
            bare = WaterBands(bare.shorter * picture.shorter, bare.longer * picture.longer);
        }
    }
    way.bubbles_m = look.bubbles_m;
    way.bubbles = bubbles_below(look, seen);
    bool has_crests = look.crest_light > 0.0f && look.crest_per_m > 0.0f && to_sun.z > 0.0f;
    CrestLight crest = CrestLight(0.0f, 0.0f, 0.0f, 0.0f);
    if (has_crests) crest = light_at_crest(to_eye, to_sun, seen.crest, look.crest_per_m, look.waves);
    way.crest_m = crest.way_m;
    way.crest_per_m = look.crest_per_m;

    WaterBack shorter = water_back(look.absorption.shorter, look.backscatter.shorter, kOwnShorter, bare.shorter, way);
    way.gathered = gathered;
    WaterBack longer = water_back(look.absorption.longer, look.backscatter.longer, kOwnLonger, bare.longer, way);
    vec3 into = sun_irradiance * entering(vec3(to_sun.x, to_sun.y, max(to_sun.z, 0.0f)), look.waves);
    vec3 back = colour_of(WaterBands(shorter.sun, longer.sun));
    vec3 of_sun = into * back;
    if (has_crests) {
        vec3 near = colour_of(WaterBands(shorter.near, longer.near));
        vec3 through = colour_of(WaterBands(shorter.crest, longer.crest));
        of_sun += look.crest_light *
                  (sun_beam * (crest.here * near + crest.share * crest.through * through) -
                   into * (near + crest.share * (back - near)));
    }
    vec3 of_sky = sky_irradiance * in_sky * colour_of(WaterBands(shorter.sky, longer.sky));
    return (max(of_sun, vec3(0.0f)) + max(of_sky, vec3(0.0f))) / square(kWaterIndex);
}
