#include "plugin/bake/level_set.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <limits>

namespace pelagic {
namespace {

double squared(double x) {
    return x * x;
}

// Squares of distances from p.
double to_edge(glm::dvec3 p, glm::dvec3 a, glm::dvec3 b) {
    const glm::dvec3 along = b - a, from_a = p - a;
    const double t = glm::clamp(glm::dot(from_a, along) / glm::dot(along, along), 0.0, 1.0);
    const glm::dvec3 off = from_a - t * along;
    return glm::dot(off, off);
}
double to_triangle(glm::dvec3 p, const std::array<glm::dvec3, 3>& corners) {
    const auto& [a, b, c] = corners;
    const glm::dvec3 normal = glm::cross(b - a, c - a);
    const auto is_left_of = [&](glm::dvec3 from, glm::dvec3 to) {
        return glm::dot(glm::cross(normal, to - from), p - from) >= 0.0;
    };
    if (is_left_of(a, b) && is_left_of(b, c) && is_left_of(c, a))
        return squared(glm::dot(p - a, normal)) / glm::dot(normal, normal);
    return std::min({to_edge(p, a, b), to_edge(p, b, c), to_edge(p, c, a)});
}

// Each cell's two triangles meet on the diagonal from its lower corner.
class Solid {
  public:
    explicit Solid(const SeaSolid& solid)
        : heights_m_(solid.heights_m),
          cells_(solid.cells),
          cell_m_(solid.size_m / solid.cells),
          half_m_(0.5 * solid.size_m),
          floor_m_(solid.floor_m) {}

    // The lowest and the highest point above a rectangle, in cells, both ends included; rectangles outside the square
    // have those of its border.
    glm::dvec2 heights_over(glm::ivec2 from, glm::ivec2 to) const {
        from = glm::clamp(from, 0, cells_ - 1);
        to = glm::clamp(to, 0, cells_ - 1);
        glm::dvec2 range(std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity());
        for (int y = from.y; y <= to.y + 1; ++y)
            for (int x = from.x; x <= to.x + 1; ++x) {
                range.x = std::min(range.x, height(x, y));
                range.y = std::max(range.y, height(x, y));
            }
        return range;
    }
    int cell_of(double at_m) const {
        return std::clamp(static_cast<int>(std::floor((at_m + half_m_) / cell_m_)), 0, cells_ - 1);
    }

    // Signed, where it is less than `most_m`; otherwise most_m with the sign.
    double distance(glm::dvec3 p, double most_m) const {
        const glm::dvec2 inside_m(std::clamp(p.x, -half_m_, half_m_), std::clamp(p.y, -half_m_, half_m_));
        const double above_m = p.z - height_at(inside_m);
        const bool is_over_square = inside_m == glm::dvec2(p);
        const bool is_inside = is_over_square && above_m < 0.0 && p.z > floor_m_;
        double best = squared(most_m);
        if (is_inside) {
            // A side is reached straight on, unless the surface lies between, which is nearer then.
            best = std::min({best, squared(half_m_ - std::abs(p.x)), squared(half_m_ - std::abs(p.y)),
                             squared(p.z - floor_m_)});
        } else if (above_m < 0.0) {
            const glm::dvec3 off = p - glm::dvec3(inside_m, std::max(p.z, floor_m_));
            best = std::min(best, glm::dot(off, off));
        }
        best = to_surface(p, best);
        const double distance_m = std::sqrt(best);
        return is_inside ? -distance_m : distance_m;
    }

  private:
    double height(int x, int y) const {
        return static_cast<double>(heights_m_[static_cast<std::size_t>(y) * (cells_ + 1) + x]);
    }
    glm::dvec3 corner(int x, int y) const {
        return {-half_m_ + x * cell_m_, -half_m_ + y * cell_m_, height(x, y)};
    }

    double height_at(glm::dvec2 at_m) const {
        const int x = cell_of(at_m.x), y = cell_of(at_m.y);
        const double u = std::clamp((at_m.x + half_m_) / cell_m_ - x, 0.0, 1.0);
        const double v = std::clamp((at_m.y + half_m_) / cell_m_ - y, 0.0, 1.0);
        const double low = height(x, y), high = height(x + 1, y + 1);
        // Below the diagonal and above it.
        if (u >= v) return low + u * (height(x + 1, y) - low) + v * (high - height(x + 1, y));
        return low + v * (height(x, y + 1) - low) + u * (high - height(x, y + 1));
    }

    // The smaller of `best` and the squared distance from the triangles, found ring by ring of cells.
    double to_surface(glm::dvec3 p, double best) const {
        const int x = cell_of(p.x), y = cell_of(p.y);
        for (int ring = 0; ring < cells_; ++ring) {
            // A ring lies at least so far from any point of its middle cell.
            if (squared((ring - 1) * cell_m_) >= best && ring > 0) break;
            const int step = ring == 0 ? 1 : 2 * ring;
            for (int j = y - ring; j <= y + ring; ++j) {
                if (j < 0 || j >= cells_) continue;
                const bool is_whole_row = j == y - ring || j == y + ring;
                for (int i = x - ring; i <= x + ring; i += is_whole_row ? 1 : step)
                    if (i >= 0 && i < cells_) best = to_cell(p, {i, j}, best);
            }
        }
        return best;
    }

