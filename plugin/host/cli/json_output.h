// --json: what a verb says, for programs: an object a line on stdout ("event": "progress", "message", "result", "end"), in place of
// what people read there. Messages stay on stderr as well. FARM.md has the keys.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <ostream>
#include <streambuf>
#include <string>

namespace pelagic::cli {

void add_json(CLI::App& command);

// Whether the arguments ask for it: known before they are parsed, for what is wrong with them is told so, too.
bool asks_for_json(int argc, const char* const* argv);

// During its lifetime stdout is of events alone, and each line of std::cerr is one, too. One at a time.
class JsonOutput {
  public:
    JsonOutput();
    ~JsonOutput();
    JsonOutput(const JsonOutput&) = delete;
    JsonOutput& operator=(const JsonOutput&) = delete;

    void end(int status);  // the last event

  private:
    friend void tell_json(const nlohmann::ordered_json& event);
    std::streambuf *out_, *err_;
    std::ostream lines_;
    std::unique_ptr<std::streambuf> tee_;
    std::string last_message_;
};

bool is_json();
// Nothing without --json. Any thread may call.
void tell_json(const nlohmann::ordered_json& event);

}  // namespace pelagic::cli
