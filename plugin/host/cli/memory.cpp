// --max-memory. See memory.h.
#include "plugin/host/cli/memory.h"

#include <charconv>
#include <cmath>
#include <iostream>
#include <optional>
#include <string_view>

#include "core/base/text.h"
#include "plugin/host/cli/exit_status.h"

namespace pelagic::cli {
namespace {

std::optional<std::size_t> parse_memory(const std::string& text) {
    constexpr std::string_view kUnits = "KMGT";
    constexpr double kMost = 1e18;
    double size = 0.0;
    const char* const end = text.data() + text.size();
    const auto [after, error] = std::from_chars(text.data(), end, size, std::chars_format::fixed);
    if (error != std::errc() || after == end) return std::nullopt;
    const std::size_t unit = kUnits.find(*after);
    const std::string_view rest(after + 1, end);
    if (unit == std::string_view::npos || !(rest.empty() || rest == "B" || rest == "iB")) return std::nullopt;
    size *= std::pow(1024.0, static_cast<double>(unit) + 1.0);
    if (!(size >= 1.0 && size <= kMost)) return std::nullopt;
    return static_cast<std::size_t>(size);
}

// What is wrong with a size; empty if nothing is.
std::string refuse_text(const std::string& text) {
    if (parse_memory(text)) return {};
    return text + " is no size of memory; accepted: a number and K, M, G or T, like 8G or 512M";
}

}  // namespace

CLI::Option* add_max_memory(CLI::App& command, std::string& memory, const char* help) {
    return command.add_option("--max-memory", memory, help)
        ->type_name("SIZE")
        ->check(CLI::Validator(refuse_text, ""));
}

std::size_t memory_of(const std::string& memory) {
    return parse_memory(memory).value_or(0);
}

int refuse_memory(const std::string& shot, const NotEnoughMemory& error) {
    std::cerr << line_text(shot) << ": " << error.what() << "; or allow more with --max-memory\n";
    return status_of(error);
}

}  // namespace pelagic::cli
