#include "core/waves/second_order.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "core/base/constants.h"
#include "core/plan/mode_lattice.h"
#include "core/waves/kernels.h"

namespace pelagic {
namespace {

constexpr int kGrain = 8;  // columns or rows of a task

template <class Work>
void for_each_index(int from, int to, Work&& work) {
    tbb::parallel_for(
        tbb::blocked_range<int>(from, to, kGrain),
        [&](const tbb::blocked_range<int>& range) { work(range.begin(), range.end()); },
        tbb::simple_partitioner());
}

// A line of complex numbers, and its transform.
template <class T>
struct Line {
    explicit Line(int n) : stride(line_stride<T>(n)), from(2 * stride), to(2 * stride) {}
    void clear() { std::fill_n(from.data(), 2 * stride, T(0)); }
    T* re() { return from.data(); }
    T* im() { return from.data() + stride; }
    const T* to_re() const { return to.data(); }
    const T* to_im() const { return to.data() + stride; }

    std::size_t stride;
    Buffer<T> from, to;
};

int wrapped(int m, int n) {
    return m < 0 ? m + n : m;
}

}  // namespace

template <class T>
SecondOrderWaves<T>::SecondOrderWaves(std::shared_ptr<const Sea<T>> sea, int cascade,
                                      LineTransform<T> transform)
    : sea_(std::move(sea)), cascade_(cascade), transform_(std::move(transform)) {
    const auto plane = [&](std::size_t columns) {
        const std::size_t samples = columns * static_cast<std::size_t>(plan().resolution);
        return Plane{Buffer<T>::uncleared(samples), Buffer<T>::uncleared(samples)};
    };
    for (int sum = 0; sum < plan().sums(); ++sum) sums_.push_back(plane(columns()));
    std::size_t modes = 0;
    for (int mx = 0; mx < reach(); ++mx) {
        first_.push_back(modes);
        modes += column_length(reach(), mx);
    }
    for (int result = 0; result < plan().results(); ++result) {
        results_.push_back(plane(static_cast<std::size_t>(reach())));
        modes_.push_back({std::vector<T>(modes), std::vector<T>(modes)});
    }
}

template <class T>
PairModes<T> SecondOrderWaves<T>::column(int mx) const {
    const std::size_t at = first_[static_cast<std::size_t>(mx)];
    PairModes<T> modes{half_height(reach(), mx), modes_[0].re.data() + at, modes_[0].im.data() + at};
    if (plan().moves) {
        modes.rate_re = modes_[1].re.data() + at;
        modes.rate_im = modes_[1].im.data() + at;
    }
    return modes;
}

template <class T>
long SecondOrderWaves<T>::set(double time_s) {
    for_each_index(0, radius(), [&](int from, int to) { sum_columns(from, to, time_s); });
    for_each_index(0, plan().resolution, [&](int from, int to) { pair_rows(from, to); });
    for_each_index(0, reach(), [&](int from, int to) { take_columns(from, to); });
    return plan().lines();
}

// The waves that travel along k have the amplitudes 2 h0(k) e^{−iωt}, for all k: those of a stored mode and those of −k, whose
// conjugate is stored with it.
template <class T>
void SecondOrderWaves<T>::sum_columns(int first_mx, int end_mx, double time_s) {
    const Cascade<T>& cascade = sea_->cascades()[cascade_];
    const Kernels<T> kernels = pelagic::kernels<T>();
    const int n = plan().resolution, r = radius(), sums = plan().sums();
    const int of_heights = plan().moves ? sums / 2 : sums;
    const double step = kTwoPi / cascade.size_m;
    const std::size_t longest = 2 * static_cast<std::size_t>(r) + 1;
    Buffer<T> height_re(longest), height_im(longest), rate_re(longest), rate_im(longest);
    struct {
        Buffer<T> re, im, rate_re, rate_im;
    } growing;  // by the amplitudes' own rates; empty where they stay
    if (plan().moves && !cascade.growth[0].empty())
        growing = {Buffer<T>(longest), Buffer<T>(longest), Buffer<T>(longest), Buffer<T>(longest)};
    std::vector<Line<T>> lines, mirrored;  // by sum: of column mx, and of −mx
    for (int sum = 0; sum < sums; ++sum) {
        lines.emplace_back(n);
        mirrored.emplace_back(n);
    }
    for (int mx = first_mx; mx < end_mx; ++mx) {
        const int height = half_height(r, mx);
        const std::size_t at = cascade.middle(mx) - static_cast<std::size_t>(height);
        kernels.advance({.forward_re = cascade.forward_re.data() + at,
                         .forward_im = cascade.forward_im.data() + at,
                         .backward_re = cascade.backward_re.data() + at,
                         .backward_im = cascade.backward_im.data() + at,
                         .cycles_per_s = cascade.cycles_per_s.data() + at,
                         .time_s = time_s,
                         .count = 2 * static_cast<std::size_t>(height) + 1,
                         .height_re = height_re.data(),
                         .height_im = height_im.data(),
                         .rate_re = rate_re.data(),
                         .rate_im = rate_im.data()});
        const bool grows = !growing.re.empty();
        if (grows)
            kernels.advance({.forward_re = cascade.growth[0].data() + at,
                             .forward_im = cascade.growth[1].data() + at,
                             .backward_re = cascade.growth[2].data() + at,
                             .backward_im = cascade.growth[3].data() + at,
                             .cycles_per_s = cascade.cycles_per_s.data() + at,
                             .time_s = time_s,
                             .count = 2 * static_cast<std::size_t>(height) + 1,
                             .height_re = growing.re.data(),
                             .height_im = growing.im.data(),
                             .rate_re = growing.rate_re.data(),
                             .rate_im = growing.rate_im.data()});
        for (int sum = 0; sum < sums; ++sum) {
            lines[sum].clear();
            mirrored[sum].clear();
        }
        for (int my = -height; my <= height; ++my) {
            if (mx == 0 && my == 0) continue;
            const std::size_t i = static_cast<std::size_t>(my + height);
            const double k = step * std::hypot(mx, my);
            const T omega = static_cast<T>(kTwoPi * cascade.cycles_per_s[at + i]);
            const T root = static_cast<T>(std::sqrt(k)), east = root * static_cast<T>(step * mx / k),
                    north = root * static_cast<T>(step * my / k);
            const T slow = plan().shallow > 0.0
                               ? static_cast<T>(std::sqrt(shallow_wavenumber(k, plan().depth_m)))
                               : T(0);
            const T turned_re = -rate_im[i] / omega, turned_im = rate_re[i] / omega;
            const auto put = [&](std::vector<Line<T>>& to, int row, T re, T im, T sign) {
                const int j = wrapped(row, n);
                const T weights[]{root, sign * east, sign * north, slow};
                for (int sum = 0; sum < of_heights; ++sum) {
                    to[sum].re()[j] = weights[sum] * re;
                    to[sum].im()[j] = weights[sum] * im;
                    if (!plan().moves) continue;
                    to[of_heights + sum].re()[j] = omega * weights[sum] * im;  // −iω
                    to[of_heights + sum].im()[j] = -omega * weights[sum] * re;
                }
            };
            put(lines, my, height_re[i] + turned_re, height_im[i] + turned_im, T(1));
            if (mx > 0) put(mirrored, -my, height_re[i] - turned_re, turned_im - height_im[i], T(-1));
            if (!grows) continue;
            const auto add = [&](std::vector<Line<T>>& to, int row, T re, T im, T sign) {
                const int j = wrapped(row, n);
                const T weights[]{root, sign * east, sign * north, slow};
                for (int sum = 0; sum < of_heights; ++sum) {
                    to[of_heights + sum].re()[j] += weights[sum] * re;
                    to[of_heights + sum].im()[j] += weights[sum] * im;
                }
            };
            const T later_re = -growing.rate_im[i] / omega, later_im = growing.rate_re[i] / omega;
            add(lines, my, growing.re[i] + later_re, growing.im[i] + later_im, T(1));
            if (mx > 0) add(mirrored, -my, growing.re[i] - later_re, later_im - growing.im[i], T(-1));
        }
        const auto transform = [&](Line<T>& line, Plane& plane, int column) {
            transform_.execute(line.from.data(), line.to.data());
            for (int y = 0; y < n; ++y) {
                const std::size_t to =
                    static_cast<std::size_t>(y) * columns() + static_cast<std::size_t>(r - 1 + column);
                plane.re[to] = line.to_re()[y];
                plane.im[to] = line.to_im()[y];
            }
        };
        for (int sum = 0; sum < sums; ++sum) {
            transform(lines[sum], sums_[sum], mx);
            if (mx > 0) transform(mirrored[sum], sums_[sum], -mx);
        }
    }
}

// From the sums along a row of places to what pairs add there, and along the row back to modes.
template <class T>
void SecondOrderWaves<T>::pair_rows(int first_y, int end_y) {
    const int n = plan().resolution, r = radius(), sums = plan().sums();
    const int of_heights = plan().moves ? sums / 2 : sums;
    std::vector<Line<T>> lines;
    for (int sum = 0; sum < sums; ++sum) lines.emplace_back(n);
    Line<T> added(n);
    const T difference = static_cast<T>(plan().difference), sum_of_two = static_cast<T>(plan().sum),
            shallow = static_cast<T>(plan().shallow);
    // By sum: of |F|², and of Re F².
    const T square[]{difference, difference, difference, T(0)};
    const T doubled[]{sum_of_two, -sum_of_two, -sum_of_two, shallow};
    for (int y = first_y; y < end_y; ++y) {
        const std::size_t row = static_cast<std::size_t>(y) * columns();
        for (int sum = 0; sum < sums; ++sum) {
            Line<T>& line = lines[sum];
            line.clear();
            for (int m = 1 - r; m < r; ++m) {
                const std::size_t at = row + static_cast<std::size_t>(m + r - 1);
                line.re()[wrapped(m, n)] = sums_[sum].re[at];
                line.im()[wrapped(m, n)] = sums_[sum].im[at];
            }
            transform_.execute(line.from.data(), line.to.data());
        }
        // The transform back has the other sign: of what is real, the conjugate.
        const auto take = [&](Line<T>& result, Plane& plane) {
            transform_.execute(result.from.data(), result.to.data());
            const std::size_t to = static_cast<std::size_t>(y) * reach();
            std::copy_n(result.to_re(), reach(), &plane.re[to]);
            for (int m = 0; m < reach(); ++m) plane.im[to + m] = -result.to_im()[m];
            result.clear();
        };
        for (int sum = 0; sum < of_heights; ++sum) {
            const T of_re = square[sum] + doubled[sum], of_im = square[sum] - doubled[sum];
            const T *re = lines[sum].to_re(), *im = lines[sum].to_im();
            for (int x = 0; x < n; ++x) added.re()[x] += of_re * re[x] * re[x] + of_im * im[x] * im[x];
        }
        take(added, results_[0]);
        if (!plan().moves) continue;
        for (int sum = 0; sum < of_heights; ++sum) {
            const T of_re = square[sum] + doubled[sum], of_im = square[sum] - doubled[sum];
            const T *re = lines[sum].to_re(), *im = lines[sum].to_im();
            const T *rate_re = lines[of_heights + sum].to_re(), *rate_im = lines[of_heights + sum].to_im();
            for (int x = 0; x < n; ++x)
                added.re()[x] += T(2) * (of_re * re[x] * rate_re[x] + of_im * im[x] * rate_im[x]);
        }
        take(added, results_[1]);
    }
}

// From columns of places to modes.
template <class T>
void SecondOrderWaves<T>::take_columns(int first_mx, int end_mx) {
    const int n = plan().resolution;
    const std::size_t r = static_cast<std::size_t>(reach());
    const T scale = T(1) / (static_cast<T>(n) * static_cast<T>(n));
    Line<T> line(n);
    for (int mx = first_mx; mx < end_mx; ++mx)
        for (std::size_t result = 0; result < results_.size(); ++result) {
            for (int y = 0; y < n; ++y) {
                const std::size_t at = static_cast<std::size_t>(y) * r + static_cast<std::size_t>(mx);
                line.re()[y] = results_[result].re[at];
                line.im()[y] = -results_[result].im[at];
            }
            transform_.execute(line.from.data(), line.to.data());
            const int height = half_height(reach(), mx);
            for (int my = -height; my <= height; ++my) {
                if (mx == 0 && my == 0) continue;  // the mean stays that of the waves themselves
                const std::size_t to =
                    first_[static_cast<std::size_t>(mx)] + static_cast<std::size_t>(my + height);
                modes_[result].re[to] = scale * line.to_re()[wrapped(my, n)];
                modes_[result].im[to] = -scale * line.to_im()[wrapped(my, n)];
            }
        }
}

template class SecondOrderWaves<float>;
template class SecondOrderWaves<double>;

}  // namespace pelagic
