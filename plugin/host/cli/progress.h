// Progress on stderr: on a terminal one line that is rewritten, otherwise plain lines, few enough for a log.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <utility>

#include "plugin/run/run.h"

namespace pelagic::cli {

class Progress {
  public:
    Progress();
    ~Progress() { clear(); }
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    // share_is: what a frame's share is of, "the picture".
    void show(const RunProgress& progress, const std::string& share_is);
    void show(const std::string& line);  // progress of other work than a run, as a text
    void show_measuring(double done);    // of the shot or the machine, for a budget
    void clear();                        // erases the line, so that a message can follow

  private:
    using Clock = std::chrono::steady_clock;

    void tell(const RunProgress& progress);  // --json
    void show_building(double built);
    void write_over(const std::string& line);

    bool terminal_;
    bool line_is_there_ = false;
    bool building_said_ = false;
    bool frame_said_ = false;
    bool waiting_said_ = false;
    Clock::time_point last_;
    std::optional<std::pair<RunStage, int>> told_{};  // frames that were finished then
    double furthest_ = 0.0;                           // share of the frames that was told
};

// One line for a terminal of this width: "[######----] frame 12  13/48  3.4 frames/s  10 s left".
std::string progress_bar(const RunProgress& progress, const std::string& share_is, int columns);

// "frame 12: 13 of 48, 3.4 frames/s, 10 s left"
std::string progress_line(const RunProgress& progress, const std::string& share_is);

}  // namespace pelagic::cli
