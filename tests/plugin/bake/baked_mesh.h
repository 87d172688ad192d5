// A baked mesh as it is read from its files, and what it should be: computed here in double precision, on the earth by
// angles instead of the core's series.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <iterator>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/base/constants.h"
#include "core/evaluate/evaluate.h"
#include "core/scene/names.h"
#include "plugin/bake/bake.h"
#include "plugin/format/usd/layers.h"
#include "plugin/format/usd/read_mesh.h"

namespace pelagic::test {

namespace fs = std::filesystem;

struct Mesh {
    glm::dvec3 origin_m{0.0};
    std::vector<glm::vec3> points, normals, velocities;
    std::vector<std::int32_t> counts, corners;  // of faces

    glm::dvec3 place_m(std::int32_t i) const {
        return origin_m + glm::dvec3(points[static_cast<std::size_t>(i)]);
    }
};

inline std::string bytes_of(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

inline std::vector<glm::vec3> vectors(const usd::MeshArray& array) {
    const auto& numbers = std::get<std::vector<float>>(array.values);
    std::vector<glm::vec3> all;
    for (std::size_t i = 0; i < numbers.size(); i += 3)
        all.emplace_back(numbers[i], numbers[i + 1], numbers[i + 2]);
    return all;
}

inline void add_layer(const fs::path& file, Mesh& mesh) {
    const usd::MeshLayer layer = usd::read_mesh_layer(bytes_of(file));
    if (layer.origin_m) mesh.origin_m = *layer.origin_m;
    for (const usd::MeshArray& array : layer.arrays) {
        if (array.name == "points") mesh.points = vectors(array);
        if (array.name == "normals") mesh.normals = vectors(array);
        if (array.name == "velocities") mesh.velocities = vectors(array);
        if (array.name == "faceVertexCounts") mesh.counts = std::get<std::vector<std::int32_t>>(array.values);
        if (array.name == "faceVertexIndices")
            mesh.corners = std::get<std::vector<std::int32_t>>(array.values);
    }
}

// How finely floats of this size, and the sums that made them, hold a place.
inline double resolution_m(const glm::vec3& point) {
    constexpr double kRounding = 0x1p-23;
    return kRounding *
           std::max({std::abs(static_cast<double>(point.x)), std::abs(static_cast<double>(point.y)),
                     std::abs(static_cast<double>(point.z))});
}

// Where (x, y, z) of the plane is on a sphere that it touches at the origin, and the unit vectors there: outwards from the
// origin, and up.
struct OnSphere {
    glm::dvec3 place_m, outwards, up;
};
inline OnSphere on_sphere(glm::dvec3 flat_m, double curvature_per_m) {
    const double away_m = std::hypot(flat_m.x, flat_m.y);
    const glm::dvec2 heading = away_m > 0.0 ? glm::dvec2(flat_m) / away_m : glm::dvec2(1.0, 0.0);
    const double angle = away_m * curvature_per_m, sine = std::sin(angle), cosine = std::cos(angle);
    const double radius_m = 1.0 / curvature_per_m + flat_m.z, half = std::sin(0.5 * angle);
    return {.place_m = {radius_m * sine * heading, flat_m.z - 2.0 * radius_m * half * half},
            .outwards = {cosine * heading, -sine},
            .up = {sine * heading, cosine}};
}
// A direction of the plane as it is at this point of the sphere.
inline glm::dvec3 turned(const glm::dvec3& direction, glm::dvec2 at_m, double curvature_per_m) {
    const OnSphere there = on_sphere(glm::dvec3(at_m, 0.0), curvature_per_m);
    const double away_m = glm::length(at_m);
    const glm::dvec2 out = away_m > 0.0 ? at_m / away_m : glm::dvec2(1.0, 0.0), across(-out.y, out.x);
    return glm::dot(out, glm::dvec2(direction)) * there.outwards +
           glm::dvec3(glm::dot(across, glm::dvec2(direction)) * across, 0.0) + direction.z * there.up;
}

// What a frame's vertices are in double precision, seen from the world's origin.
struct Reference {
    std::vector<glm::dvec3> places_m, velocities, normals;
    std::vector<glm::dvec3> up;  // at rest; empty: z
    double significant_height_m = 0.0;
};

inline Reference reference_of(const Scene& scene, int frame) {
    const auto plan = std::make_shared<Plan>(plan_bake(prepare(scene), std::vector{frame}));
    Frame<double> sea(std::make_shared<const Sea<double>>(*plan));
    sea.set(scene.shot.time_s(frame));
    RestPoints<double> at;
    plan->surface->points_at(frame, at);
    Reference reference{.places_m = std::vector<glm::dvec3>(at.rest_m.size()),
                        .velocities = std::vector<glm::dvec3>(at.rest_m.size()),
                        .normals = std::vector<glm::dvec3>(at.rest_m.size()),
                        .up = {},
                        .significant_height_m = 4.0 * std::sqrt(plan->from->spectrum.m0())};
    Results<double> results;
    results.set(Product::Position, {reference.places_m.data()});
    results.set(Product::Velocity, {reference.velocities.data()});
    results.set(Product::Normal, {reference.normals.data()});
    Points<double> points{.origin_m = at.origin_m, .count = at.rest_m.size(), .rest_m = {at.rest_m.data()}};
    if (!at.cell_m.empty()) points.cell_m = {at.cell_m.data()};
    if (!at.pixel_m.empty()) points.pixel_m = {at.pixel_m.data()};
    if (!at.cell_axis_m.empty()) points.cell_axis_m = {at.cell_axis_m.data()};
    if (!at.pixel_axis_m.empty()) points.pixel_axis_m = {at.pixel_axis_m.data()};
    evaluate(sea, 0, points, results);
    const glm::dvec2 from_m = at.origin_m - at.touches_at_m;
    for (std::size_t i = 0; i < reference.places_m.size(); ++i) {
        glm::dvec3& place = reference.places_m[i];
        if (at.curvature_per_m == 0.0) {
            place += glm::dvec3(at.origin_m, 0.0);
            continue;
        }
        place = glm::dvec3(at.touches_at_m, 0.0) +
                on_sphere(glm::dvec3(from_m, 0.0) + place, at.curvature_per_m).place_m;
        const glm::dvec2 rest_m = from_m + glm::dvec2(at.rest_m[i]);
        reference.velocities[i] = turned(reference.velocities[i], rest_m, at.curvature_per_m);
        reference.normals[i] = turned(reference.normals[i], rest_m, at.curvature_per_m);
        reference.up.push_back(on_sphere(glm::dvec3(rest_m, 0.0), at.curvature_per_m).up);
    }
    return reference;
}

inline void expect_exact(const Mesh& mesh, const Reference& reference, double time_scale = 1.0) {
    ASSERT_EQ(mesh.points.size(), reference.places_m.size());
    // Laid on the earth, points are rounded once more.
    const double roundings = reference.up.empty() ? 1.0 : 1.5;
    double worst = 0.0, velocity = 0.0, normal = 0.0;
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
        const glm::dvec3 off = mesh.place_m(static_cast<std::int32_t>(i)) - reference.places_m[i];
        // The reference is a double and rounds as well: to 1e-7 m at 1e9 m.
        const double allowed = 1e-5 * reference.significant_height_m +
                               roundings * resolution_m(mesh.points[i]) +
                               0x1p-52 * glm::length(glm::dvec2(reference.places_m[i]));
        worst = std::max(worst, glm::length(off) / allowed);
        velocity = std::max(
            velocity, glm::length(glm::dvec3(mesh.velocities[i]) - time_scale * reference.velocities[i]));
        normal = std::max(normal, glm::distance(glm::dvec3(mesh.normals[i]), reference.normals[i]));
    }
    EXPECT_LE(worst, 1.0);
    EXPECT_LE(normal, 2e-5);
    EXPECT_LE(velocity, 1e-5 * reference.significant_height_m);
}

// A shot's camera, given over the plane, at that place of the planet: as far from the origin, and as high.
inline void to_planet(Scene& scene) {
    const double curvature_per_m = 1.0 / kEarthRadius_m;
    const auto put = [&](glm::dvec3& position_m, glm::dvec3& look_at_m) {
        const glm::dvec3 ahead_m = look_at_m - position_m;
        const glm::dvec2 nadir_m(position_m);
        position_m = on_sphere(position_m, curvature_per_m).place_m;
        look_at_m = position_m + turned(ahead_m, nadir_m, curvature_per_m);
    };
    scene.surface.kind = SurfaceKind::Planet;
    scene.surface.earth_curvature = true;
    put(scene.camera.position_m, scene.camera.look_at_m);
    for (CameraKey& key : scene.camera.keys) put(key.position_m, key.look_at_m);
}

// A folder of its own.
class BakedMeshes : public ::testing::Test {
  protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("pelagic-meshes-" + std::to_string(getpid()));
        fs::remove_all(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }

    Mesh baked(const Scene& scene, int frame) const {
        fs::remove_all(folder_);
        bake(scene, {.out = folder_, .frames = {frame}, .progress = {}, .cancel = nullptr});
        return read(scene, frame);
    }
    Mesh read(const Scene& scene, int frame) const {
        const std::string extension(word_of(scene.output.mesh));
        Mesh mesh;
        add_layer(folder_ / usd::topology_file(scene.shot.name, extension), mesh);
        add_layer(folder_ / usd::frame_file(scene.shot.name, frame, extension), mesh);
        return mesh;
    }

    fs::path folder_;
};

}  // namespace pelagic::test
