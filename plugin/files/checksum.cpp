#include "plugin/files/checksum.h"

#include <xxhash.h>

#include <array>
#include <cstdio>
#include <new>

namespace pelagic::files {

void Checksum::Free::operator()(XXH3_state_s* state) const {
    XXH3_freeState(state);
}

Checksum::Checksum() : state_(XXH3_createState()) {
    if (!state_) throw std::bad_alloc();
    XXH3_64bits_reset(state_.get());
}

void Checksum::add(std::string_view bytes) {
    XXH3_64bits_update(state_.get(), bytes.data(), bytes.size());
}

std::string Checksum::text() const {
    std::array<char, 17> digits{};
    std::snprintf(digits.data(), digits.size(), "%016llx",
                  static_cast<unsigned long long>(XXH3_64bits_digest(state_.get())));
    return digits.data();
}

std::string checksum_of(std::string_view bytes) {
    Checksum sum;
    sum.add(bytes);
    return sum.text();
}

}  // namespace pelagic::files
