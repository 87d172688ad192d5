// Two choices that a frame makes, each beside what it might do instead: two real rows in one complex
// transform, and derivatives by transform.

#include <fftw3.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <string>

#include "core/waves/kernels.h"
#include "core/waves/transform.h"
#include "tests/bench/sea.h"
#include "tests/bench/timing.h"

namespace pelagic::bench {
namespace {

// ---- Rows: half a spectrum in, N real values out

constexpr int kRows = 64;  // with N = 1024 and a result's place for each, half a megabyte: level 2

// From a half spectrum to one real row, planned by FFTW_PATIENT. The input is kept, as ours is.
class RealLine {
  public:
    explicit RealLine(int n) : stride_(line_stride<float>(n)) {
        Buffer<float> from(2 * stride_), to(stride_);
        const fftwf_iodim line{n, 1, 1};
        plan_ = fftwf_plan_guru_split_dft_c2r(1, &line, 0, nullptr, from.data(), from.data() + stride_ / 2,
                                              to.data(), FFTW_PATIENT | FFTW_PRESERVE_INPUT);
        fftwf_forget_wisdom();
    }
    RealLine(const RealLine&) = delete;
    RealLine& operator=(const RealLine&) = delete;
    ~RealLine() { fftwf_destroy_plan(plan_); }
    void execute(float* from, float* to) const {
        fftwf_execute_split_dft_c2r(plan_, from, from + stride_ / 2, to);
    }

