#include "plugin/render/cryptomatte.h"

#include <algorithm>
#include <bit>
#include <cstdio>
#include <cstring>
#include <map>

namespace pelagic {
namespace {

std::string hexadecimal(std::uint32_t value) {
    std::array<char, 9> digits{};
    std::snprintf(digits.data(), digits.size(), "%08x", value);
    return digits.data();
}

// As JSON has a text.
std::string quoted(std::string_view text) {
    std::string quoted = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') {
            quoted += '\\';
            quoted += c;
        } else if (static_cast<unsigned char>(c) < 0x20) {
            quoted += "\\u" + hexadecimal(static_cast<unsigned char>(c)).substr(4);
        } else {
            quoted += c;
        }
    }
    return quoted + '"';
}

struct Rank {
    float id, share;
    bool is_before(const Rank& other) const {
        return share != other.share ? share > other.share : id < other.id;
    }
};

}  // namespace

std::uint32_t murmur_hash(std::string_view text) {
    constexpr std::uint32_t kFirst = 0xcc9e2d51u, kSecond = 0x1b873593u;
    const auto mixed = [](std::uint32_t block) { return std::rotl(block * kFirst, 15) * kSecond; };
    std::uint32_t hash = 0;
    std::size_t at = 0;
    const auto byte = [&](std::size_t i) { return std::uint32_t{static_cast<unsigned char>(text[i])}; };
    for (; at + 4 <= text.size(); at += 4) {
        const std::uint32_t block = byte(at) | byte(at + 1) << 8 | byte(at + 2) << 16 | byte(at + 3) << 24;
        hash = std::rotl(hash ^ mixed(block), 13) * 5 + 0xe6546b64u;
    }
    std::uint32_t tail = 0;
    for (std::size_t i = text.size(); i > at; --i) tail = tail << 8 | byte(i - 1);
    if (at < text.size()) hash ^= mixed(tail);
    hash ^= static_cast<std::uint32_t>(text.size());
    hash = (hash ^ hash >> 16) * 0x85ebca6bu;
    hash = (hash ^ hash >> 13) * 0xc2b2ae35u;
    return hash ^ hash >> 16;
}

float matte_id(std::string_view name) {
    std::uint32_t bits = murmur_hash(name);
    const std::uint32_t exponent = bits >> 23 & 0xff;
    if (exponent == 0 || exponent == 0xff) bits ^= 1u << 23;
    return std::bit_cast<float>(bits);
}

bool add_to_ranks(std::span<float, kMatteFloats> ranks, float id, float share) {
    for (std::size_t i = 0; i < kMatteFloats; i += 2) {
        if (ranks[i + 1] == 0.0f || ranks[i] == id) {
            ranks[i] = id;
            ranks[i + 1] += share;
            return true;
        }
    }
    return false;
}

void keep_in_ranks(std::span<float, kMatteFloats> ranks, float id, float share) {
    std::size_t last = 0;
    for (std::size_t i = 2; i < kMatteFloats; i += 2)
        if (Rank{ranks[last], ranks[last + 1]}.is_before({ranks[i], ranks[i + 1]})) last = i;
    if (!Rank{id, share}.is_before({ranks[last], ranks[last + 1]})) return;
    ranks[last] = id;
    ranks[last + 1] = share;
}

void sort_ranks(std::span<float, kMatteFloats> ranks) {
    std::array<Rank, kMatteRanks> sorted{};
    std::memcpy(sorted.data(), ranks.data(), sizeof(sorted));
    std::sort(sorted.begin(), sorted.end(), [](const Rank& a, const Rank& b) { return a.is_before(b); });
    std::memcpy(ranks.data(), sorted.data(), sizeof(sorted));
}

std::vector<std::pair<std::string, std::string>> matte_attributes(std::span<const std::string> names) {
    std::map<std::string, std::string> of;  // objects of one name are one
    for (const std::string& name : names)
        of[name] = hexadecimal(std::bit_cast<std::uint32_t>(matte_id(name)));
    of[std::string(kSeaMatteName)] = hexadecimal(std::bit_cast<std::uint32_t>(kSeaMatte));
    std::string manifest;
    for (const auto& [name, id] : of)
        manifest += (manifest.empty() ? "{" : ",") + quoted(name) + ":\"" + id + '"';
    const std::string key = "cryptomatte/" + hexadecimal(murmur_hash(kMatteLayer)).substr(0, 7) + '/';
    return {{key + "name", std::string(kMatteLayer)},
            {key + "hash", "MurmurHash3_32"},
            {key + "conversion", "uint32_to_float32"},
            {key + "manifest", manifest + '}'}};
}

}  // namespace pelagic
