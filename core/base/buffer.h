// Memory for vectorised loops: aligned to a cache line, zero-initialised unless asked otherwise, in huge pages
// where it is large. (With small pages a transform along the columns of a large grid would miss the TLB at every
// step.)
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>

namespace pelagic {

template <class T>
class Buffer {
  public:
    // Loops may read and write this many values beyond size(): the floats of the longest vector, whatever T
    // is, because mixed loops read doubles lane by lane beside floats.
    static constexpr std::size_t kSlack = 64 / sizeof(float);

    Buffer() = default;
    explicit Buffer(std::size_t count) : Buffer(count, 0) {}  // throws std::bad_alloc

    // Without clearing, for callers that overwrite the values before anybody reads them; only the slack is zero.
    static Buffer uncleared(std::size_t count) { return Buffer(count, count); }

    T* data() { return data_.get(); }
    const T* data() const { return data_.get(); }
    std::size_t size() const { return size_; }
    bool empty() const { return size_ == 0; }
    T& operator[](std::size_t i) { return data_.get()[i]; }
    const T& operator[](std::size_t i) const { return data_.get()[i]; }

    // Gives the system back the whole pages that lie within these values, which are lost. It may keep them.
    void give_back(std::size_t first, std::size_t count) {
        const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
        const auto begin = reinterpret_cast<std::uintptr_t>(data() + first),
                   end = reinterpret_cast<std::uintptr_t>(data() + first + count);
        const std::uintptr_t from = (begin + page - 1) / page * page, to = end / page * page;
        if (from < to) madvise(reinterpret_cast<void*>(from), to - from, MADV_DONTNEED);
    }

  private:
    struct Free {
        void operator()(T* p) const { std::free(p); }
    };

    // Clears the values from index `cleared_from` on, and the slack.
    Buffer(std::size_t count, std::size_t cleared_from) : size_(count) {
        constexpr std::size_t kLine = 64, kHugePage = std::size_t(2) << 20;
        const std::size_t bytes = (count + kSlack) * sizeof(T);
        const std::size_t alignment = bytes >= 2 * kHugePage ? kHugePage : kLine;
        void* memory = nullptr;
        if (posix_memalign(&memory, alignment, bytes) != 0) throw std::bad_alloc();
        data_.reset(static_cast<T*>(memory));
#ifdef MADV_HUGEPAGE
        // A hint: failure is fine. The last, partial huge page is left out: it would take memory that the
        // plan doesn't count.
        if (alignment == kHugePage) madvise(memory, bytes / kHugePage * kHugePage, MADV_HUGEPAGE);
#endif
        std::memset(data_.get() + cleared_from, 0, bytes - cleared_from * sizeof(T));
    }

    std::unique_ptr<T, Free> data_;
    std::size_t size_ = 0;
};

}  // namespace pelagic
