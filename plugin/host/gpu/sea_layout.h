// The layout of a query's grids and tables in GPU memory. It is the same for all frames and views of a sea.
// Needs no OpenGL.
#pragma once

#include <algorithm>
#include <cstddef>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <initializer_list>
#include <memory>
#include <vector>

#include "core/waves/frame.h"

namespace pelagic {

// A number as the sum of two floats of 12 significant bits, whose products with other such floats are exact.
struct SplitNumber {
    float high, low;
};
SplitNumber split_number(double value);

class SeaLayout {
  public:
    // Throws std::invalid_argument as PackedFrame does.
    SeaLayout(std::shared_ptr<const Sea<float>> sea, int query);

    const Sea<float>& sea() const { return *sea_; }
    int query() const { return query_; }
    bool is_choppy() const { return is_choppy_; }
    bool has_coverage() const { return has_coverage_; }
    // Whether cascades have random tiling: their tiles at random offsets, blended (core/plan/random_tiling.h).
    bool has_random_tiling() const;
    // Whether what earlier breaking has left is part of the picture (PackedFoam).
    bool has_living_foam() const { return has_coverage_ && sea_->plan().foam.has_value(); }
    bool has_trains() const { return sea_->plan().trains.has_value(); }
    bool has_gusts() const { return sea_->gusts().has_value(); }
    // Of them those that are placed.
    int fronts() const { return has_gusts() ? static_cast<int>(sea_->gusts()->plan.fronts.size()) : 0; }
    int front_rows() const { return fronts() > 0 ? 2 * fronts() + 1 + 2 * Gusts::kBends : 0; }
    // Waves that feel a coast's floor (coast.glsl): whether any break there, whether they are trains, how many of these feel it, and how many of
    // their pictures lie side by side in coast_trains. Its rows of the uniform block are the last.
    bool has_surf() const { return sea_->has_surf(); }
    bool has_coast() const { return sea_->coast() != nullptr; }
    int coast_trains() const { return has_coast() ? static_cast<int>(sea_->coast()->feeling) : 0; }
    int coast_across() const {
        return std::max(coast_sizes_.trains.x / std::max(coast_sizes_.cells.x, 1), 1);
    }
    int coast_rows() const { return has_surf() ? 4 : 0; }
    int coast_row() const {
        return has_surf() ? kGustRows + mask_rows() + kVesselRows * vessels() + front_rows() : 0;
    }
    // Calm and rough places (masks.glsl): how many, their rows of the uniform block, and the levels of cells and pixels that show what a
    // slick leaves; −1: none is finer.
    bool is_masked() const { return sea_->plan().masks.has_value(); }
    int masks() const { return is_masked() ? static_cast<int>(sea_->plan().masks->masks.size()) : 0; }
    int mask_rows() const { return is_masked() ? 3 * masks() + 1 : 0; }
    // A coast that tiles feel is one of them.
    bool has_mask_pictures() const {
        return is_masked() && std::ranges::any_of(sea_->plan().masks->masks, [](const MasksPlan::Mask& mask) {
                   return bool(mask.cells);
               });
    }
    // Whether vessels' wakes calm ripples as well.
    bool has_strips() const { return is_masked() && sea_->plan().masks->has_strips; }
    int calm_cell() const { return calm_cell_; }
    int calm_pixel() const { return calm_pixel_; }
    int cascades() const { return static_cast<int>(sea_->plan().cascades.size()); }
    int sea_cascades() const { return static_cast<int>(sea_->plan().sea_cascades()); }
    int vessels() const { return cascades() - sea_cascades(); }  // whose cascades are behind the sea's

    // A texture: rows of `width` texels, fields interleaved, zeros up to `channels`.
    struct Plane {
        bool of_cells = false;  // grids of the cells' levels, otherwise of the pixels'
        int channels = 1;       // 1, 2 or 4
        std::vector<Field> fields;
        glm::ivec2 size{1};
    };
    const std::vector<Plane>& planes() const { return planes_; }
    // Those that a sea of this plan will have. Throws as the constructor.
    static std::vector<Plane> planes_of(const Plan& plan, int query);
    void fill(const Frame<float>& frame, std::vector<std::vector<float>>& planes) const;

