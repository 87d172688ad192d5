#include "tests/bench/fftw.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <numeric>
#include <stdexcept>

#include "core/plan/grid_layout.h"

namespace pelagic::bench {
namespace {

constexpr int kPadding = 16;  // complex values: two cache lines, against strides that are powers of two
constexpr double kPatience_s = 30.0;  // at most, for each plan

struct Initialised {
    Initialised() { fftwf_init_threads(); }
};

}  // namespace

std::string Arrangement::name() const {
    return std::string(two_in_one ? "two in one complex" : "one real each") +
           (in_place ? ", in place" : ", out of place") + (padding ? ", rows padded" : "") +
           (split ? ", each split over the threads" : "");
}

BareFftw::BareFftw(int n, int fields)
    : n_(n),
      fields_(fields),
      slot_(2 * static_cast<std::size_t>(n) * (static_cast<std::size_t>(n) + 3 * kPadding)),
      // Of an odd number of fields the last has a complex transform to itself.
      from_(slot_ * static_cast<std::size_t>((fields + 1) / 2)),
      to_(slot_ * static_cast<std::size_t>((fields + 1) / 2)) {
    static const Initialised once;
}

BareFftw::Handle BareFftw::planned(const Arrangement& a, int threads, unsigned flag) {
    fftwf_plan_with_nthreads(a.split ? threads : 1);
    fftwf_set_timelimit(kPatience_s);
    const int size[2] = {n_, n_};
    auto* from = reinterpret_cast<fftwf_complex*>(from_.data());
    float* to = a.in_place ? from_.data() : to_.data();
    const auto start = std::chrono::steady_clock::now();
    fftwf_plan plan;
    if (a.two_in_one) {
        const int rows[2] = {n_, n_ + a.padding};
        plan = fftwf_plan_many_dft(2, size, 1, from, rows, 1, 0, reinterpret_cast<fftwf_complex*>(to), rows,
                                   1, 0, FFTW_BACKWARD, flag);
    } else {
        const int half[2] = {n_, n_ / 2 + 1 + a.padding};
        const int real[2] = {n_, a.in_place ? 2 * half[1] : n_ + 2 * a.padding};
        plan = fftwf_plan_many_dft_c2r(2, size, 1, from, half, 1, 0, to, real, 1, 0, flag);
    }
    if (!plan) throw std::runtime_error("FFTW has no plan for " + a.name());
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
    // FFTW plans with rising patience and keeps the last that it finished in time.
    std::string planning = flag == FFTW_PATIENT ? "PATIENT" : "MEASURE";
    if (spent.count() >= kPatience_s) planning += " until stopped";
    return Handle(new Planned{a, planning, plan}, Destroy());
}

void BareFftw::run(const Planned& p) {
    const auto transform = [&](int first) {
        float* from = from_.data() + slot_ * static_cast<std::size_t>(first) / 2;
        float* to = p.arrangement.in_place ? from : to_.data() + slot_ * static_cast<std::size_t>(first) / 2;
        if (p.arrangement.two_in_one)
            fftwf_execute_dft(p.plan, reinterpret_cast<fftwf_complex*>(from),
                              reinterpret_cast<fftwf_complex*>(to));
        else
            fftwf_execute_dft_c2r(p.plan, reinterpret_cast<fftwf_complex*>(from), to);
    };
    const int step = p.arrangement.two_in_one ? 2 : 1;
    if (p.arrangement.split) {
        for (int field = 0; field < fields_; field += step) transform(field);
    } else {
        tbb::parallel_for(
            tbb::blocked_range<int>(0, (fields_ + step - 1) / step, 1),
            [&](const tbb::blocked_range<int>& range) {
                for (int i = range.begin(); i < range.end(); ++i) transform(i * step);
            },
            tbb::simple_partitioner());
    }
}

Timed BareFftw::timed(const Handle& handle) {
    return {handle->arrangement.name() + "; " + handle->planning, [this, handle] { run(*handle); }};
}

std::vector<Timed> BareFftw::fastest(int threads) {
    const auto is_known = [&](const Arrangement& a) {
        return std::any_of(measured_.begin(), measured_.end(),
                           [&](const Handle& h) { return h->arrangement == a; });
    };
    for (const bool split : {false, true})
        for (const bool two_in_one : {true, false})
            for (const bool in_place : {true, false})
                for (const int padding : {0, kPadding}) {
                    const Arrangement a{two_in_one, in_place, padding, split};
                    if ((split && threads == 1) || (n_ > 1024 && padding == 0) ||
                        (n_ > 2048 && (split || !in_place)) || is_known(a))
                        continue;
                    measured_.push_back(planned(a, threads, FFTW_MEASURE));
                }
    std::vector<Handle> usable;
    for (const Handle& handle : measured_)
        if (!handle->arrangement.split || threads > 1) usable.push_back(handle);
    std::vector<Timed> contest;
    for (const Handle& handle : usable) contest.push_back(timed(handle));
    interleave(contest, 5);
    std::vector<std::size_t> order(contest.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return contest[a].least() < contest[b].least(); });
    std::vector<Timed> best{timed(usable[order[0]]), timed(usable[order[1]])};
    if (n_ <= 1024) {
        const Arrangement& first = usable[order[0]]->arrangement;
        auto found = std::find_if(patient_.begin(), patient_.end(),
                                  [&](const Handle& h) { return h->arrangement == first; });
        if (found == patient_.end())
            found = patient_.insert(patient_.end(), planned(first, threads, FFTW_PATIENT));
        best.push_back(timed(*found));
    }
    fftwf_set_timelimit(FFTW_NO_TIMELIMIT);
    fftwf_plan_with_nthreads(1);
    only_recorded_plans();
    return best;
}

void learn_lines(int n) {
    const std::size_t stride = line_stride<float>(n);
    Buffer<float> from(2 * stride), to(2 * stride);
    const fftwf_iodim line{n, 1, 1};
    fftwf_destroy_plan(fftwf_plan_guru_split_dft(1, &line, 0, nullptr, from.data() + stride, from.data(),
                                                 to.data() + stride, to.data(),
                                                 FFTW_PATIENT | FFTW_PRESERVE_INPUT));
}

}  // namespace pelagic::bench
