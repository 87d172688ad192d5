// A bake: what its overlap gains, and what its checksums and going on cost.
//   bake [FRAMES [ROUNDS [DIR]]]      default 100 4, into the system's folder for temporary files
//
// Three ways to spend time, in turn: computing alone; encoding and writing alone, of values that are there
// already, side by side as in a bake; and the bake. Writing alone, as many bytes of which nothing is made,
// says what the disk is good for.

#include <oneapi/tbb/info.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "plugin/bake/bake.h"
#include "plugin/bake/sequence.h"
#include "plugin/files/checksum.h"
#include "plugin/files/files.h"
#include "plugin/files/read.h"
#include "tests/bench/timing.h"

namespace pelagic::bench {
namespace {

namespace fs = std::filesystem;

constexpr int kN = 1024;

Scene million_vertices(int frames) {
    Scene scene;
    scene.shot.last_frame = frames;
    scene.surface.size_m = 400.0;
    scene.surface.resolution = kN;
    scene.waves.cascades = {{.size_m = 400.0, .resolution = kN}};
    scene.output.mesh = MeshFormat::Usdc;
    scene.output.maps = {MapKind::Displacement, MapKind::Normal};
    scene.output.map_resolution = kN;
    return scene;
}

// A way to spend time on all frames, which says how long they took, and the processor's time beside.
struct Way {
    std::string name;
    std::function<double()> wall_of;
    std::vector<double> wall_s{}, processor_s{};
};

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

void overlap_table(const Scene& scene, Sequence& sequence, int rounds, const fs::path& folder) {
    const int frames = scene.shot.last_frame;
    std::array<FrameSlot, kFramesInFlight> slots;
    for (FrameSlot& slot : slots) {
        sequence.compute(1, slot);
        sequence.encode(slot);
    }
    std::uintmax_t bytes = 0, bytes_a_frame = 0;
    const FileSink sink = [&](const FileJob& file) {
        bytes += files::write_atomically(folder / file.path, file.content).bytes;
    };
    const auto nothing = [](int, int) {};
    const auto compute = [&](int item, int place) { sequence.compute(item + 1, slots[place]); };
    const auto encode = [&](int, int place) { sequence.encode(slots[place]); };
    const auto write = [&](int item, int place) {
        slots[place].frame = item + 1;
        sequence.write(slots[place], sink);
    };
    const auto wall_of = [&](const PipelineStages& stages) {
        return run_pipeline(frames, kFramesInFlight, stages).wall_s;
    };
    RunReport report;
    std::vector<Way> ways{
        {"computing alone",
         [&] { return wall_of({.compute = compute, .encode = nothing, .write = nothing}); }},
        {"encoding and writing alone",
         [&] { return wall_of({.compute = nothing, .encode = encode, .write = write}); }},
        {"writing alone", [&] { return wall_of({.compute = nothing, .encode = nothing, .write = write}); }},
        {"the bake", [&] {
             report = bake(scene, {.out = folder, .frames = {}, .progress = {}});
             return report.times.wall_s;
         }}};
    // Each round begins with another way: a disk that tires slows all alike.
    for (std::size_t round = 0; round < static_cast<std::size_t>(rounds); ++round)
        for (std::size_t i = 0; i < ways.size(); ++i) {
            Way& way = ways[(i + round) % ways.size()];
            fs::remove_all(folder);
            fs::create_directories(folder / "mesh");
            fs::create_directories(folder / "maps");
            sync();  // what lies in the system's cache from before is not this way's to wait for
            bytes = 0;
            const double before_s = processor_s();
            way.wall_s.push_back(way.wall_of());
            way.processor_s.push_back(processor_s() - before_s);
            if (way.name == "writing alone") bytes_a_frame = bytes / frames;
        }
    fs::remove_all(folder);

    const double computing_s = median(ways[0].wall_s), encoding_s = median(ways[1].wall_s),
                 baking_s = median(ways[3].wall_s);
    const int cores = tbb::info::default_concurrency();
    const double processor_floor_s = (median(ways[0].processor_s) + median(ways[1].processor_s)) / cores;
    std::printf(
        "\nA bake of %d frames to %s: %d^2 vertices as crates, two maps of %d^2, %.0f MB a frame, "
        "%d cores,\nmedians of %d interleaved rounds\n  %-28s %10s %16s\n",
        frames, folder.parent_path().c_str(), kN + 1, kN, 1e-6 * static_cast<double>(bytes_a_frame), cores,
        rounds, "", "ms a frame", "processor's ms");
    for (const Way& way : ways)
        std::printf("  %-28s %10.1f %16.1f\n", way.name.c_str(), 1e3 * median(way.wall_s) / frames,
                    1e3 * median(way.processor_s) / frames);
    std::printf(
        "  the bake to the larger of computing and encoding and writing: %.2f\n"
        "  the floor of that, all work spread evenly over the cores: %.2f\n  %s\n",
        baking_s / std::max(computing_s, encoding_s),
        std::max({processor_floor_s, computing_s, encoding_s}) / std::max(computing_s, encoding_s),
        time_text(report).c_str());
}

// What checksums cost: the bytes of a bake are hashed as they are written, and read and hashed by the next one.
void resume_table(const Scene& scene, int rounds, const fs::path& folder) {
    const auto again = [&](bool trust_times) {
        RunOptions options;
        options.out = folder;
        options.trust_times = trust_times;
        return bake(scene, options).seconds;
    };
    const double before_s = processor_s();
    const double baking_s = again(false), baking_processor_s = processor_s() - before_s;
    std::vector<double> reading_s, trusting_s, hashing_s;
    std::uintmax_t bytes = 0;
    for (int round = 0; round < rounds; ++round) {
        reading_s.push_back(again(false));
        trusting_s.push_back(again(true));
        hashing_s.push_back(0.0);
        bytes = 0;
        for (const fs::directory_entry& file : fs::recursive_directory_iterator(folder)) {
            if (!file.is_regular_file()) continue;
            std::string content;
            files::read_pieces(file.path(), [&](std::string_view piece) { content += piece; });
            bytes += content.size();
            const double start_s = processor_s();
            files::checksum_of(content);
            hashing_s.back() += processor_s() - start_s;
        }
    }
    fs::remove_all(folder);
    std::printf(
        "\nThe same bake again, all of it whole, against the bake; %.0f MB\n"
        "  its files read: %.4f; sizes and times trusted: %.4f\n"
        "  the checksums of its bytes, of the bake's processor time: %.4f\n",
        1e-6 * static_cast<double>(bytes), median(reading_s) / baking_s, median(trusting_s) / baking_s,
        median(hashing_s) / baking_processor_s);
}

int run(int argc, char** argv) {
    const int frames = argc > 1 ? std::atoi(argv[1]) : 100;
    const int rounds = argc > 2 ? std::atoi(argv[2]) : 4;
    const fs::path folder = (argc > 3 ? fs::path(argv[3]) : fs::temp_directory_path()) /
                            ("pelagic-bench-" + std::to_string(getpid()));
    if (frames < 1 || rounds < 1) {
        std::fprintf(stderr, "usage: bench_bake [FRAMES [ROUNDS [DIR]]], both at least 1\n");
        return 2;
    }
    const Scene scene = million_vertices(frames);
    const std::unique_ptr<Sequence> sequence = make_sequence(plan_bake(scene));
    overlap_table(scene, *sequence, rounds, folder);
    resume_table(scene, rounds, folder);
    std::printf("  peak memory of this process: %.0f MiB\n", peak_mib());
    return 0;
}

}  // namespace
}  // namespace pelagic::bench

int main(int argc, char** argv) {
    return pelagic::bench::run(argc, argv);
}
