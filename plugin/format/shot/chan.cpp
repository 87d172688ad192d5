#include "plugin/format/shot/chan.h"

#include <array>
#include <charconv>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "core/base/constants.h"
#include "core/scene/limits.h"
#include "core/scene/text.h"

namespace pelagic {
namespace {

constexpr const char* kLine = "lines of frame x y z rx ry rz, and the vertical angle of view if there is one";
constexpr double kAhead_m = 100.0;
constexpr std::string_view kBlanks = " \t\r";

struct Line {
    std::size_t number;
    std::array<double, 8> values{};
    std::size_t count = 0;
};

[[noreturn]] void refuse(const Line& line, const std::string& problem, std::string accepted = kLine) {
    throw ChanError("line " + std::to_string(line.number) + ": " + problem, std::move(accepted));
}

Line numbers_of(std::string_view text, std::size_t number) {
    Line line{.number = number};
    while (true) {
        const std::size_t begin = text.find_first_not_of(kBlanks);
        if (begin == std::string_view::npos || (line.count == 0 && text[begin] == '#')) return line;
        text.remove_prefix(begin);
        const std::string_view word = text.substr(0, text.find_first_of(kBlanks));
        text.remove_prefix(word.size());
        double value = 0.0;
        const char* const first = word.data() + (word.starts_with('+') ? 1 : 0);
        const auto [end, error] = std::from_chars(first, word.data() + word.size(), value);
        if (error != std::errc{} || end != word.data() + word.size() || !std::isfinite(value))
            refuse(line, quoted_text(word.substr(0, 40)) + " is no number");
        if (line.count == line.values.size()) refuse(line, "has more than 8 numbers");
        line.values[line.count++] = value;
    }
}

// The file's world stands on its y.
glm::dvec3 with_z_up(glm::dvec3 v) {
    return {v.x, -v.z, v.y};
}

glm::dvec3 turned(glm::dvec3 v, glm::dvec3 degrees) {
    const auto turn = [](double& a, double& b, double deg) {
        const double c = std::cos(deg * (kPi / 180.0)), s = std::sin(deg * (kPi / 180.0));
        const double was = a;
        a = c * was - s * b;
        b = s * was + c * b;
    };
    turn(v.x, v.y, degrees.z);
    turn(v.y, v.z, degrees.x);
    turn(v.z, v.x, degrees.y);
    return v;
}

// As CameraKey has it: how far the picture's up is turned from the one without a roll.
double roll_deg(glm::dvec3 forward, glm::dvec3 up) {
    constexpr double kVertical = 1e-9;  // as view_at()
    const bool vertical = std::hypot(forward.x, forward.y) < kVertical;
    const glm::dvec3 right =
        glm::normalize(glm::cross(forward, vertical ? glm::dvec3(0.0, 1.0, 0.0) : glm::dvec3(0.0, 0.0, 1.0)));
    return std::atan2(glm::dot(up, right), glm::dot(up, glm::cross(right, forward))) * (180.0 / kPi);
}

CameraKey key_of(const Line& line, const CameraKey* before, glm::ivec2 resolution) {
    const auto& v = line.values;
    if (line.count < 7) refuse(line, "has " + std::to_string(line.count) + " numbers");
    CameraKey key;
    if (v[0] != std::floor(v[0]) || !limits::kFrame.holds(v[0]))
        refuse(line, "the frame " + number_text(v[0]) + " is none",
               "a whole number, " + text_of(limits::kFrame));
    key.frame = static_cast<int>(v[0]);
    if (before && key.frame <= before->frame)
        refuse(
            line,
            "the frame " + std::to_string(key.frame) + " doesn't come after " + std::to_string(before->frame),
            "rising frames, each once");
    key.position_m = with_z_up({v[1], v[2], v[3]});
    const glm::dvec3 degrees(v[4], v[5], v[6]);
    for (int axis = 0; axis < 3; ++axis) {
        if (!limits::kCameraCoordinate_m.holds(key.position_m[axis]))
            refuse(line, "the position is outside the range", text_of(limits::kCameraCoordinate_m) + " m");
        if (!limits::kAngle_deg.holds(degrees[axis]))
            refuse(line, "an angle is outside the range", text_of(limits::kAngle_deg) + " degrees");
    }
    const glm::dvec3 forward = with_z_up(turned({0.0, 0.0, -1.0}, degrees)),
                     up = with_z_up(turned({0.0, 1.0, 0.0}, degrees));
    key.look_at_m = key.position_m + kAhead_m * forward;
    key.roll_deg = roll_deg(forward, up);
    // The short way from key to key.
    if (before) key.roll_deg += 360.0 * std::round((before->roll_deg - key.roll_deg) / 360.0);
    if (line.count < 8) return key;
    const double high = std::tan(v[7] * (kPi / 360.0));
    key.fov_deg = std::atan(high * resolution.x / resolution.y) * (360.0 / kPi);
    if (!(v[7] > 0.0 && v[7] < 180.0) || !limits::kFov_deg.holds(*key.fov_deg))
        refuse(line, "the angle of view of " + number_text(v[7]) + " degrees is outside the range",
               "one that is " + text_of(limits::kFov_deg) + " degrees across the picture");
    return key;
}

}  // namespace

std::vector<CameraKey> parse_chan(std::string_view text, glm::ivec2 resolution) {
    std::vector<CameraKey> keys;
    for (std::size_t number = 1; !text.empty(); ++number) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        const Line line = numbers_of(text.substr(0, end), number);
        text.remove_prefix(std::min(end + 1, text.size()));
        if (line.count > 0) keys.push_back(key_of(line, keys.empty() ? nullptr : &keys.back(), resolution));
    }
    if (keys.empty()) throw ChanError("has no frames", kLine);
    return keys;
}

}  // namespace pelagic
