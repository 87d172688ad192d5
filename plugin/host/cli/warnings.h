// What a user should know of a sea that is built all the same, and of meshes that are read.
#pragma once

#include <string>

#include "pelagic/scene.h"

namespace pelagic::cli {

// "storm.toml: note: the surface folds over itself …", a line for each of sea_warnings() and of the notes of objects' meshes, to
// standard error.
void print_warnings(const std::string& shot, const Scene& scene);

}  // namespace pelagic::cli
