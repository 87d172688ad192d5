// A host with a oneTBB of its own, whose threads ask libpelagic, which has another: two in one process.
//   two_tbb SHOT.toml
#include <pelagic/procedural.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <atomic>
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
    std::atomic<int> failed{0};
    const auto heights = [&](const tbb::blocked_range<int>& places, double sum) {
        for (int i = places.begin(); i != places.end(); ++i) {
            const double place[2] = {0.1 * i, -0.2 * i};
            pelagic_water water = PELAGIC_INIT(pelagic_water);
            pelagic_error own{};  // of this task alone
            if (pelagic_water_at(frame, place, 1, 0.5, &water, &own))
                ++failed;
            else
                sum += water.height_m;
        }
        return sum;
    };
    const int count = 1000, piece = 50;
    const double together = tbb::parallel_deterministic_reduce(tbb::blocked_range<int>(0, count, piece), 0.0,
                                                               heights, std::plus<>());
    // The same sums in the same order, by this thread alone: pieces are halved until they are small.
    const std::function<double(int, int)> alone = [&](int from, int to) {
        if (to - from <= piece) return heights({from, to}, 0.0);
        const int middle = from + (to - from) / 2;
        return alone(from, middle) + alone(middle, to);
    };
    const double by_one = alone(0, count);
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
    std::printf("mean height %.4f m, by one thread %.4f m, %d failed; oneTBB: %s %s\n", together / count,
                by_one / count, failed.load(), ours ? "libpelagic's" : "", theirs ? "the host's" : "");
    return failed == 0 && together == by_one && together != 0.0 && ours && theirs ? 0 : 1;
}
