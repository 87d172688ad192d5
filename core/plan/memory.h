// What a run will hold in memory, known from its plan before it begins.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/plan/plan.h"

namespace pelagic {

// "12 KiB", "3.4 MiB", "1.25 GiB".
std::string bytes_text(std::size_t bytes);

// Bytes that are held at the same time as the others of a need.
struct MemoryPart {
    std::string what;  // "the frame's grids"
    std::size_t bytes = 0;
    std::string remedy;  // what to change so that they become fewer: "lower output.map_resolution"
};

class MemoryNeed {
  public:
    // Adds to the part of that name, if there is one.
    void add(const std::string& what, std::size_t bytes, const std::string& remedy);
    std::size_t bytes() const;
    // The largest first.
    std::vector<MemoryPart> parts() const;

  private:
    std::vector<MemoryPart> parts_;
};

// The sea of a plan, one frame of it, and what so many threads work on while they compute it.
void add_sea(MemoryNeed& need, const Plan& plan, int threads);

// "About 3.4 GiB: 3.0 GiB for the frame's grids, 412.0 MiB for …": those above a hundredth.
std::string memory_text(const MemoryNeed& need);

// What a run may hold, and who says so: "this machine has", "--max-memory allows".
struct MemoryLimit {
    std::size_t bytes = 0;
    std::string whose;
    bool is_asked = false;  // by the user: elsewhere or later it is the same
};

// A run that needs more than it may have. what() says how much is needed and there, for what, and what to change.
class NotEnoughMemory : public std::runtime_error {
  public:
    explicit NotEnoughMemory(const std::string& text, bool is_asked = false)
        : std::runtime_error(text), is_asked_(is_asked) {}
    // Of the limit: MemoryLimit::is_asked.
    bool is_asked() const { return is_asked_; }

  private:
    bool is_asked_;
};

// Throws NotEnoughMemory. `run`: "this bake". `how`: "at least" where a part of the need isn't known yet.
void require_memory(const MemoryNeed& need, const MemoryLimit& limit, const std::string& run,
                    const char* how = "about");

}  // namespace pelagic
