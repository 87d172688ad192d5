#include "core/waves/transform.h"

#include <fftw3.h>
#include <pthread.h>

#include <mutex>
#include <stdexcept>
#include <string>

#include "core/base/buffer.h"
#include "core/base/instruction_set.h"
#include "core/waves/planning.h"
#include "core/waves/wisdom.h"

namespace pelagic {
namespace {

// FFTW's planner is not thread-safe (its execution is): all who use it have FFTW's own lock, and we this one beside it.
std::mutex& planner_of_process() {
    static std::mutex mutex;
    return mutex;
}
// A forked process has one thread, and needs a planner that no other one is at work in.
std::mutex& planner() {
    static std::once_flag once;
    std::call_once(once, [] {
        pthread_atfork([] { planner_of_process().lock(); }, [] { planner_of_process().unlock(); },
                       [] { planner_of_process().unlock(); });
    });
    return planner_of_process();
}

// Guarded by the planner's mutex.
Planning planning = Planning::Recorded;

unsigned effort() {
    switch (planning) {
        case Planning::Measure:
            return FFTW_MEASURE;
        case Planning::Patient:
            return FFTW_PATIENT;
        case Planning::Recorded:
        case Planning::Estimate:
            break;
    }
    return FFTW_ESTIMATE;
}

// Adds to FFTW's wisdom. A different build of FFTW rejects it: no effect then. Double precision serves as reference only.
void remember() {
    for (const char* wisdom : {kSingleLineWisdom, kPairedLineWisdom}) fftwf_import_wisdom_from_string(wisdom);
}

// Once in a process, before the first plan: others may plan from then on as well, since FFTW's lock doesn't guard its wisdom.
void begin_planning() {
    static std::once_flag once;
    std::call_once(once, [] {
        fftwf_make_planner_thread_safe();
        fftw_make_planner_thread_safe();
        remember();
    });
}

void plan_by(Planning wanted) {
    const std::lock_guard lock(planner());
    begin_planning();
    fftwf_forget_wisdom();
    fftw_forget_wisdom();
    planning = wanted;
    if (planning == Planning::Recorded) remember();
}

template <class T>
struct Fftw;  // FFTW's two precisions under one name

template <>
struct Fftw<float> {
    using Handle = fftwf_plan;
    static constexpr auto plan = fftwf_plan_guru_split_dft;
    static constexpr auto execute = fftwf_execute_split_dft;
    static constexpr auto destroy_plan = fftwf_destroy_plan;
    using Dimension = fftwf_iodim;
};
template <>
struct Fftw<double> {
    using Handle = fftw_plan;
    static constexpr auto plan = fftw_plan_guru_split_dft;
    static constexpr auto execute = fftw_execute_split_dft;
    static constexpr auto destroy_plan = fftw_destroy_plan;
    using Dimension = fftw_iodim;
};

}  // namespace

template <class T>
struct LineTransform<T>::Plan {
    typename Fftw<T>::Handle handle = nullptr;
    Plan() = default;
    Plan(const Plan&) = delete;
    Plan& operator=(const Plan&) = delete;
    ~Plan() {
        const std::lock_guard lock(planner());
        if (handle) Fftw<T>::destroy_plan(handle);
    }
};

PlannedBy::PlannedBy(Planning wanted) {
    plan_by(wanted);
}
PlannedBy::~PlannedBy() {
    plan_by(Planning::Recorded);
}

// FFTW's split-complex transforms have sign −1. Exchanging real and imaginary parts of input and output gives
// sign +1.
template <class T>
LineTransform<T>::LineTransform(int n, Parts parts) : n_(n), parts_(parts) {
    const std::size_t stride = line_stride<T>(n), imaginary = parts == Parts::Paired ? 1 : stride;
    Buffer<T> from(2 * stride), to(2 * stride);
    const int step = parts == Parts::Paired ? 2 : 1;
    const typename Fftw<T>::Dimension line{n, step, step};
    auto plan = std::make_shared<Plan>();
    {
        const std::lock_guard lock(planner());
        begin_planning();
        // Lengths without wisdom use FFTW's estimate, which is good for single 1-D transforms out of place: within
        // a fifth of its longest search. (For 2-D, strided or in-place transforms estimates are up to ten times
        // slower.)
        const unsigned flags = effort() | FFTW_PRESERVE_INPUT | (is_below_avx2() ? FFTW_NO_SIMD : 0U);
        plan->handle = Fftw<T>::plan(1, &line, 0, nullptr, from.data() + imaginary, from.data(),
                                     to.data() + imaginary, to.data(), flags);
    }
    if (!plan->handle) throw std::runtime_error("no transform for size " + std::to_string(n));
    plan_ = std::move(plan);
}

template <class T>
void LineTransform<T>::execute(const T* from, T* to) const {
    const std::size_t stride = line_stride<T>(n_);
    if (parts_ == Parts::Apart) {
        T* input = const_cast<T*>(from);  // FFTW's interface lacks const; the plan preserves its input
        Fftw<T>::execute(plan_->handle, input + stride, input, to + stride, to);
        return;
    }
    thread_local Buffer<T> pairs;  // before and after
    const auto n = static_cast<std::size_t>(n_);
    if (pairs.size() < 4 * stride) pairs = Buffer<T>(4 * stride);
    T *in = pairs.data(), *out = in + 2 * stride;
    for (std::size_t i = 0; i < n; ++i) {
        in[2 * i] = from[i];
        in[2 * i + 1] = from[stride + i];
    }
    Fftw<T>::execute(plan_->handle, in + 1, in, out + 1, out);
    for (std::size_t i = 0; i < n; ++i) {
        to[i] = out[2 * i];
        to[stride + i] = out[2 * i + 1];
    }
}

template class LineTransform<float>;
template class LineTransform<double>;

}  // namespace pelagic
