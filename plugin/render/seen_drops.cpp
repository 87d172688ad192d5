#include "plugin/render/seen_drops.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>

#include "core/base/constants.h"
#include "core/surface/earth.h"

namespace pelagic {
namespace {

double eased(double x) {
    x = std::clamp(x, 0.0, 1.0);
    return x * x * (3.0 - 2.0 * x);
}

constexpr double kHidden_m = 0.5, kWhole_m = 2.0;
// Where the disc is no narrower, its profile adds up over pixels to its integral.
constexpr double kNarrowest_px = 1.5;

namespace drop_shading {
using namespace glm;
#include "core/lighting/spray_drop.glsl"
}  // namespace drop_shading

}  // namespace

double drops_share(double distance_m) {
    return 1.0 - eased(2.0 * distance_m / kDropsReach_m - 1.0);
}

double parcel_share(double distance_m) {
    return drops_share(distance_m) * eased((distance_m - kHidden_m) / (kWhole_m - kHidden_m));
}

bool are_drops_near(const Scene& scene, const View& view) {
    return scene.effects.spray_drops && view.position_m.z < kDropsReach_m;
}

void add_seen_drops(MemoryNeed& need, const Plan& plan) {
    if (!plan.from->scene.effects.spray_drops) return;
    need.add("the drops of the spray",
             spray_drops_bytes(plan, plan_spray_drops(*plan.from, kDropsSquare_m), kDropsSquare_m),
             "set effects.spray_drops to false");
}

float SeenDrop::thickness() const {
    return static_cast<float>(section_px2 / (kPi * radius_px * radius_px));
}

float SeenDrop::hides(glm::dvec2 place_px, float sea_m) const {
    return drop_shading::spray_drop_hides(glm::vec2((place_px - at_px) / radius_px), thickness(),
                                          (sea_m - distance_m) / depth_m);
}

std::vector<SeenDrop> seen_drops(std::span<const SprayDrop> drops, const DropsEye& eye) {
    const auto& [view, curvature_per_m, air, spray, late_s] = eye;
    const glm::dvec2 nadir_m(view.position_m);
    const double tangent = view.pixel_tangent();
    const glm::dvec2 size(view.resolution), middle = view.middle_tangents();
    std::vector<SeenDrop> seen;
    std::vector<glm::vec3> to_eye;
    std::vector<float> heights_m;
    for (const SprayDrop& drop : drops) {
        const glm::dvec3 flown_m = drop.position_m + late_s * drop.velocity_mps,
                         at_m = on_earth(flown_m - glm::dvec3(nadir_m, 0.0), curvature_per_m);
        const glm::dvec3 way = at_m - glm::dvec3(0.0, 0.0, view.position_m.z);
        const double distance_m = glm::length(way), ahead_m = glm::dot(way, view.forward);
        const double share = parcel_share(distance_m);
        if (!(share > 0.0) || !(ahead_m > kHidden_m)) continue;
        const double px_a_m = 1.0 / (tangent * ahead_m);
        const double radius_px = std::max(0.5 * drop.width_m * px_a_m, kNarrowest_px);
        const glm::dvec2 at_px(0.5 * size.x + (glm::dot(way, view.right) / ahead_m - middle.x) / tangent,
                               0.5 * size.y - (glm::dot(way, view.up) / ahead_m - middle.y) / tangent);
        // One more: passes look beside a pixel's middle.
        const double reach_px = radius_px + 1.0;
        if (at_px.x < -reach_px || at_px.y < -reach_px || at_px.x > size.x + reach_px ||
            at_px.y > size.y + reach_px)
            continue;
        seen.push_back({.at_px = at_px,
                        .radius_px = radius_px,
                        .section_px2 = share * drop.section_m2 * px_a_m * px_a_m,
                        .distance_m = static_cast<float>(distance_m),
                        .depth_m = static_cast<float>(0.5 * drop.width_m)});
        to_eye.push_back(glm::vec3(-way / distance_m));
        heights_m.push_back(static_cast<float>(flown_m.z));
    }
    constexpr std::size_t kAtOnce = 256;
    const std::size_t parts = (seen.size() + kAtOnce - 1) / kAtOnce;
    tbb::parallel_for(std::size_t{0}, parts, [&](std::size_t part) {
        const std::size_t begin = part * kAtOnce, end = std::min(begin + kAtOnce, seen.size());
        std::array<SeaRadiance, kAtOnce> light{};
        std::array<float, kAtOnce> distances_m{};
        const std::span of(light.data(), end - begin);
        for (std::size_t i = begin; i < end; ++i) {
            of[i - begin].air = spray_light(spray, -to_eye[i], heights_m[i]);
            distances_m[i - begin] = seen[i].distance_m;
        }
        if (air)
            see_through(*air, std::span(to_eye).subspan(begin, end - begin), {distances_m.data(), of.size()},
                        of);
        for (std::size_t i = begin; i < end; ++i) {
            SeaRadiance& radiance = of[i - begin];
            see_through_spray(spray, -to_eye[i], seen[i].distance_m, radiance);
            seen[i].radiance = radiance.air;
        }
    });
    std::stable_sort(seen.begin(), seen.end(),
                     [](const SeenDrop& a, const SeenDrop& b) { return a.distance_m > b.distance_m; });
    return seen;
}

}  // namespace pelagic
