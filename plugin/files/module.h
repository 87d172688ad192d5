// Modules: shared libraries of Pelagic's own that are loaded when they are first wanted, since what they need is large or not everywhere.
#pragma once

#include <string>

namespace pelagic::files {

struct Module {
    const char* file;    // found by the RPATH of whatever is loading
    const char* symbol;  // its only one
    std::string what;    // "Embree": what can't be loaded, in an error's words
    std::string needs;   // the rest of that sentence
};

// The symbol, for as long as the process lives: code of a module may run until then. Throws std::system_error (not_supported), whose text is
// a sentence, where the module or what it needs isn't there.
void* load(const Module& module);

}  // namespace pelagic::files
