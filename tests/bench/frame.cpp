// A frame against its floor: from the spectrum to usable arrays, and the same number of transforms by FFTW
// alone, in whichever arrangement and with whichever planning is fastest here, in the same process.
//   frame [RESOLUTION…]      default: every row; else the squares of these resolutions only

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <optional>
#include <string>

#include "core/waves/transform.h"
#include "tests/bench/fftw.h"
#include "tests/bench/sea.h"

namespace pelagic::bench {
namespace {

constexpr int kThreads[] = {1, 2};

// Periods so far apart that each of four cascades of 256² holds all its modes.
constexpr double kWideRatio = 16.0;

class Threads {
  public:
    explicit Threads(int count) : limit_(tbb::global_control::max_allowed_parallelism, count) {}

  private:
    tbb::global_control limit_;
};

// About as many samples for each row, within reason.
int repeats_of(int n) {
    return n <= 512 ? 61 : n <= 1024 ? 31 : n <= 2048 ? 15 : 7;
}

// Plans as every program does, whatever was planned before.
Frame<float> unaided_frame(std::shared_ptr<const Sea<float>> sea) {
    only_recorded_plans();
    return Frame<float>(std::move(sea));
}

struct Row {
    int n = 1024, cascades = 1;
    double ratio = kUsualRatio;                     // of the cascades' periods
    std::array<std::optional<double>, 2> target{};  // by kThreads: our time over FFTW's

