// What copies of the cascades' tiles cost beside periodic tiles: a frame's transforms, and a vertex of patches and of scattered
// points. The default sea, one thread.
//   copies [REPEATS]      default 7

#include <tbb/global_control.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "core/evaluate/values.h"
#include "core/surface/patch.h"
#include "tests/bench/timing.h"

namespace pelagic::bench {
namespace {

struct Case {
    std::string name;
    ProductSet wanted;
    double size_m;
    int quads;  // 0: as many scattered points
};

void row(const Case& at, int repeats) {
    constexpr int kScattered = 512;
    const int side = at.quads > 0 ? at.quads : kScattered;
    Query query;
    query.name = "points";
    query.products = at.wanted;
    query.cell_m = query.pixel_m = {at.quads > 0 ? at.size_m / side : 0.5};
    std::vector<glm::vec2> rest =
        rest_points<float>({.per_side = side, .spacing_m = at.size_m / side, .first_m = -0.5 * at.size_m});
    if (at.quads == 0) {
        std::mt19937 random(1);
        std::uniform_real_distribution<float> inside(-0.5f, 0.5f);
        for (glm::vec2& point : rest)
            point = static_cast<float>(at.size_m) * glm::vec2(inside(random), inside(random));
    }
    std::vector<std::unique_ptr<Frame<float>>> frames;
    std::vector<Values> values(2);
    std::vector<Timed> timed;
    double t_s = 0.0;
    for (const Tiling tiling : {Tiling::Periodic, Tiling::Random}) {
        Scene scene;
        scene.waves.tiling = tiling;
        frames.push_back(
            std::make_unique<Frame<float>>(std::make_shared<const Sea<float>>(make_plan(scene, {query}))));
        Frame<float>& frame = *frames.back();
        Values& out = values[frames.size() - 1];
        out.resize(at.wanted, rest.size());
        frame.set(1.0);
        timed.push_back({"set", [&] { frame.set(t_s += 0.04); }});
        timed.push_back({"points", [&] {
                             evaluate(frame, 0, Points<float>{.count = rest.size(), .rest_m = {rest.data()}},
                                      out.results());
                         }});
    }
    interleave(timed, repeats);
    const auto ns = [&](std::size_t i) { return timed[i].least() * 1e6 / static_cast<double>(rest.size()); };
    std::printf("  %-52s %8.2f %8.2f %6.2f   %8.1f %8.1f %6.2f\n", at.name.c_str(), timed[0].least(),
                timed[2].least(), timed[2].least() / timed[0].least(), ns(1), ns(3), ns(3) / ns(1));
    std::fflush(stdout);
}

void run(int repeats) {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    const ProductSet position = products(Product::Position), normal = products(Product::Normal),
                     mesh = products(Product::Position, Product::Normal, Product::Velocity,
                                     Product::SlopeVariance, Product::Breaking);
    std::printf("Periodic tiles, copies, ratio; least of %d repeats\n  %-52s %26s   %26s\n", repeats, "",
                "transforms ms", "a point ns");
    for (const Case& at :
         {Case{"200 m, 1024², a mesh", mesh, 200.0, 1024}, Case{"2 km, 1024², a mesh", mesh, 2000.0, 1024},
          Case{"200 m, 1024², positions", position, 200.0, 1024},
          Case{"2 km, 1024², positions", position, 2000.0, 1024},
          Case{"200 m, 1024², normals alone", normal, 200.0, 1024},
          Case{"scattered over 400 m, a mesh's values", mesh, 400.0, 0},
          Case{"scattered over 400 m, positions", position, 400.0, 0}})
        row(at, repeats);
}

}  // namespace
}  // namespace pelagic::bench

int main(int argc, char** argv) {
    pelagic::bench::run(argc > 1 ? std::max(1, std::atoi(argv[1])) : 7);
}
