#include "core/lighting/lighting.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <glm/glm.hpp>
#include <stdexcept>
#include <utility>

#include "core/lighting/air.h"
#include "core/lighting/meniscus.h"

namespace pelagic {
namespace sea_shading {

using namespace glm;

// The shared source as members of a struct: an instance for each Fresnel term and number of sky lookups, whose loops
// then unroll. The terms are chosen at run time, which costs 3 % of the time per point; a variant for each as well took
// seven times as long to compile.
template <FresnelFit kFresnel, SkyQuality kSkyQuality>
struct Shading {
    explicit Shading(const SkyMap& sky_map, const Air* of_air = nullptr, const LightingChoice& choice = {},
                     const FoamImage* of_foam = nullptr, std::span<const float> of_floor = {})
        : map(sky_map),
          seen_air(of_air),
          foam_image(of_foam),
          floor_values(of_floor),
          kSkyMapSize(static_cast<float>(sky_map.size())),
          kSun(choice.sun),
          kSky(choice.sky),
          kWater(choice.water),
          kWhitecaps(choice.whitecaps),
          kSecondReflection(choice.second_reflection),
          kMeshMasking(choice.mesh_masking) {}

    static constexpr int kAirColumns = Air::kColumns, kAirRows = Air::kRows, kAirSkyRows = Air::kSkyRows,
                         kAirHorizonRow = Air::kHorizonRow;

    static constexpr bool kExactFresnel = kFresnel == FresnelFit::Exact;
    static constexpr int kSkyLookups = kSkyQuality == SkyQuality::One    ? 1
                                       : kSkyQuality == SkyQuality::Nine ? 9
                                                                         : 0;
    const SkyMap& map;
    const Air* seen_air;
    const FoamImage* foam_image;
    const std::span<const float> floor_values;
    const float kSkyMapSize;
    const bool kSun, kSky, kWater, kWhitecaps, kSecondReflection, kMeshMasking;

