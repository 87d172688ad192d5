#include "core/base/instruction_set.h"

#include <hwy/highway.h>

#include <algorithm>
#include <cctype>

namespace pelagic {

std::string instruction_set() {
    // The best of those that the program holds: the lowest bit.
    const std::int64_t targets = hwy::SupportedTargets() & HWY_TARGETS;
    std::string name = hwy::TargetName(targets & -targets);
    std::transform(name.begin(), name.end(), name.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return name;
}

}  // namespace pelagic
