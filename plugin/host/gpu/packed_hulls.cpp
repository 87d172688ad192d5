#include "plugin/host/gpu/packed_hulls.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <utility>

namespace pelagic {

PackedHulls::PackedHulls(std::vector<std::shared_ptr<const Hull>> hulls) {
    for (auto& hull : hulls) {
        if (!hull || !hull->keeps_water_out() || std::ranges::find(hulls_, hull) != hulls_.end()) continue;
        first_row_.push_back(rows_);
        rows_ += static_cast<int>((hull->nodes_m().size() + kHullColumns - 1) / kHullColumns);
        hulls_.push_back(std::move(hull));
    }
}

std::vector<float> PackedHulls::maps() const {
    std::vector<float> texels(static_cast<std::size_t>(kHullColumns) * rows_);
    for (std::size_t i = 0; i < hulls_.size(); ++i)
        std::ranges::copy(hulls_[i]->nodes_m(),
                          texels.begin() + static_cast<std::ptrdiff_t>(kHullColumns) * first_row_[i]);
    return texels;
}

std::vector<glm::vec4> PackedHulls::places(std::span<const PlacedHull> hulls) const {
    std::vector<glm::vec4> texels(1), waters;
    std::size_t count = 0;
    for (const PlacedHull& placed : hulls) count += placed.hull && placed.hull->keeps_water_out();
    texels[0].x = static_cast<float>(count);
    const std::size_t first_water = 1 + kHullTexels * count;
    for (const PlacedHull& placed : hulls) {
        if (!placed.hull || !placed.hull->keeps_water_out()) continue;
        const Hull& hull = *placed.hull;
        const auto known = static_cast<std::size_t>(
            std::ranges::find_if(hulls_, [&](const auto& of) { return of.get() == &hull; }) - hulls_.begin());
        const double scale = glm::length(glm::dvec3(placed.grid_from[0]));
        // From the grid to columns, rows, and levels above the box's lowest point.
        const glm::dvec3 first_m(hull.first_m(), hull.lowest_m()),
            step_m(hull.cell_m(), hull.cell_m(), hull.level_m());
        const glm::dmat4 into = glm::inverse(placed.grid_from);
        for (int axis = 0; axis < 3; ++axis)
            texels.emplace_back(
                glm::dvec4(into[0][axis], into[1][axis], into[2][axis], into[3][axis] - first_m[axis]) /
                step_m[axis]);
        texels.emplace_back(hull.columns().x, hull.columns().y, first_row_[known], scale);
        const Hulls::Beside* water = placed.water;
        if (!water || water->count.x == 0) {
            texels.emplace_back(0.0f);
            texels.emplace_back(0.0f);
            continue;
        }
        texels.emplace_back(water->foam, water->foam_m, first_water + waters.size(), water->count.x);
        const glm::dvec2 to_first = (water->first_m - hull.first_m()) / hull.cell_m();
        texels.emplace_back(to_first.x, to_first.y, hull.cell_m() / water->step_m, water->count.y);
        for (const glm::vec3& way : water->way_mps) waters.emplace_back(way, 0.0f);
    }
    texels.insert(texels.end(), waters.begin(), waters.end());
    texels.resize((texels.size() + kHullPlaceColumns - 1) / kHullPlaceColumns * kHullPlaceColumns);
    return texels;
}

}  // namespace pelagic
