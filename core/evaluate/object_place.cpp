#include "core/evaluate/object_place.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <span>
#include <vector>

#include "core/evaluate/evaluate.h"
#include "core/evaluate/floating_response.h"
#include "core/surface/earth.h"

namespace pelagic {
namespace {

// Heel and trim of a body that floats: no more than this slope. A wave as long as the body has up to 0.44.
constexpr double kMostLean = 0.45;
constexpr int kAlong = 5, kAcross = 3;  // places of the water under a body

struct WaterPlane {
    double height_m = 0.0;
    glm::dvec2 slope{0.0};  // along the body's axes
};

// The least-squares plane through points (x, y along the body's axes, z).
WaterPlane plane_through(std::span<const glm::dvec3> points) {
    glm::dmat3 sums(0.0);
    glm::dvec3 heights(0.0);
    for (const glm::dvec3& p : points) {
        const glm::dvec3 row(1.0, p.x, p.y);
        sums += glm::outerProduct(row, row);
        heights += p.z * row;
    }
    // Points in one line have no slope across it.
    for (int i = 1; i < 3; ++i) sums[i][i] += 1e-9;
    const glm::dvec3 plane = glm::inverse(sums) * heights;
    return {plane.x, glm::dvec2(plane.y, plane.z)};
}

// Over two seconds before and after, so that a path with corners turns no body at once; 0 in a sea that stands still.
glm::dvec2 velocity_mps(const Scene& scene, const SceneObject& object, double frame) {
    constexpr double kAround_s = 2.0;
    const double frame_s = scene.shot.time_s(frame + 1.0) - scene.shot.time_s(frame);
    if (!(std::abs(frame_s) > 0.0)) return glm::dvec2(0.0);
    const double around = kAround_s / frame_s;
    return (glm::dvec2(object_pose(scene, object, frame + around).place_m) -
            glm::dvec2(object_pose(scene, object, frame - around).place_m)) /
           (2.0 * kAround_s);
}

}  // namespace

template <class T>
PlacedObject place_object(const Frame<T>& state, const Scene& scene, const SceneObject& object,
                          const ObjectMoment& at) {
    PlacedObject placed{object_pose(scene, object, at.frame), 0.0};
    if (at.rest_m) placed.water_m = at.rest_m(glm::dvec2(placed.pose.place_m));
    if (!object.floats) return placed;
    ObjectPose& pose = placed.pose;
    const double level = std::hypot(pose.turn[0].x, pose.turn[0].y);
    const glm::dvec2 ahead = level > 1e-6 ? glm::dvec2(pose.turn[0]) / level : glm::dvec2(1.0, 0.0);
    const glm::dvec2 port(-ahead.y, ahead.x);
    const glm::dvec2 origin_m(pose.place_m);
    const auto lie_on = [&](WaterPlane plane) {
        plane.slope = glm::clamp(plane.slope, -kMostLean, kMostLean);
        const glm::dvec3 up =
            glm::normalize(glm::dvec3(-(plane.slope.x * ahead + plane.slope.y * port), 1.0));
        placed.water_m += plane.height_m;
        for (int axis = 0; axis < 3; ++axis) pose.turn[axis] = from_level(pose.turn[axis], up);
        pose.place_m = glm::dvec3(origin_m, placed.water_m) + pose.place_m.z * up;
        return placed;
    };
    if (object.buoyancy == Buoyancy::Response)
        if (const FloatingBox box = floating_box(object); box.draught_m > 0.0) {
            const double c = std::cos(box.turn), s = std::sin(box.turn);
            const glm::dvec2 along = c * ahead + s * port, across = c * port - s * ahead;
            const FloatingMotion motion =
                floating_motion(state, floating_model(box, object.roll_damping),
                                {.middle_m = origin_m + box.middle_m.x * ahead + box.middle_m.y * port,
                                 .ahead = along,
                                 .velocity_mps = velocity_mps(scene, object, at.frame),
                                 .cell_m = floating_cell_m(box),
                                 .late_s = at.late_s});
            const glm::dvec2 leans = motion.slope.x * along + motion.slope.y * across,
                             slope(glm::dot(leans, ahead), glm::dot(leans, port));
            return lie_on({motion.heave_m - glm::dot(slope, box.middle_m), slope});
        }
    const glm::dvec2 least(object.mesh->least_m()), most(object.mesh->most_m());
    const glm::dvec2 size = pose.scale * (most - least);
    const bool is_long = size.x >= size.y;
    const int nx = is_long ? kAlong : kAcross, ny = is_long ? kAcross : kAlong;
    std::array<glm::vec<2, T>, kAlong * kAcross> rest;
    std::array<glm::vec<3, T>, kAlong * kAcross> position, velocity{};
    for (int k = 0; k < kAlong * kAcross; ++k) {
        const glm::dvec2 local =
            pose.scale * (least + (most - least) * glm::dvec2((k % nx + 0.5) / nx, (k / nx + 0.5) / ny));
        rest[k] = glm::vec<2, T>(local.x * ahead + local.y * port);
    }
    const std::vector<T> cell_m(rest.size(), static_cast<T>(floating_cell_m(object)));
    Results<T> results;
    results.set(Product::Position, {position.data()});
    if (at.late_s != 0.0) results.set(Product::Velocity, {velocity.data()});
    evaluate(
        state, at.query,
        Points<T>{
            .origin_m = origin_m, .count = rest.size(), .rest_m = {rest.data()}, .cell_m = {cell_m.data()}},
        results);
    std::array<glm::dvec3, kAlong * kAcross> points;
    for (std::size_t k = 0; k < points.size(); ++k) {
        const glm::dvec3 there = glm::dvec3(position[k]) + at.late_s * glm::dvec3(velocity[k]);
        points[k] = {glm::dot(glm::dvec2(there), ahead), glm::dot(glm::dvec2(there), port), there.z};
    }
    return lie_on(plane_through(points));
}
template PlacedObject place_object(const Frame<float>&, const Scene&, const SceneObject&,
                                   const ObjectMoment&);
template PlacedObject place_object(const Frame<double>&, const Scene&, const SceneObject&,
                                   const ObjectMoment&);

}  // namespace pelagic
