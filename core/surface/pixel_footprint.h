// The footprints of pixels on the drawn sea, in C++.
#pragma once

#include "core/base/number.h"

namespace pelagic {

#include "core/surface/pixel_footprint.inl"

}  // namespace pelagic