    vec3 sky_lookup(vec2 u, float level) const { return map.radiance(u, level); }
    float foam_image_texel(int x, int y) const {
        return foam_image->texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(foam_image->side) +
                                  static_cast<std::size_t>(x)];
    }
    float floor_value(int i) const { return floor_values[static_cast<std::size_t>(i)]; }
    vec4 air_texel(int column, int row) const {
        return seen_air
            ->texels[static_cast<std::size_t>(row) * Air::kWidth + static_cast<std::size_t>(column)];
    }

// The order matters: each file uses those before it.
// clang-format off
#include "core/lighting/special.glsl"
#include "core/lighting/level.glsl"
#include "core/lighting/fresnel.glsl"
#include "core/lighting/slopes.glsl"
#include "core/lighting/sun.glsl"
#include "core/lighting/sky.glsl"
#include "core/lighting/floor.glsl"
#include "core/base/bubbles.inl"
#include "core/lighting/water.glsl"
#include "core/lighting/foam.glsl"
#include "core/lighting/foam_structure.glsl"
#include "core/lighting/sea.glsl"
#include "core/lighting/air.glsl"
#include "core/lighting/place.glsl"
#include "core/lighting/below.glsl"
    // clang-format on
};

template <class Variant>
typename Variant::WaterBands bands(const WaterBands& of) {
    return {of.shorter, of.longer};
}

template <class Variant>
typename Variant::WaterLook look_of(const WaterBody& water) {
    return {water.reflectance,
            water.has_body,
            bands<Variant>(water.absorption),
            bands<Variant>(water.backscatter),
            bands<Variant>(water.scattering),
            bands<Variant>(water.floor_colour),
            water.floor_m,
            water.waves,
            water.crest_light,
            water.crest_per_m,
            water.bubbles,
            water.bubbles_m};
}

// Seen from 45°, as most of what a camera above the sea sees of the water below it is.
constexpr float kSeenFrom = 0.70710678f;

glm::vec3 reflectance_of(const WaterBody& water) {
    using Variant = Shading<FresnelFit::Exact, SkyQuality::One>;
    const SkyMap none;
    Variant shading(none);
    typename Variant::WaterWay way{};
    way.sun = 1.0f;
    way.eye = 1.0f / shading.refracted_cosine(kSeenFrom);
    way.floor_m = water.floor_m;
    const auto back = [&](const glm::vec3& absorption, const glm::vec3& backscatter, const glm::vec3& own,
                          const glm::vec3& floor) {
        return shading.water_back(absorption, backscatter, own, floor, way).sky;
    };
    const glm::vec3 seen = shading.colour_of({back(water.absorption.shorter, water.backscatter.shorter,
                                                   shading.kOwnShorter, water.floor_colour.shorter),
                                              back(water.absorption.longer, water.backscatter.longer,
                                                   shading.kOwnLonger, water.floor_colour.longer)});
    return glm::clamp(shading.kPi * seen, vec3(0.0f), vec3(1.0f));
}

SeaAlbedo albedo(const WaterBody& body) {
    using Variant = Shading<FresnelFit::Exact, SkyQuality::One>;
    const SkyMap none;
    Variant shading(none);
    // Of irradiance π the radiance is the albedo.
    const vec3 up(0.0f, 0.0f, 1.0f), dark(0.0f), sky(shading.kPi);
    const glm::vec3 water = body.has_body
                                ? shading.body_radiance({kSeenFrom, 0.0f, kSeenFrom}, up, up, dark, dark, sky,
                                                        look_of<Variant>(body), typename Variant::FloorView{},
                                                        dark, shading.no_crest_nor_bubbles())
                                : shading.water_radiance(up, dark, sky, body.reflectance);
    return {.water = water,
            .foam = glm::mix(water, shading.kWhiteFoam * shading.kFoamColour, shading.kFoamOpacity),
            .water_index = shading.kWaterIndex};
}

template <class Variant>
typename Variant::SeaLight light_of(const Sky& sky, const WaterBody& water, const FloorSeen& floor) {
    return {sky.sun_direction,
            sky.sun_radiance,
            sky.sun_angular_radius,
            sky.sun_irradiance,
            sky.sky_irradiance,
            look_of<Variant>(water),
            {floor.is_seen, floor.z_m, floor.curvature_per_m, floor.pixel, floor.lowest_m, floor.depths,
             floor.depths_per_m, floor.colours, floor.colours_first, floor.light, floor.coarse, floor.shafts,
             floor.shafts_look}};
}

template <class Variant>
typename Variant::FoamPattern pattern_of(const FoamPattern& foam) {
    return {foam.cell, foam.rest, foam.axes, foam.look, foam.white, foam.image};
}

template <class Variant>
typename Variant::SeenFoam foam_at(Variant& shading, const LightingChoice& choice,
                                   const typename Variant::FoamPattern& pattern, const SeaPoint& p,
                                   const Sky& sky) {
    if (!choice.whitecaps) return shading.no_foam();
    return shading.seen_foam(pattern, p.rest_m, p.pixel_m, p.coverage, p.active, p.age_s, sky.sun_direction);
}

template <class Variant>
typename Variant::SeenBody seen_body(Variant& shading, const WaterBody& water, const SeaPoint& p) {
    const float covered = water.bubbles > 0.0f ? std::clamp(p.coverage, 0.0f, 1.0f) : 0.0f,
                fresh = std::min(covered, std::max(p.active, 0.0f));
    // Water that breaks has no more of them than that: clouds that overlap are one.
    const bool is_sum = water.bubbles > 0.0f && p.bubbles >= 0.0f;
    return {p.from_eye_m,
            shading.pixel_over(p.pixel_m),
            p.crest,
            is_sum ? std::min(fresh + p.bubbles, 1.0f) : fresh,
            is_sum ? 0.0f : covered - fresh,
            p.age_s};
}

void albedo_batch(const Sky& sky, const WaterBody& water, std::span<const SeaPoint> points,
                  std::span<glm::vec3> albedo) {
    using Variant = Shading<FresnelFit::Exact, SkyQuality::One>;
    const SkyMap none;
    Variant shading(none);
    typename Variant::WaterLook look = look_of<Variant>(water);
    const vec3 scale = shading.kPi / max(sky.sun_irradiance + sky.sky_irradiance, vec3(1e-12f));
    const vec3 beam = (shading.kPi * shading.square(sky.sun_angular_radius)) * sky.sun_radiance;
    const auto of = [&](const SeaPoint& p, const typename Variant::SeenBody& body) {
        const vec3 light =
            look.has_body ? shading.body_radiance(p.to_eye, p.normal, sky.sun_direction, sky.sun_irradiance,
                                                  beam, sky.sky_irradiance, look, {}, vec3(0.0f), body)
                          : shading.water_radiance(sky.sun_direction, sky.sun_irradiance, sky.sky_irradiance,
                                                   look.reflectance);
        return clamp(light * scale, vec3(0.0f), vec3(1.0f));
    };
    const bool is_level = std::all_of(points.begin(), points.end(), [&](const SeaPoint& p) {
        return p.crest == vec3(0.0f) && p.to_eye == points.front().to_eye &&
               p.normal == points.front().normal;
    });
    if (!is_level) {
        for (std::size_t i = 0; i < points.size(); ++i)
            albedo[i] = of(points[i], seen_body(shading, water, points[i]));
        return;
    }
    // Nothing but bubbles differs: as much as so much foam has that breaks now. By steps of its root, straight between them, to 1e-4.
    look.crest_light = 0.0f;  // which level water doesn't know, and takes time
    constexpr int kSteps = 32;
    std::array<vec3, kSteps + 1> by_foam;
    for (int step = 0; step <= kSteps && !points.empty(); ++step)
        by_foam[static_cast<std::size_t>(step)] =
            of(points.front(),
               {vec3(0.0f), 0.0f, vec3(0.0f), shading.square(static_cast<float>(step) / kSteps), 0.0f, 0.0f});
    const float now = shading.bubbles_per_m(0.0f, look.bubbles_m);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const typename Variant::SeenBody body = seen_body(shading, water, points[i]);
        float foam = body.fresh;
        if (body.old > 0.0f) foam += body.old * shading.bubbles_per_m(body.age_s, look.bubbles_m) / now;
        const float place = kSteps * std::sqrt(std::clamp(foam, 0.0f, 1.0f));
        const auto step = std::min(static_cast<std::size_t>(place), std::size_t{kSteps - 1});
        albedo[i] = mix(by_foam[step], by_foam[step + 1], place - static_cast<float>(step));
    }
}

