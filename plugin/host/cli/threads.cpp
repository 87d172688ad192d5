// --threads. See threads.h.
#include "plugin/host/cli/threads.h"

#include <oneapi/tbb/info.h>

#include <charconv>

namespace pelagic::cli {
namespace {

constexpr int kMostThreads = 256;  // a frame has too little work for more

// What is wrong with a number of threads; empty if nothing is.
std::string refuse_threads(const std::string& text) {
    int number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error == std::errc() && end == text.data() + text.size() && number >= 1 && number <= kMostThreads)
        return {};
    return text + " is not a number of threads; accepted: 1 … " + std::to_string(kMostThreads) +
           ", or no --threads for all cores";
}

}  // namespace

CLI::Option* add_threads(CLI::App& command, std::string& threads, const char* help) {
    return command.add_option("--threads", threads, help)
        ->type_name("N")
        ->check(CLI::Validator(refuse_threads, ""));
}

Threads::Threads(const std::string& threads)
    : count_(threads.empty() ? tbb::info::default_concurrency() : std::stoi(threads)),
      limit_(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(count_)),
      arena_(count_) {}

}  // namespace pelagic::cli
