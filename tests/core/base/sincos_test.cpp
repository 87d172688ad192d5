// Sine and cosine for vectors against the C library in double, on every instruction set of this CPU.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/core/base/sincos_test.cpp"
#include <hwy/foreach_target.h>
// foreach_target comes first: it includes this file once per instruction set.
#include "core/base/sincos-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pelagic {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <class T>
void SinCosOf(const T* cycles, int count, T* sine, T* cosine) {
    const hn::CappedTag<T, 4> d;
    for (int i = 0; i < count; i += static_cast<int>(hn::Lanes(d))) {
        hn::Vec<decltype(d)> s, c;
        SinCosCycles(d, hn::LoadU(d, cycles + i), s, c);
        hn::StoreU(s, d, sine + i);
        hn::StoreU(c, d, cosine + i);
    }
}
void SinCosFloat(const float* x, int n, float* s, float* c) {
    SinCosOf(x, n, s, c);
}
void SinCosDouble(const double* x, int n, double* s, double* c) {
    SinCosOf(x, n, s, c);
}

}  // namespace HWY_NAMESPACE
}  // namespace pelagic
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/base/instruction_set.h"
#include "core/base/random.h"

namespace pelagic {
HWY_EXPORT(SinCosFloat);
HWY_EXPORT(SinCosDouble);

namespace {

template <class T>
std::vector<T> phases() {
    std::vector<T> cycles;
    for (int i = -64; i <= 64; ++i) cycles.push_back(T(i) / T(16));  // every border between octants
    for (std::uint32_t i = 0; cycles.size() < 100000; ++i) {
        const auto z = normal_pair({i, 0, 0, 0}, 7);
        cycles.push_back(static_cast<T>(z[0]));         // within a few cycles
        cycles.push_back(static_cast<T>(1000 * z[1]));  // far from 0
    }
    while (cycles.size() % 4 != 0) cycles.push_back(T(0));
    return cycles;
}

template <class T, class Work>
void expect_close(Work work, double tolerance) {
    const std::vector<T> cycles = phases<T>();
    std::vector<T> sine(cycles.size()), cosine(cycles.size());
    work(cycles.data(), static_cast<int>(cycles.size()), sine.data(), cosine.data());
    double worst = 0.0;
    for (std::size_t i = 0; i < cycles.size(); ++i) {
        const double whole = static_cast<double>(cycles[i]);
        const double angle = kTwoPi * (whole - std::round(whole));
        worst = std::max(worst, std::abs(static_cast<double>(sine[i]) - std::sin(angle)));
        worst = std::max(worst, std::abs(static_cast<double>(cosine[i]) - std::cos(angle)));
    }
    EXPECT_LT(worst, tolerance);
}

// Rounding of the angle, the polynomial and the last product: two units in the last place of 1.
TEST(SinCos, MatchesTheCLibraryOnEveryInstructionSet) {
    const std::string best = instruction_set();
    for (const std::string& set : instruction_sets()) {
        use_instruction_set(set);
        SCOPED_TRACE(set);
        expect_close<float>(HWY_DYNAMIC_DISPATCH(SinCosFloat), 2 * 1.2e-7);
        expect_close<double>(HWY_DYNAMIC_DISPATCH(SinCosDouble), 2 * 2.3e-16);
    }
    use_instruction_set(best);
}

}  // namespace
}  // namespace pelagic
#endif
