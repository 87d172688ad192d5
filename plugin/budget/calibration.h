// How long this machine takes for what the cost model counts (cost.h): measured there in a few seconds, and kept in the user's
// cache folder, $XDG_CACHE_HOME/pelagic or ~/.cache/pelagic, for the program's version, the CPU's name, the number of threads and
// the vector instruction set.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

#include "core/base/build_watch.h"
#include "plugin/budget/cost.h"

namespace pelagic {

// Kinds of work that take as much longer or shorter on another machine.
struct WorkGroup {
    const char* name;
    const char* of;  // for people: what is done there
};
inline constexpr std::array kWorkGroups = std::to_array<WorkGroup>({
    {"transforms", "Fourier transforms"},
    {"modes", "the waves' phases"},
    {"points", "values at points"},
    {"trains", "wave trains at points"},
    {"foam", "the foam's past"},
    {"light", "light of pictures"},
    {"integral", "the integral of the sky"},
});

struct Calibration {
    std::string version, cpu, instruction_set;
    int threads = 0;
    // By group: the time here over the recorded one.
    std::array<double, kWorkGroups.size()> times{};

    Rates rates() const;
};

// This machine, with the threads of the calling arena, as if it took the recorded times.
Calibration as_recorded();

// Measured anew, on the threads of the calling arena, by a clock. Seconds. Throws BuildCancelled.
double wall_ms();
Calibration measure_machine(const BuildWatch& watch = {}, double (*now_ms)() = wall_ms);

// What an earlier one kept of this machine in the folder, whole.
std::optional<Calibration> kept_calibration(const std::filesystem::path& folder);

// That, or measured and kept. A folder that can't be written and a file that can't be read are no
// failure: then this process remembers it. Empty: there is no folder.
Calibration calibration(const std::filesystem::path& folder, const BuildWatch& watch = {});

// Keeps it for calibration(). The file; empty where the folder can't be written.
std::filesystem::path keep(const Calibration& measured, const std::filesystem::path& folder);

// The user's; empty where the environment names none.
std::filesystem::path cache_folder();

}  // namespace pelagic
