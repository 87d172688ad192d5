// A frame against its floor: from the spectrum to usable arrays, and the same number of transforms by FFTW alone, in the same process.
// FFTW's are two real fields in a complex transform, in place, rows padded, planned by FFTW_MEASURE, each on one thread: of its
// arrangements the fastest on most machines and sizes, or within a tenth of it.
//   frame [RESOLUTION…]      default: every row; else the squares of these resolutions only
#include <fftw3.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/buffer.h"
#include "core/plan/plan.h"
#include "core/waves/frame.h"
#include "core/waves/planning.h"
#include "core/waves/sea.h"
#include "tests/bench/timing.h"

namespace pelagic::bench {
namespace {

constexpr int kThreads[] = {1, 2};

// Of a cascade's period to the next one's: the golden ratio cubed, as "auto" cascades have it; and so far apart that each of four
// cascades of 256² holds all its modes.
constexpr double kUsualRatio = 4.23606797749979, kWideRatio = 16.0;

// The bare transforms of `fields` fields of n × n: no spectrum is written into them.
class BareFftw {
  public:
    BareFftw(int n, int fields)
        : pairs_((fields + 1) / 2),
          size_(2 * static_cast<std::size_t>(n) * static_cast<std::size_t>(n + kPadding)),
          fields_(size_ * static_cast<std::size_t>(pairs_)) {
        const int size[2] = {n, n}, rows[2] = {n, n + kPadding};
        plan_ = fftwf_plan_many_dft(2, size, 1, pair(0), rows, 1, 0, pair(0), rows, 1, 0, FFTW_BACKWARD,
                                    FFTW_MEASURE);
        const PlannedBy recorded(Planning::Recorded);  // what FFTW has learnt is forgotten
    }
    ~BareFftw() { fftwf_destroy_plan(plan_); }
    BareFftw(const BareFftw&) = delete;
    BareFftw& operator=(const BareFftw&) = delete;

    void run() {
        tbb::parallel_for(0, pairs_, [&](int i) { fftwf_execute_dft(plan_, pair(i), pair(i)); });
    }

  private:
    static constexpr int kPadding =
        16;  // complex values: two cache lines, against strides that are powers of two

    fftwf_complex* pair(int i) {
        return reinterpret_cast<fftwf_complex*>(fields_.data() + size_ * static_cast<std::size_t>(i));
    }

    int pairs_;
    std::size_t size_;  // floats of two fields
    Buffer<float> fields_;
    fftwf_plan plan_;
};

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

// Each cascade (n × n, a period of 400 m, the next ones smaller by the ratio) on its own lattice, whole squares of waves, nothing filtered.
Frame<float> frame_of(const Row& row) {
    Scene scene;
    std::vector<Query> queries;
    double size_m = 400.0;
    for (int c = 0; c < row.cascades; ++c, size_m /= row.ratio) {
        scene.waves.cascades.push_back({.size_m = size_m, .resolution = row.n});
        Query query;
        query.name = "cascade";
        query.products =
            products(Product::Position, Product::Normal, Product::SlopeVariance, Product::Breaking);
        query.points = static_cast<std::size_t>(row.n) * row.n;
        query.lattice = Lattice{-0.5 * size_m, size_m / row.n};
        query.only_cascade = c;
        queries.push_back(std::move(query));
    }
    return Frame<float>(std::make_shared<const Sea<float>>(make_plan(scene, queries)));
}

// Prints a row for each number of threads.
void against_fftw(const Row& row) {
    Frame<float> frame = frame_of(row);
    const int fields = frame.sea().plan().transforms_per_frame();
    BareFftw bare(row.n, fields);
    for (int i = 0; i < 2; ++i) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                        static_cast<std::size_t>(kThreads[i]));
        double t = 0.0;
        std::vector<Timed> timed{{"FFTW", [&] { bare.run(); }}, {"ours", [&] { frame.set(t += 0.04); }}};
        interleave(timed, row.n <= 512 ? 61 : row.n <= 1024 ? 31 : 15);
        const double ratio = timed[1].median() / timed[0].median();
        char target[32] = "shown";
        if (row.target[i])
            std::snprintf(target, sizeof target, "<= %.1f %s", *row.target[i],
                          verdict(ratio <= *row.target[i]));
        std::printf("  %-13s %2d fields %7d %9.2f %9.2f %7.2f  %s\n", row.name().c_str(), fields, kThreads[i],
                    timed[1].median(), timed[0].median(), ratio, target);
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
    };
    if (argc > 1) rows.clear();
    for (int i = 1; i < argc; ++i) rows.push_back({.n = std::atoi(argv[i])});
    std::printf(
        "A frame against the transforms of its fields by FFTW alone; medians of interleaved repeats. full: cascades "
        "whose bands\nfill their squares, as bands of cascades of usual sizes don't\n"
        "  %-23s %7s %9s %9s %7s  target\n",
        "", "threads", "ours ms", "FFTW ms", "ratio");
    for (const Row& row : rows) against_fftw(row);
}
