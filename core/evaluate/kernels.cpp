#include "core/evaluate/kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/evaluate/kernels.cpp"
#include <hwy/foreach_target.h>
// foreach_target first: it includes this file once for each instruction set.
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/pack-inl.h"
#include "core/evaluate/grids-inl.h"
#include "core/plan/random_tiling.h"

HWY_BEFORE_NAMESPACE();
namespace pelagic {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace {  // names are this file's own

#include "core/evaluate/surface.inl"
// After surface.inl, of which it is made.
#include "core/evaluate/rest_normal.inl"
#include "core/plan/filter.inl"
#include "core/waves/whitecaps.inl"
// After filter.inl, of which it is made.
#include "core/plan/random_tiling.inl"

// Along one axis, in double.
template <class T>
void PlaceTiles(const TilingAxisArgs& args, const T* rest_m, std::size_t count, TilingAxis<T>& axis) {
    const hn::ScalableTag<double> dd;
    using Wide = decltype(dd);
    const hn::Rebind<T, Wide> narrow;
    const hn::Rebind<hwy::MakeSigned<T>, Wide> index;
    const auto scale = hn::Set(dd, args.cells_per_m), origin = hn::Set(dd, args.origin_from_middle);
    const auto half = hn::Set(dd, 0.5), most = hn::Set(dd, kFarthestCell);
    for (std::size_t i = 0; i < count; i += hn::Lanes(dd)) {
        auto cells = hn::MulAdd(grids_detail::Widen(dd, rest_m + i), scale, origin);
        cells = hn::IfThenElseZero(hn::Lt(hn::Abs(cells), most), cells);  // no number, or no place
        const auto cell = hn::Floor(hn::Add(cells, half));
        hn::StoreU(grids_detail::Index(dd, cell, T()), index, axis.code.data() + i);
        hn::StoreU(grids_detail::Narrow(dd, hn::Sub(cells, cell), T()), narrow, axis.rate.data() + i);
    }
    const hn::ScalableTag<T> d;
    using N = Pack<decltype(d)>;
    const hn::RebindToSigned<decltype(d)> di;
    const auto per_m = hn::Set(d, static_cast<T>(args.cells_per_m)), none = hn::Zero(d);
    for (std::size_t i = 0; i < count; i += hn::Lanes(d)) {
        const auto from_middle = hn::LoadU(d, axis.rate.data() + i);
        const BlendWeights<N> weights = blend_weights(N(hn::Abs(from_middle)));
        const auto side =
            hn::IfThenElse(hn::RebindMask(di, hn::Lt(from_middle, none)), hn::Set(di, 3), hn::Set(di, 1));
        const auto shown = hn::IfThenElseZero(hn::RebindMask(di, hn::Gt(weights.next.v, none)), side);
        const auto cell = hn::LoadU(di, axis.code.data() + i);
        hn::StoreU(hn::Add(hn::ShiftLeft<2>(cell), shown), di, axis.code.data() + i);
        hn::StoreU(weights.own.v, d, axis.own.data() + i);
        hn::StoreU(weights.next.v, d, axis.next.data() + i);
        hn::StoreU(hn::CopySignToAbs(hn::Mul(weights.rate.v, per_m), from_middle), d, axis.rate.data() + i);
    }
}

template <class T>
ChunkSpan<T> SpanOf(const Chunk<T>& chunk) {
    const hn::ScalableTag<T> d;
    const std::size_t lanes = hn::Lanes(d);
    ChunkSpan<T> span;
    const auto along = [&](const T* at, T& low, T& high) HWY_ATTR {
        low = high = at[0];
        T none = T(0);  // no number as soon as one isn't, or is infinite
        std::size_t i = 0;
        if (chunk.count >= lanes) {
            auto least = hn::LoadU(d, at), most = least, nones = hn::Mul(least, hn::Zero(d));
            for (i = lanes; i + lanes <= chunk.count; i += lanes) {
                const auto here = hn::LoadU(d, at + i);
                least = hn::Min(least, here);
                most = hn::Max(most, here);
                nones = hn::MulAdd(here, hn::Zero(d), nones);
            }
            none = hn::GetLane(hn::SumOfLanes(d, nones));
            low = hn::GetLane(hn::MinOfLanes(d, least));
            high = hn::GetLane(hn::MaxOfLanes(d, most));
        }
        for (; i < chunk.count; ++i) {
            low = std::min(low, at[i]);
            high = std::max(high, at[i]);
            none += at[i] * T(0);
        }
        span.is_finite = span.is_finite && none == T(0);
    };
    along(chunk.rest_x.data(), span.low_x, span.high_x);
    along(chunk.rest_y.data(), span.low_y, span.high_y);
    return span;
}

// Writes those points of a vector that exist.
template <class D, class T = hn::TFromD<D>>
HWY_INLINE void Put(D d, const Strided<glm::vec<3, T>>& out, std::size_t i, std::size_t count,
                    const std::array<Pack<D>, 3>& value) {
    const std::size_t lanes = hn::Lanes(d);
    if (out.stride_bytes == 3 * sizeof(T) && i + lanes <= count) {
        hn::StoreInterleaved3(value[0].v, value[1].v, value[2].v, d, &out[i].x);
        return;
    }
    alignas(64) T axis[3][64 / sizeof(T)];
    for (int a = 0; a < 3; ++a) hn::Store(value[a].v, d, axis[a]);
    for (std::size_t j = 0; j < std::min(lanes, count - i); ++j)
        out[i + j] = glm::vec<3, T>(axis[0][j], axis[1][j], axis[2][j]);
}
template <class D, class T = hn::TFromD<D>>
HWY_INLINE void Put(D d, const Strided<T>& out, std::size_t i, std::size_t count, Pack<D> value) {
    const std::size_t lanes = hn::Lanes(d);
    if (out.stride_bytes == sizeof(T) && i + lanes <= count) {
        hn::StoreU(value.v, d, &out[i]);
        return;
    }
    alignas(64) T values[64 / sizeof(T)];
    hn::Store(value.v, d, values);
    for (std::size_t j = 0; j < std::min(lanes, count - i); ++j) out[i + j] = values[j];
}

// What a chunk's pixels leave unresolved, as vectors: by point, or the same for all.
template <class T>
class Unresolved {
  public:
    using D = hn::ScalableTag<T>;
    using N = Pack<D>;
    HWY_INLINE explicit Unresolved(const DeriveArgs<T>& args) : args_(args) {
        if (args.unresolved_of) return;
        const UnresolvedGradients<N> gradient = gradients_at(0);
        const GradientTraces<N> traces = gradient_traces(gradient);
        hn::Store(traces.second.v, D(), second_);
        hn::Store(traces.third.v, D(), third_);
    }
    HWY_INLINE N moment_at(std::size_t moment, std::size_t i) const {
        return args_.unresolved_of ? N(hn::LoadU(D(), args_.unresolved_of->moments[moment].data() + i))
                                   : N(args_.unresolved[moment]);
    }
    HWY_INLINE UnresolvedGradients<N> gradients_at(std::size_t i) const {
        return {moment_at(kUnresolvedSlopes, i), moment_at(kUnresolvedSlopes + 1, i),
                moment_at(kUnresolvedSlopes + 2, i), moment_at(kUnresolvedSlopes + 3, i),
                moment_at(kUnresolvedSlopes + 4, i)};
    }
    HWY_INLINE GradientTraces<N> traces_of(const UnresolvedGradients<N>& gradient) const {
        if (args_.unresolved_of) return gradient_traces(gradient);
        return {N(hn::Load(D(), second_)), N(hn::Load(D(), third_))};
    }

