// Which frames: the command line's --frames.

#include <charconv>
#include <optional>
#include <stdexcept>

#include "plugin/run/run.h"

namespace pelagic {

std::vector<int> parse_frames(const std::string& text, const Shot& shot) {
    const std::string range = std::to_string(shot.first_frame) + "-" + std::to_string(shot.last_frame);
    const auto refuse = [&](const std::string& why) {
        throw std::invalid_argument("frames \"" + text + "\": " + why + "; accepted: a frame like " +
                                    std::to_string(shot.first_frame) + ", a range like " + range +
                                    ", or every fifth of it like " + range + "x5, within the shot's " +
                                    range);
    };
    const char* at = text.data();
    const char* const end = at + text.size();
    const auto number = [&]() -> std::optional<int> {
        int value = 0;
        const auto [after, error] = std::from_chars(at, end, value);
        if (error != std::errc()) return std::nullopt;
        at = after;
        return value;
    };
    const auto first = number();
    if (!first) refuse("that is not a frame");
    int last = *first, step = 1;
    if (at != end && *at == '-') {
        ++at;
        const auto given = number();
        if (!given) refuse("nothing that is a frame follows the -");
        last = *given;
    }
    if (at != end && *at == 'x') {
        ++at;
        const auto given = number();
        if (!given || *given < 1) refuse("the step after the x must be a whole number from 1 up");
        step = *given;
    }
    if (at != end) refuse("\"" + std::string(at, end) + "\" is left over");
    if (last < *first) refuse("it runs backwards");
    if (*first < shot.first_frame || last > shot.last_frame) refuse("that is outside the shot");
    std::vector<int> frames;
    for (long frame = *first; frame <= last; frame += step) frames.push_back(static_cast<int>(frame));
    return frames;
}

std::string frames_text(const std::vector<int>& frames) {
    std::string text;
    for (std::size_t i = 0; i < frames.size();) {
        std::size_t last = i;
        while (last + 1 < frames.size() && frames[last + 1] == frames[last] + 1) ++last;
        if (!text.empty()) text += ", ";
        text += std::to_string(frames[i]);
        if (last > i) text += '-' + std::to_string(frames[last]);
        i = last + 1;
    }
    return text;
}

}  // namespace pelagic
