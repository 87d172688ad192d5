// What a call of the query costs where few points are asked for at a time: prepared, and with evaluate(),
// which prepares anew at each call. One thread; points lie scattered, as rays and floats do. And what bounds
// of a region cost.
//   query [REPEATS]      default 300

#include <tbb/global_control.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "core/base/constants.h"
#include "core/evaluate/bounds.h"
#include "core/evaluate/prepared_query.h"
#include "core/evaluate/values.h"
#include "tests/bench/timing.h"

namespace pelagic::bench {
namespace {

constexpr std::size_t kBatches[] = {1, 16, 4096};
constexpr std::size_t kCalls = 256, kPoints = 4096;  // in one repeat at most

struct Case {
    std::string name;
    Scene scene;
    ProductSet products;
};

// The least time of a call [ns], of `repeats` rounds in which all batches take turns.
void table(const Case& at, int repeats) {
    Query query;
    query.name = "points";
    query.products = at.products;
    query.cell_m = query.pixel_m = {0.5};
    Frame<float> frame(std::make_shared<const Sea<float>>(make_plan(at.scene, {query})));
    frame.set(3.0);
    std::mt19937 random(1);
    std::uniform_real_distribution<float> inside(-200.0f, 200.0f);
    std::vector<glm::vec2> rest(kPoints);
    for (glm::vec2& point : rest) point = {inside(random), inside(random)};
    Values values;
    values.resize(at.products, kPoints);
    const Results<float> results = values.results();
    const PreparedQuery<float> prepared(frame, 0, at.products);
    const auto calls_of = [](std::size_t batch) { return std::min(kCalls, kPoints / batch); };
    const auto in_batches = [&](std::size_t batch, const auto& ask) {
        return [&, batch, ask] {
            for (std::size_t first = 0; first < calls_of(batch) * batch; first += batch)
                ask(Points<float>{.count = batch, .rest_m = {&rest[first]}}, results.from_point(first));
        };
    };
    // Each twice: the first finds the caches full of other points' samples, and isn't counted.
    std::vector<Timed> timed;
    const auto add = [&](const std::function<void()>& work) {
        timed.insert(timed.end(), {{"", work}, {"", work}});
    };
    for (const std::size_t batch : kBatches) {
        add(in_batches(batch, [&](const Points<float>& points, const Results<float>& to) {
            prepared.evaluate(points, to);
        }));
        add(in_batches(batch, [&](const Points<float>& points, const Results<float>& to) {
            evaluate(frame, 0, points, to);
        }));
    }
    interleave(timed, repeats);
    const auto ns_a_call = [&](std::size_t i) {
        return timed[2 * i + 1].least() * 1e6 / static_cast<double>(calls_of(kBatches[i / 2]));
    };
    const double own_ns = ns_a_call(4) / static_cast<double>(kBatches[2]);
    std::printf("\n%s: a point's own time %.0f ns, as one of %zu\n  %8s %14s %14s %8s\n", at.name.c_str(),
                own_ns, kBatches[2], "points", "prepared ns", "evaluate ns", "ratio");
    for (std::size_t b = 0; b < std::size(kBatches); ++b)
        std::printf("  %8zu %14.0f %14.0f %8.2f\n", kBatches[b], ns_a_call(2 * b), ns_a_call(2 * b + 1),
                    ns_a_call(2 * b) / ns_a_call(2 * b + 1));
    const double call_ns = ns_a_call(0) - own_ns;
    std::printf("  one point: %.0f ns beside its own time; target at most 2000: %s\n", call_ns,
                verdict(call_ns <= 2000.0));
}

// What bounds cost beside the frame that they are of: made once after set(), then asked for regions.
void bounds_table(const std::string& name, const Scene& scene, int repeats) {
    Query query;
    query.name = "points";
    query.products = products(Product::Position);
    query.cell_m = query.pixel_m = {0.5};
    Frame<float> frame(std::make_shared<const Sea<float>>(make_plan(scene, {query})));
    double t_s = 0.0;
    frame.set(t_s);
    FrameBounds<float> bounds(frame, 0);
    const double side_m = 2.0 * kTwoPi / frame.sea().plan().from->spectrum.longest_peak_wavenumber();
    const RestRegion region{{0.0, 0.0}, {side_m, side_m}};
    std::vector<Timed> timed{{"set", [&] { frame.set(t_s += 0.04); }},
                             {"refresh", [&] { bounds.refresh(); }}};
    constexpr int kBlocks[] = {1, 64, 1024, 4096};
    for (const int blocks : kBlocks)
        timed.push_back({"a region of two peak waves, at most " + std::to_string(blocks) + " blocks",
                         [&, blocks] { bounds.region(region, blocks); }});
    interleave(timed, repeats);
    std::printf("\nBounds, %s: µs\n", name.c_str());
    for (const Timed& of : timed) std::printf("  %-50s %10.1f\n", of.name.c_str(), 1e3 * of.least());
}

void run(int repeats) {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    std::printf("A call of the query, least of %d repeats, one thread\n", repeats);
    const ProductSet floats = products(Product::Position, Product::Normal, Product::Velocity);
    const ProductSet all = ~lasting_products();
    Scene trains;
    trains.waves.model = WaveModel::Trochoid;
    table({"default sea, position", Scene(), products(Product::Position)}, repeats);
    table({"default sea, position, normal, velocity", Scene(), floats}, repeats);
    table({"default sea, everything", Scene(), all}, repeats);
    table({"60 wave trains, position", trains, products(Product::Position)}, repeats);
    table({"60 wave trains, everything", trains, all}, repeats);
    bounds_table("default sea", Scene(), std::max(1, repeats / 10));
    bounds_table("60 wave trains", trains, std::max(1, repeats / 10));
}

}  // namespace
}  // namespace pelagic::bench

int main(int argc, char** argv) {
    pelagic::bench::run(argc > 1 ? std::max(1, std::atoi(argv[1])) : 300);
    return 0;
}