  private:
    std::size_t stride_;
    fftwf_plan plan_;
};

void rows_table() {
    std::printf(
        "\nRows, one thread: two in one complex transform (estimated plan, as in a frame) against a "
        "complex-to-real one each (FFTW_PATIENT)\n  %-8s %16s %16s %16s %8s\n",
        "", "one each, ns/row", "two in one", "with pairing", "ratio");
    const Kernels<float> kernel = kernels<float>();
    for (const int n : {256, 512, 1024, 2048, 4096}) {
        const std::size_t stride = line_stride<float>(n);
        Buffer<float> spectra(kRows * stride), rows(kRows * stride), line(2 * stride);
        const LineTransform<float> two_in_one(n);
        const RealLine one_each(n);
        const int rounds = 8 * 4096 / n;
        const auto repeat = [&](auto work) {
            return [=] {
                for (int i = 0; i < rounds; ++i) work();
            };
        };
        float* const from = spectra.data();
        float* const to = rows.data();
        float* const whole = line.data();
        std::vector<Timed> timed{{"one each", repeat([&, from, to, stride] {
                                      for (int i = 0; i < kRows; ++i)
                                          one_each.execute(from + i * stride, to + i * stride);
                                  })},
                                 {"two in one", repeat([&, from, to, stride] {
                                      for (int i = 0; i < kRows; i += 2)
                                          two_in_one.execute(from + i * stride, to + i * stride);
                                  })},
                                 {"with pairing", repeat([&, from, to, whole, stride] {
                                      for (int i = 0; i < kRows; i += 2) {
                                          kernel.pair({.first = from + i * stride,
                                                       .second = from + (i + 1) * stride,
                                                       .radius = n / 2 - 1,
                                                       .n = n,
                                                       .line_re = whole,
                                                       .line_im = whole + stride});
                                          two_in_one.execute(whole, to + i * stride);
                                      }
                                  })}};
        interleave(timed, 21);
        const auto ns = [&](std::size_t i) { return 1e6 * timed[i].median() / (rounds * kRows); };
        std::printf("  %6d %18.0f %16.0f %16.0f %8.2f\n", n, ns(0), ns(1), ns(2), ns(2) / ns(0));
    }
}

// ---- Derivatives: eighth-order central differences of the displacement

// f'(0) h ≈ Σ c_i (f(i h) − f(−i h)), exact for polynomials of degree 8.
constexpr std::array<float, 4> kEighthOrder{4.0f / 5.0f, -1.0f / 5.0f, 4.0f / 105.0f, -1.0f / 280.0f};
constexpr int kReach = 4;

// A row's derivative from nine rows (across) or from itself and a little beyond its ends (along); compiled
// for several CPUs and chosen at run time, as our kernels are.
__attribute__((target_clones("avx512f", "avx2", "default"), optimize("O3"))) void difference(
    const float* const* plus, const float* const* minus, float per_m, int n, float* to) {
    for (int i = 0; i < n; ++i) {
        float sum = 0.0f;
        for (int j = 0; j < kReach; ++j) sum += kEighthOrder[j] * (plus[j][i] - minus[j][i]);
        to[i] = per_m * sum;
    }
}

struct Derived {
    Field of, field;
    bool along_x;
};
constexpr Derived kDerived[] = {{Field::Height, Field::SlopeX, true},
                                {Field::Height, Field::SlopeY, false},
                                {Field::Dx, Field::Dxx, true},
                                {Field::Dy, Field::Dyy, false},
                                {Field::Dx, Field::Dxy, false}};

using Planes = std::array<Buffer<float>, std::size(kDerived)>;

void derive(const Frame<float>& frame, int n, Planes& planes) {
    const auto stride = static_cast<std::ptrdiff_t>(line_stride<float>(n));
    const auto per_m = static_cast<float>(n / kSize_m);
    tbb::parallel_for(0, n, [&](int y) {
        std::vector<float> wrapped(n + 2 * kReach);
        for (std::size_t d = 0; d < std::size(kDerived); ++d) {
            const float* plane = frame.samples(0, 0, kDerived[d].of);
            const float *plus[kReach], *minus[kReach];
            if (kDerived[d].along_x) {
                const float* row = plane + y * stride;
                std::copy(row + n - kReach, row + n, wrapped.begin());
                std::copy(row, row + n + kReach, wrapped.begin() + kReach);
                for (int j = 0; j < kReach; ++j) {
                    plus[j] = wrapped.data() + kReach + (j + 1);
                    minus[j] = wrapped.data() + kReach - (j + 1);
                }
            } else {
                for (int j = 0; j < kReach; ++j) {
                    plus[j] = plane + (y + j + 1) % n * stride;
                    minus[j] = plane + (y + n - j - 1) % n * stride;
                }
            }
            difference(plus, minus, per_m, n, planes[d].data() + y * stride);
        }
    });
}

void derivatives_table() {
    constexpr int kN = 1024;
    std::printf(
        "\nDerivatives of a %d^2 frame: five transforms (a frame of eight fields less one of three) against "
        "differences on the grid\n  %-26s %8s %14s %14s %16s %16s\n",
        kN, "waves end at", "threads", "transforms ms", "differences ms", "slope rms error", "Jacobian's");
    for (const int part : {1, 2, 4, 8}) {
        // A footprint's filter passes nothing shorter than two of it: of `part` spacings, an n-th of Nyquist.
        const double footprint_m = part == 1 ? 0.0 : part * kSize_m / kN;
        Frame<float> three(
            sea_on_own_grids({.products = products(Product::Displacement), .footprint_m = footprint_m}));
        Frame<float> eight(sea_on_own_grids({.footprint_m = footprint_m}));
        Planes planes;
        for (Buffer<float>& plane : planes) plane = Buffer<float>(grid_samples<float>(kN));
        for (const int threads : {1, 2}) {
            const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
            double t = 0.0;
            std::vector<Timed> timed{{"three", [&] { three.set(t += 0.04); }},
                                     {"eight", [&] { eight.set(t); }},
                                     {"differences", [&] { derive(eight, kN, planes); }}};
            interleave(timed, 21);
            // Relative to the exact field's own rms; slopes together, strains together.
            double error[2] = {}, whole[2] = {};
            for (std::size_t d = 0; d < std::size(kDerived); ++d) {
                const float* exact = eight.samples(0, 0, kDerived[d].field);
                for (int y = 0; y < kN; ++y)
                    for (int x = 0; x < kN; ++x) {
                        const std::size_t at = y * line_stride<float>(kN) + x;
                        const double value = static_cast<double>(exact[at]),
                                     off = static_cast<double>(planes[d][at]) - value;
                        error[d < 2 ? 0 : 1] += off * off;
                        whole[d < 2 ? 0 : 1] += value * value;
                    }
            }
            std::printf("  Nyquist%-19s %8d %14.2f %14.2f %16.1e %16.1e\n",
                        part == 1 ? "" : (" / " + std::to_string(part)).c_str(), threads,
                        timed[1].median() - timed[0].median(), timed[2].median(),
                        std::sqrt(error[0] / whole[0]), std::sqrt(error[1] / whole[1]));
        }
    }
}

}  // namespace
}  // namespace pelagic::bench

int main() {
    pelagic::bench::rows_table();
    pelagic::bench::derivatives_table();
}
