// Checksums that tell a damaged file from a whole one: XXH3 with 64 bits, as 16 hexadecimal digits. They guard
// against accidents, not against people.
#pragma once

#include <memory>
#include <string>
#include <string_view>

struct XXH3_state_s;

namespace pelagic::files {

class Checksum {
  public:
    Checksum();
    void add(std::string_view bytes);
    std::string text() const;  // of all bytes so far; more may follow

  private:
    struct Free {
        void operator()(XXH3_state_s* state) const;
    };
    std::unique_ptr<XXH3_state_s, Free> state_;
};

std::string checksum_of(std::string_view bytes);

}  // namespace pelagic::files
