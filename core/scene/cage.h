// The mesh of a cage, which others have as well.
#pragma once

#include "pelagic/cage.h"
