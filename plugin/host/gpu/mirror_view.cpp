#include "plugin/host/gpu/mirror_view.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "plugin/host/gpu/shader_variants.h"

namespace pelagic {
namespace {

// The mirrored picture's pixels are twice as wide as the picture's: waves blur what they show.
constexpr double kMirroredPixels = 0.5;
constexpr double kWidest = 4.0;  // tangents of what the mirrored eye sees to either side

}  // namespace

MirrorView mirror_view(std::span<const MirroredBody> bodies, glm::dvec3 eye_m, double pixel_tangent,
                       int largest) {
    double water_m = 0.0;
    for (const MirroredBody& body : bodies) water_m += body.water_m / static_cast<double>(bodies.size());
    MirrorView made;
    made.eye_m = {eye_m.x, eye_m.y, 2.0 * water_m - eye_m.z};
    std::vector<glm::dvec3> seen;  // from there
    glm::dvec3 middle(0.0);
    for (const MirroredBody& body : bodies)
        for (int i = 0; i < 8; ++i) {
            const glm::dvec4 of_box((i & 1) != 0 ? 1.0 : -1.0, (i & 2) != 0 ? 1.0 : -1.0,
                                    (i & 4) != 0 ? 1.0 : -1.0, 1.0);
            glm::dvec3 corner(body.grid_from_box * of_box);
            corner.z = std::max(corner.z, body.water_m);
            seen.push_back(corner - made.eye_m);
            const double away = glm::length(seen.back());
            if (away > 0.0) middle += seen.back() / away;
        }
    if (!(glm::length(middle) > 1e-9)) middle = glm::dvec3(0.0, 0.0, 1.0);
    const glm::dvec3 ahead = glm::normalize(middle);
    const glm::dvec3 side = glm::normalize(
        glm::cross(ahead, std::abs(ahead.z) < 0.99 ? glm::dvec3(0.0, 0.0, 1.0) : glm::dvec3(0.0, 1.0, 0.0)));
    const glm::dvec3 up = glm::cross(side, ahead);
    glm::dvec2 least(kWidest), most(-kWidest);
    for (const glm::dvec3& at : seen) {
        const double along = glm::dot(ahead, at);
        glm::dvec2 tangents(glm::dot(side, at), glm::dot(up, at));
        if (along * kWidest > std::max(std::abs(tangents.x), std::abs(tangents.y)))
            tangents /= along;
        else  // beside the eye, or behind it
            tangents *= 2.0 * kWidest / std::max(std::max(std::abs(tangents.x), std::abs(tangents.y)), 1e-9);
        least = glm::min(least, tangents);
        most = glm::max(most, tangents);
    }
    least = glm::max(least, glm::dvec2(-kWidest));
    most = glm::min(most, glm::dvec2(kWidest));
    const double pixel = pixel_tangent / kMirroredPixels;
    const int most_texels = std::min(kMirroredSide, largest);
    const glm::dvec2 span = glm::max(most - least, glm::dvec2(1e-4));
    for (int axis = 0; axis < 2;
         ++axis) {  // sides of powers of two, so that a moving camera seldom needs others
        made.size[axis] = 16;
        while (made.size[axis] < most_texels && made.size[axis] * pixel < span[axis]) made.size[axis] *= 2;
    }
    // A rim of nothing.
    const glm::dvec2 rim = span * 2.0 / glm::dvec2(made.size);
    least -= rim;
    most += rim;
    made.texels = std::min(made.size.x / (most.x - least.x), made.size.y / (most.y - least.y));
    // x and y of the clip coordinates, and the distance ahead as w.
    glm::dmat4 clip(0.0);
    for (int axis = 0; axis < 3; ++axis) {
        clip[axis][0] = (2.0 * side[axis] - (most.x + least.x) * ahead[axis]) / (most.x - least.x);
        clip[axis][1] = (2.0 * up[axis] - (most.y + least.y) * ahead[axis]) / (most.y - least.y);
        clip[axis][3] = ahead[axis];
    }
    glm::dmat4 from_eye(1.0);
    from_eye[3] = glm::dvec4(-made.eye_m, 1.0);
    made.clip_from_grid = clip * from_eye;
    made.clip_from_grid[3][2] = 0.0;
    return made;
}

std::vector<glm::mat4> mirror_boxes(std::span<const MirroredBody> bodies, glm::dvec3 mirrored_eye_m) {
    std::vector<const MirroredBody*> order;
    for (const MirroredBody& body : bodies) order.push_back(&body);
    const auto away = [&](const MirroredBody* body) {
        return glm::distance(glm::dvec3(body->grid_from_box[3]), mirrored_eye_m);
    };
    if (order.size() > kObjectBoxes) std::ranges::stable_sort(order, {}, away);
    order.resize(std::min<std::size_t>(order.size(), kObjectBoxes));
    std::vector<glm::mat4> boxes;
    for (const MirroredBody* body : order) boxes.emplace_back(glm::inverse(body->grid_from_box));
    return boxes;
}

glm::dmat4 grid_from_box(const glm::dmat4& grid_from, glm::dvec3 least, glm::dvec3 most) {
    glm::dmat4 box(1.0);
    box[3] = glm::dvec4(0.5 * (least + most), 1.0);
    for (int axis = 0; axis < 3; ++axis) box[axis][axis] = std::max(0.5 * (most[axis] - least[axis]), 1e-3);
    return grid_from * box;
}

}  // namespace pelagic
