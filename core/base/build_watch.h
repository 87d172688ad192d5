// How long work is watched, and ended from elsewhere: building a sea, drawing a picture, reading files.
#pragma once

#include <atomic>
#include <exception>
#include <functional>

namespace pelagic {

// Both are looked at after each part of the work.
struct BuildWatch {
    // 0 … 1, rising, one call at a time, from whichever thread; may be empty.
    std::function<void(double done)> progress{};
    const std::atomic<bool>* cancel = nullptr;  // set from elsewhere
};

// Work that was cancelled.
class BuildCancelled : public std::exception {
  public:
    const char* what() const noexcept override { return "building the sea was cancelled"; }
};

// Throws BuildCancelled.
inline void stop_if(const std::atomic<bool>* cancelled) {
    if (cancelled && cancelled->load(std::memory_order_relaxed)) throw BuildCancelled();
}

}  // namespace pelagic
