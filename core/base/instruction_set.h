// The vector instruction set that the vectorised loops use on this CPU.
#pragma once

#include <string>

namespace pelagic {

// Highway's name in lower case: "ssse3", "sse4", "avx2", "avx3" (AVX-512), "avx3_dl", "neon", …; "sse4+avx"
// where FFTW uses AVX and our loops SSE4. Machines with equal names produce equal bits; others agree to 1e-5
// of the significant height.
std::string instruction_set();

}  // namespace pelagic
