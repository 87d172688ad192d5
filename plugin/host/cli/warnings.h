// What a user should know of a sea that is built all the same.
#pragma once

#include <string>

#include "pelagic/scene.h"

namespace pelagic::cli {

// "storm.toml: note: the surface folds over itself …", a line for each of sea_warnings(), to standard error.
void print_warnings(const std::string& shot, const Scene& scene);

}  // namespace pelagic::cli
