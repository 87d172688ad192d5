#include "core/scene/object_pose.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>
#include <optional>

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

double floating_cell_m(const SceneObject& object) {
    const glm::dvec2 size(object.mesh->most_m() - object.mesh->least_m());
    const double longer = std::max(size.x, size.y), shorter = std::min(size.x, size.y);
    return object.scale *
           (object.buoyancy == Buoyancy::Response ? std::max(shorter / 6.0, longer / 60.0) : longer / 3.0);
}

}  // namespace pelagic
