#include "core/effects/spray.h"

#include <cmath>

#include "core/plan/spray.h"
#include "core/waves/whitecaps.h"

namespace pelagic {

template <class T>
double mean_breaking(const Sea<T>& sea) {
    if (!std::isfinite(sea.whitecap_threshold())) return 0.0;
    const SpectralMoments& whole = sea.total();
    const auto j = jacobian_moments<double>(0.0, 0.0, 0.0, 0.0,
                                            {whole.xxxx, whole.xxxy, whole.xxyy, whole.xyyy, whole.yyyy});
    const double mean = coverage(j, sea.whitecap_threshold(), sea.plan().knobs.third_moment);
    constexpr double kNone =
        1e-9;  // a square millimetre in a thousand square metres, as calibrated_threshold() has it
    return mean < kNone ? 0.0 : mean;
}

template <class T>
double spray_extinction_per_coverage(const Sea<T>& sea) {
    const double mean = mean_breaking(sea);
    return mean > 0.0 ? spray_law(sea.plan().from->scene).extinction_per_m / mean : 0.0;
}

template double mean_breaking(const Sea<float>&);
template double mean_breaking(const Sea<double>&);
template double spray_extinction_per_coverage(const Sea<float>&);
template double spray_extinction_per_coverage(const Sea<double>&);

}  // namespace pelagic
