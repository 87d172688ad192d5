// Which frames: the command line's --frames.

#include <charconv>
#include <optional>
#include <set>
#include <stdexcept>

#include "plugin/run/run.h"

namespace pelagic {

std::vector<int> parse_frames(const std::string& text, const Shot& shot) {
    const std::string range = std::to_string(shot.first_frame) + "-" + std::to_string(shot.last_frame);
    const auto refuse = [&](const std::string& why) {
        throw std::invalid_argument("frames \"" + text + "\": " + why + "; accepted: a frame like " +
                                    std::to_string(shot.first_frame) + ", a range like " + range +
                                    ", every fifth of it like " + range +
                                    "x5, or several of these with commas between, within the "
                                    "shot's " +
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
    std::set<int> frames;
    for (bool is_first = true; is_first || at != end; is_first = false) {
        if (!is_first && *at++ != ',') refuse("\"" + std::string(at - 1, end) + "\" is left over");
        const auto first = number();
        if (!first) refuse(is_first ? "that is not a frame" : "no frame follows the comma");
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
        if (last < *first) refuse("it runs backwards");
        if (*first < shot.first_frame || last > shot.last_frame) refuse("that is outside the shot");
        for (long frame = *first; frame <= last; frame += step)
            frames.insert(frames.end(), static_cast<int>(frame));
    }
    return {frames.begin(), frames.end()};
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
