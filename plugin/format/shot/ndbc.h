// Directional wave spectra in the text format of the NDBC archive (US National Data Buoy Center, "Measurement
// descriptions and units", spectral wave data): five files a buoy and year, one row an hour, one column a
// frequency.
#pragma once

#include <chrono>
#include <filesystem>
#include <stdexcept>
#include <string>

#include "pelagic/scene.h"

namespace pelagic {

// What is wrong with a buoy's files or with the hour asked of them.
class NdbcError : public std::runtime_error {
  public:
    struct Parts {
        std::string problem;      // names the file, and the line where there is one
        std::string accepted;     // what would be right
        bool about_time = false;  // the files are good: it is the hour that isn't in them
    };
    explicit NdbcError(Parts parts)
        : std::runtime_error(parts.problem + "; accepted: " + parts.accepted), parts_(std::move(parts)) {}
    const Parts& parts() const { return parts_; }

  private:
    Parts parts_;
};

// The spectrum of one hour. `w_file` holds the densities [m²/Hz]; the files of mean and principal direction
// (d, i) and of their spreads (j, k) lie beside it under its name, that letter in place of the w before the
// year: 41010w2019.txt, 41010d2019.txt, … Header lines "#YY MM DD hh mm .0200 …", "YYYY MM DD hh …" without
// minutes, and years of two digits are all read; of two rows of one time the first counts.
//
// Bins whose density is missing are left out, so that their neighbours bridge them. Where one of the four
// directional numbers is missing the bin has no direction. The buoy's "from, clockwise from north" α becomes
// our "towards, counter-clockwise from +x (east)" θ = 270° − α: c1 = r1 e^{iθ1}, c2 = r2 e^{2iθ2}.
//
// NdbcError if a file is missing or malformed, if frequencies differ between the files, or if the hour is not
// in all of them.
MeasuredSpectrum load_ndbc(const std::filesystem::path& w_file, std::chrono::sys_seconds time);

// "2019-02-06T00:40:00Z"
std::string time_text(std::chrono::sys_seconds time);

}  // namespace pelagic
