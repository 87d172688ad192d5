// Runs the real program as users and farms do, and inspects the files that it leaves.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace pelagic::test {

// A new folder below the system's temporary folder, deleted with its contents.
class TempFolder {
  public:
    TempFolder();
    ~TempFolder();
    TempFolder(const TempFolder&) = delete;
    TempFolder& operator=(const TempFolder&) = delete;
    const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
};

inline bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

struct Launch {
    std::vector<std::string> arguments{};
    std::filesystem::path folder = "/";  // the working folder
    std::filesystem::path program = PELAGIC_PROGRAM;
    std::filesystem::path stdout_to{};   // empty: captured
    bool terminal = false;               // stderr is a terminal of 80 columns
    bool ignore_interrupt = false;       // starts with SIGINT ignored, like background jobs of a script
    std::size_t most_address_space = 0;  // bytes; 0: unlimited
};

struct Ended {
    int status = -1;  // as in shells: the exit status, or 128 + the number of the signal that killed it
    bool killed = false;
    std::string out, err;
    double seconds = 0.0, cpu_s = 0.0;  // of the clock; of the processor, its waited-for children's counted
};

// The preview can be left out of a build; the verb then says so, whatever it is asked.
inline constexpr bool kHasPreview = PELAGIC_HAS_PREVIEW;

// A started program; terminated with this object at the latest.
class Running {
  public:
    explicit Running(const Launch& launch);
    ~Running();
    Running(const Running&) = delete;
    Running& operator=(const Running&) = delete;

    void send(int signal);
    bool has_ended();
    std::string messages() const;  // its stderr so far; not for a terminal
    Ended wait();

  private:
    void reap(bool block);

    bool out_is_captured_;
    pid_t process_ = -1;
    bool ended_ = false;
    int wait_status_ = 0;
    double cpu_s_ = 0.0;
    int out_ = -1, err_ = -1, terminal_ = -1;  // this process's ends
    std::chrono::steady_clock::time_point start_;
};

Ended run(const Launch& launch);

void write_file(const std::filesystem::path& file, const std::string& text);
std::string read_file(const std::filesystem::path& file);

// Every file below the folder, including hidden ones, by its relative path.
std::map<std::string, std::string> files_below(const std::filesystem::path& folder);

// The incomplete files below the folder, one line each; empty if all are complete. USD text must begin with
// its header and close all brackets and strings; a crate must end with its table of contents; JSON must parse;
// OpenEXR's checker must read every pixel; PNG must end with its last chunk. Skips shot files, which the tests
// write, and hidden files, which leftovers() lists.
std::string torn_files(const std::filesystem::path& folder);

// Hidden files: temporaries of writers that died.
std::vector<std::string> leftovers(const std::filesystem::path& folder);

// The files in which two bakes differ, one line each; empty if all bytes are equal.
std::string differences(const std::filesystem::path& a, const std::filesystem::path& b);

// Mounts a file system in memory on the folder, visible to this process and its children only, and gone with
// them. Returns an empty string, or why this machine doesn't allow it.
struct MemoryDisk {
    std::filesystem::path folder{};
    std::string size = "1m";
    bool read_only = false;
    bool again = false;  // remounts the one that is there
};
std::string mount_disk(const MemoryDisk& disk);

}  // namespace pelagic::test
