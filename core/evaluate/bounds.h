// How high, how low and how far aside the sea goes in one frame: for rays and culling. Bounds of this
// realisation and not of the spectrum, never exceeded by what evaluate() answers.
#pragma once

#include <array>
#include <cstddef>
#include <glm/vec2.hpp>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <vector>

#include "core/plan/plan.h"
#include "core/plan/random_tiling.h"
#include "core/waves/frame.h"

namespace pelagic {

// Displacements [m] of all points that rest in a region.
struct DisplacementBounds {
    struct Interval {
        double lo = std::numeric_limits<double>::infinity(), hi = -std::numeric_limits<double>::infinity();
    };
    Interval z, dx, dy;

    // |Dx| and |Dy| are at most this [m].
    glm::dvec2 reach_m() const;
};

// A rectangle at rest [m], in the world; its edges belong to it.
struct RestRegion {
    glm::dvec2 min_m{0.0}, max_m{0.0};
};

// Footprints of cells [m], as Points::cell_m: both ends belong to the range, and a query's first footprint is
// its finest. The default is that one alone.
struct FootprintRange {
    double finest_m = 0.0, coarsest_m = 0.0;
};

// Bounds hold for round footprints. An ellipse resolves less of each wave, but reads a cascade up to 1.2 of its
// lengths away (core/plan/taps.inl): ask for a region that is larger by so much.
//
// Made from a frame by whoever wants bounds; a frame of which nobody does pays nothing. It must not outlive
// the frame, which must stay where it is; valid until the frame's next set(), after which refresh() makes it
// so again. Any number of threads may ask at once.
//
// A cascade's grid is bounded block by block, in a pyramid: a B-spline lies in the convex hull of its
// coefficients, which are the samples (core/waves/spline.h), and a grid that is read at its nodes has no
// other values. A wave train is bounded by the interval of its phase over the region, which is split where
// that decides.
template <class T>
class FrameBounds {
  public:
    // Of a query that holds positions or displacements, at cells of these footprints. Throws
    // std::invalid_argument for one that holds neither, for a range that isn't one, or when the frame has no
    // time; std::out_of_range when there is no such query.
    FrameBounds(const Frame<T>& frame, int query, FootprintRange cells = {});

    // After the frame's set(). Throws std::invalid_argument when the frame has no time.
    void refresh();
    bool is_current() const { return frame_->times_set() == times_set_; }

    // Of all points that rest in the region. `most_blocks`: into how many the region is split at most; more
    // are tighter and take longer. Throws std::invalid_argument for a region that isn't one or no blocks,
    // std::logic_error when the frame was set since.
    DisplacementBounds region(const RestRegion& region, int most_blocks = 4096) const;
    // Of all points everywhere.
    DisplacementBounds everywhere() const;

  private:
    // Bounds of a field of a grid over blocks of its cells; each level has blocks of twice the side.
    struct Level {
        int side = 1;              // blocks along an axis
        std::vector<T> low, high;  // x fastest
    };
    struct Pyramid {
        std::vector<Level> levels;  // the finest first; none: the field is zero
    };
    struct GridBounds {
        double size_m = 1.0;
        int n = 1;                             // cells along an axis
        std::optional<uint> tiling_key{};      // with random tiling (core/plan/random_tiling.h)
        std::optional<glm::dvec2> middle_m{};  // of a vessel's: the period round it alone
        std::array<Pyramid, 3> fields;         // height, Dx, Dy
    };
    using Block = RestRegion;

    void check_current() const {
        if (!is_current())
            throw std::logic_error(
                "the frame was set to another time: refresh() makes the bounds valid again");
    }

    // Of the periodic grid's field over a block that begins and ends there [m], from its origin.
    static DisplacementBounds::Interval interval_of(const GridBounds& grid, const Pyramid& field,
                                                    glm::dvec2 from_m, glm::dvec2 to_m);
    Pyramid pyramid_of(int cascade, int grid, Field field) const;
    DisplacementBounds bounds_of(const Block& block, const std::vector<double>& cycles,
                                 glm::dvec2 origin_m) const;
    void add_coast(const Coast<T>& coast, const Block& block, const std::vector<double>& cycles,
                   glm::dvec2 origin_m, DisplacementBounds& bounds) const;

    const Frame<T>* frame_;
    const PlannedQuery* planned_;
    int query_;
    Product sampled_;          // displacements, or positions where the query has no others
    FootprintRange cells_;     // of the trains: not below the query's first
    std::vector<int> levels_;  // the plan's, that these footprints lie on or between
    std::vector<GridBounds> grids_;
    std::vector<std::vector<int>> grid_of_level_;          // by level, the indices of its grids
    std::array<std::vector<double>, 3> train_amplitudes_;  // height, Dx, Dy [m]
    std::vector<double> finest_weight_, coarsest_weight_;  // of each train, at the ends of the range
    double smallest_block_m_ = 0.0;  // of the finest grid: smaller ones are bounded no better
    long times_set_ = -1;
};

// The bounds of a query's levels of footprints, powers of two, made when asked for. As FrameBounds, but for any time of
// the frame: it notices that the frame was set.
template <class T>
class BoundsByLevel {
  public:
    // Nothing is made yet, so the frame needs no time.
    BoundsByLevel(const Frame<T>& frame, std::size_t query) : frame_(&frame), query_(query) {}

    // For all cells from the level on, up to twice as large.
    const FrameBounds<T>& from_level(double level_m) const;
    // For cells of this footprint [m] and what is beside it.
    const FrameBounds<T>& of_cell(double cell_m) const;
    // The query's first: finer ones count as that [m].
    double finest_cell_m() const { return frame_->sea().plan().queries.at(query_).query.cell_m.front(); }

  private:
    const Frame<T>* frame_;
    std::size_t query_;
    mutable std::mutex lock_;
    mutable std::map<double, std::unique_ptr<FrameBounds<T>>> bounds_;
};

}  // namespace pelagic
