// Meshes that are asked for by their error.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <utility>
#include <vector>

#include "tests/plugin/host/procedural/opened.h"

namespace pelagic {
namespace {

using namespace test;

struct Mesh {
    std::vector<std::uint32_t> corner;
    std::vector<glm::vec2> rest_m;
    std::vector<glm::vec3> position_m;
};

Mesh mesh_of(const FrameHandle& frame, const pelagic_camera& camera, double error_px) {
    pelagic_expand_options options = PELAGIC_INIT(pelagic_expand_options);
    options.error_px = error_px;
    options.triangles = 1;
    pelagic_mesh_size size = PELAGIC_INIT(pelagic_mesh_size);
    pelagic_error error;
    EXPECT_EQ(pelagic_expand_size(frame.get(), &camera, &options, &size, &error), PELAGIC_OK)
        << error.message;
    Mesh mesh{std::vector<std::uint32_t>(size.corners), std::vector<glm::vec2>(size.points),
              std::vector<glm::vec3>(size.points)};
    pelagic_values values = PELAGIC_INIT(pelagic_values);
    values.position_m = &mesh.position_m[0].x;
    pelagic_mesh_buffers buffers = PELAGIC_INIT(pelagic_mesh_buffers);
    buffers.points = size.points;
    buffers.corners = size.corners;
    buffers.corner = mesh.corner.data();
    buffers.rest_m = &mesh.rest_m[0].x;
    buffers.values = &values;
    EXPECT_EQ(pelagic_expand(frame.get(), &camera, &options, &buffers, &error), PELAGIC_OK) << error.message;
    return mesh;
}

// Of the sea in the picture, the error [px] that 95 % of it has at most, in the middles of the faces.
double error_px(const FrameHandle& frame, const pelagic_camera& camera, const Mesh& mesh) {
    std::vector<glm::vec2> rest_m;
    std::vector<glm::vec3> middle_m;
    for (std::size_t i = 0; i < mesh.corner.size(); i += 3) {
        glm::vec2 rest(0.0f);
        glm::vec3 middle(0.0f);
        for (int j = 0; j < 3; ++j) {
            rest += mesh.rest_m[mesh.corner[i + j]] / 3.0f;
            middle += mesh.position_m[mesh.corner[i + j]] / 3.0f;
        }
        rest_m.push_back(rest);
        middle_m.push_back(middle);
    }
    std::vector<glm::vec3> exact_m(rest_m.size()), normal(rest_m.size());
    pelagic_points points = PELAGIC_INIT(pelagic_points);
    points.count = rest_m.size();
    points.rest_m = &rest_m[0].x;
    pelagic_values values = PELAGIC_INIT(pelagic_values);
    values.position_m = &exact_m[0].x;
    values.normal = &normal[0].x;
    EXPECT_EQ(pelagic_evaluate(frame.get(), &points, &values, nullptr), PELAGIC_OK);
    const auto axis = [](const double(&v)[3]) { return glm::dvec3(v[0], v[1], v[2]); };
    const double pixel = 2.0 * camera.tan_half_width / camera.width;
    const auto on_screen = [&](glm::vec3 at_m) {
        const glm::dvec3 to_m = glm::dvec3(at_m) - glm::dvec3(0.0, 0.0, camera.position_m[2]);
        const double depth_m = glm::dot(to_m, axis(camera.forward));
        return glm::dvec2(glm::dot(to_m, axis(camera.right)), glm::dot(to_m, axis(camera.up))) /
               (depth_m > 0.1 ? depth_m * pixel : NAN);
    };
    std::vector<std::pair<double, double>> seen;  // error, area
    double all_px2 = 0.0;
    for (std::size_t f = 0; f < rest_m.size(); ++f) {
        glm::dvec2 at[3];
        for (int j = 0; j < 3; ++j) at[j] = on_screen(mesh.position_m[mesh.corner[3 * f + j]]);
        const glm::dvec2 ab = at[1] - at[0], ac = at[2] - at[0], middle = on_screen(middle_m[f]);
        const double area_px2 = ab.x * ac.y - ab.y * ac.x;
        if (!(area_px2 > 0.0) || !(std::abs(middle.x) < 0.5 * camera.width) ||
            !(std::abs(middle.y) < 0.5 * camera.height))
            continue;
        const double off_m = std::abs(glm::dot(middle_m[f] - exact_m[f], normal[f]));
        const double far_m =
            glm::length(glm::dvec3(middle_m[f]) - glm::dvec3(0.0, 0.0, camera.position_m[2]));
        seen.emplace_back(off_m / (pixel * far_m), area_px2);
        all_px2 += area_px2;
    }
    std::sort(seen.begin(), seen.end());
    double left_px2 = 0.95 * all_px2;
    for (const auto& [error, area_px2] : seen)
        if ((left_px2 -= area_px2) <= 0.0) return error;
    return 0.0;
}

TEST(ProceduralExpansion, KeepsTheErrorThatIsAskedFor) {
    pelagic_open_options fine = PELAGIC_INIT(pelagic_open_options);
    fine.finest_cell_m = fine.finest_pixel_m = 0.02;
    const SeaHandle sea = open_text(
        "[sea]\nwind_speed_mps = 24.0\n[camera]\nresolution = [160, 120]\nposition_m = [0, 0, 4]\n"
        "look_at_m = [0, 1000, 0]\n",
        &fine);
    const FrameHandle frame = frame_of(sea, 1.0, 1.0);
    pelagic_camera camera = PELAGIC_INIT(pelagic_camera);
    ASSERT_EQ(pelagic_shot_camera(sea.get(), 1.0, &camera, nullptr), PELAGIC_OK);
    std::size_t before = 0;
    for (const double asked_px : {0.4, 0.2}) {
        const Mesh mesh = mesh_of(frame, camera, asked_px);
        EXPECT_GT(mesh.position_m.size(), before) << asked_px;  // no finer than it takes
        before = mesh.position_m.size();
        const double is_px = error_px(frame, camera, mesh);
        EXPECT_LT(is_px, 1.1 * asked_px);  // samples of its samples
        EXPECT_GT(is_px, 0.5 * asked_px);
    }
}

TEST(ProceduralExpansion, RefusesTwoWishesAtOnce) {
    const SeaHandle sea = open_text("[camera]\nresolution = [160, 90]\n");
    const FrameHandle frame = frame_of(sea, 1.0, 1.0);
    pelagic_camera camera = PELAGIC_INIT(pelagic_camera);
    ASSERT_EQ(pelagic_shot_camera(sea.get(), 1.0, &camera, nullptr), PELAGIC_OK);
    pelagic_mesh_size size = PELAGIC_INIT(pelagic_mesh_size);
    pelagic_error error;
    for (const auto& [cell_px, error_px] :
         {std::pair(2.0, 0.5), std::pair(0.0, 0.001), std::pair(0.0, -1.0), std::pair(0.0, std::nan(""))}) {
        pelagic_expand_options options = PELAGIC_INIT(pelagic_expand_options);
        options.cell_px = cell_px;
        options.error_px = error_px;
        EXPECT_EQ(pelagic_expand_size(frame.get(), &camera, &options, &size, &error),
                  PELAGIC_INVALID_ARGUMENT);
        EXPECT_NE(std::strstr(error.message, "error_px"), nullptr) << error.message;
    }
}

}  // namespace
}  // namespace pelagic
