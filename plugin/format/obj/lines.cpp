#include "plugin/format/obj/lines.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "core/scene/text.h"

namespace pelagic::obj {
namespace {

constexpr const char* kCorners = "corners as 7, 7/2, 7//3 or 7/2/3, from 1 on or from -1 backwards";

// Splits at spaces and tabs, up to a comment.
void split(std::string_view line, Words& words) {
    constexpr std::string_view kBlank = " \t\r\v\f";
    for (std::size_t at = line.find_first_not_of(kBlank); at != std::string_view::npos && line[at] != '#';
         at = line.find_first_not_of(kBlank, at)) {
        const std::size_t end = std::min(line.find_first_of(kBlank, at), line.size());
        words.push_back(line.substr(at, end - at));
        at = end;
    }
}

}  // namespace

bool Lines::next(Words& words) {
    words.clear();
    if (at_ >= text_.size()) return false;
    line_ = ++lines_read_;
    for (;;) {
        const std::size_t end = std::min(text_.find('\n', at_), text_.size());
        std::string_view line = text_.substr(at_, end - at_);
        at_ = end + 1;
        if (line.ends_with('\r')) line.remove_suffix(1);
        const bool goes_on = line.ends_with('\\') && at_ < text_.size();
        if (line.ends_with('\\')) line.remove_suffix(1);
        split(line, words);
        if (!goes_on) return true;
        ++lines_read_;
    }
}

std::string quoted(std::string_view word) {
    return quoted_text(shortened(word));
}

double number_of(std::string_view word) {
    const bool has_plus = word.size() > 1 && word[0] == '+' && word[1] != '-';
    const char* const end = word.data() + word.size();
    double value = 0.0;
    const auto [stop, problem] = std::from_chars(word.data() + (has_plus ? 1 : 0), end, value);
    if (problem == std::errc::invalid_argument || stop != end)
        throw Refused{quoted(word) + " is no number", "numbers"};
    if (const std::size_t e = word.find_first_of("eE");
        problem == std::errc::result_out_of_range && e + 1 < word.size() && word[e + 1] == '-')
        return 0.0;  // smaller than any double but 0
    if (problem != std::errc() || !std::isfinite(value))
        throw Refused{quoted(word) + " is not a finite number", "finite numbers"};
    return value;
}

std::int64_t integer_of(std::string_view word, const char* accepted) {
    std::int64_t value = 0;
    const char* const end = word.data() + word.size();
    const auto [stop, problem] = std::from_chars(word.data(), end, value);
    if (problem != std::errc() || stop != end) throw Refused{quoted(word) + " is no whole number", accepted};
    return value;
}

glm::dvec3 point_of(const Words& words) {
    if (words.size() != 4 && words.size() != 5 && words.size() != 7)
        throw Refused{"a point has " + std::to_string(words.size() - 1) + " numbers",
                      "three, in metres; a weight of 1 or a colour may follow"};
    std::array<double, 6> numbers{};
    for (std::size_t i = 1; i < words.size(); ++i) numbers[i - 1] = number_of(words[i]);
    if (words.size() == 5 && numbers[3] != 1.0)
        throw Refused{"a point has the weight " + number_text(numbers[3]), "1, or no weight"};
    return {numbers[0], numbers[1], numbers[2]};
}

std::array<std::string_view, 3> corner_parts(std::string_view word) {
    std::array<std::string_view, 3> parts;
    std::size_t count = 0;
    for (std::size_t at = 0;; ++count) {
        const std::size_t end = std::min(word.find('/', at), word.size());
        if (count == parts.size()) throw Refused{quoted(word) + " is no corner", kCorners};
        parts[count] = word.substr(at, end - at);
        if (end == word.size()) break;
        at = end + 1;
    }
    if (parts[count].empty()) throw Refused{quoted(word) + " is no corner", kCorners};
    return parts;
}

std::int32_t index_of(std::string_view word, std::size_t count, const char* what) {
    std::int64_t index = integer_of(word, kCorners);
    const auto signed_count = static_cast<std::int64_t>(count);
    if (index < 0) index += signed_count + 1;
    if (index < 1 || index > signed_count)
        throw Refused{"the " + std::string(what) + ' ' + std::string(word) + " is outside the range",
                      count == 0 ? std::string("faces after the ") + what + "s that they name"
                                 : "1 … " + std::to_string(count) + " or -1 … -" + std::to_string(count) +
                                       ": so many stand above"};
    return static_cast<std::int32_t>(index - 1);
}

}  // namespace pelagic::obj
