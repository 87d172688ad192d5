// A value that is refused, and a range that values must lie in, as the parts of a message.
#pragma once

#include <string>

namespace pelagic {

// One refused value, as the parts of one sentence.
struct Problem {
    std::string key;       // the shot file's path of it: "waves.cascades[1].resolution", counting from 0
    std::string value;     // as the shot file would write it
    std::string problem;   // what is wrong: "is outside the range"
    std::string accepted;  // what would be right: "0 … 80"
};

// "sea.wind_speed_mps = -3: is outside the range; accepted: 0 … 80". Keys and values that would fill a page are
// shortened.
std::string text_of(const Problem& problem);

}  // namespace pelagic
