#include "plugin/render/waterline.h"

#include <algorithm>
#include <array>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vector_relational.hpp>
#include <limits>

#include "core/lighting/meniscus.h"

namespace pelagic {
namespace {

glm::dvec3 on_glass(const View& view, glm::dvec2 pixel) {
    const glm::dvec3 direction = view.direction(pixel);
    return view.position_m + direction * (kFrontGlass_m / glm::dot(direction, view.forward));
}

std::array<glm::dvec3, 4> glass_corners(const View& view) {
    const glm::dvec2 size(view.resolution);
    return {on_glass(view, glm::dvec2(0.0)), on_glass(view, {size.x, 0.0}), on_glass(view, size),
            on_glass(view, {0.0, size.y})};
}

}  // namespace

GlassHeights glass_heights(const View& view) {
    const auto corners = glass_corners(view);
    const auto [lowest, highest] = std::ranges::minmax(corners, {}, &glm::dvec3::z);
    return {lowest.z, highest.z};
}

bool may_be_in_water(const View& view, double highest_m) {
    return glass_heights(view).lowest_m <= highest_m + kMeniscus_m + kMeniscusBlur_m;
}

template <class T>
Waterline::Waterline(const View& view, double highest_m, glm::dvec2 origin_m,
                     std::span<const glm::vec<3, T>> position_m, std::span<const std::uint32_t> triangles)
    : view_(view), highest_m_(highest_m), over_(kCells * kCells) {
    const auto corners = glass_corners(view);
    glm::dvec2 high_m(corners[0]);
    low_m_ = high_m;
    for (const glm::dvec3& corner : corners) {
        low_m_ = glm::min(low_m_, glm::dvec2(corner));
        high_m = glm::max(high_m, glm::dvec2(corner));
    }
    // Seen level the glass is a line.
    cell_m_ = glm::max((high_m - low_m_) / double{kCells}, glm::dvec2(1e-6));
    high_m = low_m_ + double{kCells} * cell_m_;
    for (std::size_t t = 0; t + 2 < triangles.size(); t += 3) {
        glm::dmat3 corner;
        for (int i = 0; i < 3; ++i)
            corner[i] = glm::dvec3(position_m[triangles[t + i]]) + glm::dvec3(origin_m, 0.0);
        const glm::dvec2 least(glm::min(corner[0], glm::min(corner[1], corner[2]))),
            most(glm::max(corner[0], glm::max(corner[1], corner[2])));
        if (glm::any(glm::lessThan(most, low_m_)) || glm::any(glm::greaterThan(least, high_m))) continue;
        const glm::ivec2 first = cell_of(least), last = cell_of(most);
        for (int y = first.y; y <= last.y; ++y)
            for (int x = first.x; x <= last.x; ++x) over_[y * kCells + x].push_back(corner);
    }
}

glm::ivec2 Waterline::cell_of(glm::dvec2 place_m) const {
    return glm::ivec2(glm::clamp((place_m - low_m_) / cell_m_, 0.0, kCells - 1.0));
}

double Waterline::height_m(glm::dvec2 pixel) const {
    constexpr double kEndless_m = std::numeric_limits<double>::infinity();
    const glm::dvec3 place_m = on_glass(view_, pixel);
    if (place_m.z > highest_m_ + kMeniscus_m + kMeniscusBlur_m) return kEndless_m;
    if (place_m.z < -highest_m_) return -kEndless_m;
    const glm::ivec2 cell = cell_of(glm::dvec2(place_m));
    const auto cross = [](glm::dvec2 a, glm::dvec2 b) { return a.x * b.y - a.y * b.x; };
    double surface_m = -kEndless_m;
    for (const glm::dmat3& corner : over_[cell.y * kCells + cell.x]) {
        std::array<glm::dvec2, 3> from;
        for (int i = 0; i < 3; ++i) from[i] = glm::dvec2(corner[i] - place_m);
        const glm::dvec3 parts(cross(from[1], from[2]), cross(from[2], from[0]), cross(from[0], from[1]));
        const double twice_area = parts.x + parts.y + parts.z;
        if (twice_area == 0.0 || glm::any(glm::lessThan(parts * twice_area, glm::dvec3(0.0)))) continue;
        double here_m = 0.0;
        for (int i = 0; i < 3; ++i) here_m += parts[i] / twice_area * corner[i].z;
        surface_m = std::max(surface_m, here_m);
    }
    return place_m.z - surface_m;
}

bool Waterline::is_any_under() const {
    constexpr int kPlaces = 32;  // a side
    for (int y = 0; y <= kPlaces; ++y)
        for (int x = 0; x <= kPlaces; ++x)
            if (is_under(glm::dvec2(x, y) / static_cast<double>(kPlaces) * glm::dvec2(view_.resolution)))
                return true;
    return false;
}

template Waterline::Waterline(const View&, double, glm::dvec2, std::span<const glm::vec3>,
                              std::span<const std::uint32_t>);
template Waterline::Waterline(const View&, double, glm::dvec2, std::span<const glm::dvec3>,
                              std::span<const std::uint32_t>);

}  // namespace pelagic
