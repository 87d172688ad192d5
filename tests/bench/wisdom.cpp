// Records what core/waves/wisdom.h holds: FFTW's best plans for lines of a power of two, found by its longest
// search on the machine that runs this. A minute when quiet:   bench_wisdom > core/waves/wisdom.h
#include <fftw3.h>

#include <cstdio>
#include <iostream>
#include <string>

#include "core/base/buffer.h"
#include "core/plan/grid_layout.h"

int main() {
    using namespace pelagic;
    std::string entries, opening;
    for (int n = 256; n <= 16384; n *= 2) {
        const std::size_t stride = line_stride<float>(n);
        Buffer<float> from(2 * stride), to(2 * stride);
        const fftwf_iodim line{n, 1, 1};
        fftwf_forget_wisdom();
        // As LineTransform asks (core/waves/transform.cpp), but for the search.
        fftwf_plan plan =
            fftwf_plan_guru_split_dft(1, &line, 0, nullptr, from.data() + stride, from.data(),
                                      to.data() + stride, to.data(), FFTW_PATIENT | FFTW_PRESERVE_INPUT);
        fftwf_destroy_plan(plan);
        char* text = fftwf_export_wisdom_to_string();
        const std::string wisdom(text);
        fftwf_free(text);
        const std::size_t first = wisdom.find('\n') + 1;
        opening = wisdom.substr(0, first);
        entries += wisdom.substr(first, wisdom.rfind(')') - first);
        std::cerr << n << ' ' << std::flush;
    }
    std::cerr << '\n';
    std::cout
        << R"(// FFTW's recorded plans for lines of a power of two, 256 … 16384, in single precision: up to a fifth
// faster than its estimate, and more than twice from 4096 on. Another build of FFTW refuses them and
// estimates. Written by tests/bench/wisdom.cpp.
#pragma once

namespace pelagic {

inline constexpr char kSingleLineWisdom[] = R"wisdom()"
        << opening << entries << ")\n)wisdom\";\n\n}  // namespace pelagic\n";
}
