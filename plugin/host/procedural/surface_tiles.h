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
#include "plugin/host/procedural/tile_kernels.h"

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
    TilePlace place;
    glm::dvec3 middle_m{0.0};  // at rest, in the world
    TileBox box;               // of all points while the shutter is open
    TileQuarters quarters;
    mutable std::array<std::atomic<const Tile*>, 4> finer{};  // over the quarters; null: not asked for yet
    std::unique_ptr<float[]> values;  // by axis: positions, then velocities if the shutter is open
    TilePoints points;
};

// The tiles made so far. Any number of threads at once; nothing is removed.
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
    // masks: the sea's, null: none.
    SurfaceTiles(const PreparedQuery<float>& query, double finest_cell_m, double half_open_s,
                 std::size_t most_bytes, const MasksPlan* masks);

    // From this level on the sea is its plane at rest.
    int flat_level() const { return first_level_ + static_cast<int>(deviations_m_.size()); }
    // No point of the level is farther than this from the surface of the finest cells at the same place at rest: five
    // standard deviations of samples. Levels below the finest count as the finest, flat ones as the first of these.
    double deviation_m(int level) const;
    // The coarsest level that keeps this near to the surface.
    int level_within(double tolerance_m) const;
    // How much larger tiles of the coarser level, or the boxes of their quarters, must be to hold all of the finer
    // one's points: 1.5 times both deviations, since a box that is too small loses hits.
    double widening_m(int coarse, int fine) const { return 1.5 * (deviation_m(coarse) + deviation_m(fine)); }

    // The store that calls hold while they use its tiles; a new one once the last is full.
    std::shared_ptr<TileStore> store() const;
    bool is_full(const TileStore& store) const { return store.bytes() > most_bytes_; }
    const Tile& tile(TileStore& store, const TilePlace& place) const;

    static double width_m(int level);
    static glm::dvec3 middle_m(const TilePlace& place);

  private:
    double sampled_deviation_m(int level, bool& is_flat) const;
    std::unique_ptr<Tile> made(const TilePlace& place) const;

    const PreparedQuery<float>* query_;
    const MasksPlan* masks_;
    double finest_cell_m_, half_open_s_;
    std::size_t most_bytes_;
    int first_level_ = 0;
    std::vector<double> deviations_m_;  // by level from the first on; never falling
    double flat_deviation_m_ = 0.0;
    mutable std::mutex lock_;
    mutable std::shared_ptr<TileStore> store_;
};

}  // namespace pelagic::procedural
