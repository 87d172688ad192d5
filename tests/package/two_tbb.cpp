// A host with a oneTBB of its own, whose threads ask libpelagic, which has another: two in one process.
//   two_tbb SHOT.toml
#include <pelagic/procedural.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <cstdio>
#include <functional>
#include <string_view>

int main(int, char** argv) {
    pelagic_error error{};
    pelagic_sea* sea = nullptr;
    pelagic_frame* frame = nullptr;
    pelagic_source source{};
    source.size = sizeof source;
    source.path = argv[1];
    if (pelagic_open(&source, nullptr, &sea, &error) || pelagic_frame_create(sea, 3.0, 3.0, &frame, &error)) {
        std::fprintf(stderr, "%s\n", error.message);
        return 1;
    }
    const auto heights = [&](const tbb::blocked_range<int>& places, double sum) {
        for (int i = places.begin(); i != places.end(); ++i) {
            const double place[2] = {0.1 * i, -0.2 * i};
            pelagic_water water = PELAGIC_INIT(pelagic_water);
            if (!pelagic_water_at(frame, place, 1, 0.5, &water, &error)) sum += water.height_m;
        }
        return sum;
    };
    const tbb::blocked_range<int> all(0, 1000);
    const double together = tbb::parallel_deterministic_reduce(all, 0.0, heights, std::plus<>());
    const double again = tbb::parallel_deterministic_reduce(all, 0.0, heights, std::plus<>());
    pelagic_frame_release(frame);
    pelagic_close(sea);

    bool ours = false, theirs = false;
    char line[4096];
    std::FILE* maps = std::fopen("/proc/self/maps", "r");
    while (maps && std::fgets(line, sizeof line, maps)) {
        const std::string_view text(line);
        ours |= text.find("/libtbb-pelagic.so") != text.npos;
        theirs |= text.find("/libtbb.so") != text.npos;
    }
    std::printf("mean height %.4f m; oneTBB: %s %s\n", together / 1000.0, ours ? "libpelagic's" : "",
                theirs ? "the host's" : "");
    return together == again && together != 0.0 && ours && theirs ? 0 : 1;
}
