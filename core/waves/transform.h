// One-dimensional Fourier transforms, called lines here. Only this file and its source know FFTW.
//
// A field is real, and its modes lie within a radius R. So N × N samples take R transforms along y (0 ≤ mx <
// R) and N/2 along x (each complex transform yields two real rows): half the arithmetic of a complex N × N
// transform, less what the columns beyond R would cost. core/waves/frame combines the lines.
#pragma once

#include <memory>

#include "core/plan/grid_layout.h"

namespace pelagic {

// f(j) = Σ F(m) exp(+2πi m j/N), m and j from 0 to N − 1: unnormalised, single-threaded, out of place. Real
// parts begin at the pointer, imaginary parts line_stride(N) later, both aligned to 64 bytes. The input is
// preserved. Plans come from recorded wisdom or FFTW's estimate and never from timing, so that every run
// computes the same bits (unless the host gives FFTW other wisdom, or makes it forget). Several threads may call execute() at
// once.
template <class T>
class LineTransform {
  public:
    // What FFTW is given: real and imaginary parts apart, as they lie, or copied into pairs and back. Pairs are for lengths that are no
    // power of two, since FFTW has few vector codelets for parts that lie apart: a line of 480 takes about half as long. Powers of two
    // have recorded plans for parts apart. Pairs round otherwise.
    enum class Parts { Apart, Paired };
    explicit LineTransform(int n,
                           Parts parts = Parts::Apart);  // throws std::runtime_error where FFTW has no plan
    void execute(const T* from, T* to) const;
    int n() const { return n_; }

  private:
    struct Plan;
    int n_;
    Parts parts_;
    std::shared_ptr<const Plan> plan_;
};

}  // namespace pelagic
