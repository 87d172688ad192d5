// Its place is core/evaluate: who still includes it from here may take it from there.
#pragma once

#include "core/evaluate/object_place.h"
