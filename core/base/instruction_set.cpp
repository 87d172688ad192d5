#include "core/base/instruction_set.h"

#include <hwy/highway.h>

#include <algorithm>
#include <cctype>

namespace pelagic {

std::string instruction_set() {
    // The lowest bit is the best target that the program contains.
    const std::int64_t targets = hwy::SupportedTargets() & (HWY_TARGETS | HWY_STATIC_TARGET);
    std::string name = hwy::TargetName(targets & -targets);
    std::transform(name.begin(), name.end(), name.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
#if defined(__x86_64__)
    // FFTW chooses its own instruction set and has one (AVX) between two of ours.
    if ((targets & -targets) > HWY_AVX2)
        if (__builtin_cpu_supports("avx")) name += "+avx";
#endif
    return name;
}

}  // namespace pelagic
