#include "plugin/render/lamps.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <limits>

namespace pelagic {
namespace {

constexpr std::uint8_t kNoLamp = 0xff;
static_assert(kMostLamps < kNoLamp);

}  // namespace

std::size_t LampChoice::pick(float& number) const {
    const float at = number * all_;
    std::size_t lamp = 0;
    while (lamp + 1 < count_ && !(at < upto_[lamp])) ++lamp;
    // Rounding must not name one without a weight.
    while (lamp > 0 && !(upto_[lamp] > upto_[lamp - 1])) --lamp;
    const float before = lamp > 0 ? upto_[lamp - 1] : 0.0f;
    number = std::clamp((at - before) / (upto_[lamp] - before), 0.0f, 1.0f);
    return lamp;
}

bool Lamps::has_some(const SceneObject& object) {
    const std::vector<ObjectMaterial>& materials = object.mesh->data().materials;
    return object.glow_cd_m2 > 0.0 &&
           std::any_of(materials.begin(), materials.end(),
                       [](const ObjectMaterial& material) { return material.glow != glm::vec3(0.0f); });
}

Lamps::Lamps(const Scene& scene) : scene_(scene), lamp_of_(scene.objects.size()) {
    for (std::size_t body = 0; body < scene.objects.size(); ++body) {
        if (!has_some(scene.objects[body])) continue;
        const ObjectMeshData& mesh = scene.objects[body].mesh->data();
        parts_.reserve(parts_.size() + mesh.material.size());
        Group group{.body = body, .first = parts_.size(), .last = 0, .lamp = {}};
        for (std::uint32_t triangle = 0; triangle < mesh.material.size(); ++triangle)
            if (power_of(body, triangle) > 0.0f) parts_.push_back({triangle, 0.0f});
        group.last = parts_.size();
        if (group.last == group.first) continue;
        lamp_of_[body].assign(mesh.material.size(), kNoLamp);
        find_bounds(group);
        groups_.push_back(group);
    }
    while (groups_.size() < kMostLamps && split_widest()) {
    }
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        // In order of azimuth, so that even numbers spread over all sides.
        const auto side_of = [&](const Part& part) {
            const auto [a, b, c] = corners_of(groups_[g].body, part.triangle);
            const glm::vec3 normal = glm::cross(b - a, c - a);
            return std::atan2(normal.y, normal.x);
        };
        std::stable_sort(parts_.begin() + static_cast<std::ptrdiff_t>(groups_[g].first),
                         parts_.begin() + static_cast<std::ptrdiff_t>(groups_[g].last),
                         [&](const Part& a, const Part& b) { return side_of(a) < side_of(b); });
        double sum = 0.0;
        for (std::size_t i = groups_[g].first; i < groups_[g].last; ++i) {
            Part& part = parts_[i];
            sum += static_cast<double>(power_of(groups_[g].body, part.triangle));
            part.upto = static_cast<float>(sum / static_cast<double>(groups_[g].lamp.power));
            lamp_of_[groups_[g].body][part.triangle] = static_cast<std::uint8_t>(g);
        }
    }
}

glm::vec3 Lamps::radiance_of(std::size_t body, std::uint32_t triangle) const {
    const ObjectMeshData& mesh = scene_.objects[body].mesh->data();
    // As LitObjects has it: in thousands of cd/m².
    return static_cast<float>(1e-3 * scene_.objects[body].glow_cd_m2) *
           mesh.materials[mesh.material[triangle]].glow;
}

std::array<glm::vec3, 3> Lamps::corners_of(std::size_t body, std::uint32_t triangle) const {
    const ObjectMeshData& mesh = scene_.objects[body].mesh->data();
    std::array<glm::vec3, 3> corners;
    for (std::size_t i = 0; i < 3; ++i)
        corners[i] = mesh.points_m[mesh.triangles[3 * std::size_t{triangle} + i]];
    return corners;
}

float Lamps::power_of(std::size_t body, std::uint32_t triangle) const {
    const auto [a, b, c] = corners_of(body, triangle);
    return 0.5f * glm::length(glm::cross(b - a, c - a)) * mean_of(radiance_of(body, triangle));
}

void Lamps::find_bounds(Group& group) const {
    glm::vec3 least(std::numeric_limits<float>::max()), most(-least);
    double power = 0.0;
    for (std::size_t i = group.first; i < group.last; ++i) {
        for (const glm::vec3& corner : corners_of(group.body, parts_[i].triangle)) {
            least = glm::min(least, corner);
            most = glm::max(most, corner);
        }
        power += static_cast<double>(power_of(group.body, parts_[i].triangle));
    }
    group.lamp = {.centre = 0.5f * (least + most),
                  .radius = 0.5f * glm::length(most - least),
                  .power = static_cast<float>(power)};
}

