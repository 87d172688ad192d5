// What wakes and numbers with keys cost a default bake, against the same without them.
//   places [ROUNDS [FRAMES]]      default 5 48
//
// All bakes in one process, in turn, on two threads; of each round the ratio by the clock and by the processor. What the waves are is measured by
// tests, whose figures places.py prints beside these.
#include <oneapi/tbb/global_control.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "core/scene/keys.h"
#include "plugin/bake/bake.h"
#include "plugin/bake/sequence.h"
#include "tests/bench/timing.h"

namespace pelagic::bench {
namespace {

namespace fs = std::filesystem;

constexpr int kThreads = 2;

// Side by side, at the speed of a vessel's own default.
Scene with_vessels(Scene scene, int count) {
    constexpr double kApart_m = 15.0;
    for (int i = 0; i < count; ++i) {
        const std::string north_m = std::to_string(kApart_m * (i - 0.5 * (count - 1)));
        scene.waves.vessels.push_back({.path = "1 0 " + north_m + ", 48 10 " + north_m});
    }
    return scene;
}

// What a keyed shot is compared with: pairs of waves have no keyed depth to feel.
Scene by_the_shore() {
    Scene scene;
    scene.sea.depth_m = 30.0;
    scene.sea.swell = {{}};
    scene.waves.second_order = 0.0;
    return scene;
}
Scene keyed(Scene scene, int frames, bool with_sun) {
    const auto give = [&](const char* path, double first, double last) {
        const NumberKeys number{{{1, first}, {frames, last}}, CameraInterpolation::Smooth};
        if (set_value(scene, key_of(path), number)) std::abort();
    };
    give("sea.wind_speed_mps", 8.0, 14.0);
    give("sea.depth_m", 30.0, 20.0);
    if (with_sun) give("light.sun_elevation_deg", 40.0, 20.0);
    scene.sea.swell[0].height_m = 1.5;
    scene.keyed.push_back(
        {"sea.swell[0].height_m", {{{1, 1.0}, {frames, 1.5}}, CameraInterpolation::Smooth}});
    return scene;
}

struct Bake {
    Scene scene;
    std::vector<int> frames;  // none: all
    std::vector<double> wall_s{}, processor_s{};
};

void bake_once(Bake& of, const fs::path& folder) {
    fs::remove_all(folder);
    const double before_s = processor_s();
    const RunReport report = bake(of.scene, {.out = folder, .frames = of.frames, .progress = {}});
    of.processor_s.push_back(processor_s() - before_s);
    of.wall_s.push_back(report.seconds);
}

// Of each round, the lowest, the median and the highest.
struct Spread {
    std::vector<double> values;
    explicit Spread(std::vector<double> all) : values(std::move(all)) {
        std::sort(values.begin(), values.end());
    }
    double median() const { return values[values.size() / 2]; }
};

Spread ratios(const std::vector<double>& of, const std::vector<double>& to) {
    std::vector<double> each;
    for (std::size_t i = 0; i < of.size(); ++i) each.push_back(of[i] / to[i]);
    return Spread(std::move(each));
}

void row(const char* what, const Spread& found, double target) {
    std::printf("%s\t%.2f (%.2f ... %.2f)\t<= %g\t%s\n", what, found.median(), found.values.front(),
                found.values.back(), target, verdict(found.median() <= target));
}

void run(int rounds, int frames) {
    Scene plain, shore = by_the_shore();
    plain.shot.last_frame = shore.shot.last_frame = frames;
    const Scene one_vessel = with_vessels(plain, 1), sea = keyed(shore, frames, false),
                sun = keyed(shore, frames, true);
    const std::vector<int> all, alone{frames / 2};
    enum { Plain, One, Ten, PlainAlone, OneAlone, Shore, Sea, ShoreAlone, SeaAlone, Sun, SunAlone };
    std::vector<Bake> bakes{{plain, all},   {one_vessel, all},   {with_vessels(plain, 10), all},
                            {plain, alone}, {one_vessel, alone}, {shore, all},
                            {sea, all},     {shore, alone},      {sea, alone},
                            {sun, all},     {sun, alone}};
    const fs::path folder = fs::temp_directory_path() / ("pelagic-bench-" + std::to_string(getpid()));
    bake_once(bakes[PlainAlone], folder);  // warms up
    bakes[PlainAlone].wall_s.clear();
    bakes[PlainAlone].processor_s.clear();
    for (int round = 0; round < rounds; ++round)
        for (std::size_t i = 0; i < bakes.size(); ++i) {
            const std::size_t of = (i + static_cast<std::size_t>(round)) % bakes.size();
            if (round == 0 || of < Sun) bake_once(bakes[of], folder);  // skies take long
        }
    fs::remove_all(folder);
    const auto by_clock = [&](int of, int to) { return ratios(bakes[of].wall_s, bakes[to].wall_s); };
    const auto by_processor = [&](int of, int to) {
        return ratios(bakes[of].processor_s, bakes[to].processor_s);
    };
    row("a default bake with one vessel over none, by the clock", by_clock(One, Plain), 1.5);
    row("the same, the processor's time", by_processor(One, Plain), 1.5);
    row("a default bake with ten vessels over none, by the clock", by_clock(Ten, Plain), 5.0);
    row("the same, the processor's time", by_processor(Ten, Plain), 5.0);
    std::vector<double> more_s;
    for (std::size_t i = 0; i < bakes[OneAlone].processor_s.size(); ++i)
        more_s.push_back(bakes[OneAlone].processor_s[i] - bakes[PlainAlone].processor_s[i]);
    row("a frame alone, what a vessel adds, s of the processor", Spread(more_s), 0.2);
    const auto mib = [&](int of) {
        const Plan plan = plan_bake(bakes[of].scene);
        return static_cast<double>(bake_memory(plan, static_cast<std::size_t>(frames), kThreads).bytes()) /
               (1 << 20);
    };
    std::printf("what one vessel and ten add to the bytes that are said\t%.0f, %.0f MiB\tsaid\tmet\n",
                mib(One) - mib(Plain), mib(Ten) - mib(Plain));
    row("keyed wind, depth, swell, under living foam, over none: in a run", by_processor(Sea, Shore), 1.5);
    row("the same alone, construction counted", by_processor(SeaAlone, ShoreAlone), 2.0);
    row("with a keyed sun besides, whose sky each frame bakes: in a run", by_processor(Sun, Shore), 1.5);
    row("the same alone", by_processor(SunAlone, ShoreAlone), 2.0);
}

}  // namespace
}  // namespace pelagic::bench

int main(int argc, char** argv) {
    const int rounds = argc > 1 ? std::atoi(argv[1]) : 5, frames = argc > 2 ? std::atoi(argv[2]) : 48;
    if (rounds < 1 || frames < 2) {
        std::fprintf(stderr, "usage: bench_places [ROUNDS [FRAMES]]\n");
        return 2;
    }
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, 2);
    pelagic::bench::run(rounds, frames);
}