using Batch = void (*)(const LightingChoice&, const Sky&, const WaterBody&, std::span<const SeaPoint>,
                       std::span<SeaRadiance>, const Air*, const FoamPattern&, const FloorSeen&);

template <FresnelFit kFresnel, SkyQuality kSkyQuality>
void shade_batch(const LightingChoice& choice, const Sky& sky, const WaterBody& water,
                 std::span<const SeaPoint> points, std::span<SeaRadiance> radiance, const Air* air,
                 const FoamPattern& foam, const FloorSeen& floor) {
    using Variant = Shading<kFresnel, kSkyQuality>;
    const bool by_place = air && air->by_place > 0.0f;
    Variant shading(sky.map, air, choice, foam.picture, floor.values);
    const typename Variant::PlaceView place{by_place ? air->to_sun : sky.sun_direction,
                                            by_place ? air->by_place : 0.0f};
    const auto light = light_of<Variant>(sky, water, floor);
    const auto pattern = pattern_of<Variant>(foam);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const SeaPoint& p = points[i];
        const typename Variant::SeenFoam seen = foam_at(shading, choice, pattern, p, sky);
        typename Variant::SeenBody body = seen_body(shading, water, p);
        if (!choice.whitecaps) body.fresh = body.old = 0.0f;
        const glm::vec3 to_eye = shading.levelled(p.to_eye, p.up);
        const typename Variant::SeaTerms terms = shading.sea_radiance_at(
            p.up, to_eye, shading.visible_normal(p.normal, to_eye, p.slope_variance_at_rest, p.mesh_variance),
            p.slope_variance, seen, body, light, place);
        radiance[i] = {terms.sun, terms.sky, terms.sea, terms.foam};
    }
}

