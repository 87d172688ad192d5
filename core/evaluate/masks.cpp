#include "core/evaluate/masks.h"

#include <algorithm>

namespace pelagic {

template <class T>
bool MaskChunk<T>::take(const MasksPlan& plan, std::span<const WakeStrip> strips, glm::dvec2 origin_m,
                        const Chunk<T>& chunk) {
    const std::size_t padded = chunk.padded();
    for (Values* ones : {&waves, &ripples, &foam}) std::fill_n(ones->begin(), padded, T(1));
    for (Values* zeros : {&x, &y}) std::fill_n(zeros->begin(), padded, T(0));
    has_edges = has_ripples = false;
    bool any = false;
    for (const MasksPlan::Mask& mask : plan.masks) {
        const glm::vec<2, T> from(origin_m - mask.middle_m), along(mask.along), inner(mask.inner_per_m),
            outer(mask.outer_per_m), cells(mask.cells_per_m);
        const T reach = static_cast<T>(mask.reach_m), whole = static_cast<T>(mask.whole),
                all = static_cast<T>(mask.waves), short_ones = static_cast<T>(mask.ripples),
                foamy = static_cast<T>(mask.foam);
        for (std::size_t i = 0; i < chunk.count; ++i) {
            const T east = from.x + chunk.rest_x[i], north = from.y + chunk.rest_y[i];
            if (!(east * east + north * north < reach * reach)) continue;  // also where it is no number
            any = true;
            const MaskGains<T> before{waves[i], x[i], y[i], ripples[i], foam[i]};
            const MaskGains<T> at =
                mask.cells
                    ? with_share(before,
                                 picture_share(*mask.cells, east * along.x + north * along.y,
                                               north * along.x - east * along.y, cells.x, cells.y, whole),
                                 along.x, along.y, all, short_ones, foamy)
                    : with_mask(before, east, north, along.x, along.y, inner.x, inner.y, outer.x, outer.y,
                                all, short_ones, foamy);
            waves[i] = at.waves;
            x[i] = at.x;
            y[i] = at.y;
            ripples[i] = at.ripples;
            foam[i] = at.foam;
            has_edges = has_edges || at.x != T(0) || at.y != T(0);
            has_ripples = has_ripples || at.ripples != T(1);
        }
    }
    if (!plan.has_strips) return any;
    for (const WakeStrip& strip : strips)
        strip.for_each(
            WakeStrip::Wanted::Calm, chunk.count,
            [&](std::size_t i) { return origin_m + glm::dvec2(chunk.rest_x[i], chunk.rest_y[i]); },
            [](std::size_t) { return kSlick_m; },
            [&](std::size_t i, const WakeWater<double>& water) {
                const T calm = static_cast<T>(water.calm);
                if (!(calm > T(0))) return;
                ripples[i] *= T(1) - calm;
                any = has_ripples = true;
            });
    return any;
}

template <class T>
void mask_sums(const MaskChunk<T>& masks, const Chunk<T>& values, Chunk<T>& chunk) {
    const auto of = [](auto& sums, Field field) { return sums.sums[index(field)].data(); };
    const std::size_t count = chunk.count;
    if (masks.has_edges) {
        // ∂Dy/∂x − ∂Dx/∂y, before the gain: Dxy changes below.
        const T *east = of(values, Field::Dx), *north = of(values, Field::Dy);
        for (std::size_t i = 0; i < count; ++i)
            chunk.turn[i] = masks.waves[i] * chunk.turn[i] + (north[i] * masks.x[i] - east[i] * masks.y[i]);
        for (const Gradient& gradient : kGradients) {
            T* to = of(chunk, gradient.derivative);
            const T *value = of(values, gradient.of),
                    *rate = gradient.along_y ? masks.y.data() : masks.x.data();
            for (std::size_t i = 0; i < count; ++i)
                to[i] = masked_slope(to[i], value[i], masks.waves[i], rate[i]);
        }
    } else {
        for (std::size_t i = 0; i < count; ++i) chunk.turn[i] *= masks.waves[i];
        for (const Gradient& gradient : kGradients) {
            T* to = of(chunk, gradient.derivative);
            for (std::size_t i = 0; i < count; ++i) to[i] *= masks.waves[i];
        }
    }
    for (std::size_t f = 0; f < kFieldCount; ++f) {
        if (!cell_fields()[f]) continue;
        for (std::size_t i = 0; i < count; ++i) chunk.sums[f][i] *= masks.waves[i];
    }
}

template struct MaskChunk<float>;
template struct MaskChunk<double>;
template void mask_sums(const MaskChunk<float>&, const Chunk<float>&, Chunk<float>&);
template void mask_sums(const MaskChunk<double>&, const Chunk<double>&, Chunk<double>&);

}  // namespace pelagic
