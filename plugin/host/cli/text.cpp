// Formats numbers for messages. See text.h.
#include "plugin/host/cli/text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace pelagic::cli {

std::string duration_text(double seconds) {
    constexpr double kLongest_s = 1e9;  // 30 years: the conversion to integers stays defined
    const double whole = std::clamp(std::isnan(seconds) ? 0.0 : seconds, 0.0, kLongest_s);
    std::array<char, 64> text{};
    const long rounded = std::lround(whole);
    if (whole < 9.95) {
        std::snprintf(text.data(), text.size(), "%.1f s", whole);
    } else if (rounded < 60) {
        std::snprintf(text.data(), text.size(), "%ld s", rounded);
    } else if (rounded < 3600) {
        std::snprintf(text.data(), text.size(), "%ld min %02ld s", rounded / 60, rounded % 60);
    } else {
        std::snprintf(text.data(), text.size(), "%ld h %02ld min", rounded / 3600, rounded / 60 % 60);
    }
    return text.data();
}

std::string bytes_text(std::size_t bytes) {
    static constexpr std::array<const char*, 6> kUnits{"bytes", "KiB", "MiB", "GiB", "TiB", "PiB"};
    double value = static_cast<double>(bytes);
    std::size_t unit = 0;
    for (; value >= 1023.5 && unit + 1 < kUnits.size(); ++unit) value /= 1024.0;
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), "%.*f %s", unit > 0 && value < 9.95 ? 1 : 0, value, kUnits[unit]);
    return text.data();
}

std::string count_text(long count, const char* singular, const char* plural) {
    return std::to_string(count) + ' ' + (count == 1 ? singular : plural);
}

std::string listed(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
    return text;
}

}  // namespace pelagic::cli