    std::string name() const {
        const std::string square = std::to_string(n) + "^2";
        if (cascades == 1) return square;
        return std::to_string(cascades) + " x " + square + (ratio == kWideRatio ? " full" : "");
    }
};
struct PerSample {
    double ours_ns, fftw_ns;
};

// The frame's one-dimensional transforms and nothing else, each thread's in its own level-1 cache.
void lines_alone(const LineTransform<float>& transform, long lines) {
    constexpr long kAtOnce = 64;
    tbb::parallel_for(0L, (lines + kAtOnce - 1) / kAtOnce, [&](long block) {
        thread_local Buffer<float> from, to;
        const std::size_t size = 2 * line_stride<float>(transform.n());
        if (from.size() != size) from = Buffer<float>(size), to = Buffer<float>(size);
        for (long i = block * kAtOnce; i < std::min(lines, (block + 1) * kAtOnce); ++i)
            transform.execute(from.data(), to.data());
    });
}

// Prints a row for each number of threads.
void against_fftw(const Row& row, std::map<int, PerSample> (&per_sample)[2]) {
    Frame<float> frame =
        unaided_frame(sea_on_own_grids({.n = row.n, .cascades = row.cascades, .ratio = row.ratio}));
    const Plan& plan = frame.sea().plan();
    const int fields = plan.transforms_per_frame();
    const LineTransform<float> line(row.n);
    BareFftw bare(row.n, fields);
    for (int i = 0; i < 2; ++i) {
        const Threads limit(kThreads[i]);
        double t = 0.0;
        std::vector<Timed> timed = bare.fastest(kThreads[i]);
        timed.push_back({"ours", [&] { frame.set(t += 0.04); }});
        timed.push_back({"lines alone", [&] { lines_alone(line, plan.lines_per_frame()); }});
        interleave(timed, repeats_of(row.n));
        const double ours_ms = timed[timed.size() - 2].median(), lines_ms = timed.back().median();
        const Timed* fftw = &timed[0];
        for (std::size_t j = 1; j + 2 < timed.size(); ++j)
            if (timed[j].median() < fftw->median()) fftw = &timed[j];
        const double ratio = ours_ms / fftw->median();
        const double samples = static_cast<double>(fields) * row.n * row.n;
        if (row.cascades == 1)
            per_sample[i][row.n] = {1e6 * ours_ms / samples, 1e6 * fftw->median() / samples};
        char target[32] = "shown";
        if (row.target[i])
            std::snprintf(target, sizeof target, "<= %.1f %s", *row.target[i],
                          verdict(ratio <= *row.target[i]));
        std::printf("  %-13s %2d fields %7d %9.2f %9.2f %7.2f  %-13s %7.2f  %s\n", row.name().c_str(), fields,
                    kThreads[i], ours_ms, fftw->median(), ratio, target, lines_ms / ours_ms,
                    fftw->name.c_str());
    }
}

void growth(const std::map<int, PerSample> (&per_sample)[2]) {
    std::printf(
        "\nCost of a sample of a field, and its growth; target: ours grows no more than FFTW's\n"
        "  %-9s %8s %10s %10s %10s %10s\n",
        "", "threads", "ours ns", "FFTW ns", "ours x", "FFTW x");
    for (int i = 0; i < 2; ++i) {
        const PerSample& first = per_sample[i].begin()->second;
        for (const auto& [n, cost] : per_sample[i]) {
            const double ours = cost.ours_ns / first.ours_ns, fftw = cost.fftw_ns / first.fftw_ns;
            std::printf("  %6d^2  %8d %10.3f %10.3f %10.2f %10.2f  %s\n", n, kThreads[i], cost.ours_ns,
                        cost.fftw_ns, ours, fftw, verdict(ours <= fftw));
        }
    }
}

void displacement_alone() {
    std::printf(
        "\n1024^2, displacement only against everything; target: as the transforms say, within 15 %%\n"
        "  %8s %12s %12s %8s %10s\n",
        "threads", "3 fields", "11 fields", "ratio", "to 3/11");
    Frame<float> few = unaided_frame(sea_on_own_grids({.products = products(Product::Displacement)}));
    Frame<float> all =
        unaided_frame(sea_on_own_grids({.products = kEightFields | products(Product::Velocity)}));
    const double counts = static_cast<double>(few.sea().plan().transforms_per_frame()) /
                          all.sea().plan().transforms_per_frame();
    for (const int threads : kThreads) {
        const Threads limit(threads);
        double t = 0.0;
        std::vector<Timed> timed{{"few", [&] { few.set(t += 0.04); }}, {"all", [&] { all.set(t += 0.04); }}};
        interleave(timed, repeats_of(1024));
        const double ratio = timed[0].median() / timed[1].median();
        std::printf("  %8d %9.2f ms %9.2f ms %8.3f %10.2f  %s\n", threads, timed[0].median(),
                    timed[1].median(), ratio, ratio / counts,
                    verdict(std::abs(ratio / counts - 1.0) <= 0.15));
    }
}

// Every sample of every field.
std::vector<float> content(const Frame<float>& frame) {
    std::vector<float> samples;
    for (std::size_t f = 0; f < kFieldCount; ++f)
        if (const float* plane = frame.samples(0, 0, static_cast<Field>(f))) {
            const int n = frame.sea().plan().cascades[0].grids[0].resolution;
            for (int y = 0; y < n; ++y)
                samples.insert(samples.end(), plane + y * line_stride<float>(n),
                               plane + y * line_stride<float>(n) + n);
        }
    return samples;
}

bool same_bits(const std::vector<float>& a, const std::vector<float>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

void same_every_time() {
    std::printf(
        "\nThe same bits every time: plans by estimate (ours) against the fastest (FFTW_PATIENT)\n"
        "  %-8s %8s %10s %10s %8s  %-13s %s\n",
        "", "threads", "ours ms", "free ms", "ratio", "<= 1.10",
        "same bits: again, another frame, 1 and 2 threads");
    for (const int n : {256, 512, 1024, 2048, 4096}) {
        const auto sea = sea_on_own_grids({.n = n});
        Frame<float> ours = unaided_frame(sea), other = unaided_frame(sea);
        learn_lines(n);
        Frame<float> free(sea);
        only_recorded_plans();
        std::vector<float> first;
        for (const int threads : kThreads) {
            const Threads limit(threads);
            double t = 0.0;
            std::vector<Timed> timed{{"ours", [&] { ours.set(t += 0.04); }},
                                     {"free", [&] { free.set(t += 0.04); }}};
            interleave(timed, repeats_of(n));
            const double ratio = timed[0].median() / timed[1].median();
            ours.set(7.0);
            const std::vector<float> now = content(ours);
            if (first.empty()) first = now;
            ours.set(8.0);
            ours.set(7.0);
            other.set(7.0);
            std::printf("  %6d^2 %8d %10.2f %10.2f %8.2f  %-13s %s, %s, %s\n", n, threads, timed[0].median(),
                        timed[1].median(), ratio, verdict(ratio <= 1.10),
                        same_bits(now, content(ours)) ? "yes" : "NO",
                        same_bits(now, content(other)) ? "yes" : "NO", same_bits(now, first) ? "yes" : "NO");
        }
    }
}

}  // namespace
}  // namespace pelagic::bench

int main(int argc, char** argv) {
    using namespace pelagic::bench;
    std::setvbuf(stdout, nullptr, _IOLBF, 0);  // a row takes a while
    std::vector<Row> rows{
        {.n = 1024, .target = {1.6, 1.5}},
        {.n = 512, .target = {1.6, 1.6}},
        {.n = 256, .cascades = 4, .target = {1.6, 1.6}},
        {.n = 256, .cascades = 4, .ratio = kWideRatio, .target = {1.6, 1.6}},
        {.n = 2048, .target = {1.5, 1.5}},
        {.n = 256},
        {.n = 4096},
    };
    if (argc > 1) rows.clear();
    for (int i = 1; i < argc; ++i) rows.push_back({.n = std::atoi(argv[i])});
    std::printf(
        "A frame against the transforms of its fields by FFTW alone, best arrangement and planning; medians "
        "of\n"
        "interleaved repeats. lines: our transforms alone, in cache, over our time; full: cascades whose "
        "bands\n"
        "fill their squares, as bands of cascades of usual sizes don't\n"
        "  %-23s %7s %9s %9s %7s  %-13s %7s  %s\n",
        "", "threads", "ours ms", "FFTW ms", "ratio", "target", "lines", "FFTW's best");
    std::map<int, PerSample> per_sample[2];
    for (const Row& row : rows) against_fftw(row, per_sample);
    growth(per_sample);
    if (argc > 1) return 0;
    displacement_alone();
    same_every_time();
}
