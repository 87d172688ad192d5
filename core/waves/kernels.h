// The loops over modes and samples that a Frame spends its time in, in the vectors of the CPU at hand
// (Highway, chosen at run time). A column is a run of modes with one mx (core/plan/mode_lattice.h); pointers
// "at my = 0" are read from −H to H. Every loop may read, and write, up to Buffer<T>::kSlack values beyond
// what it is asked for.
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

// What a grid lets through of a column's modes: the footprint's weight times the spline's prefilter.
template <class T>
struct ThroughArgs {
    int half_height;
    T kx, step;                        // [rad/m]
    double footprint_m, n_min, n_max;  // core/plan/filter.h; footprint 0: all of it
    const T* prefilter = nullptr;      // by my, at my = 0; none where the grid is read at its nodes
    T prefilter_x = T(1);
    const T* chop = nullptr;    // choppiness coth(kd)/k, at my = 0; none without choppiness
    T *through, *chop_through;  // out, at my = 0; the second is the first times chop
};

// One field's spectrum along a column, as the line that a transform along y takes: my from 0 up, nothing, my
// from −H to −1.
template <class T>
struct LineArgs {
    Field field;
    int half_height, n;
    T kx, step;                                          // [rad/m]
    const T *height_re, *height_im, *rate_re, *rate_im;  // at my = 0
    const T *through, *chop_through;                     // at my = 0
    T *line_re, *line_im;                                // out, n values
};

// Columns after their transform, as pieces of the rows that they cross: for each row, its real parts from
// column first_column on, and the imaginary parts half a stride later.
template <class T>
struct ScatterArgs {
    const T* lines;  // `columns` lines, each 2 line_stride(n) long
    int columns, first_column, n;
    T* rows;  // line_stride(n) apart
};

// Two rows' half spectra X and Y (modes 0 … radius − 1), as the whole line X + iY that a transform along x
// takes; its real part is then the first row and its imaginary part the second. `second` may be null: 0.
template <class T>
struct PairArgs {
    const T *first, *second;  // as scatter leaves them
    int radius, n;
    T *line_re, *line_im;
};

// Sums over a column's modes, doubled for their mirror images: see core/waves/realisation.h.
template <class T>
struct RealiseArgs {
    const T *height_re, *height_im, *forward_re, *forward_im, *backward_re, *backward_im;
    const double* cycles_per_s;
    int first_my, count;  // pointers stand at first_my
    double kx, step;
    double cell_m, pixel_m, n_min, n_max;
    double* sums;  // m0, m_minus1, mss, east, north: added to
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

// For the CPU that runs this.
template <class T>
Kernels<T> kernels();

}  // namespace pelagic
