#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>

#include "core/base/random.h"
#include "core/lighting/air.h"
#include "core/lighting/background.h"
#include "core/lighting/spray.h"
#include "tracer_impl.h"

namespace pelagic::trace {
namespace {

constexpr float kWaterIndex = 1.34f;  // as core/lighting/special.glsl

// Of the exact, unpolarised term, from air into water.
float fresnel(float cosine) {
    const float c = std::clamp(cosine, 0.0f, 1.0f), g = std::sqrt(kWaterIndex * kWaterIndex + c * c - 1.0f);
    const float across = (g - c) / (g + c), along = (c * (g + c) - 1.0f) / (c * (g - c) + 1.0f);
    return 0.5f * across * across * (1.0f + along * along);
}

}  // namespace

// Off the surface: the sea's places are known to half a footprint.
RayQuery Tracer::Impl::from_place(const RayQuery& before, const RayAnswer& met, glm::vec3 towards) const {
    const float width_m = before.width.footprint_m + before.width.spread * met.distance_m;
    const float rises = std::max(std::abs(glm::dot(towards, met.normal)), 0.05f);
    return {.from = before.from + met.distance_m * before.towards,
            .towards = towards,
            .nearest_m = met.met == Met::Sea ? width_m / rises : 1e-3f + 1e-5f * met.distance_m,
            .width = {.footprint_m = width_m, .spread = before.width.spread}};
}

// Whether something is between the places that rays met and the middle of the sun.
std::vector<std::uint8_t> Tracer::Impl::in_shadow(std::span<const RayQuery> rays,
                                                  std::span<const RayAnswer> met) const {
    const glm::vec3 to_sun = light_.sky().sun_direction;
    std::vector<std::uint8_t> dark(met.size(), 0);
    if (light_.sky().sun_radiance == glm::vec3(0.0f)) return dark;
    std::vector<RayQuery> up(met.size());
    in_parallel(met.size(), [&](std::size_t i) { up[i] = from_place(rays[i], met[i], to_sun); });
    traced_->occluded(up, dark);
    return dark;
}

// The sun's light on the object, and the sky's where nothing hides any of it: half of it on an upright side.
glm::vec3 Tracer::Impl::sun_on(const RayAnswer& object, bool in_shadow) const {
    const Sky& sky = light_.sky();
    const float facing = glm::dot(object.normal, sky.sun_direction);
    if (in_shadow || !(facing > 0.0f)) return glm::vec3(0.0f);
    // Irradiance over π: the disc's solid angle is π r².
    return object.albedo * sky.sun_radiance * (sky.sun_angular_radius * sky.sun_angular_radius * facing);
}
glm::vec3 Tracer::Impl::sky_on(const RayAnswer& object) const {
    return object.albedo * light_.sky().sky_irradiance * ((0.5f + 0.5f * object.normal.z) / kPi_f);
}

glm::vec3 Tracer::Impl::sky_towards(glm::vec3 direction) const {
    return options_.picture.lighting.sky ? background(light_.sky(), direction, kWide).sky : glm::vec3(0.0f);
}

std::array<std::uint32_t, 4> Tracer::Impl::random(std::size_t sample, std::uint32_t what) const {
    const std::size_t in_picture = sample + static_cast<std::size_t>(first_row_) * view_.resolution.x;
    return {static_cast<std::uint32_t>(in_picture), static_cast<std::uint32_t>(in_picture >> 32),
            static_cast<std::uint32_t>(frame_), what};
}

// A facet of the sea that the eye sees, of hidden waves as of those that are shown, in the axes of the level there; nullopt where
// chance finds none.
std::optional<glm::vec3> Tracer::Impl::facet(std::size_t i, glm::vec3 to_eye) const {
    const glm::vec3 normal = light_.answers().vectors(Product::Normal)[i];
    const glm::vec3 variance = light_.answers().vectors(Product::SlopeVariance)[i];
    if (!(normal.z > 0.05f)) return std::nullopt;
    const glm::vec2 mean = -glm::vec2(normal) / normal.z;
    const float x = std::sqrt(std::max(variance.x, 0.0f)), mixed = x > 0.0f ? variance.z / x : 0.0f;
    const float y = std::sqrt(std::max(variance.y - mixed * mixed, 0.0f));
    const float most = to_eye.z - glm::dot(mean, glm::vec2(to_eye)) +
                       3.0f * std::sqrt(std::max(variance.x + variance.y, 0.0f));
    for (std::uint32_t tries = 0; tries < 8; ++tries) {
        const auto normals = normal_pair(random(on_sea_[i], 2 * tries), kSeed);
        const glm::vec2 hidden(x * static_cast<float>(normals[0]),
                               mixed * static_cast<float>(normals[0]) + y * static_cast<float>(normals[1]));
        const glm::vec2 slope = mean + hidden;
        // Seen in proportion to its area towards the eye.
        const float area = to_eye.z - glm::dot(slope, glm::vec2(to_eye));
        const float chance =
            static_cast<float>(philox(random(on_sea_[i], 2 * tries + 1), kSeed)[0] >> 8) * 0x1p-24f;
        if (area > chance * most) return glm::normalize(glm::vec3(-slope, 1.0f));
    }
    return std::nullopt;
}

// Of the air and the spray before each sample of the sea.
std::vector<glm::vec3> Tracer::Impl::transmittances() const {
    std::vector<SeaRadiance> white(on_sea_.size());
    for (SeaRadiance& one : white) one.sea = glm::vec3(1.0f);
    if (options_.picture.lighting.air) see_through(air_, seen_.to_eye, seen_.distance_m, white);
    see_through_spray(spray_, seen_.to_eye, seen_.distance_m, white);
    std::vector<glm::vec3> through(white.size());
    for (std::size_t i = 0; i < white.size(); ++i) through[i] = glm::max(white[i].sea, glm::vec3(1e-6f));
    return through;
}

// Rays from one facet of each sample of the sea. What the sea's own shading has of mirrored light is the sky's; what a mirrored ray
// meets in its place replaces it. Facets that mirror the ray down into their own wave are left to that shading, too.
void Tracer::Impl::mirror_and_refract(const std::vector<std::uint8_t>& dark) {
    const std::vector<glm::vec3> through = transmittances();
    const std::vector<float>& coverage = light_.answers().numbers(Product::Coverage);
    std::vector<std::optional<SecondRay>> mirrored(on_sea_.size());
    std::vector<RayQuery> below(on_sea_.size());
    std::vector<float> enters(on_sea_.size(), 0.0f);
    in_parallel(on_sea_.size(), [&](std::size_t i) {
        const std::size_t sample = on_sea_[i];
        const glm::vec3 up = seen_.up[i], view = seen_.to_eye[i];
        const auto found = facet(i, glm::vec3(to_level(glm::dvec3(view), glm::dvec3(up))));
        below[i].farthest_m = 0.0f;
        if (!found) return;
        const glm::vec3 normal = world_normal(*found, up);
        const float cosine = glm::dot(view, normal), share = fresnel(cosine);
        const float clear = coverage.empty() ? 1.0f : 1.0f - std::clamp(coverage[i], 0.0f, 1.0f);
        const glm::vec3 towards = 2.0f * cosine * normal - view;
        if (glm::dot(towards, answers_[sample].normal) > 0.0f) {
            // One facet's share may be more than the mean that the shading has: no more of the sky is taken away than is there.
            const glm::vec3 most =
                lit_[i].sky / (through[i] * glm::max(sky_towards(towards), glm::vec3(1e-12f)));
            SecondRay ray{.ray = from_place(rays_[sample], answers_[sample], towards),
                          .sample = sample,
                          .weight = glm::min(glm::vec3(clear * share), most),
                          .replaces_sky = true};
            ray.ray.width.spread = std::max(ray.ray.width.spread, kMirrored);
            mirrored[i] = ray;
        }
        below[i] =
            from_place(rays_[sample], answers_[sample], glm::refract(-view, normal, 1.0f / kWaterIndex));
        below[i].nearest_m = 0.0f;
        enters[i] = clear * (1.0f - share);
    });
    for (const auto& ray : mirrored)
        if (ray) second_.push_back(*ray);

    // The bottom is out of sight: under water there is nothing but the object, in front of the light that water scatters.
    std::vector<RayAnswer> met(on_sea_.size());
    traced_->trace_object(below, met);
    const WaterBody& water = light_.water();
    const Sky& sky = light_.sky();
    const glm::vec3 loss_per_m = water.absorption_per_m + 2.0f * water.backscatter_per_m;
    for (std::size_t i = 0; i < met.size(); ++i) {
        if (met[i].met != Met::Object) continue;
        const glm::vec3 place = below[i].from + met[i].distance_m * below[i].towards;
        const float depth_m = std::max(below[i].from.z - place.z, 0.0f);
        // Where the water's surface is in a shadow, so is what lies under it.
        const glm::vec3 down =
            0.95f * (sky.sky_irradiance + (dark[i] ? glm::vec3(0.0f) : sky.sun_irradiance));
        const glm::vec3 left = glm::exp(-loss_per_m * met[i].distance_m);
        const glm::vec3 object = met[i].albedo * down * glm::exp(-loss_per_m * depth_m) *
                                 ((0.6f + 0.4f * met[i].normal.z) / (kPi_f * kWaterIndex * kWaterIndex));
        // It stands in front of so much of the water's light; of one facet no more than there is.
        const glm::vec3 hidden = left * lit_[i].sea / through[i];
        added_[on_sea_[i]] += enters[i] * left * object - hidden;
    }
}

void Tracer::Impl::trace_second_rays() {
    const std::size_t count = second_.size();
    std::vector<RayQuery> rays(count);
    std::vector<RayAnswer> met(count);
    for (std::size_t i = 0; i < count; ++i) rays[i] = second_[i].ray;
    traced_->trace(rays, met);
    std::vector<glm::vec3> light(count, glm::vec3(0.0f));
    std::vector<std::size_t> sea;
    std::vector<std::size_t> object;
    for (std::size_t i = 0; i < count; ++i) {
        if (met[i].met == Met::Nothing)
            light[i] = second_[i].replaces_sky ? glm::vec3(0.0f) : sky_towards(rays[i].towards);
        else
            (met[i].met == Met::Sea ? sea : object).push_back(i);
    }
    light_second_sea(rays, met, sea, light);
    const auto [to_object, of_object] = gathered(rays, met, object);
    const std::vector<std::uint8_t> dark = in_shadow(to_object, of_object);
    for (std::size_t i = 0; i < object.size(); ++i)
        light[object[i]] = sun_on(of_object[i], dark[i] != 0) + sky_on(of_object[i]);
    for (std::size_t i = 0; i < count; ++i) {
        glm::vec3 more = light[i];
        if (second_[i].replaces_sky && met[i].met != Met::Nothing) more -= sky_towards(rays[i].towards);
        added_[second_[i].sample] += second_[i].weight * more;
    }
}

// The sea that second rays meet, through the air above the waves.
void Tracer::Impl::light_second_sea(std::span<const RayQuery> rays, std::span<const RayAnswer> met,
                                    std::span<const std::size_t> sea, std::span<glm::vec3> light) {
    if (sea.empty()) return;
    SeenSea<float> seen;
    seen.origin_m = glm::dvec2(view_.position_m);
    seen.resize(sea.size());
    for (std::size_t i = 0; i < sea.size(); ++i) {
        const RayQuery& ray = rays[sea[i]];
        const RayAnswer& answer = met[sea[i]];
        seen.rest[i] = answer.rest_m;
        seen.up[i] = glm::vec3(earth_up(glm::dvec2(answer.rest_m), grid_options_.curvature_per_m));
        const float width_m = ray.width.footprint_m + ray.width.spread * answer.distance_m;
        const float facing = std::max(std::abs(glm::dot(answer.normal, ray.towards)), 0.1f);
        const float across = std::max(std::hypot(ray.towards.x, ray.towards.y), 1e-6f);
        seen.pixel_m[i] = width_m;
        seen.pixel_axis_m[i] = glm::vec2(ray.towards) * (width_m / (facing * across));
        seen.to_eye[i] = -ray.towards;
        seen.distance_m[i] = answer.distance_m;
    }
    std::vector<SeaRadiance> lit(sea.size());
    light_.find_crests(seen.origin_m, seen.rest, seen.pixel_m, seen.pixel_axis_m, seen.crest);
    light_.answer(seen);
    light_.light(seen, light_.sky(), air_below_, {}, lit);
    // The sun that waves mirror onto the object is left out: few of the rays find it, and those would be white dots.
    for (std::size_t i = 0; i < sea.size(); ++i)
        light[sea[i]] = radiance_of(lit[i]) - (second_[sea[i]].replaces_sky ? glm::vec3(0.0f) : lit[i].sun);
}

// What rays have added, as the eye sees it. The air and the spray before the sea have added their own light already.
void Tracer::Impl::through_air() {
    const auto seen_through = [&](std::size_t sample, bool is_object) {
        SeaRadiance more{.sea = added_[sample]};
        const glm::vec3 to_eye = -rays_[sample].towards;
        const float distance_m = answers_[sample].distance_m;
        if (options_.picture.lighting.air)
            see_through(air_, std::span(&to_eye, 1), std::span(&distance_m, 1), std::span(&more, 1));
        if (is_object)
            see_through_spray(spray_, -to_eye, distance_m, more);
        else
            see_through_spray(spray_, {&to_eye, 1}, {&distance_m, 1}, {&more, 1});
        radiance_[sample].sea += more.sea;
        if (is_object) radiance_[sample].air += more.air;
    };
    in_parallel(on_object_.size(), [&](std::size_t i) { seen_through(on_object_[i], true); });
    if (options_.traced) in_parallel(on_sea_.size(), [&](std::size_t i) { seen_through(on_sea_[i], false); });
}

}  // namespace pelagic::trace