// The inverse of the normal distribution, to 5e-4 (Abramowitz and Stegun 26.2.23).
float normal_below(float share) {
    const float tail = std::clamp(std::min(share, 1.0f - share), 1e-6f, 0.5f);
    const float t = std::sqrt(-2.0f * std::log(tail));
    const float y = t - (2.515517f + t * (0.802853f + t * 0.010328f)) /
                            (1.0f + t * (1.432788f + t * (0.189269f + t * 0.001308f)));
    return share < 0.5f ? -y : y;
}

using OfFacets = Shading<FresnelFit::Exact, SkyQuality::Nine>;

// Below there is one variant.
using FromBelow = Shading<FresnelFit::Exact, SkyQuality::Nine>;

}  // namespace sea_shading

void shade_sea_from_below(const LightingChoice& choice, const Sky& sky, const WaterBody& water,
                          float height_m, std::span<const SeaPoint> points, std::span<const float> distance_m,
                          std::span<SeaRadiance> radiance, const FoamPattern& foam, const FloorSeen& floor) {
    using Variant = sea_shading::FromBelow;
    if (points.size() != radiance.size() || points.size() != distance_m.size())
        throw std::invalid_argument(
            "shade_sea_from_below: give a distance and one SeaRadiance for each SeaPoint");
    if (choice.sky && sky.map.size() == 0)
        throw std::invalid_argument("shade_sea_from_below: the sky has no map");
    Variant shading(sky.map, nullptr, choice, foam.picture, floor.values);
    const auto light = sea_shading::light_of<Variant>(sky, water, floor);
    const auto pattern = sea_shading::pattern_of<Variant>(foam);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const SeaPoint& p = points[i];
        const glm::vec3 to_eye = shading.levelled(p.to_eye, p.up);
        const glm::vec3 down(-p.normal.x, -p.normal.y, p.normal.z);
        const glm::vec3 seen = shading.visible_normal(down, shading.upside_down(to_eye),
                                                      p.slope_variance_at_rest, p.mesh_variance);
        const typename Variant::SeaTerms terms =
            shading.sea_from_below(to_eye, {-seen.x, -seen.y, seen.z}, p.slope_variance,
                                   sea_shading::foam_at(shading, choice, pattern, p, sky),
                                   sea_shading::seen_body(shading, water, p), height_m, distance_m[i], light);
        radiance[i] = {terms.sun, terms.sky, terms.sea, terms.foam};
    }
}

void shade_water(const LightingChoice& choice, const Sky& sky, const WaterBody& water, float height_m,
                 std::span<const glm::vec3> direction, std::span<SeaRadiance> radiance,
                 const FloorSeen& floor) {
    using Variant = sea_shading::FromBelow;
    if (direction.size() != radiance.size())
        throw std::invalid_argument("shade_water: give one SeaRadiance for each direction");
    Variant shading(sky.map, nullptr, choice, nullptr, floor.values);
    const auto light = sea_shading::light_of<Variant>(sky, water, floor);
    for (std::size_t i = 0; i < direction.size(); ++i) {
        radiance[i] = {};
        if (choice.water)
            radiance[i].sea =
                shading.water_between(glm::vec3(0.0f), direction[i], height_m, -1.0f, 0.0f, light).light;
    }
}

