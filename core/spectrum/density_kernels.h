// Ψ at many wavevectors at once, in the vectors of the CPU at hand (Highway, chosen at run time). Loops may
// read and write up to kDensitySlack values beyond what they are asked for.
#pragma once

#include <cstddef>

#include "core/spectrum/spectrum_table.h"

namespace pelagic {

inline constexpr std::size_t kDensitySlack = 8;

// A value at the wavevectors (x, y), (−x, −y), (x, −y) and (−x, y).
struct FourWays {
    double *same, *opposite, *below, *above;
};

struct DensityKernels {
    // k = |(x, y)| [rad/m] and the direction's cosine and sine for x = x_cells·step and
    // y = (first_my + i + y_offset)·step: a wavevector's bits don't depend on where the run began.
    void (*column)(double x_cells, double y_offset, int first_my, double step, std::size_t count, double* k,
                   double* cosine, double* sine);
    // Adds the term's part of Ψ, times `weight`, at wavenumbers k in the direction (cosine, sine) and its
    // three mirror images.
    void (*add_density)(const TablePanel&, const TableTerm&, double weight, std::size_t count,
                        const double* k, const double* cosine, const double* sine, const FourWays& sum);
};

// For the CPU that runs this.
DensityKernels density_kernels();

}  // namespace pelagic
