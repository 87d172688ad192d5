// The inner loops of a Frame over modes and samples, vectorised with Highway for the CPU at run time. A
// column is the run of modes with one mx (core/plan/mode_lattice.h). Pointers "at my = 0" are read from −H to
// H. Every loop may read and write up to Buffer<T>::kSlack values beyond its range.
#pragma once

#include <cstddef>

#include "core/plan/fields.h"

namespace pelagic {

// h(k,t) = forward e^{−iωt} + backward e^{iωt} and, where `rate_re` is given, ∂h/∂t.
template <class T>
struct AdvanceArgs {
    const T *forward_re, *forward_im, *backward_re, *backward_im;  // [m]
    const double* cycles_per_s;
    double time_s;
    std::size_t count;
    T *height_re, *height_im;                  // [m]
    T *rate_re = nullptr, *rate_im = nullptr;  // [m/s]
};

// A grid's weight on each mode of a column: footprint filter times spline prefilter.
template <class T>
struct ThroughArgs {
    int half_height;
    T kx, step;                        // [rad/m]
    double footprint_m, n_min, n_max;  // core/plan/filter.h; footprint 0: no filter
    const T* prefilter = nullptr;      // at my = 0; null where the grid is read at its nodes only
    T prefilter_x = T(1);
    const T* chop = nullptr;    // choppiness coth(kd)/k, at my = 0; null without choppiness
    T *through, *chop_through;  // out, at my = 0: the weight, and the weight times chop
};

// One field's spectrum along a column, in the order of a 1-D transform along y: my = 0 … H, zeros, my =
// −H … −1.
template <class T>
struct LineArgs {
    Field field;
    int half_height, n;
    T kx, step;                                          // [rad/m]
    const T *height_re, *height_im, *rate_re, *rate_im;  // at my = 0
    const T *through, *chop_through;                     // at my = 0
    T *line_re, *line_im;                                // out, n values
};

// Writes transformed columns into the rows. In each row the real parts begin at column first_column, the
// imaginary parts half a stride later.
template <class T>
struct ScatterArgs {
    const T* lines;  // `columns` lines, each 2 line_stride(n) long
    int columns, first_column, n;
    T* rows;                         // line_stride(n) apart
    int first_row = 0, end_row = 0;  // that are written
};

// Combines two rows' half spectra X and Y (modes 0 … radius − 1) into the full spectrum X + iY. Its transform
// along x has the first row as its real part and the second as its imaginary part. `second` null: Y = 0.
template <class T>
struct PairArgs {
    const T *first, *second;  // as scatter() leaves them
    int radius, n;
    T *line_re, *line_im;
};

// Sums over a column's modes, doubled for their conjugates at −k: see core/waves/realisation.h.
template <class T>
struct RealiseArgs {
    const T *height_re, *height_im, *forward_re, *forward_im, *backward_re, *backward_im;
    const double* cycles_per_s;
    int first_my, count;  // the pointers stand at first_my
    double kx, step;
    double cell_m, pixel_m, n_min, n_max;
    double* sums;  // added to: m0, m_minus1, mss, east, north
};

template <class T>
struct Kernels {
    void (*advance)(const AdvanceArgs<T>&);
    void (*through)(const ThroughArgs<T>&);
    void (*line)(const LineArgs<T>&);
    void (*scatter)(const ScatterArgs<T>&);
    void (*pair)(const PairArgs<T>&);
    void (*realise)(const RealiseArgs<T>&);
};

// The kernels for the CPU that the program runs on.
template <class T>
Kernels<T> kernels();

}  // namespace pelagic