float meniscus_share(double height_m) {
    return static_cast<float>(
        std::clamp((kMeniscus_m + kMeniscusBlur_m - height_m) / (2.0 * kMeniscusBlur_m), 0.0, 1.0));
}

SeaRadiance mixed(const SeaRadiance& a, const SeaRadiance& b, float share) {
    return {glm::mix(a.sun, b.sun, share), glm::mix(a.sky, b.sky, share), glm::mix(a.sea, b.sea, share),
            glm::mix(a.foam, b.foam, share), glm::mix(a.air, b.air, share)};
}

void shade_meniscus(const LightingChoice& choice, const Sky& sky, const WaterBody& water, float height_m,
                    glm::vec3 forward, std::span<const MeniscusSight> sights, std::span<SeaRadiance> radiance,
                    const FloorSeen& floor) {
    using Variant = sea_shading::FromBelow;
    if (sights.size() != radiance.size())
        throw std::invalid_argument("shade_meniscus: give one SeaRadiance for each sight");
    if (choice.sky && sky.map.size() == 0) throw std::invalid_argument("shade_meniscus: the sky has no map");
    Variant shading(sky.map, nullptr, choice, nullptr, floor.values);
    const auto light = sea_shading::light_of<Variant>(sky, water, floor);
    const float n = shading.kWaterIndex;
    // The wedge turns sights by 40° a millimetre, over which the lens mixes them.
    constexpr float kMixed = 0.6f;
    const auto below = [&](glm::vec3 direction, float mixed) {
        if (!choice.water) return glm::vec3(0.0f);
        return kBehindGlass *
               shading.water_between(glm::vec3(0.0f), direction, height_m, -1.0f, mixed, light).light;
    };
    const auto above = [&](glm::vec3 direction) {
        return choice.sky ? shading.sky_lookup(shading.sky_place(direction), 0.0f) : glm::vec3(0.0f);
    };
    // Water doesn't climb a glass that looks straight up or down.
    const glm::vec3 across(forward.x, forward.y, 0.0f);
    const glm::vec3 side = glm::length(across) > 1e-3f ? glm::normalize(across) : glm::vec3(0.0f);
    for (std::size_t i = 0; i < sights.size(); ++i) {
        radiance[i] = {};
        const glm::vec3 d = sights[i].direction;
        const auto climbed = static_cast<double>(sights[i].height_m);
        const auto inclined =
            static_cast<float>(2.0 * std::asin(std::clamp(climbed, 0.0, kMeniscus_m) / (2.0 * kCapillary_m)));
        const glm::vec3 normal =
            glm::normalize(std::sin(inclined) * side + glm::vec3(0.0f, 0.0f, std::cos(inclined)));
        const float cosine = glm::dot(d, normal);
        if (cosine <= 0.0f) {
            radiance[i].sea = below(d, 0.0f);
            continue;
        }
        const float mirrored = shading.fresnel_exact(cosine, 1.0f / n);
        // A sight that goes steeply up is mirrored by so inclined water upwards, along the glass: level is as good.
        glm::vec3 inwards = d - 2.0f * cosine * normal;
        inwards = glm::normalize(glm::vec3(inwards.x, inwards.y, std::min(inwards.z, -1e-3f)));
        radiance[i].sea = mirrored * below(inwards, kMixed);
        if (mirrored >= 1.0f) continue;
        const float beyond = std::sqrt(std::max(1.0f - n * n * (1.0f - cosine * cosine), 0.0f));
        const glm::vec3 out = glm::normalize(n * d - (n * cosine - beyond) * normal);
        const float through = 1.0f - mirrored;
        if (out.z >= 0.0f) {
            radiance[i].sky = through * above(out);
            continue;
        }
        const float by_sea = shading.fresnel_exact(-out.z, n);
        radiance[i].sky = through * by_sea * above({out.x, out.y, -out.z});
        radiance[i].sea += through * (1.0f - by_sea) *
                           below({out.x / n, out.y / n, -shading.refracted_cosine(-out.z)}, kMixed);
    }
}

