// Inverse Fourier transforms of complex squares: the one place that knows FFTW.
#pragma once

#include <complex>
#include <cstddef>
#include <memory>

namespace pelagic {

// Memory aligned as FFTW's vector code wants it, always alike, so that the same plan gives the same bits.
template <class T>
class TransformBuffer {
  public:
    TransformBuffer() = default;
    explicit TransformBuffer(std::size_t count);  // throws std::bad_alloc
    std::complex<T>* data() const { return data_.get(); }
    std::size_t size() const { return size_; }

  private:
    struct Free {
        void operator()(std::complex<T>*) const;
    };
    std::unique_ptr<std::complex<T>[], Free> data_;
    std::size_t size_ = 0;
};

// f(jx, jy) = Σ F(mx, my) exp(+2πi (mx jx + my jy)/N), in place, one thread, unnormalised. Takes F(mx, my) at
// mx N + my, my side by side, and leaves f(jx, jy) at jy N + jx, x side by side. Planned by FFTW's estimate
// and never by timing, so that every run takes the same path (where the host has not given FFTW wisdom of its
// own). execute() may be called from several threads at once.
template <class T>
class InverseTransform {
  public:
    explicit InverseTransform(int n);  // throws std::runtime_error where FFTW has no plan
    void execute(const TransformBuffer<T>&) const;
    int n() const { return n_; }

  private:
    struct Plan;
    int n_;
    std::shared_ptr<const Plan> plan_;
};

}  // namespace pelagic
