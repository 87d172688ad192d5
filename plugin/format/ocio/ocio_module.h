// What ocio.cpp asks of the module.
#pragma once

#include "plugin/format/ocio/ocio.h"

// The module's only symbol.
extern "C" const pelagic::ocio::View* pelagic_ocio_view(const pelagic::ocio::ViewChoice& choice);
