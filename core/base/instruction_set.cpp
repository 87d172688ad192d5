#include "core/base/instruction_set.h"

#include <hwy/highway.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <stdexcept>
#include <utility>

namespace pelagic {
namespace {

// Highway's bits, the widest set's the lowest. The one that the program is compiled for is there in any case: Debian's Highway
// finds SSE4 only where the CPU has AES as well, and dispatch then ends there.
std::int64_t in_use() {
    return (hwy::SupportedTargets() & HWY_TARGETS) | HWY_STATIC_TARGET;
}
// Of this CPU, before anything was narrowed.
const std::int64_t kAll = in_use();

std::int64_t widest(std::int64_t targets) {
    return targets & -targets;
}

std::string name_of(std::int64_t target) {
    std::string name = hwy::TargetName(target);
    std::transform(name.begin(), name.end(), name.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return name.starts_with("avx3") ? "avx512" : name;  // with whatever else: our sums are the same
}

}  // namespace

std::string instruction_set() {
    return name_of(widest(in_use()));
}

std::vector<std::string> instruction_sets() {
    std::vector<std::string> names;
    for (std::int64_t left = kAll; left != 0; left &= left - 1)
        if (std::string name = name_of(widest(left)); names.empty() || names.back() != name)
            names.push_back(std::move(name));
    std::reverse(names.begin(), names.end());
    return names;
}

void use_instruction_set(const std::string& name) {
    for (std::int64_t left = kAll; left != 0; left &= left - 1)
        if (name_of(widest(left)) == name) {
            // (hwy::DisableTargets() doesn't do: asking which there are brings all back.)
            hwy::SetSupportedTargetsForTest(left);
            hwy::GetChosenTarget().DeInit();
            return;
        }
    std::string known;
    for (const std::string& set : instruction_sets()) known += (known.empty() ? "" : ", ") + set;
    throw std::invalid_argument("instruction set \"" + name + "\": this CPU has " + known);
}

bool is_below_avx2() {
#if HWY_ARCH_X86
    return widest(in_use()) > HWY_AVX2;
#else
    return false;
#endif
}

}  // namespace pelagic
