// The energy of each cell of a cascade's wavevector grid: Ψ integrated over the cell and its band, not
// sampled at its centre. A swell of 11 s sits at mode 2 of a 400 m tile: its whole spectrum fits between two
// samples.
//
// The rule follows from how smooth Ψ is across the cell. With r the cell's distance from the origin in cells,
// times the panel's width (TablePanel):
//   a kink or an edge of the band crosses the cell, or r < 8:  polar coordinates, the circles cut exactly by
//                                                             the cell's sides
//   r < 48, 192 and beyond:                                   4 × 4, 2 × 2 and 1 Gauss nodes
// What a wavenumber spectrum ∝ k⁻⁴ loses by one node is ⅔ r⁻²: below 2e-5.
#pragma once

#include <cstddef>
#include <vector>

#include "core/spectrum/density_kernels.h"
#include "core/spectrum/spectrum_table.h"

namespace pelagic {

class CellEnergies {
  public:
    // Of the grid with cells of 2π/size_m and the band k_lower ≤ k < k_upper [rad/m]; k_upper may be
    // infinite. The table must outlive this.
    CellEnergies(const SpectrumTable& table, double size_m, double k_lower, double k_upper);

    // Energies [m²], ≥ 0, of the modes (mx, my), (−mx, −my), (mx, −my) and (−mx, my), my = 0 … height,
    // mx ≥ 0, each into an array of height + 1 + kDensitySlack values. 0 for (0, 0), which is no wave. A
    // mode's energy has the same bits whatever the height. Safe to call from any number of threads.
    void column(int mx, int height, const FourWays& energy) const;

  private:
    enum class Rule { Nothing, Polar, Sixteen, Four, One };
    struct Ring {
        double end;  // holds the cells with mx² + my² < end that no ring before it has
        Rule rule;
        std::size_t panel;
    };
    struct Sum {  // of one cell and its mirror images, as in FourWays
        double same = 0.0, opposite = 0.0, below = 0.0, above = 0.0;
    };
    struct Nodes;

    void run(const Ring& ring, int mx, int first_my, int end_my, const FourWays& energy) const;
    Sum cell(int mx, int my, bool polar) const;
    void polar(int mx, int my, Sum& sum) const;
    void sixteen(int mx, int my, Sum& sum) const;
    void add(std::size_t panel, Nodes& nodes, Sum& sum) const;

    const SpectrumTable& table_;
    DensityKernels kernels_;
    double step_, k_lower_, k_upper_;
    std::vector<Ring> rings_;   // rising
    std::vector<double> cuts_;  // kinks and edges of the band, in cells
};

}  // namespace pelagic
