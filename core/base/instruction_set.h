// Which of the CPU's vector instructions our loops run on.
#pragma once

#include <string>

namespace pelagic {

// In small letters, as Highway names them: "ssse3", "sse4", "avx2", "avx3" (AVX-512), "avx3_dl", "neon", …;
// "sse4+avx" where FFTW finds more than ours do. Results are the same to the bit on machines that answer
// alike, and to 1e-5 of the significant height on others.
std::string instruction_set();

}  // namespace pelagic
