// A hash of bytes, the same on every machine.
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>

namespace pelagic {

// Fowler, Noll, Vo: FNV-1a with 64 bits.
class ByteHash {
  public:
    void add(unsigned char byte) { hash_ = (hash_ ^ byte) * 0x100000001b3u; }
    // 16 hexadecimal digits.
    std::string text() const {
        char digits[17];
        std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(hash_));
        return digits;
    }

  private:
    std::uint64_t hash_ = 0xcbf29ce484222325u;
};

}  // namespace pelagic
