#include "plugin/host/procedural/tile_kernels.h"

#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "plugin/host/procedural/tile_kernels.cpp"
#include <hwy/foreach_target.h>
// foreach_target first: it includes this file once for each instruction set.
#include <hwy/highway.h>

#include "core/base/pack-inl.h"

HWY_BEFORE_NAMESPACE();
namespace pelagic::procedural {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace {  // names are this file's own

using D = hn::CappedTag<float, kTileCells>;
using N = pelagic::HWY_NAMESPACE::Pack<D>;

// Along the ray: x and y are 0 on it, z is the distance.
struct Sheared {
    alignas(64) float x[kTileRoom], y[kTileRoom], z[kTileRoom];
};

struct Corner {
    N x, y, z;
};
HWY_INLINE Corner CornerAt(const Sheared& points, int i) {
    const D d;
    return {hn::LoadU(d, points.x + i), hn::LoadU(d, points.y + i), hn::LoadU(d, points.z + i)};
}
// Twice the area of the triangle between the ray and an edge, exactly opposite for the opposite edge; and how much of
// it may be the rounding of the points.
struct Edge {
    N area, slack;
};
HWY_INLINE Edge EdgeOf(const Corner& a, const Corner& b, N rounding) {
    return {a.x * b.y - a.y * b.x, rounding * (magnitude(a.x - b.x) + magnitude(a.y - b.y))};
}
HWY_INLINE Edge Opposite(const Edge& edge) {
    return {-edge.area, edge.slack};
}

struct Best {
    N distance, x, y;
};

// A corner with the edge across from it, and its place in the cell.
struct Weighted {
    Edge across;
    const Corner& corner;
    float x, y;
};
HWY_INLINE void Take(const Weighted& a, const Weighted& b, const Weighted& c, N column, N near, N rounding,
                     Best& best) {
    const N area = a.across.area + b.across.area + c.across.area;
    const auto is_behind = area < N(0);
    const auto turned = [&](N w) HWY_ATTR { return select<D>(is_behind, -w, w); };
    const N wa = turned(a.across.area), wb = turned(b.across.area), wc = turned(c.across.area);
    const N inside = minimum(minimum(wa + a.across.slack, wb + b.across.slack), wc + c.across.slack);
    const N ia = maximum(wa, N(0)), ib = maximum(wb, N(0)), ic = maximum(wc, N(0)), sum = ia + ib + ic;
    auto is_hit = hn::And(hn::Ge(inside.v, hn::Zero(D())), sum > N(0));
    if (hn::AllFalse(D(), is_hit)) return;
    const N per = N(1) / select<D>(is_hit, sum, N(1));
    // Beyond a sharp corner, or where a triangle seen edge-on has hardly any weights, the place isn't on the ray.
    const N off = maximum(magnitude(ia * a.corner.x + ib * b.corner.x + ic * c.corner.x),
                          magnitude(ia * a.corner.y + ib * b.corner.y + ic * c.corner.y));
    is_hit = hn::And(is_hit, off * per < N(4) * rounding);
    const N distance = (ia * a.corner.z + ib * b.corner.z + ic * c.corner.z) * per;
    const auto is_nearer = hn::And(is_hit, hn::And(hn::Ge(distance.v, near.v), distance < best.distance));
    best.distance = select<D>(is_nearer, distance, best.distance);
    best.x = select<D>(is_nearer, column + (ia * N(a.x) + ib * N(b.x) + ic * N(c.x)) * per, best.x);
    best.y = select<D>(is_nearer, (ia * N(a.y) + ib * N(b.y) + ic * N(c.y)) * per, best.y);
}

// Woop, Benthin, Wald 2013: in axes along the ray, edges of neighbours are tested by the same numbers.
void Shear(const TilePoints& points, const TileRay& ray, Sheared& to) {
    const D d;
    const glm::vec3 far(std::abs(ray.direction.x), std::abs(ray.direction.y), std::abs(ray.direction.z));
    const int along = far.x > far.y ? (far.x > far.z ? 0 : 2) : (far.y > far.z ? 1 : 2);
    const int u = (along + 1) % 3, v = (along + 2) % 3;
    const float per = 1.0f / ray.direction[along];
    const N shear_u(ray.direction[u] * per), shear_v(ray.direction[v] * per), scale(per);
    const bool moves = points.velocity_mps[0] != nullptr;
    const auto at = [&](int axis, int i) HWY_ATTR {
        const N place = N(hn::LoadU(d, points.at_m[axis] + i)) - N(ray.from_m[axis]);
        return moves ? place + N(ray.time_s) * N(hn::LoadU(d, points.velocity_mps[axis] + i)) : place;
    };
    const int lanes = static_cast<int>(hn::Lanes(d));
    for (int i = 0; i < kTilePoints; i += lanes) {
        const N z = at(along, i);
        hn::Store((at(u, i) - shear_u * z).v, d, to.x + i);
        hn::Store((at(v, i) - shear_v * z).v, d, to.y + i);
        hn::Store((z * scale).v, d, to.z + i);
    }
}

bool Nearest(const TilePoints& points, const TileRay& ray, TileHit& hit) {
    const D d;
    Sheared sheared;
    Shear(points, ray, sheared);
    const N near(ray.near), rounding(ray.rounding_m);
    const int lanes = static_cast<int>(hn::Lanes(d));
    float found = ray.far;
    for (int row = 0; row < kTileCells; ++row)
        for (int column = 0; column < kTileCells; column += lanes) {
            const int i = row * kTileRow + column;
            const Corner a = CornerAt(sheared, i), b = CornerAt(sheared, i + 1),
                         c = CornerAt(sheared, i + kTileRow + 1), e = CornerAt(sheared, i + kTileRow);
            const auto edge = [&](const Corner& from, const Corner& to)
                                  HWY_ATTR { return EdgeOf(from, to, rounding); };
            const Edge diagonal = edge(a, c);
            Best best{N(found), N(0), N(0)};
            const N columns = N(hn::Iota(d, static_cast<float>(column)));
            Take({edge(c, b), a, 0, 0}, {diagonal, b, 1, 0}, {edge(b, a), c, 1, 1}, columns, near, rounding,
                 best);
            Take({edge(e, c), a, 0, 0}, {edge(a, e), c, 1, 1}, {Opposite(diagonal), e, 0, 1}, columns, near,
                 rounding, best);
            const float nearest = hn::GetLane(hn::MinOfLanes(d, best.distance.v));
            if (!(nearest < found)) continue;
            found = nearest;
            const auto first =
                static_cast<std::size_t>(hn::FindFirstTrue(d, hn::Eq(best.distance.v, hn::Set(d, nearest))));
            hit = {nearest, hn::ExtractLane(best.x.v, first),
                   static_cast<float>(row) + hn::ExtractLane(best.y.v, first)};
        }
    return found < ray.far;
}

void Enter(const TileQuarters& boxes, const QuartersRay& ray, QuartersEntered& entered) {
    const hn::CappedTag<double, 4> d;
    const hn::Rebind<float, decltype(d)> floats;
    const auto widening = hn::Set(d, ray.widening_m);
    for (std::size_t q = 0; q < 4; q += hn::Lanes(d)) {
        auto near = hn::Set(d, ray.near_m), far = hn::Set(d, ray.far_m);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto at = static_cast<glm::length_t>(axis);
            const auto from = hn::Set(d, ray.from_m[at]), per = hn::Set(d, ray.per_direction[at]);
            const auto low = hn::PromoteTo(d, hn::LoadU(floats, &boxes.low_m[axis][q]));
            const auto high = hn::PromoteTo(d, hn::LoadU(floats, &boxes.high_m[axis][q]));
            const auto a = hn::Mul(hn::Sub(hn::Sub(low, widening), from), per);
            const auto b = hn::Mul(hn::Sub(hn::Add(high, widening), from), per);
            near = hn::Max(near, hn::Min(a, b));
            far = hn::Min(far, hn::Max(a, b));
        }
        hn::StoreU(near, d, &entered.near_m[q]);
        hn::StoreU(far, d, &entered.far_m[q]);
    }
}

NearestInTile NearestHere() {
    return &Nearest;
}
EnterQuarters EnterHere() {
    return &Enter;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace pelagic::procedural
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace pelagic::procedural {
HWY_EXPORT(NearestHere);
HWY_EXPORT(EnterHere);

NearestInTile nearest_in_tile() {
    return HWY_DYNAMIC_DISPATCH(NearestHere)();
}
EnterQuarters enter_quarters() {
    return HWY_DYNAMIC_DISPATCH(EnterHere)();
}

}  // namespace pelagic::procedural
#endif
