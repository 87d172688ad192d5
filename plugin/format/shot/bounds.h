// Bounds of a shot file that are checked before it is parsed: parsers of TOML, and all code that walks through what
// they made, recurse as deep as the file nests.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace pelagic {

inline constexpr int kMostKeyParts = 16;                // of a dotted key or a table's header; ours have 2
inline constexpr int kMostNesting = 16;                 // of lists and inline tables; ours nest 3 deep
inline constexpr std::size_t kMostWordBytes = 256;      // of a key's part or a number without quotes
inline constexpr std::size_t kMostStringBytes = 65536;  // between quotes: a vessel's path of 1000 keys

// Where a text goes beyond a bound. Lines count from 1, columns from 1 in characters.
struct BeyondBound {
    std::size_t line = 0, column = 0;
    std::string problem, accepted;
};

// The first such place; nothing if there is none. Text that is no TOML has no bounds after its first error, which
// is where parsers stop.
std::optional<BeyondBound> beyond_bounds(std::string_view toml);

}  // namespace pelagic
