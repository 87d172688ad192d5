// surface.kind = "cage": what OpenSubdiv takes beside the sea. A cage that stands still is refined once and costs a frame
// nothing; of one that moves from frame to frame (Python's CageSurface) each frame applies stencils.
#include <array>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>
#include <memory>
#include <vector>

#include "core/evaluate/values.h"
#include "core/plan/plan.h"
#include "core/surface/cage.h"
#include "core/waves/frame.h"
#include "tests/bench/timing.h"

namespace {

using namespace pelagic;

constexpr int kSide = 48;  // quads of the cage

// A wavy sheet of 480 m; every other quad as two triangles, where asked for: no place of it is then regular.
CageMesh sheet(bool has_triangles) {
    CageMesh mesh;
    for (int y = 0; y <= kSide; ++y)
        for (int x = 0; x <= kSide; ++x)
            mesh.points_m.emplace_back(10.0 * x - 5.0 * kSide, 10.0 * y - 5.0 * kSide,
                                       4.0 * std::sin(0.3 * x) * std::cos(0.2 * y));
    for (std::int32_t y = 0; y < kSide; ++y)
        for (std::int32_t x = 0; x < kSide; ++x) {
            const std::int32_t a = y * (kSide + 1) + x, b = a + 1, c = b + kSide + 1, d = c - 1;
            if (has_triangles && (x + y) % 2 == 0) {
                mesh.face_counts.insert(mesh.face_counts.end(), {3, 3});
                mesh.indices.insert(mesh.indices.end(), {a, b, c, a, c, d});
            } else {
                mesh.face_counts.push_back(4);
                mesh.indices.insert(mesh.indices.end(), {a, b, c, d});
            }
            if (y == kSide / 2) mesh.creases.push_back({a, b, 2.5});
        }
    return mesh;
}

void measure(const char* name, bool has_triangles) {
    Scene scene;
    scene.surface.kind = SurfaceKind::Cage;
    scene.surface.cage = std::make_shared<const Cage>(sheet(has_triangles));
    scene.surface.cage_level.splits = 3;
    const CageMesh& mesh = scene.surface.cage->mesh();

    std::unique_ptr<const CageLimit> limit;
    CageMeshing meshing;
    CageStencils stencils;
    std::vector<glm::dvec3> places_m, normals;
    const Plan plan = plan_bake(prepare(scene), std::array{1});
    RestPoints<float> rest;
    plan.surface->points_at(1, rest);
    Frame<float> frame(std::make_shared<const Sea<float>>(plan));
    const Points<float> points{.origin_m = rest.origin_m,
                               .count = rest.rest_m.size(),
                               .rest_m = {rest.rest_m.data()},
                               .cell_m = {rest.cell_m.data()},
                               .pixel_m = {rest.pixel_m.data()},
                               .rest_normal = {rest.normal.data()}};
    QueryRunner<float> runner;
    Values values;
    const int query = plan.outputs.front().query;
    const ProductSet held = plan.queries[query].query.products & ~lasting_products();
    double time_s = 0.0;
    std::vector<bench::Timed> timed{
        {"topology", [&] { limit = std::make_unique<const CageLimit>(mesh); }},
        {"mesh", [&] { meshing = limit->mesh(limit->uniform_rates(8)); }},
        {"places and normals", [&] { limit->place(meshing, mesh.points_m, places_m, normals); }},
        {"stencils", [&] { stencils = limit->stencils(meshing); }},
        {"transforms", [&] { frame.set(time_s += 1.0 / 24.0); }},
        {"query at the points", [&] { runner.run(frame, query, points, held, values); }},
        {"a further frame of a bake",
         [&] {
             if (!plan.surface->is_constant()) plan.surface->points_at(2, rest);
         }},
        {"stencils applied", [&] { CageLimit::place(meshing, stencils, mesh.points_m, places_m, normals); }}};
    bench::interleave(timed, 9);
    const auto ms = [&](std::size_t i) { return timed[i].median(); };
    const double frame_ms = ms(4) + ms(5);
    std::printf("\n%s: %zu faces, %zu points on the limit surface\n", name, mesh.face_counts.size(),
                meshing.points);
    std::printf("  once, cold          ms: topology %.1f, mesh %.1f, places and normals %.1f\n", ms(0), ms(1),
                ms(2));
    std::printf("  a frame of the sea  ms: transforms %.1f, query %.1f\n", ms(4), ms(5));
    std::printf("  still cage          ms a frame: %.3f (share %.2f %%)\n", ms(6),
                100.0 * ms(6) / (ms(6) + frame_ms));
    std::printf(
        "  moving cage         ms a frame: %.1f (share %.0f %%; %.0f ns a point); once, for its stencils, %.1f ms and %.1f MiB\n",
        ms(7), 100.0 * ms(7) / (ms(7) + frame_ms), 1e6 * ms(7) / static_cast<double>(meshing.points), ms(3),
        static_cast<double>(stencils.control.size() * (sizeof(std::int32_t) + sizeof(stencils.weights[0]))) /
            (1 << 20));
}

}  // namespace

int main() {
    std::printf(
        "A sheet of %d × %d quads, each edge halved three times, one row of edges sharp for 2.5 levels; medians\n",
        kSide, kSide);
    measure("quads alone", false);
    measure("every other quad as two triangles", true);
    return 0;
}
