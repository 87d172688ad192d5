// The meaning of the program's exit status.
#pragma once

namespace pelagic::cli {

inline constexpr int kDone = 0;     // everything requested is complete, on disk or printed
inline constexpr int kRefused = 1;  // a shot file is invalid, a file can't be read or written, or isn't whole
inline constexpr int kWrongUsage = 2;  // an error on the command line
inline constexpr int kSignal = 128;    // plus the signal's number, as in shells

}  // namespace pelagic::cli
