// What the fuzz targets share: how they say that a promise is broken, numbers out of bytes, and files without a disk.
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <string>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace pelagic::fuzz {

// Ends the process: the driver and libFuzzer keep the input.
inline void hold(bool is_true, std::string_view promise, std::string_view found = {}) {
    if (is_true) return;
    std::fputs(("broken promise: " + std::string(promise) + '\n' + std::string(found) + '\n').c_str(),
               stderr);
    std::abort();
}

// Numbers out of the input, zeros after its end. Many are of the sort that goes wrong.
class Numbers {
  public:
    Numbers(const std::uint8_t* data, std::size_t size) : at_(data), end_(data + size) {}

    bool is_over() const { return at_ == end_; }
    std::uint8_t byte() { return at_ == end_ ? std::uint8_t{0} : *at_++; }
    // 0 … count − 1
    std::size_t below(std::size_t count) { return byte() % count; }
    bool one_in(std::size_t count) { return below(count) == count - 1; }
    std::string_view rest(std::size_t most) {
        const std::size_t length = std::min(most, static_cast<std::size_t>(end_ - at_));
        const std::string_view text(reinterpret_cast<const char*>(at_), length);
        at_ += length;
        return text;
    }

    double number() {
        constexpr double kNaN = std::numeric_limits<double>::quiet_NaN(),
                         kInfinity = std::numeric_limits<double>::infinity();
        constexpr std::array kSpecial{
            0.0,   -0.0, 1.0,   -1.0,   0.5,       2.0,        1e-3,       1e3,    1e6,          -1e6,  1e9,
            1.1e9, 1e12, -1e12, 1.1e12, 1e30,      1e300,      -1e300,     1e-300, 5e-324,       1e-38, 3e38,
            4e38,  kNaN, kNaN,  -kNaN,  kInfinity, -kInfinity, 16777216.0, 1e10,   4294967296.0, 1e-12};
        static_assert(kSpecial.size() == 32);
        const std::uint8_t kind = byte();
        if (kind < 64) return kSpecial[kind % kSpecial.size()];
        if (kind < 80) {
            std::array<std::uint8_t, sizeof(double)> bytes{};
            for (std::uint8_t& each : bytes) each = byte();
            double any = 0.0;
            std::memcpy(&any, bytes.data(), sizeof any);
            return any;
        }
        // Where seas are: to a few hundred metres, seconds or pixels.
        const int low = byte();
        return (low + 256 * (kind - 168)) / 64.0;
    }
    float single() {
        const double wide = number();
        // Beyond floats: what a conversion would make of it is the compiler's.
        if (std::isfinite(wide) && std::abs(wide) > double{std::numeric_limits<float>::max()})
            return std::copysign(std::numeric_limits<float>::max(), wide > 0.0 ? 1.0f : -1.0f);
        return static_cast<float>(wide);
    }

  private:
    const std::uint8_t *at_, *end_;
};

// A file with these bytes, in memory, that readers of paths can open.
class MemoryFile {
  public:
    MemoryFile(const std::uint8_t* data, std::size_t size) : descriptor_(memfd_create("input", MFD_CLOEXEC)) {
        if (descriptor_ < 0 || write(descriptor_, data, size) != static_cast<ssize_t>(size)) {
            std::perror("memfd_create");
            std::exit(2);
        }
    }
    explicit MemoryFile(std::string_view text)
        : MemoryFile(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()) {}
    ~MemoryFile() { close(descriptor_); }
    MemoryFile(const MemoryFile&) = delete;
    MemoryFile& operator=(const MemoryFile&) = delete;

    std::string path() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

  private:
    int descriptor_;
};

}  // namespace pelagic::fuzz
