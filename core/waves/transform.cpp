#include "core/waves/transform.h"

#include <fftw3.h>

#include <mutex>
#include <new>
#include <stdexcept>
#include <string>
#include <type_traits>

namespace pelagic {
namespace {

// FFTW's planner is not thread-safe (its execution is).
std::mutex& planner() {
    static std::mutex mutex;
    return mutex;
}

template <class T>
struct Fftw;  // FFTW's two precisions under one name

template <>
struct Fftw<float> {
    using Complex = fftwf_complex;
    using Handle = fftwf_plan;
    static constexpr auto plan_dft_2d = fftwf_plan_dft_2d;
    static constexpr auto execute_dft = fftwf_execute_dft;
    static constexpr auto destroy_plan = fftwf_destroy_plan;
    static constexpr auto alloc_complex = fftwf_alloc_complex;
    static constexpr auto free = fftwf_free;
};
template <>
struct Fftw<double> {
    using Complex = fftw_complex;
    using Handle = fftw_plan;
    static constexpr auto plan_dft_2d = fftw_plan_dft_2d;
    static constexpr auto execute_dft = fftw_execute_dft;
    static constexpr auto destroy_plan = fftw_destroy_plan;
    static constexpr auto alloc_complex = fftw_alloc_complex;
    static constexpr auto free = fftw_free;
};

}  // namespace

template <class T>
TransformBuffer<T>::TransformBuffer(std::size_t count) : size_(count) {
    data_.reset(reinterpret_cast<std::complex<T>*>(Fftw<T>::alloc_complex(count)));
    if (!data_) throw std::bad_alloc();
}

template <class T>
void TransformBuffer<T>::Free::operator()(std::complex<T>* p) const {
    Fftw<T>::free(p);
}

template <class T>
struct InverseTransform<T>::Plan {
    typename Fftw<T>::Handle handle;
    explicit Plan(typename Fftw<T>::Handle h) : handle(h) {}
    Plan(const Plan&) = delete;
    Plan& operator=(const Plan&) = delete;
    ~Plan() {
        const std::lock_guard lock(planner());
        Fftw<T>::destroy_plan(handle);
    }
};

template <class T>
InverseTransform<T>::InverseTransform(int n) : n_(n) {
    const TransformBuffer<T> scratch(static_cast<std::size_t>(n) * n);
    auto* data = reinterpret_cast<typename Fftw<T>::Complex*>(scratch.data());
    typename Fftw<T>::Handle handle;
    {
        const std::lock_guard lock(planner());
        handle = Fftw<T>::plan_dft_2d(n, n, data, data, FFTW_BACKWARD, FFTW_ESTIMATE);
    }
    if (!handle) throw std::runtime_error("no transform for size " + std::to_string(n));
    plan_ = std::make_shared<const Plan>(handle);
}

template <class T>
void InverseTransform<T>::execute(const TransformBuffer<T>& buffer) const {
    auto* data = reinterpret_cast<typename Fftw<T>::Complex*>(buffer.data());
    Fftw<T>::execute_dft(plan_->handle, data, data);
}

template class TransformBuffer<float>;
template class TransformBuffer<double>;
template class InverseTransform<float>;
template class InverseTransform<double>;

}  // namespace pelagic
