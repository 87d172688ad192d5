// Residual foam in the layout of the textures that foam_history.glsl reads. Needs no OpenGL.
#pragma once

#include <array>
#include <atomic>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <vector>

#include "core/effects/foam_history.h"
#include "core/surface/projected_grid.h"

namespace pelagic {

class PackedFoam {
  public:
    PackedFoam() = default;  // nothing is left anywhere
    // The tiles that the history was asked for since its time was set, around a place [m]: of views that are far from
    // each other only one's.
    PackedFoam(const FoamHistory<float>& history, glm::dvec2 centre_m);

    static constexpr int kTilesAcross = 256;    // the texture of nodes
    static constexpr int kFarthestTile = 1024;  // of a level, from the centre's: so far out coarser ones do
    static constexpr int kLevelTexels = 2;      // a level's columns in level_texels()

    // Nodes of tiles, kTilesAcross of them side by side: foam, and foam times its age; with bubbles these as well, and nothing. One texel
    // without tiles.
    const std::vector<float>& nodes() const { return nodes_; }
    int channels() const { return channels_; }
    glm::ivec2 nodes_size() const { return nodes_size_; }
    // Level by level a box of tiles, as many rows as it is high: which tile of nodes() is there, −1 for none.
    const std::vector<float>& pages() const { return pages_; }
    glm::ivec2 pages_size() const { return pages_size_; }
    // For points relative to an origin [m]: a row for each level and one for the sea, as foam_history.glsl has them.
    std::vector<glm::vec4> level_texels(glm::dvec2 origin_m) const;

    // What the history held when this was made.
    std::size_t history_bytes() const { return history_bytes_; }
    std::size_t bytes() const { return nodes_.size() * sizeof(float) + pages_.size() * sizeof(float); }
    // The bytes of foam that takes this much in a history, at most.
    static std::size_t bytes_for(const FoamPlan& foam, std::size_t history_bytes);

  private:
    struct Box {
        glm::dvec2 first{0.0};  // tile
        glm::ivec2 size{0};     // tiles
        int row = 0;            // of pages()
        double cells_per_m = 0.0;
        glm::dvec2 drifted_m{0.0};
    };
    std::array<Box, FoamPlan::kLevels> boxes_{};
    std::size_t history_bytes_ = 0;
    int channels_ = 2;
    std::vector<float> nodes_ = std::vector<float>(2);
    glm::ivec2 nodes_size_{1};
    std::vector<float> pages_{-1.0f};
    glm::ivec2 pages_size_{1};
    float mean_ = 0.0f, mean_times_age_s_ = 0.0f, cells_per_m_ = 1.0f, mean_bubbles_ = -1.0f;
    float past_m_ = 0.0f, breaking_m_ = 0.0f, breaking_deviate_ = 0.0f;
};

// The tiles that pixels between a grid's points read at the history's time, and some of coarser levels, which are
// read where waves turn away from the eye. Points beside those of a whole grid stand each for its cell.
// `cancel` is looked at for each row of the grid: throws BuildCancelled.
std::vector<FoamPlace> foam_places(const FoamPlan& foam, double time_s, const ProjectedGrid& grid,
                                   const std::atomic<bool>* cancel = nullptr);

}  // namespace pelagic
