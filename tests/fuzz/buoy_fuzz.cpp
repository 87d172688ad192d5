// The five files of a buoy, as one input: w, d, i, j, k, with a byte 1e between them. A spectrum or a refusal.
#include <cmath>
#include <fstream>
#include <map>
#include <string>

#include "plugin/format/shot/ndbc.h"
#include "tests/fuzz/fuzz.h"
#include "tests/plugin/format/shot/temporary_folder.h"

using namespace pelagic;
using fuzz::hold;

namespace {

void expect_good(const MeasuredSpectrum& spectrum) {
    hold(spectrum.bins.size() >= 2, "a spectrum has two bins");
    double last_hz = 0.0;
    for (const MeasuredSpectrum::Bin& bin : spectrum.bins) {
        hold(std::isfinite(bin.frequency_hz) && bin.frequency_hz > last_hz, "frequencies rise");
        last_hz = bin.frequency_hz;
        hold(std::isfinite(bin.density_m2_per_hz) && bin.density_m2_per_hz >= 0.0, "densities are 0 or more");
        hold(std::hypot(bin.c1_re, bin.c1_im) <= 1.0 + 1e-12, "the first moment is 1 at most");
        hold(std::hypot(bin.c2_re, bin.c2_im) <= 1.0 + 1e-12, "the second moment is 1 at most");
    }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const TemporaryFolder folder;
    static std::map<char, std::string> written;  // most inputs differ from the one before in one file alone
    std::string_view rest(reinterpret_cast<const char*>(data), size);
    for (const char letter : std::string_view("wdijk")) {
        const std::filesystem::path file = folder.path() / (std::string("fuzz") + letter + "2021.txt");
        const std::size_t end = std::min(rest.find('\x1e'), rest.size());
        if (const auto [at, is_first] = written.try_emplace(letter);
            is_first || at->second != rest.substr(0, end)) {
            std::filesystem::remove(file);  // file systems that are overwritten wait for the disk
            std::ofstream(file, std::ios::binary) << (at->second = rest.substr(0, end));
        }
        rest.remove_prefix(std::min(rest.size(), end + 1));
    }
    using namespace std::chrono;
    const sys_seconds time = sys_days{2021y / March / 1} + 50min;
    try {
        expect_good(load_ndbc(folder.path() / "fuzzw2021.txt", time));
    } catch (const NdbcError& error) {
        hold(!error.parts().problem.empty() && !error.parts().accepted.empty(), "a refusal says why",
             error.what());
    }
    return 0;
}