glm::vec3 water_lets_through(const WaterBody& water, float distance_m) {
    const SkyMap none;
    sea_shading::FromBelow shading(none);
    return shading.let_through_water(std::max(distance_m, 0.0f),
                                     sea_shading::light_of<sea_shading::FromBelow>({}, water, {}).water);
}

SeaAlbedo sea_albedo(const WaterBody& water) {
    return sea_shading::albedo(water);
}

WaterBands bands_of(const glm::vec3& colour) {
    const SkyMap none;
    const auto of = sea_shading::Shading<FresnelFit::Exact, SkyQuality::One>(none).bands_of(colour);
    return {of.shorter, of.longer};
}

float water_entering(const WaterBody& water, glm::vec3 from) {
    const SkyMap none;
    sea_shading::Shading<FresnelFit::Exact, SkyQuality::One> shading(none);
    from.z = std::max(from.z, 0.0f);
    return water.has_body ? shading.entering(from, water.waves)
                          : 1.0f - shading.fresnel_exact(from.z, shading.kWaterIndex);
}

glm::vec3 body_reflectance(const WaterBody& water) {
    return sea_shading::reflectance_of(water);
}

void water_albedo(const Sky& sky, const WaterBody& water, std::span<const SeaPoint> points,
                  std::span<glm::vec3> albedo) {
    if (points.size() != albedo.size())
        throw std::invalid_argument("water_albedo: give one albedo for each SeaPoint");
    sea_shading::albedo_batch(sky, water, points, albedo);
}

SeaFacets::SeaFacets(const LightingChoice& choice, const Sky& sky, const SeaPoint& p, const FoamPattern& foam)
    : up_(p.up) {
    using Variant = sea_shading::OfFacets;
    Variant shading(sky.map, nullptr, choice, foam.picture);
    const glm::vec3 to_eye = shading.levelled(p.to_eye, p.up);
    const glm::vec3 normal = shading.facing_normal(
        shading.visible_normal(p.normal, to_eye, p.slope_variance_at_rest, p.mesh_variance), to_eye);
    const Variant::SlopeFrame frame = shading.slope_frame(normal, p.slope_variance);
    x_ = frame.x;
    y_ = frame.y;
    normal_ = frame.normal;
    variance_ = frame.variance;
    to_eye_ = shading.into_frame(frame, to_eye);
    const Variant::VisibleSlopes seen = shading.visible_slopes(to_eye_, variance_);
    along_ = seen.along;
    across_ = seen.across;
    const Variant::MaskedView view = shading.masked_view(to_eye_, variance_);
    height_ = view.height;
    along2_ = view.along;
    area_ = view.area;
    clear_ =
        1.0f - sea_shading::foam_at(shading, choice, sea_shading::pattern_of<Variant>(foam), p, sky).opacity;
    first_ = std::max(-seen.tilt, -kFarthest);
    all_ = kFarthest - first_;
}

// Eq. 20 as sky_integral() has it, by chance: x along the line of sight from the steepest visible facet, evenly; y across it by its own
// distribution. That visible slopes have a density with the integral 1 (Eq. 11) makes the weights.
MirroredLight SeaFacets::mirrored(glm::vec2 place, std::size_t count) const {
    static const SkyMap none;
    sea_shading::OfFacets shading(none);
    const sea_shading::OfFacets::MaskedView view{height_, along2_, area_};
    const float each = clear_ * all_ / (std::sqrt(2.0f * shading.kPi) * static_cast<float>(count));
    const float x = first_ + all_ * place.x;
    const float facing = std::max(view.height + std::sqrt(view.along) * x, 0.0f);
    const glm::vec2 slope = across_ * sea_shading::normal_below(place.y) - along_ * x;
    const glm::vec3 f = glm::normalize(glm::vec3(-slope.x, -slope.y, 1.0f));
    const float cosine = std::max(glm::dot(to_eye_, f), 0.0f);
    const glm::vec3 r = 2.0f * cosine * f - to_eye_;
    const float nested = shading.nested_part(view, facing);
    const float lit =
        std::min(shading.lit_of(view, nested, facing, r, variance_), shading.visible_of(view, nested));
    const glm::vec3 level = shading.out_of_frame({x_, y_, normal_, variance_}, r);
    // levelled()'s inverse.
    const glm::vec3 both = up_ + glm::vec3(0.0f, 0.0f, 1.0f);
    return {.from = level - both * (glm::dot(both, level) / (1.0f + up_.z)) + 2.0f * level.z * up_,
            .weight = each * facing * std::exp(-0.5f * x * x) * shading.facet_fresnel(cosine) * lit};
}

