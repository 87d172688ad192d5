#include "plugin/render/motion.h"

#include <glm/common.hpp>

#include "core/surface/view.h"

namespace pelagic {

Motion::Motion(const Scene& scene, int frame, glm::dvec3 origin_m)
    : half_size_(0.5 * glm::dvec2(scene.camera.resolution)), step_s_(scene.shot.time_scale / scene.shot.fps) {
    constexpr double kNear = 0.0;  // depth isn't asked for
    for (int i = 0; i < 3; ++i)
        clip_from_[i] = view_at(scene.camera, frame + (i - 1.0)).clip_from(origin_m, kNear);
}

glm::dvec4 Motion::of(glm::dvec4 point_m, glm::dvec3 velocity_mps) const {
    const glm::dvec4 step_m(point_m.w * step_s_ * velocity_mps, 0.0);
    return between(
        {clip_from_[0] * (point_m - step_m), clip_from_[1] * point_m, clip_from_[2] * (point_m + step_m)});
}

glm::dvec4 Motion::of(const std::array<glm::dvec3, 3>& places_m) const {
    std::array<glm::dvec4, 3> seen{};
    for (std::size_t i = 0; i < seen.size(); ++i) seen[i] = clip_from_[i] * glm::dvec4(places_m[i], 1.0);
    return between(seen);
}

glm::dvec4 Motion::between(const std::array<glm::dvec4, 3>& seen) const {
    constexpr double kFarthest_px = 1e6;
    const auto way = [&](const glm::dvec4& other) {
        if (!(other.w > 0.0 && seen[1].w > 0.0)) return glm::dvec2(0.0);
        const glm::dvec2 px = half_size_ * (glm::dvec2(other) / other.w - glm::dvec2(seen[1]) / seen[1].w);
        return glm::clamp(px, -kFarthest_px, kFarthest_px);
    };
    return {way(seen[2]), way(seen[0])};
}

}  // namespace pelagic
