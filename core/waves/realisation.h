// Statistics of the waves at one time: sums over modes or trains, independent of any mesh.
#pragma once

namespace pelagic {

struct Realisation {
    double m0 = 0.0;                 // Σ|h|² [m²]
    double m_minus1 = 0.0;           // Σ|h|²/ω [m² s/rad]
    double mss = 0.0;                // Σk²|h|²
    double east = 0.0, north = 0.0;  // Σ|h0|² k/|k|: the direction in which the energy travels

    Realisation& operator+=(const Realisation& other) {
        m0 += other.m0;
        m_minus1 += other.m_minus1;
        mss += other.mss;
        east += other.east;
        north += other.north;
        return *this;
    }
};

}  // namespace pelagic