  private:
    const DeriveArgs<T>& args_;
    alignas(64) T second_[64 / sizeof(T)], third_[64 / sizeof(T)];
};

// J in a chunk's pixels, and the coverage that follows. These are two loops because the second is one long chain of
// operations, and a CPU overlaps more of them when they stand alone.
template <class T>
void DeriveWhitecaps(const DeriveArgs<T>& args) {
    using D = hn::ScalableTag<T>;
    using N = Pack<D>;
    const D d;
    const Chunk<T>& chunk = *args.chunk;
    const Unresolved<T> unresolved(args);
    const auto moments = args.results.vectors(Product::JacobianMoments);
    const auto foam = args.results.numbers(Product::Breaking);
    alignas(64) typename Chunk<T>::Values mean, variance, third;
    for (std::size_t i = 0; i < chunk.count; i += hn::Lanes(d)) {
        const auto at = [&](Field field) HWY_ATTR {
            return N(hn::LoadU(d, args.breaking->sums[index(field)].data() + i));
        };
        const UnresolvedGradients<N> gradient = unresolved.gradients_at(i);
        const JacobianMoments<N> j =
            jacobian_moments(at(Field::Dxx), at(Field::Dyy), at(Field::Dxy),
                             at(Field::Dxy) + N(hn::LoadU(d, args.breaking->turn.data() + i)), gradient,
                             unresolved.traces_of(gradient));
        if (moments) Put(d, moments, i, chunk.count, std::array<N, 3>{j.mean, j.variance, j.third});
        hn::StoreU(j.mean.v, d, mean.data() + i);
        hn::StoreU(j.variance.v, d, variance.data() + i);
        hn::StoreU(j.third.v, d, third.data() + i);
    }
    if (!foam) return;
    const auto cover = [&](const auto& threshold_at) HWY_ATTR {
        for (std::size_t i = 0; i < chunk.count; i += hn::Lanes(d)) {
            const JacobianMoments<N> j{N(hn::LoadU(d, mean.data() + i)), N(hn::LoadU(d, variance.data() + i)),
                                       N(hn::LoadU(d, third.data() + i))};
            Put(d, foam, i, chunk.count, coverage(j, threshold_at(i), args.third_moment));
        }
    };
    if (const T* of = args.whitecap_threshold_of)
        cover([&](std::size_t i) HWY_ATTR { return N(hn::LoadU(d, of + i)); });
    else
        cover([&](std::size_t) HWY_ATTR { return N(args.whitecap_threshold); });
}

// Normals where the surface at rest has its own.
template <class T>
void DeriveNormalsOn(const DeriveArgs<T>& args) {
    using D = hn::ScalableTag<T>;
    using N = Pack<D>;
    const D d;
    const Chunk<T>& chunk = *args.chunk;
    const auto out = args.results.vectors(Product::Normal);
    if (!out) return;
    alignas(64) typename Chunk<T>::Values x{}, y{}, z{};
    for (std::size_t i = 0; i < chunk.count; ++i) {
        const glm::vec<3, T> normal = args.rest_normal[i];
        x[i] = normal.x, y[i] = normal.y, z[i] = normal.z;
    }
    for (std::size_t i = 0; i < chunk.count; i += hn::Lanes(d)) {
        const auto at = [&](Field field)
                            HWY_ATTR { return N(hn::LoadU(d, chunk.sums[index(field)].data() + i)); };
        const SurfaceNormal<N> rest(N(hn::LoadU(d, x.data() + i)), N(hn::LoadU(d, y.data() + i)),
                                    N(hn::LoadU(d, z.data() + i)));
        const SurfaceNormal<N> normal =
            normal_on(rest, at(Field::SlopeX), at(Field::SlopeY), at(Field::Dxx), at(Field::Dyy),
                      at(Field::Dxy), at(Field::Dxy) + N(hn::LoadU(d, chunk.turn.data() + i)));
        Put(d, out, i, chunk.count, std::array<N, 3>{normal.x, normal.y, normal.z});
    }
}

template <class T>
void Derive(const DeriveArgs<T>& args) {
    using D = hn::ScalableTag<T>;
    using N = Pack<D>;
    const D d;
    const Chunk<T>& chunk = *args.chunk;
    const Results<T>& results = args.results;
    const std::size_t count = chunk.count;
    const auto at = [&](Field field, std::size_t i)
                        HWY_ATTR { return N(hn::LoadU(d, chunk.sums[index(field)].data() + i)); };
    const auto dyx = [&](std::size_t i)
                         HWY_ATTR { return at(Field::Dxy, i) + N(hn::LoadU(d, chunk.turn.data() + i)); };
    using Vector = std::array<N, 3>;
    const auto each = [&](const Strided<glm::vec<3, T>>& out, const auto& value) HWY_ATTR {
        if (!out) return;
        for (std::size_t i = 0; i < count; i += hn::Lanes(d)) Put(d, out, i, count, value(i));
    };
    each(results.vectors(Product::Displacement), [&](std::size_t i) HWY_ATTR {
        return Vector{at(Field::Dx, i), at(Field::Dy, i), at(Field::Height, i)};
    });
    each(results.vectors(Product::Position), [&](std::size_t i) HWY_ATTR {
        return Vector{at(Field::Dx, i) + N(hn::LoadU(d, chunk.rest_x.data() + i)),
                      at(Field::Dy, i) + N(hn::LoadU(d, chunk.rest_y.data() + i)), at(Field::Height, i)};
    });
    each(results.vectors(Product::Velocity), [&](std::size_t i) HWY_ATTR {
        return Vector{at(Field::VelocityX, i), at(Field::VelocityY, i), at(Field::VelocityZ, i)};
    });
    if (args.rest_normal)
        DeriveNormalsOn(args);
    else
        each(results.vectors(Product::Normal), [&](std::size_t i) HWY_ATTR {
            const SurfaceNormal<N> normal =
                surface_normal(at(Field::SlopeX, i), at(Field::SlopeY, i), at(Field::Dxx, i),
                               at(Field::Dyy, i), at(Field::Dxy, i), dyx(i));
            return Vector{normal.x, normal.y, normal.z};
        });
    const Unresolved<T> unresolved(args);
    const auto at_rest = [&](std::size_t i) HWY_ATTR {
        return SlopeVariances<N>{unresolved.moment_at(0, i), unresolved.moment_at(2, i),
                                 unresolved.moment_at(1, i)};
    };
    each(results.vectors(Product::SlopeVariance), [&](std::size_t i) HWY_ATTR {
        const SlopeVariances<N> carried =
            carried_slopes(at_rest(i), at(Field::Dxx, i), at(Field::Dyy, i), at(Field::Dxy, i), dyx(i));
        return Vector{carried.xx, carried.yy, carried.xy};
    });
    each(results.vectors(Product::SlopeVarianceAtRest), [&](std::size_t i) HWY_ATTR {
        const SlopeVariances<N> rest = at_rest(i);
        return Vector{rest.xx, rest.yy, rest.xy};
    });
    if (results.holds(Product::JacobianMoments) || results.holds(Product::Breaking)) DeriveWhitecaps(args);
}

template <class T>
EvaluateKernels<T> Table() {
    return {&grids_detail::AddGrid<T>, &Derive<T>, &SpanOf<T>, &PlaceTiles<T>};
}
std::pair<EvaluateKernels<float>, EvaluateKernels<double>> Tables() {
    return {Table<float>(), Table<double>()};
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace pelagic
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelagic {
HWY_EXPORT(Tables);

template <class T>
EvaluateKernels<T> evaluate_kernels() {
    return std::get<EvaluateKernels<T>>(HWY_DYNAMIC_DISPATCH(Tables)());
}
template EvaluateKernels<float> evaluate_kernels();
template EvaluateKernels<double> evaluate_kernels();

}  // namespace pelagic
#endif
