#include "core/waves/transform.h"

#include <fftw3.h>

#include <algorithm>
#include <mutex>
#include <new>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

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
    static constexpr auto plan_many_dft = fftwf_plan_many_dft;
    static constexpr auto execute_dft = fftwf_execute_dft;
    static constexpr auto destroy_plan = fftwf_destroy_plan;
    static constexpr auto alloc_complex = fftwf_alloc_complex;
    static constexpr auto free = fftwf_free;
};
template <>
struct Fftw<double> {
    using Complex = fftw_complex;
    using Handle = fftw_plan;
    static constexpr auto plan_many_dft = fftw_plan_many_dft;
    static constexpr auto execute_dft = fftw_execute_dft;
    static constexpr auto destroy_plan = fftw_destroy_plan;
    static constexpr auto alloc_complex = fftw_alloc_complex;
    static constexpr auto free = fftw_free;
};

// In place, tile by tile, so that both tiles of a swap stay in the first-level cache.
template <class T>
void transpose(std::complex<T>* square, int n) {
    constexpr int kTile = 16;
    for (int y0 = 0; y0 < n; y0 += kTile)
        for (int x0 = y0; x0 < n; x0 += kTile)
            for (int y = y0; y < std::min(y0 + kTile, n); ++y)
                for (int x = std::max(x0, y + 1); x < std::min(x0 + kTile, n); ++x)
                    std::swap(square[static_cast<std::size_t>(y) * n + x],
                              square[static_cast<std::size_t>(x) * n + y]);
}

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
    typename Fftw<T>::Handle rows = nullptr;
    Plan() = default;
    Plan(const Plan&) = delete;
    Plan& operator=(const Plan&) = delete;
    ~Plan() {
        const std::lock_guard lock(planner());
        if (rows) Fftw<T>::destroy_plan(rows);
    }
};

template <class T>
InverseTransform<T>::InverseTransform(int n) : n_(n) {
    const TransformBuffer<T> scratch(static_cast<std::size_t>(n) * n);
    auto* data = reinterpret_cast<typename Fftw<T>::Complex*>(scratch.data());
    auto plan = std::make_shared<Plan>();
    {
        const std::lock_guard lock(planner());
        plan->rows = Fftw<T>::plan_many_dft(1, &n, n, data, nullptr, 1, n, data, nullptr, 1, n, FFTW_BACKWARD,
                                            FFTW_ESTIMATE);
    }
    if (!plan->rows) throw std::runtime_error("no transform for size " + std::to_string(n));
    plan_ = std::move(plan);
}

template <class T>
void InverseTransform<T>::execute(const TransformBuffer<T>& buffer) const {
    // Along y, where y lies side by side; turned; along x. Asked for the square at once, or for its columns,
    // FFTW's estimate picks passes that are 8 to 14 times slower than what its timing
    // would find; rows it estimates well.
    auto* data = reinterpret_cast<typename Fftw<T>::Complex*>(buffer.data());
    Fftw<T>::execute_dft(plan_->rows, data, data);
    transpose(buffer.data(), n_);
    Fftw<T>::execute_dft(plan_->rows, data, data);
}

template class TransformBuffer<float>;
template class TransformBuffer<double>;
template class InverseTransform<float>;
template class InverseTransform<double>;

}  // namespace pelagic
