// --size. See size.h.
#include "plugin/host/cli/size.h"

#include <charconv>
#include <optional>

#include "core/scene/limits.h"

namespace pelagic::cli {
namespace {

std::optional<glm::ivec2> parse_size(const std::string& text) {
    glm::ivec2 size(0);
    const char* const end = text.data() + text.size();
    const auto [x, x_error] = std::from_chars(text.data(), end, size.x);
    if (x_error != std::errc() || x == end || *x != 'x') return std::nullopt;
    const auto [y, y_error] = std::from_chars(x + 1, end, size.y);
    if (y_error != std::errc() || y != end) return std::nullopt;
    if (!limits::kImageResolution.holds(size.x) || !limits::kImageResolution.holds(size.y))
        return std::nullopt;
    return size;
}

// What is wrong with a size; empty if nothing is.
std::string refuse_size(const std::string& text) {
    if (parse_size(text)) return {};
    return text + " is no size; accepted: width and height in pixels, like 1280x720, each " +
           text_of(limits::kImageResolution);
}

}  // namespace

CLI::Option* add_size(CLI::App& command, std::string& size, const char* help) {
    return command.add_option("--size", size, help)->type_name("WxH")->check(CLI::Validator(refuse_size, ""));
}

glm::ivec2 size_of(const std::string& size) {
    return parse_size(size).value_or(glm::ivec2(0));
}

}  // namespace pelagic::cli