// The half vector's slope ζ has dζ = dω/(4 cosθ f_z³), as a facet's solid angle is f_z³ dζ and its mirror image's 4 cosθ times that
// (Walter et al. 2007, Eq. 14).
SeaFacets::Part SeaFacets::from(const glm::vec3& direction, float spread) const {
    static const SkyMap none;
    sea_shading::OfFacets shading(none);
    const sea_shading::OfFacets::MaskedView view{height_, along2_, area_};
    const glm::vec3 l = shading.into_frame({x_, y_, normal_, variance_}, shading.levelled(direction, up_));
    const glm::vec3 half = to_eye_ + l;
    if (!(l.z > 0.0f) || !(half.z > 1e-4f)) return {};
    const float cosine = 0.5f * glm::length(half), upright = 0.5f * half.z / cosine;
    const glm::vec2 slope = -glm::vec2(half) / half.z;
    const float facing = cosine / upright;
    const float nested = shading.nested_part(view, facing);
    const float lit =
        std::min(shading.lit_of(view, nested, facing, l, variance_), shading.visible_of(view, nested));
    const float by_slope = 0.25f / (cosine * upright * upright * upright);
    const float wider = spread * spread;
    Part part;
    part.weight = clear_ * facing * shading.slope_density(slope, variance_ + glm::vec3(wider, wider, 0.0f)) *
                  shading.facet_fresnel(cosine) * lit * by_slope;
    // Of y's distribution by the slope, which is both's over x's.
    const float x = (facing - height_) / std::sqrt(along2_);
    if (x >= first_ && x <= kFarthest)
        part.density = shading.slope_density(slope, variance_) * std::sqrt(2.0f * shading.kPi) *
                       std::exp(0.5f * x * x) / all_ * by_slope;
    return part;
}

void shade_sea(const LightingChoice& choice, const Sky& sky, const WaterBody& water,
               std::span<const SeaPoint> points, std::span<SeaRadiance> radiance, const Air* air,
               const FoamPattern& foam, const FloorSeen& floor) {
    if (points.size() != radiance.size()) {
        throw std::invalid_argument("shade_sea: give one SeaRadiance for each SeaPoint");
    }
    if (choice.sky && sky.map.size() == 0) {
        throw std::invalid_argument(
            "shade_sea: the sky has no map; make one with daylight_sky() or picture_sky()");
    }
    // By FresnelFit, then by SkyQuality.
    static constexpr sea_shading::Batch kBatches[2][3] = {
        {sea_shading::shade_batch<FresnelFit(0), SkyQuality(0)>,
         sea_shading::shade_batch<FresnelFit(0), SkyQuality(1)>,
         sea_shading::shade_batch<FresnelFit(0), SkyQuality(2)>},
        {sea_shading::shade_batch<FresnelFit(1), SkyQuality(0)>,
         sea_shading::shade_batch<FresnelFit(1), SkyQuality(1)>,
         sea_shading::shade_batch<FresnelFit(1), SkyQuality(2)>}};
    kBatches[std::size_t(choice.fresnel)][std::size_t(choice.sky_quality)](choice, sky, water, points,
                                                                           radiance, air, foam, floor);
}

}  // namespace pelagic
