// A bake: what its overlap gains, and what each way of packing a map costs.
//   bake [FRAMES [ROUNDS [DIR]]]      default 100 3, into the system's folder for temporary files
//
// Three ways to spend time, in turn: computing alone; encoding and writing alone, of values that are there
// already, side by side as in a bake; and the bake. Writing alone, as many bytes of which nothing is made,
// says what the disk is good for.

#include <oneapi/tbb/info.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "plugin/bake/bake.h"
#include "plugin/bake/maps.h"
#include "plugin/bake/sequence.h"
#include "plugin/exr/exr.h"
#include "plugin/files/files.h"
#include "tests/bench/timing.h"

namespace pelagic::bench {
namespace {

namespace fs = std::filesystem;

constexpr int kN = 1024;

Scene million_vertices(int frames) {
    Scene scene;
    scene.shot.last_frame = frames;
    scene.surface = {.size_m = 400.0, .resolution = kN};
    scene.waves.cascades = {{.size_m = 400.0, .resolution = kN}};
    scene.output.mesh = MeshFormat::Usdc;
    scene.output.maps = {MapKind::Displacement, MapKind::Normal};
    scene.output.map_resolution = kN;
    return scene;
}

// Of this process, both user's and system's [s].
double processor_s() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

void packing_table(Sequence& sequence) {
    using exr::Compression;
    FrameSlot slot;
    sequence.compute(1, slot);
    const std::vector<glm::vec3>& displacement = slot.maps[0].values.displacement;
    const std::vector<glm::vec3>& normal = slot.maps[1].values.normal;
    std::vector<MipLevel<glm::vec3>> normals{{kN, normal}};
    for (auto& level : normal_mips({.n = kN, .texels = normal, .periodic = true}))
        normals.push_back(std::move(level));
    const auto image = [](int n, const std::vector<glm::vec3>& texels, exr::PixelType type) {
        exr::Image picture{.width = n, .height = n, .channels = {}};
        for (int c = 0; c < 3; ++c)
            picture.channels.push_back({.name = std::string(1, "RGB"[c]),
                                        .data = &texels.data()->x + c,
                                        .pixel_stride_bytes = sizeof(glm::vec3),
                                        .type = type});
        return picture;
    };
    std::vector<exr::Image> levels;
    for (const auto& level : normals) levels.push_back(image(level.n, level.texels, exr::PixelType::Half));

    struct Row {
        const char* name;
        Compression compression;
        std::size_t displacement_bytes = 0, normal_bytes = 0;
    };
    std::array<Row, 5> rows{{{"none", Compression::None},
                             {"RLE", Compression::Rle},
                             {"ZIPS", Compression::Zips},
                             {"ZIP", Compression::Zip},
                             {"PIZ", Compression::Piz}}};
    std::vector<Timed> timed;
    for (Row& row : rows) {
        timed.push_back({row.name, [&] {
                             row.displacement_bytes =
                                 exr::encode_scanline({.attributes = {}, .compression = row.compression},
                                                      image(kN, displacement, exr::PixelType::Float))
                                     .size();
                         }});
        timed.push_back(
            {row.name, [&] {
                 row.normal_bytes =
                     exr::encode_mipmapped({.attributes = {}, .compression = row.compression}, levels).size();
             }});
    }
    interleave(timed, 5);
    std::printf(
        "OpenEXR's lossless packings, maps of %d^2, one thread, medians of 5 interleaved repeats\n"
        "  %-8s  %28s  %34s\n  %-8s %10s %9s %8s  %16s %9s %8s\n",
        kN, "", "displacement, float", "normal, half, with mip levels", "", "MB", "of none", "ms", "MB",
        "of none", "ms");
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto mb = [](std::size_t bytes) { return 1e-6 * static_cast<double>(bytes); };
        std::printf("  %-8s %10.2f %9.2f %8.1f  %16.2f %9.2f %8.1f\n", rows[i].name,
                    mb(rows[i].displacement_bytes),
                    mb(rows[i].displacement_bytes) / mb(rows[0].displacement_bytes), timed[2 * i].median(),
                    mb(rows[i].normal_bytes), mb(rows[i].normal_bytes) / mb(rows[0].normal_bytes),
                    timed[2 * i + 1].median());
    }
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
    const FileSink sink = [&](const std::string& path, const FileContent& content) {
        const std::uintmax_t size = files::write_atomically(folder / path, content);
        bytes += size;
        return size;
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
    BakeReport report;
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
    for (int round = 0; round < rounds; ++round)
        for (Way& way : ways) {
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

int run(int argc, char** argv) {
    const int frames = argc > 1 ? std::atoi(argv[1]) : 100;
    const int rounds = argc > 2 ? std::atoi(argv[2]) : 3;
    const fs::path folder = (argc > 3 ? fs::path(argv[3]) : fs::temp_directory_path()) /
                            ("pelagic-bench-" + std::to_string(getpid()));
    if (frames < 1 || rounds < 1) {
        std::fprintf(stderr, "usage: bench_bake [FRAMES [ROUNDS [DIR]]], both at least 1\n");
        return 2;
    }
    const Scene scene = million_vertices(frames);
    const std::unique_ptr<Sequence> sequence = make_sequence(scene, make_plan(scene));
    packing_table(*sequence);
    overlap_table(scene, *sequence, rounds, folder);
    std::printf("  peak memory of this process: %.0f MiB\n", peak_mib());
    return 0;
}

}  // namespace
}  // namespace pelagic::bench

int main(int argc, char** argv) {
    return pelagic::bench::run(argc, argv);
}
