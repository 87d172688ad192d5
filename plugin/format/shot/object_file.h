// The mesh of a body from its file (objects[].file).
#pragma once

#include <filesystem>
#include <memory>

#include "pelagic/object_mesh.h"

namespace pelagic {

// A Wavefront OBJ with the MTL files and pictures beside it (plugin/format/obj/object_obj.h), or a USD crate (plugin/format/usd/read_body.h). Throws ObjError; its problem is the end of a sentence
// about the file where that can't be read, and says the line otherwise.
std::shared_ptr<const ObjectMesh> load_object(const std::filesystem::path& file);

}  // namespace pelagic
