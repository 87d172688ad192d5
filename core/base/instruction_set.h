// The vector instruction set that the vectorised loops use, and FFTW's with them.
#pragma once

#include <string>
#include <vector>

namespace pelagic {

// "sse4", "avx2", "avx512"; others by Highway's name in lower case. Machines with equal names produce equal bits; others agree to
// 1e-5 of the significant height.
std::string instruction_set();

// Those that this program contains and this CPU has, the narrowest first.
std::vector<std::string> instruction_sets();

// No wider one than this is used from now on: what a CPU that has no more computes, to the bit, where the C library's mathematics are
// those of such a CPU too (it chooses them when a process starts; from "avx2" on they are the same). Before the process computes
// anything: a sea keeps the transforms that were planned for it. Throws std::invalid_argument, naming the sets that there are.
void use_instruction_set(const std::string& name);

// Whether the set in use is narrower than AVX2. FFTW has one more (AVX) that ours leave out and that no call of it does: its transforms
// are scalar then, which all CPUs compute alike.
bool is_below_avx2();

}  // namespace pelagic
