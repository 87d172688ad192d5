// The sea of a frame as triangles, for rays: tiles that are made when a ray first asks for them and kept while there is room.
//
// Level k has its points 2^k m apart, each filtered by a cell of that width. The tiles of a level join: each level is one
// surface without gaps, and lies within deviation_m() of the exact one. A tile of a level is also the box round the tiles
// of finer levels over the same place, widened by both deviations.
#pragma once

#include <tbb/concurrent_unordered_map.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <mutex>
#include <vector>

#include "core/evaluate/prepared_query.h"
#include "plugin/procedural/tile_kernels.h"

namespace pelagic::procedural {

// Of a level, its tile number x, y: kTileCells × 2^level m wide, that many widths from the world's origin.
struct TilePlace {
    int level = 0;
    std::int64_t x = 0, y = 0;
    bool operator==(const TilePlace&) const = default;
};

struct TileBox {
    glm::vec3 low_m{0.0f}, high_m{0.0f};  // relative to the tile's middle at rest
};

struct Tile {
    TileBox box;                                              // of all points while the shutter is open
    std::array<TileBox, 4> quarters;                          // x fastest
    mutable std::array<std::atomic<const Tile*>, 4> finer{};  // over the quarters; null: not asked for yet
    std::unique_ptr<float[]> values;  // by axis: positions, then velocities if the shutter is open
    TilePoints points;
};

// What was made so far. Any number of threads at once; nothing is taken away.
class TileStore {
  public:
    const Tile* find(const TilePlace& place) const;
    // The tile that is there afterwards: this one, or another thread's, which is the same.
    const Tile* keep(const TilePlace& place, std::unique_ptr<const Tile> tile, std::size_t bytes);
    std::size_t bytes() const { return bytes_; }

  private:
    struct Hash {
        std::size_t operator()(const TilePlace& place) const;
    };
    tbb::concurrent_unordered_map<TilePlace, std::unique_ptr<const Tile>, Hash> tiles_;
    std::atomic<std::size_t> bytes_ = 0;
};

class SurfaceTiles {
  public:
    // Of a query with positions, and with velocities if the shutter is open for half_open_s to either side of the frame's time.
    // It must outlive this. finest_cell_m: finer ones show no more. most_bytes: of the tiles that are kept.
    SurfaceTiles(const PreparedQuery<float>& query, double finest_cell_m, double half_open_s,
                 std::size_t most_bytes);

    // From this level on the sea is its plane at rest.
    int flat_level() const { return first_level_ + static_cast<int>(deviations_m_.size()); }
    // No point of the level is further from the surface of the finest cells, where the same place at rest lies: by five
    // standard deviations of what is sampled. Levels below the finest count as that, flat ones as the first of these.
    double deviation_m(int level) const;
    // The coarsest level that keeps this near to the surface.
    int level_within(double tolerance_m) const;
    // By half as much again as both deviations together, since a box that is too small loses hits: tiles of the coarser level, or boxes of their quarters, hold all of the finer one's points when they are so much larger.
    double widening_m(int coarse, int fine) const { return 1.5 * (deviation_m(coarse) + deviation_m(fine)); }

    // What calls hold while they use its tiles; an empty one once the last is full.
    std::shared_ptr<TileStore> store() const;
    bool is_full(const TileStore& store) const { return store.bytes() > most_bytes_; }
    const Tile& tile(TileStore& store, const TilePlace& place) const;

    static double width_m(int level);
    static glm::dvec3 middle_m(const TilePlace& place);

  private:
    double sampled_deviation_m(int level, bool& is_flat) const;
    std::unique_ptr<Tile> made(const TilePlace& place) const;

    const PreparedQuery<float>* query_;
    double finest_cell_m_, half_open_s_;
    std::size_t most_bytes_;
    int first_level_ = 0;
    std::vector<double> deviations_m_;  // by level from the first on; never falling
    double flat_deviation_m_ = 0.0;
    mutable std::mutex lock_;
    mutable std::shared_ptr<TileStore> store_;
};

}  // namespace pelagic::procedural
