// How values are written in messages and in the canonical text. See text.h.
#include "core/scene/text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace pelagic {

std::string number_text(double value) {
    // std::to_chars may print the sign and payload of a NaN; nobody wants to read them.
    if (std::isnan(value)) return "nan";
    // Within these bounds people write numbers without an exponent, and 17 digits still fit on a line.
    constexpr double kLeastFixed = 1e-4;
    constexpr double kMostFixed = 1e7;
    const double magnitude = std::abs(value);
    const bool is_fixed = value == 0.0 || (magnitude >= kLeastFixed && magnitude < kMostFixed);
    std::array<char, 32> buffer{};  // the longest shortest double has 24 characters
    const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value,
                                      is_fixed ? std::chars_format::fixed : std::chars_format::scientific);
    std::string text(buffer.data(), result.ptr);
    // "1e+08" is 1e8: no plus, no leading zero.
    if (const std::size_t e = text.find('e'); e != std::string::npos) {
        const std::size_t first = text[e + 1] == '-' ? e + 2 : e + 1;
        text.erase(first, text.find_first_of("123456789", first) - first);
    }
    return text;
}

std::string rough_text(double value) {
    std::array<char, 32> buffer{};
    const auto written =
        std::to_chars(buffer.data(), buffer.data() + buffer.size(), value, std::chars_format::scientific, 1);
    double rounded = value;
    std::from_chars(buffer.data(), written.ptr, rounded);
    return number_text(rounded);
}

}  // namespace pelagic
