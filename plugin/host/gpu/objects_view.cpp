#include "plugin/host/gpu/objects_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "plugin/host/gpu/shader_variants.h"

namespace pelagic {
namespace {

// The mirrored picture's pixels are twice as wide as the picture's: waves blur what they show.
constexpr double kMirroredPixels = 0.5;
constexpr double kWidest = 4.0;       // tangents of what such an eye sees to either side
constexpr double kWaterIndex = 1.34;  // as in core/lighting/special.glsl

double mean_water_m(std::span<const ViewedBody> bodies) {
    double water_m = 0.0;
    for (const ViewedBody& body : bodies) water_m += body.water_m / static_cast<double>(bodies.size());
    return water_m;
}

std::array<glm::dvec3, 8> corners(const ViewedBody& body) {
    std::array<glm::dvec3, 8> made{};
    for (int i = 0; i < 8; ++i)
        made[static_cast<std::size_t>(i)] =
            glm::dvec3(body.grid_from_box * glm::dvec4((i & 1) != 0 ? 1.0 : -1.0, (i & 2) != 0 ? 1.0 : -1.0,
                                                       (i & 4) != 0 ? 1.0 : -1.0, 1.0));
    return made;
}

// Upright, of all places. pixel: a texel's tangent, or more where there are too many.
ObjectsView view_of(std::span<const glm::dvec3> places, glm::dvec3 eye_m, double pixel, int largest) {
    ObjectsView made;
    made.eye_m = eye_m;
    glm::dvec3 middle(0.0);
    for (const glm::dvec3& place : places)
        if (const double away = glm::distance(place, eye_m); away > 0.0) middle += (place - eye_m) / away;
    if (!(glm::length(middle) > 1e-9)) middle = glm::dvec3(0.0, 0.0, 1.0);
    const glm::dvec3 ahead = glm::normalize(middle);
    const glm::dvec3 side = glm::normalize(
        glm::cross(ahead, std::abs(ahead.z) < 0.99 ? glm::dvec3(0.0, 0.0, 1.0) : glm::dvec3(0.0, 1.0, 0.0)));
    const glm::dvec3 up = glm::cross(side, ahead);
    glm::dvec2 least(kWidest), most(-kWidest);
    for (const glm::dvec3& place : places) {
        const glm::dvec3 at = place - eye_m;
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
    const int most_texels = std::min(kObjectsSide, largest);
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

}  // namespace

ObjectsView mirrored_view(std::span<const ViewedBody> bodies, glm::dvec3 eye_m, double pixel_tangent,
                          int largest) {
    std::vector<glm::dvec3> places;
    for (const ViewedBody& body : bodies)
        for (glm::dvec3 corner : corners(body)) {
            corner.z = std::max(corner.z, body.water_m);
            places.push_back(corner);
        }
    return view_of(places, {eye_m.x, eye_m.y, 2.0 * mean_water_m(bodies) - eye_m.z},
                   pixel_tangent / kMirroredPixels, largest);
}

ObjectsView in_water_view(std::span<const ViewedBody> bodies, glm::dvec3 eye_m, double pixel_tangent,
                          int largest) {
    constexpr double kLeast_m = 1e-3;
    const double water_m = mean_water_m(bodies), high_m = eye_m.z - water_m;
    std::vector<glm::dvec3> places;
    glm::dvec3 middle(0.0);
    for (const ViewedBody& body : bodies) {
        const std::array<glm::dvec3, 8> all = corners(body);
        if (std::ranges::none_of(all, [&](const glm::dvec3& at) { return at.z < body.water_m - kLeast_m; }))
            continue;
        for (glm::dvec3 corner : all) {
            corner.z = std::min(corner.z, body.water_m);
            places.push_back(corner);
            middle += corner;
        }
    }
    if (places.empty() || !(high_m > kLeast_m)) return {};
    middle /= static_cast<double>(places.size());
    const double deep_m = std::max(water_m - middle.z, kLeast_m);
    const glm::dvec2 level(glm::dvec2(middle) - glm::dvec2(eye_m));
    const double far_m = glm::length(level);
    // Where the ray between them crosses the surface: Snell's law, by halves.
    double near = 0.0, far = far_m;
    for (int i = 0; i < 60; ++i) {
        const double at = 0.5 * (near + far), left = far_m - at;
        (at / std::hypot(at, high_m) < kWaterIndex * left / std::hypot(left, deep_m) ? near : far) = at;
    }
    const glm::dvec3 crossing(glm::dvec2(eye_m) + (far_m > 0.0 ? level * (near / far_m) : glm::dvec2(0.0)),
                              water_m);
    const glm::dvec3 down = glm::normalize(glm::dvec3(glm::dvec2(middle), water_m - deep_m) - crossing);
    return view_of(places, crossing - kWaterIndex * glm::distance(eye_m, crossing) * down, pixel_tangent,
                   largest);
}

std::vector<glm::mat4> object_boxes(std::span<const ViewedBody> bodies, glm::dvec3 eye_m) {
    std::vector<const ViewedBody*> order;
    for (const ViewedBody& body : bodies) order.push_back(&body);
    const auto away = [&](const ViewedBody* body) {
        return glm::distance(glm::dvec3(body->grid_from_box[3]), eye_m);
    };
    if (order.size() > kObjectBoxes) std::ranges::stable_sort(order, {}, away);
    order.resize(std::min<std::size_t>(order.size(), kObjectBoxes));
    std::vector<glm::mat4> boxes;
    for (const ViewedBody* body : order) boxes.emplace_back(glm::inverse(body->grid_from_box));
    return boxes;
}

glm::dmat4 grid_from_box(const glm::dmat4& grid_from, glm::dvec3 least, glm::dvec3 most) {
    glm::dmat4 box(1.0);
    box[3] = glm::dvec4(0.5 * (least + most), 1.0);
    for (int axis = 0; axis < 3; ++axis) box[axis][axis] = std::max(0.5 * (most[axis] - least[axis]), 1e-3);
    return grid_from * box;
}

}  // namespace pelagic
