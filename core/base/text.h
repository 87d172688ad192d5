// What users' texts (paths, values) become in messages and files: nothing in them is a command for whoever reads.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace pelagic {

// The text between quotes, with quotes, backslashes and control characters escaped as TOML and JSON do: one
// line of UTF-8, whatever is in it. A byte that isn't part of UTF-8 (a file name's: Unix allows any) has no
// escape in either; it stands there as in utf8_text(), the backslash escaped like any other.
std::string quoted_text(std::string_view text);

// The text with "\xe9" in place of a byte that isn't part of UTF-8; any other is as it was.
std::string utf8_text(std::string_view text);

// A file's name or another text of the user's as a message shows it: one line of UTF-8 that moves no cursor and
// turns no writing direction; what would is shown as its escape.
std::string line_text(std::string_view text);

// Whether a file's name ends so, whatever the case of its letters: ".exr", in lower case.
bool has_ending(std::string_view name, std::string_view ending);

// The text's first UTF-8 character, or its first byte where that isn't UTF-8.
std::string_view first_character(std::string_view text);

// The text, or its beginning and "…" where it has more bytes than that; cut between characters.
inline constexpr std::size_t kShort = 80;
std::string shortened(std::string_view text, std::size_t most_bytes = kShort);

}  // namespace pelagic
