// Cryptomatte 1.2 (Friedman and Jones 2015; the specification of psyop/Cryptomatte on GitHub): which share of each pixel each object has.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace pelagic {

// MurmurHash3_x86_32 with seed 0 (Appleby, public domain) of the text's bytes.
std::uint32_t murmur_hash(std::string_view text);

// A name's identifier: its hash as the bits of a float that is neither infinite, nor NaN, nor subnormal: of such ones the exponent's lowest
// bit is flipped.
float matte_id(std::string_view name);

inline constexpr std::string_view kSeaMatteName = "sea";
inline const float kSeaMatte = matte_id(kSeaMatteName);

inline constexpr std::string_view kMatteLayer = "CryptoObject";
inline constexpr std::size_t kMatteRanks = 6,
                             kMatteFloats = 2 * kMatteRanks;  // identifier, share; no share: none
// Adds to what a pixel has of it; false where six others have the ranks.
bool add_to_ranks(std::span<float, kMatteFloats> ranks, float id, float share);
// Of a full pixel and one more the last by sort_ranks() is lost.
void keep_in_ranks(std::span<float, kMatteFloats> ranks, float id, float share);
// The largest share first, of equal ones the lower identifier.
void sort_ranks(std::span<float, kMatteFloats> ranks);

// Name and value of the header's attributes for objects of these names, and the sea.
std::vector<std::pair<std::string, std::string>> matte_attributes(std::span<const std::string> names);

}  // namespace pelagic
