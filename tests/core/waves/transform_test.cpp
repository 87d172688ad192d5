// 1-D transforms against the defining sum, and the recorded plans.
#include "core/waves/transform.h"

#include <fftw3.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <string>

#include "core/base/buffer.h"
#include "core/base/random.h"
#include "core/waves/planning.h"
#include "core/waves/wisdom.h"

namespace pelagic {
namespace {

// Rounding of log2(N) stages: half a unit in the last place each, of sums that grow as √N.
template <class T>
using Parts = typename LineTransform<T>::Parts;
template <class T>
void expect_the_sum(int n, Parts<T> parts = Parts<T>::Apart) {
    const std::size_t stride = line_stride<T>(n);
    Buffer<T> from(2 * stride), to(2 * stride);
    for (int m = 0; m < n; ++m) {
        const auto z = normal_pair({static_cast<std::uint32_t>(m), 0, 0, 0}, 3);
        from[m] = static_cast<T>(z[0]);
        from[stride + m] = static_cast<T>(z[1]);
    }
    LineTransform<T>(n, parts).execute(from.data(), to.data());
    const double tolerance = 4.0 * std::numeric_limits<T>::epsilon() * std::sqrt(n) * (1.0 + std::log2(n));
    for (int j = 0; j < n; j += 1 + n / 16) {
        std::complex<double> sum = 0.0;
        for (int m = 0; m < n; ++m)
            sum += std::complex<double>(from[m], from[stride + m]) *
                   std::polar(1.0, 2.0 * std::numbers::pi * static_cast<double>(std::int64_t(m) * j % n) / n);
        ASSERT_NEAR(to[j], sum.real(), tolerance) << n << ' ' << j;
        ASSERT_NEAR(to[stride + j], sum.imag(), tolerance) << n << ' ' << j;
    }
}

TEST(LineTransform, IsTheSumWithAPositiveExponent) {
    for (int n : {1, 2, 3, 5, 7, 16, 30, 81, 256, 540, 1024, 4096}) {
        expect_the_sum<float>(n);
        expect_the_sum<double>(n);
    }
    for (int n : {2, 7, 30, 480, 512}) {
        expect_the_sum<float>(n, Parts<float>::Paired);
        expect_the_sum<double>(n, Parts<double>::Paired);
    }
}

// Whether FFTW knows a plan for such a line, as LineTransform asks for it, without searching.
bool is_recorded(int n, Parts<float> parts) {
    const std::size_t stride = line_stride<float>(n), imaginary = parts == Parts<float>::Paired ? 1 : stride;
    Buffer<float> from(2 * stride), to(2 * stride);
    const int step = parts == Parts<float>::Paired ? 2 : 1;
    const fftwf_iodim line{n, step, step};
    fftwf_plan plan = fftwf_plan_guru_split_dft(1, &line, 0, nullptr, from.data() + imaginary, from.data(),
                                                to.data() + imaginary, to.data(),
                                                FFTW_ESTIMATE | FFTW_PRESERVE_INPUT | FFTW_WISDOM_ONLY);
    if (plan) fftwf_destroy_plan(plan);
    return plan != nullptr;
}

// A different build of FFTW may reject the recorded plans. Then this fails, and only speed is lost.
TEST(LineTransform, RecordedPlansAreThoseOfThisFftw) {
    EXPECT_EQ(fftwf_import_wisdom_from_string(kSingleLineWisdom), 1);
    EXPECT_EQ(fftwf_import_wisdom_from_string(kPairedLineWisdom), 1);
    { const PlannedBy recorded(Planning::Recorded); }
    for (int n = 256; n <= 16384; n *= 2) EXPECT_TRUE(is_recorded(n, Parts<float>::Apart)) << n;
    for (const int n : {320, 400, 480, 560, 640}) EXPECT_TRUE(is_recorded(n, Parts<float>::Paired)) << n;
    EXPECT_FALSE(is_recorded(240, Parts<float>::Paired));
}

// So that a comparison changes nobody's bits.
TEST(LineTransform, PlansThatAreFoundOtherwiseAreForgotten) {
    const auto known = [] {
        char* text = fftwf_export_wisdom_to_string();
        const std::string wisdom(text);
        fftwf_free(text);
        return wisdom;
    };
    { const PlannedBy recorded(Planning::Recorded); }
    const std::string recorded = known();
    for (const Planning planning : {Planning::Estimate, Planning::Measure}) {
        const PlannedBy planned(planning);
        expect_the_sum<float>(540);
        EXPECT_NE(known(), recorded);
    }
    EXPECT_EQ(known(), recorded);
}

TEST(GridLayout, KeepsRowsApartAndAligned) {
    for (int n = 1; n < 5000; ++n) {
        EXPECT_GE(line_stride<float>(n), n + kRowSkirt);
        EXPECT_EQ(line_stride<float>(n) * sizeof(float) % 64, 0u);
        EXPECT_NE(line_stride<float>(n) * sizeof(float) % 2048, 0u);
        EXPECT_NE(line_stride<double>(n) * sizeof(double) % 2048, 0u);
        EXPECT_EQ(grid_samples<float>(n) % (2 * line_stride<float>(n)), 0u);
    }
}

}  // namespace
}  // namespace pelagic
