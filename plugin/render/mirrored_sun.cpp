#include "plugin/render/mirrored_sun.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <utility>

#include "core/lighting/floor.h"

namespace pelagic {
namespace {

constexpr int kMostSide = 256;         // texels of a plane
constexpr double kMostMirrored = 0.5;  // margin over a plane's side
constexpr double kTexelsAWay = 128.0;  // of the way of the light: its net has lines some texels wide
// By how much planes are farther up, one over the other: by eye, as is the least height of one, over which light has hardly gathered.
constexpr double kRise = 1.3, kLowest_m = 0.1, kOfHighest = 1.0 / 64.0;

glm::dvec2 left_of(const glm::dvec2& along) {
    return {-along.y, along.x};
}
glm::dvec2 turned(const glm::dvec2& place, const glm::dvec2& along) {
    return {glm::dot(place, along), glm::dot(place, left_of(along))};
}

// Steps of one ladder over the water for all bodies: where one heaves, the planes that it needs stay as they are, and its pattern doesn't jump.
// Only what is lower than a 64th of a body's top has its first plane, which may be another when that top has risen by kRise.
std::vector<double> heights_m(double bottom_m, double top_m) {
    const auto step_of = [](double height_m) {
        return std::log(std::max(height_m / kLowest_m, 1.0)) / std::log(kRise);
    };
    const double last = std::ceil(step_of(top_m));
    std::vector<double> heights;
    for (double k = std::floor(step_of(std::max(bottom_m, kOfHighest * top_m))); k <= last; k += 1.0)
        heights.push_back(kLowest_m * std::pow(kRise, k));
    return heights;
}

}  // namespace

float MirroredSun::Plane::at(const glm::dvec2& place_m) const {
    const glm::dvec2 at = (place_m - from_m) / texel_m - 0.5;
    if (!(at.x > -1.0 && at.y > -1.0 && at.x < side && at.y < side)) return 1.0f;
    const int column = static_cast<int>(std::floor(at.x)), row = static_cast<int>(std::floor(at.y));
    const auto texel = [&](int x, int y) {
        const bool is_in = x >= 0 && y >= 0 && x < side && y < side;
        return is_in ? texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(side) +
                              static_cast<std::size_t>(x)]
                     : 1.0f;
    };
    const auto right = static_cast<float>(at.x - column), up = static_cast<float>(at.y - row);
    return glm::mix(glm::mix(texel(column, row), texel(column + 1, row), right),
                    glm::mix(texel(column, row + 1), texel(column + 1, row + 1), right), up);
}

void MirroredSun::clear() {
    planes_.clear();
    found_.reset();
}

template <class T>
void MirroredSun::find(const Frame<T>& frame, MirroredSunWanted wanted, const std::atomic<bool>* cancel) {
    wanted.sun.is_mirrored = true;
    if (found_ == wanted && frame_ == &frame && times_set_ == frame.times_set()) return;
    clear();
    const auto half_m = [&](const glm::dvec3& direction) {
        const glm::dvec3 edges = glm::abs(direction * wanted.half_edges_m);
        return edges.x + edges.y + edges.z;
    };
    const double high_m = half_m({0.0, 0.0, 1.0}), top_m = wanted.middle_m.z + high_m,
                 bottom_m = wanted.middle_m.z - high_m;
    share_ = static_cast<float>(caustics_share(wanted.sun));
    if (share_ > 0.0f && top_m > 0.0) {
        way_ = level_way(wanted.sun);
        const double tangent = glm::length(way_);
        along_ = tangent > 1e-6 ? way_ / tangent : glm::dvec2(1.0, 0.0);
        const double far_m = std::max(half_m(glm::dvec3(along_, 0.0)), 1e-3),
                     wide_m = std::max(half_m(glm::dvec3(left_of(along_), 0.0)), 1e-3);
        const glm::dvec2 middle_m = turned(glm::dvec2(wanted.middle_m), along_);
        for (const double height_m : heights_m(bottom_m, top_m)) {
            // The place on this plane of what the nearest ones' light meets between them and it; below the first it meets all.
            double shift_m = (kRise - 1.0) * height_m * tangent;
            if (planes_.empty()) shift_m = std::max(shift_m, (height_m - std::max(bottom_m, 0.0)) * tangent);
            const double width_m = 2.0 * std::max(far_m + shift_m, wide_m);
            double texel_m = std::max({width_m / (kMostSide - 2),
                                       height_m / (kTexelsAWay * static_cast<double>(wanted.sun.to_sun.z)),
                                       wanted.finest_m});
            // Rounded, so that planes are the same while a body hardly moves.
            texel_m = std::exp2(0.5 * std::ceil(2.0 * std::log2(texel_m)));
            Plane plane{.height_m = height_m,
                        .texel_m = texel_m,
                        .side = static_cast<int>(std::ceil(width_m / texel_m)) + 2};
            plane.from_m = texel_m * glm::floor((middle_m - 0.5 * plane.side * texel_m) / texel_m);
            plane.texels.resize(static_cast<std::size_t>(plane.side) * static_cast<std::size_t>(plane.side));
            find_caustics({.from_m = plane.from_m.x * along_ + plane.from_m.y * left_of(along_),
                           .texel_m = texel_m,
                           .side = plane.side,
                           .texels = plane.texels,
                           .along = along_},
                          Floor(), frame, 0, wanted.sun,
                          {.depth_m = height_m,
                           .level_m = wanted.level_m,
                           .most_margin_m = kMostMirrored * plane.side * texel_m,
                           .finest_cell_m = wanted.finest_cell_m},
                          cancel);
            planes_.push_back(std::move(plane));
        }
    }
    found_ = wanted;
    frame_ = &frame;
    times_set_ = frame.times_set();
}
template void MirroredSun::find(const Frame<float>&, MirroredSunWanted, const std::atomic<bool>*);
template void MirroredSun::find(const Frame<double>&, MirroredSunWanted, const std::atomic<bool>*);

float MirroredSun::at(const glm::dvec3& place_m) const {
    if (planes_.empty()) return 1.0f;
    const auto on = [&](const Plane& plane) {
        return plane.at(
            turned(glm::dvec2(place_m) + (plane.height_m - std::max(place_m.z, 0.0)) * way_, along_));
    };
    const auto over = std::partition_point(planes_.begin(), planes_.end(),
                                           [&](const Plane& plane) { return plane.height_m <= place_m.z; });
    float pattern = 1.0f;
    if (over == planes_.begin()) {
        pattern = on(planes_.front());
    } else if (over == planes_.end()) {
        pattern = on(planes_.back());
    } else {
        const Plane& below = *(over - 1);
        pattern =
            glm::mix(on(below), on(*over),
                     static_cast<float>((place_m.z - below.height_m) / (over->height_m - below.height_m)));
    }
    return 1.0f + share_ * (pattern - 1.0f);
}

std::size_t MirroredSun::bytes() {
    const auto planes = static_cast<std::size_t>(std::ceil(-std::log(kOfHighest) / std::log(kRise))) + 2;
    return planes * static_cast<std::size_t>(kMostSide) * static_cast<std::size_t>(kMostSide) * sizeof(float);
}

std::size_t MirroredSun::finding_bytes() {
    return caustics_bytes(kMostSide, kMostMirrored, true);
}

}  // namespace pelagic
