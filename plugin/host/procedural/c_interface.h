// What the files of the C interface share: handles, checks of what comes in, and guards that let no exception out.
#pragma once

#ifdef __SSE2__
#include <xmmintrin.h>
#endif

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <exception>
#include <glm/vec3.hpp>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>

#include "core/evaluate/results.h"
#include "core/plan/memory.h"
#include "core/scene/limits.h"
#include "pelagic/procedural.h"
#include "plugin/format/shot/shot.h"
#include "plugin/host/procedural/procedural_frame.h"

struct pelagic_sea {
    std::shared_ptr<const pelagic::procedural::ShotSea> shot;
};
struct pelagic_frame {
    pelagic::procedural::ShotFrame frame;
};

namespace pelagic::procedural {

inline void say(pelagic_error* error, const char* message) {
    if (!error) return;
    std::size_t length = std::min(std::strlen(message), sizeof error->message - 1);
    const auto is_inside_character = [&] {
        return (static_cast<unsigned char>(message[length]) & 0xc0) == 0x80;
    };
    while (length > 0 && is_inside_character()) --length;
    std::memcpy(error->message, message, length);
    error->message[length] = '\0';
}

// While it lives floating point is as a program begins: to nearest, with subnormal numbers, no exception traps. A host's own settings, which
// would change bits or end it where a log meets 0, and its flags are as they were afterwards. On other CPUs nothing is done.
class OwnFloatingPoint {
  public:
#ifdef __SSE2__
    OwnFloatingPoint() : host_(_mm_getcsr()) {
        _mm_setcsr(kDefault);
    }
    ~OwnFloatingPoint() {
        _mm_setcsr(host_);
    }
    OwnFloatingPoint(const OwnFloatingPoint&) = delete;
    OwnFloatingPoint& operator=(const OwnFloatingPoint&) = delete;

