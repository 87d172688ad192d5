// The picture of a body's colour from its file (map_Kd of an MTL).
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>

#include "plugin/format/obj/object_obj.h"

namespace pelagic {

// A PNG, whose numbers are sRGB, or an OpenEXR, whose numbers are linear Rec. 709 from 0 to 1; others are the nearest of these. Throws
// PictureRefused for a file that is neither, or damaged, that has NaN, or more texels than that.
std::shared_ptr<const ObjectImage> read_object_image(const std::filesystem::path& file,
                                                     std::size_t most_texels);

}  // namespace pelagic
