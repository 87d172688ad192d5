// The scene, which others have as well.
#pragma once

#include <cmath>

#include "pelagic/scene.h"
