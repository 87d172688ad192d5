// The sea for validating the lighting (Bruneton, Neyret, Holzschuch 2010, §7.2): one periodic tile of waves
// that ends at a known wavelength. Very fine geometry can show all of its waves, and a pixel hides exactly
// what that geometry shows and the filter doesn't.
#pragma once

#include <cstdint>
#include <memory>

#include "core/surface/projected_grid.h"
#include "core/waves/frame.h"

namespace pelagic::bench {

struct WaveTileOptions {
    double wind_speed_mps = 5.0, fetch_m = 300e3;
    double choppiness = 1.0;
    std::uint64_t seed = 1;
    double size_m = 100.0;
    int resolution = 2048;  // of the waves: the shortest is slightly longer than two samples
};

// The queries of the tile's plan, all of this band only.
enum TileQuery {
    kWhole,   // positions and normals of all waves, unfiltered
    kCells,   // positions, filtered by cells: a levels
    kPixels,  // normals and unresolved slope variance, filtered by pixels: a levels
};

class WaveTile {
  public:
    explicit WaveTile(const WaveTileOptions& options);

    const Frame<float>& frame() const { return *frame_; }
    double size_m() const { return size_m_; }
    double shortest_m() const { return shortest_m_; }
    // Moments of the tile's band, and what a footprint of 0 hides of it: the error of "hides nothing".
    const SpectralMoments& whole() const { return frame_->sea().statistics(kWhole).whole; }
    SpectralMoments unresolved_from_all() const;
    // Of the positions, with room for the highest crest among a few thousand.
    SurfaceBounds bounds() const;
    // What a mesh of the scene's waves hides: those longer than the tile, too, which is a little more.
    const UnresolvedHeight& unresolved_height() const { return unresolved_height_; }

  private:
    double size_m_, shortest_m_;
    UnresolvedHeight unresolved_height_;
    std::unique_ptr<Frame<float>> frame_;
};

}  // namespace pelagic::bench
