// Fourier transforms of single lines: the one place that knows FFTW.
//
// A field is real and its spectrum lives in a disc of modes, so a square of N × N samples takes R
// transforms along y (R: the disc's radius; 0 ≤ mx < R only) and N/2 along x (two real rows ride in one
// complex line). That is the arithmetic of half a complex square, less for the empty columns, whichever
// fields are asked for. core/waves/frame puts the lines together.
#pragma once

#include <memory>

#include "core/plan/grid_layout.h"

namespace pelagic {

// f(j) = Σ F(m) exp(+2πi m j/N), m and j from 0 to N − 1, one thread, unnormalised, from one place to
// another; real parts at the pointer, imaginary parts line_stride(N) behind it, both aligned to 64 bytes. The
// input is kept. Planned from recorded wisdom or by FFTW's estimate and never by timing, so that every run
// takes the same path (where the host has not given FFTW wisdom of its own). execute() may be called from
// several threads at once.
template <class T>
class LineTransform {
  public:
    explicit LineTransform(int n);  // throws std::runtime_error where FFTW has no plan
    void execute(const T* from, T* to) const;
    int n() const { return n_; }

  private:
    struct Plan;
    int n_;
    std::shared_ptr<const Plan> plan_;
};

}  // namespace pelagic
