// Two choices that a frame makes, each beside what it might do instead: two real rows in one complex
// transform, and derivatives by transform.

#include <fftw3.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <string>

#include "core/waves/kernels.h"
#include "core/waves/transform.h"
#include "tests/bench/sea.h"
#include "tests/bench/timing.h"

namespace pelagic::bench {
namespace {

// ---- Rows: half a spectrum in, N real values out

constexpr int kValues = 1 << 16;  // in rows and as many in their results: half a megabyte, level 2

// From half a spectrum to one real row, planned by FFTW_PATIENT; its parts apart, as ours, or side by side.
class RealLine {
  public:
    RealLine(int n, bool apart) : half_(line_stride<float>(n) / 2), apart_(apart) {
        Buffer<float> from(2 * half_), to(2 * half_);
        const fftwf_iodim line{n, 1, 1};
        plan_ = apart ? fftwf_plan_guru_split_dft_c2r(1, &line, 0, nullptr, from.data(), from.data() + half_,
                                                      to.data(), FFTW_PATIENT)
                      : fftwf_plan_dft_c2r_1d(n, reinterpret_cast<fftwf_complex*>(from.data()), to.data(),
                                              FFTW_PATIENT);
        fftwf_forget_wisdom();
    }
    RealLine(const RealLine&) = delete;
    RealLine& operator=(const RealLine&) = delete;
    ~RealLine() { fftwf_destroy_plan(plan_); }
    void execute(float* from, float* to) const {
        if (apart_)
            fftwf_execute_split_dft_c2r(plan_, from, from + half_, to);
        else
            fftwf_execute_dft_c2r(plan_, reinterpret_cast<fftwf_complex*>(from), to);
    }

  private:
    std::size_t half_;
    bool apart_;
    fftwf_plan plan_;
};

void rows_table() {
    std::printf(
        "Rows, one thread, ns a row: two in one complex transform (estimated plan, as in a frame) against a\n"
        "complex-to-real one each (FFTW_PATIENT; parts apart or side by side, whichever is faster)\n"
        "  %-8s %12s %12s %14s %8s\n",
        "", "one each", "two in one", "with pairing", "ratio");
    const Kernels<float> kernel = kernels<float>();
    for (const int n : {256, 512, 1024, 2048, 4096}) {
        const std::size_t stride = line_stride<float>(n);
        const int rows = kValues / n;
        Buffer<float> spectra(rows * stride), results(rows * stride), line(2 * stride);
        const LineTransform<float> two_in_one(n);
        const RealLine apart(n, true), side_by_side(n, false);
        constexpr int kRounds = 8;
        const auto over_rows = [&](int step, const std::function<void(float*, float*)>& work) {
            for (int i = 0; i < kRounds; ++i)
                for (int row = 0; row < rows; row += step)
                    work(spectra.data() + row * stride, results.data() + row * stride);
        };
        const auto paired = [&](float* from, float* to) {
            kernel.pair({.first = from,
                         .second = from + stride,
                         .radius = n / 2,
                         .n = n,
                         .line_re = line.data(),
                         .line_im = line.data() + stride});
            two_in_one.execute(line.data(), to);
        };
        std::vector<Timed> timed{
            {"apart", [&] { over_rows(1, [&](float* from, float* to) { apart.execute(from, to); }); }},
            {"side by side",
             [&] { over_rows(1, [&](float* from, float* to) { side_by_side.execute(from, to); }); }},
            {"two in one",
             [&] { over_rows(2, [&](float* from, float* to) { two_in_one.execute(from, to); }); }},
            {"with pairing", [&] { over_rows(2, paired); }}};
        interleave(timed, 21);
        const auto ns = [&](std::size_t i) { return 1e6 * timed[i].median() / (kRounds * rows); };
        const double each = std::min(ns(0), ns(1));
        std::printf("  %6d %14.0f %12.0f %14.0f %8.2f\n", n, each, ns(2), ns(3), ns(3) / each);
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
        "\nSlopes and Jacobian's derivatives of a %d^2 frame: five transforms (a frame of eight fields less "
        "one "
        "of three) against differences on the grid; errors are rms, relative\n"
        "  %-13s %8s %14s %12s %16s %12s\n",
        kN, "waves end at", "threads", "transforms ms", "error", "differences ms", "error");
    for (const int part : {1, 2, 4, 8}) {
        // A footprint's filter passes nothing shorter than two of it: of `part` spacings, an n-th of Nyquist.
        const double footprint_m = part == 1 ? 0.0 : part * kSize_m / kN;
        Frame<float> three(
            sea_on_own_grids({.products = products(Product::Displacement), .footprint_m = footprint_m}));
        Frame<float> eight(sea_on_own_grids({.footprint_m = footprint_m}));
        Frame<double> exact(sea_on_own_grids<double>({.footprint_m = footprint_m}));
        Planes planes;
        for (Buffer<float>& plane : planes) plane = Buffer<float>(grid_samples<float>(kN));
        for (const int threads : {1, 2}) {
            const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
            double t = 0.0;
            std::vector<Timed> timed{{"three", [&] { three.set(t += 0.04); }},
                                     {"eight", [&] { eight.set(t); }},
                                     {"differences", [&] { derive(eight, kN, planes); }}};
            interleave(timed, 21);
            exact.set(t);
            // Of differences and of transforms, relative to the exact fields' own rms.
            double differences2 = 0.0, transforms2 = 0.0, whole = 0.0;
            for (std::size_t d = 0; d < std::size(kDerived); ++d) {
                const double* truth = exact.samples(0, 0, kDerived[d].field);
                const float* transformed = eight.samples(0, 0, kDerived[d].field);
                for (int y = 0; y < kN; ++y)
                    for (int x = 0; x < kN; ++x) {
                        const double value = truth[y * line_stride<double>(kN) + x];
                        const std::size_t at = y * line_stride<float>(kN) + x;
                        differences2 += std::pow(static_cast<double>(planes[d][at]) - value, 2);
                        transforms2 += std::pow(static_cast<double>(transformed[at]) - value, 2);
                        whole += value * value;
                    }
            }
            std::printf("  Nyquist%-6s %8d %14.2f %12.1e %16.2f %12.1e\n",
                        part == 1 ? "" : (" / " + std::to_string(part)).c_str(), threads,
                        timed[1].median() - timed[0].median(), std::sqrt(transforms2 / whole),
                        timed[2].median(), std::sqrt(differences2 / whole));
        }
    }
}

}  // namespace
}  // namespace pelagic::bench

int main() {
    pelagic::bench::rows_table();
    pelagic::bench::derivatives_table();
}
