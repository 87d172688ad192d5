// quality.level, resolved into knobs: the one place that says what a level means, for the waves and for the
// light. Errors and times of each row: `pelagic accuracy --rows interpolation,sky`.
#pragma once

#include <span>
#include <stdexcept>

#include "pelagic/scene.h"

namespace pelagic {

// How the sky's reflection is looked up: core/lighting has the three.
enum class SkyLookups { One, Nine, Integral };

struct QualityRow {
    QualityLevel level;
    int spline_taps;            // 4: cubic B-spline, 6: quintic
    double oversampling;        // grid nodes per Nyquist sample of the shortest wave, where a spline reads it
    double light_oversampling;  // the same for what only a picture's light reads
    bool double_precision;      // of the waves
    SkyLookups sky;
    bool fitted_fresnel;  // our fit to the exact Fresnel term, or the paper's to Schlick's
    int samples;          // N × N a pixel
    // What reading between the nodes adds to positions, RMS over Hs: the largest of all examples' in `pelagic accuracy --rows
    // interpolation` (trade-wind, rounded up); of double precision less than that sweep's reference can tell.
    double read_error;
};

// From cheap to accurate.
inline std::span<const QualityRow> quality_table() {
    using enum SkyLookups;
    static constexpr QualityRow kQualityTable[]{
        {QualityLevel::Draft, 4, 1.25, 1.25, false, One, false, 1, 6.7e-3},
        {QualityLevel::Preview, 4, 2.0, 1.5, false, Nine, true, 1, 5.3e-4},
        {QualityLevel::Final, 6, 2.0, 1.4, false, Nine, true, 2, 3.7e-5},
        {QualityLevel::Reference, 6, 4.0, 4.0, true, Integral, true, 4, 1e-6},
    };
    return kQualityTable;
}

inline const QualityRow& quality_of(QualityLevel level) {
    for (const QualityRow& row : quality_table())
        if (row.level == level) return row;
    throw std::invalid_argument("quality level out of range");
}

}  // namespace pelagic
