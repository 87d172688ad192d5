// A host that was compiled with version 0.1.0's header.
#pragma once

#include <cstddef>
#include <vector>

namespace pelagic::test {

// A sea's numbers as that host gets them, of a shot's text at a time.
struct FirstVersion {
    std::vector<float> coverage;  // at points
    std::vector<float> of_hits,
        rest_m;  // of rays straight down over them, and x, y of where they meet the sea
    double frame_bytes = 0.0;
};
FirstVersion ask_as_first_version(const char* text, double time_s, const std::vector<float>& rest_m,
                                  float footprint_m);

}  // namespace pelagic::test