    double to_cell(glm::dvec3 p, glm::ivec2 cell, double best) const {
        const std::array<double, 4> h{height(cell.x, cell.y), height(cell.x + 1, cell.y),
                                      height(cell.x, cell.y + 1), height(cell.x + 1, cell.y + 1)};
        const auto beyond = [](double at, double low, double high) {
            return at < low ? low - at : at > high ? at - high : 0.0;
        };
        const glm::dvec3 low = corner(cell.x, cell.y);
        const double to_box =
            squared(beyond(p.x, low.x, low.x + cell_m_)) + squared(beyond(p.y, low.y, low.y + cell_m_)) +
            squared(beyond(p.z, std::min({h[0], h[1], h[2], h[3]}), std::max({h[0], h[1], h[2], h[3]})));
        if (to_box >= best) return best;
        const glm::dvec3 right = corner(cell.x + 1, cell.y), left = corner(cell.x, cell.y + 1),
                         high = corner(cell.x + 1, cell.y + 1);
        return std::min({best, to_triangle(p, {low, right, high}), to_triangle(p, {low, high, left})});
    }

    std::span<const float> heights_m_;
    int cells_;
    double cell_m_, half_m_, floor_m_;
};

int block_of(int voxel) {
    return voxel >= 0 ? voxel / vdb::kBlock : -((vdb::kBlock - 1 - voxel) / vdb::kBlock);
}

// A column of blocks: those that hold voxels near the boundary.
class BlockColumn {
  public:
    BlockColumn(const Solid& solid, const SeaSolid& about, const VoxelLattice& voxels, glm::ivec2 block)
        : solid_(solid), about_(about), voxels_(voxels), first_(block * vdb::kBlock) {}

    void for_each(const std::function<void(const vdb::Block<float>&)>& take) {
        const double width_m = kHalfWidth_voxels * voxels_.voxel_m;
        const glm::dvec2 low_m = glm::dvec2(voxels_.first_m) + voxels_.voxel_m * glm::dvec2(first_) - width_m;
        const glm::dvec2 high_m = low_m + (vdb::kBlock - 1) * voxels_.voxel_m + 2.0 * width_m;
        const glm::dvec2 heights_m =
            solid_.heights_over({solid_.cell_of(low_m.x), solid_.cell_of(low_m.y)},
                                {solid_.cell_of(high_m.x), solid_.cell_of(high_m.y)});
        const double half_m = 0.5 * about_.size_m;
        const bool is_at_side =
            low_m.x <= -half_m || low_m.y <= -half_m || high_m.x >= half_m || high_m.y >= half_m;
        const int floor_from = block_at(about_.floor_m - width_m),
                  floor_to = block_at(about_.floor_m + width_m);
        const int from = block_at(heights_m.x - width_m), to = block_at(heights_m.y + width_m);
        has_hulls_ = about_.hulls && about_.hulls->are_near(low_m, high_m, width_m);
        for (int k = floor_from; k <= to; ++k)
            if (is_at_side || has_hulls_ || k <= floor_to || k >= from) take_block(k, take);
    }

  private:
    int block_at(double z_m) const {
        return block_of(static_cast<int>(std::floor((z_m - voxels_.first_m.z) / voxels_.voxel_m)));
    }

    void take_block(int k_block, const std::function<void(const vdb::Block<float>&)>& take) const {
        vdb::Block<float> block{.first = {first_.x, first_.y, k_block * vdb::kBlock}};
        const double most_m = kHalfWidth_voxels * voxels_.voxel_m;
        const auto most = static_cast<float>(most_m);
        for (int i = 0; i < vdb::kBlock; ++i)
            for (int j = 0; j < vdb::kBlock; ++j)
                for (int k = 0; k < vdb::kBlock; ++k) {
                    const glm::dvec3 at_m =
                        voxels_.first_m + voxels_.voxel_m * glm::dvec3(block.first + glm::ivec3(i, j, k));
                    double of_sea_m = solid_.distance(at_m, most_m);
                    if (has_hulls_) of_sea_m = std::max(of_sea_m, -about_.hulls->depth_m(at_m, most_m));
                    const auto distance_m = static_cast<float>(of_sea_m);
                    const std::size_t index = vdb::index_in_block(i, j, k);
                    block.values[index] = distance_m;
                    block.active[index] = std::abs(distance_m) < most;
                }
        if (block.active.any()) take(block);
    }

    const Solid& solid_;
    const SeaSolid& about_;
    const VoxelLattice& voxels_;
    glm::ivec2 first_;  // voxel
    bool has_hulls_ = false;
};

}  // namespace

VoxelLattice voxels_over(double size_m, double voxel_m) {
    const double first_m = -0.5 * size_m + 0.5 * voxel_m;
    return {.voxel_m = voxel_m, .first_m = {first_m, first_m, 0.5 * voxel_m}};
}

void for_each_block(const SeaSolid& about, const VoxelLattice& voxels,
                    const std::function<void(const vdb::Block<float>&)>& take) {
    const Solid solid(about);
    const int outside = static_cast<int>(kHalfWidth_voxels);
    const int columns = static_cast<int>(std::ceil(about.size_m / voxels.voxel_m));
    const int from = block_of(-outside), to = block_of(columns - 1 + outside);
    const int a_side = to - from + 1;
    tbb::parallel_for(0, a_side * a_side, [&](int i) {
        BlockColumn(solid, about, voxels, {from + i % a_side, from + i / a_side}).for_each(take);
    });
}

}  // namespace pelagic
