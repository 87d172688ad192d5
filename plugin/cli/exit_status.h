// What the program's exit status means.
#pragma once

namespace pelagic::cli {

inline constexpr int kDone = 0;        // everything that was asked for is complete, on disk or printed
inline constexpr int kRefused = 1;     // a shot file that is refused, or a file that can't be read or written
inline constexpr int kWrongUsage = 2;  // the command line itself
inline constexpr int kSignal = 128;    // plus the signal's number, as shells count

}  // namespace pelagic::cli