    // A grid's place: its N × N samples, with the first columns and rows repeated at the end so that a spline
    // can read across the periodic border. n = 0: this footprint lets nothing of the cascade through.
    struct Tile {
        glm::ivec2 first{0};
        int n = 0;
        int cascade = 0, grid = 0;
    };
    // Levels of footprints [m], ascending, and the tiles by level · cascades() + cascade.
    struct Levels {
        std::vector<double> footprints_m;
        std::vector<Tile> tiles;
    };
    // A plane's tiles, each grid's once, without those through which nothing passes. fill_row() writes one row of a
    // tile, side_of() texels.
    std::vector<Tile> tiles_of(const Plane& plane) const;
    int side_of(const Tile& tile) const { return tile.n + sea_->plan().knobs.spline_taps - 1; }
    void fill_row(const Frame<float>& frame, const Plane& plane, const Tile& tile, int row, float* to) const;
    const Levels& cells() const { return cells_; }
    const Levels& pixels() const { return pixels_; }
    // The tiles of the breaking waves' displacement gradient, by the pixels' levels; none where they are the pixels'
    // own.
    const Levels& breaking() const { return breaking_; }

    // The unresolved moments of a level of pixels without the trains' part: alone, and mixed with the next level.
    struct UnresolvedLevel {
        UnresolvedMoments<float> alone{}, with_next{};
        double m0_alone = 0.0, m0_with_next = 0.0;  // of heights [m²]
    };
    const std::vector<UnresolvedLevel>& unresolved() const { return unresolved_; }

    // kTrainTexels rows; one column per train, and one more for the end of the prefix sums. trains.glsl
    // describes the rows.
    static constexpr int kTrainTexels = 8;
    std::vector<glm::vec4> train_texels() const;

    // Rows of ellipse_columns(), as cascades.glsl has it; one texel of zeros where there are no cascades.
    std::vector<glm::vec4> ellipse_texels() const;
    int ellipse_columns() const;

    // The texture mask_cells, one float a texel, by the size of it; where masks have pictures.
    glm::ivec2 mask_cells_size() const;
    std::vector<float> mask_cells() const;

    // The textures coast_cells and coast_trains, empty where a sea of this plan has none.
    struct CoastSizes {
        glm::ivec2 cells{0}, trains{0};
        int side() const;           // the longest
        std::size_t bytes() const;  // of both
    };
    static CoastSizes coast_sizes_of(const Plan& plan);
    const CoastSizes& coast_sizes() const { return coast_sizes_; }
    std::vector<glm::vec4> coast_cell_texels() const;
    std::vector<glm::vec2> coast_train_texels() const;

    // A vessel's rows of the uniform block, and of the texture wake_table: see wakes.glsl.
    static constexpr int kVesselRows = 2, kWakeTableRows = 2 + Frame<float>::kSlopeBlocks;
    glm::ivec2 wake_size() const;
    std::vector<glm::vec4> wake_texels(const Frame<float>& frame) const;

    // Of gusts.glsl.
    static constexpr int kGustRows =
        2 * GustsPlan::kWaves + (Gusts::kLevelTerms + Gusts::kKeptTerms + 1 + 3) / 4;

    // For points relative to an origin [m]: the uniform block of cascades.glsl, as large for each, in which the time counts
    // only for gusts and vessels; and, where the sea has trains, their phases there [cycles], one float a train.
    std::vector<std::byte> tables(glm::dvec2 origin_m, double time_within_loop_s) const;
    std::vector<float> train_cycles(glm::dvec2 origin_m, double time_within_loop_s) const;

  private:
    static Levels levels_of(const Plan& plan, const std::vector<double>& footprints_m,
                            const std::vector<int>& levels);
    static glm::ivec2 place(const Plan& plan, std::initializer_list<Levels*> all_levels);
    static std::vector<Plane> lay_out(const Plan& plan, int query, Levels& cells, Levels& pixels,
                                      Levels& breaking);

    std::shared_ptr<const Sea<float>> sea_;
    int query_ = 0;
    bool is_choppy_ = false, has_coverage_ = false;
    int calm_cell_ = -1, calm_pixel_ = -1;
    std::vector<Plane> planes_;
    Levels cells_, pixels_, breaking_;
    std::vector<UnresolvedLevel> unresolved_;
    CoastSizes coast_sizes_;
};

}  // namespace pelagic
