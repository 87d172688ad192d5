// Vertices and error per pixel of the surfaces that a bake may have, for one camera 4 m above the sea: the mesh from near to
// far, the camera's projected grid, and a patch as far as the horizon. The error is the distance from a point of a face to the
// exact surface, along its normal, over the width of a pixel there; over all pixels that show the sea.
// A patch with the cells that it takes would have billions of vertices: only the cells under the pixels are looked at.
//   near_far [WIDTH HEIGHT]      default 1280 720

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <memory>
#include <random>
#include <vector>

#include "core/evaluate/evaluate.h"
#include "core/plan/plan.h"
#include "core/surface/earth.h"
#include "core/surface/earth_view.h"
#include "plugin/accuracy/mesh_error.h"
#include "tests/bench/timing.h"

namespace pelagic::bench {
namespace {

constexpr double kAllowed_px = 0.25, kShare = 0.95;

// The camera's height decides how far a patch must reach.
struct Seen : SeenSurface {
    EarthView earth{4.0, kEarthCurvature_per_m, 0.0};
};

struct Row {
    double vertices = 0.0, median_px = 0.0, error_px = 0.0;
};

void print(const char* what, const Row& row, double horizon_patch) {
    std::printf("  %-34s %12.3g %10.3f %10.3f", what, row.vertices, row.median_px, row.error_px);
    if (horizon_patch > 0.0) std::printf("   1/%.3g of the patch", horizon_patch / row.vertices);
    std::printf("\n");
}

Surface near_far(double size_m, int resolution) {
    Surface surface;
    surface.kind = SurfaceKind::NearFar;
    surface.size_m = size_m;
    surface.resolution = resolution;
    return surface;
}

Surface grid(double cell_px) {
    Surface surface;
    surface.kind = SurfaceKind::ProjectedGrid;
    surface.cell_px = cell_px;
    return surface;
}

Row row_of(const Seen& seen, const Surface& surface) {
    Scene scene = seen.prepared->scene;
    scene.surface = surface;
    const auto rest = make_surface(scene, seen.prepared->extent);
    RestPoints<float> at;
    Faces faces;
    rest->points_at(1, at);
    rest->faces_at(1, faces);
    const MeshPicture picture(seen, at);
    const FaceSamples samples = samples_of(seen, at, faces, picture);
    return {static_cast<double>(at.rest_m.size()), error_px(seen, at, picture, samples, 0.5),
            error_px(seen, at, picture, samples, kShare)};
}

// A patch round the camera with cells of this size, as far as the horizon.
Row patch_row(const Seen& seen, double cell_m) {
    constexpr int kSamples = 100'000;
    RestPoints<float> at{.origin_m = glm::dvec2(seen.view.position_m),
                         .curvature_per_m = kEarthCurvature_per_m};
    at.touches_at_m = at.origin_m;
    const MeshPicture picture(seen, at);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    std::vector<glm::dvec2> within;
    for (int i = 0; i < kSamples; ++i) {
        const glm::dvec3 ray = seen.view.direction(glm::dvec2(seen.view.resolution) *
                                                   glm::dvec2(uniform(random), uniform(random)));
        if (!(ray.z < 0.0)) continue;
        const glm::dvec2 flat = glm::dvec2(ray) * (-seen.view.position_m.z / ray.z);
        const double arc_m = seen.earth.arc_of(glm::length(flat));
        if (arc_m > seen.earth.horizon_m()) continue;
        const glm::dvec2 place = arc_m * glm::normalize(flat) / cell_m, cell = glm::floor(place);
        // The quad's two triangles, over the diagonal from its first corner.
        const bool is_right = place.x - cell.x > place.y - cell.y;
        for (const glm::dvec2 corner :
             {glm::dvec2(0.0), is_right ? glm::dvec2(1.0, 0.0) : glm::dvec2(0.0, 1.0), glm::dvec2(1.0)})
            at.rest_m.emplace_back((cell + corner) * cell_m);
        within.push_back(place - cell);
    }
    at.cell_m.assign(at.rest_m.size(), static_cast<float>(cell_m));
    const std::vector<glm::vec3> position_m = positions_of(seen, at);
    FaceSamples samples;
    for (std::size_t i = 0; i < within.size(); ++i) {
        const double most = std::max(within[i].x, within[i].y), least = std::min(within[i].x, within[i].y);
        const glm::dvec3 weight(1.0 - most, most - least, least);
        glm::dvec3 face(0.0);
        glm::dvec2 rest(0.0);
        for (int corner = 0; corner < 3; ++corner) {
            face += weight[corner] * picture.place(position_m[3 * i + corner]);
            rest += weight[corner] * glm::dvec2(at.rest_m[3 * i + corner]);
        }
        samples.rest_m.emplace_back(rest);
        samples.face_m.push_back(face);
    }
    const double side = 2.0 * seen.earth.horizon_m() / cell_m;
    return {side * side, error_px(seen, at, picture, samples, 0.5),
            error_px(seen, at, picture, samples, kShare)};
}

void run(const char* name, double wind_mps, int width, int height) {
    Scene scene;
    scene.sea.wind_speed_mps = wind_mps;
    scene.camera.resolution = {width, height};
    const double height_m = scene.camera.position_m.z;
    Seen seen{seen_surface(scene, view_at(scene.camera, 1.0)), {4.0, kEarthCurvature_per_m, 0.0}};
    seen.earth = EarthView(height_m, kEarthCurvature_per_m, seen.prepared->extent.height_m);
    // The first second in which the sea is well below the eye.
    RestPoints<float> nadir{.origin_m = glm::dvec2(seen.view.position_m), .rest_m = {glm::vec2(0.0f)}};
    for (int second = 0;
         second == 0 || positions_of(seen, nadir).front().z > 0.5f * static_cast<float>(height_m); ++second)
        seen.sea->set(second);
    std::printf("\n%s, %d x %d from %g m, horizon %.1f km\n  %-34s %12s %10s %10s\n", name, width, height,
                height_m, seen.earth.horizon_m() / 1e3, "", "vertices", "median px", "95 % px");

    char text[80];
    double patch = 0.0, least = 1e300;
    for (double cell_m = 1.0; patch == 0.0 && cell_m > SeenSurface::kFinest_m; cell_m /= std::sqrt(2.0)) {
        const Row row = patch_row(seen, cell_m);
        std::snprintf(text, sizeof text, "patch, cells of %.3g m", cell_m);
        print(text, row, 0.0);
        if (row.error_px <= kAllowed_px) patch = row.vertices;
    }
    for (const double size_m : {200.0, 32.0})
        for (double resolution = 64.0; resolution <= 1024.0; resolution *= std::sqrt(2.0)) {
            const int quads = static_cast<int>(std::round(resolution));
            const Row row = row_of(seen, near_far(size_m, quads));
            std::snprintf(text, sizeof text, "near-far, %g m, %d quads a side", size_m, quads);
            print(text, row, patch);
            if (row.error_px > kAllowed_px) continue;
            least = std::min(least, row.vertices);
            break;
        }
    for (double cell_px = 8.0; cell_px >= 0.5; cell_px /= std::sqrt(2.0)) {
        const Row row = row_of(seen, grid(cell_px));
        std::snprintf(text, sizeof text, "projected grid, cells of %.2g px", cell_px);
        print(text, row, patch);
        if (row.error_px <= kAllowed_px) break;
    }
    std::printf("  near-far against the patch, both within %g px: 1/%.3g   <= 1/20 %s\n", kAllowed_px,
                patch / least, verdict(least <= patch / 20.0));
}

}  // namespace
}  // namespace pelagic::bench

int main(int argc, char** argv) {
    const int width = argc > 2 ? std::atoi(argv[1]) : 1280, height = argc > 2 ? std::atoi(argv[2]) : 720;
    pelagic::bench::run("The default sea", 10.0, width, height);
    pelagic::bench::run("A storm, 24 m/s", 24.0, width, height);
}
