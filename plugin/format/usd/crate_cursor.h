// Bytes of a crate, read with care.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <vector>

#include "plugin/format/usd/read_mesh.h"

namespace pelagic::usd {

[[noreturn]] inline void refuse_cut() {
    throw ReadError("is cut short or damaged");
}

// Reads from a range of bytes, one value after another.
class CrateCursor {
  public:
    explicit CrateCursor(std::string_view bytes, std::uint64_t begin = 0) : bytes_(bytes) {
        if (begin > bytes_.size()) refuse_cut();
        bytes_.remove_prefix(begin);
    }

    std::string_view take(std::uint64_t count) {
        if (count > bytes_.size()) refuse_cut();
        const std::string_view taken = bytes_.substr(0, count);
        bytes_.remove_prefix(count);
        return taken;
    }
    template <class T>
    T number() {
        T value;
        std::memcpy(&value, take(sizeof value).data(), sizeof value);
        return value;
    }
    template <class T>
    std::vector<T> numbers(std::uint64_t count) {
        if (count > bytes_.size() / sizeof(T)) refuse_cut();
        std::vector<T> values(count);
        const std::string_view taken = take(count * sizeof(T));
        if (!values.empty()) std::memcpy(values.data(), taken.data(), taken.size());
        return values;
    }
    std::size_t left() const { return bytes_.size(); }

  private:
    std::string_view bytes_;
};

}  // namespace pelagic::usd
