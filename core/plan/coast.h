// What a coast (Waves::coast) is to whatever feels it: its depths, what breaks on its floor, and the sea of tiles over it.
//
// Tiles of cascades are alike everywhere: their waves neither turn nor shorten. What is left of them is an amplitude, one more mask of places
// (core/plan/masks.h). Of the energy that comes from sea.depth_m,
//
//   the wind sea's waves have φ(ω, d)/φ(ω, sea.depth_m), 1 at most (Kitaigorodskii's φ, Bouws et al. 1985: core/spectrum/tma.h);
//   a swell's are no sea of that depth but rise as they slow down, c_g(ω, sea.depth_m)/c_g(ω, d), kMostCoastEnergy at most; a buoy's as well,
//   since swell is among them.
//
// The mean of both over the spectrum, by energy, is that of all waves. Breaking then holds them by H⁻⁵ = H_all⁻⁵ + (γ d)⁻⁵ with γ = kSurfGamma:
// what Thornton and Guza's dissipation (1983; core/waves/coast.h) takes on its way adds up in H⁻⁵, and of its balance on plane beaches,
// 0.38 … 0.45 of the depth from 5 to 1 m on 1:50, γ is the middle. So H_rms < γ d everywhere, whatever the way there.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/common.hpp>
#include <glm/vec2.hpp>
#include <optional>
#include <vector>

#include "pelagic/depth_map.h"
#include "pelagic/scene.h"

namespace pelagic {

class DirectionalSpectrum;
struct MasksPlan;

inline constexpr double kCoastShore_m = 0.05;
inline constexpr double kSurfGamma = 0.42;  // Thornton and Guza's, of H_rms over depth
// A wave's energy over what came in.
inline constexpr double kMostCoastEnergy = 3.0;

// How wide a coast's cells are over a map of this size, and how many there are.
double coast_cell_m(glm::dvec2 size_m);
glm::ivec2 coast_cells(glm::dvec2 size_m);

// The depths of a map's cells [m], columns fastest, rows from the south.
struct CoastDepths {
    glm::ivec2 count{0};
    glm::dvec2 from_m{0.0}, cell_m{1.0};
    std::vector<double> depth_m;

    std::size_t at(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(count.x) + static_cast<std::size_t>(x);
    }
};
// Their means over a grid of so many cells.
CoastDepths coast_depths(const DepthMap& map, glm::ivec2 count);

// How far beyond a map of this size its gains and its foam go [m]. The side over eight is some of its waves' lengths.
inline double coast_fade_m(glm::dvec2 size_m) {
    return std::max(size_m.x, size_m.y) / 8.0;
}
// What is left of a map's part at so many times the distance over which it fades: 1 … 0, with its derivative.
struct CoastFade {
    double left, rate;
};
inline CoastFade coast_fade(double t) {
    if (t >= 1.0) return {0.0, 0.0};
    return {1.0 - t * t * (3.0 - 2.0 * t), -6.0 * t * (1.0 - t)};
}

// The share of waves that break where they are so high (rms) in such a depth, as Thornton and Guza (1983) saw them.
inline double surf_share(double rms_height_m, double depth_m) {
    return std::min(std::pow(rms_height_m / (kSurfGamma * depth_m), 4.0), 1.0);
}

// What breaks on a coast's floor, for foam.
template <class T>
struct CoastSurf {
    glm::ivec2 count{0};
    glm::dvec2 from_m{0.0}, cell_m{1.0};
    // A number a cell: the share of waves that break, and the heights' standard deviation [m].
    std::vector<T> broken, deviation_m;
    double peak_per_m = 0.0;  // the wavenumber of the highest waves where they come from
    double fade_m = 1.0;      // how far beyond the map gains and foam are 1 and none again

    // From the map's nearest place to this one.
    glm::dvec2 beyond_m(glm::dvec2 place_m) const {
        return place_m - glm::clamp(place_m, from_m, from_m + glm::dvec2(count) * cell_m);
    }
    std::size_t cell(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(count.x) + static_cast<std::size_t>(x);
    }
};

// The gain of tiles' amplitudes by depth.
class TilesOverDepth {
  public:
    // Of a sea that comes from sea.depth_m and has waves, for depths up to this one [m].
    TilesOverDepth(const DirectionalSpectrum& spectrum, double deepest_m);

    // Of energies without breaking; of amplitudes with it, 0 on land and up to kCoastShore_m.
    double energy(double depth_m) const;
    double amplitude(double depth_m) const;
    double rms_height_m(double depth_m) const { return height_m_ * amplitude(depth_m); }

  private:
    double height_m_;             // rms, of the sea as it comes
    std::vector<double> energy_;  // at depths a twentieth apart, from the shore's on
};

// Adds it to a scene's masks where tiles feel a coast (waves.coast with the model fft) and the sea has waves.
void add_coast_mask(std::optional<MasksPlan>& masks, const Scene& scene, const DirectionalSpectrum& spectrum);

}  // namespace pelagic
