#include "plugin/files/module.h"

#include <dlfcn.h>

#include <system_error>
#include <utility>

namespace pelagic::files {
namespace {

// What this machine lacks, in these words alone: std::system_error adds the system's.
struct NotLoaded : std::system_error {
    explicit NotLoaded(std::string text)
        : system_error(std::make_error_code(std::errc::not_supported)), text_(std::move(text)) {}
    const char* what() const noexcept override { return text_.c_str(); }
    std::string text_;
};

}  // namespace

void* load(const Module& module) {
    void* const library = ::dlopen(module.file, RTLD_NOW | RTLD_LOCAL);
    void* const symbol = library ? ::dlsym(library, module.symbol) : nullptr;
    if (!symbol) throw NotLoaded(module.what + " can't be loaded: " + ::dlerror() + "; " + module.needs);
    return symbol;
}

}  // namespace pelagic::files
