#include "core/plan/memory.h"

#include <algorithm>
#include <cstdio>

#include "core/plan/effects.h"
#include "core/plan/grid_layout.h"

namespace pelagic {

std::string bytes_text(std::size_t bytes) {
    constexpr double kKibi = 1024.0;
    const double b = static_cast<double>(bytes);
    char text[32];
    if (b < kKibi * kKibi)
        std::snprintf(text, sizeof text, "%.1f KiB", b / kKibi);
    else if (b < kKibi * kKibi * kKibi)
        std::snprintf(text, sizeof text, "%.1f MiB", b / (kKibi * kKibi));
    else
        std::snprintf(text, sizeof text, "%.2f GiB", b / (kKibi * kKibi * kKibi));
    return text;
}

void MemoryNeed::add(const std::string& what, std::size_t bytes, const std::string& remedy) {
    if (bytes == 0) return;
    const auto same =
        std::find_if(parts_.begin(), parts_.end(), [&](const MemoryPart& part) { return part.what == what; });
    if (same != parts_.end())
        same->bytes += bytes;
    else
        parts_.push_back({what, bytes, remedy});
}

std::size_t MemoryNeed::bytes() const {
    std::size_t sum = 0;
    for (const MemoryPart& part : parts_) sum += part.bytes;
    return sum;
}

std::vector<MemoryPart> MemoryNeed::parts() const {
    std::vector<MemoryPart> sorted = parts_;
    std::stable_sort(sorted.begin(), sorted.end(),
                     [](const MemoryPart& a, const MemoryPart& b) { return a.bytes > b.bytes; });
    return sorted;
}

void add_sea(MemoryNeed& need, const Plan& plan, int threads) {
    const std::string remedy = plan.from->scene.waves.cascades.empty()
                                   ? "lower quality.level, or give waves.cascades of lower resolution"
                                   : "lower the resolutions in waves.cascades, or quality.level";
    need.add("the sea's amplitudes", plan.sea_bytes(), remedy);
    need.add("the frame's grids", plan.frame_bytes(), remedy);
    for (const EffectRow& row : effect_table())
        if (row.state.bytes) need.add(row.state.name, row.state.bytes(plan), row.state.remedy);
    // Sixteen columns of the largest grid, its lines and its modes (core/waves/frame.h), by thread.
    constexpr std::size_t kNumbers = 17 * 2 + 16 * 6;
    int largest = 0;
    for (const CascadePlan& cascade : plan.cascades)
        for (const Grid& grid : cascade.grids) largest = std::max(largest, grid.resolution);
    const std::size_t scalar = plan.knobs.double_precision ? sizeof(double) : sizeof(float);
    need.add("what threads work on", kNumbers * static_cast<std::size_t>(largest) * scalar * threads,
             "run on fewer threads (--threads)");
}

std::string memory_text(const MemoryNeed& need) {
    std::string text = "about " + bytes_text(need.bytes());
    const char* between = ": ";
    for (const MemoryPart& part : need.parts()) {
        if (part.bytes < need.bytes() / 100) break;
        text += between + bytes_text(part.bytes) + " for " + part.what;
        between = ", ";
    }
    return text;
}

void require_memory(const MemoryNeed& need, const MemoryLimit& limit, const std::string& run,
                    const char* how) {
    if (need.bytes() <= limit.bytes) return;
    const MemoryPart most = need.parts().front();
    const std::string remedy = most.remedy.empty() ? std::string() : ": " + most.remedy;
    throw NotEnoughMemory(run + " needs " + how + " " + bytes_text(need.bytes()) + " of memory, and " +
                              limit.whose + " " + bytes_text(limit.bytes) + "; most of it, " +
                              bytes_text(most.bytes) + ", is for " + most.what + remedy,
                          limit.is_asked);
}

}  // namespace pelagic
