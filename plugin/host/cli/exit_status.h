// The meaning of the program's exit status, which scripts and render farms rely on: help.cpp and README.md promise it.
#pragma once

#include <exception>
#include <stdexcept>

namespace pelagic::cli {

inline constexpr int kDone = 0;     // everything requested is complete, on disk or printed
inline constexpr int kUnknown = 1;  // an error of no known kind: a bug, ours or a library's
inline constexpr int kWrongUsage =
    2;  // what is asked for can't be, and the same again gives the same: the command
        // line, a shot file, a folder that is none, what this machine lacks
inline constexpr int kNotWhole = 3;  // what a folder holds isn't whole
inline constexpr int kTryAgain =
    75;  // later or on another machine it may succeed: disk, memory, threads, lock
inline constexpr int kSignal = 128;  // plus the signal's number, as in shells

// What kTryAgain is of, where it is no refusal of the system's.
struct TryAgain : std::runtime_error {
    using std::runtime_error::runtime_error;
};

// Whether the system refused to start another thread, from wherever it was asked; oneTBB's exception says it in words only.
bool is_about_threads(const std::exception& error);

// Of what ended the program.
int status_of(const std::exception& error);

}  // namespace pelagic::cli
