// Progress on stderr. See progress.h.
#include "plugin/host/cli/progress.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "plugin/host/cli/json_output.h"
#include "plugin/host/cli/text.h"

namespace pelagic::cli {
namespace {

constexpr std::chrono::milliseconds kRewriteEvery{100};  // faster than one can read
constexpr std::chrono::seconds kLineEvery{5};            // keeps the log of a long bake short
constexpr int kColumns = 80;                             // of a terminal of unknown width
constexpr int kLongestBar = 40;
constexpr int kShortestBar = 8;  // a shorter one isn't informative

bool is_terminal() {
    const char* kind = std::getenv("TERM");
    return isatty(STDERR_FILENO) != 0 && kind != nullptr && std::string_view(kind) != "dumb";
}

int terminal_columns() {
    winsize size{};
    return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : kColumns;
}

std::string percent(double share) {
    return std::to_string(std::lround(100.0 * share)) + " %";
}

const char* word_of(RunStage stage) {
    constexpr std::array kWords{"planning", "checking", "building", "looking", "frames", "waiting"};
    return kWords[static_cast<std::size_t>(stage)];
}

int finished(const RunProgress& progress) {
    return progress.done + progress.kept;
}

// "3.4 frames/s", or "12 s a frame" if it is slow; empty before the first frame is done.
std::string rate_text(const RunProgress& progress) {
    if (progress.done == 0 || progress.seconds <= 0.0) return {};
    const double rate = progress.done / progress.seconds;
    if (rate < 0.5) return duration_text(1.0 / rate) + " a frame";
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), rate < 9.95 ? "%.1f frames/s" : "%.0f frames/s", rate);
    return text.data();
}

std::string left_text(const RunProgress& progress) {
    const int left = progress.total - finished(progress);
    if (progress.done == 0 || left <= 0) return {};
    return duration_text(progress.seconds / progress.done * left) + " left";
}

std::string share_text(const RunProgress& progress, const std::string& share_is) {
    if (!(progress.share > 0.0)) return {};
    return share_is + ": " + percent(progress.share);
}

std::string joined(std::initializer_list<std::string> parts, std::string_view between) {
    std::string text;
    for (const std::string& part : parts) {
        if (part.empty()) continue;
        if (!text.empty()) text += between;
        text += part;
    }
    return text;
}

void print(const std::string& text) {
    std::fwrite(text.data(), 1, text.size(), stderr);
    std::fflush(stderr);
}

}  // namespace

std::string progress_line(const RunProgress& progress, const std::string& share_is) {
    const std::string count = std::to_string(finished(progress)) + " of " + std::to_string(progress.total);
    if (progress.done == 0)
        return joined(
            {progress.kept > 0 ? count + " frames are whole already" : "", share_text(progress, share_is)},
            ", ");
    return "frame " + std::to_string(progress.frame) + ": " +
           joined({count, rate_text(progress), left_text(progress), share_text(progress, share_is)}, ", ");
}

std::string progress_bar(const RunProgress& progress, const std::string& share_is, int columns) {
    const std::string count = std::to_string(finished(progress)) + '/' + std::to_string(progress.total);
    const std::string frame = progress.done > 0 ? "frame " + std::to_string(progress.frame) : std::string();
    const std::string text = joined(
        {frame, count, rate_text(progress), left_text(progress), share_text(progress, share_is)}, "  ");
    // The last column stays empty, because many terminals wrap there. 3: brackets and a space.
    const int room = std::min(columns - 1 - static_cast<int>(text.size()) - 3, kLongestBar);
    if (room < kShortestBar) return text.substr(0, static_cast<std::size_t>(std::max(columns - 1, 0)));
    const auto filled =
        static_cast<std::size_t>(static_cast<long>(room) * finished(progress) / std::max(progress.total, 1));
    return '[' + std::string(filled, '#') + std::string(static_cast<std::size_t>(room) - filled, '-') + "] " +
           text;
}

Progress::Progress() : terminal_(is_terminal() && !is_json()) {}

void Progress::tell(const RunProgress& progress) {
    const Clock::time_point now = Clock::now();
    const std::pair moment(progress.stage, finished(progress));
    if (told_ == moment && now - last_ < std::chrono::seconds(1)) return;
    told_ = moment;
    last_ = now;
    double share = progress.share;
    if (progress.stage == RunStage::Frames && progress.total > 0) {
        // A frame is computed while the one before it is written: what is done of it isn't added to what is whole.
        furthest_ = std::max(furthest_, (finished(progress) + progress.share) / progress.total);
        share = furthest_;
    }
    tell_json({{"event", "progress"},
               {"stage", word_of(progress.stage)},
               {"frame", progress.frame},
               {"done", progress.done},
               {"kept", progress.kept},
               {"total", progress.total},
               {"seconds", progress.seconds},
               {"share", share}});
}

void Progress::show(const RunProgress& progress, const std::string& share_is) {
    if (is_json()) return tell(progress);
    switch (progress.stage) {
        case RunStage::Planning:
            return;  // milliseconds
        case RunStage::Checking:
            return show("checking the files that are there: " + percent(progress.share));
        case RunStage::Waiting:
            if (!std::exchange(waiting_said_, true)) last_ = {};  // at once, whatever was said just now
            return show("waiting for another bake that writes into the same folder");
        case RunStage::Building:
            return show_building(progress.share);
        case RunStage::Looking:
            return show("looking where the camera is above water: " + percent(progress.share));
        case RunStage::Frames:
            break;
    }
    waiting_said_ = false;
    const bool last = finished(progress) >= progress.total;
    const Clock::time_point now = Clock::now();
    if (frame_said_ && !last && now - last_ < (terminal_ ? Clock::duration(kRewriteEvery) : kLineEvery))
        return;
    if (!terminal_ && progress.done == 0 && progress.kept == 0 &&
        (!(progress.share > 0.0) || now - last_ < kLineEvery))
        return;  // nothing to report yet
    frame_said_ = true;
    last_ = now;
    if (terminal_) return write_over(progress_bar(progress, share_is, terminal_columns()));
    print(progress_line(progress, share_is) + '\n');
}

void Progress::show_building(double built) {
    const Clock::time_point now = Clock::now();
    if (building_said_ && now - last_ < (terminal_ ? Clock::duration(kRewriteEvery) : kLineEvery)) return;
    const std::string share = built > 0.0 ? ": " + percent(built) : "";
    building_said_ = true;
    last_ = now;
    if (terminal_) return write_over("building the sea" + (share.empty() ? " …" : share));
    print("building the sea" + share + '\n');
}

void Progress::show_measuring(double done) {
    show("measuring for the budget: " + percent(done));
}

void Progress::show(const std::string& line) {
    const Clock::time_point now = Clock::now();
    if (frame_said_ && now - last_ < (terminal_ ? Clock::duration(kRewriteEvery) : kLineEvery)) return;
    frame_said_ = true;
    last_ = now;
    if (is_json()) return tell_json({{"event", "progress"}, {"text", line}});
    if (terminal_) return write_over(line.substr(0, static_cast<std::size_t>(terminal_columns()) - 1));
    print(line + '\n');
}

void Progress::clear() {
    if (line_is_there_) print("\r\x1b[K");
    line_is_there_ = false;
}

void Progress::write_over(const std::string& line) {
    print("\r\x1b[K" + line);  // returns to the start of the line and erases it
    line_is_there_ = true;
}

}  // namespace pelagic::cli
