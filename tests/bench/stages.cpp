// What is done with a frame's transforms: each stage in ms and as a ratio to the transforms.
//   stages [RESOLUTION…]      default 512 1024

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <cstdio>
#include <cstdlib>
#include <string>

#include "core/base/constants.h"
#include "core/evaluate/values.h"
#include "core/surface/patch.h"
#include "plugin/format/exr/exr.h"
#include "plugin/format/usd/layers.h"
#include "plugin/format/usd/text.h"
#include "tests/bench/timing.h"

namespace pelagic::bench {
namespace {

void table(int n) {
    Scene scene;
    scene.surface.size_m = 400.0;
    scene.surface.resolution = n;
    scene.waves.cascades = {{.size_m = 400.0, .resolution = n}};
    const auto make_frame = [&](std::vector<Query> queries) {
        // The plain cost of a whole cascade: nothing filtered away.
        for (Query& query : queries) query.cell_m = query.pixel_m = {0.0};
        return Frame<float>(std::make_shared<const Sea<float>>(make_plan(scene, queries)));
    };
    std::vector<Query> on_nodes;
    for (const PlannedQuery& planned : plan_bake(scene).queries) on_nodes.push_back(planned.query);
    std::vector<Query> between = on_nodes;
    between[0].lattice.reset();
    Frame<float> node_frame = make_frame(on_nodes), spline_frame = make_frame(between);
    const auto points = rest_points<float>({.per_side = n + 1, .spacing_m = 400.0 / n, .first_m = -200.0});
    const Points<float> rest{.count = points.size(), .rest_m = {points.data()}};
    Values out;
    out.resize(products(Product::Position, Product::Normal, Product::Velocity, Product::SlopeVariance,
                        Product::Breaking),
               points.size());

    double t = 0.0;
    const auto text = [&] {
        usd::write_frame_text({.points = out.vectors(Product::Position),
                               .normals = out.vectors(Product::Normal),
                               .velocities = out.vectors(Product::Velocity),
                               .slope_variance = out.vectors(Product::SlopeVariance),
                               .whitecap_coverage = out.numbers(Product::Breaking)},
                              [](std::string_view) {});
    };
    const auto exr_map = [&] {
        exr::Image image{.width = n, .height = n, .channels = {}};
        for (int c = 0; c < 3; ++c)
            image.channels.push_back(
                {.name = std::string(1, "BGR"[c]),
                 .data = &out.vectors(Product::Position).data()->x + c,
                 .pixel_stride_bytes = sizeof(glm::vec3),
                 .row_stride_bytes = static_cast<std::ptrdiff_t>(sizeof(glm::vec3)) * (n + 1)});
        exr::encode_scanline({}, image);
    };
    std::vector<Timed> stages{
        {"set: spectrum and transforms", [&] { node_frame.set(t += 0.04); }},
        {"evaluate every vertex at its node", [&] { evaluate(node_frame, 0, rest, out.results()); }},
        {"set, oversampled for the spline", [&] { spline_frame.set(t += 0.04); }},
        {"evaluate every vertex by spline", [&] { evaluate(spline_frame, 0, rest, out.results()); }},
        {"USD text of the mesh, one thread", text},
        {"OpenEXR of the displacement, one thread", exr_map},
    };
    interleave(stages, 7);
    std::printf("\n%d^2, every attribute, %zu vertices\n  %-46s %9s  %s\n", n, points.size(), "stage", "ms",
                "ratio");
    for (const Timed& stage : stages)
        std::printf("  %-46s %9.2f  %.2f\n", stage.name.c_str(), stage.median(),
                    stage.median() / stages[0].median());
}

}  // namespace
}  // namespace pelagic::bench

int main(int argc, char** argv) {
    std::vector<int> resolutions;
    for (int i = 1; i < argc; ++i) resolutions.push_back(std::atoi(argv[i]));
    if (resolutions.empty()) resolutions = {512, 1024};
    std::printf(
        "Stages of one frame, %d threads, medians of 7 interleaved repeats\n",
        static_cast<int>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism)));
    for (const int n : resolutions) pelagic::bench::table(n);
    std::printf("\npeak memory of this process: %.0f MiB\n", pelagic::bench::peak_mib());
}
