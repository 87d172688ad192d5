// How values are written in messages and in the canonical text: one spelling each, independent of the locale.
#pragma once

#include <string>
#include <string_view>

namespace pelagic {

// The shortest text that reads back as the same double: "24", "0.1", "1e8", "inf", "nan".
std::string number_text(double value);

// The text between quotes, with quotes, backslashes and control characters escaped as TOML and JSON do: one
// line, whatever is in it.
std::string quoted_text(std::string_view text);

}  // namespace pelagic