  private:
    static constexpr unsigned int kDefault = 0x1f80;
    unsigned int host_;
#endif
};

// Runs `work`; what it throws becomes a status and a message.
template <class Work>
pelagic_status guarded(pelagic_error* error, const Work& work) noexcept {
    const auto failed = [&](pelagic_status status, const char* message) {
        say(error, message);
        return status;
    };
    say(error, "");
    [[maybe_unused]] const OwnFloatingPoint own;
    try {
        return work();
    } catch (const ShotError& refused) {
        return failed(PELAGIC_SHOT_REFUSED, refused.what());
    } catch (const BuildCancelled&) {
        return failed(PELAGIC_CANCELLED, "cancelled by the host");
    } catch (const NotEnoughMemory& refused) {
        return failed(PELAGIC_OUT_OF_MEMORY, refused.what());
    } catch (const std::invalid_argument& invalid) {
        return failed(PELAGIC_INVALID_ARGUMENT, invalid.what());
    } catch (const std::bad_alloc&) {
        return failed(PELAGIC_OUT_OF_MEMORY, "there is not enough memory");
    } catch (const std::exception& other) {
        return failed(PELAGIC_FAILED, other.what());
    } catch (...) {
        return failed(PELAGIC_FAILED, "something failed that has no name");
    }
}

template <class T>
T& required(T* pointer, const char* name) {
    if (!pointer) throw std::invalid_argument(std::string(name) + " is null");
    return *pointer;
}

// A frame that has a time.
inline const ShotFrame& frame_of(const pelagic_frame* frame) {
    const ShotFrame& of = required(frame, "frame").frame;
    if (!of.is_set())
        throw std::invalid_argument(
            "frame has no time, since setting it was cancelled or failed: call pelagic_frame_set() again");
    return of;
}

// The size of a structure in its first version; later members follow.
template <class S>
inline constexpr std::size_t kFirstSize = sizeof(S);
template <>
inline constexpr std::size_t kFirstSize<pelagic_open_options> = offsetof(pelagic_open_options,
                                                                         ray_cache_bytes);
template <>
inline constexpr std::size_t kFirstSize<pelagic_info> = offsetof(pelagic_info, foam_bytes);
template <>
inline constexpr std::size_t kFirstSize<pelagic_values> = offsetof(pelagic_values, breaking);
template <>
inline constexpr std::size_t kFirstSize<pelagic_expand_options> = offsetof(pelagic_expand_options, error_px);

// No version's structures are larger. A larger number isn't a size.
inline constexpr std::size_t kLargestSize = 4096;

// The size that a structure says it has.
template <class S>
std::size_t checked_size(const S* structure, const char* name) {
    const std::size_t size = required(structure, name).size;
    if (size < kFirstSize<S>)
        throw std::invalid_argument(std::string(name) + " has no size: begin with PELAGIC_INIT");
    if (size > kLargestSize)
        throw std::invalid_argument(std::string(name) + " has a size of " + std::to_string(size) +
                                    " bytes; accepted: at most " + std::to_string(kLargestSize) +
                                    ", begin with PELAGIC_INIT");
    return size;
}

// A structure of the caller's, as this version knows it. One of an earlier version has zeros for later members. A
// longer one is of a later version: all beyond this version's members must be 0.
template <class S>
S taken(const S* from, const char* name) {
    const std::size_t size = checked_size(from, name);
    S known{};
    std::memcpy(&known, from, std::min(size, sizeof(S)));
    if (size <= sizeof(S)) return known;
    const auto* bytes = reinterpret_cast<const unsigned char*>(from);
    if (std::any_of(bytes + sizeof(S), bytes + size, [](unsigned char byte) { return byte != 0; }))
        throw std::invalid_argument(std::string(name) + " asks for what a later version of the library has");
    return known;
}
// The same where null stands for a structure of zeros.
template <class S>
S taken_or_zeros(const S* from, const char* name) {
    return from ? taken(from, name) : S{};
}
// Copies into the caller's structure, whose size stays.
template <class S>
void give(S from, S* to, const char* name) {
    const std::size_t size = checked_size(to, name);
    from.size = size;
    std::memcpy(to, &from, std::min(size, sizeof(S)));
}

// Of a member that is 0 or 1: another number may be what a later version has.
inline bool flag(int value, const char* name) {
    if (value != 0 && value != 1)
        throw std::invalid_argument(std::string(name) + " is " + std::to_string(value) +
                                    ", which this version of the library doesn't know; accepted: 0, 1");
    return value == 1;
}

// A place [m], within the range of cameras.
inline void check_place(double metres, const char* name) {
    if (!limits::kCameraCoordinate_m.holds(metres))
        throw std::invalid_argument(std::string(name) + " is outside the range; accepted: " +
                                    text_of(limits::kCameraCoordinate_m) + " m");
}

// The size of a batch. More vectors than memory has room for would have addresses that wrap.
inline void check_count(std::size_t count, const char* name) {
    constexpr std::size_t kMost = PTRDIFF_MAX / sizeof(glm::vec3);
    if (count > kMost)
        throw std::invalid_argument(std::string(name) + " is " + std::to_string(count) +
                                    "; accepted: at most " + std::to_string(kMost));
}

// What a host wants, and what it takes coverage for.
struct Wanted {
    Results<float> results;
    CoverageOf coverage = CoverageOf::AllFoam;
};

inline Wanted wanted_in(const pelagic_values& values) {
    static_assert(sizeof(glm::vec3) == 3 * sizeof(float));
    const auto vectors = [](float* at) { return Strided<glm::vec3>{reinterpret_cast<glm::vec3*>(at)}; };
    Results<float> results;
    results.set(Product::Position, vectors(values.position_m));
    results.set(Product::Normal, vectors(values.normal));
    results.set(Product::Velocity, vectors(values.velocity_mps));
    results.set(Product::SlopeVariance, vectors(values.slope_variance));
    results.set(Product::Coverage, {values.coverage});
    results.set(Product::Breaking, {values.breaking});
    results.set(Product::FoamAge, {values.age_s});
    const bool is_first = values.size <= kFirstSize<pelagic_values>;
    return {results, is_first ? CoverageOf::FirstVersion : CoverageOf::AllFoam};
}

}  // namespace pelagic::procedural
