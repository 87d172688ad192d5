// One wavenumber with its dispersion solved once, as every energy and spreading law wants it.
#pragma once

#include "core/spectrum/dispersion.h"

namespace pelagic {

struct WavePoint {
    double k = 0.0;          // rad/m, > 0
    double omega = 0.0;      // rad/s
    double domega_dk = 0.0;  // m/s
};

inline WavePoint wave_point(const Dispersion& dispersion, double k) {
    return {k, dispersion.omega(k), dispersion.domega_dk(k)};
}

}  // namespace pelagic
