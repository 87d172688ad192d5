#include "core/scene/object_pose.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>
#include <optional>
#include <vector>

#include "core/base/constants.h"
#include "core/scene/course.h"

namespace pelagic {
namespace {

bool stands(const VesselPath& path, std::size_t i) {  // from key i to the next
    return path.keys[i].place_m == path.keys[i + 1].place_m;
}

// The way in which a path leaves its key i, or comes to key i + 1, also where it slowly stops there.
glm::dvec2 way_at(const VesselPath& path, std::size_t i, bool is_coming) {
    const VesselPath::Key &a = path.keys[i], &b = path.keys[i + 1];
    const glm::dvec2 chord = b.place_m - a.place_m;
    const glm::dvec2 here_mps = is_coming ? b.velocity_mps : a.velocity_mps;
    if (!path.is_smooth) return chord;
    if (here_mps != glm::dvec2(0.0)) return here_mps;
    // Of a cubic that stops at one end, the acceleration there.
    const glm::dvec2 way =
        3.0 * chord - (b.time_s - a.time_s) * (is_coming ? a.velocity_mps : b.velocity_mps);
    return way != glm::dvec2(0.0) ? way : chord;
}

double angle_of(glm::dvec2 way) {
    return std::atan2(way.y, way.x);
}

// Where it goes at that time, counter-clockwise from east. Where it stands for a while it turns from the way on which it came to the one
// on which it leaves, the shorter way round; before it has ever moved it looks where it will go, and where it never moves, east.
double heading_of(const VesselPath& path, double time_s) {
    const std::vector<VesselPath::Key>& keys = path.keys;
    if (keys.size() < 2) return 0.0;
    const glm::dvec2 velocity_mps = path.velocity_mps(time_s);
    if (glm::length(velocity_mps) > 1e-9 * path.fastest_mps()) return angle_of(velocity_mps);
    std::optional<std::size_t> before, after;  // which parts of the path move
    for (std::size_t i = 0; i + 1 < keys.size(); ++i) {
        if (stands(path, i)) continue;
        const double middle_s = std::midpoint(keys[i].time_s, keys[i + 1].time_s);
        if (middle_s <= time_s) before = i;
        if (middle_s > time_s && !after) after = i;
    }
    if (!before && !after) return 0.0;
    if (!after) return angle_of(way_at(path, *before, true));
    const double leaves = angle_of(way_at(path, *after, false));
    if (!before) return leaves;
    const double comes = angle_of(way_at(path, *before, true));
    const double from_s = keys[*before + 1].time_s, to_s = keys[*after].time_s;
    const double share = to_s > from_s ? std::clamp((time_s - from_s) / (to_s - from_s), 0.0, 1.0)
                                       : (time_s > from_s ? 1.0 : 0.0);
    return comes + share * share * (3.0 - 2.0 * share) * std::remainder(leaves - comes, kTwoPi);
}

// On the camera's clock, which runs on where the sea's stands still. Between keys of one place it stands.
VesselPath path_in_frames(const SceneObject& object) {
    Shot clock;
    clock.fps = 1.0;
    VesselPath path = path_of(clock, {.path = object.path, .interpolation = object.interpolation});
    for (std::size_t i = 0; i + 1 < path.keys.size(); ++i)
        if (stands(path, i)) path.keys[i].velocity_mps = path.keys[i + 1].velocity_mps = glm::dvec2(0.0);
    return path;
}

glm::dmat3 turn_of(double heading, double pitch, double roll) {
    const double ch = std::cos(heading), sh = std::sin(heading), cp = std::cos(pitch), sp = std::sin(pitch),
                 cr = std::cos(roll), sr = std::sin(roll);
    const glm::dvec3 forward(ch * cp, sh * cp, sp);
    const glm::dvec3 level_port(-sh, ch, 0.0), level_up(-ch * sp, -sh * sp, cp);
    return {forward, cr * level_port + sr * level_up, cr * level_up - sr * level_port};
}

}  // namespace

ObjectPose object_pose(const Scene& scene, const SceneObject& object, double frame) {
    VesselPath path;
    double time_s = frame - 1.0;
    if (object.vessel > 0) {
        path = path_of(scene.shot, scene.waves.vessels.at(static_cast<std::size_t>(object.vessel) - 1));
        time_s = scene.shot.time_s(frame);
    } else if (!object.path.empty()) {
        path = path_in_frames(object);
    }
    glm::dvec2 place_m(0.0);
    double course = 0.0;
    if (!path.keys.empty()) {
        place_m = path.at(time_s);
        course = heading_of(path, time_s);
    }
    const double c = std::cos(course), s = std::sin(course);
    place_m += glm::dvec2(c * object.east_m - s * object.north_m, s * object.east_m + c * object.north_m);
    constexpr double kDegree = kPi / 180.0;
    return {.place_m = {place_m, object.up_m},
            .turn = turn_of(course + kDegree * object.heading_deg, kDegree * object.pitch_deg,
                            kDegree * object.roll_deg),
            .scale = object.scale};
}

FloatingBox floating_box(const SceneObject& object) {
    const ObjectMeshData& mesh = object.mesh->data();
    constexpr double kDegree = kPi / 180.0, kFar = std::numeric_limits<double>::infinity();
    const glm::dmat3 turn = turn_of(0.0, kDegree * object.pitch_deg, kDegree * object.roll_deg);
    const double level = turn[0].x < 0.0 ? -1.0 : 1.0;  // ahead is where its x lies over the water
    const auto placed = [&](std::uint32_t i) {
        const glm::dvec3 p = turn * (object.scale * glm::dvec3(mesh.points_m[i]));
        return glm::dvec3(level * p.x, level * p.y, p.z + object.up_m);
    };
    // By Gauss's theorem: what is open at the water's level adds nothing to the volume, and is the waterplane.
    double volume_m3 = 0.0, plane_m2 = 0.0;
    glm::dvec2 first_m3(0.0);
    glm::dvec3 second_m4(0.0);  // xx, yy, xy
    bool is_cut = false;
    std::vector<glm::dvec2> wetted;
    double lowest_m = 0.0;
    for (std::size_t t = 0; t + 2 < mesh.triangles.size(); t += 3) {
        const std::array<glm::dvec3, 3> corners{placed(mesh.triangles[t]), placed(mesh.triangles[t + 1]),
                                                placed(mesh.triangles[t + 2])};
        std::array<glm::dvec3, 4> part;
        std::size_t count = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            const glm::dvec3 &a = corners[i], &b = corners[(i + 1) % 3];
            if (a.z <= 0.0) part[count++] = a;
            if ((a.z < 0.0 && b.z > 0.0) || (a.z > 0.0 && b.z < 0.0)) {
                part[count++] = glm::mix(a, b, a.z / (a.z - b.z));
                is_cut = true;
            }
        }
        for (std::size_t i = 0; i < count; ++i) {
            wetted.emplace_back(part[i]);
            lowest_m = std::min(lowest_m, part[i].z);
        }
        for (std::size_t i = 2; i < count; ++i) {
            const glm::dvec3 &a = part[0], &b = part[i - 1], &c = part[i];
            const double up_m2 = 0.5 * glm::cross(b - a, c - a).z;
            const glm::dvec3 sum = a + b + c;
            plane_m2 -= up_m2;
            volume_m3 += up_m2 * sum.z / 3.0;
            first_m3 -= up_m2 / 3.0 * glm::dvec2(sum);
            // The mean of a product over a triangle.
            const auto mean = [&](int u, int v) {
                return (sum[u] * sum[v] + a[u] * a[v] + b[u] * b[v] + c[u] * c[v]) / 12.0;
            };
            second_m4 -= up_m2 * glm::dvec3(mean(0, 0), mean(1, 1), mean(0, 1));
        }
    }
    if (!is_cut) return {};
    // A mesh with holes, or whose faces look inwards, has numbers that no body has.
    FloatingBox box;
    if (plane_m2 > 0.0) {
        const glm::dvec2 centre = first_m3 / plane_m2;
        const double xx = second_m4.x / plane_m2 - centre.x * centre.x,
                     yy = second_m4.y / plane_m2 - centre.y * centre.y,
                     xy = second_m4.z / plane_m2 - centre.x * centre.y;
        constexpr double kRound = 0.05;  // so nearly it has no longer axis
        if (xx > 0.0 && yy > 0.0 && std::hypot(xx - yy, 2.0 * xy) > kRound * (xx + yy))
            box.turn = 0.5 * std::atan2(2.0 * xy, xx - yy);
    }
    const glm::dvec2 along(std::cos(box.turn), std::sin(box.turn)), across(-along.y, along.x);
    glm::dvec2 least(kFar), most(-kFar);
    for (const glm::dvec2& point : wetted) {
        const glm::dvec2 turned(glm::dot(point, along), glm::dot(point, across));
        least = glm::min(least, turned);
        most = glm::max(most, turned);
    }
    constexpr double kSmallest_m = 1e-6;
    const glm::dvec2 size = most - least, middle = 0.5 * (least + most);
    if (!(std::min(size.x, size.y) > kSmallest_m && lowest_m < 0.0)) return {};
    box.middle_m = middle.x * along + middle.y * across;
    const double fullness = plane_m2 / (size.x * size.y), depth_m = volume_m3 / plane_m2;
    const bool is_body = fullness > 0.2 && fullness < 1.01 && depth_m > 0.0 && depth_m < -1.01 * lowest_m;
    const double narrower = is_body ? std::sqrt(std::min(fullness, 1.0)) : 1.0;
    box.length_m = narrower * size.x;
    box.beam_m = narrower * size.y;
    box.draught_m = is_body ? depth_m : -lowest_m;
    return box;
}

bool answers_by_mass(const SceneObject& object) {
    return object.floats && object.buoyancy == Buoyancy::Response && floating_box(object).draught_m > 0.0;
}

double floating_cell_m(const FloatingBox& box) {
    const double longer = std::max(box.length_m, box.beam_m), shorter = std::min(box.length_m, box.beam_m);
    return std::max(shorter / 6.0, longer / 60.0);
}

double floating_cell_m(const SceneObject& object) {
    if (object.floats && object.buoyancy == Buoyancy::Response)
        if (const FloatingBox box = floating_box(object); box.draught_m > 0.0) return floating_cell_m(box);
    const glm::dvec2 size(object.mesh->most_m() - object.mesh->least_m());
    return object.scale * std::max(size.x, size.y) / 3.0;
}

}  // namespace pelagic
