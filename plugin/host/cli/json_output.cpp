#include "plugin/host/cli/json_output.h"

#include <algorithm>
#include <iostream>
#include <mutex>
#include <string_view>

#include "plugin/host/cli/help.h"

namespace pelagic::cli {
namespace {

JsonOutput* the_json = nullptr;
std::mutex json_writing;

// Passes all on, and tells of each line.
class Tee final : public std::streambuf {
  public:
    Tee(std::streambuf* to, std::string& last) : to_(to), last_(last) {}
    ~Tee() override { to_->sputn(line_.data(), static_cast<std::streamsize>(line_.size())); }

  private:
    // A line at a time, though std::cerr is flushed after each of its words: one write, and whole in what several write into.
    int_type overflow(int_type c) override {
        if (traits_type::eq_int_type(c, traits_type::eof())) return traits_type::not_eof(c);
        line_ += traits_type::to_char_type(c);
        if (line_.back() != '\n') return c;
        const auto size = static_cast<std::streamsize>(line_.size());
        const bool is_written = to_->sputn(line_.data(), size) == size;
        line_.pop_back();
        if (!line_.empty()) {
            if (!line_.starts_with("See: ") && line_.find(": note: ") == std::string::npos)
                last_ = line_;  // no error
            tell_json({{"event", "message"}, {"text", line_}});
        }
        line_.clear();
        return is_written ? c : traits_type::eof();
    }

    std::streambuf* const to_;
    std::string& last_;
    std::string line_;
};

}  // namespace

void add_json(CLI::App& command) {
    command.add_flag("--json", help::kJson);
}

bool asks_for_json(int argc, const char* const* argv) {
    const auto has = [&](std::initializer_list<std::string_view> names) {
        return std::any_of(argv, argv + argc, [&](const char* argument) {
            return std::find(names.begin(), names.end(), argument) != names.end();
        });
    };
    return has({"--json"}) && !has({"-h", "--help", "--version"});
}

JsonOutput::JsonOutput()
    : out_(std::cout.rdbuf(nullptr)),
      err_(std::cerr.rdbuf()),
      lines_(out_),
      tee_(std::make_unique<Tee>(err_, last_message_)) {
    std::cerr.rdbuf(tee_.get());
    the_json = this;
}

JsonOutput::~JsonOutput() {
    the_json = nullptr;
    std::cerr.rdbuf(err_);
    std::cout.rdbuf(out_);  // which forgets that nothing could be written while there was nowhere to
    if (!lines_) std::cout.setstate(std::ios::badbit);
}

void JsonOutput::end(int status) {
    nlohmann::ordered_json event{{"event", "end"}, {"status", status}};
    if (status != 0 && !last_message_.empty()) event["error"] = last_message_;
    tell_json(event);
}

bool is_json() {
    return the_json != nullptr;
}

void tell_json(const nlohmann::ordered_json& event) {
    if (!the_json) return;
    const std::lock_guard lock(json_writing);
    the_json->lines_ << event.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace) << std::endl;
}

}  // namespace pelagic::cli
