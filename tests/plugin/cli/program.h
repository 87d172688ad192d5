// Runs the real program, as a person or a farm does, and looks at what it leaves on disk.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace pelagic::test {

// A new folder of its own below the system's temporary folder, deleted with all that is in it.
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

struct Launch {
    std::vector<std::string> arguments{};
    std::filesystem::path folder = "/";  // the working folder
    std::filesystem::path program = PELAGIC_PROGRAM;
    std::filesystem::path stdout_to{};   // empty: captured
    bool terminal = false;               // stderr is a terminal of 80 columns
    bool ignore_interrupt = false;       // begins with SIGINT ignored, as background jobs of a script do
    std::size_t most_address_space = 0;  // bytes; 0: unlimited
};

struct Ended {
    int status = -1;  // as shells count: the exit status, or 128 + the signal that killed it
    bool killed = false;
    std::string out, err;
    double seconds = 0.0;
};

// A started program; ended at the latest with this object.
class Running {
  public:
    explicit Running(const Launch& launch);
    ~Running();
    Running(const Running&) = delete;
    Running& operator=(const Running&) = delete;

    void send(int signal);
    bool has_ended();
    std::string messages() const;  // what is on its stderr so far; not for a terminal
    Ended wait();

  private:
    void reap(bool block);

    bool out_is_captured_;
    pid_t process_ = -1;
    bool ended_ = false;
    int wait_status_ = 0;
    int out_ = -1, err_ = -1, terminal_ = -1;  // our ends
    std::chrono::steady_clock::time_point start_;
};

Ended run(const Launch& launch);

void write_file(const std::filesystem::path& file, const std::string& text);
std::string read_file(const std::filesystem::path& file);

// Every file below the folder, hidden ones too, by its path relative to it.
std::map<std::string, std::string> files_below(const std::filesystem::path& folder);

// What is wrong with the files below the folder, a line each; empty: all are whole. USD text begins with its
// header and all its brackets and strings are closed; a crate ends with its contents; JSON parses; OpenEXR's
// own checker reads every pixel; PNG ends with its last chunk. Shot files, which are the tests' own, are not
// looked at. Hidden files are looked at by leftovers().
std::string torn_files(const std::filesystem::path& folder);

// Hidden files: temporaries that a dead writer left.
std::vector<std::string> leftovers(const std::filesystem::path& folder);

// In which files two bakes differ, a line each; empty: same files, same bytes.
std::string differences(const std::filesystem::path& a, const std::filesystem::path& b);

// Mounts a file system in memory on the folder, seen by this process and its children only, and gone with
// them. Empty, or why this machine doesn't let us.
struct MemoryDisk {
    std::filesystem::path folder{};
    std::string size = "1m";
    bool read_only = false;
    bool again = false;  // changes the one that is mounted there
};
std::string mount_disk(const MemoryDisk& disk);

}  // namespace pelagic::test