// Lamps that stand apart are lamps of their own: the widest group first, while its area is small beside its sphere.
bool Lamps::split_widest() {
    std::size_t widest = groups_.size();
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        const Group& group = groups_[g];
        const auto brightest = static_cast<float>(1e-3 * scene_.objects[group.body].glow_cd_m2);
        const bool is_apart = group.last - group.first > 1 && !group.is_whole &&
                              group.lamp.power < brightest * group.lamp.radius * group.lamp.radius;
        if (is_apart && (widest == groups_.size() || group.lamp.radius > groups_[widest].lamp.radius))
            widest = g;
    }
    if (widest == groups_.size()) return false;
    Group& group = groups_[widest];
    const auto middle_of = [&](const Part& part) {
        const auto [a, b, c] = corners_of(group.body, part.triangle);
        return (a + b + c) / 3.0f;
    };
    const auto begin = parts_.begin() + static_cast<std::ptrdiff_t>(group.first),
               end = parts_.begin() + static_cast<std::ptrdiff_t>(group.last);
    glm::vec3 least(std::numeric_limits<float>::max()), most(-least);
    for (auto part = begin; part != end; ++part) {
        least = glm::min(least, middle_of(*part));
        most = glm::max(most, middle_of(*part));
    }
    const glm::vec3 size = most - least;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const float half = 0.5f * (least[axis] + most[axis]);
    const auto cut =
        std::stable_partition(begin, end, [&](const Part& part) { return middle_of(part)[axis] <= half; });
    if (cut == begin || cut == end) {
        group.is_whole = true;  // all in one place
        return true;
    }
    Group other = group;
    group.last = other.first = static_cast<std::size_t>(cut - parts_.begin());
    find_bounds(group);
    find_bounds(other);
    groups_.push_back(other);
    return true;
}

void Lamps::place(std::span<const glm::mat4x3> bodies) {
    bodies_.assign(bodies.begin(), bodies.end());
    placed_.clear();
    for (const Group& group : groups_) {
        const glm::mat4x3& at = bodies_[group.body];
        const float scale = glm::length(at[0]);
        placed_.push_back({.centre = at * glm::vec4(group.lamp.centre, 1.0f),
                           .radius = scale * group.lamp.radius,
                           .power = scale * scale * group.lamp.power});
    }
}

Lamps::Light Lamps::light(std::size_t lamp, const glm::vec3& place, glm::vec2 number) const {
    const Group& group = groups_[lamp];
    const auto begin = parts_.begin() + static_cast<std::ptrdiff_t>(group.first),
               end = parts_.begin() + static_cast<std::ptrdiff_t>(group.last);
    auto part = std::lower_bound(begin, end, number.x, [](const Part& of, float x) { return of.upto <= x; });
    if (part == end) --part;  // rounding
    const float before = part == begin ? 0.0f : (part - 1)->upto;
    const float along = std::clamp((number.x - before) / std::max(part->upto - before, 1e-12f), 0.0f, 1.0f);
    const glm::mat4x3& at = bodies_[group.body];
    const auto [a, b, c] = corners_of(group.body, part->triangle);
    // Evenly over the triangle.
    const float root = std::sqrt(along);
    const glm::vec3 on = (1.0f - root) * a + root * ((1.0f - number.y) * b + number.y * c);
    const glm::vec3 way = at * glm::vec4(on, 1.0f) - place;
    const float distance = std::max(glm::length(way), 1e-6f);
    Light light{.body = group.body, .towards = way / distance, .distance_m = distance};
    const glm::vec3 normal = glm::mat3(at) * glm::cross(b - a, c - a);
    const float facing = -glm::dot(light.towards, normal) / std::max(glm::length(normal), 1e-30f);
    if (!(facing > 1e-6f)) return light;
    light.radiance = radiance_of(group.body, part->triangle);
    light.density = mean_of(light.radiance) / placed_[lamp].power * distance * distance / facing;
    return light;
}

Lamps::Met Lamps::met(const Ray& ray, const RayHit& hit) const {
    const auto body = static_cast<std::size_t>(hit.body);
    if (lamp_of_[body].empty() || lamp_of_[body][hit.triangle] == kNoLamp) return {};
    const auto [a, b, c] = corners_of(body, hit.triangle);
    const glm::vec3 normal = glm::mat3(bodies_[body]) * glm::cross(b - a, c - a);
    const float facing = -glm::dot(ray.towards, normal) / std::max(glm::length(normal), 1e-30f);
    if (!(facing > 1e-6f)) return {};
    Met met{.lamp = lamp_of_[body][hit.triangle], .radiance = radiance_of(body, hit.triangle)};
    met.density = mean_of(met.radiance) / placed_[static_cast<std::size_t>(met.lamp)].power * hit.distance_m *
                  hit.distance_m / facing;
    return met;
}

std::size_t Lamps::bytes(const Scene& scene) {
    std::size_t bytes = 0;
    for (const SceneObject& object : scene.objects)
        if (has_some(object))
            bytes += object.mesh->data().material.size() * (2 * sizeof(Part) + sizeof(std::uint8_t));
    return bytes;
}

}  // namespace pelagic
